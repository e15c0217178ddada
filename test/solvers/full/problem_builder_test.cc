#include "plumbline/solvers/full/problem_builder.h"

#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr int kEliminated = 0;

void ExpectValidOrdering(const JointProblem& joint, const SlamGraph& graph) {
  std::vector<double*> blocks;
  joint.problem->GetParameterBlocks(&blocks);
  EXPECT_EQ(joint.ordering->NumElements(), static_cast<int>(blocks.size()));
  int num_eliminated = 0;
  for (double* block : blocks) {
    ASSERT_TRUE(joint.ordering->IsMember(block));
    const bool eliminated = joint.ordering->GroupId(block) == kEliminated;
    num_eliminated += eliminated;
    if (eliminated) {
      EXPECT_EQ(joint.problem->ParameterBlockSize(block), 2);
    }
  }
  // Of the points that a pair joins, half can go; of the others, all.
  EXPECT_GE(num_eliminated, static_cast<int>(graph.num_returns()) / 2);

  std::vector<ceres::ResidualBlockId> residuals;
  joint.problem->GetResidualBlocks(&residuals);
  for (const ceres::ResidualBlockId residual : residuals) {
    joint.problem->GetParameterBlocksForResidualBlock(residual, &blocks);
    int num_eliminated_here = 0;
    for (double* block : blocks) {
      num_eliminated_here += joint.ordering->GroupId(block) == kEliminated;
    }
    EXPECT_LE(num_eliminated_here, 1);
  }
}

void ExpectSparseSchurLowersTheCost(const JointProblem& joint) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.linear_solver_ordering = joint.ordering;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, joint.problem.get(), &summary);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_EQ(summary.linear_solver_type_used, ceres::SPARSE_SCHUR);
  EXPECT_LT(summary.final_cost, 0.9 * summary.initial_cost);
}

TEST(ProblemBuilderTest, EliminatedPointsShareNoResidual) {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.01, room.graph, &room.state);
  const Associations associations = AssociationsOf(room.graph, room.state);
  ASSERT_GT(associations.shape_pairs.size(), 0u);
  const JointProblem joint = BuildJointProblem(room.graph, associations, EveryTerm(), &room.state);
  ExpectValidOrdering(joint, room.graph);
  ExpectSparseSchurLowersTheCost(joint);
}

TEST(ProblemBuilderTest, CeresGetsABlockPerPosePointAndMeasurement) {
  NoisyRoom room = MakeNoisyRoom();
  const Associations associations = AssociationsOf(room.graph, room.state);
  const JointProblem joint = BuildJointProblem(room.graph, associations, EveryTerm(), &room.state);
  EXPECT_EQ(static_cast<std::size_t>(joint.problem->NumParameterBlocks()),
            room.graph.num_poses() + room.graph.num_returns());
  const std::size_t counts[] = {room.graph.odometry().size(), room.graph.relative_poses().size(),
                                room.graph.num_returns(), associations.lines.CountReturns(),
                                associations.shape_pairs.size()};
  ASSERT_EQ(joint.residual_blocks.size(), std::size(counts));
  std::size_t total = 0;
  for (std::size_t term = 0; term < std::size(counts); ++term) {
    EXPECT_GT(counts[term], 0u) << term;
    EXPECT_EQ(joint.residual_blocks[term].size(), counts[term]) << term;
    total += counts[term];
  }
  EXPECT_EQ(static_cast<std::size_t>(joint.problem->NumResidualBlocks()), total);
}

TEST(ProblemBuilderTest, PairsThatChainAndRingAreOrderedToo) {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.01, room.graph, &room.state);
  Associations associations = AssociationsOf(room.graph, room.state);
  associations.shape_pairs.clear();
  std::size_t next = 200;
  const auto join = [&](std::size_t previous, std::size_t current) {
    // The other segment, of points that no other pair has, makes it a term of four.
    associations.shape_pairs.push_back({previous, current, next, next + 1, ShapeCategory::k0});
    next += 2;
  };
  for (std::size_t r = 0; r < 20; ++r) join(r, r + 1);   // a chain
  for (std::size_t r = 60; r > 40; --r) join(r, r - 1);  // one that runs back
  join(70, 75), join(75, 80), join(80, 70);              // a ring
  for (std::size_t r = 100; r < 110; ++r) join(90, r);   // a star
  const JointProblem joint = BuildJointProblem(room.graph, associations, EveryTerm(), &room.state);
  ExpectValidOrdering(joint, room.graph);
  ExpectSparseSchurLowersTheCost(joint);
}

TEST(ProblemBuilderTest, AllPointsAreEliminatedWithoutShapeTerms) {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.01, room.graph, &room.state);
  FactorOptions factors = EveryTerm();
  factors.shape = false;
  const JointProblem joint =
      BuildJointProblem(room.graph, AssociationsOf(room.graph, room.state), factors, &room.state);
  ExpectValidOrdering(joint, room.graph);
  EXPECT_EQ(joint.ordering->GroupSize(kEliminated), static_cast<int>(room.graph.num_returns()));
  EXPECT_TRUE(joint.residual_blocks[4].empty());
}

TEST(ProblemBuilderTest, APoseWithoutTermsStaysOut) {
  NoisyRoom room = MakeNoisyRoom();
  const int pose_id = room.graph.AddPose({9.0, 9.0, 0.0}, 99.0);
  room.graph.ExtendState(&room.state);
  DisturbPoses(0.01, room.graph, &room.state);
  const JointProblem joint = BuildJointProblem(room.graph, AssociationsOf(room.graph, room.state),
                                               EveryTerm(), &room.state);
  EXPECT_FALSE(joint.problem->HasParameterBlock(&room.state.poses[3 * pose_id]));
  ExpectValidOrdering(joint, room.graph);
  ExpectSparseSchurLowersTheCost(joint);
}

