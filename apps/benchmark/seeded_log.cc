#include "plumbline/apps/benchmark/seeded_log.h"

#include <utility>

#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {
namespace {

Status SimulateBuilding(SlamGraph* graph) {
  SimulatedLog log;
  PLUMBLINE_RETURN_IF_ERROR(
      Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), SimulationOptions(), &log));
  return MakeGraph(log, graph);
}

}  // namespace

Status ReadDrive(const std::string& log, SlamGraph* graph) {
  LogNotes notes;
  return log.empty() ? SimulateBuilding(graph) : ReadLogIntoGraph(log, 0, &notes, graph);
}

Status PrepareDrive(const std::string& log, const MapLogOptions& options, LogMapping* mapping) {
  SlamGraph graph;
  PLUMBLINE_RETURN_IF_ERROR(ReadDrive(log, &graph));
  ThreadPool pool(options.solver.num_threads);
  return PrepareLog(options, std::move(graph), &pool, mapping);
}

Status SeedPreparedDrive(const MapLogOptions& options, LogMapping* mapping, SolverOptions* solver) {
  ThreadPool pool(options.solver.num_threads);
  PLUMBLINE_RETURN_IF_ERROR(SeedLog(options, {}, &pool, mapping));
  *solver = RefinementOptions(options, *mapping);
  return Status::Ok();
}

}  // namespace plumbline
