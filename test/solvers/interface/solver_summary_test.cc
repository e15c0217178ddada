#include "plumbline/solvers/interface/solver_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

SolverSummary Example() {
  SolverSummary summary;
  summary.termination = TerminationType::kConverged;
  summary.message = "the reason why";
  summary.solver = "alternating_cg";
  summary.num_poses = 4934;
  summary.num_points = 1739359;
  summary.acceptance.seed_energy = 4.25e6;
  summary.acceptance.final_energy = 3.5e6;
  RoundSummary round;
  round.radius_m = 0.125;
  round.gate_sigmas = 4.75;
  round.num_lines = 852193;
  round.num_shape_pairs = 44332;
  round.initial_cost = 7.5e5;
  round.final_cost = 2.5e5;
  round.marginal_energy = 3.5e6;
  round.iterations = 42;
  summary.rounds = {round, round};
  summary.rounds.front().kept = true;
  summary.iterations.resize(84);
  // 10 blocks of 3 cost 135: 3 sigmas, of several units. 50 blocks of 2 residuals cost 200:
  // sqrt(2 x 200 / 100) = 2 sigmas, 0.024 m.
  summary.terms = {{"motion", 10, 150.0, 135.0, 3, 0.0, ""},
                   {"range beam", 50, 800.0, 200.0, 2, 0.012, "m (as range)"},
                   {"manifold", 0, 0.0, 0.0, 1, 0.008, "m (robust)"}};
  summary.association_time_s = 1.25;
  summary.setup_time_s = 0.75;
  summary.solve_time_s = 18.5;
  summary.total_time_s = 21.75;
  return summary;
}

/// The words of the first line that starts, after blanks, with `label`.
std::vector<std::string> WordsAfter(const std::string& label, const std::string& report) {
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos || line.compare(start, label.size(), label) != 0) continue;
    std::istringstream words(line.substr(start + label.size()));
    return {std::istream_iterator<std::string>(words), {}};
  }
  return {};
}

TEST(SolverSummaryTest, BriefReportHoldsTheNumbers) {
  const std::string report = Example().BriefReport();
  EXPECT_EQ(report,
            "alternating_cg: converged in 21.75 s, 2 rounds, 84 iterations, 4934 poses, 1739359 "
            "points, energy 4.250000e+06 -> 3.500000e+06");
}

TEST(SolverSummaryTest, FullReportHoldsRoundsTermsTimesAndReason) {
  const SolverSummary summary = Example();
  const std::string report = summary.FullReport();
  EXPECT_THAT(report, HasSubstr(summary.BriefReport()));
  EXPECT_THAT(report, HasSubstr("0.125  4.75    852193        44332  7.500000e+05  2.500000e+05    "
                                "42 3.500000e+06\n"));
  EXPECT_THAT(report, HasSubstr("42 3.500000e+06 undone\n"));
  using Words = std::vector<std::string>;
  EXPECT_EQ(WordsAfter("range beam", report), Words({"50", "8.000000e+02", "2.000000e+02", "2.000",
                                                     "0.02400", "m", "(as", "range)"}));
  EXPECT_EQ(WordsAfter("motion", report), Words({"10", "1.500000e+02", "1.350000e+02", "3.000"}));
  EXPECT_EQ(WordsAfter("manifold", report),
            Words({"0", "0.000000e+00", "0.000000e+00", "0.000", "0.00000", "m", "(robust)"}));
  EXPECT_THAT(report, HasSubstr("association 1.25, setup 0.75, minimisation 18.50, total 21.75\n"));
  EXPECT_THAT(report, HasSubstr("Termination: converged. the reason why\n"));
}

TEST(SolverSummaryTest, NamesTheIgnoredEdgesThatAreFarthestOff) {
  SolverSummary summary = Example();
  EXPECT_THAT(summary.FullReport(), Not(HasSubstr("contradicted by their scans")));
  for (int i = 0; i < 7; ++i) {
    summary.ignored_edges.push_back(
        {static_cast<std::size_t>(i), i, i + 10, 0.25 * i, 0.5, 4.0 * i});
  }
  const std::vector<IgnoredEdge> farthest = summary.FarthestIgnoredEdges(2);
  ASSERT_EQ(farthest.size(), 2u);
  EXPECT_EQ(farthest[0].edge, 6u);
  EXPECT_EQ(farthest[1].edge, 5u);
  const std::string report = summary.FullReport();
  EXPECT_THAT(report, HasSubstr("  7 relative poses are contradicted by their scans and did not "
                                "count:\n    6 to 16 is 1.50 m, 0.500 rad, 24 sigmas off the "
                                "result\n    5 to 15 "));
  EXPECT_THAT(report, HasSubstr("    2 to 12 is 0.50 m"));
  EXPECT_THAT(report, Not(HasSubstr("    1 to 11 ")));
}

TEST(SolverSummaryTest, ALongMessageIsNotCut) {
  SolverSummary summary;
  summary.message = std::string(5000, 'x');
  EXPECT_THAT(summary.FullReport(), HasSubstr(summary.message));
}

TEST(SolverSummaryTest, IsAFailureUntilTold) {
  const SolverSummary summary;
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_FALSE(summary.IsSolutionUsable());
  EXPECT_TRUE(Example().IsSolutionUsable());
}

TEST(SolverSummaryTest, ProgressRowsHaveOneColumnPerHeading) {
  IterationSummary it;
  it.iteration = 7;
  it.round = 2;
  it.phase = "poses";
  it.cost = 123.5;
  it.cost_change = 0.5;
  it.gradient_max_norm = 10.0;
  it.step_norm = 0.25;
  it.step_size = 1.5;
  it.beta = 0.75;
  it.trust_region_ratio = 0.875;
  it.trust_region_radius = 1e4;
  it.evaluations = 3;
  it.iteration_time_s = 0.125;
  it.total_time_s = 9.5;
  const auto words = [](const std::string& line) {
    std::istringstream stream(line);
    return std::vector<std::string>(std::istream_iterator<std::string>(stream), {});
  };
  EXPECT_EQ(words(ProgressRow(it)),
            std::vector<std::string>({"7", "2", "poses", "1.235000e+02", "5.000e-01", "1.00e+01",
                                      "2.50e-01", "1.50e+00", "7.50e-01", "8.75e-01", "1.00e+04",
                                      "3", "0.125", "9.50"}));
  EXPECT_EQ(words(ProgressHeader()).size(), words(ProgressRow(it)).size());
}

TEST(SolverSummaryTest, TerminationsHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const TerminationType type :
       {TerminationType::kFailure, TerminationType::kNoImprovement, TerminationType::kUserStopped,
        TerminationType::kMaxIterations, TerminationType::kConverged}) {
    EXPECT_STRNE(ToString(type), "");
    names.insert(ToString(type));
  }
  EXPECT_EQ(names.size(), 5u);
}

}  // namespace
}  // namespace plumbline
