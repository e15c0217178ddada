#include "plumbline/solvers/map_sessions.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/seeding/close_all_loops.h"
#include "plumbline/solvers/seeding/seed_drive.h"
#include "plumbline/solvers/sessions/align_sessions.h"
#include "plumbline/solvers/sessions/bent_stretches.h"
#include "plumbline/solvers/sessions/session_set.h"

namespace plumbline {
namespace {

Status CheckOptions(const MapLogOptions& options) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  if (options.start != StartType::kSeed) {
    return Status::InvalidArgument("several sessions are mapped from their seeds, not from " +
                                   std::string(ToString(options.start)));
  }
  if (options.calibration.IsOn()) {
    return Status::InvalidArgument("a calibration goes with one session, not with several");
  }
  if (options.solver.MovesPosesOnly()) {
    return Status::InvalidArgument(
        "several sessions are tied by their returns, at which the solver " +
        std::string(SolverOf(options.solver).name()) + " does not look");
  }
  return Status::Ok();
}

// What is wrong with a session, by its number.
Status OfSession(std::size_t index, const Status& status) {
  if (status.code() != StatusCode::kInvalidArgument) return status;
  return Status::InvalidArgument("session " + std::to_string(index + 1) + ": " + status.message());
}

// Processes share all sessions or none, and only such as SeedLog takes from them.
Status CheckSharing(const MapLogOptions& options, const std::vector<LogMapping>& sessions) {
  const Peers* peers = sessions.front().graph.peers();
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    if (sessions[i].graph.peers() != peers) {
      return OfSession(i,
                       Status::InvalidArgument("it is not shared by the processes of session 1"));
    }
    if (peers != nullptr && !CanSeedTogether(options, sessions[i])) {
      return OfSession(i, Status::InvalidArgument("processes cannot seed such a log together"));
    }
  }
  return Status::Ok();
}

// The work of SeedLog, with what it takes to go on closing loops.
Status SeedSession(const MapLogOptions& options, const SeedingProgress& progress, ThreadPool* pool,
                   LogMapping* mapping, SeededDrive* drive) {
  const MotionOptions& motion = options.solver.factors.motion;
  MeasureSurfaceOf(options, pool, mapping);
  SeedingReport seeding;
  if (mapping->graph.peers() == nullptr) {
    PLUMBLINE_RETURN_IF_ERROR(SeedDrive(options.seeding, motion, mapping->surface, progress, pool,
                                        mapping->graph, drive, &seeding));
  } else {
    PLUMBLINE_RETURN_IF_ERROR(SeedSharedDrive(options.seeding, motion, progress, pool,
                                              &mapping->graph, &mapping->surface, drive, &seeding));
  }
  return StartFromSeed(options, PoseArray(drive->world_from_robot), std::move(seeding), mapping);
}

// A finished map among the sessions.
struct FixedMap {
  int session = -1;          // none
  std::vector<Pose2> poses;  // where they are fixed
};

// Poses that the closing of loops has bent along with those of a finished map: the latter go back
// to where they are fixed, and each of the others follows the nearest of them. first: the first one
// of the map.
void FollowFixedMap(const std::vector<Pose2>& fixed, int first, std::vector<Pose2>* poses) {
  constexpr std::size_t kMostCompared = 2000;  // a session is bent by no more than decimetres
  const std::vector<Pose2> bent(poses->begin() + first, poses->begin() + first + fixed.size());
  const std::size_t stride = fixed.size() / kMostCompared + 1;
  for (Pose2& pose : *poses) {
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < bent.size(); i += stride) {
      const auto distance = [&](std::size_t other) {
        return (bent[other].translation() - pose.translation()).squaredNorm();
      };
      if (distance(i) < distance(nearest)) nearest = i;
    }
    pose = fixed[nearest] * (bent[nearest].Inverse() * pose);
  }
  std::copy(fixed.begin(), fixed.end(), poses->begin() + first);
}

void TakeLarger(const MotionOptions& other, MotionOptions* motion) {
  for (const MotionField& field : kMotionFields) {
    motion->*field.value = std::max(motion->*field.value, other.*field.value);
  }
}

// Known if it is known of all.
void TakeLarger(const RandomError& other, bool is_first, RandomError* error) {
  error->estimated = other.estimated && (is_first || error->estimated);
  error->num_spans += other.num_spans;
  error->sigma_per_sqrt_m = std::max(error->sigma_per_sqrt_m, other.sigma_per_sqrt_m);
  error->sigma_per_sqrt_rad = std::max(error->sigma_per_sqrt_rad, other.sigma_per_sqrt_rad);
}

