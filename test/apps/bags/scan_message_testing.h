#ifndef PLUMBLINE_TEST_APPS_BAGS_SCAN_MESSAGE_TESTING_H_
#define PLUMBLINE_TEST_APPS_BAGS_SCAN_MESSAGE_TESTING_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "plumbline/test/apps/bags/bag_testing.h"

namespace plumbline {

/// Echoes and their intensities by beam.
inline std::string MultiEchoBytes(TestEncoding encoding, std::int64_t stamp_ns,
                                  const std::vector<std::vector<double>>& ranges,
                                  const std::vector<std::vector<double>>& intensities,
                                  const LaserModel& laser) {
  MessageWriter writer(encoding);
  writer.Header(stamp_ns, "laser");
  writer.Single(laser.first_bearing_rad);
  writer.Single(laser.first_bearing_rad + laser.bearing_step_rad * (laser.num_beams - 1));
  writer.Single(laser.bearing_step_rad);
  writer.Single(0.0);
  writer.Single(0.0);
  writer.Single(laser.min_range_m);
  writer.Single(laser.max_range_m);
  for (const auto& echoes : {ranges, intensities}) {
    writer.Unsigned(static_cast<std::uint32_t>(echoes.size()));
    for (const std::vector<double>& echo : echoes) {
      writer.Unsigned(static_cast<std::uint32_t>(echo.size()));
      for (const double value : echo) writer.Single(value);
    }
  }
  return writer.bytes();
}

/// Where a driver puts the fields of a point.
struct CloudLayout {
  struct Field {
    std::string name;
    unsigned offset = 0;
    int datatype = 7;  // 7: FLOAT32, 8: FLOAT64, others are filled with zeros
  };
  std::vector<Field> fields;
  unsigned point_step = 0;
  bool is_big_endian = false;
  unsigned height = 1;
  unsigned row_padding = 0;  // bytes behind each row
};
/// Of velodyne_pointcloud up to ROS Melodic, as in the 3D recordings published with Cartographer.
inline CloudLayout VelodyneLayout() {
  return {{{"x", 0}, {"y", 4}, {"z", 8}, {"intensity", 16}, {"ring", 20, 4}}, 32};
}
/// Of the driver of Ouster for ROS 2: destaggered rows.
inline CloudLayout OusterLayout() {
  return {{{"x", 0},
           {"y", 4},
           {"z", 8},
           {"intensity", 16},
           {"t", 20, 6},
           {"reflectivity", 24, 4},
           {"ring", 26, 4},
           {"ambient", 28, 4},
           {"range", 32, 6}},
          48};
}
/// Of laser_geometry: the cloud of a planar laser.
inline CloudLayout PlanarLayout() {
  return {{{"x", 0}, {"y", 4}, {"z", 8}, {"intensity", 12}, {"index", 16, 5}}, 20};
}

inline std::string CloudBytes(TestEncoding encoding, std::int64_t stamp_ns,
                              const std::string& frame,
                              const std::vector<std::array<double, 3>>& points,
                              const CloudLayout& layout) {
  const auto width = static_cast<unsigned>(points.size()) / layout.height;
  const unsigned row_step = width * layout.point_step + layout.row_padding;
  std::string data(layout.height * row_step, '\0');
  for (unsigned i = 0; i < width * layout.height; ++i) {
    const std::size_t at = i / width * row_step + i % width * layout.point_step;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const CloudLayout::Field& field = layout.fields[axis];
      std::string number(field.datatype == 8 ? 8 : 4, '\0');
      const double value = points[i][axis];
      const auto single = static_cast<float>(value);
      std::memcpy(number.data(), field.datatype == 8 ? static_cast<const void*>(&value) : &single,
                  number.size());
      if (layout.is_big_endian) std::reverse(number.begin(), number.end());
      data.replace(at + field.offset, number.size(), number);
    }
  }
  MessageWriter writer(encoding);
  writer.Header(stamp_ns, frame);
  writer.Unsigned(layout.height);
  writer.Unsigned(width);
  writer.Unsigned(static_cast<std::uint32_t>(layout.fields.size()));
  for (const CloudLayout::Field& field : layout.fields) {
    writer.Text(field.name);
    writer.Unsigned(field.offset);
    writer.Byte(field.datatype);
    writer.Unsigned(1);
  }
  writer.Byte(layout.is_big_endian ? 1 : 0);
  writer.Unsigned(layout.point_step);
  writer.Unsigned(row_step);
  writer.Unsigned(static_cast<std::uint32_t>(data.size()));
  writer.Raw(data);
  writer.Byte(1);  // is_dense
  return writer.bytes();
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_BAGS_SCAN_MESSAGE_TESTING_H_
