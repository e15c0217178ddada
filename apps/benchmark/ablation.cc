#include "plumbline/apps/benchmark/ablation.h"

#include <cmath>
#include <cstddef>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "plumbline/apps/benchmark/synthetic_drive.h"
#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/core/map_quality.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/marginal_energy.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

// Factor on the sigmas of a term that leaves nothing of it.
constexpr double kOff = 1e4;

AblationVariant Scaled(const std::string& name, const SolverOptions& full, double factor) {
  AblationVariant variant{name, full};
  variant.options.association.landmark_size_m *= factor;
  variant.options.rounds.coarse_radius_m *= factor;
  variant.options.rounds.fine_radius_m *= factor;
  return variant;
}

void SwitchOffMotion(MotionOptions* motion) {
  for (const MotionField& field : kMotionFields) motion->*field.value *= kOff;
}

AblationOutcome Measure(const AblationInput& input, const MapState& state, ThreadPool* pool) {
  AblationOutcome outcome;
  if (!input.truth.poses.empty()) {
    const MapErrors errors = MeasureMapErrors({PosesOf(state.poses), state.points}, input.truth);
    outcome.pose_m = MeanAndVarianceOf(errors.pose_m).mean;
    PoseErrors fitted(StatisticsConvention::kEvo);
    fitted.AddFitted(input.truth.poses, PosesOf(state.poses));
    outcome.fitted_pose_m = fitted.Statistics().translation_m.mean;
    outcome.point_m = MeanAndVarianceOf(errors.point_m).mean;
  }
  if (!input.relations.empty()) {
    outcome.relations_m =
        MeasureRelations(input.relations, TrajectoryOf(input.graph, state), RelationsOptions())
            .all.translation_m.mean;
  }
  const MapQuality quality = MeasureMapQuality(state.points, MapQualityOptions(), pool);
  outcome.thickness_m = quality.wall_thickness_m;
  outcome.entropy = quality.mean_map_entropy;
  const MeasuredSurface surface =
      MeasureSurface(input.graph, NormalOptionsFor(input.full.factors.beam), pool);
  outcome.energy = MarginalEnergy(input.graph, state.poses, surface, input.full, pool);
  return outcome;
}

Status SeedInput(ThreadPool* pool, AblationInput* input) {
  MapLogOptions options;
  options.solver = input->full;
  LogMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, std::move(input->graph), pool, &mapping));
  PLUMBLINE_RETURN_IF_ERROR(SeedLog(options, {}, pool, &mapping));
  input->full = RefinementOptions(options, mapping);
  input->graph = std::move(mapping.graph);
  input->seed = std::move(mapping.state);
  input->seed.points = input->graph.MeasuredMap(input->seed.poses);
  return Status::Ok();
}

std::vector<std::string> RowNames() {
  std::vector<std::string> names = {"seed"};
  for (const AblationVariant& variant : AblationVariants(SolverOptions())) {
    names.push_back(variant.name);
  }
  return names;
}

// Makes and ablates inputs, each on one thread.
template <typename MakeInput>
Status AblateEach(int num_inputs, const MakeInput& make_input, ThreadPool* pool,
                  AblationTable* table) {
  std::vector<Status> statuses(num_inputs);
  std::vector<std::vector<AblationOutcome>> outcomes(num_inputs);
  pool->ForEachChunk(num_inputs, 1, [&](std::size_t i, std::size_t, std::size_t) {
    ThreadPool single(1);
    AblationInput input;
    statuses[i] = make_input(i + 1, &input);
    if (statuses[i].ok()) statuses[i] = SeedInput(&single, &input);
    input.full.num_threads = 1;
    if (statuses[i].ok()) statuses[i] = RunAblation(input, &single, &outcomes[i]);
  });
  for (const Status& status : statuses) PLUMBLINE_RETURN_IF_ERROR(status);
  table->names = RowNames();
  table->outcomes = std::move(outcomes);
  return Status::Ok();
}