// What the seedings of several sessions found, as of one log; but for the loops that were closed.
class JoinedReport {
 public:
  void Add(const SessionOfMap& session, const SlamGraph& graph) {
    const MappingReport& own = session.report;
    for (FrozenStretch stretch : own.frozen_laser) {
      stretch.first_scan += session.first_scan;
      stretch.last_scan += session.first_scan;
      stretch.laser = graph.all_scans()[stretch.first_scan].laser;
      report_.frozen_laser.push_back(stretch);
    }
    if (own.sweep_order) report_.sweep_order = own.sweep_order;
    report_.range_noise_m = std::max(report_.range_noise_m, own.range_noise_m);
    AddMoving(own.seeding.moving_share, session, graph);
    AddSequential(own.seeding.sequential);
    AddNoise(own.seeding.odometry_noise);
    is_first_ = false;
  }

  MappingReport Take() { return std::move(report_); }

 private:
  void AddSequential(const SequentialSeedingReport& own) {
    SequentialSeedingReport& sum = report_.seeding.sequential;
    sum.num_keyframes += own.num_keyframes;
    sum.num_reversed_steps += own.num_reversed_steps;
    sum.num_recovered += own.num_recovered;
    sum.num_unmatched += own.num_unmatched;
    sum.odometry_sign.num_backward_steps += own.odometry_sign.num_backward_steps;
    sum.odometry_sign.num_decided += own.odometry_sign.num_decided;
    sum.odometry_sign.num_contradicting += own.odometry_sign.num_contradicting;
    if (own.odometry_sign.sign_lost) sum.odometry_sign.sign_lost = true;
  }

  // Weighted by the numbers of returns.
  void AddMoving(double share, const SessionOfMap& session, const SlamGraph& graph) {
    double num_own = 0.0;
    for (int scan = session.first_scan; scan < session.first_scan + session.num_scans; ++scan) {
      num_own += static_cast<double>(graph.all_scans()[scan].num_returns);
    }
    if (num_own == 0.0) return;
    double& joined = report_.seeding.moving_share;
    joined = (joined * num_returns_ + share * num_own) / (num_returns_ + num_own);
    num_returns_ += num_own;
  }

  void AddNoise(const OdometryNoiseReport& own) {
    OdometryNoiseReport& joined = report_.seeding.odometry_noise;
    joined.num_leaps += own.num_leaps;
    joined.num_still_steps += own.num_still_steps;
    if (own.is_prediction) joined.is_prediction = true;
    if (is_first_) joined.motion = own.motion;
    TakeLarger(own.motion, &joined.motion);
    TakeLarger(own.translation, is_first_, &joined.translation);
    TakeLarger(own.rotation, is_first_, &joined.rotation);
  }

  MappingReport report_;
  double num_returns_ = 0.0;
  bool is_first_ = true;
};

// All sessions, seeded, and their way from there to maps.
class SessionsRun {
 public:
  SessionsRun(const MapLogOptions& options, const SeedingProgress& progress, ThreadPool* pool)
      : options_(options), progress_(progress), pool_(pool) {}

