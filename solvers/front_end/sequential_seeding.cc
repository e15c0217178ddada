#include "plumbline/solvers/front_end/sequential_seeding.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <thread>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/front_end/given_poses.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/odometry_sign.h"
#include "plumbline/solvers/front_end/odometry_span.h"
#include "plumbline/solvers/front_end/sequential_matcher.h"

namespace plumbline {
namespace {

// Stretches of a long drive are matched side by side. They depend on the drive alone, so that the
// result is the same for any number of threads. Each begins with a run-up over the end of the one
// before it, which fills its local map: this long a path [m] and this many scans.
constexpr double kRunUpM = 6.0;
constexpr int kRunUpScans = 50;
// A stretch is long against its run-up, ...
constexpr double kMinStretchM = 10.0 * kRunUpM;
constexpr int kMinStretchPoses = 5 * kRunUpScans;
// ... and more than these would keep few more processors busy.
constexpr int kMaxStretches = 16;

// Pose ids: matched from `run_up` to before `end`, and kept from `begin` on.
struct Stretch {
  int run_up = 0;
  int begin = 0;
  int end = 0;
};

// odometry: of each pose from the one before. scan_of_pose: -1 if it has none to match.
std::vector<Stretch> CutIntoStretches(const std::vector<Pose2>& odometry,
                                      const std::vector<int>& scan_of_pose) {
  const int num_poses = static_cast<int>(odometry.size());
  if (num_poses == 0) return {};
  std::vector<double> path_m(num_poses, 0.0);
  for (int pose = 1; pose < num_poses; ++pose) {
    path_m[pose] = path_m[pose - 1] + odometry[pose].translation().norm();
  }
  const int num_stretches =
      std::min({kMaxStretches, num_poses / kMinStretchPoses,
                static_cast<int>(std::min(path_m.back() / kMinStretchM, 1.0 * kMaxStretches))});
  if (num_stretches < 2) return {{0, 0, num_poses}};
  std::vector<Stretch> stretches(num_stretches);
  const auto border = [&](int i) {
    return static_cast<int>(static_cast<std::int64_t>(num_poses) * i / num_stretches);
  };
  for (int i = 0; i < num_stretches; ++i) {
    Stretch& stretch = stretches[i];
    stretch = {border(i), border(i), border(i + 1)};
    if (i == 0) continue;
    // Not farther than half way: a robot that stands still gains nothing there.
    const int earliest = (border(i - 1) + border(i)) / 2;
    int num_scans = 0;
    while (stretch.run_up > earliest &&
           (path_m[stretch.begin] - path_m[stretch.run_up] < kRunUpM || num_scans < kRunUpScans)) {
      --stretch.run_up;
      if (scan_of_pose[stretch.run_up] >= 0) ++num_scans;
    }
  }
  return stretches;
}

// The scans that it takes to match some of the stretches.
std::vector<int> ScansAlong(const std::vector<Stretch>& stretches,
                            const std::vector<std::size_t>& some,
                            const std::vector<int>& scan_of_pose) {
  std::vector<int> scans;
  for (const std::size_t i : some) {
    for (int pose = stretches[i].run_up; pose < stretches[i].end; ++pose) {
      if (scan_of_pose[pose] >= 0) scans.push_back(scan_of_pose[pose]);
    }
  }
  return scans;
}

// Without their run-ups.
int NumPosesAlong(const std::vector<Stretch>& stretches, const std::vector<std::size_t>& some) {
  int num_poses = 0;
  for (const std::size_t i : some) num_poses += stretches[i].end - stretches[i].begin;
  return num_poses;
}

// Counts scans on all threads, and tells the caller on its own: it may not expect calls on others.
class ProgressMeter {
 public:
  // num_own: of this process, which stand for num_total.
  ProgressMeter(const SeedingProgress& progress, int num_own, int num_total)
      : progress_(progress),
        num_own_(num_own),
        num_total_(num_total),
        caller_(std::this_thread::get_id()) {}

  // To be called first: the caller hears of the matching whatever its thread does.
  void Begin() {
    if (progress_ && !progress_(SeedingPhase::kMatchingScans, 0, num_total_)) stopped_ = true;
  }

