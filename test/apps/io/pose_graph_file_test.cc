#include "plumbline/apps/io/pose_graph_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/LU>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const char kUnit[] = " 1 0 0 1 0 1\n";  // information in g2o's order

// A scan of three beams of 60 deg about straight ahead, by a laser 0.2 m ahead of its robot.
std::string Laser(const std::string& ranges, const std::string& time) {
  return "ROBOTLASER1 0 -1.047198 2.094395 1.047198 30 0.01 0 3 " + ranges +
         " 0 5.2 6 0 5 6 0 0 0 0 0 0 " + time + " host 0\n";
}

class PoseGraphFileTest : public testing::Test {
 protected:
  Status Read(const std::string& content) {
    WriteFile(path_, content);
    return ReadPoseGraphFile(path_, &file_);
  }
  void ExpectError(const std::string& content, const std::string& message) {
    const Status status = Read(content);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << content;
    EXPECT_THAT(status.message(), HasSubstr(path_ + message));
    EXPECT_TRUE(file_.lines.empty());  // untouched
  }

  const std::string folder_ = TempFolder();
  const std::string path_ = folder_ + "a.g2o";
  PoseGraphFile file_;
};

TEST_F(PoseGraphFileTest, TakesNoMoreMemoryThanAllowed) {
  std::string content = "VERTEX_SE2 0 0 0 0\n";
  for (int i = 0; i < 1000; ++i) content += Laser("1 2 3", "10");
  WriteFile(path_, content);
  EXPECT_THAT(ReadPoseGraphFile(path_, &file_, 2e4).message(), HasSubstr("takes more memory"));
  EXPECT_TRUE(file_.lines.empty());
  EXPECT_TRUE(ReadPoseGraphFile(path_, &file_, 1e6).ok());
}

TEST_F(PoseGraphFileTest, ReadsG2o) {
  const Status status = Read(
      "# a comment\n\nPARAMS_SE2OFFSET 0 0 0 0\n"
      "EDGE_SE2 -7 100 1.5 -0.5 0.25 4 1 0.5 9 -1 16\r\n"
      "VERTEX_SE2 100 1 2 3\nVERTEX_SE2 -7 4 5 -3\nFIX -7\n");
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(file_.format, PoseGraphFormat::kG2o);
  EXPECT_THAT(file_.vertex_ids, ElementsAre(100, -7));
  EXPECT_THAT(file_.graph.initial_poses(), ElementsAre(1, 2, 3, 4, 5, -3));
  EXPECT_EQ(file_.graph.timestamp_s(1), 1.0);
  ASSERT_EQ(file_.graph.relative_poses().size(), 1u);
  const RelativePoseConstraint& edge = file_.graph.relative_poses()[0];
  EXPECT_EQ(edge.from, 1);
  EXPECT_EQ(edge.to, 0);
  EXPECT_EQ(edge.from_from_to.y, -0.5);
  EXPECT_EQ(edge.from_from_to.yaw, 0.25);
  Eigen::Matrix3d information;
  information << 4, 1, 0.5, 1, 9, -1, 0.5, -1, 16;
  EXPECT_TRUE((edge.covariance * RotateAxes(information, 0.25)).isIdentity(1e-12));
  ASSERT_EQ(file_.graph.fixed_poses().size(), 1u);
  EXPECT_EQ(file_.graph.fixed_poses()[0].pose, 1);
}

TEST_F(PoseGraphFileTest, ReadsToro) {
  ASSERT_TRUE(
      Read("VERTEX2 0 1 2 3\nVERTEX2 1 4 5 -3\nEDGE2 0 1 1.5 -0.5 0.25 4 1 9 16 0.5 -1\n").ok());
  EXPECT_EQ(file_.format, PoseGraphFormat::kToro);
  Eigen::Matrix3d information;
  information << 4, 1, 0.5, 1, 9, -1, 0.5, -1, 16;
  const Eigen::Matrix3d& covariance = file_.graph.relative_poses().at(0).covariance;
  EXPECT_TRUE((covariance * RotateAxes(information, 0.25)).isIdentity(1e-12));
  EXPECT_EQ(file_.graph.fixed_poses().at(0).pose, 0);
}

// g2o's error is Z^-1 (X_from^-1 X_to).
TEST_F(PoseGraphFileTest, AnErrorWeighsWhatItWeighsInG2o) {
  ASSERT_TRUE(Read("VERTEX_SE2 0 1 2 3\nVERTEX_SE2 1 1.3 4 -1.5\n"
                   "EDGE_SE2 0 1 -2 -0.3 1.6 100 2 5 4 -1 16\n")
                  .ok());
  const RelativePoseConstraint& edge = file_.graph.relative_poses().at(0);
  const Pose2 actual = Between(file_.graph.InitialPose(0), file_.graph.InitialPose(1));
  const Pose2 in_g2o = Between(edge.from_from_to, actual);
  Eigen::Matrix3d information;
  information << 100, 2, 5, 2, 4, -1, 5, -1, 16;
  const Eigen::Vector3d expected(in_g2o.x, in_g2o.y, NormalizeAngle(in_g2o.yaw));
  const Eigen::Vector3d error(actual.x - edge.from_from_to.x, actual.y - edge.from_from_to.y,
                              NormalizeAngle(actual.yaw - edge.from_from_to.yaw));
  const double chi2 = expected.dot(information * expected);
  EXPECT_NEAR(error.dot(edge.covariance.inverse() * error), chi2, 1e-9 * chi2);
}

