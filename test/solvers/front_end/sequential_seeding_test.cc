#include "plumbline/solvers/front_end/sequential_seeding.h"

#include <gtest/gtest.h>

#include <thread>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

// Half a lap of radius 1 m round the room, 10 cm a step, ahead of `num_back` steps backward.
SlamGraph DriveRoundTheRoom(int num_back) {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  for (int i = 0; i <= 30; ++i) {
    const double angle = 0.1 * i;
    scene.poses.emplace_back(std::cos(angle), std::sin(angle), angle + kPi / 2.0);
  }
  for (int i = 0; i < num_back; ++i) scene.poses.push_back(scene.poses[29 - i]);
  return MakeGraph(scene);
}

Status SeedWith(const SlamGraph& graph, const SeedingProgress& progress, ThreadPool* pool,
                SequentialTrajectory* trajectory, SequentialSeedingReport* report) {
  ScanSurfaces surfaces(graph, Packed(SurfacesOf(graph)));
  return SeedSequentially(SeedingOptions(), MotionOptions(), progress, pool, &surfaces, trajectory,
                          report);
}

SequentialTrajectory Seed(const SlamGraph& graph, SequentialSeedingReport* report) {
  ThreadPool pool(1);
  SequentialTrajectory trajectory;
  EXPECT_TRUE(SeedWith(graph, nullptr, &pool, &trajectory, report).ok());
  return trajectory;
}

double WorstM(const SlamGraph& truth, const SequentialTrajectory& trajectory) {
  double worst_m = 0.0;
  for (int pose = 0; pose < truth.num_poses(); ++pose) {
    worst_m =
        std::max(worst_m, DistanceM(truth.InitialPose(pose), trajectory.world_from_robot[pose]));
  }
  return worst_m;
}

TEST(SequentialSeeding, CorrectsAnOdometryThatIsAFifthOff) {
  SlamGraph graph = DriveRoundTheRoom(0);
  AddOdometry([](const Pose2& s) { return Pose2(1.2 * s.x, s.y, 0.8 * s.yaw); }, &graph);
  SequentialSeedingReport report;
  const SequentialTrajectory trajectory = Seed(graph, &report);
  EXPECT_LT(WorstM(graph, trajectory), 0.02);
  EXPECT_EQ(report.num_unmatched, 0);
  EXPECT_GT(report.num_keyframes, 5);
  EXPECT_LT(report.num_keyframes, 31);
  EXPECT_EQ(trajectory.keyframes.front().pose, 0);
}

TEST(SequentialSeeding, MarksTheKeyframeAfterAScanThatMatchesNothing) {
  SlamGraph graph = DriveRoundTheRoom(0);
  AddOdometry([](const Pose2& s) { return s; }, &graph);
  std::vector<SurfacePoints> all = SurfacesOf(graph);
  constexpr int kStrange = 15;
  for (SurfacePoint& point : all[kStrange]) point.position *= 0.3;
  ScanSurfaces surfaces(graph, Packed(all));
  ThreadPool pool(1);
  SequentialTrajectory trajectory;
  SequentialSeedingReport report;
  ASSERT_TRUE(SeedSequentially(SeedingOptions(), MotionOptions(), nullptr, &pool, &surfaces,
                               &trajectory, &report)
                  .ok());
  EXPECT_EQ(report.num_unmatched, 1);
  int before = 0, num_marked = 0;
  for (const Keyframe& keyframe : trajectory.keyframes) {
    const bool is_next = before < kStrange && keyframe.pose >= kStrange;
    EXPECT_EQ(keyframe.after_unmatched, is_next) << keyframe.pose;
    num_marked += is_next;
    before = keyframe.pose;
  }
  EXPECT_EQ(num_marked, 1);
}

TEST(SequentialSeeding, FindsTheLostSignOfEachStep) {
  SlamGraph graph = DriveRoundTheRoom(12);
  AddOdometry([](const Pose2& s) { return s.x < 0.0 ? Pose2(-s.x, -s.y, s.yaw) : s; }, &graph);
  SequentialSeedingReport report;
  const SequentialTrajectory trajectory = Seed(graph, &report);
  EXPECT_TRUE(report.odometry_sign.sign_lost);
  EXPECT_EQ(report.num_reversed_steps, 12);
  EXPECT_LT(WorstM(graph, trajectory), 0.02);
  EXPECT_GT(trajectory.odometry[30].x, 0.09);
  EXPECT_LT(trajectory.odometry[31].x, -0.09);
}

