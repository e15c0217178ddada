#include "plumbline/apps/benchmark/synthetic_experiment.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "plumbline/apps/benchmark/known_walls.h"
#include "plumbline/apps/benchmark/match_graph.h"
#include "plumbline/apps/benchmark/plain_icp.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/front_end/global_icp.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/pose_graph/stochastic_descent.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

// What a user would tell of the laser.
MapLogOptions OptionsFor(const SyntheticNoise& noise, MapLogOptions options) {
  options.solver.factors.beam.sigma_range_m = noise.sigma_range_m;
  options.solver.factors.beam.sigma_bearing_rad = noise.sigma_bearing_rad;
  options.solver.num_threads = 1;
  return options;
}

// The odometry's true noise too, its systematic errors taken as random ones.
FactorOptions ExactFactorsFor(const SyntheticNoise& noise, FactorOptions factors) {
  const OdometryNoise odometry = noise.Odometry();
  factors.motion.rotation_per_rotation = odometry.rotation_per_rotation;
  factors.motion.rotation_per_translation_rad_m =
      std::hypot(odometry.rotation_per_translation_rad_m, odometry.heading_drift_rad_m);
  factors.motion.translation_per_translation =
      std::hypot(odometry.translation_per_translation, odometry.scale_error);
  factors.motion.translation_per_rotation_m_rad = odometry.translation_per_rotation_m_rad;
  factors.motion.translation_floor_m = 1e-3;
  factors.motion.rotation_floor_rad = 1e-3;
  return factors;
}

class MapMaker {
 public:
  MapMaker(const SyntheticDrive& drive, const SyntheticNoise& noise, const MapLogOptions& options,
           std::array<MapEstimate, kNumMappers>* maps)
      : drive_(drive),
        noise_(noise),
        options_(OptionsFor(noise, options)),
        factors_(options_.solver.factors),
        maps_(*maps) {}

  Status Run() {
    PutRaw(Mapper::kOdometry, PosesOf(drive_.graph.initial_poses()));
    PutRaw(Mapper::kTruePoses, drive_.truth.poses);
    const FactorOptions exact = ExactFactorsFor(noise_, factors_);
    Map(Mapper::kKnownAssociation) = EstimateGivenTruth(drive_, exact, Told::kWhoseReturn);
    Map(Mapper::kKnownDirections) = EstimateGivenTruth(drive_, exact, Told::kDirections);
    Map(Mapper::kKnownWalls) = EstimateGivenTruth(drive_, exact, Told::kWalls);
    MatchScans();
    PLUMBLINE_RETURN_IF_ERROR(RunPublished());
    return Refine();
  }

 private:
  MapEstimate& Map(Mapper mapper) { return maps_[static_cast<int>(mapper)]; }

  void PutRaw(Mapper mapper, const std::vector<Pose2>& poses) {
    Map(mapper) = {poses, PlacedReturns(drive_.graph, poses)};
  }

  // ICP as the paper compares it, and two back ends on one front end.
  void MatchScans() {
    const PlainIcp scans(drive_.graph);
    PutRaw(Mapper::kPlainIcp, ChainEdges(drive_.graph, scans.MatchConsecutive(PlainIcpOptions())));
    const MatchGraph matches = BuildMatchGraph(scans, MatchGraphOptions());
    std::vector<Pose2> poses = matches.chain;
    DescendStochastically(matches.edges, &poses);
    PutRaw(Mapper::kOlson, poses);
    poses = matches.chain;
    OptimizePoseGraph(matches.edges, {}, &poses);
    PutRaw(Mapper::kGaussNewton, poses);
  }

  Status Refine() {
    LogMapping mapping;
    PLUMBLINE_RETURN_IF_ERROR(MapLog(options_, drive_.graph, {}, &mapping));
    PutRaw(Mapper::kSeed, PosesOf(mapping.start_poses));
    Map(Mapper::kPlumbline) = {PosesOf(mapping.state.poses), mapping.state.points};
    return Status::Ok();
  }

