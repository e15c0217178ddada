#include "plumbline/apps/bags/bag_reader.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "plumbline/apps/bags/bag_container.h"
#include "plumbline/apps/bags/open_bag.h"
#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/io/compressed_frames.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/memory_limit.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr char kScanType[] = "sensor_msgs/LaserScan";
constexpr char kMultiEchoType[] = "sensor_msgs/MultiEchoLaserScan";
constexpr char kCloudType[] = "sensor_msgs/PointCloud2";
constexpr char kScanTypes[] = "sensor_msgs/LaserScan, MultiEchoLaserScan or PointCloud2";
constexpr char kOdometryType[] = "nav_msgs/Odometry";
// Of a message that rosbag2 has compressed.
constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 28;

// "sensor_msgs/LaserScan" of "sensor_msgs/msg/LaserScan", as ROS 2 calls it.
std::string TypeOf(const BagTopic& topic) {
  constexpr std::string_view kOfRos2 = "/msg/";
  std::string type = topic.type;
  const std::size_t at = type.find(kOfRos2);
  return at == type.npos ? type : type.replace(at, kOfRos2.size(), "/");
}

bool IsOfScans(const BagTopic& topic) {
  const std::string type = TypeOf(topic);
  return type == kScanType || type == kMultiEchoType || type == kCloudType;
}

bool IsOfTransforms(const BagTopic& topic) {
  const std::string type = TypeOf(topic);
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";  // equal but for the name
}

// "/scan" and "scan" are one topic, "/odom" and "odom" one frame.
std::string WithoutSlash(const std::string& name) {
  return name.empty() || name.front() != '/' ? name : name.substr(1);
}

// A name that the bag gives, for people.
std::string Shown(const std::string& name) { return Printable(name, 200); }

std::string Description(const BagTopic& topic) {
  std::string text =
      Shown(topic.name) + " (" + (topic.type.empty() ? "no type" : Shown(topic.type));
  if (topic.encoding != "ros1" && topic.encoding != "cdr") {
    text += ", encoding " + Quote(topic.encoding);
  }
  return text + ")";
}

// With a graph of the same scan.
std::size_t BytesOf(const RosScan& scan) {
  const std::size_t num_readings = scan.ranges.size() + scan.bearings_rad.size();
  return 2 * (sizeof(scan) + scan.frame.size() + num_readings * sizeof(double));
}

// As the tree keeps it: any number of frames may have long names.
std::size_t BytesOf(const RosTransform& transform) {
  return sizeof(StampedTransform) + transform.frame.size() + transform.child_frame.size();
}

// Reads one bag.
class BagReader {
 public:
  BagReader(const std::string& path, const BagReadOptions& options)
      : options_(options), cutter_(options.slice_height_m), memory_(options.max_bytes) {
    recording_.path = path;
    recording_.odom_frame = WithoutSlash(options.odom_frame);
    recording_.needs_odometry = options.needs_odometry || !options.odom_topic.empty();
  }

  Status Read(BagContainer* bag) {
    const auto list = [this](const BagTopic& topic) {
      topics_.insert(topic);
      return false;
    };
    const auto take = [this](const BagTopic& topic, double time_s, std::string_view bytes) {
      PLUMBLINE_RETURN_IF_ERROR(TakeMessage({topic, time_s, bytes, ""}));
      ++num_messages_[topic.name];
      return Status::Ok();
    };
    PLUMBLINE_RETURN_IF_ERROR(bag->ReadMessages(list, take));
    recording_.omission = bag->Omission();
    PLUMBLINE_RETURN_IF_ERROR(DropEmptyTopics(bag));
    PLUMBLINE_RETURN_IF_ERROR(ChooseTopics());
    PLUMBLINE_RETURN_IF_ERROR(CheckEncodings());
    PLUMBLINE_RETURN_IF_ERROR(
        bag->ReadMessages([this](const BagTopic& topic) { return IsWanted(topic); }, take));
    recording_.omission = bag->Omission();
    if (recording_.odometry.empty() && recording_.bad_odometry.num() == 0 &&
        options_.odom_topic.empty()) {
      recording_.odom_topic.clear();  // no message: the transforms may tell
    }
    return Status::Ok();
  }

  RosRecording&& recording() { return std::move(recording_); }

 private:
  struct Message {
    const BagTopic& topic;
    double time_s;
    std::string_view bytes;
    std::string fault;  // why the bytes cannot be expanded; empty if they can be
  };

  Status Error(const std::string& problem) const {
    return Status::InvalidArgument(recording_.path + ": " + problem);
  }

  std::string TopicList() const {
    std::string text;
    for (const BagTopic& topic : topics_) text += (text.empty() ? "" : ", ") + Description(topic);
    return "; the bag has " + (text.empty() ? "no topics" : text) +
           (recording_.omission.empty() ? "" : " (" + recording_.omission + ")");
  }

  // Where several topics may be meant, those without messages are no choice.
  Status DropEmptyTopics(BagContainer* bag) {
    if (options_.scan_topic.empty()) {
      PLUMBLINE_RETURN_IF_ERROR(DropEmpty(bag, {kScanType, kMultiEchoType, kCloudType}));
    }
    return options_.odom_topic.empty() ? DropEmpty(bag, {kOdometryType}) : Status::Ok();
  }

