#include "plumbline/apps/live/live_node.h"

#include <mutex>
#include <optional>
#include <utility>

#include "plumbline/apps/io/ros_mounting.h"
#include "plumbline/apps/live/fault_log.h"
#include "plumbline/apps/live/live_frames.h"
#include "plumbline/apps/live/live_scan.h"
#include "plumbline/apps/live/scan_inbox.h"
#include "plumbline/core/options_check.h"
#include "plumbline/solvers/map_sessions.h"

namespace plumbline {
namespace {

// How long scans wait for transforms and odometry: the first one, and any other [s].
constexpr double kStartWaitS = 3.0, kOdometryWaitS = 0.2;
// While the robot stands still, one scan is mapped in this time [s].
constexpr double kRestPeriodS = 1.0;

// A map that grows, and the laser that it is made with.
struct LiveDrive {
  LiveDrive(const LaserModel& laser_in, OnlineMapperOptions options, const SlamGraph* saved_map)
      : laser(laser_in),
        has_map(saved_map != nullptr),
        is_localised(has_map && saved_map->has_named_fixed_poses()),
        builder(laser_in, saved_map) {
    options.keeps_scans = !is_localised;
    if (has_map) {
      mapper = std::make_unique<OnlineMapper>(std::vector<LaserModel>{laser}, options,
                                              SavedMap{*saved_map, std::nullopt});
    } else {
      mapper = std::make_unique<OnlineMapper>(std::vector<LaserModel>{laser}, options);
    }
  }

  const LaserModel laser;
  const bool has_map, is_localised;  // in a saved map
  std::unique_ptr<OnlineMapper> mapper;
  LiveMapBuilder builder;
  std::string laser_frame, robot_frame;
  LaserPlace place;
  bool place_is_known = false;
  bool expects_odometry = false;
  bool was_in_map = false;  // the place in the saved map has been known
  std::size_t num_mapped = 0;
  // Of Work alone.
  std::optional<Pose2> last_odometry;  // of the last scan that was mapped
  double last_time_s = 0.0;            // of that scan
  OnlinePose last;
};

// A scan with all that is known of its place.
struct ReadyScan {
  WaitingScan waiting;
  std::optional<Pose2> odom_from_robot;
  Pose2 robot_from_base;
  std::shared_ptr<LiveDrive> drive;
};

enum class Readiness { kWaits, kIsOfNoUse, kIsReady };

}  // namespace

bool LiveOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(resolution_m, 0.001, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(min_interval_s, 0.0, 60.0);
  PLUMBLINE_CHECK_NESTED_OPTIONS(mapper);
  for (const std::string& frame : {odom_frame, base_frame}) {
    if (!frame.empty()) continue;
    if (error != nullptr) *error = "the name of a frame is empty";
    return false;
  }
  return true;
}

class LiveNode::Impl {
 public:
  explicit Impl(const LiveOptions& options)
      : options_(options),
        inbox_(options.min_interval_s),
        frames_(options.odom_frame, options.odometry_by_messages) {}

  void AddScan(RosScan scan, double now_s) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++num_received_;
    if (is_paused_) return;
    scan.frame = WithoutLeadingSlash(scan.frame);
    if (inbox_.Add(std::move(scan), now_s, &faults_)) frames_.ForgetOdometry();
  }