  Status RunPublished() {
    MapState state;
    state.poses = PoseArray(Map(Mapper::kPlainIcp).poses);
    state.points = drive_.graph.MeasuredMap(state.poses);
    const MeasuredSurface surface =
        MeasureSurface(drive_.graph, NormalOptionsFor(factors_.beam), &pool_);
    PLUMBLINE_RETURN_IF_ERROR(
        AlignScansGlobally(GlobalIcpOptionsFor(factors_.beam, IcpMetric::kPointToLine),
                           factors_.motion, surface, &pool_, drive_.graph, &state));
    PutRaw(Mapper::kPublishedStart, PosesOf(state.poses));
    SolverOptions options = options_.solver;
    options.type = SolverType::kPublished;
    const SolverSummary summary = RefineState(options, drive_.graph, &state);
    if (!summary.IsSolutionUsable()) return Status::InvalidArgument(summary.message);
    Map(Mapper::kPublished) = {PosesOf(state.poses), state.points};
    return Status::Ok();
  }

  const SyntheticDrive& drive_;
  const SyntheticNoise& noise_;
  const MapLogOptions options_;
  const FactorOptions factors_;
  std::array<MapEstimate, kNumMappers>& maps_;
  ThreadPool pool_{1};
};

// Means over stretches of beams, so that beams without a return do not move their neighbours.
std::vector<double> MeansOverStretches(const SlamGraph& graph, const std::vector<double>& errors) {
  std::vector<std::vector<double>> stretches(SyntheticOutcome::kNumStretches);
  const int num_beams = graph.LaserOfScan(0).num_beams;
  const int total = graph.num_scans() * num_beams;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    const int beam = graph.ScanOfReturn(r) * num_beams + graph.Beam(r);
    stretches[beam * SyntheticOutcome::kNumStretches / total].push_back(errors[r]);
  }
  std::vector<double> means;
  means.reserve(stretches.size());
  for (const std::vector<double>& stretch : stretches) {
    means.push_back(MeanAndVarianceOf(stretch).mean);
  }
  return means;
}

SyntheticOutcome OutcomeOf(const SyntheticDrive& drive, const MapEstimate& map) {
  const MapErrors errors = MeasureMapErrors(map, drive.truth);
  SyntheticOutcome outcome;
  outcome.pose_m = MeanAndVarianceOf(errors.pose_m);
  outcome.heading_rad = MeanAndVarianceOf(errors.heading_rad);
  outcome.point_m = MeanAndVarianceOf(errors.point_m);
  outcome.max_pose_m = *std::max_element(errors.pose_m.begin(), errors.pose_m.end());
  outcome.pose_errors_m = errors.pose_m;
  outcome.point_errors_m = MeansOverStretches(drive.graph, errors.point_m);
  return outcome;
}

}  // namespace

const char* ToString(Mapper mapper) {
  switch (mapper) {
    case Mapper::kPlainIcp:
      return "ICP (Besl & McKay)";
    case Mapper::kOlson:
      return "SG (Olson)";
    case Mapper::kPublished:
      return "published";
    case Mapper::kPublishedStart:
      return "published, its start";
    case Mapper::kSeed:
      return "Plumbline, seed";
    case Mapper::kPlumbline:
      return "Plumbline";
    case Mapper::kGaussNewton:
      return "Gauss-Newton, edges of SG";
    case Mapper::kOdometry:
      return "odometry";
    case Mapper::kKnownAssociation:
      return "known association";
    case Mapper::kKnownDirections:
      return "known directions";
    case Mapper::kKnownWalls:
      return "known walls";
    case Mapper::kTruePoses:
      return "true poses, raw ranges";
  }
  return "?";
}

