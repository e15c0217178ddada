#include "plumbline/apps/pictures/png_file.h"

#include <png.h>

#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <vector>

namespace plumbline {
namespace {

// Higher ones take twice as long for a hundredth less.
constexpr int kCompressionLevel = 3;

void KeepError(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

void IgnoreWarning(png_structp, png_const_charp) {}

void WriteBytes(png_structp png, png_bytep data, png_size_t size) {
  auto* const stream = static_cast<std::ostream*>(png_get_io_ptr(png));
  stream->write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
}

void Flush(png_structp) {}

bool IsGray(cairo_surface_t* surface) {
  return cairo_image_surface_get_format(surface) == CAIRO_FORMAT_A8;
}

// Cairo has a pixel in an integer of 32 bits, in whatever order of bytes the machine has.
void UnpackColors(const unsigned char* pixels, std::vector<unsigned char>* row) {
  for (std::size_t x = 0; 3 * x < row->size(); ++x) {
    std::uint32_t pixel = 0;
    std::memcpy(&pixel, pixels + sizeof(pixel) * x, sizeof(pixel));
    (*row)[3 * x] = static_cast<unsigned char>(pixel >> 16);
    (*row)[3 * x + 1] = static_cast<unsigned char>(pixel >> 8);
    (*row)[3 * x + 2] = static_cast<unsigned char>(pixel);
  }
}

// Apart from what is destroyed at the end of a scope, which a jump out of libpng would skip.
bool WriteRows(png_structp png, png_infop info, cairo_surface_t* surface,
               std::vector<unsigned char>* row) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  const bool is_gray = IsGray(surface);
  const auto width = static_cast<png_uint_32>(cairo_image_surface_get_width(surface));
  const auto height = static_cast<png_uint_32>(cairo_image_surface_get_height(surface));
  png_set_IHDR(png, info, width, height, 8, is_gray ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, kCompressionLevel);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_write_info(png, info);
  const unsigned char* pixels = cairo_image_surface_get_data(surface);
  for (png_uint_32 y = 0; y < height; ++y) {
    if (!is_gray) UnpackColors(pixels, row);
    png_write_row(png, is_gray ? pixels : row->data());
    pixels += cairo_image_surface_get_stride(surface);
  }
  png_write_end(png, info);
  return true;
}

}  // namespace

bool WritePng(cairo_surface_t* surface, std::ostream* stream, std::string* error) {
  cairo_surface_flush(surface);
  std::vector<unsigned char> row;
  if (!IsGray(surface)) {
    row.resize(3 * static_cast<std::size_t>(cairo_image_surface_get_width(surface)));
  }
  *error = "out of memory";
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, error, KeepError, IgnoreWarning);
  if (png == nullptr) return false;
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, stream, WriteBytes, Flush);
  const bool written = info != nullptr && WriteRows(png, info, surface, &row);
  png_destroy_write_struct(&png, &info);
  return written;
}

}  // namespace plumbline
