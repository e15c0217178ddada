#include "plumbline/apps/saved_maps/cartographer_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "plumbline/apps/saved_maps/cartographer_graph.h"
#include "plumbline/apps/saved_maps/cartographer_stream.h"
#include "plumbline/test/apps/saved_maps/pbstream_testing.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

std::vector<std::string> MessagesOf(const std::string& content) {
  std::vector<std::string> messages;
  CartographerStream stream("", content);
  while (stream.Next()) messages.emplace_back(stream.message());
  EXPECT_TRUE(stream.status().ok());
  return messages;
}

// Poses of nodes and submaps, as the writer takes them.
std::vector<double> PosesOfState(const CartographerState& state) {
  std::vector<double> poses;
  const auto add = [&poses](const Pose2& pose) {
    poses.insert(poses.end(), {pose.x, pose.y, pose.yaw});
  };
  for (const CartographerNode& node : state.nodes) add(node.map_from_tracking);
  for (const CartographerSubmap& submap : state.submaps) add(submap.map_from_submap);
  return poses;
}

class CartographerWriterTest : public testing::Test {
 protected:
  CartographerWriterTest() {
    PbState given = SmallPbState();
    // Two trajectories, tilted.
    given.nodes[2].trajectory = given.submaps[1].trajectory = 3;
    given.nodes[0].level_from_tracking =
        Turn(-0.4) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY());
    given.pose_graph_extras = PbBytes(5, PbBytes(1, "landmark")) + PbInt(99, 5);
    EXPECT_TRUE(ParseCartographerState("a.pbstream", PbFile(PbMessages(given)), &state_).ok());
  }
  // What the state becomes with these poses.
  CartographerState Moved(const std::vector<double>& poses) const {
    std::ostringstream written;
    WriteCartographerState(state_.content, poses, &written);
    CartographerState moved;
    EXPECT_TRUE(ParseCartographerState("b.pbstream", written.str(), &moved).ok());
    return moved;
  }

  CartographerState state_;
};

TEST_F(CartographerWriterTest, ThePosesAreThoseOfTheGraph) {
  SlamGraph graph;
  CartographerGraphNotes notes;
  ASSERT_TRUE(BuildGraph(state_, "a.pbstream", &graph, &notes).ok());
  EXPECT_EQ(graph.initial_poses(), PosesOfState(state_));
}

TEST_F(CartographerWriterTest, MovesNodesAndSubmapsAndNothingElse) {
  std::vector<double> poses = PosesOfState(state_);
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] += 0.01 * (1.0 + static_cast<double>(i));
  const CartographerState moved = Moved(poses);
  const std::vector<double> read = PosesOfState(moved);
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_NEAR(read[i], poses[i], 1e-14) << i;
  // Points turn with their node.
  EXPECT_EQ(moved.nodes[0].tracking_from_level_rad, state_.nodes[0].tracking_from_level_rad);

  std::vector<std::string> before = MessagesOf(state_.content), after = MessagesOf(moved.content);
  ASSERT_EQ(after.size(), before.size());
  EXPECT_NE(after[1], before[1]);
  EXPECT_THAT(after[1], HasSubstr(PbBytes(5, PbBytes(1, "landmark")) + PbInt(99, 5)));
  before[1] = after[1] = "";
  EXPECT_EQ(after, before);
  // What is not written anew is not compressed anew.
  const std::size_t tail = PbFile({before[2]}).size();
  EXPECT_EQ(moved.content.substr(moved.content.size() - tail),
            state_.content.substr(state_.content.size() - tail));
}

TEST_F(CartographerWriterTest, PosesThatAreTheSameStayAsTheyAreWritten) {
  EXPECT_EQ(MessagesOf(Moved(PosesOfState(state_)).content), MessagesOf(state_.content));
  // A node alone that moves leaves its neighbours alone.
  std::vector<double> poses = PosesOfState(state_);
  poses[4] += 1.0;
  std::vector<double> read = PosesOfState(Moved(poses));
  EXPECT_NEAR(read[4], poses[4], 1e-15);
  read[3] = poses[3], read[4] = poses[4], read[5] = poses[5];
  EXPECT_EQ(read, poses);
}

TEST_F(CartographerWriterTest, FilesAreTheSameForTheSamePoses) {
  std::vector<double> poses = PosesOfState(state_);
  poses[0] += 0.5;
  const std::string path = TempFolder() + "b.pbstream";
  ASSERT_TRUE(WriteCartographerState(path, state_.content, poses).ok());
  EXPECT_EQ(ReadFile(path), Moved(poses).content);
  // Written back, a state is the one that it was.
  CartographerState moved;
  ASSERT_TRUE(ReadCartographerState(path, &moved).ok());
  ASSERT_TRUE(WriteCartographerState(path, moved.content, PosesOfState(moved)).ok());
  EXPECT_EQ(ReadFile(path), moved.content);
}

TEST_F(CartographerWriterTest, AFileThatCannotBeWrittenIsNamed) {
  const Status status = WriteCartographerState(TempFolder() + "none/b.pbstream", state_.content,
                                               PosesOfState(state_));
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("none/b.pbstream"));
}

}  // namespace
}  // namespace plumbline