TEST(SequentialSeeding, FindsBackFromATurnThatTheOdometryMissed) {
  SyntheticScene scene = Room();
  for (int i = 0; i < 12; ++i) scene.poses.emplace_back(0.0, 0.0, i < 6 ? 0.0 : 0.45);
  SlamGraph graph = MakeGraph(scene);
  AddOdometry([](const Pose2&) { return Pose2(); }, &graph);
  SequentialSeedingReport report;
  const SequentialTrajectory trajectory = Seed(graph, &report);
  EXPECT_LT(WorstM(graph, trajectory), 0.02);
  EXPECT_NEAR(trajectory.world_from_robot.back().yaw, 0.45, 5e-3);
}

TEST(SequentialSeeding, TurningOnTheSpotAddsNoKeyframesAfterTheFirstTurn) {
  SyntheticScene scene = Room();
  for (int i = 0; i < 126; ++i) scene.poses.emplace_back(0.0, 0.0, 0.2 * i);  // four turns
  SlamGraph graph = MakeGraph(scene);
  AddOdometry([](const Pose2& s) { return s; }, &graph);
  SequentialSeedingReport report;
  Seed(graph, &report);
  EXPECT_LE(report.num_keyframes, 18);
}

TEST(SequentialSeeding, NamesTheStepThatLacksOdometry) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.1, 0.0, 0.0), Pose2(0.2, 0.0, 0.0)};
  SlamGraph graph = MakeGraph(scene);
  graph.AddOdometry({1, 2, Pose2(0.1, 0.0, 0.0)});
  ThreadPool pool(1);
  SequentialTrajectory trajectory;
  SequentialSeedingReport report;
  const Status status = SeedWith(graph, nullptr, &pool, &trajectory, &report);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("from pose 0 to pose 1"), std::string::npos);
}

TEST(SequentialSeeding, StopsWhenItsCallerSaysSo) {
  SlamGraph graph = DriveRoundTheRoom(0);
  AddOdometry([](const Pose2& s) { return s; }, &graph);
  ThreadPool pool(1);
  SequentialTrajectory trajectory;
  SequentialSeedingReport report;
  const Status status = SeedWith(
      graph, [](SeedingPhase, int, int) { return false; }, &pool, &trajectory, &report);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_TRUE(trajectory.world_from_robot.empty());
}

// Laps round the room, long enough to be cut into stretches.
SlamGraph DriveManyLaps() {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  for (int i = 0; i < 1300; ++i) {
    const double angle = 0.1 * i;
    scene.poses.emplace_back(std::cos(angle), std::sin(angle), angle + kPi / 2.0);
  }
  SlamGraph graph = MakeGraph(scene);
  AddOdometry([](const Pose2& s) { return Pose2(1.1 * s.x, s.y, 0.9 * s.yaw); }, &graph);
  return graph;
}

TEST(SequentialSeeding, StretchesOfALongDriveFitTogether) {
  const SlamGraph graph = DriveManyLaps();
  SequentialSeedingReport report;
  const SequentialTrajectory trajectory = Seed(graph, &report);
  double worst_step_m = 0.0;
  for (int pose = 1; pose < graph.num_poses(); ++pose) {
    const Pose2 truth = Between(graph.InitialPose(pose - 1), graph.InitialPose(pose));
    const std::vector<Pose2>& found = trajectory.world_from_robot;
    worst_step_m = std::max(worst_step_m, DistanceM(truth, Between(found[pose - 1], found[pose])));
  }
  EXPECT_LT(worst_step_m, 0.02);
  EXPECT_LT(WorstM(graph, trajectory), 0.1);
  EXPECT_EQ(report.num_unmatched, 0);
  const std::vector<Keyframe>& keyframes = trajectory.keyframes;
  ASSERT_EQ(report.num_keyframes, static_cast<int>(keyframes.size()));
  for (std::size_t k = 1; k < keyframes.size(); ++k) {
    EXPECT_GT(keyframes[k].pose, keyframes[k - 1].pose);
    EXPECT_GT(keyframes[k].path_m, keyframes[k - 1].path_m);
  }
  EXPECT_NEAR(keyframes.back().path_m, 0.1 * keyframes.back().pose, 2.0);
}

