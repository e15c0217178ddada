// The energy over poses and lines of landmarks, in the reduced solver's own form and in Ceres'.

#include <ceres/problem.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/solvers/full/ceres_solver.h"
#include "plumbline/solvers/full/problem_builder.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/reduced/pose_preconditioner.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/reduced/reduced_solver.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

NoisyRoom DisturbedRoom() {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.02, room.graph, &room.state);
  return room;
}

struct DisturbedDrive {
  SlamGraph graph;
  std::vector<double> poses;
};

// Through an office floor, off the truth by a drift that grows and falls.
DisturbedDrive DisturbedBuilding() {
  SimulationOptions options;
  options.scan_period_s = 1.2;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 3)), options, &log).ok());
  DisturbedDrive drive;
  EXPECT_TRUE(MakeGraph(log, &drive.graph).ok());
  const Pose2 start = log.scans[0].world_from_robot;
  std::vector<Pose2> poses;
  for (int i = 0; i < drive.graph.num_poses(); ++i) {
    const double drift = std::sin(2.0 * kPi * i / 60.0);
    const Pose2 truth = Between(start, log.scans[i].world_from_robot);
    poses.push_back(truth * Pose2(0.03 * drift, -0.02 * drift, 0.003 * drift));
  }
  drive.poses = PoseArray(poses);
  return drive;
}

// All that the scans of a graph saw, compressed, with the weights of its poses; the lines fit.
struct CompressedGraph {
  CompressedGraph(const SlamGraph& graph, const std::vector<double>& at)
      : surface(SurfaceOf(graph)), terms(graph, FactorOptions()), poses(at) {
    const SurfaceNoise noise = NoiseOf(FactorOptions());
    LineLandmarkOptions options;
    options.noise = noise;
    LineLandmarks cut = CutIntoLandmarks(graph, poses, surface, options, &pool);
    landmarks = std::move(cut.landmarks);
    ReturnCompressor compressor(graph, noise, &pool);
    observations = compressor.LayOut(landmarks.size(), cut.landmark_of_return);
    const GemanMcClure loss = GemanMcClure::FromGate(ManifoldOptions().robust_gate_sigmas);
    compressor.Weigh(landmarks, FramesOf(poses), loss, &observations);
    Cost(poses);
  }

  // Refits the lines.
  double Cost(const std::vector<double>& at) {
    return FitLandmarkLines(observations, FramesOf(at), &pool, &landmarks) + terms.Cost(at);
  }

  // Gauss-Newton with the lines eliminated, until it gains nothing. Gives the cost.
  double Converge() {
    double cost = Cost(poses);
    for (int i = 0; i < 200; ++i) {
      const std::vector<PoseFrame> frames = FramesOf(poses);
      PoseSystem system;
      system.Linearize(observations, landmarks, terms, poses, frames, &pool);
      const PosePreconditioner preconditioner(system, observations, frames, &pool);
      Eigen::VectorXd step;
      SolvePoseSystem(system, observations, preconditioner, -system.gradient, 1e-8, 2000, &pool,
                      &step);
      const std::vector<double> next = system.Moved(poses, step);
      const double next_cost = Cost(next);
      const double gain = cost - next_cost;
      if (gain <= 0.0) break;
      poses = next;
      cost = next_cost;
      if (gain <= 1e-14 * cost) break;
    }
    return Cost(poses);
  }

  ThreadPool pool{2};
  MeasuredSurface surface;
  PoseTerms terms;
  std::vector<LineLandmark> landmarks;
  LineObservations observations;
  std::vector<double> poses;
};

CeresOptions ExactSparseSchur() {
  CeresOptions options;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-14;
  return options;
}

CeresOptions ExactIterativeSchur() {
  CeresOptions options = ExactSparseSchur();
  options.linear_solver_type = ceres::ITERATIVE_SCHUR;
  options.preconditioner_type = ceres::SCHUR_JACOBI;
  return options;
}

// By all blocks of the problem, or those given; zero for constant ones.
Eigen::VectorXd GradientByCeres(const LandmarkProblem& problem, const std::vector<double*>& blocks,
                                double* cost) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = blocks;
  std::vector<double> gradient;
  EXPECT_TRUE(problem.problem->Evaluate(options, cost, nullptr, &gradient, nullptr));
  return Eigen::Map<const Eigen::VectorXd>(gradient.data(),
                                           static_cast<Eigen::Index>(gradient.size()));
}

