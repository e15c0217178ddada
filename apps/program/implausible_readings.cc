#include "plumbline/apps/program/implausible_readings.h"

#include <algorithm>
#include <cstddef>
#include <sstream>

namespace plumbline {
namespace {

constexpr double kMinReturnShare = 0.01;  // of the beams of a scan
constexpr double kShortestReachM = 1.0;   // of 2D lasers; the shortest on the market see 4 m
constexpr double kLongestReachM = 250.0;  // likewise
constexpr double kMaxShareOfEmptyScans = 0.5;

std::string EmptyScans(const SlamGraph& graph) {
  int num_empty = 0;
  for (int s = 0; s < graph.num_scans(); ++s) {
    const double num_beams = graph.LaserOfScan(s).num_beams;
    if (static_cast<double>(graph.scan(s).num_returns) < kMinReturnShare * num_beams) ++num_empty;
  }
  if (num_empty <= kMaxShareOfEmptyScans * graph.num_scans()) return "";
  const LaserModel& laser = graph.LaserOfScan(0);
  std::ostringstream text;
  text << num_empty << " of " << graph.num_scans()
       << " scans have next to no readings between the minimum and the maximum range, "
       << laser.min_range_m << " m and " << laser.max_range_m << " m; "
       << (laser.max_range_m < kShortestReachM
               ? "the maximum range looks wrong"
               : "the ranges look like millimetres, or are not positive");
  return text.str();
}

std::string LongRanges(const SlamGraph& graph) {
  std::vector<float> ranges_m = graph.returns().range_m;
  if (ranges_m.empty()) return "";
  const auto middle = ranges_m.begin() + static_cast<std::ptrdiff_t>(ranges_m.size() / 2);
  std::nth_element(ranges_m.begin(), middle, ranges_m.end());
  if (*middle <= kLongestReachM) return "";
  std::ostringstream text;
  text << "half of the readings are above " << *middle
       << " m, beyond the reach of a laser; the ranges look like millimetres";
  return text.str();
}

}  // namespace

std::vector<std::string> ImplausibleReadings(const SlamGraph& graph) {
  std::vector<std::string> faults = {EmptyScans(graph), LongRanges(graph)};
  faults.erase(std::remove(faults.begin(), faults.end(), ""), faults.end());
  return faults;
}

}  // namespace plumbline
