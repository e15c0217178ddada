#include "plumbline/apps/benchmark/solver_run.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "plumbline/apps/benchmark/child_process.h"
#include "plumbline/apps/benchmark/memory_use.h"
#include "plumbline/apps/report/run_summary.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/marginal_energy.h"
#include "plumbline/solvers/solve.h"

namespace plumbline {
namespace {

using nlohmann::json;

// A moment or a span, by the clock on the wall and by that of the process [s].
struct Seconds {
  double wall = 0.0, cpu = 0.0;

  static Seconds Now() {
    const auto wall = std::chrono::steady_clock::now().time_since_epoch();
    return {std::chrono::duration<double>(wall).count(),
            static_cast<double>(std::clock()) / CLOCKS_PER_SEC};
  }
  Seconds operator-(const Seconds& other) const { return {wall - other.wall, cpu - other.cpu}; }
  Seconds& operator+=(const Seconds& other) { return *this = {wall + other.wall, cpu + other.cpu}; }
};

// Poses of many states, in a file that has no name.
class PoseStore {
 public:
  explicit PoseStore(std::size_t state_size) : file_(std::tmpfile()), state_size_(state_size) {}

  bool Add(const std::vector<double>& poses) {
    return file_ &&
           std::fwrite(poses.data(), sizeof(double), state_size_, file_.get()) == state_size_;
  }
  // States come back in the order in which they were added.
  void Rewind() { std::rewind(file_.get()); }
  bool Next(std::vector<double>* poses) {
    poses->resize(state_size_);
    return std::fread(poses->data(), sizeof(double), state_size_, file_.get()) == state_size_;
  }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Closer> file_;
  std::size_t state_size_;
};

// One run, step by step.
class TracedRun {
 public:
  TracedRun(const ComparedSolver& solver, double time_limit_s, const SlamGraph& graph,
            const MapState& seed)
      : solver_(solver),
        time_limit_s_(time_limit_s),
        graph_(graph),
        state_(seed),
        states_(seed.poses.size()) {
    run_.solver = solver.name;
  }

  SolverRun Run(const std::vector<Relation>& relations) {
    Record({}, state_.poses);
    if (stored_) Minimise();
    if (run_.failure.empty() && !stored_) run_.failure = "no room for a temporary file";
    if (run_.failure.empty()) Evaluate(relations);
    return std::move(run_);
  }

 private:
  void Record(const Seconds& time, const std::vector<double>& poses) {
    stored_ = stored_ && states_.Add(poses);
    run_.trace.push_back({time.wall, time.cpu, 0.0});
  }

  void Minimise() {
    SolverOptions options = solver_.options;
    Seconds start, aside;
    options.callback = [&](const IterationSummary& iteration) {
      const Seconds called = Seconds::Now();
      const Seconds time = called - start - aside;
      Record(time, *iteration.poses);
      aside += Seconds::Now() - called;
      return stored_ && time.wall <= time_limit_s_;
    };
    RestartPeakMemory();
    run_.start_memory_bytes = ResidentMemoryBytes();
    alarm(1 + static_cast<unsigned>(2.0 * time_limit_s_));
    start = Seconds::Now();
    const SolverSummary summary = Solve(options, graph_, &state_);
    const Seconds time = Seconds::Now() - start - aside;
    alarm(0);
    run_.peak_memory_bytes = PeakMemoryBytes();
    run_.num_iterations = static_cast<int>(summary.iterations.size());
    run_.num_rounds = static_cast<int>(summary.rounds.size() + summary.landmark_rounds.size());
    run_.termination = ToString(summary.termination);
    if (!summary.IsSolutionUsable()) run_.failure = summary.message;
    Record(time, state_.poses);
  }

  void Evaluate(const std::vector<Relation>& relations) {
    ThreadPool pool(solver_.options.num_threads);
    if (!relations.empty()) {
      const PoseErrorStatistics all =
          MeasureRelations(relations, TrajectoryOf(graph_, state_), RelationsOptions()).all;
      run_.relations = RelationsFigures{all.translation_m.mean, all.translation_m.std,
                                        all.rotation_deg.mean, all.rotation_deg.std};
    }
    run_.points = MeasureSharpness(state_.points, &pool);
    run_.raw_ranges = MeasureSharpness(graph_.MeasuredMap(state_.poses), &pool);
    EvaluateTrace(&pool);
  }