  void Count() {
    const int num_done = num_done_++;
    if (progress_ && std::this_thread::get_id() == caller_ && num_done >= next_report_) {
      next_report_ = num_done + kScansPerReport;
      const auto done =
          static_cast<int>(static_cast<std::int64_t>(num_done) * num_total_ / num_own_);
      if (!progress_(SeedingPhase::kMatchingScans, done, num_total_)) stopped_ = true;
    }
  }

  // The caller has had enough.
  bool stopped() const { return stopped_; }

 private:
  const SeedingProgress& progress_;
  const int num_own_, num_total_;
  const std::thread::id caller_;
  static constexpr int kScansPerReport = 100;
  int next_report_ = kScansPerReport;  // of the caller's thread
  std::atomic<int> num_done_{0};
  std::atomic<bool> stopped_{false};
};

// What was found along a stretch; poses and odometry begin with its run-up.
struct MatchedStretch {
  std::vector<Pose2> poses;
  std::vector<Pose2> odometry;
  std::vector<Keyframe> keyframes;
  std::vector<PackedSurface> key_surfaces;
  SequentialSeedingReport report;  // counts only
};

// A keyframe, to be copied byte by byte.
struct PlainKeyframe {
  int pose, scan;
  double path_m;
  double information[9];
  bool after_unmatched;
};

PlainKeyframe ToPlain(const Keyframe& key) {
  PlainKeyframe plain{key.pose, key.scan, key.path_m, {}, key.after_unmatched};
  Eigen::Map<Eigen::Matrix3d>(plain.information) = key.information;
  return plain;
}

Keyframe FromPlain(const PlainKeyframe& plain) {
  return {plain.pose, plain.scan, plain.path_m,
          Eigen::Map<const Eigen::Matrix3d>(plain.information), plain.after_unmatched};
}

// How much of the arrays below belongs to a stretch, and its counts.
struct StretchOutline {
  std::size_t stretch, num_poses, num_keyframes;
  int num_reversed_steps, num_recovered, num_unmatched;
};

// Gives all processes what each has found along its own stretches, but for the surfaces.
void ShareMatches(const Peers& peers, const std::vector<std::size_t>& own,
                  std::vector<MatchedStretch>* matched) {
  peers.WaitForAll();  // some may have had no stretch
  std::vector<StretchOutline> outlines;
  std::vector<Pose2> poses, odometry;
  std::vector<PlainKeyframe> keyframes;
  for (const std::size_t i : own) {
    const MatchedStretch& stretch = (*matched)[i];
    outlines.push_back({i, stretch.poses.size(), stretch.keyframes.size(),
                        stretch.report.num_reversed_steps, stretch.report.num_recovered,
                        stretch.report.num_unmatched});
    poses.insert(poses.end(), stretch.poses.begin(), stretch.poses.end());
    odometry.insert(odometry.end(), stretch.odometry.begin(), stretch.odometry.end());
    std::transform(stretch.keyframes.begin(), stretch.keyframes.end(),
                   std::back_inserter(keyframes), ToPlain);
  }
  poses = JoinOverPeers(&peers, std::move(poses));
  odometry = JoinOverPeers(&peers, std::move(odometry));
  keyframes = JoinOverPeers(&peers, std::move(keyframes));
  auto pose = poses.begin(), step = odometry.begin();
  auto key = keyframes.begin();
  for (const StretchOutline& outline : JoinOverPeers(&peers, std::move(outlines))) {
    MatchedStretch& stretch = (*matched)[outline.stretch];
    const auto num_poses = static_cast<std::ptrdiff_t>(outline.num_poses);
    stretch = MatchedStretch();
    stretch.poses.assign(pose, pose + num_poses);
    stretch.odometry.assign(step, step + num_poses);
    pose += num_poses;
    step += num_poses;
    for (std::size_t k = 0; k < outline.num_keyframes; ++k) {
      stretch.keyframes.push_back(FromPlain(*key++));
    }
    stretch.report.num_reversed_steps = outline.num_reversed_steps;
    stretch.report.num_recovered = outline.num_recovered;
    stretch.report.num_unmatched = outline.num_unmatched;
  }
}

class DriveMatcher {
 public:
  DriveMatcher(const SeedingOptions& options, const MotionOptions& motion,
               const ScanSurfaces& surfaces, const StepSource& steps, bool sign_lost)
      : options_(options),
        motion_(motion),
        surfaces_(surfaces),
        steps_(steps),
        sign_lost_(sign_lost),
        prediction_(surfaces.graph()) {}

