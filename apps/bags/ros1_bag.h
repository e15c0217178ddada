#ifndef PLUMBLINE_APPS_BAGS_ROS1_BAG_H_
#define PLUMBLINE_APPS_BAGS_ROS1_BAG_H_

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "plumbline/apps/bags/bag_container.h"

namespace plumbline {

/// How bags of ROS 1 begin; the version follows.
constexpr std::string_view kRos1Magic = "#ROSBAG V";

/// A bag of ROS 1 (format 2.0), its chunks plain, bz2 or LZ4, with up to 1 GiB each; memory is
/// bounded by the longest one. The messages come in the order of the file. A bag without an index,
/// as an interrupted recording leaves it, and one that ends before its index are read up to the
/// last whole record; Omission() tells of the rest. Without `expanded` the file is read; otherwise
/// the file is compressed as a whole, and `expanded` is its content.
///
/// ReadMessages fails with DataLoss, naming the byte, where the file is damaged, and with
/// InvalidArgument if it is encrypted.
std::unique_ptr<BagContainer> MakeRos1Bag(std::string path, std::optional<std::string> expanded);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_ROS1_BAG_H_