  void AddOdometry(const RosOdometry& odometry) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Status status = frames_.AddOdometry(odometry);
    if (!status.ok()) faults_.Add("odometry of no use", status.message());
  }

  void AddTransforms(const std::vector<RosTransform>& transforms) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const RosTransform& transform : transforms) {
      const Status status = frames_.AddTransform(transform);
      if (status.ok()) continue;
      faults_.Add("transforms of no use", "from '" + transform.frame + "' to '" +
                                              transform.child_frame + "': " + status.message());
    }
  }

  void AddFault(const std::string& kind, const std::string& detail) {
    const std::lock_guard<std::mutex> lock(mutex_);
    faults_.Add(kind, detail);
  }

  void Work(double now_s, std::vector<LiveUpdate>* updates) {
    const std::lock_guard<std::mutex> one_at_a_time(work_mutex_);
    ReadyScan ready;
    while (TakeReady(now_s, &ready)) Map(ready, updates);
  }

  Status BuildMap(LiveMap* map) {
    const std::shared_ptr<LiveDrive> drive = Drive();
    if (drive == nullptr) return Status::InvalidArgument("there are no scans yet");
    return drive->builder.Build(*drive->mapper, options_.resolution_m, map);
  }

  Status MapNow(MappedDrive* mapped) {
    const std::shared_ptr<LiveDrive> drive = Drive();
    if (drive == nullptr) return Status::InvalidArgument("there are no scans yet");
    if (drive->is_localised) {
      return Status::InvalidArgument("the drive is localised in a saved map, which stays as it is");
    }
    MappedDrive result;
    if (!drive->has_map) {
      PLUMBLINE_RETURN_IF_ERROR(drive->mapper->MapNow(&result.mapping));
    } else {
      PLUMBLINE_RETURN_IF_ERROR(MapWithSavedMap(*drive->mapper, &result));
    }
    *mapped = std::move(result);
    return Status::Ok();
  }

  // map: null for a new one.
  void BeginAnew(std::shared_ptr<const SlamGraph> map) {
    const std::lock_guard<std::mutex> one_at_a_time(work_mutex_);
    std::shared_ptr<LiveDrive> old;  // ends without the lock: its background stops first
    const std::lock_guard<std::mutex> lock(mutex_);
    old.swap(drive_);
    saved_map_ = std::move(map);
    inbox_.Drop();
  }

  void Pause(bool paused) {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_paused_ = paused;
    if (paused) inbox_.Drop();
  }

  LiveReport Report() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    LiveReport report;
    report.state = is_paused_           ? "paused"
                   : drive_ != nullptr  ? StateOf(*drive_)
                   : num_received_ == 0 ? "waiting for scans"
                                        : "waiting for transforms and odometry";
    report.num_received = num_received_;
    report.num_mapped = drive_ == nullptr ? 0 : drive_->num_mapped;
    report.num_resting = num_resting_;
    report.faults = faults_.counts();
    return report;
  }

  std::vector<std::string> TakeNews() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return faults_.TakeNews();
  }

 private:
  static const char* StateOf(const LiveDrive& drive) {
    if (!drive.was_in_map) return "looking for its place in the saved map";
    return drive.is_localised ? "localising" : "mapping";
  }

  std::shared_ptr<LiveDrive> Drive() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return drive_;
  }

  // The map of the drive, which is the last of two sessions.
  Status MapWithSavedMap(const OnlineMapper& mapper, MappedDrive* result) {
    SessionsMapping sessions;
    PLUMBLINE_RETURN_IF_ERROR(mapper.MapNow(&sessions));
    result->continues_map = sessions.maps.size() == 1;
    if (!result->continues_map) {
      AddFault("maps without the saved one", "the drive could not be tied to it");
    }
    result->mapping = std::move(sessions.maps.back().mapping);
    return Status::Ok();
  }

  // Takes the oldest waiting scan, if all is known that it waits for.
  bool TakeReady(double now_s, ReadyScan* ready) {
    const std::lock_guard<std::mutex> lock(mutex_);
    while (!inbox_.empty()) {
      const Readiness readiness = Prepare(now_s, ready);
      if (readiness == Readiness::kWaits) return false;
      ready->waiting = inbox_.Take();
      if (readiness == Readiness::kIsReady) return true;
    }
    return false;
  }

  Readiness Prepare(double now_s, ReadyScan* ready) {
    const WaitingScan& waiting = inbox_.front();
    const double waited_s = now_s - waiting.arrival_s;
    if (drive_ == nullptr) {
      const Readiness begun = Begin(waiting.scan, waited_s >= kStartWaitS);
      if (begun != Readiness::kIsReady) return begun;
    }
    if (!IsOfThisLaser(waiting.scan)) return Readiness::kIsOfNoUse;
    ready->odom_from_robot.reset();
    const OdometryAtTime at = frames_.OdometryAt(drive_->robot_frame, waiting.scan.stamp_s);
    if (at.state == OdometryAtTime::State::kKnown) {
      ready->odom_from_robot = at.odom_from_robot;
      drive_->expects_odometry = true;
    } else if (drive_->expects_odometry) {
      const bool may_come = at.state == OdometryAtTime::State::kTooEarly &&
                            frames_.num_odometry_poses() != num_poses_when_lost_;
      if (may_come && waited_s < kOdometryWaitS) return Readiness::kWaits;
      if (may_come) num_poses_when_lost_ = frames_.num_odometry_poses();
      faults_.Add("scans without odometry of their time",
                  "the first one at " + std::to_string(waiting.scan.stamp_s) + " s");
    }
    ready->robot_from_base =
        frames_.Find(drive_->robot_frame, options_.base_frame).value_or(Pose2());
    ready->drive = drive_;
    return Readiness::kIsReady;
  }

  // Begins a map with its first scan. may_wait_no_longer: for transforms and odometry.
  Readiness Begin(const RosScan& scan, bool may_wait_no_longer) {
    std::string robot_frame = frames_.RobotFrame(scan.frame);
    const bool has_odometry = !robot_frame.empty();
    if (!has_odometry) {
      if (!may_wait_no_longer) return Readiness::kWaits;
      const bool has_base = frames_.Find(options_.base_frame, scan.frame).has_value();
      robot_frame = has_base ? options_.base_frame : scan.frame;
    }
    const LaserPlaces places = frames_.PlaceOfLaser(robot_frame, scan.frame);
    if (!places.is_known && !may_wait_no_longer) return Readiness::kWaits;
    if (places.is_known && !places.faults.front().empty()) {
      faults_.Add(places.kinds.front(), places.faults.front());
      return Readiness::kIsOfNoUse;
    }
    if (!has_odometry) {
      faults_.Add("no odometry", "no transform joins '" + scan.frame + "' with '" +
                                     frames_.odom_frame() + "'; the scans alone tell the motion");
    }
    if (!places.is_known) {
      faults_.Add("no transform to the laser",
                  "from '" + robot_frame + "' to '" + scan.frame +
                      "': the laser is taken to sit at the robot's centre");
    }
    drive_ =
        std::make_shared<LiveDrive>(LaserOf(scan, places.place), options_.mapper, saved_map_.get());
    drive_->laser_frame = scan.frame;
    drive_->robot_frame = robot_frame;
    drive_->place = places.place;
    drive_->place_is_known = places.is_known;
    drive_->expects_odometry = has_odometry;
    return Readiness::kIsReady;
  }

  bool IsOfThisLaser(const RosScan& scan) {
    if (scan.frame != drive_->laser_frame) {
      faults_.Add("scans of another frame",
                  "'" + scan.frame + "' instead of '" + drive_->laser_frame + "'");
      return false;
    }
    const LaserPlaces places = frames_.PlaceOfLaser(drive_->robot_frame, scan.frame);
    if (!places.is_known) return true;
    if (!places.faults.front().empty()) {
      faults_.Add(places.kinds.front(), places.faults.front());
      return false;
    }
    if (drive_->place.IsNear(places.place)) return true;
    faults_.Add("scans of a laser that has moved on the robot",
                drive_->place_is_known ? "they are left out"
                                       : "its transform came late; clear the map to use it");
    return !drive_->place_is_known;
  }

  // Whether the odometry says that the robot has stood still since the last scan.
  static bool IsResting(const ReadyScan& ready) {
    const LiveDrive& drive = *ready.drive;
    return drive.last_odometry && ready.odom_from_robot && !ready.waiting.after_jump &&
           ready.waiting.drive_time_s < drive.last_time_s + kRestPeriodS &&
           AreAtRest(*drive.last_odometry, *ready.odom_from_robot);
  }

  void Map(const ReadyScan& ready, std::vector<LiveUpdate>* updates) {
    if (IsResting(ready)) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        ++num_resting_;
      }
      return Update(ready, ready.drive->last.map_from_odometry * *ready.odom_from_robot, updates);
    }
    const WaitingScan& waiting = ready.waiting;
    LiveDrive* drive = ready.drive.get();
    bool is_resampled = false;
    const LaserScan scan{waiting.drive_time_s,
                         RangesFor(drive->laser, drive->place, waiting.scan, &is_resampled)};
    if (is_resampled) {
      AddFault("scans with other beams than the first one",
               scan.ranges.empty() ? "they look another way and are left out"
                                   : "they are resampled to its beams");
    }
    if (scan.ranges.empty() || !AddToMapper(ready, scan)) return;
    drive->last_odometry = ready.odom_from_robot;
    drive->last_time_s = scan.timestamp_s;
    if (ready.odom_from_robot) {
      drive->last.map_from_odometry = drive->last.map_from_robot * ready.odom_from_robot->Inverse();
    }
    drive->builder.Add(drive->last.scan, waiting.scan.stamp_s, scan, drive->last.map_from_robot);
    if (options_.wait_for_background) {
      const Status status = drive->mapper->Wait();
      if (!status.ok()) AddFault("failures of the background", status.message());
    }
    Update(ready, drive->last.map_from_robot, updates);
  }

  bool AddToMapper(const ReadyScan& ready, const LaserScan& scan) {
    LiveDrive* drive = ready.drive.get();
    std::optional<Pose2> odometry = ready.odom_from_robot;
    if (ready.waiting.after_jump) odometry.reset();
    Status status = drive->mapper->AddScan(scan, odometry, &drive->last);
    if (status.code() == StatusCode::kInvalidArgument && odometry) {
      AddFault("scans whose odometry is of no use", status.message());
      status = drive->mapper->AddScan(scan, std::nullopt, &drive->last);
    }
    if (!status.ok()) {
      AddFault("scans that could not be mapped", status.message());
      return false;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    ++drive->num_mapped;
    if (drive->was_in_map && !drive->last.is_in_map) {
      faults_.Add("scans whose place in the saved map is lost", "it is sought anew");
    }
    drive->was_in_map = drive->was_in_map || drive->last.is_in_map;
    return true;
  }

  void Update(const ReadyScan& ready, const Pose2& map_from_robot,
              std::vector<LiveUpdate>* updates) const {
    if (!ready.drive->was_in_map) return;
    LiveUpdate update;
    update.stamp_s = ready.waiting.scan.stamp_s;
    update.map_from_base = map_from_robot * ready.robot_from_base;
    if (ready.odom_from_robot) {
      const std::lock_guard<std::mutex> lock(mutex_);
      update.child_frame = frames_.odom_frame();
      update.map_from_child = map_from_robot * ready.odom_from_robot->Inverse();
    } else {
      update.child_frame = ready.drive->robot_frame;
      update.map_from_child = map_from_robot;
    }
    updates->push_back(update);
  }

  const LiveOptions options_;
  std::mutex work_mutex_;  // taken before mutex_

  mutable std::mutex mutex_;
  ScanInbox inbox_;
  LiveFrames frames_;
  FaultLog faults_;
  bool is_paused_ = false;
  std::size_t num_received_ = 0, num_resting_ = 0;
  // num_odometry_poses() when a scan waited for odometry in vain: later ones do not wait for more
  // of it until there is some.
  std::size_t num_poses_when_lost_ = static_cast<std::size_t>(-1);
  std::shared_ptr<const SlamGraph> saved_map_;  // in which the next drive begins; may be null
  std::shared_ptr<LiveDrive> drive_;            // null before the first scan
};

