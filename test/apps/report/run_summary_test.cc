#include "plumbline/apps/report/run_summary.h"

#include <gflags/gflags.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "plumbline/apps/run/flags.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;

RunSummary MakeSummary() {
  RunSummary summary;
  summary.log = "a.clf";
  summary.num_scans = 150;
  summary.num_returns = 54000;
  summary.num_skipped_records = 2;
  summary.mapping.seeding.sequential.num_keyframes = 7;
  summary.mapping.seeding.sequential.odometry_sign.sign_lost = true;
  summary.mapping.seeding.loops.num_closures = 3;
  summary.mapping.seeding.loops.matches.resize(4);
  summary.mapping.seeding.loops.matches[3].outcome = ClosureOutcome::kAmbiguous;
  SuspectStep& suspect = summary.mapping.seeding.loops.suspect_steps.emplace_back();
  suspect.first_pose_after = 5;
  suspect.evidence = 0.75;
  suspect.broken = true;
  suspect.unmatched = true;
  suspect.turned_rad = 0.25;
  suspect.num_closures_across = 2;
  summary.mapping.seeding.odometry_noise.clock_offset = {-0.125, 0.002};
  summary.mapping.seeding.odometry_noise.rotation_scale = {0.03, 0.004};
  summary.mapping.seeding.odometry_noise.rotation = {true, 20, 0.0, 0.125};
  summary.mapping.seeding.consistency.between_passes = {200, 50};
  summary.mapping.consistency.within_pass = {400, 20};
  summary.mapping.consistency.num_pairs_within = 6;
  summary.mapping.solver.solver = "alternating_cg";
  summary.mapping.solver.termination = TerminationType::kConverged;
  summary.mapping.solver.message = "said \"enough\"";
  summary.mapping.solver.final_marginal_energy = 0.1 + 0.2;
  summary.mapping.solver.round_energies = {{0, 0, 0.0, 7.5}, {1, 2, 0.25, 5.5}};
  summary.mapping.solver.rounds.resize(2);
  summary.mapping.solver.rounds[1].num_lines = 11;
  summary.mapping.solver.iterations.resize(3);
  summary.mapping.solver.iterations[2].phase = "poses";
  summary.mapping.solver.terms.resize(2);
  summary.mapping.solver.terms[0].name = "motion";
  summary.mapping.solver.terms[0].count = 1;
  summary.mapping.solver.terms[1].name = "own";
  summary.stages.resize(2);
  summary.stages[0].name = "odometry";
  summary.stages[1].name = "seed";
  summary.stages[1].quality = {0.02, -3.5, 100};
  summary.stages[1].error = TruthError{0.25, 0.5, 0.125};
  return summary;
}

Json WriteAndRead(const RunSummary& summary) {
  const std::string path = TempFolder() + "summary.json";
  const Status status = WriteJson(path, RunSummaryJson(summary));
  EXPECT_TRUE(status.ok()) << status.message();
  return Json::parse(ReadFile(path));
}

TEST(RunSummaryTest, ReadsBackAsWritten) {
  const Json json = WriteAndRead(MakeSummary());
  EXPECT_EQ(json["log"], "a.clf");
  EXPECT_EQ(json["scans"], 150);
  EXPECT_EQ(json["returns"], 54000);
  EXPECT_EQ(json["skipped_records"], 2);
  EXPECT_EQ(json["seeding"]["keyframes"], 7);
  EXPECT_EQ(json["seeding"]["odometry_sign_lost"], true);
  EXPECT_EQ(json["seeding"]["loop_closures"], 3);
  const Json& solver = json["solver"];
  EXPECT_EQ(solver["solver"], "alternating_cg");
  EXPECT_EQ(solver["termination"], "converged");
  EXPECT_EQ(solver["message"], "said \"enough\"");
  EXPECT_EQ(solver["marginal_energy_final"].get<double>(), 0.1 + 0.2);  // to the last bit
  EXPECT_EQ(solver["round_energies"][0]["marginal_energy"], 7.5);
  EXPECT_EQ(solver["round_energies"][1],
            Json::parse(R"({"round": 1, "iteration": 2, "total_time_s": 0.25,
                            "marginal_energy": 5.5})"));
  EXPECT_EQ(solver["rounds"].size(), 2u);
  EXPECT_EQ(solver["rounds"][1]["lines"], 11);
  EXPECT_EQ(solver["iterations"][2]["phase"], "poses");
  ASSERT_EQ(solver["terms"].size(), 2u);
  EXPECT_EQ(solver["terms"][0]["term"], "motion");
  EXPECT_EQ(solver["terms"][0]["count"], 1);
  EXPECT_EQ(solver["terms"][1]["term"], "own");
  EXPECT_GT(json["peak_memory_bytes"], 1000000);
}

