// Maps that slam_toolbox has saved, in the programs from end to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/saved_maps/posegraph_writer.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// The room as slam_toolbox would save it: every scan at a pose that is off by some centimetres, and
// edges that say what these poses say, as before the first loop closure.
KartoMap AsKartoMap(const NoisyRoom& room) {
  const SlamGraph& graph = room.graph;
  const LaserModel& laser = graph.LaserOfScan(0);
  KartoMap map;
  map.lasers.push_back({"laser", laser.robot_from_laser, laser.num_beams, laser.first_bearing_rad,
                        laser.bearing_step_rad, 0.1, 80.0, 80.0});
  RandomStates random(21);
  for (int i = 0; i < graph.num_poses(); ++i) {
    const double yaw = random.Gaussian(0.02), y = random.Gaussian(0.05);
    const Pose2 noise = i == 0 ? Pose2() : Pose2(random.Gaussian(0.05), y, yaw);
    KartoScan scan = {i, 100.0 + i, room.truth[i], room.truth[i] * noise, {}};
    scan.ranges = graph.RangesOfScan(i, 80.0);
    map.scans.push_back(scan);
    if (i == 0) continue;
    map.edges.push_back({i - 1, i, Between(map.scans[i - 1].corrected, scan.corrected)});
  }
  return map;
}

class SlamToolboxProgramsTest : public ProgramTest {
 protected:
  double WallThickness(const std::string& stage) const {
    const nlohmann::json summary = Summary();
    for (const auto& entry : summary.at("stages")) {
      if (entry.at("stage") == stage) return entry.at("wall_thickness_m");
    }
    ADD_FAILURE() << "no stage " << stage;
    return 0.0;
  }
};

TEST_F(SlamToolboxProgramsTest, ASavedMapGetsThinnerWallsAndIsSavedAgain) {
  WriteKartoMap(folder_ + "a", AsKartoMap(MakeNoisyRoom()));
  const Outcome run = Slam("a.posegraph", "--picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("a.posegraph (posegraph): "));
  EXPECT_LT(WallThickness("refined, raw ranges"), 0.5 * WallThickness("given"));
  EXPECT_THAT(FilesOf("out"), testing::IsSupersetOf({"graph.data", "graph.posegraph", "map.pgm",
                                                     "map.yaml", "trajectory.tum"}));

  // What it has saved says the same, and needs no more refinement.
  const Outcome again =
      Run("convert", "--input=" + folder_ + "out/graph.posegraph --output=" + folder_ +
                         "again.tum," + folder_ + "again.g2o");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(ReadFile(folder_ + "again.tum"), Result("out", "trajectory.tum"));
  EXPECT_THAT(ReadFile(folder_ + "again.g2o"), HasSubstr("ROBOTLASER1"));
}

TEST_F(SlamToolboxProgramsTest, TheMapIsNotOverwritten) {
  std::filesystem::create_directories(folder_ + "out");
  WriteKartoMap(folder_ + "out/graph", SmallKartoMap());
  const std::string data = Result("out", "graph.data");
  const Outcome run = Slam("out/graph.posegraph");
  EXPECT_EQ(run.exit_code, kExitWrongUsage);
  EXPECT_THAT(run.err, HasSubstr("--log and --output_dir both mean the file"));
  EXPECT_EQ(Result("out", "graph.data"), data);
  // Nor its other file.
  const Outcome convert =
      Run("convert", "--input=" + folder_ + "out/graph.posegraph --format=tum " +
                         "--output=" + folder_ + "out/graph.data");
  EXPECT_EQ(convert.exit_code, kExitWrongUsage);
  EXPECT_EQ(Result("out", "graph.data"), data);
}

TEST_F(SlamToolboxProgramsTest, FlagsOfLogsAreRefused) {
  WriteKartoMap(folder_ + "a", SmallKartoMap());
  ExpectError(Slam("a.posegraph", "--max_scans=2"),
              "--max_scans goes with a log, but " + folder_ + "a.posegraph is a pose graph");
}

TEST_F(SlamToolboxProgramsTest, ARealMapGetsThinnerWalls) {
  const std::string map = DatasetsFolder() + "/ecosystem/slam_toolbox_map.posegraph";
  if (!std::filesystem::exists(map)) {
    GTEST_SKIP() << "needs ecosystem/slam_toolbox_map.posegraph in PLUMBLINE_DATASETS";
  }
  const Outcome run =
      Run("slam", "--log=" + map + " --output_dir=" + folder_ + "out --picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("41 poses, 62 edges, 41 scans, 10061 returns"));
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_NEAR(WallThickness("given"), 0.0184, 0.0005);
  EXPECT_LT(WallThickness("refined, raw ranges"), 0.002);
}

}  // namespace
}  // namespace plumbline
