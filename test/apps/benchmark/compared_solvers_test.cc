#include "plumbline/apps/benchmark/compared_solvers.h"

#include <ceres/types.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "plumbline/solvers/interface/ceres_options.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<ComparedSolver> Parsed(const std::string& list,
                                   const SolverOptions& base = SolverOptions()) {
  std::vector<ComparedSolver> solvers;
  const Status status = ParseSolvers(list, base, ComparisonLimits(), &solvers);
  EXPECT_TRUE(status.ok()) << status.message();
  return solvers;
}

std::string NameOf(const std::string& entry, const SolverOptions& base = SolverOptions()) {
  const std::vector<ComparedSolver> solvers = Parsed(entry, base);
  return solvers.size() == 1 ? solvers[0].name : "not one solver";
}

CeresOptions CeresOf(const std::string& entry) {
  const std::vector<ComparedSolver> solvers = Parsed(entry);
  return solvers.empty() ? CeresOptions() : *solvers[0].options.ceres;
}

std::string ErrorOf(const std::string& list, const SolverOptions& base = SolverOptions()) {
  std::vector<ComparedSolver> solvers = {{"unchanged", base}};
  const Status status = ParseSolvers(list, base, ComparisonLimits(), &solvers);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << list;
  EXPECT_EQ(solvers.size(), 1u);
  return status.message();
}

TEST(ComparedSolversTest, NamesOfTheDefaultsSayWhatRuns) {
  SolverOptions base;
  base.num_threads = 1;
  std::vector<std::string> names;
  for (const ComparedSolver& solver : Parsed(kDefaultSolvers, base)) {
    names.push_back(solver.name);
    EXPECT_EQ(solver.options.num_threads, 1);
  }
  EXPECT_THAT(names, testing::ElementsAre(
                         "reduced", "alternating_cg", "published",
                         "ceres reduced iterative_schur schur_jacobi", "ceres reduced sparse_schur",
                         "ceres iterative_schur schur_jacobi", "ceres sparse_schur"));
}

TEST(ComparedSolversTest, EverySolverHasItsName) {
  const std::string list = "sgd,pose_graph,ceres,published,alternating_cg,reduced";
  std::set<SolverType> types;
  for (const ComparedSolver& solver : Parsed(list)) {
    types.insert(solver.options.type);
    EXPECT_EQ(solver.name.find(ToString(solver.options.type)), 0u);
  }
  EXPECT_EQ(types.size(), 6u);
  EXPECT_EQ(NameOf("ceres"), "ceres sparse_schur");
  EXPECT_EQ(NameOf("reduced:fixed_lines"), "reduced fixed_lines");
}

TEST(ComparedSolversTest, EveryLinearSolverAndPreconditionerIsAWord) {
  for (const char* word : {"dense_normal_cholesky", "dense_qr", "sparse_normal_cholesky",
                           "dense_schur", "sparse_schur"}) {
    EXPECT_EQ(NameOf(std::string("ceres:") + word), std::string("ceres ") + word);
  }
  EXPECT_EQ(NameOf("ceres:cgnr:identity"), "ceres cgnr identity");
  for (const char* word :
       {"identity", "jacobi", "schur_jacobi", "cluster_jacobi", "cluster_tridiagonal"}) {
    EXPECT_EQ(NameOf(std::string("ceres:iterative_schur:") + word),
              std::string("ceres iterative_schur ") + word);
  }
  EXPECT_EQ(CeresOf("ceres:DENSE_QR").linear_solver_type, ceres::DENSE_QR);
  EXPECT_EQ(CeresOf("ceres:cgnr:identity").preconditioner_type, ceres::IDENTITY);
}

