#include "plumbline/solvers/full/ceres_solver.h"

#include <ceres/types.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "plumbline/solvers/full/energy.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

/// A room small enough for dense linear algebra, off its optimum.
struct Problem {
  explicit Problem(int num_poses = 6, int num_beams = 90) {
    NoisyRoomOptions options;
    options.num_poses = num_poses;
    options.num_beams = num_beams;
    room = MakeNoisyRoom(options);
    DisturbPoses(0.01, room.graph, &room.state);
    associations = AssociationsOf(room.graph, room.state);
  }
  double Cost() const {
    ThreadPool pool(1);
    TermCosts costs;
    EXPECT_TRUE(Energy(room.graph, associations, factors, &pool)
                    .Evaluate(room.state.poses, room.state.points, &costs));
    return costs.Total();
  }
  InnerResult Solve(const CeresOptions& options, const ProgressCallback& report = nullptr) {
    return SolveWithCeres(room.graph, associations, factors, options, 2, report, &room.state);
  }

  NoisyRoom room;
  FactorOptions factors = EveryTerm();
  Associations associations;
};

void ExpectLowersTheEnergy(const CeresOptions& options) {
  Problem problem;
  const double before = problem.Cost();
  const InnerResult result = problem.Solve(options);
  ASSERT_TRUE(result.usable) << result.stop_reason;
  EXPECT_LT(result.final_cost, result.initial_cost) << result.stop_reason;
  EXPECT_GT(result.iterations, 0);
  EXPECT_FALSE(result.stop_reason.empty());
  EXPECT_NEAR(result.initial_cost, before, 1e-9 * before);
  EXPECT_NEAR(result.final_cost, problem.Cost(), 1e-9 * before);
}

/// Solves if Ceres takes the options; else they must come back with its words. Returns the former.
bool LowersTheEnergyOrIsRefused(const CeresOptions& options) {
  const Status status = CheckCeresOptions(options);
  if (status.ok()) {
    ExpectLowersTheEnergy(options);
    return true;
  }
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_GT(status.message().size(), std::string("Ceres refuses its options: ").size());
  return false;
}

TEST(CeresSolverTest, EveryTrustRegionStrategy) {
  for (const auto strategy : {ceres::LEVENBERG_MARQUARDT, ceres::DOGLEG}) {
    for (const auto dogleg : {ceres::TRADITIONAL_DOGLEG, ceres::SUBSPACE_DOGLEG}) {
      SCOPED_TRACE(std::string(ceres::TrustRegionStrategyTypeToString(strategy)) + " " +
                   ceres::DoglegTypeToString(dogleg));
      CeresOptions options;
      options.trust_region_strategy_type = strategy;
      options.dogleg_type = dogleg;
      EXPECT_TRUE(LowersTheEnergyOrIsRefused(options));
    }
  }
}

TEST(CeresSolverTest, EveryLinearSolverAndPreconditioner) {
  std::set<ceres::LinearSolverType> solvers_that_work;
  std::set<ceres::PreconditionerType> preconditioners_that_work;
  for (const auto solver :
       {ceres::DENSE_NORMAL_CHOLESKY, ceres::DENSE_QR, ceres::SPARSE_NORMAL_CHOLESKY,
        ceres::DENSE_SCHUR, ceres::SPARSE_SCHUR, ceres::ITERATIVE_SCHUR, ceres::CGNR}) {
    const bool iterative = solver == ceres::ITERATIVE_SCHUR || solver == ceres::CGNR;
    for (const auto preconditioner :
         {ceres::IDENTITY, ceres::JACOBI, ceres::SCHUR_JACOBI, ceres::CLUSTER_JACOBI,
          ceres::CLUSTER_TRIDIAGONAL, ceres::SUBSET}) {
      if (!iterative && preconditioner != ceres::JACOBI) continue;
      // Seconds each with 1098 unknowns; see DenseLinearSolversReachTheOptimumOfTheSparseOnes.
      if (solver == ceres::DENSE_QR || solver == ceres::DENSE_NORMAL_CHOLESKY) continue;
      SCOPED_TRACE(std::string(ceres::LinearSolverTypeToString(solver)) + " " +
                   ceres::PreconditionerTypeToString(preconditioner));
      CeresOptions options;
      options.linear_solver_type = solver;
      options.preconditioner_type = preconditioner;
      options.max_num_iterations = 3;
      if (!LowersTheEnergyOrIsRefused(options)) continue;
      solvers_that_work.insert(solver);
      if (iterative) preconditioners_that_work.insert(preconditioner);
    }
  }
  EXPECT_THAT(solvers_that_work,
              testing::IsSupersetOf({ceres::SPARSE_NORMAL_CHOLESKY, ceres::DENSE_SCHUR,
                                     ceres::SPARSE_SCHUR, ceres::ITERATIVE_SCHUR, ceres::CGNR}));
  EXPECT_THAT(preconditioners_that_work,
              testing::IsSupersetOf({ceres::IDENTITY, ceres::JACOBI, ceres::SCHUR_JACOBI}));
}

