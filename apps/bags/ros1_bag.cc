#include "plumbline/apps/bags/ros1_bag.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <exception>
#include <utility>

#include "plumbline/apps/bags/ros1_records.h"

namespace plumbline {
namespace {

BagTopic TopicOf(const std::string& name, const std::string& type) { return {name, type, "ros1"}; }

class Ros1Bag : public BagContainer {
 public:
  explicit Ros1Bag(std::string path) : path_(std::move(path)) {}

  // The library for bags throws where the file holds nonsense.
  Status ReadMessages(const IsWanted& is_wanted, const TakeMessage& take) override {
    try {
      // Its constructor can do this too, and if it throws leaks what it has read.
      if (!bag_.isOpen()) bag_.open(path_);
      return Read(is_wanted, take);
    } catch (const std::exception& exception) {
      return Status::DataLoss(path_ + ": cannot be read as a ROS bag: " + exception.what() +
                              " (rosbag reindex can repair a recording that was cut off)");
    }
  }

 private:
  Status Read(const IsWanted& is_wanted, const TakeMessage& take) const {
    rosbag::View view(bag_, [&](const rosbag::ConnectionInfo* connection) {
      return is_wanted(TopicOf(connection->topic, connection->datatype));
    });
    std::string bytes;
    for (const rosbag::MessageInstance& message : view) {
      bytes.resize(message.size());
      ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()),
                                         static_cast<std::uint32_t>(bytes.size()));
      message.write(stream);
      PLUMBLINE_RETURN_IF_ERROR(take(TopicOf(message.getTopic(), message.getDataType()),
                                     message.getTime().toSec(), bytes));
    }
    return Status::Ok();
  }

  const std::string path_;
  rosbag::Bag bag_;
};

}  // namespace

bool CanReadRos1Bags() { return true; }

Status OpenRos1Bag(const std::string& path, std::unique_ptr<BagContainer>* bag) {
  // The library is misled by lengths.
  PLUMBLINE_RETURN_IF_ERROR(CheckRos1Records(path));
  *bag = std::make_unique<Ros1Bag>(path);
  return Status::Ok();
}

}  // namespace plumbline