  // Looks for messages in the topics of each type in turn, up to the first type that has some.
  Status DropEmpty(BagContainer* bag, const std::vector<std::string>& types) {
    const auto num_topics = std::count_if(topics_.begin(), topics_.end(), [&](const auto& topic) {
      return std::find(types.begin(), types.end(), TypeOf(topic)) != types.end();
    });
    if (num_topics < 2) return Status::Ok();
    std::set<BagTopic> empty;
    for (const std::string& type : types) {
      std::set<BagTopic> unseen;
      for (const BagTopic& topic : topics_) {
        if (TypeOf(topic) == type) unseen.insert(topic);
      }
      const std::size_t num_of_type = unseen.size();
      PLUMBLINE_RETURN_IF_ERROR(DropSeen(bag, &unseen));
      empty.insert(unseen.begin(), unseen.end());
      if (unseen.size() == num_of_type) continue;
      empty_topics_.insert(empty.begin(), empty.end());
      break;
    }
    return Status::Ok();
  }

  // Keeps the topics that have no message. Reads no further than to the first message of each.
  static Status DropSeen(BagContainer* bag, std::set<BagTopic>* topics) {
    if (topics->empty()) return Status::Ok();
    const std::set<BagTopic> wanted = *topics;
    const Status status =
        bag->ReadMessages([&](const BagTopic& topic) { return wanted.count(topic) > 0; },
                          [&](const BagTopic& topic, double, std::string_view) {
                            topics->erase(topic);
                            return topics->empty() ? Status::Unavailable("") : Status::Ok();
                          });
    return topics->empty() ? Status::Ok() : status;
  }

  // The wanted topic, or the only one of the type; null if there is none.
  Status ChooseTopic(const std::string& wanted, const std::string& type, const std::string& flag,
                     const BagTopic** chosen) const {
    for (const BagTopic& topic : topics_) {
      if (wanted.empty() ? TypeOf(topic) != type || empty_topics_.count(topic) > 0
                         : WithoutSlash(topic.name) != WithoutSlash(wanted)) {
        continue;
      }
      if (*chosen != nullptr) {
        return Error("there are several topics of type " + type + ": choose one by --" + flag +
                     TopicList());
      }
      *chosen = &topic;
    }
    if (!wanted.empty() && *chosen == nullptr) {
      return Error("there is no topic '" + wanted + "', as --" + flag + " asks for" + TopicList());
    }
    return Status::Ok();
  }

  Status ChooseTopics() {
    const BagTopic* scans = nullptr;
    for (const char* type : {kScanType, kMultiEchoType, kCloudType}) {
      if (scans != nullptr) break;
      PLUMBLINE_RETURN_IF_ERROR(ChooseTopic(options_.scan_topic, type, "scan_topic", &scans));
    }
    if (scans == nullptr) {
      return Error(std::string("there is no topic of type ") + kScanTypes + TopicList());
    }
    if (!IsOfScans(*scans)) {
      return Error(Shown(scans->name) + " is not of type " + kScanTypes + TopicList());
    }
    recording_.scan_topic = scans->name;
    const BagTopic* odometry = nullptr;
    PLUMBLINE_RETURN_IF_ERROR(
        ChooseTopic(options_.odom_topic, kOdometryType, "odom_topic", &odometry));
    if (odometry == nullptr || IsOfTransforms(*odometry)) return Status::Ok();
    if (TypeOf(*odometry) != kOdometryType) {
      return Error(Shown(odometry->name) + " is neither of type " + kOdometryType +
                   " nor of transforms" + TopicList());
    }
    recording_.odom_topic = odometry->name;
    return Status::Ok();
  }

  bool IsWanted(const BagTopic& topic) const {
    return topic.name == recording_.scan_topic || topic.name == recording_.odom_topic ||
           IsOfTransforms(topic);
  }

  Status CheckEncodings() const {
    for (const BagTopic& topic : topics_) {
      if (!IsWanted(topic) || topic.encoding == "ros1" || topic.encoding == "cdr") continue;
      return Error(Shown(topic.name) + " has messages in the encoding " + Quote(topic.encoding) +
                   "; only cdr and ros1 can be read" + TopicList());
    }
    return Status::Ok();
  }

  Status TakeMessage(Message message) {
    // rosbag2 may compress each message. None of ours begins like that.
    if (message.topic.encoding == "cdr" && StartsWithZstdFrame(message.bytes)) {
      const Status status =
          ExpandFrames(FrameFormat::kZstd, message.bytes, kMaxMessageBytes, &expanded_);
      message.fault = status.message();
      message.bytes = expanded_;
    }
    if (message.topic.name == recording_.scan_topic) return TakeScan(message);
    if (message.topic.name == recording_.odom_topic) return TakeOdometry(message);
    return TakeTransforms(message);
  }

  static RosEncoding EncodingOf(const Message& message) {
    return message.topic.encoding == "ros1" ? RosEncoding::kRos1 : RosEncoding::kCdr;
  }

