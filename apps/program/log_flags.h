#ifndef PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_
#define PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_

#include <optional>

#include "plumbline/apps/bags/bag_reader.h"

namespace plumbline {

/// What the command line says of the topics of a bag of ROS.
BagReadOptions BagReadOptionsFromFlags();

/// Time that a sweep takes [s]; empty: what the log says.
std::optional<double> SweepTimeFromFlags();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_
