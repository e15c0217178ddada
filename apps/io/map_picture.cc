#include "plumbline/apps/io/map_picture.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <ostream>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr int kHeaderPx = 44;     // strip of the title
constexpr int kFooterPx = 56;     // strip of the scale bar
constexpr int kBorderPx = 20;     // left and right of the map
constexpr int kMinWidthPx = 640;  // room for title and scale bar
constexpr double kFontPx = 18.0;
constexpr double kMaxExtentM = 1e9;  // no map; keeps pixel arithmetic far from overflow

/// An interval of world coordinates [m].
struct Interval {
  double low = 0.0, high = 0.0;
  double length() const { return high - low; }
};

/// Pixels of the map area; column 0 and row 0 are at the top left.
struct Raster {
  double pixel_m = 0.0;
  double left_m = 0.0;  ///< world x of the left edge
  double top_m = 0.0;   ///< world y of the upper edge
  int width = 0, height = 0;

  double Column(double x_m) const { return (x_m - left_m) / pixel_m; }
  double Row(double y_m) const { return (top_m - y_m) / pixel_m; }
};

/// The largest of 1, 2, 2.5, 5 times a power of ten that is <= value, or the smallest that is
/// >= value.
double RoundDownToNice(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (double factor : {5.0, 2.5, 2.0}) {
    if (factor * decade <= value) return factor * decade;
  }
  return decade;
}

double RoundUpToNice(double value) {
  const double below = RoundDownToNice(value);
  if (below >= value) return below;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (double factor : {2.0, 2.5, 5.0}) {
    if (factor * decade >= value) return factor * decade;
  }
  return 10.0 * decade;
}

/// Range of one coordinate (0 = x, 1 = y) that the picture shows, margin included.
Interval VisibleInterval(const SlamGraph& graph, int coordinate, double crop_share) {
  // A quantile of a million samples is as good as one of thirty million.
  const std::size_t stride = 1 + graph.num_returns() / 1000000;
  std::vector<double> samples;
  for (std::size_t i = 0; i < graph.num_returns(); i += stride) {
    const double value = graph.points()[2 * i + coordinate];
    if (std::isfinite(value)) samples.push_back(value);
  }
  Interval interval{graph.poses()[coordinate], graph.poses()[coordinate]};
  const auto include = [&interval](double value) {
    interval.low = std::min(interval.low, value);
    interval.high = std::max(interval.high, value);
  };
  for (std::size_t i = coordinate; i < graph.poses().size(); i += 3) include(graph.poses()[i]);
  if (!samples.empty()) {
    const std::size_t outside = static_cast<std::size_t>(crop_share * samples.size());
    for (std::size_t rank : {outside, samples.size() - 1 - outside}) {
      std::nth_element(samples.begin(), samples.begin() + rank, samples.end());
      include(samples[rank]);
    }
  }
  const double margin = std::max(0.5, 0.03 * interval.length());
  return {interval.low - margin, interval.high + margin};
}

Raster ChooseRaster(const Interval& x, const Interval& y, int max_side_px) {
  Raster raster;
  // One pixel of the side is lost to snapping the edges to the grid.
  const double side_m = std::max(x.length(), y.length());
  raster.pixel_m = std::max(0.01, RoundUpToNice(side_m / (max_side_px - 1)));
  raster.left_m = std::floor(x.low / raster.pixel_m) * raster.pixel_m;
  raster.top_m = std::ceil(y.high / raster.pixel_m) * raster.pixel_m;
  raster.width = static_cast<int>(std::ceil(raster.Column(x.high)));
  raster.height = static_cast<int>(std::ceil(raster.Row(y.low)));
  return raster;
}

