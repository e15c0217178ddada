#include "plumbline/apps/pictures/png_file.h"

#include <png.h>

#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <vector>

namespace plumbline {
namespace {

constexpr int kBytesPerPixel = 3;
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

// Cairo has a pixel in an integer of 32 bits, in whatever order of bytes the machine has.
void UnpackRow(const unsigned char* pixels, std::vector<unsigned char>* row) {
  const auto* const values = reinterpret_cast<const std::uint32_t*>(pixels);
  for (std::size_t x = 0; x < row->size() / kBytesPerPixel; ++x) {
    (*row)[kBytesPerPixel * x] = static_cast<unsigned char>(values[x] >> 16);
    (*row)[kBytesPerPixel * x + 1] = static_cast<unsigned char>(values[x] >> 8);
    (*row)[kBytesPerPixel * x + 2] = static_cast<unsigned char>(values[x]);
  }
}

// Apart from what is destroyed at the end of a scope, which a jump out of libpng would skip.
bool WriteRows(png_structp png, png_infop info, cairo_surface_t* surface,
               std::vector<unsigned char>* row) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  const auto height = static_cast<png_uint_32>(cairo_image_surface_get_height(surface));
  png_set_IHDR(png, info, static_cast<png_uint_32>(row->size() / kBytesPerPixel), height, 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, kCompressionLevel);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_write_info(png, info);
  const unsigned char* pixels = cairo_image_surface_get_data(surface);
  for (png_uint_32 y = 0; y < height; ++y) {
    UnpackRow(pixels, row);
    png_write_row(png, row->data());
    pixels += cairo_image_surface_get_stride(surface);
  }
  png_write_end(png, info);
  return true;
}

}  // namespace

bool WritePng(cairo_surface_t* surface, std::ostream* stream, std::string* error) {
  cairo_surface_flush(surface);
  std::vector<unsigned char> row(static_cast<std::size_t>(kBytesPerPixel) *
                                 cairo_image_surface_get_width(surface));
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
