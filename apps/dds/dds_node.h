#ifndef PLUMBLINE_APPS_DDS_DDS_NODE_H_
#define PLUMBLINE_APPS_DDS_DDS_NODE_H_

#include <dds/dds.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// How messages of a topic are handed on, as ROS 2 names it.
struct DdsQuality {
  bool is_reliable = true;
  bool is_transient_local = false;  ///< later readers get the last messages as well
  int depth = 10;                   ///< messages that are kept for a reader
};

/// A participant of a DDS domain that reads and writes serialised messages under the names that ROS
/// 2 gives its topics: "/scan" is "rt/scan", and "sensor_msgs/msg/LaserScan" is
/// "sensor_msgs::msg::dds_::LaserScan_". Publish may be called from any thread, Spin from one.
class DdsNode {
 public:
  using Take = std::function<void(const std::string& bytes)>;

  DdsNode() = default;
  ~DdsNode();
  DdsNode(const DdsNode&) = delete;
  DdsNode& operator=(const DdsNode&) = delete;

  /// Joins a domain. network_interface: its name or address; empty: the one that Cyclone DDS
  /// chooses. On "lo", where there is no multicast, participants of this machine find each other.
  /// The environment variable CYCLONEDDS_URI configures all else. Unavailable if Cyclone DDS
  /// refuses.
  Status Join(int domain, const std::string& network_interface);

  /// Calls `take` from Spin for each message of a DDS topic. Unavailable if Cyclone DDS refuses.
  Status Subscribe(const std::string& dds_topic, const std::string& dds_type,
                   const DdsQuality& quality, Take take);

  /// *writer: for Publish. Unavailable if Cyclone DDS refuses.
  Status Advertise(const std::string& dds_topic, const std::string& dds_type,
                   const DdsQuality& quality, dds_entity_t* writer);

  /// Writes a message.
  static Status Publish(dds_entity_t writer, const std::string& bytes);

  /// The warnings of Cyclone DDS in this process since the last call, the first 20 of them.
  static std::vector<std::string> TakeWarnings();

  /// Number of readers that a writer has found.
  static int NumMatches(dds_entity_t writer);
  /// True if each subscription has found a writer.
  bool HasWriters() const;

  /// Waits for messages, at most for a time [s], and hands over all that are there.
  void Spin(double timeout_s);

 private:
  struct Reader {
    dds_entity_t entity = 0;
    Take take;
  };

  dds_entity_t domain_ = 0, participant_ = 0, waitset_ = 0;
  std::vector<std::unique_ptr<Reader>> readers_;
};

/// The DDS name of a topic of ROS 2. prefix: "rt", "rq" or "rr"; name: absolute.
std::string DdsTopic(const std::string& prefix, const std::string& name);

/// The DDS name of a type of ROS 2, "sensor_msgs/msg/LaserScan".
std::string DdsType(const std::string& ros_type);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_DDS_DDS_NODE_H_
