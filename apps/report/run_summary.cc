#include "plumbline/apps/report/run_summary.h"

#include <sys/resource.h>

#include <map>
#include <nlohmann/json.hpp>

#include "plumbline/apps/report/calibration_report.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/seeding_text.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

// null for a pair of figures that the log was too short to tell.
Json RandomJson(const RandomError& error) {
  if (!error.estimated) return nullptr;
  return {{"spans", error.num_spans},
          {"sigma_per_sqrt_m", error.sigma_per_sqrt_m},
          {"sigma_per_sqrt_rad", error.sigma_per_sqrt_rad}};
}

Json SystematicJson(const SystematicError& error) {
  return {{"value", error.value}, {"sigma", error.sigma}, {"significant", error.IsSignificant()}};
}

Json MotionJson(const MotionOptions& motion) {
  Json json = Json::object();
  for (const MotionField& field : kMotionFields) json[field.name] = motion.*field.value;
  return json;
}

Json OdometryNoiseJson(const OdometryNoiseReport& noise) {
  return {{"gross_translation_scale", noise.gross_translation_scale},
          {"clock_offset_s",
           {{"value", noise.clock_offset.value_s},
            {"sigma", noise.clock_offset.sigma_s},
            {"significant", noise.clock_offset.IsSignificant()}}},
          {"translation_scale", SystematicJson(noise.translation_scale)},
          {"rotation_scale", SystematicJson(noise.rotation_scale)},
          {"heading_drift_rad_m", SystematicJson(noise.heading_drift_rad_m)},
          {"translation_m", RandomJson(noise.translation)},
          {"rotation_rad", RandomJson(noise.rotation)},
          {"leaps", noise.num_leaps},
          {"still_steps", noise.num_still_steps},
          {"is_prediction", noise.is_prediction},
          {"given_poses",
           {{"position_m", noise.given_poses.position_m}, {"yaw_rad", noise.given_poses.yaw_rad}}},
          {"motion", MotionJson(noise.motion)}};
}

Json OutcomesJson(const LoopClosingReport& loops) {
  Json json = Json::object();
  for (const auto& [outcome, count] : CountOutcomes(loops)) json[ToString(outcome)] = count;
  return json;
}

Json SuspectStepsJson(const LoopClosingReport& loops) {
  Json json = Json::array();
  for (const SuspectStep& step : loops.suspect_steps) {
    json.push_back({{"first_pose_after", step.first_pose_after},
                    {"evidence", step.evidence},
                    {"broken", step.broken},
                    {"unmatched", step.unmatched},
                    {"turned_rad", step.turned_rad},
                    {"closures_across", step.num_closures_across},
                    {"alternatives", step.num_alternatives},
                    {"unresolved", step.IsUnresolved()}});
  }
  return json;
}

Json HypothesesJson(const std::vector<WeighedHypothesis>& hypotheses) {
  Json json = Json::array();
  for (const WeighedHypothesis& hypothesis : hypotheses) {
    Json row = {{"hypothesis", ToString(hypothesis.kind)},
                {"closures", hypothesis.num_closures},
                {"compared_returns", hypothesis.conflict.num_compared},
                {"conflicting_returns", hypothesis.conflict.num_conflicting},
                {"score", hypothesis.score},
                {"adopted", hypothesis.adopted}};
    if (hypothesis.kind == HypothesisKind::kWithoutCluster ||
        hypothesis.kind == HypothesisKind::kWithMatch) {
      row["later_poses"] = {hypothesis.first_later_pose, hypothesis.last_later_pose};
      row["earlier_poses"] = {hypothesis.first_earlier_pose, hypothesis.last_earlier_pose};
    }
    if (hypothesis.kind == HypothesisKind::kJoinedParts) {
      const Pose2& step = hypothesis.carried_to;
      row["first_pose_after"] = hypothesis.first_pose_after;
      row["carried_to"] = {step.x, step.y, step.yaw};
    }
    json.push_back(row);
  }
  return json;
}

Json SweepOrderJson(const std::optional<SweepOrder>& order) {
  return order ? Json(ToString(*order)) : Json();
}

