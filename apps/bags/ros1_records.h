#ifndef PLUMBLINE_APPS_BAGS_ROS1_RECORDS_H_
#define PLUMBLINE_APPS_BAGS_ROS1_RECORDS_H_

#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Looks at the records of a bag of ROS 1: DataLoss, naming the byte, if one is longer than what is
/// left of the file, its header is none, or it points where there is nothing of the kind; and for
/// other formats than 2.0. The library for bags takes all this for true: it reads beyond its
/// memory, or asks for gigabytes and ends the program; also of what has almost the right first
/// line. What is inside of compressed chunks is not looked at. NotFound or InvalidArgument if the
/// file cannot be read.
Status CheckRos1Records(const std::string& path);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_ROS1_RECORDS_H_
