#include "plumbline/solvers/online_mapper.h"

#include <algorithm>
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
#include "plumbline/solvers/drive_seeding.h"
#include "plumbline/solvers/map_sessions.h"
#include "plumbline/solvers/online/growing_map.h"
#include "plumbline/solvers/online/kept_scans.h"
#include "plumbline/solvers/online/live_input.h"
#include "plumbline/solvers/online/live_matching.h"
#include "plumbline/solvers/online/place_search.h"
#include "plumbline/solvers/online/saved_map.h"

namespace plumbline {
namespace {

// The drive so far is seeded first with this many keyframes, some 10 m, then whenever their number
// has grown by a factor: all seedings together take five times as long as the last one.
constexpr int kMinSeededKeyframes = 40;
constexpr double kSeedingGrowth = 1.25;
// The factor where the map is in doubt: a loop has moved it by more than this [m], a scan matched
// nothing, or the last seeding has an alarm. At most eleven times as long.
constexpr double kDoubtfulCorrectionM = 0.5;
constexpr double kGrowthInDoubt = 1.1;

// The place in a saved map is first sought after this path [m]: a drive shows three places then, as
// many as the search wants. Then each time that the path has grown by a factor, or by a length [m].
constexpr double kFirstSearchM = 10.0;
constexpr double kSearchGrowth = 1.25;
constexpr double kMaxSearchGrowthM = 25.0;

// Poses by the loops that the background has closed.
struct CorrectedPoses {
  std::vector<Pose2> map_from_robot;  // of the first scans
  Pose2 map_from_live;                // of the later ones
  bool is_in_map = true;
  int num_closures = 0;
};

// What takes a while: one of the two.
struct SlowJob {
  std::unique_ptr<DriveSeeding> seeding;
  std::unique_ptr<PlaceSearch> search;
};

Status CheckMap(const OnlineMapperOptions& options, const SavedMap* map) {
  const bool is_fixed = map != nullptr && IsFixedMap(map->graph);
  if (!options.keeps_scans && !is_fixed) {
    return Status::InvalidArgument("scans have to be kept, but for those of a fixed map's drive");
  }
  if (map == nullptr) return Status::Ok();
  PLUMBLINE_RETURN_IF_ERROR(map->graph.status());
  if (map->graph.peers() != nullptr) {
    return Status::InvalidArgument("the saved map is shared by several processes");
  }
  if (map->graph.num_scans() == 0) return Status::InvalidArgument("the saved map has no scan");
  if (map->graph.has_named_fixed_poses() && !is_fixed) {
    return Status::InvalidArgument("some poses of the saved map are fixed, and others are not");
  }
  if (!map->map_from_robot) return Status::Ok();
  SlamGraph bounds;
  bounds.AddPose(*map->map_from_robot, 0.0);
  if (bounds.status().ok()) return Status::Ok();
  return Status::InvalidArgument("map_from_robot of the saved map: " + bounds.status().message());
}

Status NothingToFill() { return Status::InvalidArgument("there is no mapping to fill: null"); }

struct KeySurface {
  int pose = 0;
  std::shared_ptr<const PackedSurface> points;
};

}  // namespace

bool OnlineMapperOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(map);
  PLUMBLINE_CHECK_OPTION_WITHIN(min_step_m, 0.0, 1.0);
  return true;
}