  void EvaluateTrace(ThreadPool* pool) {
    const MeasuredSurface surface =
        MeasureSurface(graph_, NormalOptionsFor(solver_.options.factors.beam), pool);
    states_.Rewind();
    std::vector<double> poses, evaluated;
    double energy = 0.0;
    for (TracePoint& point : run_.trace) {
      if (!states_.Next(&poses)) {
        run_.failure = "the temporary file is cut short";
        return;
      }
      // Iterations on the map alone leave the poses as they are.
      if (poses != evaluated) {
        evaluated = poses;
        energy = MarginalEnergy(graph_, poses, surface, solver_.options, pool);
      }
      point.marginal_energy = energy;
    }
  }

  const ComparedSolver& solver_;
  const double time_limit_s_;
  const SlamGraph& graph_;
  MapState state_;
  PoseStore states_;
  bool stored_ = true;
  SolverRun run_;
};

// What is not finite has become null.
double NumberOf(const json& from) {
  return from.is_null() ? std::numeric_limits<double>::quiet_NaN() : from.get<double>();
}

json SharpnessJson(const MapSharpness& sharpness) {
  json radii = json::array();
  for (const SharpnessAtRadius& at : sharpness.radii) {
    radii.push_back({at.radius_m, at.quality.wall_thickness_m, at.quality.mean_map_entropy,
                     at.quality.num_samples});
  }
  return {sharpness.num_points, radii};
}

MapSharpness SharpnessOf(const json& from) {
  MapSharpness sharpness;
  sharpness.num_points = from[0];
  for (const json& at : from[1]) {
    sharpness.radii.push_back({at[0], {NumberOf(at[1]), NumberOf(at[2]), at[3]}});
  }
  return sharpness;
}

// The way through the pipe: every digit of every number, in a form that no one else reads.
std::string Pack(const SolverRun& run) {
  json trace = json::array();
  for (const TracePoint& point : run.trace) {
    trace.push_back({point.time_s, point.cpu_time_s, point.marginal_energy});
  }
  json relations;
  if (run.relations) {
    const RelationsFigures& figures = *run.relations;
    relations = {figures.mean_m, figures.std_m, figures.mean_deg, figures.std_deg};
  }
  return json{run.failure,
              run.termination,
              run.num_iterations,
              run.num_rounds,
              trace,
              run.start_memory_bytes,
              run.peak_memory_bytes,
              relations,
              SharpnessJson(run.raw_ranges),
              SharpnessJson(run.points)}
      .dump(-1, ' ', false, json::error_handler_t::replace);
}

void Unpack(const std::string& packed, SolverRun* run) {
  const json from = json::parse(packed);
  run->failure = from[0].get<std::string>();
  run->termination = from[1].get<std::string>();
  run->num_iterations = from[2];
  run->num_rounds = from[3];
  for (const json& point : from[4]) {
    run->trace.push_back({NumberOf(point[0]), NumberOf(point[1]), NumberOf(point[2])});
  }
  run->start_memory_bytes = from[5];
  run->peak_memory_bytes = from[6];
  if (!from[7].is_null()) {
    run->relations = RelationsFigures{NumberOf(from[7][0]), NumberOf(from[7][1]),
                                      NumberOf(from[7][2]), NumberOf(from[7][3])};
  }
  run->raw_ranges = SharpnessOf(from[8]);
  run->points = SharpnessOf(from[9]);
}

}  // namespace

SolverRun RunSolver(const ComparedSolver& solver, const std::vector<Relation>& relations,
                    double time_limit_s, const SlamGraph& graph, const MapState& seed) {
  return TracedRun(solver, time_limit_s, graph, seed).Run(relations);
}

SolverRun RunSolverInChild(const ComparedSolver& solver, const std::vector<Relation>& relations,
                           double time_limit_s, const SlamGraph& graph, const MapState& seed) {
  SolverRun run;
  run.solver = solver.name;
  std::string packed;
  const Status status = RunInChild(
      [&] { return Pack(RunSolver(solver, relations, time_limit_s, graph, seed)); }, &packed);
  if (status.ok()) {
    Unpack(packed, &run);
  } else {
    run.failure = status.message();
  }
  return run;
}

}  // namespace plumbline
