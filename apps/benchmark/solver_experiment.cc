#include "plumbline/apps/benchmark/solver_experiment.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/benchmark/comparison_report.h"
#include "plumbline/apps/benchmark/seeded_log.h"
#include "plumbline/apps/benchmark/study_flags.h"
#include "plumbline/apps/run/flags.h"
#include "plumbline/solvers/interface/ceres_options.h"

namespace plumbline {
namespace {

bool IsGiven(const char* flag) { return !gflags::GetCommandLineFlagInfoOrDie(flag).is_default; }

Status ComparisonOptionsFromFlags(ComparisonOptions* options) {
  options->repeats = FLAGS_repeats;
  options->time_limit_s = FLAGS_time_limit_s;
  std::string error;
  if (!options->Check(&error)) return Status::InvalidArgument("the flags set " + error);
  return Status::Ok();
}

// The marginal energy of every row is computed with the flags that all solvers of returns read.
bool IsReadByEvaluation(const std::string& flag) {
  SolverOptions over_landmarks, over_points;
  over_landmarks.type = SolverType::kReduced;
  over_points.type = SolverType::kAlternatingCg;
  return !IsIgnored(flag, over_landmarks, StartType::kOdometry) &&
         !IsIgnored(flag, over_points, StartType::kOdometry);
}

Status CheckSomeEntryReadsEachFlag(const std::vector<ComparedSolver>& solvers, StartType start) {
  std::vector<gflags::CommandLineFlagInfo> flags;
  gflags::GetAllFlags(&flags);
  for (const gflags::CommandLineFlagInfo& flag : flags) {
    if (flag.is_default || IsReadByEvaluation(flag.name)) continue;
    const bool is_ignored = std::all_of(
        solvers.begin(), solvers.end(),
        [&](const ComparedSolver& solver) { return IsIgnored(flag.name, solver.options, start); });
    if (!is_ignored) continue;
    return Status::InvalidArgument("--" + flag.name + " is ignored by every entry of --solvers");
  }
  return Status::Ok();
}

Status SolversFromFlags(const MapLogOptions& options, std::vector<ComparedSolver>* solvers) {
  const SolverOptions& base = options.solver;
  ComparisonLimits limits;
  const std::vector<std::string> given = GivenCeresFields();
  if (std::find(given.begin(), given.end(), "max_num_iterations") != given.end()) {
    limits.line_search_iterations = base.ceres->max_num_iterations;
  }
  if (IsGiven("cg_max_sweeps")) limits.cg_sweeps = base.alternating_cg.max_sweeps;
  const Status status = ParseSolvers(FLAGS_solvers, base, limits, solvers);
  if (!status.ok()) return Status::InvalidArgument("--solvers: " + status.message());
  PLUMBLINE_RETURN_IF_ERROR(CheckSomeEntryReadsEachFlag(*solvers, options.start));
  return CheckCeresFlagsCount(*solvers, base, given, IsGiven("reduced"));
}

Status MapOptionsFromFlags(MapLogOptions* options) {
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&options->solver));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&options->seeding));
  return StartFromFlags(options->solver, &options->start);
}

// The start of every solver. Solvers of relative poses alone get the pose graph of the seeding,
// wherever they start. The solvers take over the noise that the log shows.
Status MakeProblem(const MapLogOptions& options, const std::string& log,
                   std::vector<ComparedSolver>* solvers, ComparedProblem* problem) {
  LogMapping mapping;
  SolverOptions refined;
  PLUMBLINE_RETURN_IF_ERROR(PrepareDrive(log, options, &mapping));
  const bool needs_pose_graph =
      std::any_of(solvers->begin(), solvers->end(),
                  [](const ComparedSolver& of) { return of.options.MovesPosesOnly(); });
  if (needs_pose_graph && options.start != StartType::kSeed) {
    MapLogOptions seeded = options;
    seeded.start = StartType::kSeed;
    LogMapping seed = mapping;
    PLUMBLINE_RETURN_IF_ERROR(SeedPreparedDrive(seeded, &seed, &refined));
    problem->pose_graph = std::move(seed.report.seeding.pose_graph);
  }
  PLUMBLINE_RETURN_IF_ERROR(SeedPreparedDrive(options, &mapping, &refined));
  if (options.start == StartType::kSeed) {
    problem->pose_graph = std::move(mapping.report.seeding.pose_graph);
  }
  for (ComparedSolver& solver : *solvers) solver.options.factors = refined.factors;
  problem->graph = std::move(mapping.graph);
  problem->start = std::move(mapping.state);
  return Status::Ok();
}

void PrintRun(const SolverRun& run) {
  std::cout << "  " << run.solver << ", run " << run.repeat << ": ";
  if (run.failure.empty()) {
    std::cout << run.num_iterations << " iterations, " << std::fixed << std::setprecision(2)
              << run.time_s() << " s\n";
  } else {
    std::cout << "failed: " << run.failure << '\n';
  }
  std::cout << std::flush;
}

Status WriteComparison(const OutputFolder& output, const Comparison& comparison, HtmlReport* page) {
  std::cout << ComparisonTable(comparison);
  PLUMBLINE_RETURN_IF_ERROR(WriteComparisonJson(output.File("solver_comparison.json"), comparison));
  PLUMBLINE_RETURN_IF_ERROR(WriteComparisonCsv(output.File("solver_comparison.csv"), comparison));
  if (BestEnergy(comparison.runs) == std::numeric_limits<double>::infinity()) {
    return Status::InvalidArgument("no run came to its end");
  }
  AddComparison(comparison, page);
  return WriteComparisonPlot(output.File("solver_comparison.png"), comparison);
}

}  // namespace

Status CheckComparisonNumbers() {
  ComparisonOptions options;
  return ComparisonOptionsFromFlags(&options);
}

Status CheckComparedSolvers() {
  MapLogOptions options;
  std::vector<ComparedSolver> solvers;
  PLUMBLINE_RETURN_IF_ERROR(MapOptionsFromFlags(&options));
  return SolversFromFlags(options, &solvers);
}

Status CompareSolversByFlags(const std::string& log, const std::string& relations,
                             const OutputFolder& output, HtmlReport* page) {
  Comparison comparison;
  MapLogOptions options;
  ComparedProblem problem;
  PLUMBLINE_RETURN_IF_ERROR(ComparisonOptionsFromFlags(&comparison.options));
  PLUMBLINE_RETURN_IF_ERROR(MapOptionsFromFlags(&options));
  PLUMBLINE_RETURN_IF_ERROR(SolversFromFlags(options, &comparison.solvers));
  if (!relations.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(ReadRelations(relations, &problem.relations));
  }
  PLUMBLINE_RETURN_IF_ERROR(MakeProblem(options, log, &comparison.solvers, &problem));
  comparison.input = log.empty() ? "simulated building" : log;
  comparison.start = ToString(options.start);
  comparison.num_scans = problem.graph.num_scans();
  comparison.num_returns = problem.graph.num_returns();
  std::cout << comparison.input << ": " << comparison.num_scans << " scans, "
            << comparison.num_returns << " returns, start: " << comparison.start << "; "
            << options.solver.num_threads << " threads\n";
  comparison.runs = CompareSolvers(comparison.solvers, problem, comparison.options, PrintRun);
  return WriteComparison(output, comparison, page);
}

}  // namespace plumbline
