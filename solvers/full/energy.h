#ifndef PLUMBLINE_SOLVERS_FULL_ENERGY_H_
#define PLUMBLINE_SOLVERS_FULL_ENERGY_H_

#include <cstddef>
#include <functional>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/terms/term.h"

namespace plumbline {

/// Cost of each term, in the order of Energy::terms(): one half of the (robustified) squared
/// whitened residuals.
struct TermCosts {
  std::vector<double> cost;  ///< per term

  /// The sum over all terms.
  double Total() const;
};

/// Picks terms of the energy by what they are; empty: all.
using TermChoice = std::function<bool(const Term&)>;

/// What Energy::Evaluate is to compute besides the cost; null members are left out. Vectors are
/// resized as needed.
struct EnergyDerivatives {
  std::vector<double>* pose_gradient = nullptr;   ///< 3 per pose, zero for constant ones
  std::vector<double>* point_gradient = nullptr;  ///< 2 per return
  /// Diagonal blocks of the Gauss-Newton Hessian, upper triangles row by row: 6 per pose, 3 per
  /// return.
  std::vector<double>* pose_blocks = nullptr;
  std::vector<double>* point_blocks = nullptr;  ///< see pose_blocks
};

/// The joint energy of poses and points for fixed associations, evaluated on flat arrays with the
/// same residual functions that the Ceres problem is built of, for solvers that bring their own
/// linear algebra. Bitwise the same for any number of threads.
class Energy {
 public:
  /// Keeps references to all its arguments. Its terms are those of MakeTerms. The poses that do not
  /// move are the fixed poses of the graph.
  Energy(const SlamGraph& graph, const Associations& associations, const FactorOptions& options,
         ThreadPool* pool);
  /// The same with these poses that do not move.
  Energy(const SlamGraph& graph, const Associations& associations, const FactorOptions& options,
         ThreadPool* pool, std::vector<FixedPose> constants);

  /// poses: (x, y, yaw) per pose; points: (x, y) per return. Returns false where a residual is
  /// undefined (a point on top of its laser) or not finite. Terms that are not asked for count as
  /// zero.
  bool Evaluate(const std::vector<double>& poses, const std::vector<double>& points,
                TermCosts* costs, const EnergyDerivatives& derivatives = {},
                const TermChoice& choice = nullptr) const;

  /// Gauss-Newton curvature d^T J^T W J d along a direction of the poses, the points, or both;
  /// null means zero. W holds the robust weights.
  double Curvature(const std::vector<double>& poses, const std::vector<double>& points,
                   const std::vector<double>* pose_direction,
                   const std::vector<double>* point_direction,
                   const TermChoice& choice = nullptr) const;

  /// Sets the entries of constant poses to zero. gradient: 3 per pose.
  void HoldConstants(std::vector<double>* gradient) const;
  const SlamGraph& graph() const { return graph_; }                       ///< as given
  const Associations& associations() const { return associations_; }      ///< as given
  const FactorOptions& options() const { return options_; }               ///< as given
  const TermList& terms() const { return terms_; }                        ///< in the order of costs
  const std::vector<FixedPose>& constants() const { return constants_; }  ///< as given
  ThreadPool* pool() const { return pool_; }                              ///< as given

  /// Adds, to the pose blocks (upper triangles) of Evaluate, those of terms on single points if
  /// every scan carries its points along.
  void AddCarriedBlocks(const std::vector<double>& poses, const std::vector<double>& points,
                        std::vector<double>* pose_blocks) const;

 private:
  // Indices of terms that are chosen, those that go by scan and the others.
  struct Chosen {
    std::vector<std::size_t> by_scan;
    std::vector<std::size_t> whole;
  };
  Chosen Choose(const TermChoice& choice) const;
  // Of the scans from `begin` to `end`; costs: per term, added to.
  bool LinearizeScans(std::size_t begin, std::size_t end, const std::vector<std::size_t>& terms,
                      const StateView& at, const EnergyDerivatives& out,
                      std::vector<double>* scan_gradients, std::vector<double>* scan_blocks,
                      double* costs) const;

  const SlamGraph& graph_;
  const Associations& associations_;
  const FactorOptions& options_;
  ThreadPool* pool_;
  const TermList terms_;
  const std::vector<FixedPose> constants_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_ENERGY_H_
