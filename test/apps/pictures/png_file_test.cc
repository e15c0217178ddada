#include "plumbline/apps/pictures/png_file.h"

#include <cairo/cairo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>

#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

constexpr int kSize = 256;

// Writes a drawing with these colors, and reads it back.
Picture WriteAndRead(const std::function<std::uint32_t(int x, int y)>& color) {
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, kSize, kSize);
  cairo_surface_flush(surface);
  for (int y = 0; y < kSize; ++y) {
    auto* const row = reinterpret_cast<std::uint32_t*>(
        cairo_image_surface_get_data(surface) +
        static_cast<std::size_t>(cairo_image_surface_get_stride(surface)) * y);
    for (int x = 0; x < kSize; ++x) row[x] = color(x, y);
  }
  cairo_surface_mark_dirty(surface);
  const std::string path = TempFolder() + "drawing.png";
  std::ofstream file(path, std::ios::binary);
  std::string error;
  EXPECT_TRUE(WritePng(surface, &file, &error)) << error;
  file.close();
  cairo_surface_destroy(surface);
  return Picture(path);
}

TEST(PngFileTest, ADrawingOfFewColorsIsExact) {
  const auto color = [](int x, int y) {
    return static_cast<std::uint32_t>(x / 16 * 0x101112 + y / 64 * 0x00000f) & 0xffffffu;
  };
  const Picture picture = WriteAndRead(color);
  ASSERT_EQ(picture.width, kSize);
  ASSERT_EQ(picture.height, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      ASSERT_EQ(picture.rgb[static_cast<std::size_t>(kSize) * y + x], color(x, y)) << x << ' ' << y;
    }
  }
}

// 65536 colors beside an area of one: four bits of a channel are kept, or three.
TEST(PngFileTest, BlendsAreReducedAndAreasKeepTheirColor) {
  constexpr std::uint32_t kArea = 0x7fe501u;
  const auto color = [](int x, int y) {
    if (x >= kSize / 2) return kArea;
    return static_cast<std::uint32_t>(2 * x) << 16 | static_cast<std::uint32_t>(y) << 8;
  };
  const Picture picture = WriteAndRead(color);
  int worst = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const std::uint32_t read = picture.rgb[static_cast<std::size_t>(kSize) * y + x];
      if (x >= kSize / 2) ASSERT_EQ(read, kArea) << x << ' ' << y;
      for (const int shift : {0, 8, 16}) {
        worst = std::max(worst, std::abs(Channel(read, shift) - Channel(color(x, y), shift)));
      }
    }
  }
  EXPECT_GT(worst, 0);
  EXPECT_LT(worst, 32);
}

TEST(PngFileTest, ShadesOfGrayAreExact) {
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_A8, kSize, 1);
  cairo_surface_flush(surface);
  for (int x = 0; x < kSize; ++x) {
    cairo_image_surface_get_data(surface)[x] = static_cast<unsigned char>(x);
  }
  cairo_surface_mark_dirty(surface);
  const std::string path = TempFolder() + "gray.png";
  std::ofstream file(path, std::ios::binary);
  std::string error;
  EXPECT_TRUE(WritePng(surface, &file, &error)) << error;
  file.close();
  cairo_surface_destroy(surface);
  const Picture picture(path);
  ASSERT_EQ(picture.width, kSize);
  for (int x = 0; x < kSize; ++x) {
    EXPECT_EQ(picture.rgb[x], static_cast<std::uint32_t>(x) * 0x010101u);
  }
}

}  // namespace
}  // namespace plumbline
