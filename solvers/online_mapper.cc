#include "plumbline/solvers/online_mapper.h"

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/online/growing_map.h"
#include "plumbline/solvers/online/live_matching.h"
#include "plumbline/solvers/seeding/seed_drive.h"

namespace plumbline {
namespace {

// Odometry jumps if a step exceeds this length [m] plus this speed [m/s] times its duration: no
// indoor robot drives as fast.
constexpr double kMaxStepM = 5.0, kMaxSpeedMS = 20.0;

// The drive so far is seeded first with this many keyframes, some 10 m, then whenever their number
// has grown by a factor: all seedings together take five times as long as the last one.
constexpr int kMinSeededKeyframes = 40;
constexpr double kSeedingGrowth = 1.25;
// The factor where the map is in doubt: a loop has moved it by more than this [m], a scan matched
// nothing, or the last seeding has an alarm. At most eleven times as long.
constexpr double kDoubtfulCorrectionM = 0.5;
constexpr double kGrowthInDoubt = 1.1;

// The status of a graph of one scan, without the name of the refused measurement: the mapper counts
// scans by itself.
Status WithoutName(const Status& status) {
  if (status.ok()) return status;
  constexpr std::size_t kColon = 2;  // and a blank
  return Status::InvalidArgument(status.message().substr(status.message().find(": ") + kColon));
}

// A map of the drive so far.
struct DriveSeeding {
  SlamGraph log;
  SeededDrive drive;  // with the poses of the joint estimation
  SeedingReport report;
  std::vector<Alarm> alarms;
};

// A calibration would move the frame of the robot. The host names poses that may not be there yet,
// and expects its callback from Finish.
MapLogOptions OptionsWhileDriving(const MapLogOptions& options, const SeedingProgress& progress) {
  MapLogOptions driving = options;
  driving.calibration = CalibrationOptions();
  FactorOptions& factors = driving.solver.factors;
  factors.downweighted_steps.clear();
  factors.ignored_relative_poses.clear();
  driving.solver.callback = [progress](const IterationSummary&) {
    return progress(SeedingPhase::kClosingLoops, 0, 0);
  };
  return driving;
}

// The stages of MapLog.
Status SeedDriveSoFar(const MapLogOptions& given, const SeedingProgress& progress,
                      DriveSeeding* seeding) {
  const MapLogOptions options = OptionsWhileDriving(given, progress);
  ThreadPool pool(options.solver.num_threads);
  LogMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, std::move(seeding->log), &pool, &mapping));
  PLUMBLINE_RETURN_IF_ERROR(SeedDrive(options.seeding, options.solver.factors.motion,
                                      mapping.surface, progress, &pool, mapping.graph,
                                      &seeding->drive, &seeding->report));
  PLUMBLINE_RETURN_IF_ERROR(StartFromSeed(options, PoseArray(seeding->drive.world_from_robot),
                                          seeding->report, &mapping));
  PLUMBLINE_RETURN_IF_ERROR(RefineLog(options, &pool, &mapping));
  seeding->drive.world_from_robot = PosesOf(mapping.state.poses);
  seeding->alarms = std::move(mapping.report.alarms);
  return Status::Ok();
}

OdometryFaults FaultsOf(const SeedingReport& report) {
  OdometryFaults faults;
  faults.sign_lost = report.sequential.odometry_sign.sign_lost;
  const OdometryNoiseReport& noise = report.odometry_noise;
  const bool is_given_pose = noise.given_poses.position_m > 0.0;
  faults.translation_scale = is_given_pose ? 0.0 : noise.gross_translation_scale;
  return faults;
}

// Poses by the loops that the background has closed.
struct CorrectedPoses {
  std::vector<Pose2> map_from_robot;  // of the first scans
  Pose2 map_from_live;                // of the later ones
  int num_closures = 0;
};

struct KeySurface {
  int pose = 0;
  std::shared_ptr<const PackedSurface> points;
};

}  // namespace

bool OnlineMapperOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(map);
  return true;
}

class OnlineMapper::Impl {
 public:
  Impl(const std::vector<LaserModel>& lasers, const OnlineMapperOptions& options)
      : options_(options),
        lasers_(lasers),
        matching_(options.map.seeding, options.map.solver.factors.motion,
                  NormalOptionsFor(options.map.solver.factors.beam)),
        map_(std::make_unique<GrowingMap>(lasers, options.map.solver.factors.motion)) {}

  ~Impl() { StopThreads(); }

