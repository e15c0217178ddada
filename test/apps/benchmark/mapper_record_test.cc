#include "plumbline/apps/benchmark/mapper_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/test/apps/room_as_g2o.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// Mean error [m] in the text for people.
double MeanOf(const std::string& errors) { return std::stod(errors.substr(errors.find(':') + 1)); }

TEST(MapperRecordTest, ASimulatedMapperClosesLoops) {
  MapperRecord record;
  ASSERT_TRUE(SimulateMapper(&record).ok());
  ASSERT_EQ(record.truth.size(), static_cast<std::size_t>(record.graph.num_poses()));
  EXPECT_EQ(record.graph.num_scans(), record.graph.num_poses());
  EXPECT_GT(record.graph.relative_poses().size(), record.truth.size());
  EXPECT_THAT(MapperErrors(record, record.truth), StartsWith("nodes:     0.0000"));
  std::vector<Pose2> bent = record.truth;
  for (std::size_t i = bent.size() / 2; i < bent.size(); ++i) bent[i].x += 1.0;
  EXPECT_NEAR(MeanOf(MapperErrors(record, bent)), 0.5, 0.2);
}

TEST(MapperRecordTest, OdometryLeadsFromNodeToNode) {
  CarmenLog log;
  for (int i = 0; i < 6; ++i) {
    CarmenScan scan;
    scan.timestamp_s = i;
    scan.odom_from_robot = {0.1 * i, 0.0, 0.0};
    log.scans.push_back(scan);
  }
  // The map is turned against the odometry, and corrected at the second node.
  const std::vector<TimedPose> nodes = {{1.0, {0.0, 0.0, 0.5 * kPi}}, {4.0, {7.0, 0.0, 0.0}}};
  const std::vector<TimedPose> moved = MovedAlongOdometry(nodes, log);
  ASSERT_EQ(moved.size(), 5u);
  EXPECT_EQ(moved[0].timestamp_s, 1.0);
  EXPECT_NEAR(moved[2].world_from_robot.x, 0.0, 1e-12);
  EXPECT_NEAR(moved[2].world_from_robot.y, 0.2, 1e-12);
  EXPECT_NEAR(moved[3].world_from_robot.x, 7.0, 1e-12);
  EXPECT_NEAR(moved[4].world_from_robot.x, 7.1, 1e-12);
  EXPECT_TRUE(MovedAlongOdometry({}, log).empty());
}

TEST(MapperRecordTest, RelationsMeasureAllScansOfTheLog) {
  const NoisyRoom room = MakeNoisyRoom();
  const std::string graph = TempFolder() + "room.g2o";
  WriteFile(graph, AsG2o(room));
  MapperRecord record;
  ASSERT_TRUE(ReadMapper(graph, "", "", &record).ok());
  EXPECT_EQ(record.graph.num_poses(), static_cast<int>(room.truth.size()));
  EXPECT_THAT(MapperErrors(record, room.truth), IsEmpty());
  // A log whose odometry is right, with a scan in the middle between two nodes.
  for (std::size_t i = 0; i < room.truth.size(); ++i) {
    CarmenScan scan;
    scan.timestamp_s = 100.0 + i;
    scan.odom_from_robot = room.truth[i];
    record.log.scans.push_back(scan);
    scan.timestamp_s += 0.5;
    scan.odom_from_robot = room.truth[i] * Pose2(0.1, 0.0, 0.0);
    record.log.scans.push_back(scan);
  }
  record.relations = {{100.5, 103.0, Between(room.truth[0] * Pose2(0.1, 0.0, 0.0), room.truth[3])}};
  const std::string exact = MapperErrors(record, room.truth);
  EXPECT_THAT(exact, StartsWith("relations: 0.0000"));
  EXPECT_THAT(exact, HasSubstr("(1)"));
  std::vector<Pose2> moved = room.truth;
  moved[3] = moved[3] * Pose2(0.2, 0.0, 0.0);
  EXPECT_NEAR(MeanOf(MapperErrors(record, moved)), 0.2, 1e-4);
  EXPECT_FALSE(ReadMapper(graph + "none", "", "", &record).ok());
  EXPECT_FALSE(ReadMapper(graph, graph + "none", "", &record).ok());
  EXPECT_FALSE(ReadMapper(graph, "", graph + "none", &record).ok());
}

}  // namespace
}  // namespace plumbline
