#include "plumbline/apps/pictures/png_file.h"

#include <png.h>
#include <zlib.h>

#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <ostream>
#include <vector>

namespace plumbline {
namespace {

// Most neighbours in a drawing have the same color. Other strategies take three times as long for
// files that are no smaller.
constexpr int kCompressionStrategy = Z_RLE;

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
std::uint32_t Pixel(const unsigned char* row, std::size_t x) {
  std::uint32_t pixel = 0;
  std::memcpy(&pixel, row + sizeof(pixel) * x, sizeof(pixel));
  return pixel & 0xffffffU;
}

// The colors of a drawing, reduced to the size of a palette. A drawing has few colors of its own;
// thousands more are blends along the edges of lines. Blends that differ in the low bits of their
// channels become the most frequent color among them.
class ReducedColors {
 public:
  explicit ReducedColors(cairo_surface_t* surface) {
    // Two bits per channel are 64 colors.
    for (bits_ = 5; bits_ >= 2 && !Reduce(surface); --bits_) {
    }
  }

  const std::vector<png_color>& palette() const { return palette_; }

  void IndexRow(const unsigned char* pixels, std::vector<unsigned char>* row) const {
    std::uint32_t last = 0;
    unsigned char index = index_[Cell(last)];
    for (std::size_t x = 0; x < row->size(); ++x) {
      const std::uint32_t color = Pixel(pixels, x);
      if (color != last) {
        last = color;
        index = index_[Cell(color)];
      }
      (*row)[x] = index;
    }
  }

 private:
  // The majority vote of Boyer and Moore.
  struct Vote {
    std::uint32_t color = 0;
    std::size_t lead = 0;

    void Add(std::uint32_t candidate, std::size_t count) {
      if (candidate == color) {
        lead += count;
      } else if (lead >= count) {
        lead -= count;
      } else {
        color = candidate;
        lead = count - lead;
      }
    }
  };

  std::size_t Cell(std::uint32_t color) const {
    const std::uint32_t mask = (1U << bits_) - 1;
    const std::uint32_t red = color >> (24 - bits_) & mask;
    const std::uint32_t green = color >> (16 - bits_) & mask;
    const std::uint32_t blue = color >> (8 - bits_) & mask;
    return (red << (2 * bits_)) + (green << bits_) + blue;
  }

  // False if there are too many colors at this number of bits.
  bool Reduce(cairo_surface_t* surface) {
    std::vector<Vote> votes(std::size_t{1} << (3 * bits_));
    std::vector<char> is_used(votes.size(), 0);
    const auto width = static_cast<std::size_t>(cairo_image_surface_get_width(surface));
    const unsigned char* pixels = cairo_image_surface_get_data(surface);
    for (int y = 0; y < cairo_image_surface_get_height(surface); ++y) {
      for (std::size_t x = 0, end = 0; x < width; x = end) {
        const std::uint32_t color = Pixel(pixels, x);
        for (end = x + 1; end < width && Pixel(pixels, end) == color; ++end) {
        }
        votes[Cell(color)].Add(color, end - x);
        is_used[Cell(color)] = 1;
      }
      pixels += cairo_image_surface_get_stride(surface);
    }
    palette_.clear();
    index_.assign(votes.size(), 0);
    for (std::size_t cell = 0; cell < votes.size(); ++cell) {
      if (is_used[cell] == 0) continue;
      if (palette_.size() == PNG_MAX_PALETTE_LENGTH) return false;
      index_[cell] = static_cast<unsigned char>(palette_.size());
      const std::uint32_t color = votes[cell].color;
      palette_.push_back({static_cast<png_byte>(color >> 16), static_cast<png_byte>(color >> 8),
                          static_cast<png_byte>(color)});
    }
    return true;
  }

  int bits_ = 0;  // of a channel that count
  std::vector<png_color> palette_;
  std::vector<unsigned char> index_;  // in the palette, per cell
};

// Apart from what is destroyed at the end of a scope, which a jump out of libpng would skip.
bool WriteRows(png_structp png, png_infop info, cairo_surface_t* surface,
               const ReducedColors* colors, std::vector<unsigned char>* row) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  const auto width = static_cast<png_uint_32>(cairo_image_surface_get_width(surface));
  const auto height = static_cast<png_uint_32>(cairo_image_surface_get_height(surface));
  png_set_IHDR(png, info, width, height, 8,
               colors == nullptr ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (colors != nullptr) {
    png_set_PLTE(png, info, colors->palette().data(), static_cast<int>(colors->palette().size()));
  }
  png_set_compression_strategy(png, kCompressionStrategy);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_write_info(png, info);
  const unsigned char* pixels = cairo_image_surface_get_data(surface);
  for (png_uint_32 y = 0; y < height; ++y) {
    if (colors != nullptr) colors->IndexRow(pixels, row);
    png_write_row(png, colors != nullptr ? row->data() : pixels);
    pixels += cairo_image_surface_get_stride(surface);
  }
  png_write_end(png, info);
  return true;
}

}  // namespace

bool WritePng(cairo_surface_t* surface, std::ostream* stream, std::string* error) {
  cairo_surface_flush(surface);
  std::optional<ReducedColors> colors;
  if (!IsGray(surface)) colors.emplace(surface);
  std::vector<unsigned char> row(static_cast<std::size_t>(cairo_image_surface_get_width(surface)));
  *error = "out of memory";
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, error, KeepError, IgnoreWarning);
  if (png == nullptr) return false;
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, stream, WriteBytes, Flush);
  const bool written =
      info != nullptr && WriteRows(png, info, surface, colors ? &*colors : nullptr, &row);
  png_destroy_write_struct(&png, &info);
  return written;
}

}  // namespace plumbline