struct OutcomeFigure {
  const char* name;
  double AblationOutcome::*value;
  double unit;  // of the text; files are in m
  int precision;
};
constexpr OutcomeFigure kOutcomeFigures[] = {
    {"pose_error_m", &AblationOutcome::pose_m, 1e3, 2},
    {"fitted_pose_error_m", &AblationOutcome::fitted_pose_m, 1e3, 2},
    {"map_error_m", &AblationOutcome::point_m, 1e3, 2},
    {"relations_m", &AblationOutcome::relations_m, 1e3, 2},
    {"wall_thickness_m", &AblationOutcome::thickness_m, 1e3, 2},
    {"mean_map_entropy", &AblationOutcome::entropy, 1.0, 3},
    {"marginal_energy", &AblationOutcome::energy, 1.0, 0}};

// Over the inputs, of one row.
double MedianOf(const AblationTable& table, std::size_t row, const OutcomeFigure& figure) {
  std::vector<double> values;
  for (const std::vector<AblationOutcome>& input : table.outcomes) {
    if (!std::isnan(input[row].*figure.value)) values.push_back(input[row].*figure.value);
  }
  return QuartilesOf(values).median;
}

}  // namespace

std::vector<AblationVariant> AblationVariants(const SolverOptions& full) {
  std::vector<AblationVariant> variants = {{"full", full}};
  const auto add = [&](const char* name) -> SolverOptions& {
    variants.push_back({name, full});
    return variants.back().options;
  };
  add("no manifold potential").factors.manifold.sigma_m *= kOff;
  add("no odometry");
  SwitchOffMotion(&variants.back().options.factors.motion);
  add("with shape potential").factors.shape = true;
  add("lines fixed within a round").reduced.lines_follow = false;
  add("lines of a single scan too").association.several_poses = false;
  add("no robust loss").factors.manifold.robust_gate_sigmas = kOff;
  variants.push_back(Scaled("neighbourhoods of half the size", full, 0.5));
  variants.push_back(Scaled("neighbourhoods of twice the size", full, 2.0));
  add("alternating CG").type = SolverType::kAlternatingCg;
  add("alternating CG, shape potential").type = SolverType::kAlternatingCg;
  variants.back().options.factors.shape = true;
  add("alternating CG without the scans' turn").type = SolverType::kAlternatingCg;
  variants.back().options.alternating_cg.scan_iterations_per_sweep = 0;
  add("published method, from the seed").type = SolverType::kPublished;
  add("Ceres over points, iterative Schur").type = SolverType::kCeres;
  variants.back().options.ceres->linear_solver_type = ceres::ITERATIVE_SCHUR;
  variants.back().options.ceres->preconditioner_type = ceres::SCHUR_JACOBI;
  variants.push_back({"Ceres over lines, iterative Schur", variants.back().options});
  variants.back().options.ceres->reduced = true;
  return variants;
}

Status RunAblation(const AblationInput& input, ThreadPool* pool,
                   std::vector<AblationOutcome>* outcomes) {
  std::vector<AblationOutcome> results = {Measure(input, input.seed, pool)};
  for (const AblationVariant& variant : AblationVariants(input.full)) {
    MapState state = input.seed;
    const SolverSummary summary = RefineState(variant.options, input.graph, &state);
    if (!summary.IsSolutionUsable()) {
      return Status::InvalidArgument(variant.name + ": " + summary.message);
    }
    results.push_back(Measure(input, state, pool));
  }
  *outcomes = std::move(results);
  return Status::Ok();
}

Status AblateSyntheticDrives(int num_seeds, const SolverOptions& full, ThreadPool* pool,
                             AblationTable* table) {
  const SyntheticNoise noise{"30 mm", 0.03, DegToRad(0.1), 1.0};
  const auto make_input = [&](std::size_t seed, AblationInput* input) {
    SyntheticDrive drive;
    PLUMBLINE_RETURN_IF_ERROR(MakeSyntheticDrive(seed, noise, &drive));
    input->graph = std::move(drive.graph);
    input->truth = std::move(drive.truth);
    input->full = full;
    input->full.factors.beam.sigma_range_m = noise.sigma_range_m;
    input->full.factors.beam.sigma_bearing_rad = noise.sigma_bearing_rad;
    return Status::Ok();
  };
  table->inputs = "drives of 16 scans, 30 mm range noise";
  return AblateEach(num_seeds, make_input, pool, table);
}

