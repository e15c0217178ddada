#include "plumbline/apps/dds/live_program.h"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <iostream>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/dds/dds_node.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/live/ros_encoder.h"
#include "plumbline/apps/live/ros_service.h"
#include "plumbline/apps/live/save_live_map.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

// Standard deviations that poses are given with: they are not estimated.
constexpr double kPoseSigmaM = 0.05, kPoseSigmaRad = 0.02;

// How often diagnostics are written, and how long a thread sleeps at most [s].
constexpr double kDiagnosticPeriodS = 1.0, kWakeUpS = 0.02;

// As ROS 2 has it: sensor data, transforms, static transforms, other topics, services.
constexpr DdsQuality kSensorQuality{false, false, 50}, kTransformQuality{true, false, 1000},
    kStaticQuality{true, true, 100}, kDefaultQuality{true, false, 10},
    kLatchedQuality{true, true, 1};

constexpr std::size_t kMaxWaitingCommands = 16;

double SteadyTimeS() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double SystemTimeS() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// A request that waits for its turn.
struct Command {
  ServiceName service;
  ServiceRequest request;
};

class LiveProgram {
 public:
  explicit LiveProgram(const LiveProgramOptions& options)
      : options_(options), node_(options.node) {}

  Status Run(const std::function<bool()>& is_stopped) {
    PLUMBLINE_RETURN_IF_ERROR(
        dds_.Join(options_.connection.domain, options_.connection.network_interface));
    if (!options_.map_file.empty()) {
      SlamGraph map;
      PLUMBLINE_RETURN_IF_ERROR(ReadSavedMap(options_.map_file, options_.localize, &map));
      node_.UseMap(std::move(map));
    }
    PLUMBLINE_RETURN_IF_ERROR(AdvertiseAll());
    PLUMBLINE_RETURN_IF_ERROR(SubscribeAll());
    std::cout << "Listening for scans on " << Topic(options_.scan_topic) << ", domain "
              << options_.connection.domain << '\n'
              << std::flush;
    std::thread worker([this] { RunWorker(); });
    std::thread mapper([this] { RunMapper(); });
    std::thread commander([this] { RunCommander(); });
    double next_report_s = SteadyTimeS();
    while (!is_stopped()) {
      dds_.Spin(kWakeUpS);
      WakeWorker();
      if (SteadyTimeS() < next_report_s) continue;
      next_report_s += kDiagnosticPeriodS;
      Report();
    }
    Stop();
    for (std::thread* thread : {&worker, &mapper, &commander}) thread->join();
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
      node_.AddScan(std::move(scan), SteadyTimeS());
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
    Command command{service, {}};
    if (!DecodeRequest(service.argument, bytes, &command.request)) {
      return AddBadMessage(service.name, "it is no request of type " + service.RosType());
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (commands_.size() < kMaxWaitingCommands) {
        commands_.push_back(std::move(command));
        return wake_up_.notify_all();
      }
    }
    Reply(command, Status::Unavailable("too many requests are waiting"), "");
  }

  void Reply(const Command& command, const Status& status, const std::string& message) {
    const std::string& text = status.ok() ? message : status.message();
    Publish(replies_.at(command.service.name),
            EncodeReply({command.request.client, command.request.sequence, status.ok(), text}));
    std::cout << command.service.name << ": " << Legible(text) << '\n' << std::flush;
  }

  void Publish(dds_entity_t writer, const std::string& bytes) {
    const Status status = DdsNode::Publish(writer, bytes);
    if (!status.ok()) node_.AddFault("messages that could not be written", status.message());
  }

  // Sleeps for a time [s] or until something comes in; false if the program ends.
  template <typename Condition>
  bool Sleep(double time_s, const Condition& wakes) {
    std::unique_lock<std::mutex> lock(mutex_);
    wake_up_.wait_for(lock, std::chrono::duration<double>(time_s),
                      [&] { return is_ending_ || wakes(); });
    return !is_ending_;
  }

  void Stop() {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_ending_ = true;
    wake_up_.notify_all();
  }

  // Maps scans as they come.
  void RunWorker() {
    std::vector<LiveUpdate> updates;
    do {
      node_.Work(SteadyTimeS(), &updates);
      for (const LiveUpdate& update : updates) {
        Publish(tf_,
                EncodeTransform(update.stamp_s + options_.transform_tolerance_s, options_.map_frame,
                                update.child_frame, update.map_from_child));
        Publish(pose_, EncodePose(update.stamp_s, options_.map_frame, update.map_from_base,
                                  kPoseSigmaM, kPoseSigmaRad));
      }
      updates.clear();
    } while (WaitForWork());
  }

  // After each time that the thread that reads has waited for messages.
  void WakeWorker() {
    const std::lock_guard<std::mutex> lock(mutex_);
    has_work_ = true;
    wake_up_.notify_all();
  }

  bool WaitForWork() {
    std::unique_lock<std::mutex> lock(mutex_);
    wake_up_.wait(lock, [this] { return is_ending_ || has_work_; });
    has_work_ = false;
    return !is_ending_;
  }

