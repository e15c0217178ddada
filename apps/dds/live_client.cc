#include <unistd.h>

#include <chrono>
#include <iostream>
#include <optional>
#include <string>

#include "plumbline/apps/dds/dds_node.h"
#include "plumbline/apps/dds/live_program.h"
#include "plumbline/apps/live/ros_service.h"

namespace plumbline {
namespace {

// "save_map=FOLDER" and so on; "resume" is a pause that ends.
Status ParseCall(const std::string& call, ServiceName* service, ServiceRequest* request) {
  const std::size_t equals = call.find('=');
  std::string name = call.substr(0, equals);
  request->text = equals == call.npos ? "" : call.substr(equals + 1);
  request->flag = name != "resume";
  if (name == "resume") name = "pause";
  std::string names;
  for (const ServiceName& known : LiveServices()) {
    names += known.name + ", ";
    if (known.name != name) continue;
    *service = known;
    const bool wants_text = known.argument == ServiceArgument::kText;
    if (wants_text == !request->text.empty()) return Status::Ok();
    return Status::InvalidArgument(
        "--call: " + name + (wants_text ? " needs a value, " + name + "=..." : " has no value"));
  }
  return Status::InvalidArgument("--call: '" + name + "' is none of " + names + "resume");
}

// Different for each process.
std::uint64_t ClientId() {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return static_cast<std::uint64_t>(now) << 16 ^ static_cast<std::uint64_t>(getpid());
}

}  // namespace

Status CheckCall(const std::string& call) {
  ServiceName service;
  ServiceRequest request;
  return ParseCall(call, &service, &request);
}

Status CallLive(const LiveConnection& connection, const std::string& call, double timeout_s) {
  constexpr double kPollS = 0.01;
  ServiceName service;
  ServiceRequest request;
  PLUMBLINE_RETURN_IF_ERROR(ParseCall(call, &service, &request));
  request.client = ClientId();
  request.sequence = 1;
  const std::string name = connection.Absolute("plumbline/" + service.name);
  const DdsQuality quality;
  DdsNode dds;
  PLUMBLINE_RETURN_IF_ERROR(dds.Join(connection.domain, connection.network_interface));
  std::optional<ServiceReply> reply;
  dds_entity_t writer = 0;
  PLUMBLINE_RETURN_IF_ERROR(
      dds.Subscribe(DdsTopic("rr", name + "Reply"), DdsType(service.RosType() + "_Response"),
                    quality, [&](const std::string& bytes) {
                      ServiceReply received;
                      if (DecodeReply(bytes, &received) && received.client == request.client)
                        reply = received;
                    }));
  PLUMBLINE_RETURN_IF_ERROR(dds.Advertise(
      DdsTopic("rq", name + "Request"), DdsType(service.RosType() + "_Request"), quality, &writer));
  const auto wait_until = [&](double time_s, const auto& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_s);
    while (!condition() && std::chrono::steady_clock::now() < end) dds.Spin(kPollS);
    return condition();
  };
  if (!wait_until(timeout_s, [&] { return DdsNode::NumMatches(writer) > 0 && dds.HasWriters(); })) {
    return Status::Unavailable("no live program answers to " + name + " in domain " +
                               std::to_string(connection.domain));
  }
  PLUMBLINE_RETURN_IF_ERROR(DdsNode::Publish(writer, EncodeRequest(service.argument, request)));
  if (!wait_until(10.0 * timeout_s, [&] { return reply.has_value(); })) {
    return Status::Unavailable(name + " gave no answer");
  }
  if (!reply->success) return Status::Unavailable(reply->message);
  std::cout << reply->message << '\n';
  return Status::Ok();
}

}  // namespace plumbline
