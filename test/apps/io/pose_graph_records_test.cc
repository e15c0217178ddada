#include "plumbline/apps/io/pose_graph_records.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(PoseGraphRecordsTest, KeywordsBelongToTheirFormat) {
  for (const PoseGraphFormat format : {PoseGraphFormat::kG2o, PoseGraphFormat::kToro}) {
    const PoseGraphDialect& dialect = DialectOf(format);
    EXPECT_EQ(dialect.format, format);
    EXPECT_EQ(DialectOfKeyword(dialect.vertex), &dialect);
    EXPECT_EQ(DialectOfKeyword(dialect.edge), &dialect);
  }
  EXPECT_EQ(DialectOfKeyword("VERTEX_SE2")->format, PoseGraphFormat::kG2o);
  EXPECT_EQ(DialectOfKeyword("EDGE2")->format, PoseGraphFormat::kToro);
  for (const char* keyword : {"", "FIX", "VERTEX", "EDGE_SE2_XY", "vertex2"}) {
    EXPECT_EQ(DialectOfKeyword(keyword), nullptr) << keyword;
  }
}

TEST(PoseGraphRecordsTest, CommentsAndBlankLinesHaveNoKeyword) {
  EXPECT_EQ(RecordKeyword("FIX 0"), "FIX");
  EXPECT_EQ(RecordKeyword(" \tEDGE2 0 1"), "EDGE2");
  for (const char* line : {"", "  ", "# FIX 0", "#FIX 0"}) EXPECT_EQ(RecordKeyword(line), "");
}

TEST(PoseGraphRecordsTest, APoseIsThreeFiniteNumbers) {
  FieldReader good("1.5 -2 0.25"), bad("1 inf 0"), few("1 2");
  const Pose2 pose = ReadPoseFields(&good);
  EXPECT_TRUE(good.ok());
  EXPECT_EQ(pose.x, 1.5);
  EXPECT_EQ(pose.y, -2.0);
  EXPECT_EQ(pose.yaw, 0.25);
  ReadPoseFields(&bad);
  EXPECT_EQ(bad.field(), "y");
  ReadPoseFields(&few);
  EXPECT_EQ(few.field(), "yaw");
}

}  // namespace
}  // namespace plumbline
