#include "plumbline/apps/benchmark/scaling_study.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iomanip>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <type_traits>

#include "plumbline/apps/benchmark/child_process.h"
#include "plumbline/apps/benchmark/memory_use.h"
#include "plumbline/apps/evaluation/trajectory_metrics.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/report/run_summary.h"
#include "plumbline/apps/report/units.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr double kScanSpacing = 0.11;      // [m]
constexpr std::uint64_t kSeed = 1;         // of building, drive and drift
constexpr std::uint32_t kDriftStream = 6;  // 0 to 5 belong to simulator, buildings and jumps

// A sum of waves along the path, zero at its start; root mean square about 1.
class SmoothDrift {
 public:
  explicit SmoothDrift(NoiseSource* source) {
    // From the length of a corridor between two crossings to that of several blocks [m].
    for (double& wavelength : wavelengths_m_) wavelength = 30.0 + 90.0 * source->Uniform();
  }
  double At(double path_m) const {
    double sum = 0.0;
    for (const double wavelength : wavelengths_m_) sum += std::sin(2.0 * kPi * path_m / wavelength);
    return sum * std::sqrt(2.0 / kNumWaves);
  }

 private:
  static constexpr int kNumWaves = 4;
  double wavelengths_m_[kNumWaves];
};

Status SimulateDrive(int num_scans, ScalingOutcome* outcome, SimulatedLog* log) {
  const double length_m = kScanSpacing * num_scans;
  const World world(GenerateLargeBuilding(length_m, kSeed));
  for (const Face& face : world.building().faces) {
    outcome->building_length_m = std::max(outcome->building_length_m, face.a.x());
  }
  SimulationOptions options;
  options.laser.num_beams = 300;
  options.laser.bearing_step_rad = DegToRad(0.6);
  options.scan_period_s = kScanSpacing / options.drive.speed_m_s;
  options.odometry_noise.heading_drift_rad_m = 0.0;
  options.odometry_noise.scale_error = 0.0;
  options.seed = kSeed;
  PLUMBLINE_RETURN_IF_ERROR(Simulate(world, options, log));
  // Turns on the spot give a few scans more than the length does.
  log->scans.resize(std::min<std::size_t>(log->scans.size(), num_scans));
  return Status::Ok();
}

// The true poses with a drift.
MapState DisturbedState(const std::vector<TimedPose>& truth, const SlamGraph& graph) {
  constexpr double kDriftM = 0.03, kDriftRad = 0.0035;
  NoiseSource source(kSeed, kDriftStream);
  const SmoothDrift x(&source), y(&source), yaw(&source);
  MapState state{graph.initial_poses(), {}};
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    const double path_m = kScanSpacing * pose;
    Pose2 drifted = truth[pose].world_from_robot;
    drifted.x += kDriftM * x.At(path_m);
    drifted.y += kDriftM * y.At(path_m);
    drifted.yaw += kDriftRad * yaw.At(path_m);
    state.SetPose(pose, drifted);
  }
  return state;
}

// The graph of a drive, a disturbed start, and the true poses; all else is freed on return.
Status MakeProblem(int num_scans, ScalingOutcome* outcome, SlamGraph* graph, MapState* state,
                   std::vector<TimedPose>* truth) {
  SimulatedLog log;
  PLUMBLINE_RETURN_IF_ERROR(SimulateDrive(num_scans, outcome, &log));
  PLUMBLINE_RETURN_IF_ERROR(MakeGraph(log, graph));
  for (const SimulatedScan& scan : log.scans) {
    truth->push_back(
        {scan.scan.timestamp_s, Between(log.scans[0].world_from_robot, scan.world_from_robot)});
  }
  *state = DisturbedState(*truth, *graph);
  return Status::Ok();
}