  MatchedStretch Match(const Stretch& stretch, ProgressMeter* progress) const {
    MatchedStretch matched;
    if (stretch.run_up == stretch.end) return matched;  // of a graph without poses
    SequentialSeedingReport run_up_report;
    DriveTracker tracker(options_, motion_, sign_lost_,
                         surfaces_.graph().InitialPose(stretch.run_up));
    for (int pose = stretch.run_up; pose < stretch.end; ++pose) {
      const int scan = surfaces_.scan_of_pose()[pose];
      SurfacePoints surface;
      if (scan >= 0) surface = surfaces_.Of(scan);
      const Pose2 step = pose > stretch.run_up ? StepTo(pose, tracker.poses()) : Pose2();
      tracker.Add(pose, scan, surface, KindOf(pose), step,
                  pose < stretch.begin ? &run_up_report : &matched.report);
      if (pose >= stretch.begin) progress->Count();
      if (progress->stopped()) break;
    }
    matched.poses = tracker.TakePoses();
    matched.odometry = tracker.TakeSteps();
    matched.keyframes = tracker.matcher().TakeKeyframes();
    matched.key_surfaces = tracker.matcher().TakeKeySurfaces();
    return matched;
  }

 private:
  StepKind KindOf(int pose) const {
    if (!steps_.given_poses.empty()) return StepKind::kRough;
    const bool is_measured =
        !steps_.odometry.empty() && (steps_.is_still.empty() || steps_.is_still[pose] == 0);
    return is_measured ? StepKind::kMeasured : StepKind::kPredicted;
  }

  // before: the matched poses; all of the drive unless all steps are measured.
  Pose2 StepTo(int pose, const std::vector<Pose2>& before) const {
    switch (KindOf(pose)) {
      case StepKind::kMeasured:
        return steps_.odometry[pose];
      case StepKind::kRough:
        return StepToGivenPose(steps_.given_poses, before, pose);
      default:
        return prediction_.Step(before, pose);
    }
  }

