#include "plumbline/apps/io/map_raster.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

constexpr double kMaxExtentM = 1e9;  // no map; keeps pixel arithmetic far from overflow

/// The smallest of 1, 2, 2.5, 5 times a power of ten that is >= value.
double RoundUpToNice(double value) {
  const double below = RoundDownToNice(value);
  if (below >= value) return below;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (double factor : {2.0, 2.5, 5.0}) {
    if (factor * decade >= value) return factor * decade;
  }
  return 10.0 * decade;
}

/// A quantile of some hundred thousand samples is as good as one of thirty million.
std::size_t SampleStride(std::size_t num_points) { return 1 + num_points / 200000; }

/// Coordinates of some points of a map, those that are not finite left out.
struct Samples {
  std::vector<double> x, y;

  void Add(double sample_x, double sample_y) {
    if (std::isfinite(sample_x)) x.push_back(sample_x);
    if (std::isfinite(sample_y)) y.push_back(sample_y);
  }
};

Samples SampleOf(const MapPoints& points) {
  Samples samples;
  points.ForEvery(SampleStride(points.size()),
                  [&](std::size_t, double x, double y) { samples.Add(x, y); });
  return samples;
}

/// The same samples of points that a graph and its peers have, in another order.
Samples SampleOf(const SlamGraph& graph, const MapPoints& points) {
  if (graph.peers() == nullptr) return SampleOf(points);
  const std::size_t stride = SampleStride(graph.num_returns_of_all());
  Samples samples;
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& own = graph.scan(s);
    const std::size_t first_among_all = graph.all_scans()[graph.IdAmongAll(s)].first_return;
    const std::size_t past_sample = first_among_all % stride;
    std::size_t in_scan = past_sample == 0 ? 0 : stride - past_sample;
    for (; in_scan < static_cast<std::size_t>(own.num_returns); in_scan += stride) {
      const Eigen::Vector2d point = points.At(own.first_return + in_scan);
      samples.Add(point.x(), point.y());
    }
  }
  samples.x = JoinOverPeers(graph.peers(), std::move(samples.x));
  samples.y = JoinOverPeers(graph.peers(), std::move(samples.y));
  return samples;
}

/// Range of one coordinate that the picture shows, margin included.
Interval VisibleInterval(std::vector<double> samples, const std::vector<Pose2>& trajectory,
                         int coordinate, double crop_share) {
  Interval interval{std::numeric_limits<double>::infinity(),
                    -std::numeric_limits<double>::infinity()};
  const auto include = [&interval](double value) {
    interval.low = std::min(interval.low, value);
    interval.high = std::max(interval.high, value);
  };
  for (const Pose2& pose : trajectory) include(pose.translation()[coordinate]);
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

Status FindExtentOf(Samples samples, const std::vector<Pose2>& trajectory, double crop_share,
                    MapExtent* extent) {
  *extent = {VisibleInterval(std::move(samples.x), trajectory, 0, crop_share),
             VisibleInterval(std::move(samples.y), trajectory, 1, crop_share)};
  for (double edge_m : {extent->x.low, extent->x.high, extent->y.low, extent->y.high}) {
    if (std::abs(edge_m) < kMaxExtentM) continue;
    return Status::InvalidArgument("map picture: the map reaches " + std::to_string(edge_m) +
                                   " m from the origin");
  }
  return Status::Ok();
}

MapRaster RasterOver(const MapExtent& extent, int max_side_px, double min_pixel_m) {
  MapRaster raster;
  // One pixel of the side is lost to snapping the edges to the grid.
  const double side_m = std::max(extent.x.length(), extent.y.length());
  raster.pixel_m = std::max(min_pixel_m, RoundUpToNice(side_m / (max_side_px - 1)));
  raster.left_m = std::floor(extent.x.low / raster.pixel_m) * raster.pixel_m;
  raster.top_m = std::ceil(extent.y.high / raster.pixel_m) * raster.pixel_m;
  raster.width = static_cast<int>(std::ceil(raster.Column(extent.x.high)));
  raster.height = static_cast<int>(std::ceil(raster.Row(extent.y.low)));
  return raster;
}

/// Gray value of a pixel with `count` >= 1 hits. Hits on a wall differ by orders of magnitude with
/// the robot's distance and dwell, hence a logarithm; a single hit must still be seen, hence a
/// floor.
std::uint8_t GrayLevel(std::uint32_t count, double black_level) {
  constexpr double kFaintest = 0.2;
  const double exposure = std::min(1.0, std::log1p(count) / std::log1p(black_level));
  const double darkness = std::max(kFaintest, exposure);
  return static_cast<std::uint8_t>(std::lround(255.0 * (1.0 - darkness)));
}

// counts(i): whether a point does.
template <typename Counts>
std::vector<std::uint32_t> CountHitsOf(const MapPoints& points, const MapRaster& raster,
                                       const Counts& counts) {
  std::vector<std::uint32_t> hits(static_cast<std::size_t>(raster.width) * raster.height, 0);
  points.ForEach([&](std::size_t i, double x, double y) {
    const std::ptrdiff_t pixel = raster.PixelAt(x, y);
    if (pixel >= 0 && counts(i)) ++hits[pixel];
  });
  return hits;
}

}  // namespace