void MeasureErrors(const SlamGraph& graph, const MapState& state,
                   const std::vector<TimedPose>& truth, double* pose_error_m,
                   double* step_error_m) {
  TrajectoryMetricsOptions options;
  options.delta_m = 10.0;
  const TrajectoryMetrics metrics = MeasureTrajectory(TrajectoryOf(graph, state), truth, options);
  *pose_error_m = metrics.absolute.translation_m.mean;
  *step_error_m = metrics.relative_metres.translation_m.mean;
}

void Describe(const SolverSummary& summary, ScalingOutcome* outcome) {
  if (!summary.IsSolutionUsable()) outcome->failure = summary.message;
  outcome->time_s = summary.total_time_s;
  outcome->association_time_s = summary.association_time_s;
  outcome->minimization_time_s = summary.solve_time_s;
  outcome->num_rounds = static_cast<int>(summary.landmark_rounds.size());
  outcome->num_steps = static_cast<int>(summary.iterations.size());
  for (const IterationSummary& step : summary.iterations) {
    outcome->num_linear_iterations += step.evaluations;
  }
  if (summary.landmark_rounds.empty()) return;
  outcome->num_landmarks = summary.landmark_rounds.back().num_landmarks;
  outcome->num_observations = summary.landmark_rounds.back().num_observations;
}

// Calls visit(name, field) on every figure, in the order of the table's columns.
template <typename Outcome, typename Visit>
void VisitFigures(Outcome* outcome, const Visit& visit) {
  visit("returns", &outcome->num_returns);
  visit("building_length_m", &outcome->building_length_m);
  visit("simulation_time_s", &outcome->simulation_time_s);
  visit("time_s", &outcome->time_s);
  visit("cpu_time_s", &outcome->cpu_time_s);
  visit("association_time_s", &outcome->association_time_s);
  visit("minimization_time_s", &outcome->minimization_time_s);
  visit("rounds", &outcome->num_rounds);
  visit("steps", &outcome->num_steps);
  visit("cg_iterations", &outcome->num_linear_iterations);
  visit("landmarks", &outcome->num_landmarks);
  visit("observations", &outcome->num_observations);
  visit("graph_memory_bytes", &outcome->graph_memory_bytes);
  visit("peak_memory_bytes", &outcome->peak_memory_bytes);
  visit("pose_error_before_m", &outcome->pose_error_before_m);
  visit("pose_error_after_m", &outcome->pose_error_after_m);
  visit("step_error_before_m", &outcome->step_error_before_m);
  visit("step_error_after_m", &outcome->step_error_after_m);
}

// A dash for what a drive was too short to tell.
std::string MmCell(double value_m, int width) {
  std::ostringstream cell;
  cell << std::fixed << std::setprecision(2) << std::setw(width);
  if (std::isnan(value_m)) {
    cell << '-';
  } else {
    cell << kMmPerM * value_m;
  }
  return cell.str();
}

}  // namespace

ScalingOutcome RunScalingCase(int num_scans, const SolverOptions& options) {
  ScalingOutcome outcome;
  outcome.num_scans = num_scans;
  const auto start = Clock::now();
  SlamGraph graph;
  MapState state;
  std::vector<TimedPose> truth;
  const Status status = MakeProblem(num_scans, &outcome, &graph, &state, &truth);
  if (!status.ok()) {
    outcome.failure = status.message();
    return outcome;
  }
  outcome.simulation_time_s = SecondsSince(start);
  outcome.num_returns = graph.num_returns();
  MeasureErrors(graph, state, truth, &outcome.pose_error_before_m, &outcome.step_error_before_m);
  SolverOptions reduced = options;
  reduced.type = SolverType::kReduced;
  RestartPeakMemory();
  outcome.graph_memory_bytes = ResidentMemoryBytes();
  const std::clock_t cpu_start = std::clock();
  const SolverSummary summary = RefineState(reduced, graph, &state);
  outcome.cpu_time_s = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  outcome.peak_memory_bytes = PeakMemoryBytes();
  MeasureErrors(graph, state, truth, &outcome.pose_error_after_m, &outcome.step_error_after_m);
  Describe(summary, &outcome);
  return outcome;
}

