// Builds a small graph through the installed headers and evaluates one residual on it.
#include <plumbline/core/return_normals.h>
#include <plumbline/core/slam_graph.h>
#include <plumbline/core/thread_pool.h>
#include <plumbline/factors/factor_options.h>
#include <plumbline/factors/relative_pose_factor.h>
#include <plumbline/factors/sqrt_information.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

plumbline::Status MakeGraph(plumbline::SlamGraph* graph) {
  plumbline::LaserModel laser;
  laser.num_beams = 91;
  laser.first_bearing_rad = plumbline::DegToRad(-45.0);
  laser.bearing_step_rad = plumbline::DegToRad(1.0);
  int laser_id, from, to;
  PLUMBLINE_RETURN_IF_ERROR(graph->AddLaser(laser, &laser_id));
  PLUMBLINE_RETURN_IF_ERROR(graph->AddPose({0.0, 0.0, 0.0}, 0.0, &from));
  PLUMBLINE_RETURN_IF_ERROR(graph->AddPose({1.0, 0.0, 0.0}, 1.0, &to));
  for (const int pose : {from, to}) {
    const double wall_m = 4.0 - graph->WorldFromRobot(pose).x;
    std::vector<double> ranges;
    for (int b = 0; b < laser.num_beams; ++b) ranges.push_back(wall_m / std::cos(laser.Bearing(b)));
    PLUMBLINE_RETURN_IF_ERROR(graph->AddScan(pose, laser_id, ranges));
  }
  return graph->AddRelativePose({from, to, {1.5, 0.0, 0.0}, Eigen::Matrix3d::Identity() * 0.01});
}

int Fail(const char* what) {
  std::fprintf(stderr, "consumer: %s\n", what);
  return 1;
}

}  // namespace

int main() {
  plumbline::SlamGraph graph;
  const plumbline::Status status = MakeGraph(&graph);
  if (!status.ok()) return Fail(status.message().c_str());
  if (graph.num_returns() != 182) return Fail("not every beam became a return");

  plumbline::ThreadPool pool(2);
  const auto normals = plumbline::EstimateReturnNormals(graph, {}, &pool);
  if (std::abs(normals[45].x() + 1.0f) > 1e-4f) return Fail("the wall does not face the laser");

  if (!plumbline::FactorOptions().Check(nullptr)) return Fail("default options are refused");
  const plumbline::RelativePoseConstraint& edge = graph.relative_poses()[0];
  plumbline::RelativePoseResidual residual;
  residual.a_from_b = edge.from_from_to;
  if (!plumbline::SqrtInformation(edge.covariance, &residual.sqrt_information)) {
    return Fail("the covariance is refused");
  }
  const plumbline::RelativePoseFactor factor(residual);
  const double* blocks[] = {&graph.poses()[3 * edge.from], &graph.poses()[3 * edge.to]};
  double residuals[3];
  if (!factor.Evaluate(blocks, residuals, nullptr)) return Fail("the factor refuses the graph");
  if (std::abs(residuals[0] + 5.0) > 1e-9) return Fail("half a metre at 0.1 m is 5 sigma");
  return 0;
}