TEST(SequentialSeeding, StretchesDoNotDependOnTheNumberOfThreads) {
  const SlamGraph graph = DriveManyLaps();
  std::vector<SequentialTrajectory> trajectories;
  for (const int num_threads : {1, 3}) {
    ThreadPool pool(num_threads);
    SequentialSeedingReport report;
    ASSERT_TRUE(SeedWith(graph, nullptr, &pool, &trajectories.emplace_back(), &report).ok());
  }
  EXPECT_EQ(PoseArray(trajectories[0].world_from_robot),
            PoseArray(trajectories[1].world_from_robot));
}

TEST(SequentialSeeding, KeepsTheSurfacesOfTheKeyframesOfAllStretches) {
  const SlamGraph graph = DriveManyLaps();
  const MeasuredSurface measured = SurfaceOf(graph);
  ThreadPool pool(2);
  ScanSurfaces surfaces(graph, measured);
  SequentialTrajectory made, kept;
  SequentialSeedingReport report;
  ASSERT_TRUE(
      SeedSequentially(SeedingOptions(), MotionOptions(), nullptr, &pool, &surfaces, &made, &report)
          .ok());
  ASSERT_TRUE(SeedWith(graph, nullptr, &pool, &kept, &report).ok());
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    // What is kept is in single precision.
    EXPECT_LT(DistanceM(made.world_from_robot[pose], kept.world_from_robot[pose]), 1e-3) << pose;
  }
  const std::vector<SurfacePoints> all = SurfacesOf(graph);
  std::vector<int> num_points(graph.num_scans(), 0);
  for (const Keyframe& key : made.keyframes) {
    num_points[key.scan] = static_cast<int>(all[key.scan].size());
  }
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    EXPECT_EQ(static_cast<int>(surfaces.Kept(scan).size()), num_points[scan]) << scan;
  }
}

TEST(SequentialSeeding, TellsItsCallerOnItsOwnThreadAboutScansOfAllStretches) {
  const SlamGraph graph = DriveManyLaps();
  ThreadPool pool(2);
  SequentialTrajectory trajectory;
  SequentialSeedingReport report;
  const std::thread::id caller = std::this_thread::get_id();
  int num_calls = 0, last = -1;
  const auto progress = [&](SeedingPhase, int num_done, int num_total) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_EQ(num_total, graph.num_poses());
    EXPECT_GT(num_done, last);
    EXPECT_LT(num_done, num_total);
    last = num_done;
    ++num_calls;
    return true;
  };
  ASSERT_TRUE(SeedWith(graph, progress, &pool, &trajectory, &report).ok());
  EXPECT_GT(num_calls, 0);
}

TEST(SequentialSeeding, WithoutOdometryTheScansAloneTellTheWay) {
  const SlamGraph graph = DriveRoundTheRoom(12);
  SequentialSeedingReport report;
  EXPECT_LT(WorstM(graph, Seed(graph, &report)), 0.02);
  EXPECT_EQ(report.num_unmatched, 0);
}

TEST(SequentialSeeding, WithoutOdometryAScanFarOffTheOneBeforeIsSearchedFor) {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  scene.poses = {{-1.0, 1.0, 0.0}, {1.0, -1.2, 1.2}, {1.0, -1.2, 1.2}};
  const SlamGraph graph = MakeGraph(scene);
  SequentialSeedingReport report;
  EXPECT_LT(WorstM(graph, Seed(graph, &report)), 0.02);
  EXPECT_GE(report.num_recovered, 1);
}

TEST(SequentialSeeding, WithoutOdometryAStandingRobotStands) {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  scene.poses.assign(40, {-1.0, 1.0, 0.3});
  const SlamGraph graph = MakeGraph(scene);
  SequentialSeedingReport report;
  EXPECT_LT(WorstM(graph, Seed(graph, &report)), 0.01);
  EXPECT_EQ(report.num_keyframes, 1);
}

}  // namespace
}  // namespace plumbline
