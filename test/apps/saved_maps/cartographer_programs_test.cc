// Maps that Cartographer has saved, in the programs, from end to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/saved_maps/cartographer_state.h"
#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/saved_maps/pbstream_testing.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// The room as Cartographer would save it: four nodes a submap, each of them matched to 2 cm with
// two submaps, poses off by 5 cm, and a closure between the last node and the first submap.
PbState RoomState(const NoisyRoom& room) {
  constexpr int kPerSubmap = 4;
  PbState state;
  RandomStates random(21);
  const auto noise = [&random](double sigma) {
    const double yaw = random.Gaussian(0.5 * sigma), y = random.Gaussian(sigma);
    return Pose2(random.Gaussian(sigma), y, yaw);
  };
  for (int i = 0; i < room.graph.num_poses(); ++i) {
    PbNode node;
    node.index = i;
    node.time_ticks = kPbStart + 10000000 * i;
    node.level_from_tracking = Turn(0.1 * i);
    // The truth is where the tracking frames are.
    const Pose2 tracking_from_level(0.0, 0.0, -0.1 * i);
    node.map_from_level = room.truth[i] * noise(i == 0 ? 0.0 : 0.05) * tracking_from_level;
    node.local_from_level = room.truth[i] * tracking_from_level;
    const ScanEntry& scan = room.graph.scan(i);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      node.points_in_level.push_back(tracking_from_level.Inverse() * room.graph.PointInRobot(r));
    }
    if (i % kPerSubmap == 0) {
      const Pose2& truth = room.truth[i];
      state.submaps.push_back({0, i / kPerSubmap, {truth.x, truth.y, 0.0}});
    }
    for (int back = 0; back < 2 && i / kPerSubmap - back >= 0; ++back) {
      const int submap = i / kPerSubmap - back;
      const Pose2 match = Between(state.submaps[submap].map_from_submap,
                                  room.truth[i] * noise(0.02) * tracking_from_level);
      state.constraints.push_back({submap, i, match, true});
    }
    state.nodes.push_back(node);
  }
  const int last = room.graph.num_poses() - 1;
  state.constraints.push_back(
      {0, last,
       Between(state.submaps[0].map_from_submap, room.truth[last] * Pose2(0.0, 0.0, -0.1 * last)),
       false});
  return state;
}

double MeanErrorM(const CartographerState& state, const NoisyRoom& room) {
  double sum_m = 0.0;
  for (std::size_t i = 0; i < room.truth.size(); ++i) {
    sum_m += (state.nodes[i].map_from_tracking.translation() - room.truth[i].translation()).norm();
  }
  return sum_m / static_cast<double>(room.truth.size());
}

class CartographerProgramsTest : public ProgramTest {
 protected:
  void WriteState(const PbState& state) const {
    WriteFile(folder_ + "a.pbstream", PbFile(PbMessages(state)));
  }
};

