#include "plumbline/solvers/front_end/range_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace plumbline {
namespace {

// Scans that are looked at, evenly spread over the log.
constexpr int kMaxScans = 2000;
// Fewer triples of beams say nothing.
constexpr std::size_t kMinTriples = 500;
// Difference of two beams [m] that may be noise. Beams on a surface that is met at 45 degrees
// differ by their distance from each other at most.
constexpr double kFreeDifferenceM = 0.1;
// Distance from the line [m] beyond which there is another surface.
constexpr double kMaxOffM = 0.5;
// Largest angle of three beams: lasers of fewer beams see no surface by three of them.
constexpr double kMaxWidthRad = 0.2;
// Mean of |x| over the smaller half, of a normal distribution of unit variance.
constexpr double kMeanOfSmallerHalf = 0.324664;

struct Beam {
  double range_m, bearing_rad;
};

// How far the middle beam ends off the line [m], in units of what a standard deviation of 1 brings
// about. Negative if the three beams are not fit.
double OffLine(const Beam& first, const Beam& middle, const Beam& last) {
  const double width_rad = last.bearing_rad - first.bearing_rad;
  const double nearest_m = std::min(first.range_m, last.range_m);
  if (!(std::abs(width_rad) < kMaxWidthRad) || !(nearest_m > 0.0)) return -1.0;
  const double free_m = std::max(kFreeDifferenceM, std::abs(width_rad) * nearest_m);
  if (!(std::abs(last.range_m - first.range_m) <= free_m)) return -1.0;
  // The inverse of the range along a line is a sinusoid of the bearing.
  const double sine = std::sin(width_rad);
  const double by_first = std::sin(last.bearing_rad - middle.bearing_rad) / sine;
  const double by_last = std::sin(middle.bearing_rad - first.bearing_rad) / sine;
  const double on_line_m = 1.0 / (by_first / first.range_m + by_last / last.range_m);
  const double off_m = middle.range_m - on_line_m;
  if (!(std::abs(off_m) <= kMaxOffM)) return -1.0;
  const double of_first = by_first * std::pow(on_line_m / first.range_m, 2);
  const double of_last = by_last * std::pow(on_line_m / last.range_m, 2);
  return std::abs(off_m) / std::sqrt(1.0 + of_first * of_first + of_last * of_last);
}

void AddScan(const SlamGraph& graph, int scan, std::vector<double>* off_line) {
  const ScanEntry& entry = graph.scan(scan);
  const ScanReturns returns = graph.ReturnsOfScan(scan);
  const auto beam = [&](std::size_t r) -> Beam { return {returns.Range(r), returns.Bearing(r)}; };
  for (std::size_t r = entry.first_return + 1; r + 1 < entry.first_return + entry.num_returns;
       ++r) {
    const int middle = returns.Beam(r);
    if (returns.Beam(r - 1) + 1 != middle || middle + 1 != returns.Beam(r + 1)) continue;
    const double off = OffLine(beam(r - 1), beam(r), beam(r + 1));
    if (off >= 0.0) off_line->push_back(off);
  }
}

}  // namespace

double MeasureRangeNoise(const SlamGraph& graph) {
  std::vector<double> off_line;
  const int stride = 1 + graph.num_scans() / kMaxScans;
  for (int scan = 0; scan < graph.num_scans(); scan += stride) AddScan(graph, scan, &off_line);
  if (off_line.size() < kMinTriples) return 0.0;
  const auto half = off_line.begin() + static_cast<std::ptrdiff_t>(off_line.size() / 2);
  std::nth_element(off_line.begin(), half, off_line.end());
  std::sort(off_line.begin(), half);  // the same sum for any library's nth_element
  const double sum = std::accumulate(off_line.begin(), half, 0.0);
  return sum / static_cast<double>(half - off_line.begin()) / kMeanOfSmallerHalf;
}

}  // namespace plumbline
