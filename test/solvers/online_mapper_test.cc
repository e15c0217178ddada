#include "plumbline/solvers/online_mapper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A drive through an office that comes back to where it was.
const SimulatedLog& OnlineOffice() {
  static const SimulatedLog* log = [] {
    SimulationOptions options;
    options.scan_period_s = 1.0;
    options.laser.num_beams = 180;
    options.laser.bearing_step_rad = DegToRad(1.0);
    options.odometry_noise.scale_error = 0.03;
    auto* result = new SimulatedLog;
    EXPECT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, result).ok());
    return result;
  }();
  return *log;
}

Status AddScanOfLog(const SimulatedLog& log, std::size_t i, OnlineMapper* mapper,
                    OnlinePose* now = nullptr) {
  return mapper->AddScan(log.scans[i].scan, log.scans[i].odom_from_robot, now);
}

// Poses as they were given, with a background that keeps up.
std::vector<OnlinePose> MapOnline(const SimulatedLog& log, std::size_t num_scans,
                                  OnlineMapper* mapper) {
  std::vector<OnlinePose> poses(num_scans);
  for (std::size_t i = 0; i < num_scans; ++i) {
    const Status status = AddScanOfLog(log, i, mapper, &poses[i]);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_TRUE(mapper->Wait().ok());
  }
  return poses;
}

double ErrorM(const SimulatedLog& log, std::size_t i, const Pose2& map_from_robot) {
  const Pose2 truth = Between(log.scans[0].world_from_robot, log.scans[i].world_from_robot);
  return (map_from_robot.translation() - truth.translation()).norm();
}

bool SamePose(const Pose2& a, const Pose2& b) { return a.x == b.x && a.y == b.y && a.yaw == b.yaw; }

TEST(OnlineMapperTest, CorrectsPosesAtLoopsAndFinishesAsTheBatch) {
  const SimulatedLog& log = OnlineOffice();
  OnlineMapper mapper({log.laser});
  const std::vector<OnlinePose> live = MapOnline(log, log.scans.size(), &mapper);
  double worst_m = 0.0;
  for (std::size_t i = 0; i < live.size(); ++i) {
    EXPECT_EQ(live[i].scan, static_cast<int>(i));
    EXPECT_EQ(live[i].num_pending, 1);
    worst_m = std::max(worst_m, ErrorM(log, i, live[i].map_from_robot));
  }
  const std::size_t last = live.size() - 1;
  const Pose2 by_odometry = Between(log.scans[0].odom_from_robot, log.scans[last].odom_from_robot);
  EXPECT_LT(worst_m, 0.5);
  EXPECT_LT(ErrorM(log, last, live[last].map_from_robot), 0.1);
  EXPECT_GT(ErrorM(log, last, by_odometry), 0.5);
  const Pose2 odometry_in_map = live[last].map_from_odometry * log.scans[last].odom_from_robot;
  EXPECT_NEAR(odometry_in_map.x, live[last].map_from_robot.x, 1e-9);
  EXPECT_NEAR(odometry_in_map.y, live[last].map_from_robot.y, 1e-9);

  OnlineMap map;
  ASSERT_TRUE(mapper.GetMap(&map).ok());
  ASSERT_EQ(map.map_from_robot.size(), log.scans.size());
  EXPECT_GT(map.num_closures, 10);
  EXPECT_GE(map.num_remappings, 2);
  EXPECT_GT(map.points.size(), 1000u);
  double map_worst_m = 0.0;
  for (std::size_t i = 0; i < live.size(); ++i) {
    map_worst_m = std::max(map_worst_m, ErrorM(log, i, map.map_from_robot[i]));
  }
  EXPECT_LT(map_worst_m, 0.1);
  EXPECT_GT(worst_m, map_worst_m);

  LogMapping online, batch;
  ASSERT_TRUE(mapper.Finish(&online).ok());
  SlamGraph graph;
  ASSERT_TRUE(MakeGraph(log, &graph).ok());
  ASSERT_TRUE(MapLog(MapLogOptions(), std::move(graph), {}, &batch).ok());
  EXPECT_EQ(online.state.poses, batch.state.poses);
  EXPECT_EQ(online.state.points, batch.state.points);
  EXPECT_EQ(online.start_poses, batch.start_poses);
  EXPECT_EQ(online.report.alarms.size(), batch.report.alarms.size());

  EXPECT_THAT(AddScanOfLog(log, last, &mapper).message(), HasSubstr("has finished"));
  EXPECT_FALSE(mapper.Finish(&online).ok());
  EXPECT_TRUE(mapper.GetMap(&map).ok());
}

