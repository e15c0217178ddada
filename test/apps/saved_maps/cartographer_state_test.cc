#include "plumbline/apps/saved_maps/cartographer_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <vector>

#include "plumbline/apps/saved_maps/cartographer_graph.h"
#include "plumbline/apps/saved_maps/cartographer_writer.h"
#include "plumbline/test/apps/saved_maps/pbstream_testing.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// All that was read, but for the file itself.
std::string TextOf(const CartographerState& state) {
  std::ostringstream text;
  text.precision(17);
  const auto add = [&text](const Pose2& pose) {
    text << ' ' << pose.x << ' ' << pose.y << ' ' << pose.yaw;
  };
  for (const CartographerNode& node : state.nodes) {
    text << "\nnode " << node.id.trajectory << ' ' << node.id.index << ' ' << node.time_s << ' '
         << node.tracking_from_level_rad;
    add(node.map_from_tracking);
    add(node.local_from_tracking);
    for (const Eigen::Vector2i& point : node.points_mm) text << ' ' << point.transpose();
  }
  for (const CartographerSubmap& submap : state.submaps) {
    text << "\nsubmap " << submap.id.trajectory << ' ' << submap.id.index;
    add(submap.map_from_submap);
  }
  for (const CartographerConstraint& constraint : state.constraints) {
    text << "\nconstraint " << constraint.submap << ' ' << constraint.node << ' '
         << constraint.is_intra;
    add(constraint.submap_from_tracking);
  }
  text << "\ncell " << state.cell_m.value_or(0.0) << ' ' << state.has_landmarks;
  return text.str();
}

class CartographerStateTest : public testing::Test {
 protected:
  Status Read(const std::string& content) {
    return ParseCartographerState(path_, content, &state_);
  }
  Status ReadMessages(const std::vector<std::string>& messages) { return Read(PbFile(messages)); }
  void ExpectRefused(const Status& status, const std::string& problem,
                     StatusCode code = StatusCode::kDataLoss) const {
    EXPECT_EQ(status.code(), code);
    EXPECT_THAT(status.message(),
                HasSubstr(path_ + ": cannot be read as a state of Cartographer: " + problem));
  }
  // With the pose graph of a changed state, and all else as it was.
  void ExpectPoseGraphRefused(const PbState& changed, const std::string& problem) {
    std::vector<std::string> messages = PbMessages(SmallPbState());
    messages[1] = PbMessages(changed)[1];
    ExpectRefused(ReadMessages(messages), "message 2: " + problem);
  }

  // What can be read can be made a graph and written, or that is refused.
  void ExpectReadOrNamed(const std::string& content) {
    const Status status = Read(content);
    SlamGraph graph;
    CartographerGraphNotes notes;
    const Status built = status.ok() ? BuildGraph(state_, path_, &graph, &notes) : status;
    if (!built.ok()) {
      EXPECT_THAT(built.message(), HasSubstr(path_));
      return;
    }
    std::vector<double> poses = graph.initial_poses();
    for (double& coordinate : poses) coordinate += 0.25;
    std::ostringstream written;
    WriteCartographerState(state_.content, poses, &written);
    EXPECT_TRUE(Read(written.str()).ok());
  }

  const std::string path_ = TempFolder() + "a.pbstream";
  CartographerState state_;
};

TEST_F(CartographerStateTest, ReadsPosesPointsAndConstraints) {
  for (const int version : {1, 2}) {
    const PbState given = SmallPbState();
    const std::string content = PbFile(PbMessages(given, version));
    const Status status = Read(content);
    ASSERT_TRUE(status.ok()) << status.message();
    ASSERT_EQ(state_.nodes.size(), 3u);
    const CartographerNode& node = state_.nodes[2];
    EXPECT_EQ(node.id.index, 2);
    EXPECT_NEAR(node.time_s, 1621887394.3168822, 1e-6);
    EXPECT_NEAR(node.map_from_tracking.x, 1.0, 1e-15);
    EXPECT_NEAR(node.map_from_tracking.y, 0.125, 1e-15);
    EXPECT_NEAR(node.map_from_tracking.yaw, 0.6 - 0.2, 1e-15);
    EXPECT_NEAR(node.local_from_tracking.y, 0.25, 1e-15);
    EXPECT_NEAR(node.tracking_from_level_rad, 0.2, 1e-15);
    ASSERT_EQ(node.points_mm.size(), 4u);
    // In the order of their blocks.
    EXPECT_EQ(node.points_mm[0], Eigen::Vector2i(-2000, 1125));
    EXPECT_EQ(node.points_mm[1], Eigen::Vector2i(-1000, -1000));
    EXPECT_EQ(node.points_mm[2], Eigen::Vector2i(500, -3000));
    EXPECT_EQ(node.points_mm[3], Eigen::Vector2i(1500, 500));
    ASSERT_EQ(state_.submaps.size(), 2u);
    EXPECT_EQ(state_.submaps[1].id.index, 1);
    EXPECT_NEAR(state_.submaps[1].map_from_submap.yaw, -0.2, 1e-15);
    ASSERT_EQ(state_.constraints.size(), 4u);
    const CartographerConstraint& closure = state_.constraints[3];
    EXPECT_EQ(closure.submap, 1);
    EXPECT_EQ(closure.node, 2);
    EXPECT_FALSE(closure.is_intra);
    EXPECT_TRUE(state_.constraints[0].is_intra);
    EXPECT_NEAR(closure.submap_from_tracking.yaw, 0.6 + 0.2 - 0.2, 1e-15);
    EXPECT_EQ(state_.cell_m, 0.05);
    EXPECT_FALSE(state_.has_landmarks);
    EXPECT_EQ(state_.content, content);
  }
}

