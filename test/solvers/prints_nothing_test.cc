// The library prints nothing in a host that has not initialised glog, through which Ceres logs.

#include <glog/logging.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/covariance.h"
#include "plumbline/solvers/full/ceres_solver.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/core/captured_output.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A room with 1098 unknowns over points: more than Ceres takes for BFGS without a warning.
NoisyRoom SmallDisturbedRoom() {
  NoisyRoomOptions options;
  options.num_poses = 6;
  options.num_beams = 90;
  NoisyRoom room = MakeNoisyRoom(options);
  DisturbPoses(0.02, room.graph, &room.state);
  return room;
}

SolverOptions CeresSolverOptions(bool over_landmarks) {
  SolverOptions options;
  options.type = SolverType::kCeres;
  options.rounds.max_coarse_rounds = 1;
  options.rounds.max_fine_rounds = 1;
  options.ceres->reduced = over_landmarks;
  options.ceres->max_num_iterations = 3;
  options.ceres->function_tolerance = 1e-12;
  return options;
}

SolverSummary SolveRoom(const SolverOptions& options) {
  NoisyRoom room = SmallDisturbedRoom();
  return RefineState(options, room.graph, &room.state);
}

// The flags and the log lines of the host are as before after each test.
class PrintsNothingTest : public testing::Test {
 protected:
  void SetUp() override { FLAGS_minloglevel = google::GLOG_INFO; }
  void TearDown() override {
    EXPECT_EQ(FLAGS_minloglevel, google::GLOG_INFO);
    const std::string host = CapturedOutput([] { LOG(WARNING) << "of the host"; });
    EXPECT_THAT(host, HasSubstr("of the host"));
  }
};

class CeresPrintsNothingTest : public PrintsNothingTest,
                               public testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(Over, CeresPrintsNothingTest, testing::Bool(),
                         [](const auto& over) { return over.param ? "Landmarks" : "Points"; });

TEST_P(CeresPrintsNothingTest, EveryLineSearch) {
  for (const auto direction :
       {ceres::STEEPEST_DESCENT, ceres::NONLINEAR_CONJUGATE_GRADIENT, ceres::BFGS, ceres::LBFGS}) {
    for (const auto search : {ceres::ARMIJO, ceres::WOLFE}) {
      for (const auto type :
           {ceres::FLETCHER_REEVES, ceres::POLAK_RIBIERE, ceres::HESTENES_STIEFEL}) {
        if (direction != ceres::NONLINEAR_CONJUGATE_GRADIENT && type != ceres::FLETCHER_REEVES) {
          continue;
        }
        SolverOptions options = CeresSolverOptions(GetParam());
        options.ceres->minimizer_type = ceres::LINE_SEARCH;
        // A step of BFGS over 1098 unknowns takes long, and its warning comes first.
        if (direction != ceres::BFGS) options.ceres->max_num_iterations = 20;
        options.ceres->line_search_direction_type = direction;
        options.ceres->line_search_type = search;
        options.ceres->nonlinear_conjugate_gradient_type = type;
        EXPECT_EQ(CapturedOutput([&] { SolveRoom(options); }), "")
            << ceres::LineSearchDirectionTypeToString(direction) << " "
            << ceres::LineSearchTypeToString(search) << " "
            << ceres::NonlinearConjugateGradientTypeToString(type);
      }
    }
  }
}

TEST_P(CeresPrintsNothingTest, EveryTrustRegion) {
  for (const auto solver : {ceres::SPARSE_NORMAL_CHOLESKY, ceres::DENSE_SCHUR, ceres::SPARSE_SCHUR,
                            ceres::ITERATIVE_SCHUR, ceres::CGNR}) {
    for (const auto strategy : {ceres::LEVENBERG_MARQUARDT, ceres::DOGLEG}) {
      for (const auto dogleg : {ceres::TRADITIONAL_DOGLEG, ceres::SUBSPACE_DOGLEG}) {
        SolverOptions options = CeresSolverOptions(GetParam());
        options.ceres->linear_solver_type = solver;
        options.ceres->trust_region_strategy_type = strategy;
        options.ceres->dogleg_type = dogleg;
        EXPECT_EQ(CapturedOutput([&] { SolveRoom(options); }), "")
            << ceres::LinearSolverTypeToString(solver) << " "
            << ceres::TrustRegionStrategyTypeToString(strategy) << " "
            << ceres::DoglegTypeToString(dogleg);
      }
    }
  }
}

