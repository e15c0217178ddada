#include "plumbline/apps/benchmark/log_experiment.h"

#include <chrono>
#include <utility>

#include "plumbline/apps/benchmark/corrected_log.h"
#include "plumbline/apps/evaluation/alignment.h"
#include "plumbline/apps/figures/choose_details.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/pose_graph/stochastic_descent.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

constexpr int kNumDetails = 2;
constexpr double kDetailM = 3.0;  // a piece of a room

using Clock = std::chrono::steady_clock;

// Moves a panel onto the reference by their trajectories, which pair by index.
void Align(const MapPanel& reference, MapPanel* panel) {
  const Pose2 motion = AlignTrajectories(panel->trajectory, reference.trajectory);
  for (Pose2& pose : panel->trajectory) pose = motion * pose;
  for (std::size_t i = 0; i < panel->points.size(); i += 2) {
    const Eigen::Vector2d point = motion * Eigen::Vector2d(panel->points[i], panel->points[i + 1]);
    panel->points[i] = point.x();
    panel->points[i + 1] = point.y();
  }
}

class Experiment {
 public:
  Experiment(const LogExperimentInputs& inputs,
             std::function<void(const LogStart&, const LogStage&)> done)
      : inputs_(inputs),
        options_{StartType::kSeed, inputs.seeding, inputs.solver, {}},
        done_(std::move(done)),
        pool_(inputs.solver.num_threads) {}

