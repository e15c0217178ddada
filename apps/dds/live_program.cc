#include "plumbline/apps/dds/live_program.h"

#include <chrono>
#include <iostream>
#include <map>
#include <utility>
#include <vector>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/dds/dds_node.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/live/ros_encoder.h"
#include "plumbline/apps/live/ros_service.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

// How often diagnostics are written, and how long the program waits for messages at most [s].
constexpr double kDiagnosticPeriodS = 1.0, kWakeUpS = 0.02;

// As ROS 2 has it: sensor data, transforms, static transforms, other topics, services.
constexpr DdsQuality kSensorQuality{false, false, 50}, kTransformQuality{true, false, 1000},
    kStaticQuality{true, true, 100}, kDefaultQuality{true, false, 10},
    kLatchedQuality{true, true, 1};

double SystemTimeS() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class LiveProgram {
 public:
  explicit LiveProgram(const LiveProgramOptions& options)
      : options_(options), session_(options.session, Outputs()), node_(session_.node()) {}

  Status Run(const std::function<bool()>& is_stopped) {
    PLUMBLINE_RETURN_IF_ERROR(
        dds_.Join(options_.connection.domain, options_.connection.network_interface));
    PLUMBLINE_RETURN_IF_ERROR(session_.UseSavedMap());
    PLUMBLINE_RETURN_IF_ERROR(AdvertiseAll());
    PLUMBLINE_RETURN_IF_ERROR(SubscribeAll());
    std::cout << "Listening for scans on " << Topic(options_.scan_topic) << ", domain "
              << options_.connection.domain << '\n'
              << std::flush;
    session_.Start();
    double next_report_s = LiveSession::NowS();
    while (!is_stopped()) {
      dds_.Spin(kWakeUpS);
      session_.Wake();
      if (LiveSession::NowS() < next_report_s) continue;
      next_report_s += kDiagnosticPeriodS;
      Report();
    }
    session_.Stop();
    Report();
    const LiveReport report = node_.Report();
    std::cout << report.num_received << " scans received, " << report.num_mapped << " mapped\n";
    return Status::Ok();
  }

 private:
  std::string Topic(const std::string& name) const { return options_.connection.Absolute(name); }

  Status Advertise(const std::string& name, const char* type, const DdsQuality& quality,
                   dds_entity_t* writer) {
    return dds_.Advertise(DdsTopic("rt", Topic(name)), DdsType(type), quality, writer);
  }

  Status Subscribe(const std::string& name, const char* type, const DdsQuality& quality,
                   DdsNode::Take take) {
    return dds_.Subscribe(DdsTopic("rt", Topic(name)), DdsType(type), quality, std::move(take));
  }

  Status AdvertiseAll() {
    PLUMBLINE_RETURN_IF_ERROR(
        Advertise(options_.tf_topic, "tf2_msgs/msg/TFMessage", kTransformQuality, &tf_));
    PLUMBLINE_RETURN_IF_ERROR(
        Advertise("map", "nav_msgs/msg/OccupancyGrid", kLatchedQuality, &map_));
    PLUMBLINE_RETURN_IF_ERROR(
        Advertise("plumbline/path", "nav_msgs/msg/Path", kLatchedQuality, &path_));
    PLUMBLINE_RETURN_IF_ERROR(
        Advertise("pose", "geometry_msgs/msg/PoseWithCovarianceStamped", kDefaultQuality, &pose_));
    return Advertise("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", kDefaultQuality,
                     &diagnostics_);
  }

  Status SubscribeAll() {
    PLUMBLINE_RETURN_IF_ERROR(Subscribe(options_.scan_topic, "sensor_msgs/msg/LaserScan",
                                        kSensorQuality,
                                        [this](const std::string& bytes) { TakeScan(bytes); }));
    for (const bool is_static : {true, false}) {
      const std::string topic = options_.tf_topic + (is_static ? "_static" : "");
      PLUMBLINE_RETURN_IF_ERROR(
          Subscribe(topic, "tf2_msgs/msg/TFMessage", is_static ? kStaticQuality : kTransformQuality,
                    [this, topic](const std::string& bytes) { TakeTransforms(topic, bytes); }));
    }
    if (!options_.odom_topic.empty()) {
      PLUMBLINE_RETURN_IF_ERROR(
          Subscribe(options_.odom_topic, "nav_msgs/msg/Odometry", kSensorQuality,
                    [this](const std::string& bytes) { TakeOdometry(bytes); }));
    }
    if (options_.use_sim_time) {
      PLUMBLINE_RETURN_IF_ERROR(Subscribe("/clock", "rosgraph_msgs/msg/Clock", kSensorQuality,
                                          [this](const std::string& bytes) { TakeClock(bytes); }));
    }
    for (const ServiceName& service : LiveServices()) {
      PLUMBLINE_RETURN_IF_ERROR(Serve(service));
    }
    return Status::Ok();
  }

  Status Serve(const ServiceName& service) {
    const std::string name = Topic("plumbline/" + service.name);
    const std::string type = service.RosType();
    PLUMBLINE_RETURN_IF_ERROR(dds_.Advertise(DdsTopic("rr", name + "Reply"),
                                             DdsType(type + "_Response"), kDefaultQuality,
                                             &replies_[service.name]));
    return dds_.Subscribe(
        DdsTopic("rq", name + "Request"), DdsType(type + "_Request"), kDefaultQuality,
        [this, service](const std::string& bytes) { TakeRequest(service, bytes); });
  }

  void AddBadMessage(const std::string& topic, const std::string& fault) {
    node_.AddFault("messages on " + topic + " that cannot be decoded", fault);
  }

  void TakeScan(const std::string& bytes) {
    RosScan scan;
    std::string fault;
    if (DecodeScan(RosEncoding::kCdr, bytes, &scan, &fault)) {
      node_.AddScan(std::move(scan), LiveSession::NowS());
    } else {
      AddBadMessage(options_.scan_topic, fault);
    }
  }

  void TakeTransforms(const std::string& topic, const std::string& bytes) {
    std::vector<RosTransform> transforms;
    std::string fault;
    if (DecodeTransforms(RosEncoding::kCdr, bytes, &transforms, &fault)) {
      node_.AddTransforms(transforms);
    } else {
      AddBadMessage(topic, fault);
    }
  }

  void TakeOdometry(const std::string& bytes) {
    RosOdometry odometry;
    std::string fault;
    if (DecodeOdometry(RosEncoding::kCdr, bytes, &odometry, &fault)) {
      node_.AddOdometry(odometry);
    } else {
      AddBadMessage(options_.odom_topic, fault);
    }
  }

  void TakeClock(const std::string& bytes) {
    double time_s = 0.0;
    if (DecodeClock(bytes, &time_s)) {
      sim_time_s_ = time_s;
    } else {
      node_.AddFault("messages on /clock that cannot be decoded", "");
    }
  }

  void TakeRequest(const ServiceName& service, const std::string& bytes) {
    ServiceRequest request;
    if (!DecodeRequest(service.argument, bytes, &request)) {
      return AddBadMessage(service.name, "it is no request of type " + service.RosType());
    }
    session_.Execute(
        {service.name, request.text, request.flag},
        [this, name = service.name, client = request.client, sequence = request.sequence](
            const Status& status, const std::string& text) {
          Publish(replies_.at(name), EncodeReply({client, sequence, status.ok(), text}));
          std::cout << name << ": " << Legible(text) << '\n' << std::flush;
        });
  }

  void Publish(dds_entity_t writer, const std::string& bytes) {
    const Status status = DdsNode::Publish(writer, bytes);
    if (!status.ok()) node_.AddFault("messages that could not be written", status.message());
  }

  LiveOutputs Outputs() {
    LiveOutputs outputs;
    outputs.update = [this](const LiveUpdate& update) {
      Publish(tf_, EncodeTransform(update.stamp_s + options_.transform_tolerance_s,
                                   options_.map_frame, update.child_frame, update.map_from_child));
      Publish(pose_, EncodePose(update.stamp_s, options_.map_frame, update.map_from_base));
    };
    outputs.map = [this](const LiveMap& map) {
      Publish(map_, EncodeGrid(map, options_.map_frame));
      Publish(path_, EncodePath(map, options_.map_frame));
    };
    outputs.diagnostic = [this](const Diagnostic& diagnostic) {
      Publish(diagnostics_,
              EncodeDiagnostic(options_.use_sim_time ? sim_time_s_ : SystemTimeS(), diagnostic));
    };
    outputs.news = [](const std::string& line) {
      std::cerr << "plumbline_live: " << line << std::endl;
    };
    return outputs;
  }

  void Report() {
    for (const std::string& line : DdsNode::TakeWarnings()) {
      node_.AddFault("warnings of DDS", line);
    }
    session_.Report();
  }

  const LiveProgramOptions options_;
  LiveSession session_;
  LiveNode& node_;           // of the session
  double sim_time_s_ = 0.0;  // of the thread that reads
  dds_entity_t tf_ = 0, map_ = 0, path_ = 0, pose_ = 0, diagnostics_ = 0;
  std::map<std::string, dds_entity_t> replies_;  // writers, by service
  DdsNode dds_;                                  // last, so that it ends first
};

}  // namespace

bool LiveConnection::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(domain, 0, 232);
  return true;
}

std::string LiveConnection::Absolute(const std::string& name) const {
  if (!name.empty() && name.front() == '/') return name;
  std::string space = ros_namespace;
  while (!space.empty() && space.back() == '/') space.pop_back();
  if (!space.empty() && space.front() != '/') space.insert(0, "/");
  return space + "/" + name;
}

bool LiveProgramOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(connection);
  PLUMBLINE_CHECK_NESTED_OPTIONS(session);
  PLUMBLINE_CHECK_OPTION_WITHIN(transform_tolerance_s, 0.0, 10.0);
  return true;
}

Status RunLive(const LiveProgramOptions& options, const std::function<bool()>& is_stopped) {
  return LiveProgram(options).Run(is_stopped);
}

}  // namespace plumbline