TEST_F(CartographerStateTest, TakesIdsAsTheyComeAndPointsThatAreNotPacked) {
  PbState given = SmallPbState();
  given.nodes[0].index = 1000;  // something was trimmed
  given.nodes[2].trajectory = given.submaps[1].trajectory = 5;
  given.pose_graph_extras = PbBytes(5, PbBytes(1, "landmark") + PbBytes(2, PbPose({})));
  std::vector<std::string> messages = PbMessages(given);
  const PbNode& node = given.nodes[1];
  messages[6] =
      PbBytes(4, PbBytes(1, PbId(0, 1)) +
                     PbBytes(5, PbBytes(2, PbQuaternion(node.level_from_tracking)) +
                                    PbBytes(3, PbCloud(node.points_in_level, /*packed=*/false)) +
                                    PbBytes(7, PbTrackingPose(node.local_from_level, node))));
  const Status status = ReadMessages(messages);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(state_.nodes[0].id.index, 1000);
  EXPECT_EQ(state_.nodes[1].points_mm.size(), 4u);
  EXPECT_EQ(state_.nodes[2].id.trajectory, 5);
  EXPECT_EQ(state_.constraints[3].node, 2);
  EXPECT_TRUE(state_.has_landmarks);
}

TEST_F(CartographerStateTest, IsToldByItsStartOrItsName) {
  const std::string other = TempFolder() + "map";
  EXPECT_TRUE(IsCartographerState(path_));  // to say that it is not there
  EXPECT_FALSE(IsCartographerState(other));
  WriteFile(other, kPbMagic);
  EXPECT_TRUE(IsCartographerState(other));
  WriteFile(other, kPbMagic.substr(1));
  EXPECT_FALSE(IsCartographerState(other));
  EXPECT_EQ(ReadCartographerState(path_, &state_).code(), StatusCode::kNotFound);
  std::filesystem::create_directory(path_);
  EXPECT_THAT(ReadCartographerState(path_, &state_).message(), HasSubstr(path_ + "': Is a direct"));
}

// Also a cut between two messages. Only the sensor data at the end are not missed.
TEST_F(CartographerStateTest, EveryCutIsDataLossThatNamesTheFile) {
  const std::vector<std::string> messages = PbMessages(SmallPbState());
  const std::string whole = PbFile(messages);
  const std::size_t size_without_imu =
      PbFile(std::vector<std::string>(messages.begin(), messages.end() - 1)).size();
  ASSERT_TRUE(Read(whole).ok());
  const std::string expected = TextOf(state_);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Status status = Read(whole.substr(0, size));
    if (size == size_without_imu) {
      EXPECT_TRUE(status.ok());
    } else {
      ASSERT_EQ(status.code(), StatusCode::kDataLoss) << size;
      ASSERT_THAT(status.message(), HasSubstr(path_ + ": cannot be read as a state of ")) << size;
    }
    ASSERT_EQ(TextOf(state_), expected);
  }
}

// The checksums find it, or it was of no consequence.
TEST_F(CartographerStateTest, NoFlippedByteChangesWhatIsRead) {
  const std::string whole = PbFile(PbMessages(SmallPbState()));
  ASSERT_TRUE(Read(whole).ok());
  const std::string expected = TextOf(state_);
  std::size_t num_found = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ (i % 2 == 0 ? 0xff : 0x01));
    const Status status = Read(flipped);
    ASSERT_EQ(TextOf(state_), expected) << "byte " << i;
    if (status.ok()) continue;
    EXPECT_THAT(status.message(), HasSubstr(path_)) << "byte " << i;
    ++num_found;
  }
  // Of each message, gzip has seven bytes that do not matter.
  EXPECT_GE(num_found, whole.size() - 7 * 9);
}

