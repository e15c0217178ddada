#ifndef PLUMBLINE_CORE_NO_RETURN_LEVEL_H_
#define PLUMBLINE_CORE_NO_RETURN_LEVEL_H_

#include <limits>
#include <optional>
#include <vector>

namespace plumbline {

/// Readings of one sweep. Refers to them.
struct SweepReadings {
  const std::vector<double>* ranges_m = nullptr;  ///< not finite: no return
  double bearing_step_rad = 0.0;                  ///< from a beam to the next
  /// Readings from here on are known to be no returns [m].
  double max_range_m = std::numeric_limits<double>::infinity();
  /// Finite directions [rad] of the ranges, in any order, as in a point cloud; null or empty: range
  /// i is that of beam i.
  const std::vector<double>* bearings_rad = nullptr;
};

/// Finds the reading that a laser gives where nothing comes back: the range [m] from which on
/// readings are no returns; empty if there is none.
///
/// Many lasers report "no echo" as one fixed reading above all true ones. SICK's telegram reserves
/// 8183..8191 (81.83 to 81.91 m, or 8.183 to 8.191 m in mm mode); drivers give 65.533 m, or a
/// little less than the maximum range. Such readings are found in one of two ways:
///
/// - A level: the top 0.1 % of the range (the width of SICK's codes) holds at least 10 readings,
///   more than 10 times as many as the next 0.9 %, and is not all there is. A surface would spread
///   over both. Should one be caught all the same, only the farthest 0.1 % is lost.
/// - A band, for a level with noise: the top 0.1 m holds at least 20 readings and more than 5 times
///   as many as the next 0.1 m, at most 10 times as many as all lower ones, in at least a fifth of
///   the sweeps. In most of these it takes
///   directions that no surface takes at one distance: at least three that lie apart, or an angle
///   1.5 times as wide as that of a flat wall within a band of this depth.
std::optional<double> FindNoReturnLevel(const std::vector<SweepReadings>& sweeps);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_NO_RETURN_LEVEL_H_