TEST_F(PoseGraphFileTest, ScansBelongToTheVertexBeforeThem) {
  const Status status = Read("VERTEX_SE2 3 0 0 0\nVERTEX_SE2 5 1 0 0\n" + Laser("1 2 30", "8.5") +
                             "VERTEX_SE2 4 2 0 0\n" + Laser("1 1 1", "7.5") + Laser("2 2 2", "7") +
                             "EDGE_SE2 3 5 1 0 0" + kUnit + "EDGE_SE2 5 4 1 0 0" + kUnit);
  ASSERT_TRUE(status.ok()) << status.message();
  const SlamGraph& graph = file_.graph;
  ASSERT_EQ(graph.num_scans(), 3);
  EXPECT_EQ(graph.scan(0).pose, 1);
  EXPECT_EQ(graph.scan(0).num_returns, 2u);  // 30 m is the maximum range
  EXPECT_EQ(graph.scan(1).pose, 2);
  EXPECT_EQ(graph.scan(2).pose, 2);
  EXPECT_THAT(graph.returns().range_m, ElementsAre(1, 2, 1, 1, 1, 2, 2, 2));
  EXPECT_NEAR(graph.Bearing(0), -kPi / 3.0, 1e-6);
  EXPECT_NEAR(graph.LaserOfScan(0).robot_from_laser.x, 0.2, 1e-12);
  EXPECT_NEAR(graph.LaserOfScan(0).robot_from_laser.y, 0.0, 1e-12);
  EXPECT_EQ(graph.timestamp_s(0), 0.0);  // its index
  EXPECT_EQ(graph.timestamp_s(1), 8.5);
  EXPECT_EQ(graph.timestamp_s(2), 7.5);  // of its first scan
  EXPECT_NEAR(graph.InitialState().points[2], 1.0 + 0.2 + 2.0, 1e-6);
}

TEST_F(PoseGraphFileTest, NamesTheCulprit) {
  const std::string two = "VERTEX_SE2 1 0 0 0\nVERTEX_SE2 2 1 0 0\n";
  const std::string edge = "EDGE_SE2 1 2 1 0 0";
  ExpectError("", ": the file holds no vertices");
  ExpectError("# nothing\n", ": the file holds no vertices");
  ExpectError("VERTEX_SE2 1 0 0\n", ":1: VERTEX_SE2 field 'yaw': is missing");
  ExpectError("VERTEX_SE2 1 0 nan 0\n", ":1: VERTEX_SE2 field 'y': 'nan' is not a finite");
  ExpectError("VERTEX_SE2 1.5 0 0 0\n", ":1: VERTEX_SE2 field 'id': '1.5' is not an integer");
  ExpectError("VERTEX_SE2 1 0 0 0 0\n", ":1: VERTEX_SE2 field 'end of line'");
  ExpectError(two + "VERTEX_SE2 1 0 0 0\n",
              ":3: VERTEX_SE2 field 'id': vertex 1 was there before, in line 1");
  ExpectError(two + edge + " 1 0 0 1 0\n", ":3: EDGE_SE2 field 'I33': is missing");
  ExpectError(two + edge + " 1 0 inf 1 0 1\n", ":3: EDGE_SE2 field 'I13'");
  ExpectError(two + edge + " 1 2 0 1 0 1\n", ":3: EDGE_SE2 fields 'I11' to 'I33'");
  ExpectError(two + edge + " 1 0 0 1 0 0\n", ":3: EDGE_SE2 fields 'I11' to 'I33'");
  ExpectError(two + edge + " -1 0 0 -1 0 -1\n", ":3: EDGE_SE2 fields 'I11' to 'I33'");
  ExpectError(two + "EDGE_SE2 2 2 1 0 0" + kUnit,
              ":3: EDGE_SE2 field 'to': the edge joins a vertex with itself");
  ExpectError(two + "EDGE_SE2 2 9 1 0 0" + kUnit, ":3: EDGE_SE2 field 'to': there is no vertex 9");
  ExpectError(two + edge + kUnit + "FIX 1 9\n", ":4: FIX field 'id': there is no vertex 9");
  ExpectError("FIX\n", ":1: FIX field 'id': is missing");
  ExpectError(two + "VERTEX_SE2 7 0 0 0\n" + edge + kUnit,
              ":3: VERTEX_SE2 no edges connect vertex 7 with the first vertex, 1");
}

