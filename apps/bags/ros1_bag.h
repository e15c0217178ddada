#ifndef PLUMBLINE_APPS_BAGS_ROS1_BAG_H_
#define PLUMBLINE_APPS_BAGS_ROS1_BAG_H_

#include <memory>
#include <string>
#include <string_view>

#include "plumbline/apps/bags/bag_container.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How bags of ROS 1 begin; the version follows.
constexpr std::string_view kRos1Magic = "#ROSBAG V";

/// Whether this build reads bags of ROS 1: it does where the library for them was found.
bool CanReadRos1Bags();

/// A bag of ROS 1 (format 2.0), its chunks plain, bz2 or LZ4. DataLoss if it is cut off or corrupt,
/// ReadMessages also if it has no index; NotFound or InvalidArgument if the file cannot be read;
/// InvalidArgument, saying how to build it in, unless CanReadRos1Bags().
Status OpenRos1Bag(const std::string& path, std::unique_ptr<BagContainer>* bag);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_ROS1_BAG_H_