  Status Seed(std::vector<LogMapping> sessions) {
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      LogMapping mapping = std::move(sessions[i]);  // freed once it is in the set
      if (mapping.graph.all_scans().empty()) {
        return OfSession(i, Status::InvalidArgument("it has no scan"));
      }
      SeededDrive drive;
      const Status seeded = SeedSession(options_, progress_, pool_, &mapping, &drive);
      if (!seeded.ok()) return OfSession(i, seeded);
      if (drive.matched.keyframes.empty()) {
        return OfSession(i, Status::InvalidArgument("no scan of it shows a surface"));
      }
      const Status noted = NoteFixedMap(static_cast<int>(i), mapping.graph);
      if (!noted.ok()) return OfSession(i, noted);
      PLUMBLINE_RETURN_IF_ERROR(AddSession(mapping.graph, std::move(drive), &set_));
      reports_.push_back(std::move(mapping.report));
    }
    FinishSet(pool_, &set_);
    return Status::Ok();
  }

  Status MakeMaps(SessionsMapping* mapping) {
    std::vector<SessionGroup> groups;
    PLUMBLINE_RETURN_IF_ERROR(AlignSessions(set_, progress_, pool_, &groups, &mapping->ties));
    // Without the scans of other processes: each map asks for its own.
    set_.surfaces = ScanSurfaces(set_.graph, std::move(set_.surfaces).TakeKept());
    for (const SessionGroup& group : groups) {
      PLUMBLINE_RETURN_IF_ERROR(MakeMapOrMaps(group, mapping));
    }
    std::sort(mapping->maps.begin(), mapping->maps.end(),
              [](const SessionMap& a, const SessionMap& b) {
                return a.sessions.front().session < b.sessions.front().session;
              });
    return Status::Ok();
  }

 private:
  Status NoteFixedMap(int session, const SlamGraph& graph) {
    if (!graph.has_named_fixed_poses()) return Status::Ok();
    const std::vector<FixedPose>& fixed = graph.fixed_poses();
    if (static_cast<int>(fixed.size()) < graph.num_poses()) {
      return Status::InvalidArgument("some of its poses are fixed, and others are not");
    }
    if (fixed_map_.session >= 0) {
      return Status::InvalidArgument("its poses are fixed, and so are those of session " +
                                     std::to_string(fixed_map_.session + 1));
    }
    fixed_map_.session = session;
    fixed_map_.poses.resize(fixed.size());
    for (const FixedPose& pose : fixed) fixed_map_.poses[pose.pose] = pose.world_from_robot;
    return Status::Ok();
  }

  // The last tie of a group goes if the map contradicts itself, and no session does so alone.
  Status MakeMapOrMaps(const SessionGroup& group, SessionsMapping* mapping) {
    SessionMap map;
    PLUMBLINE_RETURN_IF_ERROR(MakeMap(group, &map));
    const bool is_to_part =
        group.sessions.size() > 1 && map.mapping.report.seeding.consistency.IsContradictory() &&
        std::none_of(group.sessions.begin(), group.sessions.end(), [&](int session) {
          return reports_[session].seeding.consistency.IsContradictory();
        });
    if (!is_to_part) {
      mapping->maps.push_back(std::move(map));
      return Status::Ok();
    }
    for (SessionTie& tie : mapping->ties) {
      if (tie.first.size() + tie.second.size() == group.sessions.size() &&
          tie.first.front() == group.sessions.front()) {
        tie.outcome = TieOutcome::kContradicted;
      }
    }
    for (const SessionGroup& part : group.parts) {
      PLUMBLINE_RETURN_IF_ERROR(MakeMapOrMaps(part, mapping));
    }
    return Status::Ok();
  }

  Status MakeMap(const SessionGroup& group, SessionMap* map) {
    JoinedDrive drive;
    MotionOptions motion = reports_[group.sessions.front()].seeding.odometry_noise.motion;
    for (const int session : group.sessions) {
      TakeLarger(reports_[session].seeding.odometry_noise.motion, &motion);
    }
    PLUMBLINE_RETURN_IF_ERROR(JoinDrives(set_, group, motion, &drive));
    JoinedReport joined;
    for (std::size_t i = 0; i < group.sessions.size(); ++i) {
      SessionOfMap session;
      session.session = group.sessions[i];
      session.first_pose = drive.first_pose[i];
      session.num_poses = drive.first_pose[i + 1] - drive.first_pose[i];
      session.first_scan = drive.first_scan[i];
      session.num_scans = drive.first_scan[i + 1] - drive.first_scan[i];
      session.report = reports_[session.session];
      joined.Add(session, drive.graph);
      map->sessions.push_back(std::move(session));
    }
    map->mapping.report = group.sessions.size() == 1 ? map->sessions.front().report : joined.Take();
    MeasuredSurface surface = MeasureSurface(
        drive.graph, NormalOptionsFor(BeamNoise(options_, map->mapping.report)), pool_);
    if (group.sessions.size() == 1) {
      return Start(SeedOf(group.sessions.front()), std::move(drive.graph), std::move(surface), map);
    }
    SeedingReport& seeding = map->mapping.report.seeding;
    PLUMBLINE_RETURN_IF_ERROR(CloseLoopsOf(motion, &drive, &surface, &seeding));
    for (const OdometryConstraint& step : drive.graph.odometry()) {
      seeding.corrections.odometry.push_back(step.from_from_to);
    }
    const std::vector<Pose2>& poses = drive.matched.world_from_robot;
    for (const SessionOfMap& session : map->sessions) {
      const auto first = poses.begin() + session.first_pose;
      const std::vector<BentStretch> bent = FindBentStretches(
          SeedOf(session.session), {first, first + session.num_poses}, session.first_pose);
      std::vector<BentStretch>& all = map->mapping.report.bent_stretches;
      all.insert(all.end(), bent.begin(), bent.end());
    }
    return Start(std::move(drive.matched.world_from_robot), std::move(drive.graph),
                 std::move(surface), map);
  }

  Status CloseLoopsOf(const MotionOptions& motion, JoinedDrive* drive, MeasuredSurface* surface,
                      SeedingReport* seeding) const {
    if (drive->graph.peers() != nullptr) {  // divided as each session lay by itself
      ShareAnewByPlace(drive->graph.initial_poses(), &drive->graph, surface);
    }
    const ScanSurfaces surfaces = ScanSurfaces(drive->graph, *surface, std::move(drive->surfaces))
                                      .WithKept(ScansOf(drive->matched.keyframes), pool_);
    KeyframeGraph keys;
    return CloseAllLoops(motion, surfaces, progress_, &drive->ties, pool_, &drive->matched, &keys,
                         seeding);
  }

  std::vector<Pose2> SeedOf(int session) const {
    std::vector<Pose2> poses;
    for (int pose = set_.first_pose[session]; pose < set_.first_pose[session + 1]; ++pose) {
      poses.push_back(set_.graph.InitialPose(pose));
    }
    return poses;
  }

  Status Start(std::vector<Pose2> poses, SlamGraph graph, MeasuredSurface surface,
               SessionMap* map) const {
    for (const SessionOfMap& session : map->sessions) {
      if (session.session != fixed_map_.session) continue;
      FollowFixedMap(fixed_map_.poses, session.first_pose, &poses);
      for (int i = 0; i < session.num_poses; ++i) {
        graph.FixPose(session.first_pose + i, fixed_map_.poses[i]);
      }
    }
    PLUMBLINE_RETURN_IF_ERROR(graph.status());
    LogMapping& mapping = map->mapping;
    mapping.graph = std::move(graph);
    mapping.start_poses = PoseArray(poses);
    mapping.state = {mapping.start_poses, {}};
    mapping.surface = std::move(surface);
    if (mapping.graph.peers() != nullptr) {
      ShareAnewByPlace(mapping.start_poses, &mapping.graph, &mapping.surface);
    }
    return Status::Ok();
  }

  const MapLogOptions& options_;
  const SeedingProgress& progress_;
  ThreadPool* pool_;
  SessionSet set_;
  std::vector<MappingReport> reports_;  // per session
  FixedMap fixed_map_;
};

}  // namespace

