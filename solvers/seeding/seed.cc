#include "plumbline/solvers/seeding/seed.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/solvers/seeding/correct_odometry.h"
#include "plumbline/solvers/seeding/doubtful_edges.h"
#include "plumbline/solvers/seeding/rematch_at_breaks.h"
#include "plumbline/solvers/seeding/seed_pose_graph.h"
#include "plumbline/solvers/seeding/surface_points.h"
#include "plumbline/solvers/solve.h"

namespace plumbline {
namespace {

// Free-space conflicts over explicable ones that sound maps stay below.
constexpr double kSuspiciousRatio = 2.0;
// On alarm this many doubtful edges are broken in turn.
constexpr std::size_t kMaxRepairs = 3;

// The outcome of one way of closing the loops.
struct ClosedLoops {
  LoopClosingReport report;
  std::vector<Pose2> world_from_robot;
  std::vector<RelativePoseConstraint> pose_graph;
  MapConsistency consistency;

  bool Alarm() const {
    // Two weak signs together are one: what contradicts a little, and a doubt or loops left open.
    const bool in_doubt =
        !report.doubts.empty() || (report.num_closures == 0 && !report.matches.empty());
    return consistency.IsContradictory() || (in_doubt && consistency.Ratio() > kSuspiciousRatio) ||
           std::any_of(report.doubts.begin(), report.doubts.end(),
                       [](const DoubtfulStep& doubt) { return doubt.IsUnresolved(); });
  }
};

std::vector<int> MostDoubtfulEdges(const KeyGraph& keys) {
  std::vector<int> edges;
  for (std::size_t e = 0; e < keys.sequential.size(); ++e) {
    if (keys.sequential[e].doubtful()) edges.push_back(static_cast<int>(e));
  }
  std::stable_sort(edges.begin(), edges.end(), [&](int a, int b) {
    return keys.sequential[a].evidence > keys.sequential[b].evidence;
  });
  if (edges.size() > kMaxRepairs) edges.resize(kMaxRepairs);
  return edges;
}

void WriteTrajectory(const SequentialTrajectory& trajectory, SlamGraph* graph) {
  for (int pose = 0; pose < graph->num_poses(); ++pose) {
    graph->SetPose(pose, trajectory.world_from_robot[pose]);
  }
  for (std::size_t i = 0; i < graph->odometry().size(); ++i) {
    const OdometryConstraint& step = graph->odometry()[i];
    if (step.to == step.from + 1) graph->SetOdometryMotion(i, trajectory.odometry[step.to]);
  }
  graph->ResetPointsFromPoses();
}

Status SeedChecked(const SeedingOptions& options, const MotionOptions& motion,
                   const std::vector<Eigen::Vector2f>& normals, const SeedingProgress& progress,
                   ThreadPool* pool, SlamGraph* graph, SeedingReport* report) {
  const DefaultFloatEnvironment float_environment;
  std::string error;
  if (!options.Check(&error) || !motion.Check(&error)) return Status::InvalidArgument(error);
  if (normals.size() != graph->num_returns()) {
    return Status::InvalidArgument("seeding needs one normal per return, " +
                                   std::to_string(graph->num_returns()) + ", but got " +
                                   std::to_string(normals.size()));
  }
  const std::vector<SurfacePoints> surfaces =
      ThinnedSurfacePoints(*graph, normals, options.point_spacing_m, pool);
  SequentialTrajectory trajectory;
  PLUMBLINE_RETURN_IF_ERROR(SeedSequentially(options.sequential, motion, *graph, surfaces, progress,
                                             pool, &trajectory, &report->sequential));
  report->odometry_noise = EstimateOdometryNoise(trajectory, motion);
  CorrectOdometry(report->odometry_noise, motion, &trajectory);
  PLUMBLINE_RETURN_IF_ERROR(CloseAllLoops(options, report->odometry_noise.motion, *graph, surfaces,
                                          progress, pool, &trajectory, report));
  WriteTrajectory(trajectory, graph);
  return Status::Ok();
}

}  // namespace

bool SeedingReport::Repaired() const {
  return std::any_of(loops.doubts.begin(), loops.doubts.end(),
                     [](const DoubtfulStep& doubt) { return doubt.broken; });
}

bool SeedingOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(point_spacing_m, >, 0.0);
  PLUMBLINE_CHECK_NESTED_OPTIONS(sequential);
  PLUMBLINE_CHECK_NESTED_OPTIONS(loops);
  return true;
}

Status SeedGraph(const SeedingOptions& options, const MotionOptions& motion,
                 const std::vector<Eigen::Vector2f>& normals, const SeedingProgress& progress,
                 ThreadPool* pool, SlamGraph* graph, SeedingReport* report) {
  return CatchExceptions(
      [&] { return SeedChecked(options, motion, normals, progress, pool, graph, report); });
}

Status SeedGraph(const SeedingOptions& options, const SolverOptions& solver_options,
                 SlamGraph* graph, SeedingReport* report) {
  return CatchExceptions([&] {
    std::string error;
    if (!solver_options.Check(&error)) return Status::InvalidArgument(error);
    const FactorOptions& factors = solver_options.factors;
    ThreadPool pool(solver_options.num_threads);
    return SeedChecked(options, factors.motion,
                       EstimateReturnNormals(*graph, NormalOptionsFor(factors.beam), &pool),
                       nullptr, &pool, graph, report);
  });
}

Status CloseAllLoops(const SeedingOptions& options, const MotionOptions& motion,
                     const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                     const SeedingProgress& progress, ThreadPool* pool,
                     SequentialTrajectory* trajectory, SeedingReport* report) {
  KeyGraph keys = MakeKeyGraph(*trajectory, motion);
  MarkDoubtfulEdges(graph, surfaces, trajectory->world_from_robot, pool, &keys);
  const std::vector<int> suspects = MostDoubtfulEdges(keys);
  const auto close = [&](KeyGraph attempt, ClosedLoops* result) {
    PLUMBLINE_RETURN_IF_ERROR(
        CloseLoops(options.loops, graph, surfaces, progress, pool, &attempt, &result->report));
    result->world_from_robot = PosesFollowingKeyScans(attempt, trajectory->world_from_robot);
    RematchAtBreaks(graph, surfaces, attempt, trajectory->odometry, &result->world_from_robot);
    result->pose_graph = SeedPoseGraph(attempt, *trajectory, motion);
    result->consistency = MeasureMapConsistency(graph, result->world_from_robot, pool);
    return Status::Ok();
  };
  ClosedLoops best;
  PLUMBLINE_RETURN_IF_ERROR(close(keys, &best));
  for (std::size_t i = 0; best.Alarm() && i < suspects.size(); ++i) {
    KeyGraph broken = keys;
    broken.sequential[suspects[i]].broken = true;
    ClosedLoops attempt;
    PLUMBLINE_RETURN_IF_ERROR(close(std::move(broken), &attempt));
    if (!attempt.Alarm()) best = std::move(attempt);
  }
  report->sequential_poses = std::move(trajectory->world_from_robot);
  report->pose_graph = std::move(best.pose_graph);
  trajectory->world_from_robot = std::move(best.world_from_robot);
  report->alarm = best.Alarm();
  report->loops = std::move(best.report);
  report->consistency = std::move(best.consistency);
  return Status::Ok();
}

}  // namespace plumbline
