#include "plumbline/apps/io/pose_graph_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/test/core/initial_guesses.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A scan of three beams by a laser 0.2 m ahead of its robot.
const char kLaser[] =
    "ROBOTLASER1 0 -1.047198 2.094395 1.047198 30 0.01 0 3 1 2.50 3 0 5.2 6 0 5 6 0 0 0 0 0 0 8.5 "
    "host 0\n";

// Ids out of order, blanks and digits that no number would be printed with, a yaw beyond pi.
const std::string kG2o = std::string("PARAMS_SE2OFFSET 0 0 0 0\n") +
                         "VERTEX_SE2 100 1.50 2e0 3.5\n" + kLaser + "# comment\n" +
                         "VERTEX_SE2 -7 1000000.125 5 -3\n" + "FIX -7\n" +
                         "EDGE_SE2 -7 100 1.5 -0.50 0.25 4 1 0.5 9 -1.00 16\n";
const std::string kToro = std::string("PARAMS_SE2OFFSET 0 0 0 0\n") + "VERTEX2 100 1.50 2e0 3.5\n" +
                          kLaser + "# comment\n" + "VERTEX2 -7 1000000.125 5 -3\n" + "FIX -7\n" +
                          "EDGE2 -7 100 1.5 -0.50 0.25 4 1 9 16 0.5 -1.00\n";

class PoseGraphWriterTest : public testing::Test {
 protected:
  PoseGraphFile Read(const std::string& name) const {
    PoseGraphFile file;
    const Status status = ReadPoseGraphFile(folder_ + name, &file);
    EXPECT_TRUE(status.ok()) << status.message();
    return file;
  }
  // With the poses as they were read.
  Status Write(const std::string& name, PoseGraphFormat format, const PoseGraphFile& file) const {
    return WritePoseGraphFile(folder_ + name, format, file, file.graph.initial_poses());
  }
  // The graph through a file and back.
  SlamGraph Through(const SlamGraph& graph, PoseGraphFormat format = PoseGraphFormat::kG2o) const {
    PoseGraphFile file;
    Status status = MakePoseGraphFile(graph, MotionOptions(), &file);
    EXPECT_TRUE(status.ok()) << status.message();
    status = WritePoseGraphFile(folder_ + "a", format, file, graph.initial_poses());
    EXPECT_TRUE(status.ok()) << status.message();
    return Read("a").graph;
  }

  const std::string folder_ = TempFolder();
};

void ExpectSameScans(const SlamGraph& a, const SlamGraph& b) {
  ASSERT_EQ(a.num_scans(), b.num_scans());
  EXPECT_EQ(a.returns().range_m, b.returns().range_m);
  EXPECT_EQ(a.Bearings(), b.Bearings());
  EXPECT_EQ(a.Beams(), b.Beams());
  EXPECT_EQ(a.ScansOfReturns(), b.ScansOfReturns());
  ASSERT_EQ(a.num_lasers(), b.num_lasers());
  for (int s = 0; s < a.num_scans(); ++s) {
    EXPECT_EQ(a.scan(s).pose, b.scan(s).pose);
    const LaserModel &one = a.LaserOfScan(s), &other = b.LaserOfScan(s);
    EXPECT_EQ(one.num_beams, other.num_beams);
    EXPECT_EQ(one.first_bearing_rad, other.first_bearing_rad);
    EXPECT_EQ(one.bearing_step_rad, other.bearing_step_rad);
    EXPECT_EQ(one.max_range_m, other.max_range_m);
  }
}

void ExpectSameMounting(const SlamGraph& a, const SlamGraph& b, double tolerance) {
  const Pose2 one = a.laser(0).robot_from_laser, other = b.laser(0).robot_from_laser;
  EXPECT_NEAR(one.x, other.x, tolerance);
  EXPECT_NEAR(one.y, other.y, tolerance);
  EXPECT_NEAR(one.yaw, other.yaw, tolerance);
}