  Status Run(LogExperiment* experiment) {
    result_.log = inputs_.log.substr(inputs_.log.find_last_of('/') + 1);
    if (!inputs_.relations.empty()) {
      PLUMBLINE_RETURN_IF_ERROR(ReadRelations(inputs_.relations, &relations_));
      PLUMBLINE_RETURN_IF_ERROR(FindPublishedFigures(inputs_.relations, &result_.published));
    }
    CarmenLog log;
    PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(inputs_.log, CarmenReadOptions(), &log));
    // Both logs first: a fault of the second is then found before the work on the first is done.
    CorrectedLog pair;
    if (!inputs_.corrected_log.empty()) {
      CarmenLog corrected;
      PLUMBLINE_RETURN_IF_ERROR(
          ReadCarmenLog(inputs_.corrected_log, CarmenReadOptions(), &corrected));
      PLUMBLINE_RETURN_IF_ERROR(PairCorrectedLog(log, corrected, &pair));
    }
    PLUMBLINE_RETURN_IF_ERROR(RunRawLog("raw log", log));
    if (!inputs_.corrected_log.empty()) {
      PLUMBLINE_RETURN_IF_ERROR(RunCorrectedPoses(pair.corrected));
      PLUMBLINE_RETURN_IF_ERROR(RunRawLog("the same scans, raw odometry", pair.raw));
    }
    *experiment = std::move(result_);
    return Status::Ok();
  }

 private:
  // Its figure takes the place of an earlier one.
  Status RunRawLog(const std::string& name, const CarmenLog& log) {
    PLUMBLINE_RETURN_IF_ERROR(Start(name, log));
    AddStage("odometry", mapping_.state, 0.0);
    MapState icp, published;
    PLUMBLINE_RETURN_IF_ERROR(
        ChainPairs(IcpMetric::kPointToPoint, "pairwise ICP, point to point", &icp));
    PLUMBLINE_RETURN_IF_ERROR(
        ChainPairs(IcpMetric::kPointToLine, "pairwise ICP, point to line", &icp));
    PLUMBLINE_RETURN_IF_ERROR(RunPublishedFromGlobalIcp(&published));
    double seed_time_s = 0.0;
    PLUMBLINE_RETURN_IF_ERROR(Seed(&seed_time_s));
    const MapState sgd = AddDescent(mapping_.report.seeding);
    AddStage("seed (pose graph)", mapping_.state, seed_time_s);
    MapState from_seed = mapping_.state;
    PLUMBLINE_RETURN_IF_ERROR(RunPublished("published method, from the seed", &from_seed));
    PLUMBLINE_RETURN_IF_ERROR(RefineLog(options_, &pool_, &mapping_));
    AddRefined(mapping_.report.solver);
    DrawFigure(
        {{"ICP", &icp}, {"SG", &sgd}, {"published", &published}, {"Plumbline", &mapping_.state}});
    return Status::Ok();
  }

  Status RunCorrectedPoses(const CarmenLog& corrected) {
    PLUMBLINE_RETURN_IF_ERROR(Start("corrected poses", corrected));
    AddStage("as corrected", mapping_.state, 0.0);
    MapState published = mapping_.state;
    PLUMBLINE_RETURN_IF_ERROR(
        RunPublished("published method, from the corrected poses", &published));
    const SolverSummary summary = RefineState(inputs_.solver, mapping_.graph, &mapping_.state);
    if (!summary.IsSolutionUsable()) return Status::InvalidArgument(summary.message);
    AddRefined(summary);
    return Status::Ok();
  }

  Status Start(const std::string& name, const CarmenLog& log) {
    SlamGraph graph;
    const Status built = BuildGraph(log, 0, &graph);
    if (!built.ok()) return Status::InvalidArgument(inputs_.log + ": " + built.message());
    if (graph.num_returns() == 0) {
      return Status::InvalidArgument(inputs_.log + ": no scan has a return within range");
    }
    PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options_, std::move(graph), &pool_, &mapping_));
    result_.starts.push_back({name, mapping_.graph.num_scans(), mapping_.graph.num_returns(), {}});
    return Status::Ok();
  }

  Status ChainPairs(IcpMetric metric, const std::string& name, MapState* chain) {
    PairwiseIcpOptions options = inputs_.icp;
    options.metric = metric;
    const auto start = Clock::now();
    const MeasuredSurface surface = MeasureSurface(
        mapping_.graph, NormalOptionsFor(BeamNoise(options_, mapping_.report)), &pool_);
    PLUMBLINE_RETURN_IF_ERROR(
        plumbline::ChainPairs(options, surface, &pool_, mapping_.graph, chain));
    AddStage(name, *chain, SecondsSince(start));
    return Status::Ok();
  }

  Status Seed(double* time_s) {
    const auto start = Clock::now();
    PLUMBLINE_RETURN_IF_ERROR(SeedLog(options_, {}, &pool_, &mapping_));
    *time_s = SecondsSince(start);
    return Status::Ok();
  }

  // Algorithm 1 of its paper. *published: its result.
  Status RunPublishedFromGlobalIcp(MapState* published) {
    MapLogOptions options = options_;
    options.start = StartType::kIcpGlobal;
    LogMapping mapping = mapping_;  // the start becomes part of it
    const auto start = Clock::now();
    PLUMBLINE_RETURN_IF_ERROR(SeedLog(options, {}, &pool_, &mapping));
    AddStage("global ICP", mapping.state, SecondsSince(start));
    *published = std::move(mapping.state);
    return RunPublished("published method, from that", published);
  }

  // *state: its start, then its result.
  Status RunPublished(const std::string& name, MapState* state) {
    SolverOptions options = inputs_.solver;
    options.type = SolverType::kPublished;
    const SolverSummary summary = RefineState(options, mapping_.graph, state);
    if (!summary.IsSolutionUsable()) return Status::InvalidArgument(summary.message);
    AddOptimised(name, *state, summary.total_time_s);
    return Status::Ok();
  }

  MapState AddDescent(const SeedingReport& seeding) {
    std::vector<Pose2> poses = seeding.sequential_poses;
    const auto start = Clock::now();
    DescendStochastically(seeding.pose_graph, &poses);
    const double time_s = SecondsSince(start);
    MapState state;
    state.poses = PoseArray(poses);
    state.points = mapping_.graph.MeasuredMap(state.poses);
    AddStage("gradient descent (SGD) on its pose graph", state, time_s);
    return state;
  }

  void AddRefined(const SolverSummary& summary) {
    AddOptimised("refined", mapping_.state, summary.total_time_s);
  }

  // With optimised points beside the measured ones.
  void AddOptimised(const std::string& name, const MapState& state, double time_s) {
    const MapState raw{state.poses, mapping_.graph.MeasuredMap(state.poses)};
    LogStage* stage = Measure(name, raw, time_s);
    stage->points = MeasureSharpness(state.points, &pool_);
    Report();
  }

  // A start has none of its own.
  std::vector<double> PointsOf(const MapState& state) const {
    return state.points.empty() ? mapping_.graph.MeasuredMap(state.poses) : state.points;
  }

  LogStage* Measure(const std::string& name, const MapState& state, double time_s) {
    LogStage stage;
    stage.name = name;
    stage.time_s = time_s;
    if (!relations_.empty()) {
      stage.relations =
          MeasureRelations(relations_, TrajectoryOf(mapping_.graph, state), RelationsOptions());
    }
    stage.raw_ranges = MeasureSharpness(PointsOf(state), &pool_);
    std::vector<LogStage>* stages = &result_.starts.back().stages;
    stages->push_back(std::move(stage));
    return &stages->back();
  }

  void AddStage(const std::string& name, const MapState& state, double time_s) {
    Measure(name, state, time_s);
    Report();
  }

  void Report() const {
    if (done_) done_(result_.starts.back(), result_.starts.back().stages.back());
  }

  // Lays the maps upon the last one, with details where the second one differs most from it.
  void DrawFigure(const std::vector<std::pair<const char*, const MapState*>>& maps) {
    result_.maps = MapFigure();
    std::vector<MapPanel>* panels = &result_.maps.panels;
    for (const auto& [title, map] : maps) {
      panels->push_back({title, PointsOf(*map), PosesOf(map->poses), {}});
    }
    for (std::size_t i = 0; i + 1 < panels->size(); ++i) Align(panels->back(), &(*panels)[i]);
    result_.maps.details =
        ChooseDetails((*panels)[1].points, panels->back().points, kNumDetails, kDetailM);
  }

  const LogExperimentInputs& inputs_;
  const MapLogOptions options_;
  const std::function<void(const LogStart&, const LogStage&)> done_;
  ThreadPool pool_;
  std::vector<Relation> relations_;
  LogMapping mapping_;
  LogExperiment result_;
};

}  // namespace

Status RunLogExperiment(const LogExperimentInputs& inputs,
                        const std::function<void(const LogStart&, const LogStage&)>& done,
                        LogExperiment* experiment) {
  return Experiment(inputs, done).Run(experiment);
}

}  // namespace plumbline
