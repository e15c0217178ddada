#include "plumbline/core/no_return_level.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// NaN and infinity are none.
bool IsReading(double range_m, const SweepReadings& sweep) {
  return std::isfinite(range_m) && range_m < sweep.max_range_m;
}

template <typename Visit>
void ForEachReading(const std::vector<SweepReadings>& sweeps, const Visit& visit) {
  for (const SweepReadings& sweep : sweeps) {
    for (const double range_m : *sweep.ranges_m) {
      if (IsReading(range_m, sweep)) visit(range_m);
    }
  }
}

// Readings from a range on, from a second and lower one up to it, and below that.
struct Counts {
  double top_m, next_m;
  std::size_t num_top = 0, num_next = 0, num_lower = 0;

  void Add(double range_m) {
    ++(range_m >= top_m ? num_top : range_m >= next_m ? num_next : num_lower);
  }
};

bool IsLevel(const Counts& counts) {
  return counts.num_top >= 10 && counts.num_top > 10 * counts.num_next &&
         counts.num_next + counts.num_lower > 0;
}

bool IsPeak(const Counts& counts) {
  return counts.num_top >= 20 && counts.num_top > 5 * counts.num_next &&
         10 * (counts.num_next + counts.num_lower) >= counts.num_top;
}

// The beams of the readings of one sweep from `top_m` on, in their order around the laser.
std::vector<double> BeamsFrom(const SweepReadings& sweep, double step_rad, double top_m) {
  const bool has_bearings = sweep.bearings_rad != nullptr && !sweep.bearings_rad->empty();
  std::vector<double> beams;
  for (std::size_t i = 0; i < sweep.ranges_m->size(); ++i) {
    const double range_m = (*sweep.ranges_m)[i];
    if (!IsReading(range_m, sweep) || range_m < top_m) continue;
    beams.push_back(has_bearings ? std::round((*sweep.bearings_rad)[i] / step_rad)
                                 : static_cast<double>(i));
  }
  std::sort(beams.begin(), beams.end());
  beams.erase(std::unique(beams.begin(), beams.end()), beams.end());
  return beams;
}

// How the readings of one sweep from `top_m` on are spread over its directions.
struct Spread {
  std::size_t num_beams = 0;
  std::size_t num_groups = 0;  // that lie apart
};

Spread SpreadOf(const SweepReadings& sweep, double top_m) {
  constexpr double kApartRad = DegToRad(5.0);
  const double step_rad = std::abs(sweep.bearing_step_rad);
  const std::vector<double> beams = BeamsFrom(sweep, step_rad, top_m);
  Spread spread{beams.size(), beams.empty() ? std::size_t{0} : 1};
  for (std::size_t i = 1; i < beams.size(); ++i) {
    if ((beams[i] - beams[i - 1]) * step_rad > kApartRad) ++spread.num_groups;
  }
  return spread;
}

// Whether the readings from `top_m` up to `largest_m` take directions that no surface does.
bool IsBeyondGeometry(const std::vector<SweepReadings>& sweeps, double top_m, double largest_m) {
  constexpr double kMinSweepShare = 0.2, kWider = 1.5;
  constexpr std::size_t kMinGroups = 3;
  const double wall_rad = 2.0 * std::acos(top_m / largest_m);
  std::size_t num_with = 0, num_beyond = 0;
  for (const SweepReadings& sweep : sweeps) {
    const Spread spread = SpreadOf(sweep, top_m);
    if (spread.num_beams == 0) continue;
    ++num_with;
    const double angle_rad =
        static_cast<double>(spread.num_beams) * std::abs(sweep.bearing_step_rad);
    if (spread.num_groups >= kMinGroups || angle_rad > kWider * wall_rad) ++num_beyond;
  }
  return static_cast<double>(num_with) >= kMinSweepShare * static_cast<double>(sweeps.size()) &&
         2 * num_beyond > num_with;
}

}  // namespace

std::optional<double> FindNoReturnLevel(const std::vector<SweepReadings>& sweeps) {
  constexpr double kBandM = 0.1;
  double largest_m = 0.0;
  ForEachReading(sweeps, [&](double range_m) { largest_m = std::max(largest_m, range_m); });
  const double level_m = 0.999 * largest_m, band_m = largest_m - kBandM;
  Counts by_level{level_m, 0.99 * largest_m}, by_band{band_m, band_m - kBandM};
  ForEachReading(sweeps, [&](double range_m) {
    by_level.Add(range_m);
    by_band.Add(range_m);
  });
  // A level with noise may have a tail below the top 0.1 %, far denser than the readings below.
  const bool is_level = IsLevel(by_level);
  const double tail_per_m =
      (static_cast<double>(by_band.num_top) - static_cast<double>(by_level.num_top)) /
      (level_m - band_m);
  const double next_per_m = static_cast<double>(by_band.num_next) / kBandM;
  if (is_level && (level_m <= band_m || tail_per_m <= 5.0 * next_per_m)) return level_m;
  const bool is_band =
      band_m > kBandM && IsPeak(by_band) && IsBeyondGeometry(sweeps, band_m, largest_m);
  if (is_band) return band_m;
  return is_level ? std::optional<double>(level_m) : std::nullopt;
}

}  // namespace plumbline
