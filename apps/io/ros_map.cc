#include "plumbline/apps/io/ros_map.h"

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <ostream>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"

namespace plumbline {
namespace {

char PixelOf(Occupancy occupancy) {
  switch (occupancy) {
    case Occupancy::kOccupied:
      return 0;
    case Occupancy::kFree:
      return static_cast<char>(254);
    case Occupancy::kUnknown:
      break;
  }
  return static_cast<char>(205);
}

void WritePgm(const OccupancyGrid& grid, std::ostream* stream) {
  *stream << "P5\n" << grid.width << ' ' << grid.height << "\n255\n";
  std::vector<char> pixels(grid.width);
  for (int row = grid.height - 1; row >= 0; --row) {
    for (int column = 0; column < grid.width; ++column) {
      pixels[column] = PixelOf(grid.At(column, row));
    }
    stream->write(pixels.data(), grid.width);
  }
}

void WriteYaml(const std::string& image, const OccupancyGrid& grid, std::ostream* stream) {
  YAML::Emitter image_text;  // in quotation marks where YAML needs them
  image_text << image;
  stream->precision(12);  // A micrometre at a million metres, and 0.05 stays 0.05.
  *stream << "image: " << image_text.c_str() << "\nmode: trinary\nresolution: " << grid.resolution_m
          << "\norigin: [" << grid.left_m << ", " << grid.bottom_m
          << ", 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

}  // namespace

Status WriteRosMap(const std::string& stem, const OccupancyGrid& grid) {
  const std::string image_path = stem + ".pgm";
  AtomicFile image, description;
  PLUMBLINE_RETURN_IF_ERROR(image.Open(image_path));
  PLUMBLINE_RETURN_IF_ERROR(description.Open(stem + ".yaml"));
  WritePgm(grid, &image.stream());
  WriteYaml(std::filesystem::path(image_path).filename().string(), grid, &description.stream());
  PLUMBLINE_RETURN_IF_ERROR(image.Commit());
  return description.Commit();
}

}  // namespace plumbline