LiveNode::LiveNode(const LiveOptions& options) : impl_(std::make_unique<Impl>(options)) {}
LiveNode::~LiveNode() = default;

void LiveNode::AddScan(RosScan scan, double now_s) { impl_->AddScan(std::move(scan), now_s); }
void LiveNode::AddOdometry(const RosOdometry& odometry) { impl_->AddOdometry(odometry); }
void LiveNode::AddTransforms(const std::vector<RosTransform>& transforms) {
  impl_->AddTransforms(transforms);
}
void LiveNode::AddFault(const std::string& kind, const std::string& detail) {
  impl_->AddFault(kind, detail);
}
void LiveNode::Work(double now_s, std::vector<LiveUpdate>* updates) { impl_->Work(now_s, updates); }
Status LiveNode::BuildMap(LiveMap* map) { return impl_->BuildMap(map); }
Status LiveNode::MapNow(MappedDrive* drive) { return impl_->MapNow(drive); }
void LiveNode::Clear() { impl_->BeginAnew(nullptr); }
void LiveNode::UseMap(SlamGraph map) {
  impl_->BeginAnew(std::make_shared<const SlamGraph>(std::move(map)));
}
void LiveNode::Pause(bool paused) { impl_->Pause(paused); }
LiveReport LiveNode::Report() const { return impl_->Report(); }
std::vector<std::string> LiveNode::TakeNews() { return impl_->TakeNews(); }

}  // namespace plumbline