TEST_F(PoseGraphWriterTest, WritesThePosesAndLeavesTheRest) {
  WriteFile(folder_ + "a.g2o", kG2o);
  const PoseGraphFile file = Read("a.g2o");
  ASSERT_TRUE(Write("b.g2o", PoseGraphFormat::kG2o, file).ok());
  EXPECT_EQ(ReadFile(folder_ + "b.g2o"), kG2o);

  const std::vector<double> poses = {1.0 / 3.0, -1e-17, 3.0, 1e6 + 0.1, 2.0, 0.5 + 4.0 * kPi};
  ASSERT_TRUE(WritePoseGraphFile(folder_ + "b.g2o", PoseGraphFormat::kG2o, file, poses).ok());
  std::string expected = kG2o;
  expected.replace(expected.find("1.50 2e0 3.5"), 12, "0.3333333333333333 -1e-17 3");
  expected.replace(expected.find("1000000.125 5 -3"), 16, "1000000.1 2 0.5");
  EXPECT_EQ(ReadFile(folder_ + "b.g2o"), expected);
  const PoseGraphFile again = Read("b.g2o");
  EXPECT_EQ(again.graph.initial_poses()[0], 1.0 / 3.0);
  EXPECT_EQ(again.graph.initial_poses()[1], -1e-17);
  EXPECT_EQ(again.graph.initial_poses()[3], 1e6 + 0.1);
}

TEST_F(PoseGraphWriterTest, FormatsTranslateWordByWord) {
  WriteFile(folder_ + "a.g2o", kG2o);
  ASSERT_TRUE(Write("b.toro", PoseGraphFormat::kToro, Read("a.g2o")).ok());
  EXPECT_EQ(ReadFile(folder_ + "b.toro"), kToro);
  ASSERT_TRUE(Write("c.g2o", PoseGraphFormat::kG2o, Read("b.toro")).ok());
  EXPECT_EQ(ReadFile(folder_ + "c.g2o"), kG2o);
  EXPECT_EQ(Read("b.toro").graph.relative_poses()[0].covariance,
            Read("a.g2o").graph.relative_poses()[0].covariance);
}

TEST_F(PoseGraphWriterTest, AGraphComesBackAsItWas) {
  const SlamGraph graph = MakeNoisyRoom().graph;
  for (const PoseGraphFormat format : {PoseGraphFormat::kG2o, PoseGraphFormat::kToro}) {
    const SlamGraph back = Through(graph, format);
    EXPECT_EQ(back.initial_poses(), graph.initial_poses());
    ExpectSameScans(graph, back);
    ExpectSameMounting(graph, back, 1e-12);
    for (int pose = 0; pose < graph.num_poses(); ++pose) {
      EXPECT_EQ(back.timestamp_s(pose), graph.timestamp_s(pose));
    }
    ASSERT_EQ(back.fixed_poses().size(), 1u);
    EXPECT_EQ(back.fixed_poses()[0].pose, 0);
    std::vector<RelativePoseConstraint> expected;
    for (const OdometryConstraint& c : graph.odometry()) {
      expected.push_back(
          {c.from, c.to, c.from_from_to, MotionCovariance(c.from_from_to, MotionOptions())});
    }
    expected.insert(expected.end(), graph.relative_poses().begin(), graph.relative_poses().end());
    ASSERT_EQ(back.relative_poses().size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const RelativePoseConstraint& edge = back.relative_poses()[i];
      EXPECT_EQ(edge.from, expected[i].from);
      EXPECT_EQ(edge.to, expected[i].to);
      EXPECT_EQ(edge.from_from_to.x, expected[i].from_from_to.x);
      EXPECT_EQ(edge.from_from_to.y, expected[i].from_from_to.y);
      EXPECT_EQ(edge.from_from_to.yaw, expected[i].from_from_to.yaw);
      EXPECT_TRUE(edge.covariance.isApprox(expected[i].covariance, 1e-10)) << i;
    }
  }
}

TEST_F(PoseGraphWriterTest, FixedPosesAndLargeCoordinatesSurvive) {
  const NoisyRoom room = MakeNoisyRoom();
  std::vector<Pose2> poses;
  for (const Pose2& pose : room.truth) poses.push_back(Pose2(4.5e6 + 0.1, -5.5e5, 0.3) * pose);
  SlamGraph graph = WithInitialPoses(room.graph, poses);
  graph.FixPose(4);
  graph.FixPose(2);
  const SlamGraph back = Through(graph);
  EXPECT_EQ(back.initial_poses(), graph.initial_poses());
  ExpectSameScans(graph, back);
  ExpectSameMounting(graph, back, 1e-8);  // the records hold it as a difference of poses
  ASSERT_EQ(back.fixed_poses().size(), 2u);
  EXPECT_EQ(back.fixed_poses()[0].pose, 4);
  EXPECT_EQ(back.fixed_poses()[1].pose, 2);
}

