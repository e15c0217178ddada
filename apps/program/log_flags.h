#ifndef PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_
#define PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_

#include "plumbline/apps/io/rosbag_reader.h"

namespace plumbline {

/// What the command line says of the topics of a bag.
RosbagReadOptions RosbagReadOptionsFromFlags();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_
