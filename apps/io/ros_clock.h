#ifndef PLUMBLINE_APPS_IO_ROS_CLOCK_H_
#define PLUMBLINE_APPS_IO_ROS_CLOCK_H_

#include <string>
#include <vector>

namespace plumbline {

/// Times of the messages of one stream in the order of the recording.
struct StreamTimes {
  std::string topic;
  std::vector<double> stamps_s;    ///< of the headers
  std::vector<double> received_s;  ///< by the clock of the recorder; empty or 0: unknown
};

/// Why the stamps [s] of a stream do not tell its messages apart; empty if they do: see ClockFault,
/// or stamps of which more than BadRecordLimits allow are not set, or whole seconds that repeat.
std::string StampFault(const std::vector<double>& stamps_s);

/// Per message, the reason why its stamp does not fit; empty for most. A stamp does not fit if
/// it is not set. If the clock goes back by more than max_back_s [s], a stamp that is off the time
/// of recording by that much more than the median does not fit either; none of these is named if
/// there are more than BadRecordLimits allow.
std::vector<std::string> StampOutliers(const StreamTimes& times, double max_back_s);

/// Why the header stamps of scans and odometry are useless while their recording times are not;
/// empty otherwise. Without odometry its stream is empty.
std::string WhyRecordClock(const StreamTimes& scans, const StreamTimes& odometry,
                           double max_back_s);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROS_CLOCK_H_