  // Writes the map whenever it has changed.
  void RunMapper() {
    std::string last;
    do {
      LiveMap map;
      if (!node_.BuildMap(&map).ok()) continue;
      std::string grid = EncodeGrid(map, options_.map_frame);
      if (grid != last) {
        Publish(map_, grid);
        Publish(path_, EncodePath(map, options_.map_frame));
        last = std::move(grid);
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      last_map_ = std::move(map);
      last_map_.grid = OccupancyGrid();
      last_map_.path.clear();
    } while (Sleep(options_.map_update_interval_s, [] { return false; }));
  }

  void RunCommander() {
    while (Sleep(kDiagnosticPeriodS, [this] { return !commands_.empty(); })) {
      Command command;
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (commands_.empty()) continue;
        command = std::move(commands_.front());
        commands_.pop_front();
      }
      std::string message = "done";
      const Status status = Execute(command, &message);
      Reply(command, status, message);
    }
  }

  Status Execute(const Command& command, std::string* message) {
    const std::string& name = command.service.name;
    if (name == "save_map") {
      MappedDrive drive;
      PLUMBLINE_RETURN_IF_ERROR(node_.MapNow(&drive));
      const int num_scans = drive.mapping.graph.num_scans();
      PLUMBLINE_RETURN_IF_ERROR(SaveLiveMap(options_.node.mapper.map, options_.node.resolution_m,
                                            command.request.text, std::move(drive)));
      *message =
          "saved the map of " + std::to_string(num_scans) + " scans in " + command.request.text;
    } else if (name == "localize") {
      SlamGraph map;
      PLUMBLINE_RETURN_IF_ERROR(ReadSavedMap(command.request.text, true, &map));
      *message = "localising in a map of " + std::to_string(map.num_scans()) + " scans";
      node_.UseMap(std::move(map));
    } else if (name == "clear") {
      node_.Clear();
      *message = "the next scan begins a new map";
    } else {
      node_.Pause(command.request.flag);
      *message = command.request.flag ? "paused" : "resumed";
    }
    return Status::Ok();
  }

  void Report() {
    for (const std::string& line : DdsNode::TakeWarnings()) {
      node_.AddFault("warnings of DDS", line);
    }
    for (const std::string& line : node_.TakeNews()) {
      std::cerr << "plumbline_live: " << line << std::endl;
    }
    const LiveReport report = node_.Report();
    Diagnostic diagnostic;
    diagnostic.name = "plumbline_live: map";
    diagnostic.message = report.state;
    const auto add = [&](const std::string& key, std::size_t value) {
      diagnostic.values.emplace_back(key, std::to_string(value));
    };
    add("scans received", report.num_received);
    add("scans mapped", report.num_mapped);
    add("scans at rest", report.num_resting);
    std::size_t num_faults = 0;
    for (const auto& [kind, count] : report.faults) {
      add(kind, count);
      num_faults += count;
    }
    if (num_faults > num_reported_faults_) diagnostic.level = DiagnosticLevel::kWarn;
    num_reported_faults_ = num_faults;
    AddAlarms(&diagnostic);
    Publish(diagnostics_,
            EncodeDiagnostic(options_.use_sim_time ? sim_time_s_ : SystemTimeS(), diagnostic));
  }

  void AddAlarms(Diagnostic* diagnostic) {
    const std::lock_guard<std::mutex> lock(mutex_);
    diagnostic->values.emplace_back("loop closures", std::to_string(last_map_.num_closures));
    for (const Alarm& alarm : last_map_.alarms) {
      diagnostic->level = DiagnosticLevel::kWarn;
      diagnostic->values.emplace_back("alarm", alarm.Text());
      if (told_alarms_.size() < 100 && told_alarms_.insert(alarm.reason).second) {
        std::cerr << "plumbline_live: " << alarm.Text() << std::endl;
      }
    }
  }

  const LiveProgramOptions options_;
  LiveNode node_;
  double sim_time_s_ = 0.0;              // of the thread that reads
  std::size_t num_reported_faults_ = 0;  // of the thread that reads
  std::set<std::string> told_alarms_;    // of the thread that reads
  dds_entity_t tf_ = 0, map_ = 0, path_ = 0, pose_ = 0, diagnostics_ = 0;
  std::map<std::string, dds_entity_t> replies_;  // writers, by service

  std::mutex mutex_;
  std::condition_variable wake_up_;
  bool is_ending_ = false;
  bool has_work_ = false;  // the worker has not looked since messages came
  std::deque<Command> commands_;
  LiveMap last_map_;  // without grid and path
  DdsNode dds_;       // last, so that it ends first
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
  PLUMBLINE_CHECK_NESTED_OPTIONS(node);
  PLUMBLINE_CHECK_OPTION_WITHIN(map_update_interval_s, 0.05, 3600.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(transform_tolerance_s, 0.0, 10.0);
  return true;
}

Status RunLive(const LiveProgramOptions& options, const std::function<bool()>& is_stopped) {
  return LiveProgram(options).Run(is_stopped);
}

}  // namespace plumbline
