// Takes the place of rosbag_reader.cc where the library for bags is not installed.
#include "plumbline/apps/io/rosbag_reader.h"

namespace plumbline {

bool CanReadRosbags() { return false; }

Status ReadRosbag(const std::string& path, const RosbagReadOptions&, RosRecording*) {
  return Status::InvalidArgument(
      path +
      ": a ROS bag, which this build cannot read. Install librosbag-storage-dev, "
      "libsensor-msgs-dev, libnav-msgs-dev and libtf2-msgs-dev (Debian's names), and build again");
}

}  // namespace plumbline
