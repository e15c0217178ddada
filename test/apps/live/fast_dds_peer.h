#ifndef PLUMBLINE_TEST_APPS_LIVE_FAST_DDS_PEER_H_
#define PLUMBLINE_TEST_APPS_LIVE_FAST_DDS_PEER_H_

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace plumbline {

/// A type of Fast DDS whose samples are std::string, the bytes of a message with the header of its
/// encoding.
class PeerBytesType : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

  explicit PeerBytesType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 4096;  // to begin with
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, Payload* payload) override {
    const auto& bytes = *static_cast<std::string*>(data);
    if (bytes.size() > payload->max_size) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(Payload* payload, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<const char*>(payload->data),
                                            payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::string*>(data)->size()); };
  }
  void* createData() override { return new std::string; }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

/// A participant of Fast DDS on the loopback, with topics of bytes.
class FastDdsPeer {
 public:
  using Take = std::function<void(const std::string& bytes)>;

  explicit FastDdsPeer(int domain) {
    namespace dds = eprosima::fastdds::dds;
    dds::DomainParticipantQos qos;
    auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    transport->interfaceWhiteList.emplace_back("127.0.0.1");
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(transport);
    auto& builtin = qos.wire_protocol().builtin;
    eprosima::fastrtps::rtps::Locator_t own;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(own, 127, 0, 0, 1);
    builtin.metatrafficUnicastLocatorList.push_back(own);
    constexpr int kNumParticipants = 8;
    for (int i = 0; i < kNumParticipants; ++i) {
      eprosima::fastrtps::rtps::Locator_t other = own;
      other.port = static_cast<std::uint32_t>(7410 + 250 * domain + 2 * i);
      builtin.initialPeersList.push_back(other);
    }
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(domain), qos);
    if (participant_ == nullptr) return;
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~FastDdsPeer() {
    if (participant_ == nullptr) return;
    participant_->delete_contained_entities();
    eprosima::fastdds::dds::DomainParticipantFactory::get_instance()->delete_participant(
        participant_);
  }
  FastDdsPeer(const FastDdsPeer&) = delete;
  FastDdsPeer& operator=(const FastDdsPeer&) = delete;

  bool is_good() const { return participant_ != nullptr; }

  /// A writer for a topic, "rt/scan" of type "sensor_msgs::msg::dds_::LaserScan_".
  eprosima::fastdds::dds::DataWriter* Advertise(const std::string& topic, const std::string& type,
                                                bool is_reliable, bool is_latched = false) {
    namespace dds = eprosima::fastdds::dds;
    dds::DataWriterQos qos;
    qos.reliability().kind =
        is_reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind =
        is_latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    qos.history().depth = 1000;
    qos.reliable_writer_qos().times.heartbeatPeriod = eprosima::fastrtps::Duration_t(0.1);
    qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    return publisher_->create_datawriter(TopicOf(topic, type), qos);
  }

  /// Calls `take` from a thread of Fast DDS for each message of a topic.
  void Subscribe(const std::string& topic, const std::string& type, bool is_latched, Take take) {
    namespace dds = eprosima::fastdds::dds;
    dds::DataReaderQos qos;
    qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind =
        is_latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    qos.history().depth = is_latched ? 1 : 100;
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    listeners_.push_back(std::make_unique<Listener>(std::move(take)));
    subscriber_->create_datareader(TopicOf(topic, type), qos, listeners_.back().get());
  }

 private:
  class Listener : public eprosima::fastdds::dds::DataReaderListener {
   public:
    explicit Listener(Take take) : take_(std::move(take)) {}
    void on_data_available(eprosima::fastdds::dds::DataReader* reader) override {
      std::string bytes;
      eprosima::fastdds::dds::SampleInfo info;
      while (reader->take_next_sample(&bytes, &info) ==
             eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
        if (info.valid_data) take_(bytes);
      }
    }

   private:
    const Take take_;
  };

  eprosima::fastdds::dds::Topic* TopicOf(const std::string& topic, const std::string& type) {
    eprosima::fastdds::dds::Topic*& known = topics_[topic];
    if (known != nullptr) return known;
    eprosima::fastdds::dds::TypeSupport support(new PeerBytesType(type));
    support.register_type(participant_);
    known = participant_->create_topic(topic, type, eprosima::fastdds::dds::TOPIC_QOS_DEFAULT);
    return known;
  }

  std::vector<std::unique_ptr<Listener>> listeners_;
  std::map<std::string, eprosima::fastdds::dds::Topic*> topics_;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_LIVE_FAST_DDS_PEER_H_
