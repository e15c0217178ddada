#include "plumbline/solvers/incremental_solver.h"

#include <ceres/autodiff_cost_function.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr int kNumPoses = 60;
constexpr int kBatch = 6;

SolverOptions Threads(int num_threads) {
  SolverOptions options;
  options.num_threads = num_threads;
  return options;
}

NoisyRoom LongDrive() {
  NoisyRoomOptions options;
  options.num_poses = kNumPoses;
  options.odometry_sigma = 0.005;
  return MakeNoisyRoom(options);
}

IncrementalOptions Window(int num_free_poses) {
  IncrementalOptions options;
  options.num_free_poses = num_free_poses;
  return options;
}

// A host to whom a drive around a room comes in bit by bit.
struct Host {
  const NoisyRoom drive = LongDrive();
  SlamGraph graph;
  std::vector<double> poses;
  IncrementalSolver solver;
  std::vector<IncrementalSummary> summaries;

  explicit Host(int num_threads = 1, int num_free_poses = 20)
      : solver(Threads(num_threads), Window(num_free_poses)) {}
  explicit Host(const SolverOptions& options) : solver(options, Window(20)) {}

  // Poses where the odometry puts them.
  void Receive(int num_poses) {
    for (int pose = graph.num_poses(), end = pose + num_poses; pose < end; ++pose) {
      Pose2 here = drive.truth[0];
      if (pose > 0)
        here = Pose2(&poses[3 * (pose - 1)]) * drive.graph.odometry()[pose - 1].from_from_to;
      const int id = graph.AddPose(here, pose);
      poses.insert(poses.end(), {here.x, here.y, here.yaw});
      graph.AddScanOf(drive.graph, pose, id);
      if (pose == 0) continue;
      graph.AddOdometry(drive.graph.odometry()[pose - 1]);
    }
  }
  void Update(UpdateScope scope = UpdateScope::kAutomatic) {
    summaries.emplace_back();
    const Status status = solver.Update(graph, scope, &poses, &summaries.back());
    ASSERT_TRUE(status.ok()) << status.message();
  }
  void DriveAll() {
    while (graph.num_poses() < kNumPoses) {
      Receive(kBatch);
      Update();
    }
  }
  double MeanErrorM() const {
    double sum = 0.0;
    for (int pose = 0; pose < graph.num_poses(); ++pose) {
      sum += DistanceM(Pose2(&poses[3 * pose]), drive.truth[pose]);
    }
    return sum / graph.num_poses();
  }
};

TEST(IncrementalSolverTest, EndsWhereSolvingAllAtOnceEnds) {
  Host host;
  host.DriveAll();
  MapState batch = host.graph.InitialState();
  batch.poses = host.poses;
  batch.points = host.graph.MeasuredMap(batch.poses);
  SolverOptions options = Threads(1);
  const SolverSummary summary = RefineState(options, host.graph, &batch);
  ASSERT_TRUE(summary.IsSolutionUsable());
  double largest_m = 0.0;
  for (int pose = 0; pose < kNumPoses; ++pose) {
    largest_m =
        std::max(largest_m, DistanceM(Pose2(&host.poses[3 * pose]), batch.WorldFromRobot(pose)));
  }
  EXPECT_LT(largest_m, 0.004);
  EXPECT_LT(summary.acceptance.seed_energy, 1.01 * summary.acceptance.final_energy);
  EXPECT_LT(host.MeanErrorM(), 0.006);
}

TEST(IncrementalSolverTest, OnlyTheNewestMove) {
  Host host;
  while (host.graph.num_poses() < 48) {
    host.Receive(kBatch);
    host.Update();
  }
  const std::vector<double> before = host.poses;
  host.Receive(kBatch);
  host.Update();
  EXPECT_EQ(host.summaries.back().num_free_poses, 20);
  EXPECT_EQ(host.summaries.back().num_placed_poses, kBatch);
  EXPECT_TRUE(std::equal(before.begin(), before.begin() + 3 * 34, host.poses.begin()));
  EXPECT_NE(before[3 * 40], host.poses[3 * 40]);
}