TEST(OnlineMapperTest, GivesTheSameLivePosesEachTime) {
  const SimulatedLog& log = OnlineOffice();
  const std::size_t num_scans = log.scans.size() / 2;
  OnlineMapperOptions two_threads;
  two_threads.map.solver.num_threads = 2;
  OnlineMapper first({log.laser}), second({log.laser}, two_threads);
  std::vector<OnlinePose> of_second;
  std::thread other([&] { of_second = MapOnline(log, num_scans, &second); });
  const std::vector<OnlinePose> of_first = MapOnline(log, num_scans, &first);
  other.join();
  for (std::size_t i = 0; i < num_scans; ++i) {
    ASSERT_TRUE(SamePose(of_first[i].map_from_robot, of_second[i].map_from_robot)) << i;
  }
}

TEST(OnlineMapperTest, CallsBackFromFinishOnly) {
  const SimulatedLog& log = OnlineOffice();
  OnlineMapperOptions options;
  int num_calls = 0;
  options.map.solver.callback = [&](const IterationSummary&) {
    ++num_calls;
    return true;
  };
  OnlineMapper mapper({log.laser}, options);
  MapOnline(log, log.scans.size() / 2, &mapper);
  OnlineMap map;
  ASSERT_TRUE(mapper.GetMap(&map).ok());
  EXPECT_GE(map.num_remappings, 1);
  EXPECT_EQ(num_calls, 0);
  LogMapping mapping;
  EXPECT_TRUE(mapper.Finish(&mapping).ok());
  EXPECT_GT(num_calls, 0);
}

TEST(OnlineMapperTest, NamesWhatIsWrongWithAScanAndStaysAsItWas) {
  const SimulatedLog& log = OnlineOffice();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  OnlineMapper mapper({log.laser});
  for (std::size_t i = 0; i < 5; ++i) ASSERT_TRUE(AddScanOfLog(log, i, &mapper).ok());
  const LaserScan scan = log.scans[5].scan;
  const Pose2 odometry = log.scans[5].odom_from_robot;
  const auto refuse = [&](const LaserScan& bad, const Pose2& pose, int laser, const char* why) {
    const Status status = mapper.AddScan(bad, pose, nullptr, laser);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("scan 5: "));
    EXPECT_THAT(status.message(), HasSubstr(why));
  };
  LaserScan bad = scan;
  bad.ranges.pop_back();
  refuse(bad, odometry, 0, "179");
  bad = scan;
  bad.timestamp_s = log.scans[3].scan.timestamp_s;
  refuse(bad, odometry, 0, "before that of the scan before it");
  bad.timestamp_s = kNaN;
  refuse(bad, odometry, 0, "");
  refuse(scan, Pose2(kNaN, 0.0, 0.0), 0, "");
  refuse(scan, Pose2(0.0, 0.0, std::numeric_limits<double>::infinity()), 0, "");
  refuse(scan, odometry * Pose2(50.0, 0.0, 0.0), 0, "the odometry jumps by");
  refuse(scan, odometry, 1, "laser 1 is unknown, there are 1");
  refuse(scan, odometry, -1, "laser -1");
  OnlineMap map;
  ASSERT_TRUE(mapper.GetMap(&map).ok());
  EXPECT_EQ(map.map_from_robot.size(), 5u);
  EXPECT_FALSE(mapper.GetMap(nullptr).ok());
  EXPECT_FALSE(mapper.Finish(static_cast<LogMapping*>(nullptr)).ok());

  OnlinePose now;
  ASSERT_TRUE(AddScanOfLog(log, 5, &mapper, &now).ok());
  OnlineMapper undisturbed({log.laser});
  OnlinePose expected;
  for (std::size_t i = 0; i < 6; ++i) {
    ASSERT_TRUE(AddScanOfLog(log, i, &undisturbed, &expected).ok());
  }
  EXPECT_TRUE(SamePose(now.map_from_robot, expected.map_from_robot));
}

