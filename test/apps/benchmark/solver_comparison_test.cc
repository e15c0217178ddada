#include "plumbline/apps/benchmark/solver_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/benchmark/comparison_report.h"
#include "plumbline/solvers/full/ceres_solver.h"
#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// A run whose map has some sharpness.
SolverRun RunOf(const std::string& solver, std::vector<TracePoint> trace, std::size_t peak_bytes) {
  SolverRun run;
  run.solver = solver;
  run.trace = std::move(trace);
  run.peak_memory_bytes = peak_bytes;
  run.termination = "converged";
  run.raw_ranges.radii = run.points.radii = {{0.15, {0.01, -4.0, 100}}};
  return run;
}

SolverRun Failed(const std::string& solver) {
  SolverRun run;
  run.solver = solver;
  run.failure = "ended by signal 9 (Killed)";
  return run;
}

Comparison Synthetic() {
  Comparison comparison;
  comparison.input = "test";
  comparison.solvers = {{"fast", {}}, {"slow", {}}, {"dead", {}}};
  comparison.runs = {
      RunOf("fast", {{0.0, 0.0, 500.0}, {1.0, 1.0, 200.0}, {2.0, 2.0, 100.0}}, 1000000),
      RunOf("slow", {{0.0, 0.0, 500.0}, {4.0, 4.0, 300.0}, {8.0, 8.0, 200.01}, {12.0, 12.0, 200.0}},
            3000000),
      Failed("dead")};
  return comparison;
}

TEST(SolverComparisonTest, EverySolverIsThereOnceAndAcceptsItsOptions) {
  SolverOptions options;
  options.num_threads = 1;
  std::set<std::string> names;
  const std::vector<ComparedSolver> solvers = ComparedSolvers(options);
  for (const ComparedSolver& solver : solvers) {
    std::string error;
    EXPECT_TRUE(solver.options.Check(&error)) << error;
    EXPECT_TRUE(CheckCeresOptions(*solver.options.ceres).ok());
    EXPECT_EQ(solver.options.num_threads, 1);
    names.insert(solver.name);
  }
  EXPECT_EQ(solvers[0].options.type, SolverType::kReduced);
  EXPECT_EQ(names.size(), solvers.size());
  EXPECT_EQ(names.count("published"), 1u);
}

TEST(SolverComparisonTest, RatiosAreOfTheTimeToTheSolversOwnEnergy) {
  const Comparison comparison = Synthetic();
  const std::vector<SolverFigures> figures = SumUp(comparison.solvers, comparison.runs);
  ASSERT_EQ(figures.size(), 3u);
  // The slow one is within 0.01 % of its 200 after 8 s, the fast one after 1 s.
  EXPECT_EQ(figures[1].time_to_reach_s[1], 8.0);
  EXPECT_EQ(figures[0].time_to_reach_s[1], 1.0);
  EXPECT_EQ(figures[1].time_ratio, 8.0);
  EXPECT_EQ(figures[1].memory_ratio, 3.0);
  EXPECT_EQ(figures[0].time_ratio, 1.0);
  // It never reaches 100.
  EXPECT_EQ(figures[1].time_to_reach_s[0], std::nullopt);
  EXPECT_EQ(figures[2].median_run, nullptr);
  EXPECT_EQ(figures[0].time_to_reach_s[2], std::nullopt);
  EXPECT_EQ(BestEnergy(comparison.runs), 100.0);
}

TEST(SolverComparisonTest, FiguresAreMediansOverTheRunsThatSucceeded) {
  const std::vector<SolverRun> runs = {RunOf("a", {{0.0, 0.0, 9.0}, {5.0, 5.0, 1.0}}, 10),
                                       RunOf("a", {{0.0, 0.0, 9.0}, {3.0, 3.0, 1.0}}, 30),
                                       Failed("a"),
                                       RunOf("a", {{0.0, 0.0, 9.0}, {4.0, 4.0, 1.0}}, 20)};
  const SolverFigures figures = SumUp({{"a", {}}}, runs)[0];
  EXPECT_EQ(figures.time_s, 4.0);
  EXPECT_EQ(figures.median_run, &runs[3]);
  EXPECT_EQ(figures.peak_memory_bytes, 20.0);
  EXPECT_EQ(figures.failures.size(), 1u);
}