// As if somebody had compressed it again: what is read can be made a graph, or is refused.
TEST_F(CartographerStateTest, FlippedBytesWithinMessagesAreReadOrNamed) {
  const std::vector<std::string> messages = PbMessages(SmallPbState());
  std::string before = kPbMagic;
  const std::string whole = PbFile(messages);
  for (std::size_t m = 0; m < messages.size(); ++m) {
    const std::string here = PbFile({messages[m]}).substr(kPbMagic.size());
    const std::string after = whole.substr(before.size() + here.size());
    const std::size_t num_bytes = m == 3 || m == 4 ? 100 : messages[m].size();  // but for grids
    for (std::size_t i = 0; i < num_bytes; ++i) {
      for (const int change : {0x01, 0xff}) {
        std::string flipped = messages[m];
        flipped[i] = static_cast<char>(flipped[i] ^ change);
        ExpectReadOrNamed(before + PbFile({flipped}).substr(kPbMagic.size()) + after);
        ASSERT_FALSE(HasFailure()) << "message " << m << ", byte " << i;
      }
    }
    before += here;
  }
}

TEST_F(CartographerStateTest, OtherVersionsAreNamed) {
  const PbState state = SmallPbState();
  ExpectRefused(ReadMessages(PbMessages(state, 3)), "message 1: format version 3, but only 1 and 2",
                StatusCode::kInvalidArgument);
  ExpectRefused(ReadMessages(PbMessages(state, 0)), "message 1: format version 0",
                StatusCode::kInvalidArgument);
  // Before there were headers, the pose graph came first, by itself.
  ExpectRefused(ReadMessages({PbPoseGraph(state), PbBytes(1, "options")}),
                "message 1: no header: the file is older than Cartographer 1.0",
                StatusCode::kInvalidArgument);
}

TEST_F(CartographerStateTest, MapsIn3DAreRefused) {
  std::vector<std::string> messages = PbMessages(SmallPbState());
  const std::string submap = messages[3];
  messages[3] = PbBytes(3, PbBytes(1, PbId(0, 0)) + PbBytes(3, PbBytes(1, PbPose({}))));
  ExpectRefused(ReadMessages(messages), "message 4: a map in 3D", StatusCode::kInvalidArgument);
  messages[3] = submap;
  messages[5] = PbBytes(4, PbBytes(1, PbId(0, 0)) + PbBytes(5, PbBytes(4, PbCloud({{1.0, 1.0}}))));
  ExpectRefused(ReadMessages(messages), "message 6: a map in 3D", StatusCode::kInvalidArgument);
}

TEST_F(CartographerStateTest, MessagesComeInTheirOrder) {
  const std::vector<std::string> messages = PbMessages(SmallPbState());
  ExpectRefused(Read(kPbMagic), "there is no message in it");
  ExpectRefused(ReadMessages({messages[0]}), "message 1: no pose graph follows it");
  ExpectRefused(ReadMessages({messages[0], messages[2]}), "message 2: not one pose graph");
  ExpectRefused(ReadMessages({messages[0], messages[1] + messages[1]}),
                "message 2: not one pose graph");
  ExpectRefused(ReadMessages({messages[0], messages[1], messages[1]}),
                "message 3: a second pose graph");
  ExpectRefused(ReadMessages({messages[0], messages[1], messages[2]}),
                "message 3: the file ends after it, but the data of node 0 of trajectory 0 were");
}

TEST_F(CartographerStateTest, IdsFitTogether) {
  PbState state = SmallPbState();
  state.nodes[1].index = 2;
  ExpectPoseGraphRefused(state, "node 2 of trajectory 0 is there twice");
  state = SmallPbState();
  state.submaps[1].index = 0;
  ExpectPoseGraphRefused(state, "submap 0 of trajectory 0 is there twice");

  std::vector<std::string> messages = PbMessages(SmallPbState());
  messages[6] = messages[5];
  ExpectRefused(ReadMessages(messages), "message 7: the data of node 0 of trajectory 0 come twice");
  state = SmallPbState();
  state.nodes[1].trajectory = 4;
  messages[6] = PbNodeMessage(state.nodes[1]);
  ExpectRefused(ReadMessages(messages),
                "message 7: the message names node 1 of trajectory 4, which has no pose");

  const std::string constraint = PbBytes(1, PbId(0, 0)) + PbBytes(3, PbPose({}));
  state = SmallPbState();
  state.pose_graph_extras = PbBytes(2, constraint + PbBytes(2, PbId(0, 9)));
  ExpectPoseGraphRefused(state, "constraint 5 names node 9 of trajectory 0, which has no pose");
  state.pose_graph_extras = PbBytes(2, constraint + PbBytes(1, PbId(1, 0)));
  ExpectPoseGraphRefused(state, "constraint 5 names submap 0 of trajectory 1, which has no pose");
}

