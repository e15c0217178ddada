#include "plumbline/apps/run/memory_estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class MemoryEstimateTest : public testing::Test {
 protected:
  Status Fit(double limit, MemoryEstimate* estimate, std::string* text) const {
    int picture_side_px = 4000;
    std::ostringstream out;
    Status status = FitMemory(limit, graph_, solver_, estimate, &picture_side_px, &out);
    *text = out.str();
    return status;
  }
  std::string ErrorAt(double limit) const {
    std::string text;
    MemoryEstimate estimate = EstimateMemory(graph_, state_, solver_, false, 50);
    return Fit(limit, &estimate, &text).message();
  }

  const SlamGraph graph_ = MakeNoisyRoom().graph;  // 12 scans
  const MapState state_ = graph_.InitialState();
  SolverOptions solver_;
};

TEST_F(MemoryEstimateTest, SolversDiffer) {
  const auto joint = [&](bool calibrates) {
    return EstimateMemory(graph_, state_, solver_, calibrates, 50).joint;
  };
  const double reduced = joint(false);
  EXPECT_GT(joint(true), reduced);
  solver_.type = SolverType::kCeres;
  const double explicit_points = joint(false);
  EXPECT_GT(explicit_points - 25e6, 9.0 * (reduced - 25e6));
  solver_.ceres->reduced = true;
  EXPECT_LT(joint(false), explicit_points);
  solver_.ceres->linear_solver_type = ceres::ITERATIVE_SCHUR;
  EXPECT_LT(joint(false) - 25e6, 0.5 * (explicit_points - 25e6));
}

TEST_F(MemoryEstimateTest, CountsDenseMatricesAndRefusesThoseThatDoNotFit) {
  solver_.type = SolverType::kCeres;
  const auto joint = [&](ceres::LinearSolverType type, const SlamGraph& graph) {
    solver_.ceres->linear_solver_type = type;
    return EstimateMemory(graph, graph.InitialState(), solver_, false, 50).joint;
  };
  const double sparse = joint(ceres::SPARSE_SCHUR, graph_);
  const double columns = 3.0 * graph_.num_poses() + 2.0 * static_cast<double>(graph_.num_returns());
  EXPECT_NEAR(joint(ceres::DENSE_NORMAL_CHOLESKY, graph_) - sparse, 8.0 * columns * columns, 1.0);
  EXPECT_GT(joint(ceres::DENSE_QR, graph_), joint(ceres::DENSE_NORMAL_CHOLESKY, graph_));
  EXPECT_LT(joint(ceres::DENSE_SCHUR, graph_) - sparse, 1e5);
  EXPECT_EQ(ErrorAt(0.0), "");  // 12 scans
  NoisyRoomOptions many;
  many.num_poses = 400;
  many.num_beams = 360;
  const SlamGraph large = MakeNoisyRoom(many).graph;
  solver_.ceres->linear_solver_type = ceres::DENSE_QR;
  MemoryEstimate estimate = EstimateMemory(large, large.InitialState(), solver_, false, 50);
  int picture_side_px = 50;
  std::ostringstream out;
  EXPECT_THAT(
      FitMemory(0.0, large, solver_, &estimate, &picture_side_px, &out).message(),
      AllOf(HasSubstr("--ceres=linear_solver_type=DENSE_QR"), HasSubstr("this machine has")));
}

TEST_F(MemoryEstimateTest, TheGridIsMadeToFitAndToldOf) {
  MemoryEstimate expected;
  expected.results = 10e6;
  RunOutputOptions outputs;
  outputs.map_resolution_m = 0.2;
  EXPECT_EQ(FitGrid(expected, graph_, state_, 0.0, &outputs), "");
  EXPECT_EQ(outputs.map_max_cells, RunOutputOptions().map_max_cells);

  outputs.map_resolution_m = 0.002;
  double num_cells = 0.0;
  ASSERT_TRUE(CheckGridSize(graph_, state_, outputs.GridOptions(), &num_cells).ok());
  ASSERT_GT(num_cells, 2e6);
  const auto text_of = [](double cells) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(0)
         << "The results may need more memory than that, up to " << 10.0 + 5e-6 * cells
         << " MB: the occupancy grid takes up to " << 5e-6 * cells << " MB\n";
    return text.str();
  };
  EXPECT_EQ(FitGrid(expected, graph_, state_, 0.0, &outputs), text_of(num_cells));
  EXPECT_EQ(FitGrid(expected, graph_, state_, 10e6 + 5.0 * num_cells, &outputs),
            text_of(num_cells));
  // Cells of twice the side.
  const std::string coarser = FitGrid(expected, graph_, state_, 10e6 + 4.0 * num_cells, &outputs);
  EXPECT_NEAR(outputs.map_max_cells, 0.8 * num_cells, 1.0);
  double num_coarser = 0.0;
  ASSERT_TRUE(CheckGridSize(graph_, state_, outputs.GridOptions(), &num_coarser).ok());
  EXPECT_LT(num_coarser, 0.3 * num_cells);
  EXPECT_EQ(coarser, text_of(num_coarser));
}

