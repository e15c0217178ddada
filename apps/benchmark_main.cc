// Runs an experiment over many simulated drives and sums up what came of it.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <chrono>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/seeding_study.h"
#include "plumbline/apps/command_line.h"
#include "plumbline/apps/flags.h"

DEFINE_string(experiment, "", "What to run: seeding_study");
DEFINE_string(csv, "", "Table to write, one line per run (empty: none)");
DEFINE_int32(buildings, 200, "seeding_study: simulated buildings, one run each");

namespace plumbline {
namespace {

Status SeedingStudy() {
  if (FLAGS_buildings <= 0) return Status::InvalidArgument("--buildings must be > 0");
  SolverOptions solver;
  SeedingOptions seeding;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&seeding));
  ThreadPool pool(solver.num_threads);
  const auto start = std::chrono::steady_clock::now();
  std::vector<SeedingOutcome> outcomes;
  PLUMBLINE_RETURN_IF_ERROR(
      RunSeedingStudy(SeedingCases(FLAGS_buildings), seeding, solver.factors, &pool, &outcomes));
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;
  if (!FLAGS_csv.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteSeedingCsv(FLAGS_csv, outcomes));
  std::cout << SeedingTable(outcomes) << outcomes.size() << " runs in " << std::fixed
            << std::setprecision(1) << duration.count() << " s on " << pool.num_threads()
            << " threads\n";
  return Status::Ok();
}

struct Experiment {
  const char* name;
  Status (*run)();
};
constexpr Experiment kExperiments[] = {{"seeding_study", SeedingStudy}};

Status Run() {
  for (const Experiment& experiment : kExperiments) {
    if (FLAGS_experiment == experiment.name) return experiment.run();
  }
  return Status::InvalidArgument("--experiment='" + FLAGS_experiment +
                                 "': there is none of that name; see --help");
}

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  FLAGS_logtostderr = true;
  plumbline::ParseCommandLine(
      "Runs an experiment over many simulated drives and sums up what came of it.\n\n"
      "  plumbline_benchmark --experiment=seeding_study --buildings=200 --csv=seeding_study.csv",
      argc, argv);
  const plumbline::Status status = plumbline::Run();
  if (status.ok()) return 0;
  std::cerr << "plumbline_benchmark: " << status.message() << '\n';
  return 1;
}
