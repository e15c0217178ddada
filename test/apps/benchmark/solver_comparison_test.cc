#include "plumbline/apps/benchmark/solver_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/benchmark/comparison_report.h"
#include "plumbline/solvers/interface/ceres_options.h"
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
  comparison.start = "seed";
  comparison.solvers = {{"fast", {}}, {"slow", {}}, {"dead", {}}};
  comparison.runs = {
      RunOf("fast", {{0, 0.0, 0.0, 500.0}, {1, 1.0, 1.0, 200.0}, {2, 2.0, 2.0, 100.0}}, 1000000),
      RunOf("slow",
            {{0, 0.0, 0.0, 500.0},
             {1, 4.0, 4.0, 300.0},
             {7, 8.0, 8.0, 200.01},
             {9, 12.0, 12.0, 200.0}},
            3000000),
      Failed("dead")};
  return comparison;
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
  const std::vector<SolverRun> runs = {RunOf("a", {{0, 0.0, 0.0, 9.0}, {1, 5.0, 5.0, 1.0}}, 10),
                                       RunOf("a", {{0, 0.0, 0.0, 9.0}, {1, 3.0, 3.0, 1.0}}, 30),
                                       Failed("a"),
                                       RunOf("a", {{0, 0.0, 0.0, 9.0}, {1, 4.0, 4.0, 1.0}}, 20)};
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
            HasSubstr("\n\"slow\",1,7,8,8,200.01,100.01\n")));
  ASSERT_TRUE(WriteComparisonJson(folder + "a.json", comparison).ok());
  const auto json = nlohmann::json::parse(ReadFile(folder + "a.json"));
  EXPECT_EQ(json["start"], "seed");
  ASSERT_EQ(json["solvers"].size(), 3u);
  EXPECT_EQ(json["solvers"][1]["time_over_first"], 8.0);
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

TEST(SolverComparisonTest, TheJsonHasTheLimitOfEachRow) {
  Comparison comparison;
  const Status status = ParseSolvers("ceres,ceres:lbfgs,alternating_cg,reduced", SolverOptions(),
                                     ComparisonLimits(), &comparison.solvers);
  ASSERT_TRUE(status.ok()) << status.message();
  const std::string path = TempFolder() + "a.json";
  ASSERT_TRUE(WriteComparisonJson(path, comparison).ok());
  const auto rows = nlohmann::json::parse(ReadFile(path))["solvers"];
  EXPECT_EQ(rows[0]["limit"]["ceres_max_num_iterations"], CeresOptions().max_num_iterations);
  EXPECT_EQ(rows[1]["limit"]["ceres_max_num_iterations"], 300);
  EXPECT_EQ(rows[2]["limit"]["cg_max_sweeps"], 100);
  EXPECT_TRUE(rows[3]["limit"].empty());
}

TEST(SolverComparisonTest, LongNamesKeepTheColumnsInLine) {
  Comparison comparison = Synthetic();
  const std::string name = "ceres reduced line_search nonlinear_conjugate_gradient polak_ribiere";
  comparison.solvers[1].name = comparison.runs[1].solver = name;
  std::istringstream table(ComparisonTable(comparison));
  std::string header, first, second;
  std::getline(table, header);
  std::getline(table, first);
  std::getline(table, second);
  EXPECT_EQ(second.find(name + " "), 0u);
  EXPECT_EQ(first.find("converged"), second.find("converged"));
}

// A small room, off its optimum, with edges for solvers of relative poses.
ComparedProblem SmallProblem() {
  NoisyRoomOptions size;
  size.num_poses = 5;
  size.num_beams = 40;
  NoisyRoom room = MakeNoisyRoom(size);
  DisturbPoses(0.02, room.graph, &room.state);
  ComparedProblem problem{room.graph, {room.state.poses, {}}, {}, {}};
  for (int i = 0; i + 1 < size.num_poses; ++i) {
    problem.pose_graph.push_back(
        {i, i + 1, Between(room.truth[i], room.truth[i + 1]), 1e-6 * Eigen::Matrix3d::Identity()});
  }
  return problem;
}

