#include "plumbline/apps/run/run_outputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plumbline/test/apps/io/ros_map_reader.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

class RunOutputsTest : public testing::Test {
 protected:
  RunOutputsTest() : room_(MakeNoisyRoom()), poses_before_(room_.state.poses) {
    options_.picture_side_px = 300;
    options_.map_resolution_m = 0.1;
  }

  Status Write(const std::string& folder, const MapConsistency* consistency, int num_threads) {
    const RefinedMap map{&room_.graph, &room_.state, &poses_before_, "seed",
                         consistency,  nullptr,      &warning_};
    OutputFolder output(folder_ + folder);
    EXPECT_TRUE(output.Make().ok());
    ThreadPool pool(num_threads);
    return RunAll(MapWriteTasks(map, options_, output), &pool);
  }

  const std::string folder_ = TempFolder();
  NoisyRoom room_;
  const std::vector<double> poses_before_;
  RunOutputOptions options_;
  std::string warning_;
};

TEST_F(RunOutputsTest, ProcessesThatShareTheGraphWriteTheSameFiles) {
  MapConsistency consistency;
  consistency.places.push_back({0, 5, {1.0, 0.5}});
  DisturbPoints(0.01, &room_.state);
  ASSERT_TRUE(Write("one", &consistency, 1).ok());
  OutputFolder made(folder_ + "three");
  ASSERT_TRUE(made.Make().ok());
  RunOnParts(room_.graph, 3, [&](const SlamGraph& part) {
    ASSERT_LT(part.num_scans(), room_.graph.num_scans());
    const MapState state = PartOf(part, room_.state);
    const RefinedMap map{&part, &state, &poses_before_, "seed", &consistency, nullptr, nullptr};
    const OutputFolder output(folder_ + "three");
    ThreadPool pool(1);
    EXPECT_TRUE(RunAll(MapWriteTasks(map, options_, output), &pool, part.peers()).ok());
  });
  EXPECT_EQ(NumFilesIn(folder_ + "three"), NumFilesIn(folder_ + "one"));
  for (const auto& entry : std::filesystem::directory_iterator(folder_ + "one")) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(ReadFile(folder_ + "one/" + name) == ReadFile(folder_ + "three/" + name)) << name;
  }
}

TEST_F(RunOutputsTest, ProcessesThatShareTheGraphAllLearnThatAFileCannotBeWritten) {
  for (const char* taken : {"points.ply", "map_refined.png", "map.pgm"}) {
    const std::string folder = folder_ + "without_" + taken;
    OutputFolder made(folder);
    ASSERT_TRUE(made.Make().ok());
    std::filesystem::create_directories(folder + "/" + taken);
    RunOnParts(room_.graph, 2, [&](const SlamGraph& part) {
      const MapState state = PartOf(part, room_.state);
      const RefinedMap map{&part, &state, &poses_before_, "seed", nullptr, nullptr, nullptr};
      const OutputFolder output(folder);
      ThreadPool pool(1);
      const Status status = RunAll(MapWriteTasks(map, options_, output), &pool, part.peers());
      EXPECT_EQ(status.code(), StatusCode::kUnavailable);
      EXPECT_THAT(status.message(), HasSubstr(taken));
    });
  }
}

TEST_F(RunOutputsTest, WritesTheSameFilesWithAnyNumberOfThreads) {
  const MapConsistency consistency;
  ASSERT_TRUE(Write("one", &consistency, 1).ok());
  ASSERT_TRUE(Write("three", &consistency, 3).ok());
  const std::vector<std::string> names = {"before_after.png", "conflicts.png",   "map.pgm",
                                          "map.yaml",         "map_refined.png", "points.pcd",
                                          "points.ply"};
  EXPECT_EQ(NumFilesIn(folder_ + "one"), static_cast<int>(names.size()));
  for (const std::string& name : names) {
    const std::string content = ReadFile(folder_ + "one/" + name);
    EXPECT_FALSE(content.empty()) << name;
    EXPECT_TRUE(content == ReadFile(folder_ + "three/" + name)) << name;
    EXPECT_THAT(MapFilesText(true), HasSubstr(name));
  }
  EXPECT_EQ(ServeMap(folder_ + "one/map.yaml").resolution, 0.1);
  EXPECT_EQ(warning_, "");
}

TEST_F(RunOutputsTest, NoPictureOfConflictsThatWereNotMeasured) {
  ASSERT_TRUE(Write("out", nullptr, 2).ok());
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out/conflicts.png"));
  EXPECT_THAT(MapFilesText(false), testing::Not(HasSubstr("conflicts.png")));
}

TEST_F(RunOutputsTest, AMapThatIsTooLargeGetsCoarserCells) {
  options_.map_max_cells = 1000;
  ASSERT_TRUE(Write("out", nullptr, 2).ok());
  EXPECT_EQ(ServeMap(folder_ + "out/map.yaml").resolution, 0.2);
  EXPECT_THAT(warning_, testing::MatchesRegex("the map, [0-9.]+ m x [0-9.]+ m, is too large for "
                                              "cells of 0.1 m .1000 at most.: those of map.pgm "
                                              "are 0.2 m"));
}

TEST_F(RunOutputsTest, ALimitOfMemoryBoundsTheMap) {
  options_.LimitGrid(5e8);
  EXPECT_EQ(options_.map_max_cells, 1e8);
  options_.LimitGrid(1e9);
  EXPECT_EQ(options_.map_max_cells, 1e8);
}

TEST_F(RunOutputsTest, AFileInTheWayLeavesTheOthersWhole) {
  std::filesystem::create_directories(folder_ + "out/points.ply/inside");
  const Status status = Write("out", nullptr, 2);
  EXPECT_THAT(status.message(), HasSubstr("cannot write '" + folder_ + "out/points.ply'"));
  EXPECT_EQ(NumFilesIn(folder_ + "out"), 6);  // and nothing half-written
  EXPECT_EQ(ServeMap(folder_ + "out/map.yaml").resolution, 0.1);
}

TEST_F(RunOutputsTest, OptionsOutOfRangeAreNamed) {
  RunOutputOptions options;
  std::string error;
  EXPECT_TRUE(options.Check(&error));
  options.map_resolution_m = 0.0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_THAT(error, HasSubstr("resolution_m = 0"));
  options = RunOutputOptions();
  options.picture_side_px = 40000;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_THAT(error, HasSubstr("max_side_px = 40000"));
}

}  // namespace
}  // namespace plumbline