std::vector<std::uint32_t> CountHits(const SlamGraph& graph, const Raster& raster) {
  std::vector<std::uint32_t> hits(static_cast<std::size_t>(raster.width) * raster.height, 0);
  for (std::size_t i = 0; i < graph.num_returns(); ++i) {
    const double column = raster.Column(graph.points()[2 * i]);
    const double row = raster.Row(graph.points()[2 * i + 1]);
    // Written so that a coordinate that is not a number fails.
    if (!(column >= 0.0 && column < raster.width && row >= 0.0 && row < raster.height)) continue;
    ++hits[static_cast<std::size_t>(row) * raster.width + static_cast<std::size_t>(column)];
  }
  return hits;
}

/// Number of hits that is drawn black: what the fullest tenth of the pixels that were hit has.
double BlackLevel(const std::vector<std::uint32_t>& hits) {
  std::vector<std::uint32_t> positive;
  for (std::uint32_t count : hits) {
    if (count > 0) positive.push_back(count);
  }
  if (positive.empty()) return 1.0;
  const auto level = positive.begin() + (positive.size() - 1) * 9 / 10;
  std::nth_element(positive.begin(), level, positive.end());
  return *level;
}

/// Gray value of a pixel with `count` >= 1 hits. Hits on a wall differ by orders of magnitude with
/// the robot's distance and dwell, hence a logarithm; a single hit must still be seen, hence a
/// floor.
std::uint32_t GrayLevel(std::uint32_t count, double black_level) {
  constexpr double kFaintest = 0.2;
  const double exposure = std::min(1.0, std::log1p(count) / std::log1p(black_level));
  const double darkness = std::max(kFaintest, exposure);
  return static_cast<std::uint32_t>(std::lround(255.0 * (1.0 - darkness)));
}

struct CairoDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, CairoDeleter>;
using Context = std::unique_ptr<cairo_t, CairoDeleter>;

/// Fills the canvas white and puts the density image with its upper left corner at (left, top).
void DrawDensity(const std::vector<std::uint32_t>& hits, const Raster& raster, int left, int top,
                 cairo_surface_t* surface) {
  const double black_level = BlackLevel(hits);
  cairo_surface_flush(surface);
  unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  std::fill(data, data + static_cast<std::size_t>(stride) * cairo_image_surface_get_height(surface),
            255);
  for (int row = 0; row < raster.height; ++row) {
    auto* pixels =
        reinterpret_cast<std::uint32_t*>(data + static_cast<std::size_t>(stride) * (top + row)) +
        left;
    for (int column = 0; column < raster.width; ++column) {
      const std::uint32_t count = hits[static_cast<std::size_t>(row) * raster.width + column];
      if (count > 0) pixels[column] = 0x010101u * GrayLevel(count, black_level);
    }
  }
  cairo_surface_mark_dirty(surface);
}

void DrawTrajectory(const SlamGraph& graph, const Raster& raster, cairo_t* context) {
  cairo_set_source_rgb(context, 0.85, 0.15, 0.1);
  cairo_set_line_width(context, 1.5);
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    const Pose2 robot = graph.WorldFromRobot(pose);
    cairo_line_to(context, raster.Column(robot.x), raster.Row(robot.y));
  }
  cairo_stroke(context);
  const Pose2 start = graph.WorldFromRobot(0);
  cairo_arc(context, raster.Column(start.x), raster.Row(start.y), 6.0, 0.0, 2.0 * kPi);
  cairo_set_source_rgb(context, 0.1, 0.6, 0.2);
  cairo_fill(context);
}

std::string WithThousands(std::size_t number) {
  std::string text = std::to_string(number);
  for (int i = static_cast<int>(text.size()) - 3; i > 0; i -= 3) text.insert(i, ",");
  return text;
}

void DrawText(const std::string& text, double x, double y, cairo_t* context) {
  cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, kFontPx);
  cairo_move_to(context, x, y);
  cairo_show_text(context, text.c_str());
  cairo_new_path(context);  // Text leaves its end behind as the current point.
}

void DrawTitle(const SlamGraph& graph, const std::string& title, cairo_t* context) {
  const std::string numbers = WithThousands(graph.num_scans()) + " scans, " +
                              WithThousands(graph.num_returns()) + " returns";
  cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
  DrawText(title.empty() ? numbers : title + ": " + numbers, kBorderPx, 0.65 * kHeaderPx, context);
}