void ExpectSameCostAndGradient(const SlamGraph& graph, const std::vector<double>& poses) {
  CompressedGraph compressed(graph, poses);
  ASSERT_GT(compressed.landmarks.size(), 10u);
  PoseSystem system;
  system.Linearize(compressed.observations, compressed.landmarks, compressed.terms,
                   compressed.poses, FramesOf(compressed.poses), &compressed.pool);
  const double expected = compressed.Cost(compressed.poses);

  const LandmarkProblem problem = BuildLandmarkProblem(
      compressed.observations, compressed.landmarks, compressed.terms, &compressed.poses);
  std::vector<double*> pose_blocks;
  for (std::size_t i = 0; i < compressed.poses.size(); i += 3) {
    pose_blocks.push_back(&compressed.poses[i]);
  }
  double cost = 0.0;
  const Eigen::VectorXd by_poses = GradientByCeres(problem, pose_blocks, &cost);
  EXPECT_NEAR(cost, expected, 1e-8 * expected);
  const Eigen::VectorXd expected_by_poses = system.ByPose(system.gradient);
  ASSERT_EQ(by_poses.size(), expected_by_poses.size());
  EXPECT_LE((by_poses - expected_by_poses).norm(), 1e-8 * expected_by_poses.norm());
  EXPECT_TRUE(by_poses.head<3>().isZero(0.0)) << "the first pose is fixed";

  // The lines are where the cost is least: only the poses have a gradient.
  const Eigen::VectorXd by_all = GradientByCeres(problem, {}, &cost);
  ASSERT_GT(by_all.size(), by_poses.size());
  const double by_lines_squared = by_all.squaredNorm() - by_poses.squaredNorm();
  EXPECT_LE(std::abs(by_lines_squared), 1e-14 * by_poses.squaredNorm());
}

void ExpectSameOptimum(const SlamGraph& graph, const std::vector<double>& start) {
  CompressedGraph compressed(graph, start);
  const double seed_cost = compressed.Cost(compressed.poses);
  const std::vector<double> seed = compressed.poses;
  const double cost = compressed.Converge();
  EXPECT_LT(cost, 0.9 * seed_cost);
  for (const CeresOptions& options : {ExactSparseSchur(), ExactIterativeSchur()}) {
    SCOPED_TRACE(ceres::LinearSolverTypeToString(options.linear_solver_type));
    compressed.Cost(seed);
    std::vector<double> poses = seed;
    const InnerResult result =
        SolveLandmarksWithCeres(compressed.observations, compressed.landmarks, compressed.terms,
                                options, 2, nullptr, &poses);
    ASSERT_TRUE(result.usable) << result.stop_reason;
    EXPECT_NEAR(result.initial_cost, seed_cost, 1e-8 * seed_cost);
    EXPECT_NEAR(result.final_cost, cost, 1e-7 * cost) << result.stop_reason;
    EXPECT_NEAR(compressed.Cost(poses), cost, 1e-8 * cost);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_NEAR(poses[i], compressed.poses[i], 1e-5) << "pose " << i / 3;
    }
  }
}

TEST(LandmarkProblemTest, CostAndGradientAreThoseOfTheReducedSolver) {
  const NoisyRoom room = DisturbedRoom();
  ExpectSameCostAndGradient(room.graph, room.state.poses);
  const DisturbedDrive building = DisturbedBuilding();
  ExpectSameCostAndGradient(building.graph, building.poses);
}

TEST(LandmarkProblemTest, BothSolversEndAtTheSameOptimumOfARoom) {
  const NoisyRoom room = DisturbedRoom();
  ExpectSameOptimum(room.graph, room.state.poses);
}

TEST(LandmarkProblemTest, BothSolversEndAtTheSameOptimumOfABuilding) {
  const DisturbedDrive building = DisturbedBuilding();
  ExpectSameOptimum(building.graph, building.poses);
}

TEST(LandmarkProblemTest, CeresRefitsTheLinesAfterAStepOfThePoses) {
  const DisturbedDrive building = DisturbedBuilding();
  CompressedGraph compressed(building.graph, building.poses);
  std::vector<double> poses = compressed.poses;
  CeresOptions options;
  options.max_num_iterations = 1;
  const InnerResult result = SolveLandmarksWithCeres(compressed.observations, compressed.landmarks,
                                                     compressed.terms, options, 2, nullptr, &poses);
  ASSERT_NE(poses, compressed.poses);
  EXPECT_NEAR(result.final_cost, compressed.Cost(poses), 1e-5 * result.final_cost);
}

// Rounds with Ceres against rounds with the reduced solver's own steps.
class LandmarkRoundsTest : public testing::Test {
 protected:
  // Ceres' solver, or the built-in one for null.
  ReducedResult Run(const CeresOptions* ceres, const ProgressCallback& report, NoisyRoom* room) {
    return MinimizeOverLandmarks(room->graph, SurfaceOf(room->graph), factors_, reduced_,
                                 AssociationOptions(), report, &pool_, &room->state.poses, ceres);
  }

  FactorOptions factors_;
  ReducedOptions reduced_;
  ThreadPool pool_{2};
};

