#ifndef PLUMBLINE_TEST_APPS_LIVE_ROBOT_MESSAGES_H_
#define PLUMBLINE_TEST_APPS_LIVE_ROBOT_MESSAGES_H_

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "plumbline/apps/bags/bag_container.h"
#include "plumbline/apps/bags/open_bag.h"
#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A message of a bag of ROS 2.
struct RecordedMessage {
  std::string topic;
  double play_s = 0.0;  ///< when it is played
  std::string bytes;
};

/// The scans, transforms and odometry of a bag of ROS 2 in the order in which they are played: a
/// scan 6 s late, so that its odometry is there (that of the TurtleBot came up to 5 s late).
inline Status ReadMessagesOfRobot(const std::string& path, std::vector<RecordedMessage>* messages) {
  constexpr double kScanDelayS = 6.0;
  std::unique_ptr<BagContainer> bag;
  PLUMBLINE_RETURN_IF_ERROR(OpenBag(path, &bag));
  const std::vector<std::string> topics = {"/scan", "/tf", "/tf_static", "/odom"};
  PLUMBLINE_RETURN_IF_ERROR(bag->ReadMessages(
      [&](const BagTopic& topic) {
        return std::find(topics.begin(), topics.end(), topic.name) != topics.end();
      },
      [&](const BagTopic& topic, double time_s, std::string_view bytes) {
        const double delay_s = topic.name == "/scan" ? kScanDelayS : 0.0;
        messages->push_back({topic.name, time_s + delay_s, std::string(bytes)});
        return Status::Ok();
      }));
  std::stable_sort(messages->begin(), messages->end(),
                   [](const RecordedMessage& a, const RecordedMessage& b) {
                     const bool a_is_static = a.topic == "/tf_static";
                     const bool b_is_static = b.topic == "/tf_static";
                     if (a_is_static != b_is_static) return a_is_static;
                     return a.play_s < b.play_s;
                   });
  return Status::Ok();
}

/// FNV-1a.
inline std::uint64_t HashOf(std::string_view bytes) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  }
  return hash;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_LIVE_ROBOT_MESSAGES_H_