TEST(CeresSolverTest, EveryLineSearchDirection) {
  std::set<ceres::LineSearchDirectionType> directions_that_work;
  for (const auto direction :
       {ceres::STEEPEST_DESCENT, ceres::NONLINEAR_CONJUGATE_GRADIENT, ceres::BFGS, ceres::LBFGS}) {
    // Keeps a dense matrix of 1098^2; see BfgsAndLbfgsReachTheOptimumOfTheTrustRegion.
    if (direction == ceres::BFGS) continue;
    for (const auto search : {ceres::ARMIJO, ceres::WOLFE}) {
      SCOPED_TRACE(std::string(ceres::LineSearchDirectionTypeToString(direction)) + " " +
                   ceres::LineSearchTypeToString(search));
      CeresOptions options;
      options.minimizer_type = ceres::LINE_SEARCH;
      options.line_search_direction_type = direction;
      options.line_search_type = search;
      if (LowersTheEnergyOrIsRefused(options)) directions_that_work.insert(direction);
    }
  }
  EXPECT_THAT(directions_that_work,
              testing::IsSupersetOf(
                  {ceres::STEEPEST_DESCENT, ceres::NONLINEAR_CONJUGATE_GRADIENT, ceres::LBFGS}));
}

// The energy at which Ceres ends from the start of a problem of about 250 unknowns.
double FinalCost(CeresOptions options) {
  Problem problem(5, 24);
  options.max_num_iterations = 2000;
  options.function_tolerance = 1e-12;
  const InnerResult result = problem.Solve(options);
  EXPECT_TRUE(result.converged) << result.stop_reason;
  EXPECT_LT(result.final_cost, 0.7 * result.initial_cost);
  EXPECT_NEAR(result.final_cost, problem.Cost(), 1e-9 * result.final_cost);
  return result.final_cost;
}

TEST(CeresSolverTest, DenseLinearSolversReachTheOptimumOfTheSparseOnes) {
  const double optimum = FinalCost(CeresOptions());
  for (const auto solver : {ceres::DENSE_QR, ceres::DENSE_NORMAL_CHOLESKY, ceres::DENSE_SCHUR,
                            ceres::SPARSE_NORMAL_CHOLESKY}) {
    SCOPED_TRACE(ceres::LinearSolverTypeToString(solver));
    CeresOptions options;
    options.linear_solver_type = solver;
    EXPECT_NEAR(FinalCost(options), optimum, 1e-6 * optimum);
  }
}

TEST(CeresSolverTest, BfgsAndLbfgsReachTheOptimumOfTheTrustRegion) {
  const double optimum = FinalCost(CeresOptions());
  for (const auto direction : {ceres::BFGS, ceres::LBFGS}) {
    SCOPED_TRACE(ceres::LineSearchDirectionTypeToString(direction));
    CeresOptions options;
    options.minimizer_type = ceres::LINE_SEARCH;
    options.line_search_direction_type = direction;
    EXPECT_NEAR(FinalCost(options), optimum, 1e-6 * optimum);
  }
}

TEST(CeresSolverTest, EveryNonlinearConjugateGradient) {
  for (const auto type : {ceres::FLETCHER_REEVES, ceres::POLAK_RIBIERE, ceres::HESTENES_STIEFEL}) {
    SCOPED_TRACE(ceres::NonlinearConjugateGradientTypeToString(type));
    CeresOptions options;
    options.minimizer_type = ceres::LINE_SEARCH;
    options.line_search_direction_type = ceres::NONLINEAR_CONJUGATE_GRADIENT;
    options.nonlinear_conjugate_gradient_type = type;
    EXPECT_TRUE(LowersTheEnergyOrIsRefused(options));
  }
}

