#include "plumbline/solvers/seed.h"

#include <string>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/seeding/seed_drive.h"

namespace plumbline {

Status SeedGraph(const SeedingOptions& options, const MotionOptions& motion,
                 const MeasuredSurface& surface, const SeedingProgress& progress, ThreadPool* pool,
                 const SlamGraph& graph, MapState* state, SeedingReport* report) {
  return CatchExceptions([&] {
    const DefaultFloatEnvironment float_environment;
    PLUMBLINE_RETURN_IF_ERROR(graph.status());
    SeededDrive drive;
    PLUMBLINE_RETURN_IF_ERROR(
        SeedDrive(options, motion, surface, progress, pool, graph, &drive, report));
    MapState seed;
    seed.poses = PoseArray(drive.world_from_robot);
    seed.points = graph.MeasuredMap(seed.poses);
    *state = std::move(seed);
    return Status::Ok();
  });
}

Status SeedGraph(const SeedingOptions& options, const SolverOptions& solver_options,
                 const SlamGraph& graph, MapState* state, SeedingReport* report) {
  return CatchExceptions([&] {
    std::string error;
    if (!solver_options.Check(&error)) return Status::InvalidArgument(error);
    const FactorOptions& factors = solver_options.factors;
    ThreadPool pool(solver_options.num_threads);
    return SeedGraph(options, factors.motion,
                     MeasureSurface(graph, NormalOptionsFor(factors.beam), &pool), nullptr, &pool,
                     graph, state, report);
  });
}

}  // namespace plumbline