TEST(SolverComparisonTest, TheTableHasARowPerSolver) {
  const std::string table = ComparisonTable(Synthetic());
  EXPECT_THAT(table, AllOf(HasSubstr("\nfast "), HasSubstr("\nslow "),
                           HasSubstr("failed: ended by signal 9 (Killed)")));
  EXPECT_THAT(table.substr(table.find("\nslow ")), HasSubstr(" 200.0  100.000     8.0 "));
}

TEST(SolverComparisonTest, FilesHoldEveryIterationAndEveryFigure) {
  const std::string folder = TempFolder();
  const Comparison comparison = Synthetic();
  ASSERT_TRUE(WriteComparisonCsv(folder + "a.csv", comparison).ok());
  EXPECT_THAT(
      ReadFile(folder + "a.csv"),
      AllOf(StartsWith(
                "solver,repeat,iteration,time_s,cpu_time_s,marginal_energy,gap\n\"fast\",1,0,"),
            HasSubstr("\n\"slow\",1,2,8,8,200.01,100.01\n")));
  ASSERT_TRUE(WriteComparisonJson(folder + "a.json", comparison).ok());
  const auto json = nlohmann::json::parse(ReadFile(folder + "a.json"));
  ASSERT_EQ(json["solvers"].size(), 3u);
  EXPECT_EQ(json["solvers"][1]["time_over_reduced"], 8.0);
  EXPECT_EQ(json["solvers"][0]["time_to_final_energy_of_s"]["slow"], 1.0);
  EXPECT_TRUE(json["solvers"][1]["time_to_final_energy_of_s"]["fast"].is_null());
  EXPECT_EQ(json["solvers"][2]["failures"][0], "ended by signal 9 (Killed)");
  ASSERT_TRUE(WriteComparisonPlot(folder + "a.png", comparison).ok());
  EXPECT_EQ(Picture(folder + "a.png").width, 1200);
  HtmlReport page;
  AddComparison(comparison, &page);
  ASSERT_TRUE(WriteHtmlReport(folder + "a.html", page).ok());
  EXPECT_THAT(ReadFile(folder + "a.html"),
              AllOf(HasSubstr("<th scope=\"row\">slow</th><td>200</td><td>100.000 %</td>"),
                    HasSubstr("<td>failed: ended by signal 9 (Killed)</td>"),
                    HasSubstr("{\"label\":\"slow\",\"points\":[[")));
  EXPECT_EQ(NumFilesIn(folder), 4);
}

TEST(SolverComparisonTest, AllSolversRunFromOneSeed) {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.02, room.graph, &room.state);
  SolverOptions options;
  options.rounds.max_coarse_rounds = 0;
  options.rounds.max_fine_rounds = 1;
  Comparison comparison;
  comparison.options.repeats = 2;
  comparison.solvers = ComparedSolvers(options);
  int num_done = 0;
  comparison.runs = CompareSolvers(
      comparison.solvers, {}, comparison.options, [&](const SolverRun&) { ++num_done; }, room.graph,
      room.state);
  ASSERT_EQ(comparison.runs.size(), 2 * comparison.solvers.size());
  EXPECT_EQ(num_done, static_cast<int>(comparison.runs.size()));
  for (const SolverRun& run : comparison.runs) {
    ASSERT_EQ(run.failure, "") << run.solver;
    EXPECT_EQ(run.trace[0].marginal_energy, comparison.runs[0].trace[0].marginal_energy);
    EXPECT_LT(run.final_energy(), run.trace[0].marginal_energy) << run.solver;
  }
  const std::string table = ComparisonTable(comparison);
  for (const ComparedSolver& solver : comparison.solvers) {
    EXPECT_THAT(table, HasSubstr("\n" + solver.name + " "));
  }
}

TEST(SolverComparisonTest, OptionsOutOfRangeAreNamed) {
  ComparisonOptions options;
  std::string error;
  EXPECT_TRUE(options.Check(&error));
  options.time_limit_s = 0.0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_THAT(error, HasSubstr("time_limit_s"));
  options = {};
  options.repeats = 0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_THAT(error, HasSubstr("repeats"));
}

}  // namespace
}  // namespace plumbline
