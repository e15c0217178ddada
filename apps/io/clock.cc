#include "plumbline/apps/io/clock.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace plumbline {
namespace {

// Files keep six decimals; a little more, for what rounding does to a time of 1e9 s.
constexpr double kResolutionS = 1.5e-6;

std::size_t NumDifferent(std::vector<double> times_s) {
  std::sort(times_s.begin(), times_s.end());
  std::size_t num_different = times_s.empty() ? 0 : 1;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    if (times_s[i] - times_s[i - 1] > kResolutionS) ++num_different;
  }
  return num_different;
}

bool AreSame(const std::vector<double>& a, const std::vector<double>& b, double tolerance_s) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [tolerance_s](double x, double y) { return std::abs(x - y) <= tolerance_s; });
}

}  // namespace

std::string ClockFault(const std::vector<double>& times_s) {
  if (times_s.size() < 2) return "";
  const std::size_t num_different = NumDifferent(times_s);
  if (num_different > 1 && 2 * num_different >= times_s.size()) return "";
  return "its clock is useless: " + std::to_string(num_different) +
         (num_different == 1 ? " different time for " : " different times for ") +
         std::to_string(times_s.size()) + " entries";
}

std::vector<double> TimesOf(const std::vector<TimedPose>& trajectory) {
  std::vector<double> times_s;
  times_s.reserve(trajectory.size());
  for (const TimedPose& pose : trajectory) times_s.push_back(pose.timestamp_s);
  return times_s;
}

Status ChoosePairing(const RecordTimes& a, const RecordTimes& b, double tolerance_s,
                     Pairing* pairing) {
  const bool by_order = AreSame(a.times_s, b.times_s, tolerance_s);
  bool clock_is_useless = false;
  for (const RecordTimes* record : {&a, &b}) {
    const std::string fault = ClockFault(record->times_s);
    if (fault.empty()) continue;
    clock_is_useless = true;
    if (by_order) continue;
    return Status::InvalidArgument(record->path + ": " + fault + ", and " +
                                   (record == &a ? b : a).path +
                                   " has not the same times in the same order: nothing tells "
                                   "which entries belong together");
  }
  *pairing = {by_order, clock_is_useless};
  return Status::Ok();
}

}  // namespace plumbline
