#include "plumbline/apps/report/report_json.h"

#include <nlohmann/json.hpp>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/program/command_line.h"

namespace plumbline {
namespace {

Json TermsJson(const SolverSummary& solver) {
  Json json = Json::array();
  for (const TermSummary& term : solver.terms) {
    json.push_back({{"term", term.name},
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

Json LandmarkRoundsJson(const SolverSummary& solver) {
  Json json = Json::array();
  for (const LandmarkRoundSummary& round : solver.landmark_rounds) {
    json.push_back({{"gate_sigmas", round.gate_sigmas},
                    {"landmarks", round.num_landmarks},
                    {"observations", round.num_observations},
                    {"cost_before", round.initial_cost},
                    {"cost_after", round.final_cost},
                    {"moved_sigmas", round.moved_sigmas}});
  }
  return json;
}

Json RoundEnergiesJson(const SolverSummary& solver) {
  Json json = Json::array();
  for (const RoundEnergy& row : solver.round_energies) {
    json.push_back({{"round", row.round},
                    {"iteration", row.iteration},
                    {"total_time_s", row.total_time_s},
                    {"marginal_energy", row.marginal_energy}});
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

Json PoseOnlyJson(const SolverSummary& solver) {
  return {{"solver", solver.solver},
          {"termination", ToString(solver.termination)},
          {"message", solver.message},
          {"relative_poses", solver.num_relative_poses},
          {"chi2_seed", solver.seed_chi2},
          {"chi2_final", solver.final_chi2},
          {"marginal_energy_final", solver.final_marginal_energy},
          {"round_energies", RoundEnergiesJson(solver)},
          {"time_s", {{"total", solver.total_time_s}}},
          {"iterations", IterationsJson(solver)}};
}

Json ConflictJson(const FreeSpaceConflict& conflict) {
  return {{"compared", conflict.num_compared},
          {"conflicting", conflict.num_conflicting},
          {"share", conflict.Share()}};
}

// Stretches put back, steps of the odometry downweighted, and edges ignored.
Json LocalJson(const SolverSummary& solver) {
  Json put_back = Json::array(), downweighted = Json::array(), ignored = Json::array();
  for (const WorseStretch& stretch : solver.put_back) {
    put_back.push_back({{"first_pose", stretch.first},
                        {"last_pose", stretch.last},
                        {"held_out_error_seed_sigma2", stretch.seed_error},
                        {"held_out_error_refused_sigma2", stretch.state_error}});
  }
  for (const DownweightedStep& step : solver.downweighted_steps) {
    downweighted.push_back({{"step", step.step}, {"sigmas_off_seed", step.sigma_factor}});
  }
  for (const IgnoredEdge& edge : solver.ignored_edges) {
    ignored.push_back({{"from", edge.from},
                       {"to", edge.to},
                       {"off_m", edge.off_m},
                       {"off_rad", edge.off_rad},
                       {"sigmas", edge.sigmas}});
  }
  return {{"put_back", put_back},
          {"downweighted_odometry_steps", downweighted},
          {"ignored_edges", ignored}};
}

Json AcceptanceJson(const AcceptanceTest& acceptance) {
  return {{"better", acceptance.IsBetter()},
          {"worse_stretches", acceptance.num_worse_stretches},
          {"landmark_energy_seed", acceptance.seed_energy},
          {"landmark_energy_final", acceptance.final_energy},
          {"held_out_returns", acceptance.num_held_out},
          {"held_out_error_seed_sigma2", acceptance.seed_held_out_error},
          {"held_out_error_final_sigma2", acceptance.final_held_out_error},
          {"held_out_noise_sigma2", acceptance.held_out_noise}};
}

}  // namespace

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

Json SolverJson(const SolverSummary& solver) {
  if (solver.num_relative_poses > 0) return PoseOnlyJson(solver);
  return {{"solver", solver.solver},
          {"termination", ToString(solver.termination)},
          {"message", solver.message},
          {"marginal_energy_final", solver.final_marginal_energy},
          {"round_energies", RoundEnergiesJson(solver)},
          {"started_from_constraints", solver.started_from_constraints},
          {"acceptance", AcceptanceJson(solver.acceptance)},
          {"local", LocalJson(solver)},
          {"terms", TermsJson(solver)},
          {"rounds", RoundsJson(solver)},
          {"landmark_rounds", LandmarkRoundsJson(solver)},
          {"point_displacement",
           {{"mean_m", solver.displacements.mean_m},
            {"max_m", solver.displacements.max_m},
            {"max_beam_sigmas", solver.displacements.max_beam_sigmas}}},
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
    Json row = {
        {"stage", stage.name}, {"wall_thickness_m", nullptr}, {"mean_map_entropy", nullptr}};
    if (stage.quality.num_samples > 0) {
      row["wall_thickness_m"] = stage.quality.wall_thickness_m;
      row["mean_map_entropy"] = stage.quality.mean_map_entropy;
    }
    if (stage.error) {
      row["mean_pose_error_m"] = stage.error->mean_pose_error_m;
      row["mean_pose_error_rad"] = stage.error->mean_pose_error_rad;
      row["mean_point_error_m"] = stage.error->mean_point_error_m;
    }
    json.push_back(row);
  }
  return json;
}

Json SharpnessJson(const std::vector<SharpnessAtRadius>& radii) {
  Json json = Json::array();
  for (const SharpnessAtRadius& at : radii) {
    json.push_back({{"radius_m", at.radius_m},
                    {"wall_thickness_m", at.quality.wall_thickness_m},
                    {"mean_map_entropy", at.quality.mean_map_entropy},
                    {"samples", at.quality.num_samples}});
  }
  return json;
}

Json ConsistencyJson(const MapConsistency& map) {
  Json json = {{"within_pass", ConflictJson(map.within_pass)},
               {"between_passes", ConflictJson(map.between_passes)},
               {"between_over_within", map.BetweenOverWithin()},
               {"worst_within", ConflictJson(map.worst_within.conflict)},
               {"worst_between", ConflictJson(map.worst_between.conflict)},
               {"worst_over_explicable", map.Ratio()},
               {"contradictory", map.IsContradictory()}};
  json["within_pass"]["pairs"] = map.num_pairs_within;
  json["between_passes"]["pairs"] = map.num_pairs_between;
  return json;
}

Json AlarmsJson(const std::vector<Alarm>& alarms) {
  Json json = Json::array();
  for (const Alarm& alarm : alarms) {
    json.push_back({{"scan", alarm.place.scan ? Json(*alarm.place.scan) : Json()},
                    {"time_s", alarm.place.time_s},
                    {"x_m", alarm.place.world_position.x()},
                    {"y_m", alarm.place.world_position.y()},
                    {"reason", alarm.reason},
                    {"wrong_share", alarm.wrong_share ? Json(*alarm.wrong_share) : Json()}});
  }
  return json;
}

Json WarningsJson(const std::vector<Warning>& warnings) {
  Json json = Json::array();
  for (const Warning& warning : warnings) {
    json.push_back({{"id", warning.id}, {"message", warning.message}});
  }
  return json;
}

Json StoppedByJson(const std::string& signal_name) {
  return signal_name.empty() ? Json() : Json(signal_name);
}

Status WriteJson(const std::string& path, const Json& json) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  file.stream() << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  return file.Commit();
}

}  // namespace plumbline