// A residual overflows: Ceres logs that the evaluation failed.
TEST_F(PrintsNothingTest, AStateWithoutAnEnergy) {
  NoisyRoom room = SmallDisturbedRoom();
  const Associations associations = AssociationsOf(room.graph, room.state);
  room.state.points[0] = 1e308;
  InnerResult result;
  EXPECT_EQ(CapturedOutput([&] {
              result = SolveWithCeres(room.graph, associations, FactorOptions(), CeresOptions(), 2,
                                      nullptr, &room.state);
            }),
            "");
  EXPECT_FALSE(result.usable);
  EXPECT_THAT(result.stop_reason, HasSubstr("evaluation failed"));
}

// Ceres logs that steps are invalid at 1e200 m, and that residuals overflow at 1e307 m.
TEST_F(PrintsNothingTest, PoseGraphs) {
  const Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
  for (const double x : {1.0, 1e200, 1e307}) {
    std::vector<Pose2> poses{{0.0, 0.0, 0.0}, {x, 0.1, 0.2}, {2.0 * x, 0.0, 0.1}};
    const std::vector<RelativePoseConstraint> edges{{0, 1, {-x, 0.0, 0.0}, covariance},
                                                    {1, 2, {x, 0.0, 0.0}, covariance},
                                                    {0, 2, {x, 0.0, 0.0}, covariance}};
    PoseGraphResult result;
    EXPECT_EQ(CapturedOutput([&] { result = OptimizePoseGraph(edges, edges, &poses); }), "")
        << "x = " << x;
    EXPECT_THAT(result.stop_reason, HasSubstr(x == 1.0     ? "Function tolerance reached"
                                              : x == 1e200 ? "invalid steps"
                                                           : "evaluation failed"));
  }
}

// A reason that Ceres also logs is in the summary.
TEST_F(PrintsNothingTest, ARefusedCombinationOfOptions) {
  SolverOptions options = CeresSolverOptions(false);
  options.ceres->trust_region_strategy_type = ceres::DOGLEG;
  options.ceres->linear_solver_type = ceres::CGNR;
  SolverSummary summary;
  EXPECT_EQ(CapturedOutput([&] { summary = SolveRoom(options); }), "");
  EXPECT_THAT(summary.message, HasSubstr("DOGLEG"));
}

TEST_F(PrintsNothingTest, EverySolver) {
  for (const SolverType type : {SolverType::kReduced, SolverType::kAlternatingCg,
                                SolverType::kPublished, SolverType::kPoseGraph, SolverType::kSgd}) {
    SolverOptions options = CeresSolverOptions(false);
    options.type = type;
    EXPECT_EQ(CapturedOutput([&] { SolveRoom(options); }), "") << ToString(type);
  }
}

TEST_F(PrintsNothingTest, CovariancesAndCalibration) {
  NoisyRoom room = SmallDisturbedRoom();
  const SolverOptions options = CeresSolverOptions(true);
  EXPECT_EQ(
      CapturedOutput([&] {
        CalibrationOptions calibrated;
        calibrated.laser_mounting = true;
        Calibration calibration;
        EXPECT_TRUE(SolveWithCalibration(options, calibrated, room.graph, &room.state, &calibration)
                        .IsSolutionUsable());
        std::vector<Eigen::Matrix3d> covariances;
        EXPECT_TRUE(
            ComputePoseCovariances(options, room.graph, room.state, {{1, 1}}, &covariances).ok());
      }),
      "");
}

}  // namespace
}  // namespace plumbline
