#ifndef PLUMBLINE_TEST_APPS_PICTURES_PICTURE_H_
#define PLUMBLINE_TEST_APPS_PICTURES_PICTURE_H_

#include <cairo/cairo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace plumbline {

/// Pixels: first and one past the last.
struct Box {
  int left, right, top, bottom;
  int height() const { return bottom - top; }
  double center_x() const { return 0.5 * (left + right); }
  double center_y() const { return 0.5 * (top + bottom); }
};

/// A decoded PNG.
struct Picture {
  explicit Picture(const std::string& path) {
    cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
    EXPECT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    width = cairo_image_surface_get_width(surface);
    height = cairo_image_surface_get_height(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int row = 0; row < height; ++row) {
      const auto* line = reinterpret_cast<const std::uint32_t*>(
          cairo_image_surface_get_data(surface) + static_cast<std::size_t>(stride) * row);
      for (int column = 0; column < width; ++column) rgb.push_back(line[column] & 0xffffffu);
    }
    cairo_surface_destroy(surface);
  }

  int Count(bool (*is_it)(std::uint32_t)) const {
    return static_cast<int>(std::count_if(rgb.begin(), rgb.end(), is_it));
  }
  /// The box around a kind of pixels.
  Box Around(bool (*is_it)(std::uint32_t)) const { return Around(is_it, Box{0, width, 0, height}); }
  /// The same within a part of the picture.
  Box Around(bool (*is_it)(std::uint32_t), const Box& part) const {
    Box box{width, 0, height, 0};
    for (int row = part.top; row < part.bottom; ++row) {
      for (int column = part.left; column < part.right; ++column) {
        if (!is_it(rgb[static_cast<std::size_t>(row) * width + column])) continue;
        box.left = std::min(box.left, column), box.right = std::max(box.right, column + 1);
        box.top = std::min(box.top, row), box.bottom = std::max(box.bottom, row + 1);
      }
    }
    return box;
  }

  int width = 0, height = 0;
  std::vector<std::uint32_t> rgb;
};

inline int Channel(std::uint32_t rgb, int shift) { return static_cast<int>(rgb >> shift & 0xffu); }
inline bool IsRed(std::uint32_t rgb) { return Channel(rgb, 16) > 80 + Channel(rgb, 8); }
inline bool IsGreen(std::uint32_t rgb) { return Channel(rgb, 8) > 80 + Channel(rgb, 16); }
inline bool IsBlack(std::uint32_t rgb) { return rgb == 0; }
inline bool IsWhite(std::uint32_t rgb) { return rgb == 0xffffffu; }

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_PICTURES_PICTURE_H_