TEST_F(PoseGraphFileTest, LeavesNoConstraintOut) {
  const std::string one = "VERTEX_SE2 1 0 0 0\n";
  const struct {
    std::string record, advice;
  } kRecords[] = {{"EDGE_SE2_XY", "a landmark; leave"},
                  {"VERTEX_XY", "a landmark; leave"},
                  {"EDGE_PRIOR_SE2", "a prior on a pose; write FIX"},
                  {"EDGE2", "a record that is not understood"},
                  {"EQUIV", "two vertices of one pose (TORO); write an EDGE2"},
                  {"VERTEX_SWITCH", "a switchable constraint (Vertigo); write it as EDGE_SE2"},
                  {"EDGE_SE2_SWITCHABLE", "a switchable constraint (Vertigo)"},
                  {"VERTEX_SE3:QUAT", "a record in 3D; write x, y and yaw as VERTEX_SE2"},
                  {"FLASER", "a record that is not understood"}};
  for (const auto& [record, advice] : kRecords) {
    ExpectError(one + record + " 1 2 3 4 5\n", ":2: " + record + " field 'keyword': " + advice);
  }
  ExpectError("VERTEX3 0 0 0 0 0 0 0\n", ":1: VERTEX3 field 'keyword': a record in 3D");
  ExpectError("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", ":1: VERTEX_SE3:QUAT field 'keyword'");
}

TEST_F(PoseGraphFileTest, NamesTheScanThatCannotBeRead) {
  ExpectError(Laser("1 2 3", "0"), ":1: ROBOTLASER1 field 'keyword': no vertex before it");
  const Status status = Read("VERTEX_SE2 1 0 0 0\n" + Laser("1 2 x", "0"));
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(status.message(), HasSubstr(path_ + ":2: ROBOTLASER1 field 'range[2]'"));
  std::string turned = Laser("1 2 3", "0");
  turned.replace(turned.find("-1.047198"), 9, "-99");
  ExpectError("VERTEX_SE2 1 0 0 0\n" + turned, ": scan of line 2: laser 0: first_bearing_rad");
  std::string moved = Laser("1 2 3", "1");
  moved.replace(moved.find("5.2"), 3, "5.9");
  ExpectError("VERTEX_SE2 1 0 0 0\n" + Laser("1 2 3", "0") + Laser("1 2 3", "0") + moved,
              ": the place of the laser on the robot differs by up to 0.7");
}

TEST_F(PoseGraphFileTest, ReadsGzipAndNoticesATruncatedFile) {
  std::string content = "VERTEX_SE2 0 0 0 0\n";
  for (int i = 1; i < 1000; ++i) {
    const std::string id = std::to_string(i);
    content += "VERTEX_SE2 " + id + " " + std::to_string(0.37 * i * i) + " 0 0\nEDGE_SE2 " +
               std::to_string(i - 1) + " " + id + " 1 0 0" + kUnit;
  }
  gzFile file = gzopen(path_.c_str(), "wb");
  gzwrite(file, content.data(), content.size());
  gzclose(file);
  EXPECT_TRUE(IsPoseGraphFile(path_));
  ASSERT_TRUE(ReadPoseGraphFile(path_, &file_).ok());
  EXPECT_EQ(file_.graph.num_poses(), 1000);
  const std::string compressed = ReadFile(path_);
  EXPECT_EQ(Read(compressed.substr(0, compressed.size() / 2)).code(), StatusCode::kDataLoss);
  EXPECT_EQ(ReadPoseGraphFile(folder_ + "none", &file_).code(), StatusCode::kNotFound);
}

TEST_F(PoseGraphFileTest, IsToldByTheFirstRecord) {
  const auto is_pose_graph = [&](const std::string& content) {
    WriteFile(path_, content);
    return IsPoseGraphFile(path_);
  };
  for (const char* start : {"VERTEX_SE2 1", "# c\n\n EDGE_SE2 0 1", "VERTEX2 0", "EDGE2 0 1",
                            "VERTEX_SE3:QUAT 0", "FIX 0", "PARAMS_SE2OFFSET 0 0 0 0"}) {
    EXPECT_TRUE(is_pose_graph(start)) << start;
  }
  for (const char* start : {"FLASER 1 1", "PARAM a b\nVERTEX_SE2"}) {
    EXPECT_FALSE(is_pose_graph(start)) << start;
  }
  EXPECT_FALSE(IsPoseGraphFile(folder_ + "none.g2o"));
}

TEST_F(PoseGraphFileTest, IsToldByTheExtensionWhereTheRecordsDoNotTell) {
  for (const char* content : {"", "# VERTEX_SE2\n", "ROBOTLASER1 0\nVERTEX_SE2 0\n"}) {
    for (const char* name : {"a.g2o", "b.c.toro", "a.g2o.gz"}) {
      WriteFile(folder_ + name, content);
      EXPECT_TRUE(IsPoseGraphFile(folder_ + name)) << name;
    }
    for (const char* name : {"a.clf", "a.clf.gz", "g2o", "a.g2o.clf"}) {
      WriteFile(folder_ + name, content);
      EXPECT_FALSE(IsPoseGraphFile(folder_ + name)) << name;
    }
  }
}

}  // namespace
}  // namespace plumbline
