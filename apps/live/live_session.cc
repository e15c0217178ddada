#include "plumbline/apps/live/live_session.h"

#include <chrono>
#include <utility>

#include "plumbline/apps/live/save_live_map.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {
namespace {

// How long the threads that map and that execute commands sleep at most [s].
constexpr double kWorkerSleepS = 0.02, kCommanderSleepS = 1.0;

constexpr std::size_t kMaxWaitingRequests = 16;

bool IsSameGrid(const OccupancyGrid& a, const OccupancyGrid& b) {
  return a.resolution_m == b.resolution_m && a.left_m == b.left_m && a.bottom_m == b.bottom_m &&
         a.width == b.width && a.height == b.height && a.cells == b.cells;
}

void Refuse(const std::string& reason, const LiveSession::Reply& reply) {
  reply(Status::Unavailable(reason), reason);
}

}  // namespace

bool LiveSessionOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(node);
  PLUMBLINE_CHECK_OPTION_WITHIN(map_update_interval_s, 0.05, 3600.0);
  return true;
}

LiveSession::LiveSession(const LiveSessionOptions& options, LiveOutputs outputs)
    : options_(options), outputs_(std::move(outputs)), node_(options.node) {}

LiveSession::~LiveSession() { Stop(); }

double LiveSession::NowS() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void LiveSession::Wake() {
  const std::lock_guard<std::mutex> lock(mutex_);
  has_work_ = true;
  wake_up_.notify_all();
}

Status LiveSession::UseSavedMap() {
  if (options_.map_file.empty()) return Status::Ok();
  SlamGraph map;
  PLUMBLINE_RETURN_IF_ERROR(ReadSavedMap(options_.map_file, options_.localize, &map));
  node_.UseMap(std::move(map));
  return Status::Ok();
}

void LiveSession::Start() {
  if (!threads_.empty()) return;
  is_running_ = true;
  threads_.emplace_back([this] { RunWorker(); });
  threads_.emplace_back([this] { RunMapper(); });
  threads_.emplace_back([this] { RunCommander(); });
}

void LiveSession::Stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_running_ = false;
    wake_up_.notify_all();
  }
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  for (const Request& request : std::exchange(requests_, {})) {
    Refuse("mapping has been stopped", request.reply);
  }
}

void LiveSession::Execute(LiveCommand command, Reply reply) {
  bool is_running = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_running = is_running_;
    if (is_running && requests_.size() < kMaxWaitingRequests) {
      requests_.push_back({std::move(command), std::move(reply)});
      return wake_up_.notify_all();
    }
  }
  Refuse(is_running ? "too many requests are waiting" : "mapping has not been started", reply);
}

// Sleeps for a time [s] or until the condition holds; false if the session ends.
template <typename Condition>
bool LiveSession::Sleep(double time_s, const Condition& wakes) {
  std::unique_lock<std::mutex> lock(mutex_);
  wake_up_.wait_for(lock, std::chrono::duration<double>(time_s),
                    [&] { return !is_running_ || wakes(); });
  return is_running_;
}

// Maps scans as they come.
void LiveSession::RunWorker() {
  std::vector<LiveUpdate> updates;
  do {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      has_work_ = false;
    }
    node_.Work(NowS(), &updates);
    for (const LiveUpdate& update : updates) outputs_.update(update);
    updates.clear();
  } while (Sleep(kWorkerSleepS, [this] { return has_work_; }));
}

// Gives the map whenever it has changed.
void LiveSession::RunMapper() {
  do {
    LiveMap map;
    if (!node_.BuildMap(&map).ok()) continue;
    // Only this thread writes last_map_.
    if (map.stamp_s != last_map_.stamp_s || !IsSameGrid(map.grid, last_map_.grid)) {
      outputs_.map(map);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    last_map_ = std::move(map);
  } while (Sleep(options_.map_update_interval_s, [] { return false; }));
}

void LiveSession::RunCommander() {
  while (Sleep(kCommanderSleepS, [this] { return !requests_.empty(); })) {
    Request request;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (requests_.empty()) continue;
      request = std::move(requests_.front());
      requests_.pop_front();
    }
    std::string message;
    const Status status = Execute(request.command, &message);
    request.reply(status, status.ok() ? message : status.message());
  }
}

Status LiveSession::Execute(const LiveCommand& command, std::string* message) {
  if (command.name == "save_map") return SaveMap(command.text, message);
  if (command.name == "localize") {
    SlamGraph map;
    PLUMBLINE_RETURN_IF_ERROR(ReadSavedMap(command.text, true, &map));
    *message = "localising in a map of " + std::to_string(map.num_scans()) + " scans";
    node_.UseMap(std::move(map));
  } else if (command.name == "clear") {
    node_.Clear();
    *message = "the next scan begins a new map";
  } else {
    node_.Pause(command.flag);
    *message = command.flag ? "paused" : "resumed";
  }
  return Status::Ok();
}

Status LiveSession::SaveMap(const std::string& folder, std::string* message) {
  MappedDrive drive;
  PLUMBLINE_RETURN_IF_ERROR(node_.MapNow(&drive));
  const int num_scans = drive.mapping.graph.num_scans();
  PLUMBLINE_RETURN_IF_ERROR(
      SaveLiveMap(options_.node.mapper.map, options_.node.resolution_m, folder, std::move(drive)));
  *message = "saved the map of " + std::to_string(num_scans) + " scans in " + folder;
  return Status::Ok();
}

void LiveSession::Report() {
  for (const std::string& line : node_.TakeNews()) outputs_.news(line);
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
  outputs_.diagnostic(diagnostic);
}

void LiveSession::AddAlarms(Diagnostic* diagnostic) {
  constexpr std::size_t kMaxTold = 100;
  const std::lock_guard<std::mutex> lock(mutex_);
  diagnostic->values.emplace_back("loop closures", std::to_string(last_map_.num_closures));
  for (const Alarm& alarm : last_map_.alarms) {
    diagnostic->level = DiagnosticLevel::kWarn;
    diagnostic->values.emplace_back("alarm", alarm.Text());
    if (told_alarms_.size() < kMaxTold && told_alarms_.insert(alarm.reason).second) {
      outputs_.news(alarm.Text());
    }
  }
}

}  // namespace plumbline