TEST_F(MemoryEstimateTest, ReadsSizes) {
  double bytes = -1.0;
  ASSERT_TRUE(ParseMemorySize("4GB", &bytes).ok());
  EXPECT_EQ(bytes, 4e9);
  ASSERT_TRUE(ParseMemorySize("1.5MB", &bytes).ok());
  EXPECT_EQ(bytes, 1.5e6);
  ASSERT_TRUE(ParseMemorySize("0", &bytes).ok());
  EXPECT_EQ(bytes, 0.0);
  for (const char* bad : {"", "GB", "4", "4 GB", "4gb", "-1GB", "nanGB", "infMB", "4GBs", "4KB"}) {
    EXPECT_EQ(ParseMemorySize(bad, &bytes).code(), StatusCode::kInvalidArgument) << bad;
    EXPECT_EQ(bytes, 0.0);
  }
}

TEST_F(MemoryEstimateTest, PicturesAreMadeToFit) {
  constexpr int kAskedPx = 4000;  // more than a picture of a room has
  const auto estimate_at = [&](int side_px) {
    return EstimateMemory(graph_, state_, solver_, false, side_px);
  };
  const MemoryEstimate asked = estimate_at(kAskedPx);
  ASSERT_GT(asked.picture_side_px, 700);
  ASSERT_LT(asked.picture_side_px, kAskedPx);
  const auto fit = [&](double limit, MemoryEstimate* estimate, int* side_px) {
    *estimate = asked;
    *side_px = kAskedPx;
    return FitPictures(limit, estimate, side_px);
  };
  MemoryEstimate estimate;
  int side_px = 0;
  for (const double limit : {0.0, 1.01 * asked.results}) {
    EXPECT_EQ(fit(limit, &estimate, &side_px), "");
    EXPECT_EQ(side_px, kAskedPx);
    EXPECT_EQ(estimate.results, asked.results);
  }
  // Smaller ones take as much as is left, and no more.
  const double pictures = asked.pictures, others = asked.results - pictures;
  for (const double share : {0.9, 0.5, 0.2}) {
    const double limit = others + share * pictures;
    const std::string text = fit(limit, &estimate, &side_px);
    EXPECT_THAT(text, HasSubstr("sides of " + std::to_string(side_px) + " pixels at most"));
    EXPECT_NEAR(side_px, std::sqrt(share) * asked.picture_side_px, 1.0);
    EXPECT_NEAR(estimate.results, limit, 0.01 * pictures);
    EXPECT_LE(estimate_at(side_px).results, limit);
    EXPECT_EQ(estimate.seeding, asked.seeding);
    MemoryEstimate fitted = asked;
    std::string fitted_text;
    EXPECT_TRUE(Fit(limit, &fitted, &fitted_text).ok());
    EXPECT_EQ(fitted.results, estimate.results);
    EXPECT_EQ(fitted_text, asked.Text() + text);
  }
  // What a picture of no use would not save is left for FitMemory to refuse.
  for (const double limit : {others + 0.1 * pictures, 0.9 * others}) {
    EXPECT_EQ(fit(limit, &estimate, &side_px), "");
    EXPECT_EQ(side_px, kAskedPx);
    std::string text;
    EXPECT_FALSE(Fit(limit, &estimate, &text).ok());
    EXPECT_EQ(text, asked.Text());
  }
}

TEST_F(MemoryEstimateTest, RefusesWhatDoesNotFitAndSaysWhatWould) {
  solver_.type = SolverType::kCeres;
  EXPECT_EQ(ErrorAt(0.0), "");
  EXPECT_EQ(ErrorAt(1e9), "");
  EXPECT_THAT(ErrorAt(27e6), AllOf(HasSubstr("needs about 28 MB"), HasSubstr("allows 27 MB"),
                                   HasSubstr("--solver=reduced or --max_scans=6 would")));
  EXPECT_THAT(ErrorAt(5e6), AllOf(HasSubstr("allows 5 MB"), Not(HasSubstr("--max_scans"))));
  solver_.type = SolverType::kReduced;
  EXPECT_THAT(ErrorAt(25.05e6), Not(HasSubstr("--solver")));
}

TEST_F(MemoryEstimateTest, SeveralLogsTakeTheProgramOnce) {
  const MemoryEstimate one = EstimateMemory(graph_, state_, solver_, false, 50);
  MemoryEstimate two = one;
  two.Add(one);
  EXPECT_NEAR(two.seeding - 25e6, 2.0 * (one.seeding - 25e6), 1.0);
  EXPECT_NEAR(two.joint - 25e6, 2.0 * (one.joint - 25e6), 1.0);
  EXPECT_EQ(two.pictures, one.pictures);
  EXPECT_NEAR(two.results - 25e6 - two.pictures, 2.0 * (one.results - 25e6 - one.pictures), 1.0);
}

}  // namespace
}  // namespace plumbline