TEST_F(PoseGraphWriterTest, BeamsWithoutReturnStayWithoutAndNoOthersJoinThem) {
  SlamGraph graph;
  LaserModel laser = PanoramicLaser(40);
  laser.max_range_m = 30.0;
  const int laser_id = graph.AddLaser(laser);
  const int pose_id = graph.AddPose(Pose2(), 976052857.25);
  std::vector<double> ranges(40, std::numeric_limits<double>::quiet_NaN());
  for (int beam = 0; beam < 5; ++beam) ranges[2 * beam] = 29.999;  // just short of the maximum
  ranges[3] = 0.01;                                                // too near
  ranges[7] = 12.5;
  graph.AddScan(pose_id, laser_id, ranges);
  ASSERT_EQ(graph.num_returns(), 6u);
  const SlamGraph back = Through(graph);
  ExpectSameScans(graph, back);
  EXPECT_EQ(back.timestamp_s(0), 976052857.25);
}

TEST_F(PoseGraphWriterTest, AScanWithoutAnyReturnKeepsTheTime) {
  SlamGraph graph;
  const int laser_id = graph.AddLaser(PanoramicLaser(40));
  const int pose_id = graph.AddPose(Pose2(), 12.5);
  graph.AddScan(pose_id, laser_id, std::vector<double>(40, 0.0));
  const SlamGraph back = Through(graph);
  EXPECT_EQ(back.num_scans(), 1);
  EXPECT_EQ(back.num_returns(), 0u);
  EXPECT_EQ(back.timestamp_s(0), 12.5);
}

TEST_F(PoseGraphWriterTest, BeamsThatRunClockwiseAreTurnedRound) {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = 3;
  laser.first_bearing_rad = 1.0;
  laser.bearing_step_rad = -0.5;
  const int laser_id = graph.AddLaser(laser);
  laser.num_beams = 1;
  laser.bearing_step_rad = 0.0;
  const int single_id = graph.AddLaser(laser);
  const int pose_id = graph.AddPose(Pose2(1, 2, 0.5), 0.0);
  graph.AddScan(pose_id, laser_id, {1.0, 2.0, 3.0});
  graph.AddScan(pose_id, single_id, {4.0});
  const SlamGraph back = Through(graph);
  EXPECT_THAT(back.returns().range_m, testing::ElementsAre(3.0, 2.0, 1.0, 4.0));
  EXPECT_THAT(back.Bearings(), testing::ElementsAre(0.0, 0.5, 1.0, 1.0));
  const MapState before = graph.InitialState(), after = back.InitialState();
  EXPECT_NEAR(MapPoint(after, 0).x(), MapPoint(before, 2).x(), 1e-12);
  EXPECT_NEAR(MapPoint(after, 3).y(), MapPoint(before, 3).y(), 1e-12);
}

TEST_F(PoseGraphWriterTest, PointsOffTheBeamsAreRefused) {
  SlamGraph graph;
  const int laser_id = graph.AddLaser(PanoramicLaser(4));
  const int pose_id = graph.AddPose(Pose2(), 0.0);
  graph.AddPoints(pose_id, laser_id, {{1.0, 0.0}, {0.0, 2.0}});
  PoseGraphFile file;
  EXPECT_TRUE(MakePoseGraphFile(graph, MotionOptions(), &file).ok());
  const std::size_t num_lines = file.lines.size();
  graph.AddPoints(pose_id, laser_id, {{1.0, 0.1}});
  const Status off = MakePoseGraphFile(graph, MotionOptions(), &file);
  EXPECT_EQ(off.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(off.message(), HasSubstr("scan 1, beam 2: "));
  EXPECT_EQ(file.lines.size(), num_lines);  // untouched

  SlamGraph twice;
  twice.AddPoints(twice.AddPose(Pose2(), 0.0), twice.AddLaser(PanoramicLaser(4)),
                  {{1.0, 0.0}, {2.0, 0.0}});
  EXPECT_THAT(MakePoseGraphFile(twice, MotionOptions(), &file).message(),
              HasSubstr("scan 0, beam 2: "));
}

TEST_F(PoseGraphWriterTest, ARealLogComesBackAsItWas) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "PLUMBLINE_DATASETS is not set";
  CarmenLog log;
  ASSERT_TRUE(ReadCarmenLog(DatasetsFolder() + "/fr079.clf.gz", CarmenReadOptions(), &log).ok());
  log.scans.resize(1000);
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(log, 0, &graph).ok());
  const SlamGraph back = Through(graph);
  EXPECT_EQ(back.initial_poses(), graph.initial_poses());
  ExpectSameScans(graph, back);
  ExpectSameMounting(graph, back, 1e-12);
}