ScalingOutcome RunScalingCaseInChild(int num_scans, const SolverOptions& options) {
  ScalingOutcome outcome;
  outcome.num_scans = num_scans;
  std::string packed;
  const Status status = RunInChild(
      [&] {
        const ScalingOutcome result = RunScalingCase(num_scans, options);
        json figures = {{"failure", result.failure}};
        VisitFigures(&result, [&](const char* name, auto* figure) { figures[name] = *figure; });
        return figures.dump(-1, ' ', false, json::error_handler_t::replace);
      },
      &packed);
  if (!status.ok()) {
    outcome.failure = status.message();
    return outcome;
  }
  const json figures = json::parse(packed);
  outcome.failure = figures["failure"].get<std::string>();
  VisitFigures(&outcome, [&](const char* name, auto* figure) {
    using Figure = std::decay_t<decltype(*figure)>;
    *figure = figures[name].is_null() ? std::numeric_limits<Figure>::quiet_NaN()
                                      : figures[name].get<Figure>();
  });
  return outcome;
}

Status ParseScanCounts(const std::string& text, std::vector<int>* counts) {
  std::vector<int> result;
  std::istringstream stream(text + ',');
  for (std::string word; std::getline(stream, word, ',');) {
    int count = 0;
    const char* end = word.data() + word.size();
    const auto parsed = std::from_chars(word.data(), end, count);
    if (parsed.ec != std::errc() || parsed.ptr != end || count <= 0) {
      return Status::InvalidArgument("'" + word + "' is not a positive number of scans");
    }
    result.push_back(count);
  }
  *counts = std::move(result);
  return Status::Ok();
}

std::string ScalingHeader() {
  return "Joint estimation alone, from the truth under a smooth drift of a few centimetres:\n"
         "   scans    returns  length m  seconds    CPU s  s/M ret.  rounds  steps  CG it.  graph "
         "MB  "
         "peak MB  B/return  "
         "pose error, mm: before   after  in 10 m: before   after\n";
}

std::string ScalingRow(const ScalingOutcome& outcome) {
  std::ostringstream row;
  row << std::setw(8) << outcome.num_scans << std::fixed;
  if (!outcome.failure.empty()) {
    row << "  failed: " << outcome.failure << '\n';
    return row.str();
  }
  row << std::setw(11) << outcome.num_returns << std::setprecision(0) << std::setw(10)
      << outcome.building_length_m << std::setprecision(2) << std::setw(9) << outcome.time_s
      << std::setw(9) << outcome.cpu_time_s << std::setprecision(3) << std::setw(10)
      << outcome.TimePerMillionReturns() << std::setw(8) << outcome.num_rounds << std::setw(7)
      << outcome.num_steps << std::setw(8) << outcome.num_linear_iterations << std::setprecision(0)
      << std::setw(10) << outcome.graph_memory_bytes / kBytesPerMb << std::setw(9)
      << outcome.peak_memory_bytes / kBytesPerMb << std::setw(10) << outcome.BytesPerReturn()
      << MmCell(outcome.pose_error_before_m, 24) << MmCell(outcome.pose_error_after_m, 8)
      << MmCell(outcome.step_error_before_m, 17) << MmCell(outcome.step_error_after_m, 8) << '\n';
  return row.str();
}

Status WriteScalingCsv(const std::string& path, const std::vector<ScalingOutcome>& outcomes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  const ScalingOutcome names;
  out << "scans,failure" << std::setprecision(8);
  VisitFigures(&names, [&](const char* name, auto*) { out << ',' << name; });
  out << '\n';
  for (const ScalingOutcome& outcome : outcomes) {
    out << outcome.num_scans << ",\"" << outcome.failure << '"';
    VisitFigures(&outcome, [&](const char*, auto* figure) {
      out << ',';
      if (outcome.failure.empty()) out << *figure;
    });
    out << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
