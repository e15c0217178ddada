// Takes the place of ros1_bag.cc where the library for bags of ROS 1 is not installed.
#include "plumbline/apps/bags/ros1_bag.h"

namespace plumbline {

bool CanReadRos1Bags() { return false; }

Status OpenRos1Bag(const std::string& path, std::unique_ptr<BagContainer>*) {
  return Status::InvalidArgument(
      path +
      ": a bag of ROS 1, which this build cannot read. Install librosbag-storage-dev, "
      "libsensor-msgs-dev, libnav-msgs-dev and libtf2-msgs-dev (Debian's names), and build again");
}

}  // namespace plumbline
