#include "plumbline/apps/io/rosbag_reader.h"

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>

#include <Eigen/Geometry>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <exception>
#include <fstream>
#include <map>
#include <utility>
#include <vector>

#include "plumbline/apps/io/rosbag_records.h"

namespace plumbline {
namespace {

constexpr char kScanType[] = "sensor_msgs/LaserScan";
constexpr char kOdometryType[] = "nav_msgs/Odometry";

bool IsTransformType(const std::string& type) {
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";  // equal but for the name
}

// "/scan" and "scan" are one topic, "/odom" and "odom" one frame.
std::string WithoutSlash(const std::string& name) {
  return name.empty() || name.front() != '/' ? name : name.substr(1);
}

// Of a pose or transform. False if it is none; `fault` then says why.
template <typename Position>
bool ToIsometry(const Position& position, const geometry_msgs::Quaternion& rotation,
                Eigen::Isometry3d* transform, std::string* fault) {
  const Eigen::Vector3d translation(position.x, position.y, position.z);
  const Eigen::Quaterniond quaternion(rotation.w, rotation.x, rotation.y, rotation.z);
  if (!translation.allFinite() || !quaternion.coeffs().allFinite()) {
    *fault = "is not finite";
  } else if (std::abs(quaternion.norm() - 1.0) > 0.01) {
    *fault = "has a quaternion that is no rotation";
  } else {
    *transform = Eigen::Translation3d(translation) * quaternion.normalized();
    return true;
  }
  return false;
}

// Reads one bag.
class BagReader {
 public:
  BagReader(const std::string& path, const RosbagReadOptions& options) : options_(options) {
    // Its constructor can do this too, and if it throws leaks what it has read.
    bag_.open(path);
    recording_.path = path;
    recording_.odom_frame = WithoutSlash(options.odom_frame);
  }

  Status Read() {
    ListTopics();
    PLUMBLINE_RETURN_IF_ERROR(ChooseTopics());
    rosbag::View view(bag_, [this](const rosbag::ConnectionInfo* connection) {
      return connection->topic == recording_.scan_topic ||
             connection->topic == recording_.odom_topic || IsTransformType(connection->datatype);
    });
    for (const rosbag::MessageInstance& message : view) {
      PLUMBLINE_RETURN_IF_ERROR(ReadMessage(message));
      ++num_messages_[message.getTopic()];
    }
    return Status::Ok();
  }

  RosRecording&& recording() { return std::move(recording_); }

 private:
  Status Error(const std::string& problem) const {
    return Status::InvalidArgument(recording_.path + ": " + problem);
  }

  void ListTopics() {
    rosbag::View all(bag_);
    for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
      type_of_topic_[connection->topic] = connection->datatype;
    }
  }

  std::string TopicList() const {
    std::string text;
    for (const auto& [topic, type] : type_of_topic_) {
      text += (text.empty() ? "" : ", ") + topic + " (" + type + ")";
    }
    return "; the bag has " + (text.empty() ? "no topics" : text);
  }

  // The wanted topic, or the only one of the type; empty if there is none.
  Status ChooseTopic(const std::string& wanted, const std::string& type, const std::string& flag,
                     std::string* chosen) const {
    for (const auto& [topic, topic_type] : type_of_topic_) {
      if (wanted.empty() ? topic_type != type : WithoutSlash(topic) != WithoutSlash(wanted)) {
        continue;
      }
      if (!chosen->empty()) {
        return Error("there are several topics of type " + type + ": choose one by --" + flag +
                     TopicList());
      }
      *chosen = topic;
    }
    if (!wanted.empty() && chosen->empty()) {
      return Error("there is no topic '" + wanted + "', as --" + flag + " asks for" + TopicList());
    }
    return Status::Ok();
  }

  Status ChooseTopics() {
    PLUMBLINE_RETURN_IF_ERROR(
        ChooseTopic(options_.scan_topic, kScanType, "scan_topic", &recording_.scan_topic));
    if (recording_.scan_topic.empty()) {
      return Error(std::string("there is no topic of type ") + kScanType + TopicList());
    }
    if (type_of_topic_[recording_.scan_topic] != kScanType) {
      return Error(recording_.scan_topic + " is not of type " + kScanType + TopicList());
    }
    PLUMBLINE_RETURN_IF_ERROR(
        ChooseTopic(options_.odom_topic, kOdometryType, "odom_topic", &recording_.odom_topic));
    if (recording_.odom_topic.empty()) return Status::Ok();
    const std::string& type = type_of_topic_[recording_.odom_topic];
    if (IsTransformType(type)) {
      recording_.odom_topic.clear();
    } else if (type != kOdometryType) {
      return Error(recording_.odom_topic + " is neither of type " + kOdometryType +
                   " nor of transforms" + TopicList());
    }
    return Status::Ok();
  }