TEST(IncrementalSolverTest, ALoopThatGapesIsClosed) {
  Host host;
  // Half a metre off and turned, as a whole.
  host.Receive(kNumPoses / 2);
  host.Update();
  host.Receive(1);
  const Pose2 off(0.4, 0.3, 0.05);
  const Pose2 displaced = off * Pose2(&host.poses[3 * (kNumPoses / 2)]);
  host.poses[3 * (kNumPoses / 2)] = displaced.x;
  host.poses[3 * (kNumPoses / 2) + 1] = displaced.y;
  host.poses[3 * (kNumPoses / 2) + 2] = displaced.yaw;
  host.Receive(kNumPoses / 2 - 1);
  RelativePoseConstraint closure{2, kNumPoses - 2,
                                 Between(host.drive.truth[2], host.drive.truth[kNumPoses - 2])};
  closure.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  host.graph.AddRelativePose(closure);
  ASSERT_GT(host.MeanErrorM(), 0.1);
  host.Update();
  EXPECT_EQ(host.summaries.back().num_free_poses, kNumPoses);
  host.Update(UpdateScope::kAll);
  EXPECT_LT(host.MeanErrorM(), 0.02);
}

TEST(IncrementalSolverTest, OfClosuresThatAgreeOnlyTheFirstMovesAll) {
  Host host;
  host.DriveAll();
  RelativePoseConstraint closure{2, kNumPoses - 2,
                                 Between(host.drive.truth[2], host.drive.truth[kNumPoses - 2])};
  closure.covariance = Eigen::Vector3d(1e-2, 1e-2, 1e-3).asDiagonal();
  for (const int num_free : {kNumPoses, 20}) {
    host.graph.AddRelativePose(closure);
    host.Update();
    EXPECT_EQ(host.summaries.back().num_free_poses, num_free);
  }
}

TEST(IncrementalSolverTest, AClosureThatItsScansContradictIsLeftOut) {
  Host host;
  host.DriveAll();
  RelativePoseConstraint closure{2, kNumPoses - 2, Pose2(1.5, -0.8, 0.4)};
  closure.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  host.graph.AddRelativePose(closure);
  host.Update();
  ASSERT_EQ(host.summaries.back().ignored_edges.size(), 1u);
  EXPECT_EQ(host.summaries.back().ignored_edges[0].to, kNumPoses - 2);
  EXPECT_GT(host.summaries.back().ignored_edges[0].sigmas, 30.0);
  EXPECT_LT(host.MeanErrorM(), 0.006);
}

TEST(IncrementalSolverTest, ManyFalseClosuresRaiseTheAlarm) {
  Host host;
  host.DriveAll();
  std::size_t num_false = 0;
  for (const int from : {2, 5, 8}) {
    EXPECT_TRUE(host.summaries.back().alarms.empty()) << num_false;
    RelativePoseConstraint closure{from, kNumPoses - from, Pose2(1.5, -0.8, 0.4)};
    closure.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
    host.graph.AddRelativePose(closure);
    host.Update();
    const IncrementalSummary& summary = host.summaries.back();
    EXPECT_EQ(summary.ignored_edges.size() + summary.contradicted_closures.size(), ++num_false);
  }
  ASSERT_EQ(host.summaries.back().alarms.size(), 1u);
  EXPECT_THAT(host.summaries.back().alarms[0].reason,
              testing::StartsWith("3 of 3 loop closures contradict the map, by up to "));
}

// Scans that are not asked leave a false closure in force.
TEST(IncrementalSolverTest, AClosureThatCountsAndIsFalseIsNamed) {
  SolverOptions options = Threads(1);
  options.test_edges = false;
  Host host(options);
  host.DriveAll();
  RelativePoseConstraint closure{2, kNumPoses - 2, Pose2(1.5, -0.8, 0.4)};
  closure.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  RelativePoseConstraint right{1, kNumPoses - 3,
                               Between(host.drive.truth[1], host.drive.truth[kNumPoses - 3])};
  right.covariance = closure.covariance;
  for (int copy = 0; copy < 3; ++copy) host.graph.AddRelativePose(right);
  host.graph.AddRelativePose(closure);
  host.Update();
  ASSERT_EQ(host.summaries.back().contradicted_closures.size(), 1u);
  const IgnoredEdge& named = host.summaries.back().contradicted_closures[0];
  EXPECT_EQ(named.edge, 3u);
  EXPECT_EQ(named.to, kNumPoses - 2);
  EXPECT_GT(named.off_m, 0.5);
}

