#ifndef PLUMBLINE_APPS_LIVE_ROS_SERVICE_H_
#define PLUMBLINE_APPS_LIVE_ROS_SERVICE_H_

#include <cstdint>
#include <string>
#include <vector>

namespace plumbline {

/// What a service is given. Every reply tells whether it succeeded, with a message for people.
enum class ServiceArgument {
  kNone,  ///< std_srvs/srv/Trigger
  kFlag,  ///< std_srvs/srv/SetBool
  kText,  ///< diagnostic_msgs/srv/AddDiagnostics, the type with a text that all of ROS 2 has
};

/// A service of the live program.
struct ServiceName {
  std::string name;  ///< relative to the node
  ServiceArgument argument = ServiceArgument::kNone;

  /// The type of its messages: "std_srvs/srv/Trigger".
  std::string RosType() const;
};

/// The services: save_map, localize, clear and pause.
const std::vector<ServiceName>& LiveServices();

/// The request of a service. Client and sequence number lead its message, as Cyclone DDS's mapping
/// of ROS 2 has it, and come back in the reply.
struct ServiceRequest {
  std::uint64_t client = 0, sequence = 0;
  bool flag = false;  ///< of kFlag
  std::string text;   ///< of kText
};

struct ServiceReply {
  std::uint64_t client = 0, sequence = 0;
  bool success = false;
  std::string message;
};

std::string EncodeRequest(ServiceArgument argument, const ServiceRequest& request);
std::string EncodeReply(const ServiceReply& reply);
/// Each reads a message in plain CDR, little-endian. False if the bytes are none.
bool DecodeRequest(ServiceArgument argument, const std::string& bytes, ServiceRequest* request);
bool DecodeReply(const std::string& bytes, ServiceReply* reply);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_ROS_SERVICE_H_
