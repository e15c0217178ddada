#include "plumbline/apps/run_summary.h"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "plumbline/apps/command_line.h"
#include "plumbline/apps/io/atomic_file.h"

namespace plumbline {
namespace {

// Insertion order is easier on the reader than the alphabet.
using Json = nlohmann::ordered_json;

Json FlagsInForce() {
  Json json = Json::object();
  for (const gflags::CommandLineFlagInfo& flag : ProgramFlags()) {
    if (flag.type == "double") {
      json[flag.name] = std::stod(flag.current_value);
    } else if (flag.type == "int32") {
      json[flag.name] = std::stol(flag.current_value);
    } else if (flag.type == "bool") {
      json[flag.name] = flag.current_value == "true";
    } else {
      json[flag.name] = flag.current_value;
    }
  }
  return json;
}

Json SeedingJson(const RunSummary& summary) {
  const SequentialSeedingReport& sequential = summary.seeding.sequential;
  return {{"key_scans", sequential.num_key_scans},
          {"recovered_scans", sequential.num_recovered},
          {"unmatched_scans", sequential.num_unmatched},
          {"odometry_sign_lost", sequential.odometry_sign.sign_lost},
          {"reversed_steps", sequential.num_reversed_steps},
          {"loop_candidates", summary.seeding.loops.num_candidates},
          {"loop_closures", summary.seeding.loops.num_closures},
          {"dropped_loop_closures", summary.seeding.loops.num_contradicted},
          {"time_s", summary.seed_time_s}};
}

Json TermsJson(const SolverSummary& solver) {
  Json json = Json::array();
  for (int t = 0; t < kNumTerms; ++t) {
    const TermSummary& term = solver.terms[t];
    json.push_back({{"term", ToString(static_cast<Term>(t))},
                    {"count", term.count},
                    {"cost_before", term.initial_cost},
                    {"cost_after", term.final_cost}});
  }
  return json;
}

Json RoundsJson(const SolverSummary& solver) {
  Json json = Json::array();
  for (const RoundSummary& round : solver.rounds) {
    json.push_back({{"radius_m", round.radius_m},
                    {"gate_sigmas", round.gate_sigmas},
                    {"lines", round.num_lines},
                    {"shape_pairs", round.num_shape_pairs},
                    {"cost_before", round.initial_cost},
                    {"cost_after", round.final_cost},
                    {"marginal_energy", round.marginal_energy},
                    {"iterations", round.iterations},
                    {"stop_reason", round.stop_reason}});
  }
  return json;
}

Json IterationsJson(const SolverSummary& solver) {
  Json json = Json::array();
  for (const IterationSummary& it : solver.iterations) {
    json.push_back({{"iteration", it.iteration},
                    {"round", it.round},
                    {"phase", it.phase},
                    {"cost", it.cost},
                    {"total_time_s", it.total_time_s}});
  }
  return json;
}

Json SolverJson(const SolverSummary& solver) {
  return {{"solver", solver.solver},
          {"termination", ToString(solver.termination)},
          {"message", solver.message},
          {"marginal_energy_seed", solver.seed_marginal_energy},
          {"marginal_energy_final", solver.final_marginal_energy},
          {"terms_of_last_round", TermsJson(solver)},
          {"rounds", RoundsJson(solver)},
          {"time_s",
           {{"association", solver.association_time_s},
            {"setup", solver.setup_time_s},
            {"minimisation", solver.solve_time_s},
            {"total", solver.total_time_s}}},
          {"iterations", IterationsJson(solver)}};
}

Json StagesJson(const std::vector<Stage>& stages) {
  Json json = Json::array();
  for (const Stage& stage : stages) {
    Json row = {{"stage", stage.name},
                {"wall_thickness_m", stage.quality.wall_thickness_m},
                {"mean_map_entropy", stage.quality.mean_map_entropy}};
    if (stage.error) {
      row["mean_pose_error_m"] = stage.error->mean_pose_error_m;
      row["mean_pose_error_rad"] = stage.error->mean_pose_error_rad;
      row["mean_point_error_m"] = stage.error->mean_point_error_m;
    }
    json.push_back(row);
  }
  return json;
}

}  // namespace

std::size_t PeakMemoryBytes() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

Status WriteRunSummary(const std::string& path, const RunSummary& summary) {
  const Json json = {{"log", summary.log},
                     {"scans", summary.num_scans},
                     {"returns", summary.num_returns},
                     {"skipped_records", summary.num_skipped_records},
                     {"read_time_s", summary.read_time_s},
                     {"seeding", SeedingJson(summary)},
                     {"solver", SolverJson(summary.solver)},
                     {"stages", StagesJson(summary.stages)},
                     {"peak_memory_bytes", PeakMemoryBytes()},
                     {"flags", FlagsInForce()}};
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  // A path need not be UTF-8; JSON must be.
  file.stream() << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  return file.Commit();
}

}  // namespace plumbline