TEST(IncrementalSolverTest, AllFollowWhenTheCallerMovesAPose) {
  Host host;
  host.DriveAll();
  host.poses[3 * 10] += 0.03;
  host.poses[3 * 10 + 1] -= 0.02;
  host.Update();
  EXPECT_EQ(host.summaries.back().num_free_poses, kNumPoses);
  EXPECT_LT(DistanceM(Pose2(&host.poses[3 * 10]), host.drive.truth[10]), 0.01);
}

TEST(IncrementalSolverTest, FixedPosesStay) {
  Host host;
  host.Receive(kBatch);
  host.graph.FixPose(2, host.drive.truth[2]);
  host.graph.FixPose(4, host.drive.truth[4]);
  host.Update();
  host.DriveAll();
  for (const int pose : {2, 4}) {
    EXPECT_EQ(host.poses[3 * pose], host.drive.truth[pose].x);
    EXPECT_EQ(host.poses[3 * pose + 1], host.drive.truth[pose].y);
    EXPECT_EQ(host.poses[3 * pose + 2], host.drive.truth[pose].yaw);
  }
  EXPECT_LT(host.MeanErrorM(), 0.006);
}

TEST(IncrementalSolverTest, AMapThatIsFixedElsewhereIsMovedThereAsAWhole) {
  Host host;
  host.DriveAll();
  const Pose2 away(10.0, -5.0, 1.57);
  host.graph.FixPose(30, away * host.drive.truth[30]);
  host.Update();
  for (const int pose : {0, 29, kNumPoses - 1}) {
    EXPECT_LT(DistanceM(Pose2(&host.poses[3 * pose]), away * host.drive.truth[pose]), 0.03);
  }
}

TEST(IncrementalSolverTest, ClosuresOfPosesWithoutScansCount) {
  SlamGraph graph;
  std::vector<double> poses;
  for (int i = 0; i < 30; ++i) {
    graph.AddPose({0.5 * i, 0.0, 0.0}, i);
    poses.insert(poses.end(), {0.5 * i, 0.0, 0.0});
    if (i == 0) continue;
    graph.AddOdometry({i - 1, i, {0.5, 0.0, 0.0}});
  }
  RelativePoseConstraint closure{0, 29, {14.5, 1.0, 0.0}};
  closure.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal();
  graph.AddRelativePose(closure);
  IncrementalSolver solver;
  ASSERT_TRUE(solver.Update(graph, UpdateScope::kAutomatic, &poses).ok());
  EXPECT_NEAR(poses[3 * 29 + 1], 1.0, 0.01);
}

TEST(IncrementalSolverTest, AScanThatComesLateMovesItsPose) {
  Host host;
  host.DriveAll();
  host.graph.AddScanOf(host.drive.graph, 5, 5);
  host.Update();
  EXPECT_EQ(host.summaries.back().num_free_poses, kNumPoses - 5);
  EXPECT_GE(host.summaries.back().num_placed_poses, 1);
  EXPECT_LT(host.MeanErrorM(), 0.006);
}

TEST(IncrementalSolverTest, TheResultDoesNotDependOnTheNumberOfThreads) {
  Host one(1), three(3);
  for (Host* host : {&one, &three}) {
    host->DriveAll();
    host->Update(UpdateScope::kAll);
  }
  EXPECT_EQ(one.poses, three.poses);
}