TEST(OnlineMapperTest, RefusesBadOptionsAndLasersWithTheFirstScan) {
  const SimulatedLog& log = OnlineOffice();
  OnlineMapperOptions options;
  options.map.seeding.keyframe_distance_m = -1.0;
  OnlineMapper bad_options({log.laser}, options);
  EXPECT_THAT(AddScanOfLog(log, 0, &bad_options).message(), HasSubstr("keyframe_distance_m"));
  options = OnlineMapperOptions();
  options.min_step_m = -0.1;
  OnlineMapper bad_step({log.laser}, options);
  EXPECT_THAT(AddScanOfLog(log, 0, &bad_step).message(), HasSubstr("min_step_m"));
  LaserModel laser = log.laser;
  laser.num_beams = 0;
  OnlineMapper bad_laser({laser});
  EXPECT_THAT(AddScanOfLog(log, 0, &bad_laser).message(), HasSubstr("num_beams"));
  LogMapping mapping;
  EXPECT_THAT(bad_laser.Finish(&mapping).message(), HasSubstr("no scans"));
  EXPECT_TRUE(bad_laser.Wait().ok());
}

TEST(OnlineMapperTest, PredictsTheStepsOverAResetOfTheOdometry) {
  const SimulatedLog& log = OnlineOffice();
  const std::size_t reset = 30, num_scans = 60;
  OnlineMapper mapper({log.laser});
  OnlinePose now;
  for (std::size_t i = 0; i < num_scans; ++i) {
    std::optional<Pose2> odometry = log.scans[i].odom_from_robot;
    if (i >= reset) odometry = Pose2(100.0, 0.0, 1.0) * *odometry;
    Status status = mapper.AddScan(log.scans[i].scan, odometry, &now);
    if (i == reset) {
      EXPECT_THAT(status.message(), HasSubstr("jumps"));
      status = mapper.AddScan(log.scans[i].scan, std::nullopt, &now);
    }
    ASSERT_TRUE(status.ok()) << status.message();
  }
  EXPECT_LT(ErrorM(log, num_scans - 1, now.map_from_robot), 0.3);
  LogMapping mapping;
  ASSERT_TRUE(mapper.Finish(&mapping).ok());
  ASSERT_EQ(mapping.graph.odometry().size(), num_scans - 1);
  EXPECT_FALSE(mapping.graph.odometry()[reset - 1].is_measured);
  EXPECT_FALSE(mapping.graph.odometry()[reset].is_measured);
  EXPECT_TRUE(mapping.graph.odometry()[reset + 1].is_measured);
}

TEST(OnlineMapperTest, MapsWithoutOdometry) {
  SimulationOptions options;
  options.scan_period_s = 0.2;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  SimulatedLog log;
  ASSERT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 2)), options, &log).ok());
  OnlineMapper mapper({log.laser});
  OnlinePose now;
  constexpr std::size_t kNumScans = 100;
  for (std::size_t i = 0; i < kNumScans; ++i) {
    ASSERT_TRUE(mapper.AddScan(log.scans[i].scan, std::nullopt, &now).ok());
  }
  EXPECT_LT(ErrorM(log, kNumScans - 1, now.map_from_robot), 0.2);
  EXPECT_TRUE(SamePose(now.map_from_odometry, Pose2()));
  LogMapping mapping;
  ASSERT_TRUE(mapper.Finish(&mapping).ok());
  EXPECT_TRUE(mapping.report.seeding.odometry_noise.is_prediction);
}

TEST(OnlineMapperTest, EndsInTheMiddleOfItsWork) {
  const SimulatedLog& log = OnlineOffice();
  { const OnlineMapper unused({log.laser}); }
  for (const std::size_t num_scans : {std::size_t{1}, std::size_t{20}, log.scans.size()}) {
    auto mapper = std::make_unique<OnlineMapper>(std::vector<LaserModel>{log.laser});
    for (std::size_t i = 0; i < num_scans; ++i) {
      ASSERT_TRUE(AddScanOfLog(log, i, mapper.get()).ok());
    }
    mapper.reset();
  }
}

