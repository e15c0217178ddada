#ifndef PLUMBLINE_APPS_IO_CLOCK_H_
#define PLUMBLINE_APPS_IO_CLOCK_H_

#include <string>
#include <vector>

#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What is wrong with times [s] that should tell the entries of a record apart, in words, e.g.
/// "its clock is useless: 1 different time for 237 entries". Empty if nothing is: at least every
/// second entry has a time of its own, to the microsecond that files keep, so that two lasers may
/// share each time. A single entry is told apart by any time.
std::string ClockFault(const std::vector<double>& times_s);

/// Times [s] of the poses, in their order.
std::vector<double> TimesOf(const std::vector<TimedPose>& trajectory);

/// Times [s] of one record of a drive, and what errors call it: the path of its file.
struct RecordTimes {
  std::string path;
  std::vector<double> times_s;
};

/// How the entries of two records of a drive find each other.
struct Pairing {
  /// Entry i of one belongs to entry i of the other. Otherwise by their times.
  bool by_order = false;
  /// Their times would not have told.
  bool clock_is_useless = false;
};

/// Records of as many entries, whose times are the same one by one to tolerance_s [s], are paired
/// by order, whatever their clock is worth: it is the only way to tell entries of equal time apart.
/// InvalidArgument, naming the record, if they are not, and the clock of one of them is useless.
Status ChoosePairing(const RecordTimes& a, const RecordTimes& b, double tolerance_s,
                     Pairing* pairing);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_CLOCK_H_