TEST(IncrementalSolverTest, GivesTheMapOnDemand) {
  Host host;
  host.DriveAll();
  MapState state;
  ASSERT_TRUE(host.solver.GetState(host.graph, &state).ok());
  EXPECT_EQ(state.poses, host.poses);
  const std::vector<double> measured = host.graph.MeasuredMap(host.poses);
  ASSERT_EQ(state.points.size(), measured.size());
  // Points lie nearer to the walls than the ends of their beams: here, to the one at y = 2 m.
  double before = 0.0, after = 0.0;
  std::size_t num_on_wall = 0;
  for (std::size_t i = 0; i < measured.size(); i += 2) {
    if (std::abs(measured[i]) > 2.5 || std::abs(measured[i + 1] - 2.0) > 0.04) continue;
    ++num_on_wall;
    before += std::pow(measured[i + 1] - 2.0, 2);
    after += std::pow(state.points[i + 1] - 2.0, 2);
  }
  EXPECT_GT(num_on_wall, 500u);
  EXPECT_LT(after, 0.6 * before);
}

// A measured position of the robot.
struct MeasuredPosition {
  double x_m, y_m, sigma_m;

  template <typename T>
  bool operator()(const T* pose, T* residuals) const {
    residuals[0] = (pose[0] - x_m) / sigma_m;
    residuals[1] = (pose[1] - y_m) / sigma_m;
    return true;
  }
};

void AddPosition(int pose, double x_m, double y_m, double sigma_m, SlamGraph* graph) {
  graph->AddFactor("position",
                   std::make_shared<ceres::AutoDiffCostFunction<MeasuredPosition, 2, 3>>(
                       new MeasuredPosition{x_m, y_m, sigma_m}),
                   {pose});
}

TEST(IncrementalSolverTest, CustomFactorsCount) {
  Host host;
  const int pose = kNumPoses / 2;
  const Pose2 truth = host.drive.truth[pose];
  while (host.graph.num_poses() < kNumPoses) {
    host.Receive(kBatch);
    if (host.graph.num_poses() == kBatch) host.graph.FixPose(0);
    if (host.graph.num_poses() > pose && host.graph.factors().empty()) {
      AddPosition(pose, truth.x + 0.03, truth.y - 0.03, 1e-4, &host.graph);
    }
    host.Update();
  }
  for (int i = 0; i < 3; ++i) host.Update(UpdateScope::kAll);
  MapState batch = host.graph.InitialState();
  batch.poses = host.poses;
  batch.points = host.graph.MeasuredMap(batch.poses);
  ASSERT_TRUE(RefineState(Threads(1), host.graph, &batch).IsSolutionUsable());
  EXPECT_NEAR(host.poses[3 * pose], truth.x + 0.03, 0.01);
  EXPECT_NEAR(host.poses[3 * pose + 1], truth.y - 0.03, 0.01);
  for (int i = 0; i < kNumPoses; ++i) {
    EXPECT_LT(DistanceM(Pose2(&host.poses[3 * i]), batch.WorldFromRobot(i)), 0.01);
  }
}

TEST(IncrementalSolverTest, PositionsPutTheMapIntoTheWorld) {
  Host host;
  const Pose2 world_from_map(300.0, -200.0, 1.9);
  while (host.graph.num_poses() < kNumPoses) {
    const int first = host.graph.num_poses();
    host.Receive(kBatch);
    for (int pose = first; pose < host.graph.num_poses(); pose += 2) {
      const Pose2 in_world = world_from_map * host.drive.truth[pose];
      AddPosition(pose, in_world.x, in_world.y, 0.5, &host.graph);
    }
    host.Update();
  }
  int num_of_all = 0;
  for (const IncrementalSummary& summary : host.summaries) {
    num_of_all += summary.num_free_poses > 20 ? 1 : 0;
  }
  EXPECT_LT(num_of_all, 3);  // once the positions have turned the map, it only grows
  for (int pose = 0; pose < kNumPoses; ++pose) {
    const Pose2 in_world = world_from_map * host.drive.truth[pose];
    EXPECT_LT(DistanceM(Pose2(&host.poses[3 * pose]), in_world), 0.05) << pose;
  }
}

