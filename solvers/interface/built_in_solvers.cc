#include "plumbline/solvers/interface/built_in_solvers.h"

#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {
namespace {

struct BuiltInSolver {
  SolverType type;
  const Solver& (*solver)();
};
constexpr BuiltInSolver kSolvers[] = {
    {SolverType::kReduced, ReducedSolver},     {SolverType::kAlternatingCg, AlternatingCgSolver},
    {SolverType::kPublished, PublishedSolver}, {SolverType::kCeres, CeresSolver},
    {SolverType::kPoseGraph, PoseGraphSolver}, {SolverType::kSgd, SgdSolver}};

const Solver& SolverOf(SolverType type) {
  for (const BuiltInSolver& built_in : kSolvers) {
    if (built_in.type == type) return built_in.solver();
  }
  return ReducedSolver();
}

}  // namespace

const char* ToString(SolverType type) { return SolverOf(type).name(); }

bool FromString(const std::string& name, SolverType* type) {
  for (const BuiltInSolver& built_in : kSolvers) {
    if (name == built_in.solver().name()) {
      *type = built_in.type;
      return true;
    }
  }
  return false;
}

const Solver& SolverOf(const SolverOptions& options) {
  if (options.own_solver != nullptr) return *options.own_solver;
  if (options.type == SolverType::kCeres && options.ceres->reduced) return CeresReducedSolver();
  return SolverOf(options.type);
}

}  // namespace plumbline
