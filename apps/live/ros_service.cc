#include "plumbline/apps/live/ros_service.h"

#include <string_view>
#include <utility>

#include "plumbline/apps/io/byte_reader.h"
#include "plumbline/apps/live/ros_encoder.h"

namespace plumbline {
namespace {

// Takes the header of the encoding, and who asks.
bool TakeStart(ByteReader* reader, std::uint64_t* client, std::uint64_t* sequence) {
  const bool is_little_endian = reader->Bytes(4).substr(0, 2) == std::string_view("\0\1", 2);
  *client = reader->Number<std::uint64_t>();
  *sequence = reader->Number<std::uint64_t>();
  return reader->ok() && is_little_endian;
}

// Takes a text with the zero byte at its end.
bool TakeText(ByteReader* reader, std::string* text) {
  const std::string_view bytes = reader->Text();
  if (!reader->ok() || bytes.empty() || bytes.back() != '\0') return false;
  *text = std::string(bytes.substr(0, bytes.size() - 1));
  return true;
}

}  // namespace

std::string ServiceName::RosType() const {
  switch (argument) {
    case ServiceArgument::kNone:
      return "std_srvs/srv/Trigger";
    case ServiceArgument::kFlag:
      return "std_srvs/srv/SetBool";
    case ServiceArgument::kText:
      break;
  }
  return "diagnostic_msgs/srv/AddDiagnostics";
}

const std::vector<ServiceName>& LiveServices() {
  static const std::vector<ServiceName> services = {{"save_map", ServiceArgument::kText},
                                                    {"localize", ServiceArgument::kText},
                                                    {"clear", ServiceArgument::kNone},
                                                    {"pause", ServiceArgument::kFlag}};
  return services;
}

std::string EncodeRequest(ServiceArgument argument, const ServiceRequest& request) {
  CdrWriter writer;
  writer.Unsigned64(request.client);
  writer.Unsigned64(request.sequence);
  if (argument == ServiceArgument::kText) {
    writer.Text(request.text);
  } else {
    writer.Byte(request.flag ? 1 : 0);  // an empty message has a byte that means nothing
  }
  return std::move(writer.bytes());
}

std::string EncodeReply(const ServiceReply& reply) {
  CdrWriter writer;
  writer.Unsigned64(reply.client);
  writer.Unsigned64(reply.sequence);
  writer.Byte(reply.success ? 1 : 0);
  writer.Text(reply.message);
  return std::move(writer.bytes());
}

bool DecodeRequest(ServiceArgument argument, const std::string& bytes, ServiceRequest* request) {
  ByteReader reader(bytes);
  if (!TakeStart(&reader, &request->client, &request->sequence)) return false;
  if (argument == ServiceArgument::kText) return TakeText(&reader, &request->text);
  request->flag = reader.Number<std::uint8_t>() != 0;
  return argument == ServiceArgument::kNone || reader.ok();
}

bool DecodeReply(const std::string& bytes, ServiceReply* reply) {
  ByteReader reader(bytes);
  if (!TakeStart(&reader, &reply->client, &reply->sequence)) return false;
  reply->success = reader.Number<std::uint8_t>() != 0;
  reader.Bytes(3);  // up to the text's length
  return TakeText(&reader, &reply->message);
}

}  // namespace plumbline
