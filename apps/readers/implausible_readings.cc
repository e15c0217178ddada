#include "plumbline/apps/readers/implausible_readings.h"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include "plumbline/core/median.h"

namespace plumbline {
namespace {

constexpr double kMinReturnShare = 0.01;  // of the beams of a scan
constexpr double kShortestReachM = 1.0;   // of 2D lasers; the shortest on the market see 4 m
constexpr double kLongestReachM = 100.0;  // of 2D lasers, in most directions
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
               : "the ranges look like millimetres or centimetres, or are not positive");
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
       << " m, beyond the reach of a laser; the ranges look like "
       << (*middle > 10.0 * kLongestReachM ? "millimetres" : "centimetres or millimetres")
       << ", but metres are expected";
  return text.str();
}

// Lengths of the odometry's steps [m], and speeds [m/s] where the clock tells, of a robot that
// moves.
struct Steps {
  std::vector<double> lengths_m, speeds_m_s;
};

Steps MovingSteps(const SlamGraph& graph) {
  Steps steps;
  for (const OdometryConstraint& step : graph.odometry()) {
    const double length_m = step.from_from_to.translation().norm();
    const double time_s = graph.timestamp_s(step.to) - graph.timestamp_s(step.from);
    if (length_m == 0.0) continue;
    steps.lengths_m.push_back(length_m);
    if (time_s > 0.0) steps.speeds_m_s.push_back(length_m / time_s);
  }
  return steps;
}

}  // namespace

std::string ImplausibleOdometry(const SlamGraph& graph) {
  constexpr double kFastestM_S = 40.0, kLongestStepM = 20.0;
  const Steps steps = MovingSteps(graph);
  if (steps.lengths_m.size() < 2) return "";
  const double length_m = Median(steps.lengths_m);
  const bool has_clock = 2 * steps.speeds_m_s.size() > steps.lengths_m.size();
  const double speed_m_s = has_clock ? Median(steps.speeds_m_s) : 0.0;
  if (speed_m_s <= kFastestM_S && length_m <= kLongestStepM) return "";
  std::ostringstream text;
  text << "by its odometry the robot moves by " << length_m << " m from one scan to the next";
  if (has_clock) text << ", at " << speed_m_s << " m/s";
  text << "; the odometry looks like millimetres or centimetres, but metres are expected";
  return text.str();
}

std::vector<std::string> ImplausibleReadings(const SlamGraph& graph) {
  std::vector<std::string> faults = {EmptyScans(graph), LongRanges(graph)};
  faults.erase(std::remove(faults.begin(), faults.end(), ""), faults.end());
  return faults;
}

}  // namespace plumbline