  Status AddScan(const LaserScan& scan, const std::optional<Pose2>& odometry, int laser,
                 OnlinePose* now) {
    const std::lock_guard<std::mutex> one_at_a_time(front_mutex_);
    LiveScan live;
    const Status good = TakeInput(scan, odometry, laser, &live);
    if (!good.ok()) {
      return Status::InvalidArgument("scan " + std::to_string(num_scans_) + ": " + good.message());
    }
    StartThreads();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      PLUMBLINE_RETURN_IF_ERROR(failure_);
      if (faults_) matching_.SetOdometryFaults(*std::exchange(faults_, std::nullopt));
    }
    matching_.Match(&live);
    last_initial_ = live.measured.InitialPose(0);
    last_time_s_ = scan.timestamp_s;
    last_odometry_ = odometry;
    if (odometry && !first_odometry_) first_odometry_ = odometry;
    Enqueue(std::move(live), odometry, now);
    ++num_scans_;
    return Status::Ok();
  }

  void GetMap(OnlineMap* map) const {
    OnlineMap result;
    std::vector<KeySurface> keys;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      result.map_from_robot = corrected_.map_from_robot;
      for (std::size_t i = result.map_from_robot.size(); i < live_poses_.size(); ++i) {
        result.map_from_robot.push_back(corrected_.map_from_live * live_poses_[i]);
      }
      result.map_from_odometry = corrected_.map_from_live * live_from_odometry_;
      result.num_closures = corrected_.num_closures;
      result.num_remappings = num_remappings_;
      result.alarms = alarms_;
      keys = key_surfaces_;
    }
    for (const KeySurface& key : keys) {
      const FrameChange map_from_robot(result.map_from_robot[key.pose]);
      for (std::size_t i = 0; i < key.points->size(); ++i) {
        result.points.push_back((map_from_robot * (*key.points)[i]).position);
      }
    }
    *map = std::move(result);
  }

  Status Wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return stop_ || !failure_.ok() || IsIdle(); });
    return failure_;
  }

  Status MapNow(LogMapping* mapping) const {
    SlamGraph log;
    {
      const std::lock_guard<std::mutex> log_lock(log_mutex_);
      PLUMBLINE_RETURN_IF_ERROR(MakeLog(&log));
    }
    return MapLog(options_.map, std::move(log), {}, mapping);
  }

  Status Finish(LogMapping* mapping) {
    const std::lock_guard<std::mutex> one_at_a_time(front_mutex_);
    if (num_scans_ > 0) StopThreads();
    SlamGraph log;
    {
      const std::lock_guard<std::mutex> log_lock(log_mutex_);
      PLUMBLINE_RETURN_IF_ERROR(MakeLog(&log));
      map_.reset();
      queue_.clear();
    }
    return MapLog(options_.map, std::move(log), {}, mapping);
  }

 private:
  // Checks a scan, and makes its measurements.
  Status TakeInput(const LaserScan& scan, const std::optional<Pose2>& odometry, int laser,
                   LiveScan* live) const {
    std::string error;
    if (!options_.Check(&error)) return Status::InvalidArgument(error);
    if (map_ == nullptr) return Status::InvalidArgument("the mapper has finished");
    if (laser < 0 || laser >= static_cast<int>(lasers_.size())) {
      return Status::InvalidArgument("laser " + std::to_string(laser) + " is unknown, there are " +
                                     std::to_string(lasers_.size()));
    }
    const Pose2 initial =
        odometry && first_odometry_ ? Between(*first_odometry_, *odometry) : last_initial_;
    SlamGraph* measured = &live->measured;
    const int laser_id = measured->AddLaser(lasers_[laser]);
    const int pose_id = measured->AddPose(initial, scan.timestamp_s);
    measured->AddScan(pose_id, laser_id, scan.ranges);
    PLUMBLINE_RETURN_IF_ERROR(WithoutName(measured->status()));
    // The frame of the odometry has the same bounds as that of the map.
    if (odometry) {
      SlamGraph bounds;
      bounds.AddPose(*odometry, scan.timestamp_s);
      PLUMBLINE_RETURN_IF_ERROR(WithoutName(bounds.status()));
    }
    if (num_scans_ == 0) return Status::Ok();
    const double duration_s = scan.timestamp_s - last_time_s_;
    if (duration_s < 0.0) {
      return Status::InvalidArgument("its time, " + std::to_string(scan.timestamp_s) +
                                     " s, is before that of the scan before it, " +
                                     std::to_string(last_time_s_) + " s");
    }
    if (!odometry || !last_odometry_) return Status::Ok();
    live->step = Between(*last_odometry_, *odometry);
    const double length_m = live->step->translation().norm();
    if (length_m <= kMaxStepM + kMaxSpeedMS * duration_s) return Status::Ok();
    return Status::InvalidArgument("the odometry jumps by " + std::to_string(length_m) + " m in " +
                                   std::to_string(duration_s) + " s");
  }

  void Enqueue(LiveScan scan, const std::optional<Pose2>& odometry, OnlinePose* now) {
    const std::lock_guard<std::mutex> lock(mutex_);
    live_poses_.push_back(scan.world_from_robot);
    if (odometry) live_from_odometry_ = scan.world_from_robot * odometry->Inverse();
    if (scan.keyframe) key_surfaces_.push_back({scan.keyframe->pose, scan.key_surface});
    queue_.push_back(std::move(scan));
    ++num_pending_;
    if (now != nullptr) {
      now->scan = num_scans_;
      now->map_from_robot = corrected_.map_from_live * live_poses_.back();
      now->map_from_odometry = corrected_.map_from_live * live_from_odometry_;
      now->num_pending = num_pending_;
    }
    changed_.notify_all();
  }

  void StartThreads() {
    if (!loops_.joinable()) loops_ = std::thread([this] { RunLoops(); });
    if (!seeder_.joinable()) seeder_ = std::thread([this] { RunSeeder(); });
  }

  void StopThreads() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
      changed_.notify_all();
    }
    for (std::thread* thread : {&loops_, &seeder_}) {
      if (thread->joinable()) thread->join();
    }
  }

  // Needs the mutex.
  bool IsIdle() const {
    return num_pending_ == 0 && !is_closing_ && !is_seeding_ && seeding_ == nullptr;
  }

  SeedingProgress UntilStopped() const {
    return [this](SeedingPhase, int, int) { return !stop_; };
  }

  // Needs the mutex of the log.
  Status MakeLog(SlamGraph* log) const {
    if (map_ == nullptr) return Status::InvalidArgument("the mapper has finished already");
    std::vector<LiveScan> queued;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      PLUMBLINE_RETURN_IF_ERROR(failure_);
      queued = queue_;
    }
    PLUMBLINE_RETURN_IF_ERROR(map_->MakeLog(queued, log));
    if (log->num_poses() == 0) return Status::InvalidArgument("the mapper has no scans");
    return Status::Ok();
  }

  void RunLoops() {
    const DefaultFloatEnvironment float_environment;
    while (true) {
      {
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, [this] {
          return stop_ || !queue_.empty() || (seeding_ != nullptr && !is_seeding_);
        });
        if (stop_) return;
      }
      const Status status = CatchExceptions([&] { return RunRound(); });
      if (status.ok()) continue;
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!stop_) failure_ = status;
      changed_.notify_all();
      return;
    }
  }

  Status RunRound() {
    if (pool_ == nullptr) pool_ = std::make_unique<ThreadPool>(options_.map.solver.num_threads);
    const int num_poses = map_->num_poses(), num_closures = map_->num_closures();
    std::unique_ptr<DriveSeeding> seeding;
    PLUMBLINE_RETURN_IF_ERROR(TakeQueue(&seeding));
    if (seeding != nullptr) {
      map_->Adopt(std::move(seeding->drive), seeding->report.odometry_noise.motion);
      seeding_has_alarm_ = seeding->report.alarm;
    }
    PLUMBLINE_RETURN_IF_ERROR(map_->CloseLoops(UntilStopped(), pool_.get()));
    const bool is_changed = seeding != nullptr || map_->num_closures() != num_closures;
    std::unique_ptr<DriveSeeding> next;
    PLUMBLINE_RETURN_IF_ERROR(WantSeeding(&next));
    Publish(map_->num_poses() - num_poses, is_changed, std::move(seeding), std::move(next));
    return Status::Ok();
  }

  // Moves the scans of the queue into the map. seeding: a finished one, or null.
  Status TakeQueue(std::unique_ptr<DriveSeeding>* seeding) {
    const std::lock_guard<std::mutex> log_lock(log_mutex_);
    std::vector<LiveScan> scans;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      scans.swap(queue_);
      if (!is_seeding_) *seeding = std::exchange(seeding_, nullptr);
      is_closing_ = true;
    }
    for (const LiveScan& scan : scans) PLUMBLINE_RETURN_IF_ERROR(map_->Add(scan));
    return Status::Ok();
  }

  // The log of the next seeding, if one is due and none is on its way.
  Status WantSeeding(std::unique_ptr<DriveSeeding>* next) {
    const int num_keyframes = map_->num_keyframes();
    const bool is_doubtful = seeding_has_alarm_ || map_->has_unmatched() ||
                             map_->largest_correction_m() > kDoubtfulCorrectionM;
    const double growth = is_doubtful ? kGrowthInDoubt : kSeedingGrowth;
    if (num_keyframes < kMinSeededKeyframes || num_keyframes < growth * num_seeded_keyframes_) {
      return Status::Ok();
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (is_seeding_ || seeding_ != nullptr) return Status::Ok();
    }
    num_seeded_keyframes_ = num_keyframes;
    *next = std::make_unique<DriveSeeding>();
    return map_->MakeLog({}, &(*next)->log);
  }

  void Publish(int num_scans, bool is_changed, std::unique_ptr<DriveSeeding> adopted,
               std::unique_ptr<DriveSeeding> next) {
    CorrectedPoses corrected;
    if (is_changed) corrected.map_from_robot = map_->Poses();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_changed) {
      corrected.map_from_live = corrected.map_from_robot.back() *
                                live_poses_[corrected.map_from_robot.size() - 1].Inverse();
      corrected.num_closures = map_->num_closures();
      corrected_ = std::move(corrected);
    }
    if (adopted != nullptr) {
      ++num_remappings_;
      alarms_ = std::move(adopted->alarms);
      faults_ = FaultsOf(adopted->report);
    }
    if (next != nullptr) {
      seeding_ = std::move(next);
      is_seeding_ = true;
    }
    num_pending_ -= num_scans;
    is_closing_ = false;
    changed_.notify_all();
  }

  void RunSeeder() {
    const DefaultFloatEnvironment float_environment;
    while (true) {
      DriveSeeding* seeding = nullptr;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, [this] { return stop_ || is_seeding_; });
        if (stop_) return;
        seeding = seeding_.get();
      }
      const Status status =
          CatchExceptions([&] { return SeedDriveSoFar(options_.map, UntilStopped(), seeding); });
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!status.ok()) {
        seeding_.reset();
        if (!stop_) failure_ = status;
      }
      is_seeding_ = false;
      changed_.notify_all();
    }
  }

  const OnlineMapperOptions options_;
  const std::vector<LaserModel> lasers_;

  // Of the thread that adds a scan.
  std::mutex front_mutex_;
  LiveMatching matching_;
  std::optional<Pose2> first_odometry_, last_odometry_;
  Pose2 last_initial_;
  double last_time_s_ = 0.0;
  int num_scans_ = 0;

  // Of the thread that closes loops, and of Finish after that. Others read its measurements.
  std::unique_ptr<GrowingMap> map_;  // null after Finish
  std::unique_ptr<ThreadPool> pool_;
  int num_seeded_keyframes_ = 0;
  bool seeding_has_alarm_ = false;

  // Guards the measurements: they move from the queue to the map. Is locked before mutex_.
  mutable std::mutex log_mutex_;

  // Of all threads.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> stop_{false};
  std::vector<LiveScan> queue_;
  int num_pending_ = 0;
  std::vector<Pose2> live_poses_;  // as matched
  Pose2 live_from_odometry_;
  std::vector<KeySurface> key_surfaces_;
  CorrectedPoses corrected_;
  std::vector<Alarm> alarms_;
  std::optional<OdometryFaults> faults_;  // news for the matching
  int num_remappings_ = 0;
  std::unique_ptr<DriveSeeding> seeding_;  // of the seeder while is_seeding_
  bool is_seeding_ = false;
  bool is_closing_ = false;  // the loops of what was taken from the queue
  Status failure_;

  std::thread loops_, seeder_;
};

