#ifndef PLUMBLINE_TEST_APPS_IO_ROS_MAP_READER_H_
#define PLUMBLINE_TEST_APPS_IO_ROS_MAP_READER_H_

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {

/// A map as ROS' map server gives it to a robot, after the files' own convention.
struct ServedMap {
  double resolution = 0.0, origin_x = 0.0, origin_y = 0.0, origin_yaw = 1.0;
  double occupied_thresh = 0.0, free_thresh = 0.0;
  int width = 0, height = 0;
  std::string pixels;  ///< as in the file, the top row first

  /// What is at a point of the world [m].
  Occupancy At(double x, double y) const {
    const int column = static_cast<int>(std::floor((x - origin_x) / resolution));
    const int row_from_below = static_cast<int>(std::floor((y - origin_y) / resolution));
    if (column < 0 || column >= width || row_from_below < 0 || row_from_below >= height) {
      return Occupancy::kUnknown;
    }
    const unsigned char pixel = pixels[(height - 1 - row_from_below) * width + column];
    const double probability = (255 - pixel) / 255.0;
    if (probability > occupied_thresh) return Occupancy::kOccupied;
    return probability < free_thresh ? Occupancy::kFree : Occupancy::kUnknown;
  }
};

inline ServedMap ServeMap(const std::string& yaml_path) {
  std::map<std::string, std::string> fields;
  std::istringstream yaml(ReadFile(yaml_path));
  for (std::string line; std::getline(yaml, line);) {
    const std::size_t colon = line.find(": ");
    EXPECT_NE(colon, std::string::npos) << line;
    fields[line.substr(0, colon)] = line.substr(colon + 2);
  }
  ServedMap map;
  EXPECT_EQ(fields["negate"], "0");
  map.resolution = std::stod(fields["resolution"]);
  map.occupied_thresh = std::stod(fields["occupied_thresh"]);
  map.free_thresh = std::stod(fields["free_thresh"]);
  EXPECT_EQ(std::sscanf(fields["origin"].c_str(), "[%lf, %lf, %lf]", &map.origin_x, &map.origin_y,
                        &map.origin_yaw),
            3);
  EXPECT_EQ(map.origin_yaw, 0.0);
  const std::filesystem::path image =
      std::filesystem::path(yaml_path).parent_path() / fields["image"];
  const std::string pgm = ReadFile(image.string());
  int maximum = 0, header_length = 0;
  EXPECT_EQ(
      std::sscanf(pgm.c_str(), "P5 %d %d %d%n", &map.width, &map.height, &maximum, &header_length),
      3);
  EXPECT_EQ(maximum, 255);
  map.pixels = pgm.substr(header_length + 1);  // one white space ends the header
  EXPECT_EQ(map.pixels.size(), static_cast<std::size_t>(map.width) * map.height);
  return map;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_IO_ROS_MAP_READER_H_