class OnlineMapper::Impl {
 public:
  Impl(const std::vector<LaserModel>& lasers, const OnlineMapperOptions& options,
       std::unique_ptr<const SavedMap> saved)
      : options_(options),
        saved_(std::move(saved)),
        matching_(options.map.seeding, options.map.solver.factors.motion,
                  NormalOptionsFor(options.map.solver.factors.beam)),
        input_(lasers),
        kept_(options.min_step_m),
        map_(std::make_unique<GrowingMap>(lasers, options.map.solver.factors.motion)) {
    corrected_.is_in_map = saved_ == nullptr;
  }

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
    input_.Accept(live, odometry);
    const bool is_kept = kept_.Keep(&live);
    Enqueue(std::move(live), is_kept, odometry, now);
    ++num_scans_;
    return Status::Ok();
  }

  void GetMap(OnlineMap* map) const {
    OnlineMap result;
    std::vector<KeySurface> keys;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      result.map_from_robot = CorrectedLivePoses();
      result.is_in_map = corrected_.is_in_map;
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
    PLUMBLINE_RETURN_IF_ERROR(CopyLog(&log));
    return MapLog(options_.map, std::move(log), {}, mapping);
  }

  Status MapNow(SessionsMapping* mapping) const {
    PLUMBLINE_RETURN_IF_ERROR(WantSavedMap());
    SlamGraph log;
    PLUMBLINE_RETURN_IF_ERROR(CopyLog(&log));
    return MapSessions(options_.map, {saved_->graph, std::move(log)}, {}, mapping);
  }

  Status Finish(LogMapping* mapping) {
    SlamGraph log;
    PLUMBLINE_RETURN_IF_ERROR(TakeLog(&log));
    return MapLog(options_.map, std::move(log), {}, mapping);
  }

  Status Finish(SessionsMapping* mapping) {
    PLUMBLINE_RETURN_IF_ERROR(WantSavedMap());
    SlamGraph log;
    PLUMBLINE_RETURN_IF_ERROR(TakeLog(&log));
    return MapSessions(options_.map, {saved_->graph, std::move(log)}, {}, mapping);
  }

 private:
  Status TakeInput(const LaserScan& scan, const std::optional<Pose2>& odometry, int laser,
                   LiveScan* live) const {
    std::string error;
    if (!options_.Check(&error)) return Status::InvalidArgument(error);
    if (map_ == nullptr) return Status::InvalidArgument("the mapper has finished");
    PLUMBLINE_RETURN_IF_ERROR(CheckMap(options_, saved_.get()));
    return input_.Take(scan, odometry, laser, live);
  }

  void Enqueue(LiveScan scan, bool is_kept, const std::optional<Pose2>& odometry, OnlinePose* now) {
    const std::lock_guard<std::mutex> lock(mutex_);
    live_poses_.push_back(scan.world_from_robot);
    if (odometry) live_from_odometry_ = scan.world_from_robot * odometry->Inverse();
    if (scan.keyframe) key_surfaces_.push_back({scan.keyframe->pose, scan.key_surface});
    const bool is_in_map = saved_ == nullptr || (corrected_.is_in_map && scan.is_matched);
    if (is_kept) {
      kept_scans_.push_back(num_scans_);
      queue_.push_back(std::move(scan));
      ++num_pending_;
    }
    if (now != nullptr) {
      now->scan = num_scans_;
      now->is_in_map = is_in_map;
      now->map_from_robot = corrected_.map_from_live * live_poses_.back();
      now->map_from_odometry = corrected_.map_from_live * live_from_odometry_;
      now->num_pending = num_pending_;
    }
    changed_.notify_all();
  }

  // Of all scans. A scan that is not kept follows the kept one before it. Needs the mutex.
  std::vector<Pose2> CorrectedLivePoses() const {
    const std::vector<Pose2>& corrected = corrected_.map_from_robot;
    std::vector<Pose2> poses(live_poses_.size());
    std::size_t next = 0;  // after the kept scan
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (next < kept_scans_.size() && kept_scans_[next] == static_cast<int>(i)) ++next;
      if (next > corrected.size()) {
        poses[i] = corrected_.map_from_live * live_poses_[i];
      } else {
        const int kept = kept_scans_[next - 1];
        poses[i] = corrected[next - 1];
        if (kept != static_cast<int>(i)) {
          poses[i] = poses[i] * Between(live_poses_[kept], live_poses_[i]);
        }
      }
    }
    return poses;
  }

  void StartThreads() {
    if (!loops_.joinable()) loops_ = std::thread([this] { RunLoops(); });
    if (!slow_.joinable()) slow_ = std::thread([this] { RunSlowJobs(); });
  }

  void StopThreads() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
      changed_.notify_all();
    }
    for (std::thread* thread : {&loops_, &slow_}) {
      if (thread->joinable()) thread->join();
    }
  }

  // Needs the mutex.
  bool IsIdle() const {
    return num_pending_ == 0 && !is_closing_ && !is_job_running_ && job_ == nullptr;
  }

  SeedingProgress UntilStopped() const {
    return [this](SeedingPhase, int, int) { return !stop_; };
  }

  Status WantSavedMap() const {
    if (saved_ != nullptr) return Status::Ok();
    return Status::InvalidArgument("the drive has no saved map");
  }

  Status CopyLog(SlamGraph* log) const {
    const std::lock_guard<std::mutex> log_lock(log_mutex_);
    return MakeLog(log);
  }

  // Ends the drive.
  Status TakeLog(SlamGraph* log) {
    const std::lock_guard<std::mutex> one_at_a_time(front_mutex_);
    if (num_scans_ > 0) StopThreads();
    const std::lock_guard<std::mutex> log_lock(log_mutex_);
    PLUMBLINE_RETURN_IF_ERROR(MakeLog(log));
    map_.reset();
    queue_.clear();
    return Status::Ok();
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
          return stop_ || !queue_.empty() || (job_ != nullptr && !is_job_running_);
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
    if (pool_ == nullptr) PLUMBLINE_RETURN_IF_ERROR(StartBackground());
    const int num_poses = map_->num_poses(), num_closures = map_->num_closures();
    const bool was_placed = map_->is_placed();
    std::unique_ptr<SlowJob> done;
    PLUMBLINE_RETURN_IF_ERROR(TakeQueue(&done));
    const bool is_adopted = done != nullptr && Adopt(done.get());
    if (given_place_ && map_->PlaceAt(*given_place_)) given_place_.reset();
    PLUMBLINE_RETURN_IF_ERROR(map_->CloseLoops(UntilStopped(), pool_.get()));
    const bool is_changed =
        is_adopted || map_->num_closures() != num_closures || map_->is_placed() != was_placed;
    std::unique_ptr<SlowJob> next;
    PLUMBLINE_RETURN_IF_ERROR(WantJob(&next));
    Publish(map_->num_poses() - num_poses, is_changed, std::move(done), std::move(next));
    return Status::Ok();
  }

  Status StartBackground() {
    auto pool = std::make_unique<ThreadPool>(options_.map.solver.num_threads);
    if (saved_ != nullptr) {
      auto session = std::make_shared<SavedSession>();
      PLUMBLINE_RETURN_IF_ERROR(MakeSavedSession(saved_->graph, options_.map.seeding,
                                                 NormalOptionsFor(options_.map.solver.factors.beam),
                                                 pool.get(), session.get()));
      given_place_ = saved_->map_from_robot;
      const std::lock_guard<std::mutex> log_lock(log_mutex_);
      map_->StartIn({std::move(session), IsFixedMap(saved_->graph), options_.keeps_scans});
    }
    pool_ = std::move(pool);
    return Status::Ok();
  }

  // Moves the scans of the queue into the map. done: a finished job, or null.
  Status TakeQueue(std::unique_ptr<SlowJob>* done) {
    const std::lock_guard<std::mutex> log_lock(log_mutex_);
    std::vector<LiveScan> scans;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      scans.swap(queue_);
      if (!is_job_running_) *done = std::exchange(job_, nullptr);
      is_closing_ = true;
    }
    for (const LiveScan& scan : scans) PLUMBLINE_RETURN_IF_ERROR(map_->Add(scan));
    return Status::Ok();
  }

  // Takes over what a job has found. Whether poses have changed.
  bool Adopt(SlowJob* done) {
    if (done->search != nullptr) {
      return done->search->outcome == TieOutcome::kTied && map_->Place(*done->search);
    }
    seeding_has_alarm_ = done->seeding->report.alarm || !done->seeding->is_better;
    if (saved_ != nullptr || !done->seeding->is_better) return false;
    map_->Adopt(std::move(done->seeding->drive), done->seeding->report.odometry_noise.motion);
    return true;
  }

  // The next job, if one is due and none is on its way.
  Status WantJob(std::unique_ptr<SlowJob>* next) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (is_job_running_ || job_ != nullptr) return Status::Ok();
    }
    auto job = std::make_unique<SlowJob>();
    if (IsSearchDue()) {
      job->search = std::make_unique<PlaceSearch>();
      PLUMBLINE_RETURN_IF_ERROR(map_->MakeSearch(job->search.get()));
      searched_segment_ = map_->first_pose_of_segment();
      searched_m_ = map_->segment_path_m();
    } else if (IsSeedingDue()) {
      num_seeded_keyframes_ = map_->num_keyframes();
      job->seeding = std::make_unique<DriveSeeding>();
      job->seeding->poses_at_hand = map_->Poses();
      PLUMBLINE_RETURN_IF_ERROR(map_->MakeLog({}, &job->seeding->log));
    } else {
      return Status::Ok();
    }
    *next = std::move(job);
    return Status::Ok();
  }

  bool IsSearchDue() const {
    if (saved_ == nullptr || map_->is_placed() || given_place_) return false;
    double due_m = kFirstSearchM;
    if (map_->first_pose_of_segment() == searched_segment_ && searched_m_ > 0.0) {
      due_m = std::min(kSearchGrowth * searched_m_, searched_m_ + kMaxSearchGrowthM);
    }
    return map_->segment_path_m() >= due_m;
  }

  bool IsSeedingDue() const {
    if (saved_ != nullptr && IsFixedMap(saved_->graph)) return false;
    const int num_keyframes = map_->num_keyframes();
    const bool is_doubtful = seeding_has_alarm_ || map_->has_unmatched() ||
                             map_->largest_correction_m() > kDoubtfulCorrectionM;
    const double growth = is_doubtful ? kGrowthInDoubt : kSeedingGrowth;
    return num_keyframes >= kMinSeededKeyframes && num_keyframes >= growth * num_seeded_keyframes_;
  }

  void Publish(int num_scans, bool is_changed, std::unique_ptr<SlowJob> done,
               std::unique_ptr<SlowJob> next) {
    CorrectedPoses corrected;
    if (is_changed) corrected.map_from_robot = map_->Poses();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_changed) {
      corrected.map_from_live =
          corrected.map_from_robot.back() *
          live_poses_[kept_scans_[corrected.map_from_robot.size() - 1]].Inverse();
      corrected.is_in_map = saved_ == nullptr || map_->is_placed();
      corrected.num_closures = map_->num_closures();
      corrected_ = std::move(corrected);
    }
    if (done != nullptr && done->seeding != nullptr) {
      ++num_remappings_;
      alarms_ = std::move(done->seeding->alarms);
      if (done->seeding->is_better) faults_ = FaultsOf(done->seeding->report);
    }
    if (next != nullptr) {
      job_ = std::move(next);
      is_job_running_ = true;
    }
    num_pending_ -= num_scans;
    is_closing_ = false;
    changed_.notify_all();
  }

  void RunSlowJobs() {
    const DefaultFloatEnvironment float_environment;
    while (true) {
      SlowJob* job = nullptr;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, [this] { return stop_ || is_job_running_; });
        if (stop_) return;
        job = job_.get();
      }
      const Status status = CatchExceptions([&] { return RunJob(job); });
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!status.ok()) {
        job_.reset();
        if (!stop_) failure_ = status;
      }
      is_job_running_ = false;
      changed_.notify_all();
    }
  }

  Status RunJob(SlowJob* job) const {
    if (job->seeding != nullptr) {
      return SeedDriveSoFar(options_.map, UntilStopped(), job->seeding.get());
    }
    ThreadPool pool(options_.map.solver.num_threads);
    return SeekPlace(UntilStopped(), &pool, job->search.get());
  }

  const OnlineMapperOptions options_;
  const std::unique_ptr<const SavedMap> saved_;  // null without one

  // Of the thread that adds a scan.
  std::mutex front_mutex_;
  LiveMatching matching_;
  LiveInput input_;
  KeptScans kept_;
  int num_scans_ = 0;

  // Of the thread that closes loops, and of Finish after that. Others read its measurements.
  std::unique_ptr<GrowingMap> map_;  // null after Finish
  std::unique_ptr<ThreadPool> pool_;
  int num_seeded_keyframes_ = 0;
  bool seeding_has_alarm_ = false;
  std::optional<Pose2> given_place_;  // until the drive is there
  int searched_segment_ = 0;          // its first pose
  double searched_m_ = 0.0;           // its path at the last search

  // Guards the measurements: they move from the queue to the map. Is locked before mutex_.
  mutable std::mutex log_mutex_;

  // Of all threads.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> stop_{false};
  std::vector<LiveScan> queue_;
  int num_pending_ = 0;
  std::vector<Pose2> live_poses_;  // as matched
  std::vector<int> kept_scans_;    // those that are poses of the map
  Pose2 live_from_odometry_;
  std::vector<KeySurface> key_surfaces_;
  CorrectedPoses corrected_;
  std::vector<Alarm> alarms_;
  std::optional<OdometryFaults> faults_;  // news for the matching
  int num_remappings_ = 0;
  std::unique_ptr<SlowJob> job_;  // of the slow thread while is_job_running_
  bool is_job_running_ = false;
  bool is_closing_ = false;  // the loops of what was taken from the queue
  Status failure_;

  std::thread loops_, slow_;
};

OnlineMapper::OnlineMapper(const std::vector<LaserModel>& lasers,
                           const OnlineMapperOptions& options)
    : impl_(std::make_unique<Impl>(lasers, options, nullptr)) {}
OnlineMapper::OnlineMapper(const std::vector<LaserModel>& lasers,
                           const OnlineMapperOptions& options, SavedMap map)
    : impl_(std::make_unique<Impl>(lasers, options,
                                   std::make_unique<const SavedMap>(std::move(map)))) {}
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
  if (mapping == nullptr) return NothingToFill();
  return CatchExceptions([&] { return impl_->MapNow(mapping); });
}

Status OnlineMapper::MapNow(SessionsMapping* mapping) const {
  if (mapping == nullptr) return NothingToFill();
  return CatchExceptions([&] { return impl_->MapNow(mapping); });
}

Status OnlineMapper::Finish(LogMapping* mapping) {
  if (mapping == nullptr) return NothingToFill();
  return CatchExceptions([&] { return impl_->Finish(mapping); });
}

Status OnlineMapper::Finish(SessionsMapping* mapping) {
  if (mapping == nullptr) return NothingToFill();
  return CatchExceptions([&] { return impl_->Finish(mapping); });
}

}  // namespace plumbline
