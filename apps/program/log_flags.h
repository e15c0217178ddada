#ifndef PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_
#define PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_

#include "plumbline/apps/bags/bag_reader.h"

namespace plumbline {

/// What the command line says of the topics of a bag of ROS.
BagReadOptions BagReadOptionsFromFlags();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_
