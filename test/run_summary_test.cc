#include "plumbline/apps/run_summary.h"

#include <gflags/gflags.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "plumbline/apps/flags.h"
#include "plumbline/test/temp_file.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;

RunSummary MakeSummary() {
  RunSummary summary;
  summary.log = "a.clf";
  summary.num_scans = 150;
  summary.num_returns = 54000;
  summary.num_skipped_records = 2;
  summary.seeding.sequential.num_key_scans = 7;
  summary.seeding.sequential.odometry_sign.sign_lost = true;
  summary.seeding.loops.num_closures = 3;
  summary.solver.solver = "alternating_cg";
  summary.solver.termination = TerminationType::kConverged;
  summary.solver.message = "said \"enough\"";
  summary.solver.final_marginal_energy = 0.1 + 0.2;
  summary.solver.rounds.resize(2);
  summary.solver.rounds[1].num_lines = 11;
  summary.solver.iterations.resize(3);
  summary.solver.iterations[2].phase = "poses";
  summary.solver.terms[0].count = 1;
  summary.stages.resize(2);
  summary.stages[0].name = "odometry";
  summary.stages[1].name = "seed";
  summary.stages[1].error = TruthError{0.25, 0.5, 0.125};
  return summary;
}

Json WriteAndRead(const RunSummary& summary) {
  const std::string path = TempFolder() + "summary.json";
  const Status status = WriteRunSummary(path, summary);
  EXPECT_TRUE(status.ok()) << status.message();
  return Json::parse(ReadFile(path));
}

TEST(RunSummaryTest, ReadsBackAsWritten) {
  const Json json = WriteAndRead(MakeSummary());
  EXPECT_EQ(json["log"], "a.clf");
  EXPECT_EQ(json["scans"], 150);
  EXPECT_EQ(json["returns"], 54000);
  EXPECT_EQ(json["skipped_records"], 2);
  EXPECT_EQ(json["seeding"]["key_scans"], 7);
  EXPECT_EQ(json["seeding"]["odometry_sign_lost"], true);
  EXPECT_EQ(json["seeding"]["loop_closures"], 3);
  const Json& solver = json["solver"];
  EXPECT_EQ(solver["solver"], "alternating_cg");
  EXPECT_EQ(solver["termination"], "converged");
  EXPECT_EQ(solver["message"], "said \"enough\"");
  EXPECT_EQ(solver["marginal_energy_final"].get<double>(), 0.1 + 0.2);  // to the last bit
  EXPECT_EQ(solver["rounds"].size(), 2u);
  EXPECT_EQ(solver["rounds"][1]["lines"], 11);
  EXPECT_EQ(solver["iterations"][2]["phase"], "poses");
  ASSERT_EQ(solver["terms_of_last_round"].size(), static_cast<std::size_t>(kNumTerms));
  EXPECT_EQ(solver["terms_of_last_round"][0]["term"], ToString(static_cast<Term>(0)));
  EXPECT_EQ(solver["terms_of_last_round"][0]["count"], 1);
  EXPECT_GT(json["peak_memory_bytes"], 1000000);
}

TEST(RunSummaryTest, StagesHaveErrorsWhereTheTruthIsKnown) {
  const Json stages = WriteAndRead(MakeSummary())["stages"];
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_EQ(stages[0]["stage"], "odometry");
  EXPECT_FALSE(stages[0].contains("mean_pose_error_m"));
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
  EXPECT_EQ(WriteRunSummary(TempFolder() + "none/summary.json", MakeSummary()).code(),
            StatusCode::kNotFound);
}

}  // namespace
}  // namespace plumbline