TEST(IncrementalSolverTest, CustomFactorsThatCannotBeServedAreRefused) {
  Host host;
  host.Receive(kBatch);
  AddPosition(3, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.1, &host.graph);
  const Status status = host.solver.Update(host.graph, UpdateScope::kAutomatic, &host.poses);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("factor 0 (\"position\")"));
}

TEST(IncrementalSolverTest, NullAndAMovedFromSolverAreRefused) {
  Host host;
  host.Receive(kBatch);
  EXPECT_EQ(host.solver.Update(host.graph, UpdateScope::kAutomatic, nullptr).code(),
            StatusCode::kInvalidArgument);
  host.Update();
  EXPECT_EQ(host.solver.GetState(host.graph, nullptr).code(), StatusCode::kInvalidArgument);
  const IncrementalSolver other = std::move(host.solver);
  MapState state;
  EXPECT_TRUE(other.GetState(host.graph, &state).ok());
  EXPECT_THAT(host.solver.GetState(host.graph, &state).message(), HasSubstr("moved from"));
  EXPECT_THAT(host.solver.Update(host.graph, UpdateScope::kAutomatic, &host.poses).message(),
              HasSubstr("moved from"));
}

TEST(IncrementalSolverTest, GraphsWithoutPosesOrReturnsAreFine) {
  IncrementalSolver solver;
  SlamGraph graph;
  std::vector<double> poses;
  EXPECT_TRUE(solver.Update(graph, UpdateScope::kAutomatic, &poses).ok());
  for (int i = 0; i < 3; ++i) {
    graph.AddPose({1.0 * i, 0.0, 0.0}, i);
    poses.insert(poses.end(), {1.0 * i, 0.0, 0.0});
  }
  EXPECT_TRUE(solver.Update(graph, UpdateScope::kAutomatic, &poses).ok());
  EXPECT_EQ(poses, graph.initial_poses());
}

TEST(IncrementalSolverTest, BadInputIsNamedAndChangesNothing) {
  Host host;
  host.Receive(kBatch);
  const auto message = [&](const SolverOptions& options, IncrementalOptions incremental = {}) {
    std::vector<double> poses = host.poses;
    const Status status =
        IncrementalSolver(options, incremental).Update(host.graph, UpdateScope::kAutomatic, &poses);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(poses, host.poses);
    return status.message();
  };
  SolverOptions options;
  options.num_threads = 0;
  EXPECT_THAT(message(options), HasSubstr("num_threads"));
  options = SolverOptions();
  options.factors.shape = true;
  EXPECT_THAT(message(options), HasSubstr("shape terms"));
  options = SolverOptions();
  options.type = SolverType::kAlternatingCg;
  EXPECT_THAT(message(options), HasSubstr("other solver"));
  options = SolverOptions();
  options.factors.ignored_relative_poses = {0};
  EXPECT_THAT(message(options), HasSubstr("ignored relative poses"));
  options = SolverOptions();
  options.factors.downweighted_steps = {{0, 2.0}};
  EXPECT_THAT(message(options), HasSubstr("down-weighted steps"));
  EXPECT_THAT(message({}, Window(0)), HasSubstr("num_free_poses"));

  host.Update();
  MapState state;
  const std::vector<double> before = host.poses;
  host.poses[7] = std::numeric_limits<double>::quiet_NaN();
  Status status = host.solver.Update(host.graph, UpdateScope::kAutomatic, &host.poses);
  EXPECT_THAT(status.message(), HasSubstr("pose 2 is not finite"));
  host.poses = before;
  host.poses.pop_back();
  status = host.solver.Update(host.graph, UpdateScope::kAutomatic, &host.poses);
  EXPECT_THAT(status.message(), HasSubstr("6 poses, but there are 17 numbers"));
  host.poses = before;
  SlamGraph smaller;
  std::vector<double> none;
  status = host.solver.Update(smaller, UpdateScope::kAutomatic, &none);
  EXPECT_THAT(status.message(), HasSubstr("lost something"));
  EXPECT_THAT(host.solver.GetState(smaller, &state).message(), HasSubstr("last update"));
  host.DriveAll();
  EXPECT_LT(host.MeanErrorM(), 0.006);
}

}  // namespace
}  // namespace plumbline