OnlineMapper::OnlineMapper(const std::vector<LaserModel>& lasers,
                           const OnlineMapperOptions& options)
    : impl_(std::make_unique<Impl>(lasers, options)) {}
OnlineMapper::~OnlineMapper() = default;

Status OnlineMapper::AddScan(const LaserScan& scan, const std::optional<Pose2>& odometry,
                             OnlinePose* now, int laser) {
  const DefaultFloatEnvironment float_environment;
  return CatchExceptions([&] { return impl_->AddScan(scan, odometry, laser, now); });
}

Status OnlineMapper::GetMap(OnlineMap* map) const {
  if (map == nullptr) return Status::InvalidArgument("there is no map to fill: null");
  return CatchExceptions([&] {
    impl_->GetMap(map);
    return Status::Ok();
  });
}

Status OnlineMapper::Wait() { return impl_->Wait(); }

Status OnlineMapper::MapNow(LogMapping* mapping) const {
  if (mapping == nullptr) return Status::InvalidArgument("there is no mapping to fill: null");
  return CatchExceptions([&] { return impl_->MapNow(mapping); });
}

Status OnlineMapper::Finish(LogMapping* mapping) {
  if (mapping == nullptr) return Status::InvalidArgument("there is no mapping to fill: null");
  return CatchExceptions([&] { return impl_->Finish(mapping); });
}

}  // namespace plumbline