TEST(ComparedSolversTest, DoglegTypesImplyTheStrategy) {
  EXPECT_EQ(NameOf("ceres:dogleg"), "ceres sparse_schur traditional_dogleg");
  EXPECT_EQ(NameOf("ceres:subspace_dogleg"), "ceres sparse_schur subspace_dogleg");
  const CeresOptions options = CeresOf("ceres:reduced:dense_schur:subspace_dogleg");
  EXPECT_EQ(options.trust_region_strategy_type, ceres::DOGLEG);
  EXPECT_EQ(options.dogleg_type, ceres::SUBSPACE_DOGLEG);
  EXPECT_TRUE(options.reduced);
  EXPECT_EQ(NameOf("ceres:levenberg_marquardt"), "ceres sparse_schur");
}

TEST(ComparedSolversTest, WordsOfLineSearchesImplyTheMinimiser) {
  for (const char* word : {"steepest_descent", "lbfgs", "bfgs"}) {
    EXPECT_EQ(NameOf(std::string("ceres:") + word),
              std::string("ceres line_search ") + word + " wolfe");
  }
  for (const char* word : {"fletcher_reeves", "polak_ribiere", "hestenes_stiefel"}) {
    EXPECT_EQ(NameOf(std::string("ceres:armijo:") + word),
              std::string("ceres line_search nonlinear_conjugate_gradient ") + word + " armijo");
  }
  EXPECT_EQ(CeresOf("ceres:polak_ribiere").minimizer_type, ceres::LINE_SEARCH);
  EXPECT_EQ(NameOf("ceres:line_search"), "ceres line_search lbfgs wolfe");
  EXPECT_EQ(NameOf("ceres:reduced:wolfe"), "ceres reduced line_search lbfgs wolfe");
}

TEST(ComparedSolversTest, WordsOverrideTheBase) {
  SolverOptions base;
  base.ceres->minimizer_type = ceres::LINE_SEARCH;
  base.ceres->line_search_direction_type = ceres::BFGS;
  base.ceres->reduced = true;
  base.ceres->preconditioner_type = ceres::SCHUR_JACOBI;
  EXPECT_EQ(NameOf("ceres", base), "ceres reduced line_search bfgs wolfe");
  EXPECT_EQ(NameOf("ceres:iterative_schur", base), "ceres reduced iterative_schur schur_jacobi");
  EXPECT_EQ(NameOf("ceres:points:trust_region", base), "ceres sparse_schur");
}

TEST(ComparedSolversTest, SlowMinimisersGetIterationsToConverge) {
  EXPECT_EQ(CeresOf("ceres:lbfgs").max_num_iterations, 300);
  EXPECT_EQ(CeresOf("ceres:sparse_schur").max_num_iterations, CeresOptions().max_num_iterations);
  EXPECT_EQ(Parsed("alternating_cg")[0].options.alternating_cg.max_sweeps, 100);
  ComparisonLimits limits;
  limits.line_search_iterations = 7;
  limits.cg_sweeps = 8;
  std::vector<ComparedSolver> solvers;
  ASSERT_TRUE(ParseSolvers("ceres:lbfgs,alternating_cg", {}, limits, &solvers).ok());
  EXPECT_EQ(solvers[0].options.ceres->max_num_iterations, 7);
  EXPECT_EQ(solvers[1].options.alternating_cg.max_sweeps, 8);
}