Status AblateBuildings(int num_buildings, const SolverOptions& full, ThreadPool* pool,
                       AblationTable* table) {
  const auto make_input = [&](std::size_t seed, AblationInput* input) {
    SimulatedLog log;
    PLUMBLINE_RETURN_IF_ERROR(
        Simulate(World(GenerateBuilding(BuildingKind::kRandom, seed)), SimulationOptions(), &log));
    PLUMBLINE_RETURN_IF_ERROR(MakeGraph(log, &input->graph));
    input->truth = TruthOf(log, input->graph);
    input->full = full;
    return Status::Ok();
  };
  table->inputs = "simulated buildings";
  return AblateEach(num_buildings, make_input, pool, table);
}

Status AblateLog(const std::string& name, AblationInput input, AblationTable* table) {
  ThreadPool pool(input.full.num_threads);
  std::vector<AblationOutcome> outcomes;
  PLUMBLINE_RETURN_IF_ERROR(SeedInput(&pool, &input));
  PLUMBLINE_RETURN_IF_ERROR(RunAblation(input, &pool, &outcomes));
  *table = {name, RowNames(), {std::move(outcomes)}};
  return Status::Ok();
}

std::string AblationText(const AblationTable& table) {
  std::ostringstream text;
  text << table.inputs << ", medians over " << table.outcomes.size()
       << "\n                                         pose mm fitted mm    map mm  relat. mm   "
          "wall mm   entropy    "
          "  energy\n";
  for (std::size_t row = 0; row < table.names.size(); ++row) {
    text << "  " << std::left << std::setw(36) << table.names[row] << std::right << std::fixed;
    for (const OutcomeFigure& figure : kOutcomeFigures) {
      const double value = figure.unit * MedianOf(table, row, figure);
      text << std::setw(figure.precision == 0 ? 12 : 10) << std::setprecision(figure.precision);
      if (std::isnan(value)) {
        text << '-';
      } else {
        text << value;
      }
    }
    text << '\n';
  }
  return text.str();
}

Status WriteAblationCsv(const std::string& path, const std::vector<AblationTable>& tables) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "inputs,input,variant";
  for (const OutcomeFigure& figure : kOutcomeFigures) out << ',' << figure.name;
  out << '\n' << std::setprecision(8);
  for (const AblationTable& table : tables) {
    for (std::size_t input = 0; input < table.outcomes.size(); ++input) {
      for (std::size_t row = 0; row < table.names.size(); ++row) {
        out << '"' << table.inputs << "\"," << input + 1 << ",\"" << table.names[row] << '"';
        for (const OutcomeFigure& figure : kOutcomeFigures) {
          const double value = table.outcomes[input][row].*figure.value;
          out << ',';
          if (!std::isnan(value)) out << value;
        }
        out << '\n';
      }
    }
  }
  return file.Commit();
}

Status WriteAblationJson(const std::string& path, const std::vector<AblationTable>& tables) {
  Json json = Json::array();
  for (const AblationTable& table : tables) {
    Json rows = Json::array();
    for (std::size_t row = 0; row < table.names.size(); ++row) {
      Json figures = {{"variant", table.names[row]}};
      for (const OutcomeFigure& figure : kOutcomeFigures)
        figures[figure.name] = MedianOf(table, row, figure);
      rows.push_back(figures);
    }
    json.push_back({{"inputs", table.inputs}, {"runs", table.outcomes.size()}, {"medians", rows}});
  }
  return WriteJson(path, json);
}

}  // namespace plumbline
