#ifndef PLUMBLINE_SOLVERS_FULL_SCAN_OBJECTIVE_H_
#define PLUMBLINE_SOLVERS_FULL_SCAN_OBJECTIVE_H_

#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/full/block_jacobi.h"
#include "plumbline/solvers/full/energy.h"
#include "plumbline/solvers/full/nonlinear_cg.h"

namespace plumbline {

/// The joint energy as a function of the poses when every scan carries its points along, as if
/// they were glued to the robot.
///
/// The beam terms do not change then, and the poses feel the map priors and the odometry alone:
/// the step that is long where alternating between poses and points is slow.
class ScanObjective final : public CgObjective {
 public:
  /// Keeps a reference.
  explicit ScanObjective(const Energy& energy) : energy_(energy), graph_(energy.graph()) {}

  /// Glues the points of a state to its poses. To be called before a minimisation.
  void AttachPoints(const MapState& state);
  /// The points that go with poses x.
  void PlacePoints(const std::vector<double>& x, std::vector<double>* points) const;

  bool Start(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override;
  bool Resume(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override;
  bool Evaluate(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override;
  double Curvature(const std::vector<double>& x, const std::vector<double>& direction) override;
  void Precondition(const std::vector<double>& x, const std::vector<double>& gradient,
                    std::vector<double>* result) override;

 private:
  const Energy& energy_;
  const SlamGraph& graph_;
  BlockJacobi<3> preconditioner_;
  std::vector<double> attached_;  // points in the frame of their robot
  double fixed_cost_ = 0.0;       // of the beams: the same wherever the scans go
  // Kept between evaluations, which come by the dozen.
  std::vector<double> points_, point_gradient_, point_direction_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_SCAN_OBJECTIVE_H_
