#ifndef PLUMBLINE_SOLVERS_MAP_LOG_H_
#define PLUMBLINE_SOLVERS_MAP_LOG_H_

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/core/laser_scan.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/alarm.h"
#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/interface/map_consistency.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

class ThreadPool;

/// How a log is mapped.
struct MapLogOptions {
  /// Where the joint estimation starts. kSeed is the one that SeedGraph finds, or the matching
  /// before loops were closed for solvers that close the loops themselves.
  StartType start = StartType::kSeed;
  SeedingOptions seeding;          ///< how the seed is found
  SolverOptions solver;            ///< the joint estimation, and the noise of the sensors
  CalibrationOptions calibration;  ///< nothing to estimate: Solve

  /// False if a field is out of range, or if the fields do not go together; *error, if not null,
  /// then says which and why.
  bool Check(std::string* error) const;
};

/// What was found on the way from a log to a map, and whether to trust it.
struct MappingReport {
  /// Standard deviation of a range reading [m], as neighbouring beams show it; 0 if they do not.
  double range_noise_m = 0.0;
  std::vector<FrozenStretch> frozen_laser;  ///< whose repetitions were left out
  /// How the lasers sweep, as the scans say; empty where they measure all beams at once.
  std::optional<SweepOrder> sweep_order;
  SeedingReport seeding;  ///< how the start was found
  /// Of several sessions (MapSessions): where the seed bends one of them to fit the others.
  std::vector<BentStretch> bent_stretches;
  SolverSummary solver;  ///< how the joint estimation went
  /// Poses that it had left some decimetres beside where their scans fit: it began again with them
  /// there, which is what `solver` tells of.
  std::vector<int> misplaced_poses;
  Calibration calibration;     ///< empty if none was asked for
  MapConsistency consistency;  ///< of the map
  /// Where the map may be wrong, and why; empty if nothing speaks against it.
  std::vector<Alarm> alarms;
};

/// A log on its way to a map: each step of MapLog fills in what it finds.
struct LogMapping {
  /// The measurements that the estimate is made of. First those of the log without the repetitions
  /// of a frozen laser; with a seed, its corrections of the odometry, marks on what moves and, for
  /// solvers that look at nothing else, its pose graph come in, and predicted steps if it has no
  /// odometry; a calibration corrects mountings, ranges and odometry (Calibration::corrections is
  /// empty then). The motion within the sweeps of a laser is taken out, by the poses of the state.
  SlamGraph graph;
  /// The measurements with that motion in them; empty where lasers measure all beams at once.
  std::optional<SlamGraph> as_swept;
  /// What its scans saw, in the graph; empty after TakeLog and after RefineLog.
  MeasuredSurface surface;
  /// The estimate: first the initial guesses of the log; then where the solver starts
  /// (MapLogOptions::start); then the map. Before that it has no points: they are where the
  /// measurements put them (SlamGraph::MeasuredMap).
  MapState state;
  /// The start, (x, y, yaw) each. After a calibration of the mounting they are the poses of the
  /// calibrated robot that leave the lasers where they were.
  std::vector<double> start_poses;
  Pose2 before_from_after;  ///< how a calibrated mounting moved the frame of the robot
  MappingReport report;     ///< what was found on the way
};

/// Maps a log: leaves out what a frozen laser repeated, measures its range noise (BeamNoise), takes
/// out what the robot moved during a sweep (by its odometry, then by the seed), seeds the poses
/// (SeedGraph), takes the noise of the odometry from what the scans say of it, estimates poses and
/// points jointly (Solve or SolveWithCalibration; never worse than the seed by what the returns
/// say), and measures whether the map contradicts itself. graph: poses in order of time, joined by
/// odometry from each to the next, or by none at all: the scans alone then tell how the robot
/// moved, and steps that continue the motion before them take the place of the odometry. progress
/// may be empty. The result does not depend on the number of threads.
///
/// It is PrepareLog, SeedLog and RefineLog in turn, for callers that have nothing to do in between.
/// Fails like these; *mapping then holds what the steps before had found.
Status MapLog(const MapLogOptions& options, SlamGraph graph, const SeedingProgress& progress,
              LogMapping* mapping);