TEST_F(CartographerStateTest, DamagedPartsAreNamed) {
  PbState state = SmallPbState();
  state.pose_graph_extras = PbBytes(2, PbBytes(1, PbId(0, 0)));
  ExpectPoseGraphRefused(state, "a damaged constraint 5");
  state = SmallPbState();
  state.nodes[1].map_from_level.x = 1e9;
  ExpectPoseGraphRefused(state, "a damaged pose of node 1 of trajectory 0");
  state = SmallPbState();
  state.submaps[1].map_from_submap.y = std::nan("");
  ExpectPoseGraphRefused(state, "a damaged pose of submap 1 of trajectory 0");
  state = SmallPbState();
  state.pose_graph_extras = PbBytes(4, "\x7f");
  ExpectPoseGraphRefused(state, "a damaged trajectory");
  state.pose_graph_extras = "\x7f";
  ExpectPoseGraphRefused(state, "a damaged pose graph");

  const auto expect_node = [this](const std::string& data, const std::string& problem) {
    std::vector<std::string> messages = PbMessages(SmallPbState());
    messages[6] = PbBytes(4, PbBytes(1, PbId(0, 1)) + PbBytes(5, data));
    ExpectRefused(ReadMessages(messages), "message 7: " + problem);
  };
  const std::string alignment = PbBytes(2, PbQuaternion(Turn(0.0)));
  const std::string local_pose = PbBytes(7, PbPose({}));
  expect_node(local_pose, "a damaged alignment with gravity of node 1 of trajectory 0");
  expect_node(alignment, "a damaged local pose of node 1 of trajectory 0");
  expect_node("\x7f", "the data of node 1 of trajectory 0 are damaged");
  const std::string too_far = PbVarint(1) + PbVarint(1 << 13) + PbVarint(0) + PbVarint(0) + "\1";
  for (const std::string& cloud :
       {PbInt(1, 1), PbInt(1, -1), PbInt(1, 2) + PbCloud({{1.0, 1.0}}).substr(2),
        PbInt(1, 1) + PbBytes(3, "\1\1\1"), PbInt(1, 1) + PbBytes(3, "\2\1\1\1\1"),
        PbInt(1, 1) + PbBytes(3, PbVarint(~std::uint64_t{0}) + "\1\1\1\1"),
        PbInt(1, 1) + PbBytes(3, too_far), PbInt(1, 1) + PbBytes(3, "\1\1\1\1\xff")}) {
    expect_node(alignment + local_pose + PbBytes(3, cloud),
                "a damaged point cloud of node 1 of trajectory 0");
  }

  for (const double cell_m : {-0.05, 1e-5, 1e5}) {
    std::vector<std::string> messages = PbMessages(SmallPbState());
    messages[4] = PbSubmapMessage(SmallPbState().submaps[1], cell_m);
    ExpectRefused(ReadMessages(messages), "message 5: a damaged submap");
  }
  std::vector<std::string> messages = PbMessages(SmallPbState());
  messages.back() = "\x7f";
  ExpectRefused(ReadMessages(messages), "message 9: the message is damaged");
}

TEST_F(CartographerStateTest, MemoryIsLimited) {
  const std::string whole = PbFile(PbMessages(SmallPbState()));
  WriteFile(path_, whole);
  EXPECT_TRUE(ReadCartographerState(path_, &state_, 1e5).ok());
  EXPECT_EQ(state_.content, whole);
  EXPECT_THAT(ReadCartographerState(path_, &state_, 100.0).message(),
              HasSubstr("a.pbstream: what was read so far takes"));
  const double little_more = static_cast<double>(whole.size()) + 300.0;
  EXPECT_THAT(ReadCartographerState(path_, &state_, little_more).message(),
              HasSubstr("a.pbstream: message 2: what was read so far takes"));
}

}  // namespace
}  // namespace plumbline