std::vector<SyntheticNoise> SyntheticNoises() {
  const double bearing_rad = DegToRad(0.1);
  return {{"20 mm", 0.02, bearing_rad, 1.0},
          {"30 mm", 0.03, bearing_rad, 1.0},
          {"50 mm", 0.05, bearing_rad, 1.0},
          // A bearing as uncertain as the beams are apart.
          {"beyond", 0.1, DegToRad(0.5), 3.5}};
}

Status MakeMaps(const SyntheticDrive& drive, const SyntheticNoise& noise,
                const MapLogOptions& options, std::array<MapEstimate, kNumMappers>* maps) {
  return MapMaker(drive, noise, options, maps).Run();
}

Status RunSyntheticExperiment(int num_seeds, const std::vector<SyntheticNoise>& noises,
                              const MapLogOptions& options, ThreadPool* pool,
                              std::vector<SyntheticOutcome>* outcomes) {
  const std::size_t num_drives = noises.size() * static_cast<std::size_t>(num_seeds);
  std::vector<SyntheticOutcome> results(num_drives * kNumMappers);
  std::vector<Status> statuses(num_drives);
  pool->ForEachChunk(num_drives, 1, [&](std::size_t i, std::size_t, std::size_t) {
    const std::size_t noise = i % noises.size(), seed = i / noises.size() + 1;
    SyntheticDrive drive;
    std::array<MapEstimate, kNumMappers> maps;
    statuses[i] = MakeSyntheticDrive(seed, noises[noise], &drive);
    if (statuses[i].ok()) statuses[i] = MakeMaps(drive, noises[noise], options, &maps);
    if (!statuses[i].ok()) return;
    for (int m = 0; m < kNumMappers; ++m) {
      SyntheticOutcome& outcome = results[i * kNumMappers + m];
      outcome = OutcomeOf(drive, maps[m]);
      outcome.seed = seed;
      outcome.noise = static_cast<int>(noise);
      outcome.mapper = static_cast<Mapper>(m);
    }
  });
  for (const Status& status : statuses) PLUMBLINE_RETURN_IF_ERROR(status);
  *outcomes = std::move(results);
  return Status::Ok();
}

std::vector<SyntheticSummary> SummariseOutcomes(const std::vector<SyntheticOutcome>& outcomes) {
  std::map<std::pair<int, Mapper>, std::vector<const SyntheticOutcome*>> groups;
  for (const SyntheticOutcome& outcome : outcomes) {
    groups[{outcome.noise, outcome.mapper}].push_back(&outcome);
  }
  std::vector<SyntheticSummary> summaries;
  for (const auto& [key, runs] : groups) {
    SyntheticSummary summary;
    summary.noise = key.first;
    summary.mapper = key.second;
    summary.num_runs = static_cast<int>(runs.size());
    std::vector<double> values[5];
    for (const SyntheticOutcome* run : runs) {
      summary.num_failures += run->Failed() ? 1 : 0;
      const double figures[] = {run->pose_m.mean, run->pose_m.variance, run->point_m.mean,
                                run->point_m.variance, run->heading_rad.mean};
      for (int i = 0; i < 5; ++i) values[i].push_back(figures[i]);
    }
    summary.pose_mean_m = QuartilesOf(values[0]);
    summary.pose_variance_m2 = QuartilesOf(values[1]);
    summary.point_mean_m = QuartilesOf(values[2]);
    summary.point_variance_m2 = QuartilesOf(values[3]);
    summary.heading_mean_rad = QuartilesOf(values[4]);
    summaries.push_back(summary);
  }
  return summaries;
}

std::uint64_t MedianSeed(const std::vector<SyntheticOutcome>& outcomes, int noise, Mapper mapper) {
  std::vector<std::pair<double, std::uint64_t>> errors;
  for (const SyntheticOutcome& run : outcomes) {
    if (run.noise == noise && run.mapper == mapper) errors.push_back({run.pose_m.mean, run.seed});
  }
  std::sort(errors.begin(), errors.end());
  return errors[(errors.size() - 1) / 2].second;
}

}  // namespace plumbline