/// A log's map, as a value.
struct LogMap {
  /// As the other MapLog gives it. On failure, the other fields hold the results of the stages
  /// before.
  Status status;
  SlamGraph graph;             ///< LogMapping::graph
  std::vector<Pose2> poses;    ///< world_from_robot per pose of the graph
  std::vector<double> points;  ///< x, y [m] in the world, two numbers per return of the graph
  MappingReport report;        ///< how it went, and the alarms

  /// A map point, x, y [m] in the world. Needs a return id of the graph.
  Eigen::Vector2d point(std::size_t return_id) const {
    return {points[2 * return_id], points[2 * return_id + 1]};
  }
  /// A copy of poses and points for functions that take a state.
  MapState State() const { return {PoseArray(poses), points}; }
};

/// Maps a log in one call.
LogMap MapLog(SlamGraph graph, const MapLogOptions& options = MapLogOptions(),
              const SeedingProgress& progress = nullptr);

/// Takes a log over and measures the surfaces that its scans saw. InvalidArgument on bad options,
/// and on a calibration of what needs odometry if there is none; *mapping is then as it was.
Status PrepareLog(const MapLogOptions& options, SlamGraph graph, ThreadPool* pool,
                  LogMapping* mapping);

/// The same, but leaves the surfaces to whoever needs them, SeedLog or RefineLog.
Status TakeLog(const MapLogOptions& options, SlamGraph graph, ThreadPool* pool,
               LogMapping* mapping);

/// Whether processes that share the graph of a log that was prepared (PartitionByTime) can seed it
/// together: by its scans, if they were measured at once and it has odometry.
bool CanSeedTogether(const MapLogOptions& options, const LogMapping& mapping);

/// Finds the start for a log that PrepareLog took over and that has none yet. It does not read the
/// state, which the caller may have taken away. Fails like SeedGraph. Processes that share the
/// graph find it together (collective); the graph is divided anew, by place. Then progress must not
/// stop it, and InvalidArgument if they cannot (CanSeedTogether).
Status SeedLog(const MapLogOptions& options, const SeedingProgress& progress, ThreadPool* pool,
               LogMapping* mapping);

/// The same with a seed that was kept from an earlier SeedLog of the same log and options. seeding:
/// MappingReport::seeding as it was then; start_poses: likewise. Fails on sizes that do not go with
/// the log.
Status StartFromSeed(const MapLogOptions& options, std::vector<double> start_poses,
                     SeedingReport seeding, LogMapping* mapping);

/// The noise of the beams that a log is mapped with: that of the options, unless neighbouring beams
/// show more than twice as much range noise. Theirs is then taken, up to 60 mm: what differs by
/// more is grass, or no laser.
RangeBeamOptions BeamNoise(const MapLogOptions& options, const MappingReport& report);

/// Measures the surfaces that the scans of the graph saw, with BeamNoise.
void MeasureSurfaceOf(const MapLogOptions& options, ThreadPool* pool, LogMapping* mapping);

/// What the joint estimation of a seeded log goes by: the options, but with BeamNoise, and with
/// what the scans say of the noise of the odometry where that is less. A calibration has its own
/// view of that, and keeps the options'. Without odometry the noise is that of the predicted steps.
/// Steps that the seeding found broken count no more.
SolverOptions RefinementOptions(const MapLogOptions& options, const LogMapping& mapping);

/// Refines a log that has a seed. Where scans then lie beside where the map shows what they saw
/// (FindMisplacedScans), it refines again with them there, and keeps that if fewer do; an alarm
/// tells of the others. Not after a calibration, nor with a solver of poses only. InvalidArgument
/// with the solver's message if it refuses its input.
Status RefineLog(const MapLogOptions& options, ThreadPool* pool, LogMapping* mapping);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_MAP_LOG_H_