Json FrozenLaserJson(const std::vector<FrozenStretch>& frozen) {
  Json json = Json::array();
  for (const FrozenStretch& stretch : frozen) {
    json.push_back({{"first_scan", stretch.first_scan},
                    {"last_scan", stretch.last_scan},
                    {"repeated_scans", stretch.num_repeated},
                    {"moved_m", stretch.moved_m},
                    {"turned_rad", stretch.turned_rad}});
  }
  return json;
}

Json SeedingJson(const RunSummary& summary) {
  const SequentialSeedingReport& sequential = summary.mapping.seeding.sequential;
  return {{"start", ToString(summary.mapping.seeding.start)},
          {"keyframes", sequential.num_keyframes},
          {"recovered_scans", sequential.num_recovered},
          {"unmatched_scans", sequential.num_unmatched},
          {"odometry_sign_lost", sequential.odometry_sign.sign_lost},
          {"reversed_steps", sequential.num_reversed_steps},
          {"odometry_noise", OdometryNoiseJson(summary.mapping.seeding.odometry_noise)},
          {"loop_candidates", summary.mapping.seeding.loops.num_candidates},
          {"loop_closures", summary.mapping.seeding.loops.num_closures},
          {"closure_outcomes", OutcomesJson(summary.mapping.seeding.loops)},
          {"suspect_steps", SuspectStepsJson(summary.mapping.seeding.loops)},
          {"hypotheses", HypothesesJson(summary.mapping.seeding.hypotheses)},
          {"range_noise_m", summary.mapping.range_noise_m},
          {"moving_share", summary.mapping.seeding.moving_share},
          {"frozen_laser", FrozenLaserJson(summary.mapping.frozen_laser)},
          {"sweep_order", SweepOrderJson(summary.mapping.sweep_order)},
          {"alarm", summary.mapping.seeding.alarm},
          {"time_s", summary.seed_time_s}};
}

Json ProcessesJson(const std::vector<ProcessSummary>& processes) {
  Json json = Json::array();
  for (const ProcessSummary& process : processes) {
    json.push_back({{"poses", process.num_poses},
                    {"returns", process.num_returns},
                    {"peak_memory_bytes", process.peak_memory_bytes},
                    {"estimation",
                     {{"sums", process.traffic.num_sums},
                      {"sum_bytes", process.traffic.sum_bytes},
                      {"messages", process.traffic.num_messages},
                      {"message_bytes", process.traffic.message_bytes},
                      {"time_s", process.traffic.time_s}}}});
  }
  return json;
}

}  // namespace

std::vector<ProcessSummary> ProcessSummaries(const SlamGraph& graph, const PeersTraffic& traffic) {
  ProcessSummary own;
  for (int pose = 0; pose < graph.num_poses(); ++pose) own.num_poses += graph.HasScansOf(pose);
  own.num_returns = graph.num_returns();
  own.peak_memory_bytes = PeakMemoryBytes();
  own.traffic = traffic;
  return JoinOverPeers(graph.peers(), std::vector<ProcessSummary>{own});
}

std::size_t PeakMemoryBytes() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

Json RunSummaryJson(const RunSummary& summary) {
  return {
      {"log", summary.log},
      {"scans", summary.num_scans},
      {"returns", summary.num_returns},
      {"skipped_records", summary.num_skipped_records},
      {"no_return_level_m", summary.no_return_level_m ? Json(*summary.no_return_level_m) : Json()},
      {"read_time_s", summary.read_time_s},
      {"alarm", !summary.mapping.alarms.empty()},
      {"alarm_reasons", AlarmsJson(summary.mapping.alarms)},
      {"consistency",
       {{"seed", ConsistencyJson(summary.mapping.seeding.consistency)},
        {"refined", ConsistencyJson(summary.mapping.consistency)}}},
      {"seeding", SeedingJson(summary)},
      {"solver", SolverJson(summary.mapping.solver)},
      {"misplaced_poses", summary.mapping.misplaced_poses},
      {"calibration", CalibrationJson(summary.mapping.calibration)},
      {"stages", StagesJson(summary.stages)},
      {"stopped_by", StoppedByJson(summary.stopped_by)},
      {"warnings", WarningsJson(summary.warnings)},
      {"peak_memory_bytes", PeakMemoryBytes()},
      {"processes", ProcessesJson(summary.processes)},
      {"flags", FlagsInForce()}};
}

}  // namespace plumbline
