#include "plumbline/apps/benchmark/solver_run.h"

#include <unistd.h>

#include <algorithm>
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
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/marginal_energy.h"
#include "plumbline/solvers/refine_state.h"

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

// Which states of a trace are evaluated, which takes as long as several iterations of a fast
// solver: the ends, and at most `max_states` between them, evenly spaced in the logarithm of time.
std::vector<bool> StatesToEvaluate(const std::vector<TracePoint>& trace, std::size_t max_states) {
  std::vector<bool> kept(trace.size(), trace.size() <= max_states);
  kept.front() = kept.back() = true;
  if (kept.size() <= max_states) return kept;
  const double first_s = std::max(trace[1].time_s, 1e-6);
  const double step =
      std::log(std::max(1.0, trace.back().time_s / first_s)) / static_cast<double>(max_states);
  double next = 0.0;
  for (std::size_t i = 1; i + 1 < trace.size(); ++i) {
    const double log_time = std::log(std::max(1.0, trace[i].time_s / first_s));
    if (log_time < next) continue;
    kept[i] = true;
    next = std::max(next, log_time) + step;
  }
  return kept;
}

// A solver that its callback does not stop is killed after so many seconds.
unsigned LastSecond(double time_limit_s) { return 1 + static_cast<unsigned>(2.0 * time_limit_s); }

// One run, step by step.
class TracedRun {
 public:
  TracedRun(const ComparedSolver& solver, const ComparedProblem& problem, double time_limit_s)
      : solver_(solver),
        time_limit_s_(time_limit_s),
        problem_(problem),
        graph_(problem.graph),
        state_(problem.start),
        states_(problem.start.poses.size()) {
    run_.solver = solver.name;
  }

  SolverRun Run() {
    Record({}, state_.poses);
    if (stored_) Minimise();
    if (run_.failure.empty() && !stored_) run_.failure = "no room for a temporary file";
    if (run_.failure.empty()) Evaluate();
    return std::move(run_);
  }

 private:
  void Record(const Seconds& time, const std::vector<double>& poses) {
    stored_ = stored_ && states_.Add(poses);
    run_.trace.push_back({static_cast<int>(run_.trace.size()), time.wall, time.cpu, 0.0});
  }

  void Minimise() {
    if (!solver_.options.MovesPosesOnly()) return Minimise(graph_);
    SlamGraph with_edges = graph_;
    for (const RelativePoseConstraint& edge : problem_.pose_graph) {
      with_edges.AddRelativePose(edge);
    }
    Minimise(with_edges);
  }

  void Minimise(const SlamGraph& graph) {
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
    alarm(LastSecond(time_limit_s_));
    start = Seconds::Now();
    const SolverSummary summary = RefineState(options, graph, &state_);
    const Seconds time = Seconds::Now() - start - aside;
    alarm(0);
    run_.peak_memory_bytes = PeakMemoryBytes();
    run_.num_iterations = static_cast<int>(summary.iterations.size());
    run_.num_rounds = static_cast<int>(summary.rounds.size() + summary.landmark_rounds.size());
    run_.termination = ToString(summary.termination);
    if (!summary.IsSolutionUsable()) run_.failure = summary.message;
    Record(time, state_.poses);
  }

  void Evaluate() {
    ThreadPool pool(solver_.options.num_threads);
    if (!problem_.relations.empty()) {
      const PoseErrorStatistics all =
          MeasureRelations(problem_.relations, TrajectoryOf(graph_, state_), RelationsOptions())
              .all;
      run_.relations = RelationsFigures{all.translation_m.mean, all.translation_m.std,
                                        all.rotation_deg.mean, all.rotation_deg.std};
    }
    run_.points = MeasureSharpness(state_.points, &pool);
    run_.raw_ranges = MeasureSharpness(graph_.MeasuredMap(state_.poses), &pool);
    EvaluateTrace(&pool);
  }

  void EvaluateTrace(ThreadPool* pool) {
    constexpr std::size_t kMaxStates = 200;
    const MeasuredSurface surface =
        MeasureSurface(graph_, NormalOptionsFor(solver_.options.factors.beam), pool);
    const std::vector<bool> evaluate = StatesToEvaluate(run_.trace, kMaxStates);
    states_.Rewind();
    std::vector<TracePoint> trace;
    std::vector<double> poses, evaluated;
    double energy = 0.0;
    for (std::size_t i = 0; i < run_.trace.size(); ++i) {
      if (!states_.Next(&poses)) {
        run_.failure = "the temporary file is cut short";
        return;
      }
      if (!evaluate[i]) continue;
      // Iterations on the map alone leave the poses as they are.
      if (poses != evaluated) {
        evaluated = poses;
        energy = MarginalEnergy(graph_, poses, surface, solver_.options, pool);
      }
      trace.push_back(run_.trace[i]);
      trace.back().marginal_energy = energy;
    }
    run_.trace = std::move(trace);
  }

  const ComparedSolver& solver_;
  const double time_limit_s_;
  const ComparedProblem& problem_;
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
    trace.push_back({point.iteration, point.time_s, point.cpu_time_s, point.marginal_energy});
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
    run->trace.push_back({point[0], NumberOf(point[1]), NumberOf(point[2]), NumberOf(point[3])});
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

SolverRun RunSolver(const ComparedSolver& solver, const ComparedProblem& problem,
                    double time_limit_s) {
  return TracedRun(solver, problem, time_limit_s).Run();
}

SolverRun RunSolverInChild(const ComparedSolver& solver, const ComparedProblem& problem,
                           double time_limit_s) {
  SolverRun run;
  run.solver = solver.name;
  std::string packed;
  const Seconds start = Seconds::Now();
  const Status status =
      RunInChild([&] { return Pack(RunSolver(solver, problem, time_limit_s)); }, &packed);
  if (status.ok()) {
    Unpack(packed, &run);
  } else if ((Seconds::Now() - start).wall >= LastSecond(time_limit_s)) {
    run.failure = "did not stop within twice its time limit";
  } else {
    run.failure = status.message();
  }
  return run;
}

}  // namespace plumbline