/// A bar of a round length, about a sixth of the map's width, with its length in m. (x, y) is the
/// left end of the bar.
void DrawScaleBar(const Raster& raster, double x, double y, cairo_t* context) {
  const double length_m = RoundDownToNice(std::max(raster.width / 6.0, 50.0) * raster.pixel_m);
  const double length_px = length_m / raster.pixel_m;
  constexpr double kTickPx = 5.0;
  cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
  cairo_set_line_width(context, 2.0);
  cairo_move_to(context, x, y - kTickPx);
  cairo_line_to(context, x, y + kTickPx);
  cairo_move_to(context, x, y);
  cairo_line_to(context, x + length_px, y);
  cairo_move_to(context, x + length_px, y - kTickPx);
  cairo_line_to(context, x + length_px, y + kTickPx);
  cairo_stroke(context);
  char label[32];
  std::snprintf(label, sizeof(label), "%g m", length_m);
  DrawText(label, x + length_px + 12.0, y + 0.35 * kFontPx, context);
}

cairo_status_t WriteBytes(void* stream, const unsigned char* data, unsigned int size) {
  static_cast<std::ostream*>(stream)->write(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;  // AtomicFile::Commit reports a failure.
}

Status CheckInput(const SlamGraph& graph, const MapPictureOptions& options) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("map picture options: " + error);
  if (graph.num_poses() == 0) return Status::InvalidArgument("map picture: the graph has no poses");
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    if (IsFinite(graph.WorldFromRobot(pose))) continue;
    return Status::InvalidArgument("map picture: pose " + std::to_string(pose) + " is not finite");
  }
  return Status::Ok();
}

}  // namespace

bool MapPictureOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(max_side_px, >=, 100);
  PLUMBLINE_CHECK_OPTION(max_side_px, <=, 30000);  // Cairo's images end at 32767 pixels.
  PLUMBLINE_CHECK_OPTION(crop_share, >=, 0.0);
  PLUMBLINE_CHECK_OPTION(crop_share, <, 0.5);
  return true;
}

Status WriteMapPicture(const std::string& path, const SlamGraph& graph,
                       const MapPictureOptions& options) {
  PLUMBLINE_RETURN_IF_ERROR(CheckInput(graph, options));
  const Interval x = VisibleInterval(graph, 0, options.crop_share);
  const Interval y = VisibleInterval(graph, 1, options.crop_share);
  for (double edge_m : {x.low, x.high, y.low, y.high}) {
    if (std::abs(edge_m) < kMaxExtentM) continue;
    return Status::InvalidArgument("map picture: the map reaches " + std::to_string(edge_m) +
                                   " m from the origin");
  }
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));

  const Raster raster = ChooseRaster(x, y, options.max_side_px);
  const int width = std::max(raster.width + 2 * kBorderPx, kMinWidthPx);
  const int height = raster.height + kHeaderPx + kFooterPx;
  const int map_left = (width - raster.width) / 2;
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) {
    return Status::Unavailable("no memory for the picture '" + path + "'");
  }
  DrawDensity(CountHits(graph, raster), raster, map_left, kHeaderPx, surface.get());

  const Context context(cairo_create(surface.get()));
  DrawTitle(graph, options.title, context.get());
  DrawScaleBar(raster, kBorderPx, height - 0.5 * kFooterPx, context.get());
  cairo_translate(context.get(), map_left, kHeaderPx);
  DrawTrajectory(graph, raster, context.get());

  cairo_status_t result = cairo_status(context.get());
  if (result == CAIRO_STATUS_SUCCESS) {
    result = cairo_surface_write_to_png_stream(surface.get(), WriteBytes, &file.stream());
  }
  if (result != CAIRO_STATUS_SUCCESS) {
    return Status::Unavailable("cannot draw '" + path + "': " + cairo_status_to_string(result));
  }
  return file.Commit();
}

}  // namespace plumbline