TEST(OnlineMapperTest, MapsTheDriveSoFarAndGoesOn) {
  const SimulatedLog& log = OnlineOffice();
  const std::size_t num_scans = log.scans.size() / 3;
  OnlineMapper mapper({log.laser}), ending({log.laser}), undisturbed({log.laser});
  LogMapping now, end;
  EXPECT_THAT(mapper.MapNow(&now).message(), HasSubstr("no scans"));
  EXPECT_THAT(mapper.MapNow(static_cast<LogMapping*>(nullptr)).message(), HasSubstr("null"));
  for (std::size_t i = 0; i < num_scans; ++i) {
    for (OnlineMapper* each : {&mapper, &ending, &undisturbed}) {
      ASSERT_TRUE(AddScanOfLog(log, i, each).ok());
    }
  }
  // The background of the mapper has not caught up.
  ASSERT_TRUE(mapper.MapNow(&now).ok());
  ASSERT_TRUE(ending.Finish(&end).ok());
  EXPECT_EQ(now.state.poses, end.state.poses);
  EXPECT_EQ(now.state.points, end.state.points);
  ASSERT_TRUE(mapper.Wait().ok());
  ASSERT_TRUE(undisturbed.Wait().ok());
  OnlinePose pose, expected;
  ASSERT_TRUE(AddScanOfLog(log, num_scans, &mapper, &pose).ok());
  ASSERT_TRUE(AddScanOfLog(log, num_scans, &undisturbed, &expected).ok());
  EXPECT_EQ(pose.scan, expected.scan);
  ASSERT_TRUE(mapper.MapNow(&now).ok());
  EXPECT_EQ(now.graph.num_scans(), static_cast<int>(num_scans) + 1);
  ASSERT_TRUE(mapper.Finish(&end).ok());
  EXPECT_EQ(now.state.poses, end.state.poses);
  EXPECT_THAT(mapper.MapNow(&now).message(), HasSubstr("finished already"));
}

TEST(OnlineMapperTest, LeavesOutScansOfARobotThatStands) {
  const SimulatedLog& log = OnlineOffice();
  const std::size_t stop = 40, num_standing = 30, num_scans = 80;
  OnlineMapperOptions options;
  options.min_step_m = 0.05;
  OnlineMapper standing({log.laser}, options), driving({log.laser}, options);
  OnlinePose now, expected;
  for (std::size_t i = 0; i < num_scans; ++i) {
    ASSERT_TRUE(AddScanOfLog(log, i, &driving, &expected).ok());
    ASSERT_TRUE(driving.Wait().ok());
    LaserScan scan = log.scans[i].scan;
    const int num_here = i == stop ? static_cast<int>(num_standing) : 1;
    if (i > stop) scan.timestamp_s += static_cast<double>(num_standing - 1);
    for (int k = 0; k < num_here; ++k) {
      ASSERT_TRUE(standing.AddScan(scan, log.scans[i].odom_from_robot, &now).ok());
      ASSERT_TRUE(standing.Wait().ok());
      EXPECT_LT(ErrorM(log, i, now.map_from_robot), 0.3);
      scan.timestamp_s += 1.0;
    }
  }
  EXPECT_EQ(now.scan, static_cast<int>(num_scans + num_standing) - 2);
  EXPECT_NEAR(now.map_from_robot.x, expected.map_from_robot.x, 0.01);
  EXPECT_NEAR(now.map_from_robot.y, expected.map_from_robot.y, 0.01);
  OnlineMap map;
  ASSERT_TRUE(standing.GetMap(&map).ok());
  ASSERT_EQ(map.map_from_robot.size(), num_scans + num_standing - 1);
  for (std::size_t k = stop; k < stop + num_standing; ++k) {
    EXPECT_NEAR(map.map_from_robot[k].x, map.map_from_robot[stop].x, 0.01);
  }
  LogMapping of_standing, of_driving;
  ASSERT_TRUE(standing.Finish(&of_standing).ok());
  ASSERT_TRUE(driving.Finish(&of_driving).ok());
  EXPECT_EQ(of_standing.graph.num_scans(), of_driving.graph.num_scans());
  EXPECT_LT(of_standing.graph.num_scans(), static_cast<int>(num_scans) + 2);
}

TEST(OnlineMapperTest, GivesMapsToOtherThreads) {
  const SimulatedLog& log = OnlineOffice();
  OnlineMapper mapper({log.laser});
  std::thread reader([&] {
    std::size_t num_seen = 0;
    while (num_seen < log.scans.size()) {
      OnlineMap map;
      ASSERT_TRUE(mapper.GetMap(&map).ok());
      ASSERT_GE(map.map_from_robot.size(), num_seen);
      num_seen = map.map_from_robot.size();
    }
  });
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    ASSERT_TRUE(AddScanOfLog(log, i, &mapper).ok());
  }
  reader.join();
  EXPECT_TRUE(mapper.Wait().ok());
}

}  // namespace
}  // namespace plumbline