Status SeedSessions(const MapLogOptions& options, std::vector<LogMapping> sessions,
                    const SeedingProgress& progress, ThreadPool* pool, SessionsMapping* mapping) {
  return CatchExceptions([&] {
    PLUMBLINE_RETURN_IF_ERROR(CheckOptions(options));
    if (sessions.empty()) return Status::InvalidArgument("there is no session to map");
    PLUMBLINE_RETURN_IF_ERROR(CheckSharing(options, sessions));
    const bool is_shared = sessions.front().graph.peers() != nullptr;
    const SeedingProgress unstoppable = Unstoppable(progress);
    SessionsRun run(options, is_shared ? unstoppable : progress, pool);
    PLUMBLINE_RETURN_IF_ERROR(run.Seed(std::move(sessions)));
    SessionsMapping seeded;
    PLUMBLINE_RETURN_IF_ERROR(run.MakeMaps(&seeded));
    *mapping = std::move(seeded);
    return Status::Ok();
  });
}

Status MapSessions(const MapLogOptions& options, std::vector<SlamGraph> sessions,
                   const SeedingProgress& progress, SessionsMapping* mapping) {
  return CatchExceptions([&] {
    PLUMBLINE_RETURN_IF_ERROR(CheckOptions(options));
    ThreadPool pool(options.solver.num_threads);
    std::vector<LogMapping> taken(sessions.size());
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      PLUMBLINE_RETURN_IF_ERROR(
          OfSession(i, TakeLog(options, std::move(sessions[i]), &pool, &taken[i])));
    }
    SessionsMapping seeded;
    PLUMBLINE_RETURN_IF_ERROR(SeedSessions(options, std::move(taken), progress, &pool, &seeded));
    for (SessionMap& map : seeded.maps) {
      PLUMBLINE_RETURN_IF_ERROR(RefineLog(options, &pool, &map.mapping));
    }
    *mapping = std::move(seeded);
    return Status::Ok();
  });
}

}  // namespace plumbline
