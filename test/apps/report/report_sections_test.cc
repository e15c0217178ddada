#include "plumbline/apps/report/report_sections.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ReportSectionsTest, AlarmsNameTheirPlace) {
  Alarm alarm;
  alarm.place.scan = 7;
  alarm.reason = "because";
  HtmlReport report;
  AddAlarms({alarm}, "all is well", &report);
  ASSERT_EQ(report.alarms.size(), 1u);
  EXPECT_THAT(report.alarms[0], HasSubstr("Around scan 7 (t = 0.00 s"));
  EXPECT_THAT(report.alarms[0], HasSubstr("): because."));
  alarm.wrong_share = 0.08;
  AddAlarms({alarm}, "", &report);
  EXPECT_THAT(report.alarms[1], HasSubstr("because (8 % of the simulated maps"));
}

TEST(ReportSectionsTest, StagesAreComparedWithTheFirst) {
  Stage first, last;
  first.name = "given";
  last.name = "refined";
  last.quality = {0.0123, -3.5, 10};
  HtmlReport report;
  AddStages({first, last}, &report);
  ASSERT_EQ(report.tables.size(), 1u);
  EXPECT_THAT(report.tables[0].rows[0], ElementsAre("given", "-", "-"));
  EXPECT_THAT(report.tables[0].rows[1], ElementsAre("refined", "12.3 mm", "-3.500"));
  EXPECT_EQ(report.figures[0].value, "12.3 mm");
  EXPECT_EQ(report.figures[0].note, "given: -");
}

TEST(ReportSectionsTest, TheConvergenceChartShowsOneEnergyFromTheStartToTheResult) {
  SolverSummary solver;
  solver.round_energies = {{0, 0, 0.0, 100.0}, {1, 2, 0.5, 80.0}, {2, 3, 0.75, 85.0}};
  solver.total_time_s = 1.0;
  solver.final_marginal_energy = 80.0;
  HtmlReport report;
  AddSolver(solver, &report);
  ASSERT_EQ(report.plots.size(), 1u);
  const std::vector<ReportCurve>& curves = report.plots[0].curves;
  ASSERT_EQ(curves.size(), 2u);
  ASSERT_EQ(curves[0].points.size(), 3u);
  EXPECT_EQ(curves[0].points[0].value, 100.0);
  EXPECT_EQ(curves[0].points[1].time_s, 0.5);
  EXPECT_EQ(curves[0].points[1].iteration, 2.0);
  EXPECT_EQ(curves[0].points[2].value, 85.0);
  ASSERT_EQ(curves[1].points.size(), 1u);
  EXPECT_EQ(curves[1].points[0].value, 80.0);
  EXPECT_EQ(curves[1].points[0].time_s, 1.0);
  EXPECT_EQ(curves[1].points[0].iteration, 3.0);
}

TEST(ReportSectionsTest, WithoutMeasuredRoundsThereIsNoChart) {
  SolverSummary solver;
  solver.iterations.resize(2);
  HtmlReport report;
  AddSolver(solver, &report);
  EXPECT_TRUE(report.plots.empty());
}

TEST(ReportSectionsTest, ASolverOfPoseGraphsHasNoTermsOfReturns) {
  SolverSummary solver;
  solver.solver = "sgd";
  solver.num_relative_poses = 3;
  solver.seed_chi2 = 12.5;
  solver.final_chi2 = 2.5;
  HtmlReport report;
  AddSolver(solver, &report);
  ASSERT_EQ(report.tables.size(), 1u);
  EXPECT_EQ(report.tables[0].rows[0][1], "12.5");
  EXPECT_EQ(report.tables[0].rows[1][1], "2.5");
  EXPECT_TRUE(report.histograms.empty());
}

TEST(ReportSectionsTest, HistogramsHaveTheEdgesOfTheirBins) {
  SolverSummary solver;
  solver.displacements.sigma_counts[2] = 5;
  HtmlReport report;
  AddSolver(solver, &report);
  ASSERT_EQ(report.histograms.size(), 2u);
  EXPECT_EQ(report.histograms[0].lower_edges[2], 0.5);
  EXPECT_EQ(report.histograms[0].counts[2], 5u);
  EXPECT_EQ(report.histograms[1].lower_edges[0], 0.0);
  EXPECT_DOUBLE_EQ(report.histograms[1].lower_edges[1], 0.25);
  EXPECT_DOUBLE_EQ(report.histograms[1].lower_edges[3], 1.0);
  for (const ReportHistogram& histogram : report.histograms) {
    EXPECT_EQ(histogram.lower_edges.size(), histogram.counts.size());
  }
}

}  // namespace
}  // namespace plumbline
