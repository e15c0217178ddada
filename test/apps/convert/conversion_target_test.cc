#include "plumbline/apps/convert/conversion_target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string ErrorOf(const std::string& paths, const std::string& format = "") {
  std::vector<ConversionTarget> targets;
  const Status status = ParseConversionTargets(paths, format, &targets);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << paths;
  EXPECT_TRUE(targets.empty());
  return status.message();
}

TEST(ConversionTargetTest, NamesRoundTrip) {
  for (const ConversionFormat format :
       {ConversionFormat::kTum, ConversionFormat::kG2o, ConversionFormat::kToro,
        ConversionFormat::kPly, ConversionFormat::kPcd, ConversionFormat::kRosMap}) {
    ConversionFormat read = ConversionFormat::kTum;
    EXPECT_TRUE(FromString(ToString(format), &read)) << ToString(format);
    EXPECT_EQ(read, format);
  }
  ConversionFormat format;
  EXPECT_FALSE(FromString("obj", &format));
  EXPECT_FALSE(FromString("", &format));
}

TEST(ConversionTargetTest, TheExtensionTellsTheFormat) {
  std::vector<ConversionTarget> targets;
  ASSERT_TRUE(ParseConversionTargets("a.tum,d.x/b.g2o,c.toro,d.graph,e.ply,f.pcd,g.pgm,h.b.yaml",
                                     "", &targets)
                  .ok());
  std::vector<std::string> names;
  for (const ConversionTarget& target : targets) names.push_back(ToString(target.format));
  EXPECT_THAT(names, ElementsAre("tum", "g2o", "toro", "toro", "ply", "pcd", "ros_map", "ros_map"));
  EXPECT_EQ(targets[1].path, "d.x/b.g2o");
  EXPECT_THAT(targets[1].Files(), ElementsAre("d.x/b.g2o"));
  EXPECT_THAT(targets[6].Files(), ElementsAre("g.pgm", "g.yaml"));
  EXPECT_EQ(targets[7].MapStem(), "h.b");
}

TEST(ConversionTargetTest, AFormatByNameNeedsNoExtension) {
  std::vector<ConversionTarget> targets;
  ASSERT_TRUE(ParseConversionTargets("out/floor.2", "ros_map", &targets).ok());
  EXPECT_THAT(targets[0].Files(), ElementsAre("out/floor.2.pgm", "out/floor.2.yaml"));
  ASSERT_TRUE(ParseConversionTargets("a.txt", "tum", &targets).ok());
  EXPECT_THAT(targets[0].Files(), ElementsAre("a.txt"));
  EXPECT_EQ(targets[0].format, ConversionFormat::kTum);
}

TEST(ConversionTargetTest, ErrorsNameTheFlag) {
  EXPECT_THAT(ErrorOf("a.obj"), testing::AllOf(HasSubstr("--output=a.obj: the extension"),
                                               HasSubstr(" .tum .g2o .toro .graph .ply ")));
  for (const char* path : {"a", "a.g2o.gz", "a.G2O", ".g2o", "a.tum,b"}) {
    EXPECT_THAT(ErrorOf(path), HasSubstr("the extension"));
  }
  for (const char* paths : {"", "a.tum,", ",a.tum", "a.tum,,b.tum"}) {
    EXPECT_THAT(ErrorOf(paths), HasSubstr("an empty file name"));
  }
  EXPECT_THAT(ErrorOf("a.tum", "TUM"), HasSubstr("--format=TUM: no such format"));
  EXPECT_THAT(ErrorOf("a.tum,b.tum", "tum"), HasSubstr("--format goes with one output"));
}

TEST(ConversionTargetTest, WhatHasNoPlaceIsCounted) {
  SlamGraph graph = MakeNoisyRoom().graph;  // 12 poses with a scan each, 11 + 2 edges
  EXPECT_EQ(LeftOut(ConversionFormat::kG2o, graph), "");
  EXPECT_EQ(LeftOut(ConversionFormat::kToro, graph), "");
  EXPECT_EQ(LeftOut(ConversionFormat::kTum, graph), "13 edges, 12 scans");
  EXPECT_EQ(LeftOut(ConversionFormat::kPly, graph), "12 poses, 13 edges");
  EXPECT_EQ(LeftOut(ConversionFormat::kPcd, graph), "12 poses, 13 edges");
  EXPECT_EQ(LeftOut(ConversionFormat::kRosMap, graph), "12 poses, 13 edges, 12 scans");
  graph.FixPose(3);
  EXPECT_EQ(LeftOut(ConversionFormat::kTum, graph), "13 edges, 1 fixed pose, 12 scans");

  SlamGraph times;
  times.AddPose(Pose2(), 0.0);
  times.AddPose(Pose2(), 1.5);
  EXPECT_EQ(LeftOut(ConversionFormat::kG2o, times), "1 time");
  EXPECT_EQ(LeftOut(ConversionFormat::kTum, times), "");

  LaserModel turning = graph.laser(0);
  turning.beam_period_s = 1e-3;
  SlamGraph sweeps;
  const int laser = sweeps.AddLaser(turning);
  const int pose = sweeps.AddPose(Pose2(), 0.0);
  sweeps.AddScan(pose, laser, std::vector<double>(turning.num_beams, 1.0));
  EXPECT_EQ(LeftOut(ConversionFormat::kG2o, sweeps), "1 sweep time");
  EXPECT_EQ(LeftOut(ConversionFormat::kPly, sweeps), "1 pose");
}

}  // namespace
}  // namespace plumbline
