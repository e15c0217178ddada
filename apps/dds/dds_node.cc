#include "plumbline/apps/dds/dds_node.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <utility>

#include "plumbline/apps/dds/bytes_type.h"

namespace plumbline {
namespace {

// How long a writer of reliable messages waits for a slow reader before it gives up [s].
constexpr double kMaxBlockingS = 0.1;

dds_duration_t Duration(double seconds) {
  return static_cast<dds_duration_t>(seconds * DDS_NSECS_IN_SEC);
}

// Lines that Cyclone DDS logs, instead of standard error.
class DdsLog {
 public:
  static DdsLog& Of() {
    static DdsLog log;
    return log;
  }
  void Add(const dds_log_data_t& entry) {
    constexpr std::size_t kMaxLines = 20;
    std::string line(entry.message, std::strcspn(entry.message, "\n"));
    const std::lock_guard<std::mutex> lock(mutex_);
    if (lines_.size() < kMaxLines) lines_.push_back(std::move(line));
  }
  std::vector<std::string> Take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(lines_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> lines_;
};

Status Failure(const std::string& action, dds_return_t code) {
  std::string text = "DDS: cannot " + action + ": " + dds_strretcode(code);
  for (const std::string& line : DdsLog::Of().Take()) text += "; " + line;
  return Status::Unavailable(text);
}

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '<') {
      escaped += "&lt;";
    } else if (c == '&') {
      escaped += "&amp;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

// The configuration of a domain on one network interface. On the loopback participants look for
// each other at the ports of the first 32.
std::string InterfaceConfig(const std::string& name) {
  const bool is_loopback = name == "lo" || name == "127.0.0.1";
  const bool is_address = !name.empty() && name.find_first_not_of("0123456789.") == name.npos;
  std::string config = "<CycloneDDS><Domain><General><Interfaces><NetworkInterface " +
                       std::string(is_address ? "address" : "name") + "=\"" + Escaped(name) +
                       "\"/></Interfaces>";
  if (is_loopback) config += "<AllowMulticast>false</AllowMulticast>";
  config += "</General>";
  if (is_loopback) {
    config +=
        "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>31</MaxAutoParticipantIndex>"
        "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>";
  }
  return config + "</Domain></CycloneDDS>";
}

struct FreeQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, FreeQos>;

Qos QosOf(const DdsQuality& quality) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(),
                       quality.is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       Duration(kMaxBlockingS));
  dds_qset_durability(qos.get(), quality.is_transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL
                                                            : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, quality.depth);
  if (quality.is_transient_local) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, quality.depth,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

}  // namespace

std::string DdsTopic(const std::string& prefix, const std::string& name) { return prefix + name; }

std::string DdsType(const std::string& ros_type) {
  std::string type;
  const std::size_t last = ros_type.rfind('/');
  for (std::size_t i = 0; i < ros_type.size(); ++i) {
    if (ros_type[i] == '/') {
      type += i == last ? "::dds_::" : "::";
    } else {
      type += ros_type[i];
    }
  }
  return type + "_";
}

DdsNode::~DdsNode() {
  if (participant_ > 0) dds_delete(participant_);
  if (domain_ > 0) dds_delete(domain_);
}

std::vector<std::string> DdsNode::TakeWarnings() { return DdsLog::Of().Take(); }

Status DdsNode::Join(int domain, const std::string& network_interface) {
  dds_set_log_sink([](void*, const dds_log_data_t* entry) { DdsLog::Of().Add(*entry); }, nullptr);
  if (!network_interface.empty()) {
    // Parts of a configuration are separated by commas, the later ones count.
    const char* given = std::getenv("CYCLONEDDS_URI");  // NOLINT(concurrency-mt-unsafe)
    std::string config = given == nullptr || *given == '\0' ? "" : std::string(given) + ",";
    config += InterfaceConfig(network_interface);
    domain_ = dds_create_domain(static_cast<dds_domainid_t>(domain), config.c_str());
    if (domain_ < 0) return Failure("use the interface '" + network_interface + "'", domain_);
  }
  participant_ = dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr);
  if (participant_ < 0) {
    return Failure("join domain " + std::to_string(domain) +
                       (network_interface.empty() ? "" : " on '" + network_interface + "'"),
                   participant_);
  }
  waitset_ = dds_create_waitset(participant_);
  return waitset_ < 0 ? Failure("wait for messages", waitset_) : Status::Ok();
}

Status DdsNode::Subscribe(const std::string& dds_topic, const std::string& dds_type,
                          const DdsQuality& quality, Take take) {
  const dds_entity_t topic = CreateBytesTopic(participant_, dds_topic, dds_type);
  if (topic < 0) return Failure("create the topic " + dds_topic, topic);
  auto reader = std::make_unique<Reader>();
  reader->entity = dds_create_reader(participant_, topic, QosOf(quality).get(), nullptr);
  if (reader->entity < 0) return Failure("read " + dds_topic, reader->entity);
  reader->take = std::move(take);
  dds_set_status_mask(reader->entity, DDS_DATA_AVAILABLE_STATUS);
  const dds_return_t attached = dds_waitset_attach(waitset_, reader->entity, 0);
  if (attached < 0) return Failure("wait for " + dds_topic, attached);
  readers_.push_back(std::move(reader));
  return Status::Ok();
}

Status DdsNode::Advertise(const std::string& dds_topic, const std::string& dds_type,
                          const DdsQuality& quality, dds_entity_t* writer) {
  const dds_entity_t topic = CreateBytesTopic(participant_, dds_topic, dds_type);
  if (topic < 0) return Failure("create the topic " + dds_topic, topic);
  const dds_entity_t created =
      dds_create_writer(participant_, topic, QosOf(quality).get(), nullptr);
  if (created < 0) return Failure("write " + dds_topic, created);
  *writer = created;
  return Status::Ok();
}

Status DdsNode::Publish(dds_entity_t writer, const std::string& bytes) {
  const dds_return_t written = dds_write(writer, &bytes);
  return written < 0 ? Failure("write a message", written) : Status::Ok();
}

int DdsNode::NumMatches(dds_entity_t writer) {
  return static_cast<int>(dds_get_matched_subscriptions(writer, nullptr, 0));
}

bool DdsNode::HasWriters() const {
  return std::all_of(readers_.begin(), readers_.end(), [](const auto& reader) {
    return dds_get_matched_publications(reader->entity, nullptr, 0) > 0;
  });
}

void DdsNode::Spin(double timeout_s) {
  dds_waitset_wait(waitset_, nullptr, 0, Duration(timeout_s));
  for (const std::unique_ptr<Reader>& reader : readers_) {
    std::string bytes;
    void* sample = &bytes;
    dds_sample_info_t info;
    while (dds_take(reader->entity, &sample, &info, 1, 1) > 0) {
      if (info.valid_data) reader->take(bytes);
    }
  }
}

}  // namespace plumbline