TEST(ProblemBuilderTest, OptimisesTheArraysOfTheState) {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.01, room.graph, &room.state);
  const MapState before = room.state;
  ExpectSparseSchurLowersTheCost(BuildJointProblem(
      room.graph, AssociationsOf(room.graph, room.state), EveryTerm(), &room.state));
  EXPECT_NE(room.state.poses, before.poses);
  EXPECT_NE(room.state.points, before.points);
}

TEST(ProblemBuilderTest, FixedPosesAreConstants) {
  NoisyRoom room = MakeNoisyRoom();
  const int lonely = room.graph.AddPose({9.0, 9.0, 0.0}, 99.0);
  for (const int pose : {3, 7, lonely}) room.graph.FixPose(pose);
  room.graph.ExtendState(&room.state);
  DisturbPoses(0.01, room.graph, &room.state);
  const MapState before = room.state;
  const JointProblem joint = BuildJointProblem(room.graph, AssociationsOf(room.graph, room.state),
                                               EveryTerm(), &room.state);
  for (int pose = 0; pose < lonely; ++pose) {
    EXPECT_EQ(joint.problem->IsParameterBlockConstant(&room.state.poses[3 * pose]),
              pose == 3 || pose == 7)
        << pose;
  }
  EXPECT_FALSE(joint.problem->HasParameterBlock(&room.state.poses[3 * lonely]));
  ExpectSparseSchurLowersTheCost(joint);
  for (int pose = 0; pose <= lonely; ++pose) {
    EXPECT_EQ(ToBlock(room.state.WorldFromRobot(pose)) == ToBlock(before.WorldFromRobot(pose)),
              pose == 3 || pose == 7 || pose == lonely)
        << pose;
  }
}

// Three poses; the first two see landmark 0, the others landmark 2. Nothing sees landmark 1 and
// pose 3; an observation without weight is none.
struct LandmarkScene {
  LandmarkScene() {
    landmarks.resize(3);
    const auto see = [&](int pose, int landmark, float weight) {
      LineObservation observation;
      observation.pose = pose;
      observation.landmark = landmark;
      observation.weight = weight;
      observation.center = {2.0F, 1.0F};
      observation.xx = observation.yy = 1.0;
      observations.observations.push_back(observation);
    };
    see(0, 0, 4.0), see(1, 0, 4.0), see(1, 1, 0.0), see(1, 2, 4.0), see(2, 2, 4.0);
  }
  LandmarkProblem Build() { return BuildLandmarkProblem(observations, landmarks, terms, &poses); }

  std::vector<LineLandmark> landmarks;
  LineObservations observations;
  PoseTerms terms{SlamGraph(), EveryTerm()};
  std::vector<double> poses = std::vector<double>(12, 0.1);
};

TEST(ProblemBuilderTest, LinesAreEliminatedAndPosesAreKept) {
  LandmarkScene scene;
  LandmarkProblem problem = scene.Build();
  EXPECT_EQ(problem.problem->NumResidualBlocks(), 4);
  EXPECT_EQ(problem.problem->NumParameterBlocks(), 5);
  EXPECT_EQ(problem.ordering->NumElements(), 5);
  EXPECT_EQ(problem.ordering->GroupSize(kEliminated), 2);
  EXPECT_EQ(problem.lines_ordering->NumElements(), 2);
  for (const int landmark : {0, 2}) {
    EXPECT_TRUE(problem.lines_ordering->IsMember(&problem.lines[2 * landmark]));
    EXPECT_EQ(problem.ordering->GroupId(&problem.lines[2 * landmark]), kEliminated);
  }
  for (const int pose : {0, 1, 2}) {
    EXPECT_EQ(problem.ordering->GroupId(&scene.poses[3 * pose]), 1);
  }
  EXPECT_FALSE(problem.problem->HasParameterBlock(&scene.poses[3 * 3]));
}

TEST(ProblemBuilderTest, FixedPosesAreConstantsBesideLandmarks) {
  LandmarkScene scene;
  scene.terms.is_constant = {false, true, false, true};
  const LandmarkProblem problem = scene.Build();
  for (const int pose : {0, 1, 2}) {
    EXPECT_EQ(problem.problem->IsParameterBlockConstant(&scene.poses[3 * pose]), pose == 1);
  }
}

TEST(ProblemBuilderTest, LinesStartAtThoseOfTheLandmarks) {
  LandmarkScene scene;
  scene.landmarks[2].normal = {-0.6, -0.8};
  scene.landmarks[2].offset_m = 0.7;
  const LandmarkProblem problem = scene.Build();
  EXPECT_NEAR(std::cos(problem.lines[4]), -0.6, 1e-15);
  EXPECT_NEAR(std::sin(problem.lines[4]), -0.8, 1e-15);
  EXPECT_EQ(problem.lines[5], 0.7);
}

TEST(ProblemBuilderTest, PosesKeepTheirTermsBesideTheLandmarks) {
  const NoisyRoom room = MakeNoisyRoom();
  LandmarkScene scene;
  scene.observations.observations.clear();
  scene.terms = PoseTerms(room.graph, EveryTerm());
  scene.poses = room.state.poses;
  const LandmarkProblem problem = scene.Build();
  EXPECT_EQ(problem.problem->NumResidualBlocks(), 11 + 2);
  double cost = 0.0;
  ASSERT_TRUE(problem.problem->Evaluate({}, &cost, nullptr, nullptr, nullptr));
  EXPECT_GT(cost, 0.1);
  EXPECT_NEAR(cost, scene.terms.Cost(scene.poses), 1e-12 * cost);
}

}  // namespace
}  // namespace plumbline