TEST_F(LandmarkRoundsTest, LeadToTheSamePoses) {
  NoisyRoom own = DisturbedRoom();
  const double error_before = MeanPoseError(own);
  const ReducedResult expected = Run(nullptr, nullptr, &own);
  for (const auto solver : {ceres::SPARSE_SCHUR, ceres::ITERATIVE_SCHUR, ceres::CGNR}) {
    SCOPED_TRACE(ceres::LinearSolverTypeToString(solver));
    CeresOptions options;
    options.linear_solver_type = solver;
    NoisyRoom room = DisturbedRoom();
    const ReducedResult result = Run(&options, nullptr, &room);
    EXPECT_TRUE(result.usable);
    EXPECT_TRUE(result.converged) << result.stop_reason;
    EXPECT_LT(MeanPoseError(room), 0.3 * error_before);
    // Both stop a fraction of a standard deviation short of the optimum.
    for (std::size_t i = 0; i < room.state.poses.size(); ++i) {
      EXPECT_NEAR(room.state.poses[i], own.state.poses[i], 1e-3) << "pose " << i / 3;
    }
    const LandmarkRoundSummary &first = result.rounds[0], &first_expected = expected.rounds[0];
    EXPECT_EQ(first.num_observations, first_expected.num_observations);
    EXPECT_NEAR(first.initial_cost, first_expected.initial_cost, 1e-9 * first.initial_cost);
    EXPECT_EQ(first.gate_sigmas, first_expected.gate_sigmas);
  }
}

TEST_F(LandmarkRoundsTest, EveryIterationOfCeresIsReportedWithItsRoundAndState) {
  NoisyRoom room = DisturbedRoom();
  std::vector<IterationSummary> rows;
  std::vector<double> last = room.state.poses;
  const CeresOptions options;
  const ReducedResult result = Run(
      &options,
      [&](const IterationSummary& row) {
        EXPECT_EQ(room.state.poses != last, row.cost_change > 0.0);
        last = room.state.poses;
        rows.push_back(row);
        return true;
      },
      &room);
  ASSERT_GT(result.rounds.size(), 1u);
  // Ceres keeps a step to itself that ends it by the function tolerance.
  ASSERT_GT(rows.size(), 1u);
  EXPECT_EQ(rows.front().round, 1);
  EXPECT_GT(rows.back().round, 1);
  EXPECT_LE(rows.back().round, static_cast<int>(result.rounds.size()));
  for (const IterationSummary& row : rows) EXPECT_GT(row.trust_region_radius, 0.0);
}

TEST_F(LandmarkRoundsTest, EndWhenTheCallbackSaysSo) {
  NoisyRoom room = DisturbedRoom();
  const std::vector<double> seed = room.state.poses;
  int calls = 0;
  const CeresOptions options;
  const ReducedResult result = Run(
      &options, [&](const IterationSummary&) { return ++calls < 1; }, &room);
  EXPECT_EQ(calls, 1);
  EXPECT_TRUE(result.stopped);
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(result.usable);
  ASSERT_EQ(result.rounds.size(), 1u);
  EXPECT_LT(result.rounds[0].final_cost, result.rounds[0].initial_cost);
  EXPECT_NE(room.state.poses, seed);
}

TEST_F(LandmarkRoundsTest, MoveThePosesByTheirTermsWhereThereIsNoSurface) {
  NoisyRoomOptions sparse;
  sparse.num_beams = 6;
  for (const auto solver : {ceres::SPARSE_SCHUR, ceres::ITERATIVE_SCHUR}) {
    CeresOptions options;
    options.linear_solver_type = solver;
    NoisyRoom room = MakeNoisyRoom(sparse);
    DisturbPoses(0.02, room.graph, &room.state);
    const double before = PoseTerms(room.graph, factors_).Cost(room.state.poses);
    const ReducedResult result = Run(&options, nullptr, &room);
    EXPECT_TRUE(result.usable) << result.stop_reason;
    EXPECT_EQ(result.rounds[0].num_landmarks, 0u);
    EXPECT_LT(PoseTerms(room.graph, factors_).Cost(room.state.poses), 0.5 * before);
  }
}

TEST_F(LandmarkRoundsTest, PassOnWhyCeresFailed) {
  factors_.motion.translation_floor_m = kNaN;  // a covariance that cannot be inverted
  NoisyRoom room = DisturbedRoom();
  const std::vector<double> seed = room.state.poses;
  const CeresOptions options;
  const ReducedResult result = Run(&options, nullptr, &room);
  EXPECT_FALSE(result.usable);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.rounds.size(), 1u);
  EXPECT_THAT(result.stop_reason, HasSubstr("evaluation failed"));
  EXPECT_EQ(room.state.poses, seed);
}

}  // namespace
}  // namespace plumbline
