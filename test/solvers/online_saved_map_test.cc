#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/solvers/map_sessions.h"
#include "plumbline/solvers/online_mapper.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// Two of the buildings with the shortest drives.
constexpr std::uint64_t kHome = 43, kElsewhere = 34;

SimulatedLog DriveThrough(std::uint64_t building, std::uint64_t visit) {
  SimulationOptions options;
  options.seed = 10 * building + visit;
  options.scan_period_s = 0.5;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  SimulatedLog log;
  EXPECT_TRUE(
      Simulate(World(GenerateVisit(BuildingKind::kRandom, building, visit)), options, &log).ok());
  return log;
}

const SimulatedLog& FirstDrive() {
  static const auto* log = new SimulatedLog(DriveThrough(kHome, 0));
  return *log;
}

const SimulatedLog& SecondDrive() {
  static const auto* log = new SimulatedLog(DriveThrough(kHome, 1));
  return *log;
}

// The map of the first drive, as a program saves it.
SlamGraph MapOfFirstDrive(bool is_fixed) {
  static const LogMapping* mapping = [] {
    SlamGraph graph;
    EXPECT_TRUE(MakeGraph(FirstDrive(), &graph).ok());
    auto* result = new LogMapping;
    EXPECT_TRUE(MapLog(MapLogOptions(), std::move(graph), {}, result).ok());
    return result;
  }();
  const std::vector<Pose2> poses = PosesOf(mapping->state.poses);
  SlamGraph map;
  for (int pose = 0; pose < mapping->graph.num_poses(); ++pose) {
    map.AddPose(poses[pose], mapping->graph.timestamp_s(pose));
    if (is_fixed) map.FixPose(pose);
  }
  for (int scan = 0; scan < mapping->graph.num_scans(); ++scan) {
    map.AddScanOf(mapping->graph, scan, mapping->graph.scan(scan).pose);
  }
  for (const OdometryConstraint& step : mapping->graph.odometry()) map.AddOdometry(step);
  EXPECT_TRUE(map.status().ok()) << map.status().message();
  return map;
}

Pose2 TruthInMap(const SimulatedScan& scan) {
  return Between(FirstDrive().scans[0].world_from_robot, scan.world_from_robot);
}

struct LiveErrors {
  int first_in_map = -1;  // scan
  double path_m = 0.0;    // until the robot is in the map
  double sum_squares = 0.0, worst_m = 0.0;
  int num_in_map = 0;
  bool was_lost = false;

  double RmsM() const { return std::sqrt(sum_squares / num_in_map); }
};

// Adds scans [begin, end) of a drive, with a background that keeps up.
void Follow(const SimulatedLog& log, std::size_t begin, std::size_t end, OnlineMapper* mapper,
            LiveErrors* errors) {
  for (std::size_t i = begin; i < end; ++i) {
    OnlinePose now;
    const Status status = mapper->AddScan(log.scans[i].scan, log.scans[i].odom_from_robot, &now);
    ASSERT_TRUE(status.ok()) << status.message();
    ASSERT_TRUE(mapper->Wait().ok());
    if (errors->num_in_map == 0 && i > begin) {
      errors->path_m += Between(log.scans[i - 1].world_from_robot, log.scans[i].world_from_robot)
                            .translation()
                            .norm();
    }
    if (!now.is_in_map) {
      if (errors->num_in_map > 0) errors->was_lost = true;
      continue;
    }
    const double error_m =
        Between(TruthInMap(log.scans[i]), now.map_from_robot).translation().norm();
    errors->sum_squares += error_m * error_m;
    errors->worst_m = std::max(errors->worst_m, error_m);
    ++errors->num_in_map;
  }
}

SlamGraph GraphOfDrive(const SimulatedLog& log) {
  SlamGraph graph;
  EXPECT_TRUE(MakeGraph(log, &graph).ok());
  return graph;
}

TEST(OnlineSavedMapTest, IsLocalisedFromNothingAndFinishesAsMapSessions) {
  const SimulatedLog& drive = SecondDrive();
  OnlineMapper mapper({drive.laser}, OnlineMapperOptions(), {MapOfFirstDrive(true), std::nullopt});
  LiveErrors errors;
  Follow(drive, 0, drive.scans.size(), &mapper, &errors);
  ASSERT_GT(errors.num_in_map, 0);
  EXPECT_FALSE(errors.was_lost);
  EXPECT_LT(errors.path_m, 20.0);
  EXPECT_LT(errors.RmsM(), 0.03);
  EXPECT_LT(errors.worst_m, 0.1);
  OnlineMap map;
  ASSERT_TRUE(mapper.GetMap(&map).ok());
  EXPECT_TRUE(map.is_in_map);
  ASSERT_EQ(map.map_from_robot.size(), drive.scans.size());
  SessionsMapping online, batch;
  ASSERT_TRUE(mapper.Finish(&online).ok());
  ASSERT_TRUE(
      MapSessions(MapLogOptions(), {MapOfFirstDrive(true), GraphOfDrive(drive)}, {}, &batch).ok());
  ASSERT_EQ(online.maps.size(), 1u);
  ASSERT_EQ(batch.maps.size(), 1u);
  EXPECT_EQ(online.maps[0].mapping.state.poses, batch.maps[0].mapping.state.poses);
  EXPECT_EQ(online.maps[0].mapping.state.points, batch.maps[0].mapping.state.points);
}

