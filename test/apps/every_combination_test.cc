#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "plumbline/apps/benchmark/synthetic_drive.h"
#include "plumbline/core/angle.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {
namespace {

constexpr SolverType kSolvers[] = {SolverType::kReduced,   SolverType::kAlternatingCg,
                                   SolverType::kPublished, SolverType::kCeres,
                                   SolverType::kPoseGraph, SolverType::kSgd};
constexpr StartType kStarts[] = {StartType::kOdometry, StartType::kIcp, StartType::kIcpPointToLine,
                                 StartType::kIcpGlobal, StartType::kSeed};

const SyntheticDrive& Drive() {
  static const SyntheticDrive* drive = [] {
    auto* made = new SyntheticDrive;
    EXPECT_TRUE(MakeSyntheticDrive(1, {"20 mm", 0.02, DegToRad(0.1), 0.3}, made).ok());
    return made;
  }();
  return *drive;
}

// A map, or an error that names what does not go together and leaves no trace.
void ExpectRunsOrIsRefused(const MapLogOptions& options, const std::string& what) {
  std::string error;
  const bool goes = options.Check(&error);
  LogMapping mapping;
  const Status status = MapLog(options, Drive().graph, {}, &mapping);
  EXPECT_EQ(status.ok(), goes) << what << ": " << status.message();
  if (!goes) {
    EXPECT_EQ(status.message(), error) << what;
    EXPECT_EQ(mapping.graph.num_poses(), 0) << what;
    return;
  }
  EXPECT_TRUE(mapping.report.solver.IsSolutionUsable()) << what;
  EXPECT_EQ(mapping.report.seeding.start, options.start) << what;
  EXPECT_EQ(mapping.state.points.size(), 2 * Drive().graph.num_returns()) << what;
}

TEST(EveryCombinationTest, RunsOrIsRefused) {
  constexpr double kNoGate = std::numeric_limits<double>::infinity();
  for (const SolverType solver : kSolvers) {
    for (const bool reduced : {false, true}) {
      if (reduced && solver != SolverType::kCeres) continue;
      for (const StartType start : kStarts) {
        for (const bool shape : {false, true}) {
          for (const double gate : {FactorOptions().manifold.robust_gate_sigmas, kNoGate}) {
            MapLogOptions options;
            options.start = start;
            options.solver.type = solver;
            options.solver.ceres->reduced = reduced;
            options.solver.ceres->max_num_iterations = 3;
            options.solver.rounds.max_coarse_rounds = 1;
            options.solver.rounds.max_fine_rounds = 1;
            options.solver.published.max_passes = 2;
            options.solver.factors.beam.sigma_range_m = 0.02;
            options.solver.factors.shape = shape;
            options.solver.factors.manifold.robust_gate_sigmas = gate;
            ExpectRunsOrIsRefused(options, std::string(ToString(solver)) +
                                               (reduced ? " --reduced" : "") + " from " +
                                               ToString(start) + (shape ? ", shape" : "") +
                                               (gate == kNoGate ? ", Gaussian" : ""));
          }
        }
      }
    }
  }
}

TEST(EveryCombinationTest, StartsWhereItIsTold) {
  for (const StartType start : kStarts) {
    MapLogOptions options;
    options.start = start;
    LogMapping mapping;
    ASSERT_TRUE(MapLog(options, Drive().graph, {}, &mapping).ok());
    EXPECT_EQ(mapping.start_poses == Drive().graph.initial_poses(), start == StartType::kOdometry);
    EXPECT_EQ(mapping.report.seeding.sequential.num_keyframes > 0, start == StartType::kSeed);
  }
}

// A solver of pose graphs needs the seeding's edges wherever it starts.
TEST(EveryCombinationTest, PoseGraphsHaveTheirEdgesFromAnyStart) {
  double chi2 = 0.0;
  for (const StartType start : {StartType::kOdometry, StartType::kSeed}) {
    MapLogOptions options;
    options.start = start;
    options.solver.type = SolverType::kPoseGraph;
    LogMapping mapping;
    ASSERT_TRUE(MapLog(options, Drive().graph, {}, &mapping).ok());
    EXPECT_GT(mapping.report.solver.num_relative_poses, 14u);
    if (start == StartType::kOdometry) {
      chi2 = mapping.report.solver.final_chi2;
      EXPECT_GT(mapping.report.solver.seed_chi2, 2.0 * chi2);
    } else {
      EXPECT_NEAR(mapping.report.solver.final_chi2, chi2, 1e-3 * chi2);
    }
  }
}

}  // namespace
}  // namespace plumbline