  const SeedingOptions& options_;
  const MotionOptions& motion_;
  const ScanSurfaces& surfaces_;
  const StepSource& steps_;
  const bool sign_lost_;
  const MotionPrediction prediction_;
};

// Joins a stretch to those before it by its own match of the last pose that they have in common.
void Append(const Stretch& stretch, MatchedStretch matched, ScanSurfaces* surfaces,
            SequentialTrajectory* trajectory) {
  std::vector<Pose2>& poses = trajectory->world_from_robot;
  const int num_in_run_up = stretch.begin - stretch.run_up;
  if (num_in_run_up == 0) {
    poses = matched.poses;
  } else {
    const Pose2 world_from_stretch = poses.back() * matched.poses[num_in_run_up - 1].Inverse();
    for (auto it = matched.poses.begin() + num_in_run_up; it != matched.poses.end(); ++it) {
      poses.push_back(world_from_stretch * *it);
    }
  }
  trajectory->odometry.insert(trajectory->odometry.end(), matched.odometry.begin() + num_in_run_up,
                              matched.odometry.end());
  for (std::size_t k = 0; k < matched.keyframes.size(); ++k) {
    const Keyframe& keyframe = matched.keyframes[k];
    if (keyframe.pose < stretch.begin) continue;
    if (!matched.key_surfaces.empty()) {
      surfaces->Keep(keyframe.scan, std::move(matched.key_surfaces[k]));
    }
    trajectory->keyframes.push_back(keyframe);
  }
}

void MeasurePathToKeyframes(SequentialTrajectory* trajectory) {
  const std::vector<Pose2>& poses = trajectory->world_from_robot;
  double path_m = 0.0;
  int pose = 0;
  for (Keyframe& keyframe : trajectory->keyframes) {
    for (; pose < keyframe.pose; ++pose) {
      path_m += Between(poses[pose], poses[pose + 1]).translation().norm();
    }
    keyframe.path_m = path_m;
  }
}

double TroubleShare(const SequentialSeedingReport& report, const Stretch& stretch) {
  return static_cast<double>(report.num_unmatched + report.num_recovered) /
         static_cast<double>(stretch.end - stretch.begin);
}

void AddCounts(const SequentialSeedingReport& more, SequentialSeedingReport* report) {
  report->num_reversed_steps += more.num_reversed_steps;
  report->num_recovered += more.num_recovered;
  report->num_unmatched += more.num_unmatched;
}

}  // namespace

Status OdometrySteps(const SlamGraph& graph, std::vector<Pose2>* steps) {
  steps->clear();
  if (LacksOdometry(graph)) return Status::Ok();
  std::vector<int> step_to_pose;
  PLUMBLINE_RETURN_IF_ERROR(FindOdometrySteps(graph, &step_to_pose));
  steps->resize(graph.num_poses());
  for (int pose = 1; pose < graph.num_poses(); ++pose) {
    (*steps)[pose] = graph.odometry()[step_to_pose[pose]].from_from_to;
  }
  return Status::Ok();
}

Status SeedSequentially(const SeedingOptions& options, const MotionOptions& motion,
                        const SeedingProgress& progress, ThreadPool* pool, ScanSurfaces* surfaces,
                        SequentialTrajectory* trajectory, SequentialSeedingReport* report) {
  StepSource steps;
  PLUMBLINE_RETURN_IF_ERROR(OdometrySteps(surfaces->graph(), &steps.odometry));
  return SeedSequentially(options, motion, steps, progress, pool, surfaces, trajectory, report);
}

Status SeedSequentially(const SeedingOptions& options, const MotionOptions& motion,
                        const StepSource& steps, const SeedingProgress& progress, ThreadPool* pool,
                        ScanSurfaces* surfaces, SequentialTrajectory* trajectory,
                        SequentialSeedingReport* report) {
  const SlamGraph& graph = surfaces->graph();
  const std::vector<int>& scan_of_pose = surfaces->scan_of_pose();
  std::vector<Stretch> stretches{{0, 0, graph.num_poses()}};
  if (!steps.odometry.empty() && steps.is_still.empty()) {
    stretches = CutIntoStretches(steps.odometry, scan_of_pose);
  }
  SequentialSeedingReport counts;
  counts.odometry_sign = CheckOdometrySign(*surfaces, pool);

  // Each process matches those that begin in its part.
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (graph.HasScansOf(stretches[i].begin)) own.push_back(i);
  }
  const ScanSurfaces at_hand = surfaces->With(ScansAlong(stretches, own, scan_of_pose));
  const DriveMatcher matcher(options, motion, at_hand, steps, counts.odometry_sign.sign_lost);
  ProgressMeter meter(progress, NumPosesAlong(stretches, own), graph.num_poses());
  meter.Begin();
  std::vector<MatchedStretch> matched(stretches.size());
  pool->ForEachChunk(own.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    matched[own[i]] = matcher.Match(stretches[own[i]], &meter);
  });
  if (meter.stopped()) return Status::Unavailable("seeding was stopped by its caller");
  if (graph.peers() != nullptr) ShareMatches(*graph.peers(), own, &matched);

  SequentialTrajectory joined;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    AddCounts(matched[i].report, &counts);
    joined.worst_trouble_share =
        std::max(joined.worst_trouble_share, TroubleShare(matched[i].report, stretches[i]));
    Append(stretches[i], std::move(matched[i]), surfaces, &joined);
  }
  MeasurePathToKeyframes(&joined);
  counts.num_keyframes = static_cast<int>(joined.keyframes.size());
  *trajectory = std::move(joined);
  *report = counts;
  return Status::Ok();
}

}  // namespace plumbline