TEST(OnlineSavedMapTest, ContinuesAMapFromAGivenPlace) {
  const SimulatedLog& drive = SecondDrive();
  const Pose2 roughly = TruthInMap(drive.scans[0]) * Pose2(0.3, -0.2, 0.1);
  OnlineMapper mapper({drive.laser}, OnlineMapperOptions(), {MapOfFirstDrive(false), roughly});
  LiveErrors errors;
  Follow(drive, 0, 3, &mapper, &errors);
  EXPECT_GT(errors.num_in_map, 0);
  errors = LiveErrors();
  Follow(drive, 20, drive.scans.size(), &mapper, &errors);
  EXPECT_FALSE(errors.was_lost);
  EXPECT_LT(errors.RmsM(), 0.03);
  EXPECT_LT(errors.worst_m, 0.2);
}

TEST(OnlineSavedMapTest, IsNotPlacedInAnotherBuilding) {
  const SimulatedLog drive = DriveThrough(kElsewhere, 0);
  OnlineMapper mapper({drive.laser}, OnlineMapperOptions(), {MapOfFirstDrive(true), std::nullopt});
  LiveErrors errors;
  Follow(drive, 0, drive.scans.size(), &mapper, &errors);
  EXPECT_EQ(errors.num_in_map, 0);
  OnlineMap map;
  ASSERT_TRUE(mapper.GetMap(&map).ok());
  EXPECT_FALSE(map.is_in_map);
  SessionsMapping mapping;
  ASSERT_TRUE(mapper.MapNow(&mapping).ok());
  EXPECT_EQ(mapping.maps.size(), 2u);
}

TEST(OnlineSavedMapTest, NamesWhatIsWrongWithTheMapAtTheFirstScan) {
  const SimulatedLog& drive = SecondDrive();
  const auto message = [&](SavedMap map, const OnlineMapperOptions& options) {
    OnlineMapper mapper({drive.laser}, options, std::move(map));
    return mapper.AddScan(drive.scans[0].scan, drive.scans[0].odom_from_robot, nullptr).message();
  };
  const OnlineMapperOptions options;
  EXPECT_THAT(message({SlamGraph(), std::nullopt}, options), HasSubstr("has no scan"));
  SlamGraph partly_fixed = MapOfFirstDrive(false);
  partly_fixed.FixPose(1);
  EXPECT_THAT(message({partly_fixed, std::nullopt}, options), HasSubstr("others are not"));
  const Pose2 nowhere(std::nan(""), 0.0, 0.0);
  EXPECT_FALSE(message({MapOfFirstDrive(true), nowhere}, options).empty());
  OnlineMapperOptions forgetful;
  forgetful.keeps_scans = false;
  EXPECT_THAT(message({MapOfFirstDrive(false), std::nullopt}, forgetful), HasSubstr("kept"));
  OnlineMapper without({drive.laser});
  SessionsMapping mapping;
  EXPECT_THAT(without.Finish(&mapping).message(), HasSubstr("no saved map"));
}

TEST(OnlineSavedMapTest, FindsAKidnappedRobotAgain) {
  const SimulatedLog& drive = SecondDrive();
  OnlineMapperOptions options;
  options.keeps_scans = false;
  OnlineMapper mapper({drive.laser}, options, {MapOfFirstDrive(true), TruthInMap(drive.scans[0])});
  const std::size_t half = drive.scans.size() / 2;
  LiveErrors before, after;
  Follow(drive, 0, half / 2, &mapper, &before);
  EXPECT_FALSE(before.was_lost);
  EXPECT_LT(before.RmsM(), 0.03);
  // Carried to where the second half begins; the odometry does not notice.
  SimulatedLog carried = drive;
  const Pose2 odometry_from_there =
      drive.scans[half / 2].odom_from_robot * drive.scans[half].odom_from_robot.Inverse();
  for (std::size_t i = half; i < carried.scans.size(); ++i) {
    carried.scans[i].odom_from_robot = odometry_from_there * carried.scans[i].odom_from_robot;
  }
  Follow(carried, half, carried.scans.size(), &mapper, &after);
  ASSERT_GT(after.num_in_map, 0);
  EXPECT_FALSE(after.was_lost);
  EXPECT_LT(after.path_m, 20.0);
  EXPECT_LT(after.RmsM(), 0.03);
  OnlineMap map;
  ASSERT_TRUE(mapper.GetMap(&map).ok());
  EXPECT_EQ(map.map_from_robot.size(), half / 2 + carried.scans.size() - half);
  SessionsMapping mapping;
  EXPECT_THAT(mapper.Finish(&mapping).message(), HasSubstr("not kept"));
}

}  // namespace
}  // namespace plumbline
