#ifndef PLUMBLINE_SOLVERS_ENERGY_H_
#define PLUMBLINE_SOLVERS_ENERGY_H_

#include <array>
#include <cstddef>
#include <initializer_list>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/pose_terms.h"

namespace plumbline {

/// The terms of the joint energy.
enum class Term { kMotion, kRelativePose, kRangeBeam, kManifold, kShape };
constexpr int kNumTerms = 5;
const char* ToString(Term term);

/// A choice of terms.
class TermSet {
 public:
  TermSet(std::initializer_list<Term> terms) {
    for (const Term term : terms) bits_ |= Bit(term);
  }
  static TermSet All() { return TermSet({}).Others(); }

  bool Has(Term term) const { return (bits_ & Bit(term)) != 0; }
  /// The terms that are not in this set.
  TermSet Others() const {
    TermSet others({});
    others.bits_ = ~bits_;
    return others;
  }

 private:
  static unsigned Bit(Term term) { return 1u << static_cast<int>(term); }

  unsigned bits_ = 0;
};

/// Cost of each term: one half of the (robustified) squared whitened residuals.
struct TermCosts {
  std::array<double, kNumTerms> cost{};

  double& operator[](Term term) { return cost[static_cast<int>(term)]; }
  double operator[](Term term) const { return cost[static_cast<int>(term)]; }
  double Total() const;
  TermCosts& operator+=(const TermCosts& other);
};

/// What Energy::Evaluate is to compute besides the cost; null members are left out. Vectors are
/// resized as needed.
struct EnergyDerivatives {
  std::vector<double>* pose_gradient = nullptr;   ///< 3 per pose, zero for constant ones
  std::vector<double>* point_gradient = nullptr;  ///< 2 per return
  /// Diagonal blocks of the Gauss-Newton Hessian, upper triangles row by row: 6 per pose, 3 per
  /// return.
  std::vector<double>* pose_blocks = nullptr;
  std::vector<double>* point_blocks = nullptr;
};

/// The joint energy of poses and points for fixed associations, evaluated on flat arrays with the
/// same residual functions that the Ceres problem is built of, for solvers that bring their own
/// linear algebra. Bitwise the same for any number of threads.
class Energy {
 public:
  /// Keeps references to all its arguments. Shape pairs join returns of one scan and are in order
  /// of scans, as FindShapePairs gives them.
  Energy(const SlamGraph& graph, const Associations& associations, const FactorOptions& options,
         ThreadPool* pool);

  /// poses: (x, y, yaw) per pose; points: (x, y) per return. Returns false where a residual is
  /// undefined (a point on top of its laser) or not finite. Terms that are not asked for count as
  /// zero.
  bool Evaluate(const std::vector<double>& poses, const std::vector<double>& points,
                TermCosts* costs, const EnergyDerivatives& derivatives = {},
                TermSet terms = TermSet::All()) const;

  /// Gauss-Newton curvature d^T J^T W J d along a direction of the poses, the points, or both;
  /// null means zero. W holds the robust weights.
  double Curvature(const std::vector<double>& poses, const std::vector<double>& points,
                   const std::vector<double>* pose_direction,
                   const std::vector<double>* point_direction,
                   TermSet terms = TermSet::All()) const;

  const SlamGraph& graph() const { return graph_; }
  /// Sets the entries of fixed poses to zero: they are constants. gradient: 3 per pose.
  void HoldConstants(std::vector<double>* gradient) const;
  const Associations& associations() const { return associations_; }
  const FactorOptions& options() const { return options_; }
  ThreadPool* pool() const { return pool_; }

  /// Number of residual blocks of each term.
  std::array<std::size_t, kNumTerms> CountTerms() const;

 private:
  // Each calls the visitor with residuals and, if asked for, Jacobians of some terms of one scan or
  // of the poses; false where a residual is undefined.
  template <typename Visitor>
  bool VisitBeams(const ScanEntry& scan, const std::vector<double>& poses,
                  const std::vector<double>& points, bool with_jacobians, Visitor* visitor) const;
  template <typename Visitor>
  bool VisitLines(const ScanEntry& scan, const std::vector<double>& points, bool with_jacobians,
                  Visitor* visitor) const;
  template <typename Visitor>
  bool VisitShapePairs(int scan_id, const std::vector<double>& points, bool with_jacobians,
                       Visitor* visitor) const;
  template <typename Visitor>
  bool VisitScan(int scan_id, const std::vector<double>& poses, const std::vector<double>& points,
                 TermSet terms, bool with_jacobians, Visitor* visitor) const;
  template <typename Visitor>
  bool VisitPoseTerms(const std::vector<double>& poses, TermSet terms, Visitor* visitor) const;

  const SlamGraph& graph_;
  const Associations& associations_;
  const FactorOptions& options_;
  ThreadPool* pool_;
  PoseTerms pose_terms_;
  std::vector<std::size_t> first_shape_pair_;  // per scan, and the end
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ENERGY_H_