// Compares the solvers with small limits. Every run lowers the energy from the one start, but the
// published method, which leaves the map of so sparse scans as it is.
Comparison CompareOnSmallProblem(const std::string& list, const ComparedProblem& problem) {
  SolverOptions base;
  base.num_threads = 1;
  base.rounds.max_coarse_rounds = 0;
  base.rounds.max_fine_rounds = 1;
  base.reduced.max_rounds = 2;
  base.published.max_passes = 5;
  ComparisonLimits limits;
  limits.line_search_iterations = 20;
  Comparison comparison;
  comparison.options.repeats = 1;
  const Status status = ParseSolvers(list, base, limits, &comparison.solvers);
  EXPECT_TRUE(status.ok()) << status.message();
  comparison.runs = CompareSolvers(comparison.solvers, problem, comparison.options, {});
  for (const SolverRun& run : comparison.runs) {
    if (!run.failure.empty()) {
      ADD_FAILURE() << run.solver << ": " << run.failure;
      continue;
    }
    EXPECT_EQ(run.trace[0].marginal_energy, comparison.runs[0].trace[0].marginal_energy);
    if (run.solver.rfind("published", 0) == 0) {
      EXPECT_EQ(run.final_energy(), run.trace[0].marginal_energy) << run.solver;
    } else {
      EXPECT_LT(run.final_energy(), run.trace[0].marginal_energy) << run.solver;
    }
  }
  return comparison;
}

TEST(SolverComparisonTest, EverySolverRunsFromOneStart) {
  const ComparedProblem problem = SmallProblem();
  const Comparison comparison = CompareOnSmallProblem(
      "reduced,reduced:fixed_lines,alternating_cg,published,ceres,"
      "pose_graph,sgd",
      problem);
  const std::string table = ComparisonTable(comparison);
  for (const ComparedSolver& solver : comparison.solvers) {
    EXPECT_THAT(table, HasSubstr("\n" + solver.name + " "));
  }
}

TEST(SolverComparisonTest, EverySwitchOfCeresRuns) {
  const ComparedProblem problem = SmallProblem();
  for (const std::string over : {"ceres:points", "ceres:reduced"}) {
    std::string list;
    for (const char* words :
         {"dense_normal_cholesky", "dense_qr", "sparse_normal_cholesky", "dense_schur",
          "sparse_schur", "iterative_schur:identity", "iterative_schur:jacobi",
          "iterative_schur:schur_jacobi", "cgnr:identity", "cgnr:jacobi", "traditional_dogleg",
          "subspace_dogleg", "steepest_descent:armijo", "steepest_descent:wolfe", "lbfgs", "bfgs",
          "fletcher_reeves", "polak_ribiere", "hestenes_stiefel"}) {
      list += (list.empty() ? "" : ",") + over + ":" + words;
    }
    const Comparison comparison = CompareOnSmallProblem(list, problem);
    EXPECT_EQ(comparison.runs.size(), 19u);
  }
}

TEST(SolverComparisonTest, RepeatsComeInTurns) {
  const ComparedProblem problem = SmallProblem();
  ComparisonOptions options;
  options.repeats = 2;
  std::vector<std::string> done;
  const std::vector<SolverRun> runs = CompareSolvers(
      {{"a", {}}, {"b", {}}}, problem, options,
      [&](const SolverRun& run) { done.push_back(run.solver + std::to_string(run.repeat)); });
  EXPECT_THAT(done, testing::ElementsAre("a1", "b1", "a2", "b2"));
  EXPECT_EQ(runs[0].final_energy(), runs[3].final_energy());
}

TEST(SolverComparisonTest, PoseGraphsAreForSolversOfRelativePosesOnly) {
  ComparedProblem problem = SmallProblem();
  SolverOptions options;
  const ComparedSolver reduced{"reduced", options};
  options.type = SolverType::kPoseGraph;
  const ComparedSolver pose_graph{"pose_graph", options};
  const double energy = RunSolver(reduced, problem, 100.0).final_energy();
  problem.pose_graph[0].from_from_to.x += 0.1;
  EXPECT_EQ(RunSolver(reduced, problem, 100.0).final_energy(), energy);
  const SolverRun moved = RunSolver(pose_graph, problem, 100.0);
  EXPECT_GT(moved.final_energy(), energy);
  problem.pose_graph[0].to = -1;
  EXPECT_NE(RunSolver(pose_graph, problem, 100.0).failure, "");
}

TEST(SolverComparisonTest, LongTracesKeepStatesEvenlyInLogarithmOfTime) {
  const ComparedProblem problem = SmallProblem();
  SolverOptions options;
  options.type = SolverType::kSgd;
  const SolverRun run = RunSolver({"sgd", options}, problem, 100.0);
  ASSERT_EQ(run.failure, "");
  EXPECT_EQ(run.num_iterations, 400);
  EXPECT_GT(run.trace.size(), 20u);
  EXPECT_LE(run.trace.size(), 203u);
  EXPECT_EQ(run.trace.front().iteration, 0);
  EXPECT_EQ(run.trace.back().iteration, 401);
  for (std::size_t i = 1; i < run.trace.size(); ++i) {
    EXPECT_GT(run.trace[i].iteration, run.trace[i - 1].iteration);
    EXPECT_GT(run.trace[i].marginal_energy, 0.0);
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