double RoundDownToNice(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (double factor : {5.0, 2.5, 2.0}) {
    if (factor * decade <= value) return factor * decade;
  }
  return decade;
}

Status FindExtent(const MapPoints& points, const std::vector<Pose2>& trajectory, double crop_share,
                  MapExtent* extent) {
  return FindExtentOf(SampleOf(points), trajectory, crop_share, extent);
}

Status FindExtent(const SlamGraph& graph, const MapState& state, double crop_share,
                  MapExtent* extent) {
  const MapPoints points(graph, state);
  return FindExtentOf(SampleOf(graph, points), PosesOf(state.poses), crop_share, extent);
}

Status ChooseRaster(const SlamGraph& graph, const MapState& state, double crop_share,
                    int max_side_px, MapRaster* raster, double min_pixel_m) {
  MapExtent extent;
  PLUMBLINE_RETURN_IF_ERROR(FindExtent(graph, state, crop_share, &extent));
  *raster = RasterOver(extent, max_side_px, min_pixel_m);
  return Status::Ok();
}

std::vector<std::uint32_t> CountHits(const MapPoints& points, const MapRaster& raster) {
  return CountHitsOf(points, raster, [](std::size_t) { return true; });
}

std::vector<std::uint32_t> CountHitsAtRest(const SlamGraph& graph, const MapPoints& points,
                                           const MapRaster& raster) {
  return CountHitsOf(points, raster, [&graph](std::size_t r) { return !graph.Moves(r); });
}

void GatherHits(const Peers* peers, int rank, std::vector<std::uint32_t>* hits) {
  if (peers == nullptr) return;
  // Most pixels of a map are white.
  struct Pixel {
    std::uint32_t index, count;
  };
  std::vector<std::vector<Pixel>> to_rank(peers->size());
  if (peers->rank() != rank) {
    for (std::size_t i = 0; i < hits->size(); ++i) {
      if ((*hits)[i] > 0) to_rank[rank].push_back({static_cast<std::uint32_t>(i), (*hits)[i]});
    }
    *hits = std::vector<std::uint32_t>();
  }
  for (const std::vector<Pixel>& of_rank : ExchangeValues(*peers, to_rank)) {
    for (const Pixel& pixel : of_rank) (*hits)[pixel.index] += pixel.count;
  }
}

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

std::vector<std::uint8_t> DensityImage(const std::vector<std::uint32_t>& hits, double black_level) {
  std::vector<std::uint8_t> gray(hits.size(), 255);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i] > 0) gray[i] = GrayLevel(hits[i], black_level);
  }
  return gray;
}

}  // namespace plumbline