TEST_F(CartographerProgramsTest, ASavedMapIsRefinedAndWrittenBack) {
  const NoisyRoom room = MakeNoisyRoom();
  const PbState state = RoomState(room);
  WriteState(state);
  const Outcome run = Slam("a.pbstream", "--picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, HasSubstr("(pbstream): 15 poses, 21 edges, 12 scans, "));
  EXPECT_THAT(run.out, HasSubstr("\n  12 nodes, 3 submaps; matches are off by "));
  for (const char* name : {"points.ply", "map.pgm", "map.yaml", "before_after.png", "map_given.png",
                           "report.html", "summary.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ + "out/" + name)) << name;
  }
  EXPECT_EQ(Summary()["format"], "pbstream");

  CartographerState given, refined;
  ASSERT_TRUE(ReadCartographerState(folder_ + "a.pbstream", &given).ok());
  ASSERT_TRUE(ReadCartographerState(folder_ + "out/graph.pbstream", &refined).ok());
  EXPECT_LT(MeanErrorM(refined, room), 0.4 * MeanErrorM(given, room));
  EXPECT_LT(MeanErrorM(refined, room), 0.02);
  EXPECT_EQ(refined.submaps[0].map_from_submap.x, given.submaps[0].map_from_submap.x);

  std::vector<TimedPose> trajectory;
  ASSERT_TRUE(ReadTumTrajectory(folder_ + "out/trajectory.tum", &trajectory).ok());
  ASSERT_EQ(trajectory.size(), 12u);
  EXPECT_NEAR(trajectory[5].timestamp_s, 1621887398.816882, 1e-5);
  EXPECT_NEAR(trajectory[5].world_from_robot.x, refined.nodes[5].map_from_tracking.x, 1e-8);

  // The result is an input again.
  std::filesystem::copy(folder_ + "out/graph.pbstream", folder_ + "b.pbstream");
  EXPECT_EQ(Slam("b.pbstream", "--picture_side_px=200").exit_code, 0);
}

TEST_F(CartographerProgramsTest, TheNumberOfThreadsChangesNothing) {
  WriteState(RoomState(MakeNoisyRoom()));
  ASSERT_EQ(Slam("a.pbstream", "--picture_side_px=200 --threads=1", "one").exit_code, 0);
  ASSERT_EQ(Slam("a.pbstream", "--picture_side_px=200 --threads=2", "two").exit_code, 0);
  for (const char* name : {"graph.pbstream", "trajectory.tum", "points.ply"}) {
    EXPECT_EQ(Result("one", name), Result("two", name)) << name;
  }
}

TEST_F(CartographerProgramsTest, FrozenTrajectoriesAndLandmarksAreWarnings) {
  const NoisyRoom room = MakeNoisyRoom();
  PbState state = RoomState(room);
  PbNode node = state.nodes[0];
  node.trajectory = 1;
  state.nodes.push_back(node);
  state.submaps.push_back({1, 0, {}});
  state.constraints.push_back({3, 0, state.nodes[0].map_from_level, false});
  state.pose_graph_extras = PbBytes(5, PbBytes(1, "landmark") + PbBytes(2, PbPose({})));
  WriteState(state);
  const Outcome run = Slam("a.pbstream", "--picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("a.pbstream: trajectory 1 has no constraints within its submaps"));
  EXPECT_THAT(run.err,
              HasSubstr("a.pbstream: landmarks are neither used nor moved [landmarks_unused]\n"));
  CartographerState refined;
  ASSERT_TRUE(ReadCartographerState(folder_ + "out/graph.pbstream", &refined).ok());
  EXPECT_NEAR(refined.nodes[12].map_from_tracking.x, node.map_from_level.x, 1e-15);
}

TEST_F(CartographerProgramsTest, FlagsOfLogsAndOtherProgramsAreRefused) {
  WriteState(SmallPbState());
  ExpectError(Slam("a.pbstream", "--max_scans=5"),
              "--max_scans goes with a log, but " + folder_ + "a.pbstream is a pose graph");
  const std::string in = folder_ + "a.pbstream";
  ExpectError(Run("convert", "--input=" + in + " --output=" + folder_ + "a.tum"),
              in + ": a map that Cartographer has saved, and no log; plumbline_slam refines it");
  ExpectError(Slam("none.pbstream"), "none.pbstream': No such file");
}

// A vehicle between shelves.
TEST_F(CartographerProgramsTest, TheMapOfAVehicleHasThinnerWalls) {
  const std::string path = DatasetsFolder() + "/ecosystem/cartographer_agv.pbstream";
  if (DatasetsFolder().empty() || !std::filesystem::exists(path)) {
    GTEST_SKIP() << "PLUMBLINE_DATASETS has no ecosystem/cartographer_agv.pbstream";
  }
  const Outcome run =
      Run("slam", "--log=" + path + " --output_dir=" + folder_ + "out --picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, HasSubstr("1134 scans, 233050 returns"));
  EXPECT_THAT(run.out, HasSubstr("The refined map is consistent"));
  const nlohmann::json stages = Summary()["stages"];
  ASSERT_EQ(stages.size(), 4u);
  EXPECT_GT(stages[0]["wall_thickness_m"], 0.044);
  EXPECT_LT(stages[2]["wall_thickness_m"], 0.029);  // the measured ranges at refined poses
  CartographerState refined;
  ASSERT_TRUE(ReadCartographerState(folder_ + "out/graph.pbstream", &refined).ok());
  EXPECT_EQ(refined.nodes.size(), 1134u);
}

}  // namespace
}  // namespace plumbline