// Over and over the scans of a room, with other poses than those it starts from.
struct LongDrive {
  SlamGraph graph;
  std::vector<double> poses;
};

LongDrive MakeLongDrive() {
  const SlamGraph room = MakeNoisyRoom().graph;
  LongDrive drive;
  for (int i = 0; i < 1100; ++i) {
    const int pose = drive.graph.AddPose(Pose2(0.1 * i, 0.0, 3.0), i);
    drive.graph.AddScanOf(room, i % room.num_scans(), pose);
    if (i == 0) continue;
    drive.graph.AddOdometry({i - 1, i, Pose2(0.1, 0.0, 0.0)});
  }
  drive.poses = drive.graph.initial_poses();
  for (std::size_t i = 0; i < drive.poses.size(); i += 6) drive.poses[i + 2] += 0.5;
  return drive;
}

TEST_F(PoseGraphWriterTest, WritesLineByLineWhatTheTextOfAllIs) {
  const LongDrive drive = MakeLongDrive();
  PoseGraphFile file;
  ASSERT_TRUE(MakePoseGraphFile(drive.graph, MotionOptions(), &file).ok());
  ASSERT_TRUE(WritePoseGraphFile(folder_ + "all", PoseGraphFormat::kG2o, file, drive.poses).ok());
  const std::string all = ReadFile(folder_ + "all");
  const auto write = [&](const std::string& name, const SlamGraph& graph,
                         const std::vector<RelativePoseConstraint>& more_edges) {
    return WritePoseGraph(folder_ + name, graph, MotionOptions(), more_edges, drive.poses);
  };
  ASSERT_TRUE(write("lines", drive.graph, {}).ok());
  EXPECT_TRUE(ReadFile(folder_ + "lines") == all);
  ASSERT_TRUE(write("edges", drive.graph, {{0, 2, Pose2(0.2, 0.0, 0.0)}}).ok());
  const std::string with_edge = ReadFile(folder_ + "edges");
  EXPECT_TRUE(with_edge.substr(0, all.size()) == all);
  EXPECT_THAT(with_edge.substr(all.size()), HasSubstr("EDGE_SE2 0 2 0.2 0 0 1 "));
  RunOnParts(drive.graph, 3, [&](const SlamGraph& part) {
    EXPECT_LT(part.num_scans(), drive.graph.num_scans());
    EXPECT_TRUE(write("parts", part, {}).ok());
  });
  EXPECT_TRUE(ReadFile(folder_ + "parts") == all);
}

TEST_F(PoseGraphWriterTest, AScanThatOneProcessCannotWriteEndsThemAll) {
  LongDrive drive = MakeLongDrive();
  const int laser = drive.graph.AddLaser(PanoramicLaser(4));
  const int num_scans = drive.graph.num_scans();
  drive.graph.AddPoints(900, laser, {{1.0, 0.1}});
  RunOnParts(drive.graph, 2, [&](const SlamGraph& part) {
    const Status status = WritePoseGraph(folder_ + "a.g2o", part, MotionOptions(), {}, drive.poses);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("scan " + std::to_string(num_scans) + ", beam "));
  });
  EXPECT_EQ(NumFilesIn(folder_), 0);
}

TEST_F(PoseGraphWriterTest, LeavesNothingWhereItCannotWrite) {
  WriteFile(folder_ + "a.g2o", kG2o);
  const Status status = Write("none/b.g2o", PoseGraphFormat::kG2o, Read("a.g2o"));
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("none/b.g2o"));
  EXPECT_EQ(NumFilesIn(folder_), 1);
}

}  // namespace
}  // namespace plumbline
