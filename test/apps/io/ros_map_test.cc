#include "plumbline/apps/io/ros_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>

#include "plumbline/test/apps/io/ros_map_reader.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

OccupancyGrid SmallGrid() {
  const Occupancy u = Occupancy::kUnknown, f = Occupancy::kFree, o = Occupancy::kOccupied;
  return {0.05, -1.25, 500000.3, 3, 2, {u, f, o, f, f, u}};
}

TEST(RosMapTest, WritesTheTopRowFirst) {
  const std::string folder = TempFolder();
  ASSERT_TRUE(WriteRosMap(folder + "map", SmallGrid()).ok());
  EXPECT_EQ(ReadFile(folder + "map.pgm"), std::string("P5\n3 2\n255\n\xfe\xfe\xcd\xcd\xfe\0", 17));
  EXPECT_EQ(ReadFile(folder + "map.yaml"),
            "image: map.pgm\nmode: trinary\nresolution: 0.05\norigin: [-1.25, 500000.3, 0]\n"
            "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
  EXPECT_EQ(NumFilesIn(folder), 2);
}

TEST(RosMapTest, AnyNameOfTheImageIsReadBack) {
  for (const char* name :
       {"a: b", "# a", "it's", "a\"b", " a", "[a", "gr\xc3\xb6\xc3\x9f", "a\nb"}) {
    const std::string folder = TempFolder();
    ASSERT_TRUE(WriteRosMap(folder + name, SmallGrid()).ok());
    const YAML::Node map = YAML::LoadFile(folder + name + ".yaml");
    EXPECT_EQ(map["image"].as<std::string>(), std::string(name) + ".pgm");
    EXPECT_EQ(map["resolution"].as<double>(), 0.05);
  }
}

TEST(RosMapTest, AMapServerReadsTheSameGridBack) {
  const std::string folder = TempFolder();
  const OccupancyGrid grid = SmallGrid();
  ASSERT_TRUE(WriteRosMap(folder + "map", grid).ok());
  const ServedMap map = ServeMap(folder + "map.yaml");
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      const double x = -1.25 + 0.05 * (column + 0.5), y = 500000.3 + 0.05 * (row + 0.5);
      EXPECT_EQ(map.At(x, y), grid.At(column, row)) << column << ' ' << row;
    }
  }
}

TEST(RosMapTest, FilesThatCannotBeWrittenLeaveNothingHalfWritten) {
  const std::string folder = TempFolder();
  EXPECT_EQ(WriteRosMap(folder + "none/map", SmallGrid()).code(), StatusCode::kUnavailable);
  std::filesystem::create_directories(folder + "map.yaml/in_the_way");
  EXPECT_FALSE(WriteRosMap(folder + "map", SmallGrid()).ok());
  EXPECT_EQ(NumFilesIn(folder), 1);
}

}  // namespace
}  // namespace plumbline
