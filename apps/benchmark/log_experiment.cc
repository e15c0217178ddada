#include "plumbline/apps/benchmark/log_experiment.h"

#include <chrono>
#include <utility>

#include "plumbline/apps/benchmark/corrected_log.h"
#include "plumbline/apps/evaluation/alignment.h"
#include "plumbline/apps/figures/choose_details.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/graph_poses.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/solve.h"

namespace plumbline {
namespace {

constexpr int kNumDetails = 2;
constexpr double kDetailM = 3.0;  // a piece of a room

using Clock = std::chrono::steady_clock;

void SetPoses(const std::vector<Pose2>& poses, SlamGraph* graph) {
  for (int pose = 0; pose < graph->num_poses(); ++pose) graph->SetPose(pose, poses[pose]);
  graph->ResetPointsFromPoses();
}

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
      : inputs_(inputs), done_(std::move(done)), pool_(inputs.solver.num_threads) {}

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
    PLUMBLINE_RETURN_IF_ERROR(RunWholeLog(log));
    if (!inputs_.corrected_log.empty()) PLUMBLINE_RETURN_IF_ERROR(RunCorrectedLog(pair));
    *experiment = std::move(result_);
    return Status::Ok();
  }

 private:
  Status RunWholeLog(const CarmenLog& log) {
    PLUMBLINE_RETURN_IF_ERROR(Start("raw log", log));
    AddStage("odometry", 0.0);
    PLUMBLINE_RETURN_IF_ERROR(ChainPairs(IcpMetric::kPointToPoint, "pairwise ICP, point to point"));
    PLUMBLINE_RETURN_IF_ERROR(ChainPairs(IcpMetric::kPointToLine, "pairwise ICP, point to line"));
    AddPanel("pairwise ICP");
    SeedingReport seeding;
    PLUMBLINE_RETURN_IF_ERROR(Seed(&seeding));
    const std::vector<Pose2> seed = PosesOf(graph_);
    AddDescent(seeding);
    AddPanel("gradient descent (SGD)");
    SetPoses(seed, &graph_);
    AddStage("seed (pose graph)", seed_time_s_);
    AddPanel("pose graph, Plumbline's seed");
    PLUMBLINE_RETURN_IF_ERROR(Refine(seeding.odometry_noise));
    AddPanel("Plumbline, poses and points");
    FinishFigure();
    return Status::Ok();
  }

  Status RunCorrectedLog(const CorrectedLog& pair) {
    PLUMBLINE_RETURN_IF_ERROR(Start("corrected poses", pair.corrected));
    AddStage("as corrected", 0.0);
    PLUMBLINE_RETURN_IF_ERROR(Refine({}));
    PLUMBLINE_RETURN_IF_ERROR(Start("the same scans, raw odometry", pair.raw));
    AddStage("odometry", 0.0);
    SeedingReport seeding;
    PLUMBLINE_RETURN_IF_ERROR(Seed(&seeding));
    AddStage("seed (pose graph)", seed_time_s_);
    return Refine(seeding.odometry_noise);
  }

  Status Start(const std::string& name, const CarmenLog& log) {
    const Status built = BuildGraph(log, 0, &graph_);
    if (!built.ok()) return Status::InvalidArgument(inputs_.log + ": " + built.message());
    if (graph_.num_returns() == 0) {
      return Status::InvalidArgument(inputs_.log + ": no scan has a return within range");
    }
    normals_ = EstimateReturnNormals(graph_, NormalOptionsFor(inputs_.solver.factors.beam), &pool_);
    result_.starts.push_back({name, graph_.num_scans(), graph_.num_returns(), {}});
    return Status::Ok();
  }

  // Leaves the result in the graph; all metrics start from the odometry, which edges hold.
  Status ChainPairs(IcpMetric metric, const std::string& name) {
    PairwiseIcpOptions options = inputs_.icp;
    options.metric = metric;
    PairwiseIcpReport report;
    const auto start = Clock::now();
    PLUMBLINE_RETURN_IF_ERROR(plumbline::ChainPairs(options, normals_, &pool_, &graph_, &report));
    AddStage(name, SecondsSince(start));
    return Status::Ok();
  }

  Status Seed(SeedingReport* report) {
    const auto start = Clock::now();
    PLUMBLINE_RETURN_IF_ERROR(SeedGraph(inputs_.seeding, inputs_.solver.factors.motion, normals_,
                                        {}, &pool_, &graph_, report));
    seed_time_s_ = SecondsSince(start);
    return Status::Ok();
  }

  void AddDescent(const SeedingReport& seeding) {
    std::vector<Pose2> poses = seeding.sequential_poses;
    const auto start = Clock::now();
    DescendStochastically(seeding.pose_graph, inputs_.descent, &poses);
    const double time_s = SecondsSince(start);
    SetPoses(poses, &graph_);
    AddStage("gradient descent (SGD) on its pose graph", time_s);
  }

  // odometry_noise: as the seeding found it, if there was one.
  Status Refine(const OdometryNoiseReport& odometry_noise) {
    const auto start = Clock::now();
    SolverOptions solver = inputs_.solver;
    solver.factors.motion = RefinementMotion(odometry_noise, solver.factors.motion);
    const SolverSummary summary = Solve(solver, &graph_);
    if (!summary.IsSolutionUsable()) return Status::InvalidArgument(summary.message);
    const double time_s = SecondsSince(start);
    const std::vector<double> points = graph_.points();
    graph_.ResetPointsFromPoses();
    LogStage* stage = Measure("refined", time_s);
    graph_.points() = points;
    stage->points = MeasureSharpness(points, &pool_);
    Report();
    return Status::Ok();
  }

  LogStage* Measure(const std::string& name, double time_s) {
    LogStage stage;
    stage.name = name;
    stage.time_s = time_s;
    if (!relations_.empty()) {
      stage.relations = MeasureRelations(relations_, TrajectoryOf(graph_), RelationsOptions());
    }
    stage.raw_ranges = MeasureSharpness(graph_.points(), &pool_);
    std::vector<LogStage>* stages = &result_.starts.back().stages;
    stages->push_back(std::move(stage));
    return &stages->back();
  }

  void AddStage(const std::string& name, double time_s) {
    Measure(name, time_s);
    Report();
  }

  void Report() const {
    if (done_) done_(result_.starts.back(), result_.starts.back().stages.back());
  }

  void AddPanel(const std::string& title) {
    result_.maps.panels.push_back({title, graph_.points(), PosesOf(graph_), {}});
  }

  // The last panel is what the others are compared with.
  void FinishFigure() {
    std::vector<MapPanel>* panels = &result_.maps.panels;
    const MapPanel& refined = panels->back();
    for (std::size_t i = 0; i + 1 < panels->size(); ++i) Align(refined, &(*panels)[i]);
    const MapPanel& seed = (*panels)[panels->size() - 2];
    result_.maps.details = ChooseDetails(seed.points, refined.points, kNumDetails, kDetailM);
  }

  const LogExperimentInputs& inputs_;
  const std::function<void(const LogStart&, const LogStage&)> done_;
  ThreadPool pool_;
  std::vector<Relation> relations_;
  SlamGraph graph_;
  std::vector<Eigen::Vector2f> normals_;
  double seed_time_s_ = 0.0;
  LogExperiment result_;
};

}  // namespace

Status RunLogExperiment(const LogExperimentInputs& inputs,
                        const std::function<void(const LogStart&, const LogStage&)>& done,
                        LogExperiment* experiment) {
  return Experiment(inputs, done).Run(experiment);
}

}  // namespace plumbline