TEST(ComparedSolversTest, ErrorsNameEntryAndWord) {
  EXPECT_THAT(ErrorOf("reduced,gauss:lbfgs"),
              AllOf(HasSubstr("entry 'gauss:lbfgs': there is no solver 'gauss'"),
                    HasSubstr("alternating_cg, published, ceres, pose_graph or sgd")));
  EXPECT_THAT(ErrorOf("ceres:lbfgs:newton"),
              AllOf(HasSubstr("entry 'ceres:lbfgs:newton': ceres has no word 'newton'"),
                    HasSubstr("sparse_schur"), HasSubstr("hestenes_stiefel")));
  EXPECT_THAT(ErrorOf("sgd:fast"), HasSubstr("entry 'sgd:fast': sgd has no word 'fast'"));
  EXPECT_THAT(ErrorOf("reduced:lines"), HasSubstr("'lines'; it has fixed_lines"));
  EXPECT_THAT(ErrorOf("published:fixed_lines"), HasSubstr("'fixed_lines'; it takes none"));
  EXPECT_THAT(ErrorOf("ceres:"), HasSubstr("entry 'ceres:': ceres has no word ''"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("entry '': there is no solver ''"));
  EXPECT_THAT(ErrorOf("reduced,,sgd"), HasSubstr("entry '': there is no solver ''"));
  EXPECT_THAT(ErrorOf("ceres::lbfgs"), HasSubstr("ceres has no word ''"));
  EXPECT_THAT(ErrorOf("reduced,"), HasSubstr("entry '': there is no solver ''"));
}

TEST(ComparedSolversTest, WordsThatContradictEachOtherAreRefused) {
  const char* const pairs[][2] = {
      {"lbfgs", "sparse_schur"},        {"sparse_schur", "dense_qr"},
      {"trust_region", "wolfe"},        {"levenberg_marquardt", "subspace_dogleg"},
      {"polak_ribiere", "lbfgs"},       {"reduced", "points"},
      {"levenberg_marquardt", "wolfe"}, {"jacobi", "lbfgs"}};
  for (const auto& [first, second] : pairs) {
    const std::string a = first, b = second;
    EXPECT_THAT(ErrorOf("ceres:" + a + ":" + b),
                HasSubstr("'" + a + "' and '" + b + "' contradict each other"));
    EXPECT_THAT(ErrorOf("ceres:" + b + ":" + a),
                HasSubstr("'" + b + "' and '" + a + "' contradict each other"));
  }
  EXPECT_EQ(NameOf("ceres:trust_region:sparse_schur:dogleg"),
            "ceres sparse_schur traditional_dogleg");
}

TEST(ComparedSolversTest, WordsWithoutEffectAreRefused) {
  EXPECT_THAT(ErrorOf("ceres:schur_jacobi"),
              HasSubstr("'schur_jacobi' changes nothing: sparse_schur takes no preconditioner"));
}

TEST(ComparedSolversTest, CombinationsThatCeresRefusesAreRefused) {
  EXPECT_THAT(ErrorOf("ceres:cgnr:schur_jacobi"),
              AllOf(HasSubstr("entry 'ceres:cgnr:schur_jacobi'"), HasSubstr("SCHUR_JACOBI")));
  EXPECT_THAT(ErrorOf("ceres:armijo"), HasSubstr("must be set to WOLFE"));
  EXPECT_THAT(ErrorOf("ceres:cgnr:dogleg"), HasSubstr("DOGLEG"));
  SolverOptions base;
  base.reduced.lines_follow = false;
  EXPECT_THAT(ErrorOf("ceres:reduced", base), HasSubstr("reduced.lines_follow = false"));
}

TEST(ComparedSolversTest, EntriesThatRunTheSameAreRefused) {
  EXPECT_THAT(ErrorOf("ceres:lbfgs,reduced,ceres:wolfe:lbfgs"),
              HasSubstr("entry 'ceres:wolfe:lbfgs': it runs 'ceres line_search lbfgs wolfe', as "
                        "entry 'ceres:lbfgs' does"));
}

TEST(ComparedSolversTest, FlagsThatNoEntryGoesByAreNamed) {
  SolverOptions base;
  base.ceres->minimizer_type = ceres::LINE_SEARCH;
  const auto check = [&](const std::string& list) {
    return CheckCeresFlagsCount(Parsed(list, base), base, {"minimizer_type"}, false);
  };
  EXPECT_TRUE(check("ceres:sparse_schur,ceres").ok());
  EXPECT_EQ(check("reduced,ceres:sparse_schur").message(),
            "--ceres=minimizer_type is ignored by every entry of --solvers");
  EXPECT_FALSE(check("reduced").ok());
}

}  // namespace
}  // namespace plumbline