  Status ReadMessage(const rosbag::MessageInstance& message) {
    if (message.getTopic() == recording_.scan_topic) {
      return Take<sensor_msgs::LaserScan>(message);
    }
    if (message.getTopic() == recording_.odom_topic) return Take<nav_msgs::Odometry>(message);
    return Take<tf2_msgs::TFMessage>(message);
  }

  template <typename Message>
  Status Take(const rosbag::MessageInstance& message) {
    const auto content = message.instantiate<Message>();
    if (content) return Add(message, *content);
    return MessageError(message,
                        "its definition is not that of this version of " + message.getDataType());
  }

  Status MessageError(const rosbag::MessageInstance& message, const std::string& problem) const {
    const auto index = num_messages_.find(message.getTopic());
    return Error(RosMessageName(message.getTopic(),
                                index == num_messages_.end() ? 0 : index->second,
                                message.getTime().toSec()) +
                 problem);
  }

  Status Add(const rosbag::MessageInstance&, const sensor_msgs::LaserScan& message) {
    RosScan scan;
    scan.stamp_s = message.header.stamp.toSec();
    scan.frame = WithoutSlash(message.header.frame_id);
    scan.angle_min_rad = message.angle_min;
    scan.angle_increment_rad = message.angle_increment;
    scan.range_min_m = message.range_min;
    scan.range_max_m = message.range_max;
    scan.ranges.assign(message.ranges.begin(), message.ranges.end());
    recording_.scans.push_back(std::move(scan));
    return Status::Ok();
  }

  Status Add(const rosbag::MessageInstance& instance, const nav_msgs::Odometry& message) {
    Eigen::Isometry3d odom_from_robot;
    std::string fault;
    const geometry_msgs::Pose& pose = message.pose.pose;
    if (!ToIsometry(pose.position, pose.orientation, &odom_from_robot, &fault)) {
      return MessageError(instance, "field 'pose.pose' " + fault);
    }
    recording_.odom_frame = WithoutSlash(message.header.frame_id);
    recording_.robot_frame = WithoutSlash(message.child_frame_id);
    recording_.odometry.push_back({message.header.stamp.toSec(), InPlane(odom_from_robot)});
    return Status::Ok();
  }

  Status Add(const rosbag::MessageInstance& instance, const tf2_msgs::TFMessage& message) {
    for (const geometry_msgs::TransformStamped& stamped : message.transforms) {
      StampedTransform sample;
      sample.stamp_s = stamped.header.stamp.toSec();
      std::string fault;
      if (!ToIsometry(stamped.transform.translation, stamped.transform.rotation,
                      &sample.parent_from_child, &fault)) {
        return MessageError(instance, "the transform from '" + stamped.header.frame_id + "' to '" +
                                          stamped.child_frame_id + "' " + fault);
      }
      recording_.transforms.Add(WithoutSlash(stamped.header.frame_id),
                                WithoutSlash(stamped.child_frame_id), sample);
    }
    return Status::Ok();
  }

  rosbag::Bag bag_;
  const RosbagReadOptions& options_;
  std::map<std::string, std::string> type_of_topic_;
  std::map<std::string, std::size_t> num_messages_;  // read so far, by topic
  RosRecording recording_;
};

}  // namespace

bool CanReadRosbags() { return true; }

Status ReadRosbag(const std::string& path, const RosbagReadOptions& options,
                  RosRecording* recording) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  // The library for bags throws where the file holds nonsense, if not misled by lengths.
  PLUMBLINE_RETURN_IF_ERROR(CheckRosbagRecords(path));
  try {
    BagReader reader(path, options);
    PLUMBLINE_RETURN_IF_ERROR(reader.Read());
    *recording = reader.recording();
    return Status::Ok();
  } catch (const std::exception& exception) {
    return Status::DataLoss(path + ": cannot be read as a ROS bag: " + exception.what() +
                            " (rosbag reindex can repair a recording that was cut off)");
  }
}

}  // namespace plumbline
