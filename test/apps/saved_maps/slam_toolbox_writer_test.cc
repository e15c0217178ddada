#include "plumbline/apps/saved_maps/slam_toolbox_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "plumbline/apps/saved_maps/slam_toolbox_graph.h"
#include "plumbline/test/apps/saved_maps/posegraph_writer.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

class SlamToolboxWriterTest : public testing::Test {
 protected:
  SlamToolboxWriterTest() {
    WriteKartoMap(folder_ + "in", SmallKartoMap());
    Read("in", &graph_);
  }

  void Read(const std::string& name, SlamGraph* graph) {
    int num_restarts = 0;
    ASSERT_TRUE(ReadSlamToolboxMap(folder_ + name + ".posegraph", 0.0, &map_).ok());
    ASSERT_TRUE(BuildGraph(map_, graph, &num_restarts).ok());
  }
  void Write(const std::vector<double>& poses) {
    ASSERT_TRUE(WriteSlamToolboxMap(folder_ + "out.posegraph", map_, poses).ok());
  }
  // How many bytes differ.
  int Changes(const std::string& extension) const {
    const std::string before = ReadFile(folder_ + "in" + extension);
    const std::string after = ReadFile(folder_ + "out" + extension);
    EXPECT_EQ(before.size(), after.size());
    int changes = 0;
    for (std::size_t i = 0; i < before.size(); ++i) changes += before[i] != after[i] ? 1 : 0;
    return changes;
  }

  const std::string folder_ = TempFolder();
  SlamToolboxMap map_;
  SlamGraph graph_;
};

TEST_F(SlamToolboxWriterTest, TheGivenPosesGiveTheSameFiles) {
  Write(graph_.initial_poses());
  EXPECT_EQ(Changes(".posegraph"), 0);
  EXPECT_EQ(Changes(".data"), 0);
}

TEST_F(SlamToolboxWriterTest, OtherPosesAreReadAgain) {
  std::vector<double> poses = graph_.initial_poses();
  for (double& number : poses) number += 0.25;
  Write(poses);
  SlamGraph again;
  Read("out", &again);
  EXPECT_EQ(again.initial_poses(), poses);
  EXPECT_EQ(again.returns().range_m, graph_.returns().range_m);
  // All scans in both files.
  for (const auto& scans : {GraphScansOf(map_), DatasetScansOf(map_)}) {
    ASSERT_EQ(scans.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(PoseOf(scans[i].Object("corrected_pose")).x, poses[3 * i]);
      EXPECT_EQ(scans[i].Number("is_dirty"), 1.0);
    }
  }
}

// The optimum of the edges, which slam_toolbox goes to, is where the scans are.
TEST_F(SlamToolboxWriterTest, EdgesSayWhatThePosesSay) {
  std::vector<double> poses = graph_.initial_poses();
  poses[3] += 0.1;
  poses[5] += 7.0;  // more than a turn
  Write(poses);
  SlamGraph again;
  Read("out", &again);
  ASSERT_EQ(again.relative_poses().size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const RelativePoseConstraint &edge = again.relative_poses()[i],
                                 &before = graph_.relative_poses()[i];
    EXPECT_EQ(edge.covariance, before.covariance);
    const bool moves = edge.from == 1 || edge.to == 1;
    const Pose2 expected = moves ? Between(again.InitialPose(edge.from), again.InitialPose(edge.to))
                                 : before.from_from_to;
    EXPECT_NEAR(edge.from_from_to.x, expected.x, 1e-12);
    EXPECT_NEAR(edge.from_from_to.y, expected.y, 1e-12);
    EXPECT_NEAR(edge.from_from_to.yaw, expected.yaw, 1e-12);
  }
}

TEST_F(SlamToolboxWriterTest, NothingButPosesChanges) {
  std::vector<double> poses = graph_.initial_poses();
  poses[0] += 0.125;
  Write(poses);
  // A scan has a pose of three numbers and its mark, an edge three poses; scan 0 has two edges.
  EXPECT_GT(Changes(".posegraph"), 0);
  EXPECT_LE(Changes(".posegraph"), 3 * 8 + 1 + 2 * 3 * 3 * 8);
  EXPECT_GT(Changes(".data"), 0);
  EXPECT_LE(Changes(".data"), 3 * 8 + 1);
}

TEST_F(SlamToolboxWriterTest, SaysWhatCannotBeWritten) {
  EXPECT_EQ(
      WriteSlamToolboxMap(folder_ + "none/out.posegraph", map_, graph_.initial_poses()).code(),
      StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
