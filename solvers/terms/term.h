#ifndef PLUMBLINE_SOLVERS_TERMS_TERM_H_
#define PLUMBLINE_SOLVERS_TERMS_TERM_H_

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace ceres {
class LossFunction;
}

namespace plumbline {

class PoseSets;
struct TermProblem;

/// A parameter block of a residual.
struct PoseId {
  static constexpr int kSize = 3;  ///< x, y, yaw
  int id;                          ///< pose id
};
/// Likewise, of a map point.
struct PointId {
  static constexpr int kSize = 2;  ///< x, y
  std::size_t id;                  ///< return id
};

/// A state by its flat arrays: (x, y, yaw) per pose and (x, y) per return.
struct StateView {
  const double* poses = nullptr;   ///< [m, m, rad]
  const double* points = nullptr;  ///< [m]
};

/// Where a term adds its derivatives to; null members are left out. Those of poses begin with pose
/// first_pose.
struct TermDerivatives {
  int first_pose = 0;                ///< pose id
  double* pose_gradient = nullptr;   ///< 3 per pose
  double* pose_blocks = nullptr;     ///< upper triangles of J^T W J, row by row: 6 per pose
  double* point_gradient = nullptr;  ///< 2 per return
  double* point_blocks = nullptr;    ///< 3 per return

  /// Whether anything of the poses is wanted.
  bool WantsPoses() const { return pose_gradient != nullptr || pose_blocks != nullptr; }
  /// Whether anything of the points is wanted.
  bool WantsPoints() const { return point_gradient != nullptr || point_blocks != nullptr; }

  /// @{
  /// The entries of one block; null if they are not wanted.
  double* Gradient(PoseId pose) const { return Entry(pose_gradient, 3, pose.id - first_pose); }
  double* Gradient(PointId point) const {
    return Entry(point_gradient, 2, static_cast<std::ptrdiff_t>(point.id));
  }
  double* Block(PoseId pose) const { return Entry(pose_blocks, 6, pose.id - first_pose); }
  double* Block(PointId point) const {
    return Entry(point_blocks, 3, static_cast<std::ptrdiff_t>(point.id));
  }
  /// @}

 private:
  static double* Entry(double* values, int size, std::ptrdiff_t i) {
    return values == nullptr ? nullptr : values + size * i;
  }
};

/// The Gauss-Newton equations of poses, as terms that see poses only add to them.
class PoseEquations {
 public:
  virtual ~PoseEquations() = default;
  /// A block on the diagonal, J^T W J, and the gradient J^T W r.
  virtual void Add(int pose, const Eigen::Matrix3d& block, const Eigen::Vector3d& gradient) = 0;
  /// A block off the diagonal: columns of pose a, rows of pose b, a < b.
  virtual void AddCoupling(int a, int b, const Eigen::Matrix3d& block) = 0;
};

/// A term of the energy: all residuals of one kind, for one graph, its associations and options.
/// All that the library knows of a kind of residual is behind this class; terms.cc has the list.
///
/// Functions work on a batch: the residuals of one scan if GoesByScan(), else (`scan` is kNoScan)
/// all of them. Different scans may be worked on by different threads.
class Term {
 public:
  static constexpr int kNoScan = -1;  ///< of a term that does not go by scan

  virtual ~Term() = default;

  /// @{
  /// For reports. The sigma is that of one residual in `unit`, or 0 where they have several units.
  virtual std::string name() const = 0;
  virtual std::string unit() const { return ""; }
  virtual double sigma() const { return 0.0; }
  /// @}
  virtual int residuals_per_block() const = 0;  ///< scalars
  virtual std::size_t num_blocks() const = 0;   ///< residual blocks
  /// What blocks are numbered by, as constraints or returns of the graph; not all need have one.
  virtual std::size_t num_measurements() const { return num_blocks(); }

  virtual bool SeesPoses() const = 0;   ///< whether any residual sees a pose
  virtual bool SeesPoints() const = 0;  ///< whether any residual sees a point
  /// Whether a residual sees more than one point.
  virtual bool JoinsPoints() const = 0;
  /// Whether each residual belongs to a scan: it sees points of this scan only, and its pose.
  virtual bool GoesByScan() const = 0;
  /// Whether nothing changes when a scan moves with its points.
  virtual bool RidesAlong() const { return false; }

  /// Adds one half of the (robustified) squared residuals to *cost, and derivatives. False where a
  /// residual is undefined.
  virtual bool Linearize(int scan, const StateView& at, const TermDerivatives& out,
                         double* cost) const = 0;
  /// Adds d^T J^T W J d to *sum, for a direction d; null pointers are zero.
  virtual void AddCurvature(int scan, const StateView& at, const StateView& direction,
                            double* sum) const = 0;
  /// Adds the diagonal block (upper triangle) of the scan's pose when the points go along with it,
  /// for a preconditioner: terms that it can do without add nothing.
  virtual void AddCarriedBlock(int /*scan*/, const double* /*pose*/, const double* /*points*/,
                               double* /*block*/) const {}
  /// Whitened residuals without loss, residuals_per_block() for each measurement; NaN where
  /// undefined, untouched where there is none.
  virtual void Evaluate(int scan, const StateView& at, double* residuals) const = 0;

  /// @{
  /// As residual blocks of Ceres. MakeLoss: for all blocks of the term; null: none.
  virtual std::unique_ptr<ceres::LossFunction> MakeLoss() const = 0;
  virtual void AddTo(int scan, TermProblem* problem) const = 0;
  /// @}

  /// @{
  /// Of terms that see poses only. AddSquares adds twice the cost, NaN where it is undefined;
  /// TiePoses says which poses residuals join, and which ones they tie to the world.
  virtual void AddSquares(const double* /*poses*/, double* /*sum*/) const {}
  virtual void AddEquations(const double* /*poses*/, PoseEquations* /*equations*/) const {}
  virtual void TiePoses(PoseSets* /*sets*/, std::vector<char>* /*tied*/) const {}
  /// @}
};

/// In the order of the energy. Shared, and constant, so that a list can be copied.
using TermList = std::vector<std::shared_ptr<const Term>>;

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_TERM_H_
