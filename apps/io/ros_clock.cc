#include "plumbline/apps/io/ros_clock.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "plumbline/apps/io/bad_records.h"
#include "plumbline/apps/io/clock.h"
#include "plumbline/core/median.h"

namespace plumbline {
namespace {

bool IsSet(double stamp_s) { return std::isfinite(stamp_s) && stamp_s > 0.0; }

std::vector<double> SetOnes(const std::vector<double>& stamps_s) {
  std::vector<double> set;
  std::copy_if(stamps_s.begin(), stamps_s.end(), std::back_inserter(set), IsSet);
  return set;
}

bool HasRecordClock(const StreamTimes& times) {
  return times.received_s.size() == times.stamps_s.size() &&
         std::all_of(times.received_s.begin(), times.received_s.end(), IsSet);
}

bool AreRepeatedSeconds(const std::vector<double>& stamps_s) {
  const bool are_whole = std::all_of(stamps_s.begin(), stamps_s.end(),
                                     [](double stamp_s) { return stamp_s == std::round(stamp_s); });
  return are_whole && std::adjacent_find(stamps_s.begin(), stamps_s.end()) != stamps_s.end();
}

bool GoesBack(const std::vector<double>& stamps_s, double max_back_s) {
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    if (stamps_s[i - 1] - stamps_s[i] > max_back_s) return true;
  }
  return false;
}

// Whether some of the scans lie within the time of the odometry.
bool Overlap(const std::vector<double>& scans_s, const std::vector<double>& odometry_s) {
  const auto [first, last] = std::minmax_element(odometry_s.begin(), odometry_s.end());
  return std::any_of(scans_s.begin(), scans_s.end(), [first = *first, last = *last](double time_s) {
    return time_s >= first && time_s <= last;
  });
}

// The stamps that are set and fit.
std::vector<double> FittingStamps(const StreamTimes& times, double max_back_s) {
  const std::vector<std::string> outliers = StampOutliers(times, max_back_s);
  std::vector<double> fitting;
  for (std::size_t i = 0; i < outliers.size(); ++i) {
    if (outliers[i].empty()) fitting.push_back(times.stamps_s[i]);
  }
  return fitting;
}

}  // namespace

std::string StampFault(const std::vector<double>& stamps_s) {
  const std::vector<double> set = SetOnes(stamps_s);
  const std::size_t num_unset = stamps_s.size() - set.size();
  if (num_unset > 0 &&
      (2 * num_unset > stamps_s.size() || num_unset > BadRecordLimits().Of(stamps_s.size()))) {
    return "the stamps of " + std::to_string(num_unset) + " of " + std::to_string(stamps_s.size()) +
           " headers are not set";
  }
  std::string fault = ClockFault(set);
  if (!fault.empty()) return fault;
  return AreRepeatedSeconds(set) ? "its clock is useless: the stamps are whole seconds" : "";
}

std::vector<std::string> StampOutliers(const StreamTimes& times, double max_back_s) {
  const std::size_t size = times.stamps_s.size();
  std::vector<std::string> faults(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (!IsSet(times.stamps_s[i])) faults[i] = "field 'header.stamp' is not set";
  }
  if (!HasRecordClock(times) || !GoesBack(SetOnes(times.stamps_s), max_back_s)) return faults;
  std::vector<double> delays_s;
  for (std::size_t i = 0; i < size; ++i) {
    if (faults[i].empty()) delays_s.push_back(times.received_s[i] - times.stamps_s[i]);
  }
  const double usual_s = Median(delays_s);
  std::vector<std::size_t> outliers;
  for (std::size_t i = 0; i < size; ++i) {
    const double off_s = times.received_s[i] - times.stamps_s[i] - usual_s;
    if (faults[i].empty() && std::abs(off_s) > max_back_s) outliers.push_back(i);
  }
  if (outliers.size() > BadRecordLimits().Of(size) || 2 * outliers.size() > size) return faults;
  for (const std::size_t i : outliers) {
    faults[i] = "field 'header.stamp' does not fit the time of recording";
  }
  return faults;
}

std::string WhyRecordClock(const StreamTimes& scans, const StreamTimes& odometry,
                           double max_back_s) {
  for (const StreamTimes* times : {&scans, &odometry}) {
    if (!HasRecordClock(*times) || !ClockFault(times->received_s).empty() ||
        GoesBack(times->received_s, max_back_s)) {
      return "";
    }
  }
  for (const StreamTimes* times : {&scans, &odometry}) {
    const std::string fault = StampFault(times->stamps_s);
    if (!fault.empty()) return times->topic + ": " + fault;
    if (GoesBack(FittingStamps(*times, max_back_s), max_back_s)) {
      return times->topic + ": the clock jumps back";
    }
  }
  if (odometry.stamps_s.empty() || scans.stamps_s.empty()) return "";
  if (!Overlap(scans.stamps_s, odometry.stamps_s) &&
      Overlap(scans.received_s, odometry.received_s)) {
    return "the stamps on " + scans.topic + " and " + odometry.topic +
           " are of different times, as of a clock since boot";
  }
  return "";
}

}  // namespace plumbline
