#include "plumbline/apps/bags/cloud_cutter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/median.h"

namespace plumbline {
namespace {

// Difference in height that the points of a planar laser may have: a tilt of 0.2 deg at 30 m.
constexpr double kPlanarM = 0.1;
// Fewer points do not show the spacing of the beams.
constexpr std::size_t kMinPointsToSpace = 30;
constexpr int kDefaultBeams = 720, kMinBeams = 90, kMaxBeams = 7200;
// Points of several rings of a 3D laser that are closer than this count as one direction.
constexpr double kSameDirectionRad = DegToRad(0.02);

struct CloudReturn {
  double range_m;
  double bearing_rad;
  double height_m;
};

// Without the points that drivers put where there is no return: not finite, or at the origin.
std::vector<CloudReturn> ReturnsOf(const RosCloud& cloud) {
  std::vector<CloudReturn> returns;
  for (const Eigen::Vector3d& point : cloud.points) {
    const double range_m = std::hypot(point.x(), point.y());
    if (!point.allFinite() || range_m < LaserModel().min_range_m) continue;
    returns.push_back({range_m, std::atan2(point.y(), point.x()), point.z()});
  }
  return returns;
}

// Number of beams all around, from the median spacing of the directions.
int NumBeamsOf(std::vector<double> bearings_rad) {
  std::sort(bearings_rad.begin(), bearings_rad.end());
  std::vector<double> steps_rad;
  double last_rad = bearings_rad.front();
  for (const double bearing_rad : bearings_rad) {
    if (bearing_rad - last_rad < kSameDirectionRad) continue;
    steps_rad.push_back(bearing_rad - last_rad);
    last_rad = bearing_rad;
  }
  if (steps_rad.empty()) return kDefaultBeams;
  return static_cast<int>(std::clamp<double>(std::round(2.0 * kPi / Median(std::move(steps_rad))),
                                             kMinBeams, kMaxBeams));
}

// Bearing of the first beam, for `num_beams` around that fit the bearings best.
double FirstBearing(const std::vector<double>& bearings_rad, int num_beams) {
  double x = 0.0, y = 0.0;
  for (const double bearing_rad : bearings_rad) {
    x += std::cos(num_beams * bearing_rad);
    y += std::sin(num_beams * bearing_rad);
  }
  const double step_rad = 2.0 * kPi / num_beams;
  const int num_before = num_beams / 2;  // beams to the right of the forward axis
  return std::atan2(y, x) / num_beams - num_before * step_rad;
}

std::string HeightText(double low_m, double high_m) {
  std::ostringstream text;
  text.precision(3);
  text << "points at heights from " << low_m << " to " << high_m << " m";
  return text.str();
}

}  // namespace

bool HeightBand::Check(std::string* error) const {
  const bool is_good = std::isfinite(low_m) && std::isfinite(high_m) && low_m < high_m;
  if (!is_good && error != nullptr) *error = "slice_height_m is no band from low to high";
  return is_good;
}

bool CloudCutter::Cut(const RosCloud& cloud, RosScan* scan, std::string* fault) {
  std::vector<CloudReturn> returns = ReturnsOf(cloud);
  const auto is_lower = [](const CloudReturn& a, const CloudReturn& b) {
    return a.height_m < b.height_m;
  };
  if (band_) {
    const auto is_outside = [this](const CloudReturn& r) {
      return r.height_m < band_->low_m || r.height_m > band_->high_m;
    };
    returns.erase(std::remove_if(returns.begin(), returns.end(), is_outside), returns.end());
  } else if (!returns.empty()) {
    const auto [low, high] = std::minmax_element(returns.begin(), returns.end(), is_lower);
    if (high->height_m - low->height_m > kPlanarM) {
      *fault = "it has " + HeightText(low->height_m, high->height_m) + " in " + Quote(cloud.frame) +
               ", as a 3D laser gives: choose a band of them by " + "--slice_height_m=LOW,HIGH";
      return false;
    }
  }
  *scan = RosScan();
  scan->stamp_s = cloud.stamp_s;
  scan->frame = cloud.frame;
  scan->range_max_m = std::numeric_limits<double>::infinity();
  for (const CloudReturn& r : returns) {
    scan->ranges.push_back(r.range_m);
    scan->bearings_rad.push_back(r.bearing_rad);
  }
  if (num_beams_ == 0 && returns.size() >= kMinPointsToSpace) {
    num_beams_ = NumBeamsOf(scan->bearings_rad);
    first_bearing_rad_ = FirstBearing(scan->bearings_rad, num_beams_);
  }
  scan->angle_increment_rad = 2.0 * kPi / (num_beams_ > 0 ? num_beams_ : kDefaultBeams);
  scan->angle_min_rad = num_beams_ > 0 ? first_bearing_rad_ : -kPi;
  if (band_) KeepNearest(scan);
  if (returns.empty()) {
    scan->ranges = {std::numeric_limits<double>::infinity()};
    scan->bearings_rad = {scan->angle_min_rad};
  }
  return true;
}

void CloudCutter::KeepNearest(RosScan* scan) const {
  // Half a beam wide: a ring whose spacing differs a little loses no point.
  const double bin_rad = 0.5 * scan->angle_increment_rad;
  std::vector<std::size_t> nearest(static_cast<std::size_t>(std::lround(2.0 * kPi / bin_rad)) + 1,
                                   scan->ranges.size());
  for (std::size_t i = 0; i < scan->ranges.size(); ++i) {
    std::size_t& kept = nearest[static_cast<std::size_t>((scan->bearings_rad[i] + kPi) / bin_rad)];
    if (kept == scan->ranges.size() || scan->ranges[i] < scan->ranges[kept]) kept = i;
  }
  std::vector<double> ranges, bearings_rad;
  for (const std::size_t i : nearest) {
    if (i == scan->ranges.size()) continue;
    ranges.push_back(scan->ranges[i]);
    bearings_rad.push_back(scan->bearings_rad[i]);
  }
  scan->ranges = std::move(ranges);
  scan->bearings_rad = std::move(bearings_rad);
}

}  // namespace plumbline