TEST(RunSummaryTest, TellsHowTheSeedingWent) {
  const Json seeding = WriteAndRead(MakeSummary())["seeding"];
  EXPECT_EQ(seeding["closure_outcomes"]["accepted"], 3);
  EXPECT_EQ(seeding["closure_outcomes"]["ambiguous"], 1);
  ASSERT_EQ(seeding["suspect_steps"].size(), 1u);
  const Json& suspect = seeding["suspect_steps"][0];
  EXPECT_EQ(suspect["first_pose_after"], 5);
  EXPECT_EQ(suspect["evidence"], 0.75);
  EXPECT_EQ(suspect["broken"], true);
  EXPECT_EQ(suspect["unmatched"], true);
  EXPECT_EQ(suspect["turned_rad"], 0.25);
  EXPECT_EQ(suspect["closures_across"], 2);
  EXPECT_EQ(suspect["unresolved"], false);
  const Json& noise = seeding["odometry_noise"];
  EXPECT_EQ(noise["clock_offset_s"]["value"], -0.125);
  EXPECT_EQ(noise["clock_offset_s"]["significant"], true);
  EXPECT_EQ(noise["rotation_scale"]["value"], 0.03);
  EXPECT_EQ(noise["rotation_scale"]["significant"], true);
  EXPECT_EQ(noise["heading_drift_rad_m"]["significant"], false);
  EXPECT_EQ(noise["rotation_rad"]["sigma_per_sqrt_rad"], 0.125);
  EXPECT_TRUE(noise["translation_m"].is_null());  // not estimated
}

TEST(RunSummaryTest, TellsWhetherTheMapIsTrusted) {
  RunSummary summary = MakeSummary();
  Json json = WriteAndRead(summary);
  EXPECT_EQ(json["alarm"], false);
  EXPECT_TRUE(json["alarm_reasons"].empty());
  EXPECT_TRUE(json["misplaced_poses"].empty());
  EXPECT_EQ(json["consistency"]["seed"]["between_passes"]["share"], 0.25);
  const Json& refined = json["consistency"]["refined"];
  EXPECT_EQ(refined["within_pass"]["share"], 0.05);
  EXPECT_EQ(refined["within_pass"]["pairs"], 6);
  EXPECT_EQ(refined["worst_over_explicable"], 1.0);
  EXPECT_EQ(refined["contradictory"], false);

  summary.mapping.misplaced_poses = {4, 5};
  summary.mapping.alarms = {{{7, 1.5, {2.0, -3.0}}, "it leaps", 0.25}};
  json = WriteAndRead(summary);
  EXPECT_EQ(json["misplaced_poses"], Json({4, 5}));
  EXPECT_EQ(json["alarm"], true);
  EXPECT_EQ(json["alarm_reasons"],
            Json::parse(R"([{"scan": 7, "time_s": 1.5, "x_m": 2.0, "y_m": -3.0,
                             "reason": "it leaps", "wrong_share": 0.25}])"));
  summary.mapping.alarms[0].wrong_share.reset();
  EXPECT_TRUE(WriteAndRead(summary)["alarm_reasons"][0]["wrong_share"].is_null());
  summary.mapping.alarms[0].place.scan.reset();
  EXPECT_TRUE(WriteAndRead(summary)["alarm_reasons"][0]["scan"].is_null());
}

TEST(RunSummaryTest, StagesHaveErrorsWhereTheTruthIsKnown) {
  const Json stages = WriteAndRead(MakeSummary())["stages"];
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_EQ(stages[0]["stage"], "odometry");
  EXPECT_FALSE(stages[0].contains("mean_pose_error_m"));
  EXPECT_TRUE(stages[0]["wall_thickness_m"].is_null());  // measured nowhere
  EXPECT_EQ(stages[1]["wall_thickness_m"], 0.02);
  EXPECT_EQ(stages[1]["mean_map_entropy"], -3.5);
  EXPECT_EQ(stages[1]["mean_pose_error_m"], 0.25);
  EXPECT_EQ(stages[1]["mean_pose_error_rad"], 0.5);
  EXPECT_EQ(stages[1]["mean_point_error_m"], 0.125);
}

TEST(RunSummaryTest, HoldsTheFlagsInForceAndNoOthers) {
  const gflags::FlagSaver saver;
  gflags::SetCommandLineOption("sigma_range_m", "0.03");
  gflags::SetCommandLineOption("cg_max_sweeps", "5");
  gflags::SetCommandLineOption("shape", "false");
  gflags::SetCommandLineOption("solver", "ceres");
  SolverOptions options;
  ASSERT_TRUE(SolverOptionsFromFlags(&options).ok());
  const Json flags = WriteAndRead(MakeSummary())["flags"];
  EXPECT_EQ(flags.at("sigma_range_m"), options.factors.beam.sigma_range_m);
  EXPECT_EQ(flags.at("cg_max_sweeps"), 5);
  EXPECT_EQ(flags.at("shape"), false);
  EXPECT_EQ(flags.at("solver"), "ceres");
  EXPECT_FALSE(flags.contains("logtostderr"));
  EXPECT_FALSE(flags.contains("help"));
}

TEST(RunSummaryTest, APathThatIsNotUtf8StillGivesJson) {
  RunSummary summary = MakeSummary();
  summary.log = "caf\xe9.clf";
  EXPECT_EQ(WriteAndRead(summary)["log"], "caf\xef\xbf\xbd.clf");
}

TEST(RunSummaryTest, ReportsAFolderThatDoesNotExist) {
  EXPECT_EQ(WriteJson(TempFolder() + "none/summary.json", RunSummaryJson(MakeSummary())).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