  std::string MessageName(const Message& message) const {
    const auto index = num_messages_.find(message.topic.name);
    return RosMessageName(Shown(message.topic.name),
                          index == num_messages_.end() ? 0 : index->second, message.time_s);
  }

  Status MessageError(const Message& message, const std::string& problem) const {
    return Error(MessageName(message) + problem);
  }

  Status Keep(const Message& message, std::size_t bytes) {
    return memory_.Keep(bytes) ? Status::Ok() : MessageError(message, memory_.Fault());
  }

  // Sets `fault` if the message is none of its type. Fails if the user has to choose heights.
  Status DecodeAnyScan(const Message& message, RosScan* scan, std::string* fault) {
    const std::string type = TypeOf(message.topic);
    const RosEncoding encoding = EncodingOf(message);
    if (type == kScanType) {
      DecodeScan(encoding, message.bytes, scan, fault);
    } else if (type == kMultiEchoType) {
      DecodeMultiEchoScan(encoding, message.bytes, options_.echo, scan, fault);
    } else {
      RosCloud cloud;
      std::string problem;
      if (DecodeCloud(encoding, message.bytes, &cloud, fault) &&
          !cutter_.Cut(cloud, scan, &problem)) {
        return MessageError(message, problem);
      }
    }
    return Status::Ok();
  }

  Status TakeScan(const Message& message) {
    RosScan scan;
    std::string fault = message.fault;
    if (fault.empty()) PLUMBLINE_RETURN_IF_ERROR(DecodeAnyScan(message, &scan, &fault));
    if (!fault.empty()) {
      scan = RosScan();
      scan.fault = fault;
    }
    scan.received_s = message.time_s;
    scan.frame = WithoutSlash(scan.frame);
    PLUMBLINE_RETURN_IF_ERROR(Keep(message, BytesOf(scan)));
    recording_.scans.push_back(std::move(scan));
    return Status::Ok();
  }

  Status TakeOdometry(const Message& message) {
    RosOdometry odometry;
    Eigen::Isometry3d odom_from_robot;
    std::string fault = message.fault;
    if (fault.empty() && DecodeOdometry(EncodingOf(message), message.bytes, &odometry, &fault)) {
      if (!ToIsometry(odometry.pose, &odom_from_robot, &fault))
        fault = "field 'pose.pose' " + fault;
    }
    if (!fault.empty()) {
      recording_.bad_odometry.Add(fault, MessageName(message) + fault);
      return Status::Ok();
    }
    recording_.odom_frame = WithoutSlash(odometry.frame);
    recording_.robot_frame = WithoutSlash(odometry.child_frame);
    PLUMBLINE_RETURN_IF_ERROR(Keep(message, 2 * sizeof(TimedPose)));  // with a graph of them
    recording_.odometry.push_back({odometry.stamp_s, InPlane(odom_from_robot)});
    recording_.odometry_received_s.push_back(message.time_s);
    return Status::Ok();
  }

  Status TakeTransforms(const Message& message) {
    std::vector<RosTransform> transforms;
    std::string fault = message.fault;
    ++recording_.num_transform_messages;
    if (!fault.empty() ||
        !DecodeTransforms(EncodingOf(message), message.bytes, &transforms, &fault)) {
      recording_.bad_transforms.Add(fault, MessageName(message) + fault);
      return Status::Ok();
    }
    for (const RosTransform& transform : transforms) {
      PLUMBLINE_RETURN_IF_ERROR(Keep(message, BytesOf(transform)));
      const std::string parent = WithoutSlash(transform.frame);
      const std::string child = WithoutSlash(transform.child_frame);
      StampedTransform sample;
      sample.stamp_s = transform.stamp_s;
      sample.received_s = message.time_s;
      if (ToIsometry(transform.pose, &sample.parent_from_child, &fault)) {
        recording_.transforms.Add(parent, child, sample);
      } else {
        recording_.transforms.AddBad(parent, child, "the transform " + fault,
                                     MessageName(message) + "the transform from " +
                                         Quote(transform.frame) + " to " +
                                         Quote(transform.child_frame) + " " + fault);
      }
    }
    return Status::Ok();
  }

  const BagReadOptions& options_;
  std::set<BagTopic> topics_, empty_topics_;
  std::map<std::string, std::size_t> num_messages_;  // read so far, by topic
  std::string expanded_;
  CloudCutter cutter_;
  MemoryLimit memory_;
  RosRecording recording_;
};

}  // namespace

bool BagReadOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(max_bytes, >=, 0.0);
  if (slice_height_m && !slice_height_m->Check(error)) return false;
  if (odom_frame.empty() && error != nullptr) *error = "odom_frame is empty";
  return !odom_frame.empty();
}

Status ReadBag(const std::string& path, const BagReadOptions& options, RosRecording* recording) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  std::unique_ptr<BagContainer> bag;
  PLUMBLINE_RETURN_IF_ERROR(OpenBag(path, &bag, options.max_bytes));
  BagReader reader(path, options);
  PLUMBLINE_RETURN_IF_ERROR(reader.Read(bag.get()));
  *recording = reader.recording();
  return Status::Ok();
}

}  // namespace plumbline