TEST(CeresSolverTest, ARefusedCombinationComesBackInCeresWords) {
  CeresOptions options;
  options.trust_region_strategy_type = ceres::DOGLEG;
  options.linear_solver_type = ceres::CGNR;
  Status status = CheckCeresOptions(options);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("DOGLEG"));

  options = CeresOptions();
  options.minimizer_type = ceres::LINE_SEARCH;
  options.line_search_type = ceres::ARMIJO;
  options.line_search_direction_type = ceres::LBFGS;
  status = CheckCeresOptions(options);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("must be set to WOLFE"));
}

TEST(CeresSolverTest, RefusesWhatWouldAbortInCeres) {
  const auto check = [](ceres::LinearSolverType solver, ceres::PreconditionerType preconditioner) {
    CeresOptions options;
    options.linear_solver_type = solver;
    options.preconditioner_type = preconditioner;
    return CheckCeresOptions(options);
  };
  EXPECT_THAT(check(ceres::CGNR, ceres::SCHUR_JACOBI).message(), HasSubstr("SCHUR_JACOBI"));
  EXPECT_THAT(check(ceres::CGNR, ceres::CLUSTER_JACOBI).message(), HasSubstr("CGNR"));
  EXPECT_THAT(check(ceres::CGNR, ceres::SUBSET).message(), HasSubstr("SUBSET"));
  EXPECT_THAT(check(ceres::ITERATIVE_SCHUR, ceres::SUBSET).message(), HasSubstr("SUBSET"));
}

TEST(CeresSolverTest, ConvergesAndSaysSo) {
  Problem problem;
  CeresOptions options;
  options.max_num_iterations = 50;
  const InnerResult result = problem.Solve(options);
  EXPECT_TRUE(result.usable);
  EXPECT_TRUE(result.converged) << result.stop_reason;
  EXPECT_FALSE(result.stopped);
  EXPECT_LT(result.iterations, 50);
  EXPECT_THAT(result.stop_reason, HasSubstr("Function tolerance"));
}

TEST(CeresSolverTest, StopsWhenTheCallbackSaysSo) {
  Problem problem;
  std::vector<IterationSummary> rows;
  const InnerResult result = problem.Solve(CeresOptions(), [&](const IterationSummary& it) {
    rows.push_back(it);
    return rows.size() < 2;
  });
  EXPECT_TRUE(result.usable);
  EXPECT_TRUE(result.stopped);
  EXPECT_FALSE(result.converged);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].phase, "joint");
  EXPECT_GT(rows[0].cost_change, 0.0);
  EXPECT_GT(rows[0].trust_region_radius, 0.0);
  EXPECT_NEAR(result.final_cost, rows[1].cost, 1e-9 * rows[1].cost);
  EXPECT_NEAR(problem.Cost(), result.final_cost, 1e-9 * result.final_cost);
}

TEST(CeresSolverTest, ACallbackSeesTheStateOfItsIteration) {
  for (const auto minimizer : {ceres::TRUST_REGION, ceres::LINE_SEARCH}) {
    SCOPED_TRACE(ceres::MinimizerTypeToString(minimizer));
    Problem problem;
    CeresOptions options;
    options.minimizer_type = minimizer;
    double last_cost = problem.Cost();
    int rows = 0;
    problem.Solve(options, [&](const IterationSummary& it) {
      const double cost = problem.Cost();
      EXPECT_NEAR(cost, it.cost, 1e-9 * cost);
      EXPECT_LT(cost, last_cost);
      last_cost = cost;
      ++rows;
      return true;
    });
    EXPECT_GT(rows, 1);
  }
}

TEST(CeresSolverTest, RefusesAStateWithoutAnEnergy) {
  Problem problem;
  MapState& state = problem.room.state;
  const Pose2 laser = problem.room.graph.WorldFromLaser(0, state.poses);
  state.points[0] = laser.x;
  state.points[1] = laser.y;
  const MapState given = state;
  const InnerResult result = problem.Solve(CeresOptions());
  EXPECT_FALSE(result.usable);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_FALSE(result.stop_reason.empty());
  EXPECT_EQ(state, given);
}

}  // namespace
}  // namespace plumbline
