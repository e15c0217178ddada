#include "plumbline/apps/pose_graph_run.h"

#include <Eigen/Core>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/map_picture.h"
#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/stage.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/marginal_energy.h"
#include "plumbline/solvers/pose_graph/refine_pose_graph.h"
#include "plumbline/solvers/solve.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

std::vector<Pose2> PosesOf(const SlamGraph& graph) {
  std::vector<Pose2> poses;
  for (int i = 0; i < graph.num_poses(); ++i) poses.push_back(graph.WorldFromRobot(i));
  return poses;
}

// One run, step by step.
class PoseGraphRun {
 public:
  explicit PoseGraphRun(const PoseGraphRunOptions& options)
      : options_(options), pool_(options.solver.num_threads) {}

  Status Run() {
    PLUMBLINE_RETURN_IF_ERROR(Read());
    PLUMBLINE_RETURN_IF_ERROR(MakeOutputFolder());
    PLUMBLINE_RETURN_IF_ERROR(RecordMap("given", "map_given.png"));
    RefineByEdges();
    PLUMBLINE_RETURN_IF_ERROR(RecordMap("pose graph", "map_pose_graph.png"));
    if (has_scans()) PLUMBLINE_RETURN_IF_ERROR(RefineJointly());
    return WriteResults();
  }

 private:
  bool has_scans() const { return file_.graph.num_returns() > 0; }

  Status Read() {
    PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraphFile(options_.log, &file_));
    std::cout << "Read " << options_.log << " (" << ToString(file_.format)
              << "): " << file_.graph.num_poses() << " poses, "
              << file_.graph.relative_poses().size() << " edges, " << file_.graph.num_scans()
              << " scans, " << file_.graph.num_returns() << " returns\n";
    return Status::Ok();
  }

  Status MakeOutputFolder() const {
    std::error_code error;
    std::filesystem::create_directories(options_.output_dir, error);
    if (!error) return Status::Ok();
    return Status::Unavailable("cannot make the folder '" + options_.output_dir +
                               "': " + error.message());
  }

  void RefineByEdges() {
    given_poses_ = file_.graph.poses();
    edges_summary_ = RefinePoseGraph(&file_.graph);
    std::cout << edges_summary_.BriefReport() << '\n';
  }

  // The edges' optimum is where to start from, unless the scans know better: a graph that came in
  // refined, with edges that are not as good as their covariances say.
  void ChooseJointStart() {
    SlamGraph& graph = file_.graph;
    const FactorOptions& factors = options_.solver.factors;
    const std::vector<Eigen::Vector2f> normals =
        EstimateReturnNormals(graph, NormalOptionsFor(factors.beam), &pool_);
    // The widest neighbourhoods: the narrow ones do not see a double wall.
    const auto energy = [&] {
      return MarginalEnergy(normals, factors, options_.solver.association,
                            options_.solver.rounds.coarse_radius_m, &pool_, &graph);
    };
    const double after_edges = energy();
    const std::vector<double> poses_after_edges = graph.poses();
    graph.poses() = given_poses_;
    joint_starts_as_given_ = energy() < after_edges;
    if (!joint_starts_as_given_) graph.poses() = poses_after_edges;
    graph.ResetPointsFromPoses();
    std::cout << "Edges and scans together: starting at the "
              << (joint_starts_as_given_ ? "given poses, which fit them better\n"
                                         : "optimum of the edges\n");
  }

  Status RefineJointly() {
    ChooseJointStart();
    SolverOptions options = options_.solver;
    std::cout << ProgressHeader() << '\n';
    options.callback = [](const IterationSummary& iteration) {
      std::cout << ProgressRow(iteration) << '\n' << std::flush;
      return true;
    };
    joint_summary_ = Solve(options, &file_.graph);
    if (!joint_summary_.IsSolutionUsable()) {
      return Status::InvalidArgument(joint_summary_.message);
    }
    std::cout << '\n' << joint_summary_.FullReport() << '\n';
    return Status::Ok();
  }

  Status WriteResults() {
    const std::string graph_name = std::string("graph.") + ToString(file_.format);
    PLUMBLINE_RETURN_IF_ERROR(
        WriteTumTrajectory(Path("trajectory.tum"), TrajectoryOf(file_.graph)));
    PLUMBLINE_RETURN_IF_ERROR(WritePoseGraphFile(Path(graph_name), file_));
    if (has_scans()) PLUMBLINE_RETURN_IF_ERROR(WriteMap());
    PLUMBLINE_RETURN_IF_ERROR(WriteSummary());
    if (has_scans()) std::cout << StageTable(stages_) << '\n';
    std::cout << "Results in " << options_.output_dir << ": trajectory.tum, " << graph_name
              << (has_scans() ? ", points.ply, map_given.png, map_pose_graph.png, map_refined.png"
                              : "")
              << ", summary.json\n";
    return Status::Ok();
  }

  Status WriteMap() {
    PLUMBLINE_RETURN_IF_ERROR(WritePointsPly(Path("points.ply"), file_.graph));
    const std::vector<double> optimised = file_.graph.points();
    file_.graph.ResetPointsFromPoses();
    AddStage("refined, raw ranges");
    file_.graph.points() = optimised;
    return RecordMap("refined, optimised points", "map_refined.png");
  }

  // What a stage's map looks like and how good it is; nothing without scans.
  Status RecordMap(const std::string& stage, const std::string& picture) {
    if (!has_scans()) return Status::Ok();
    AddStage(stage);
    MapPictureOptions options;
    options.title = stage;
    options.max_side_px = options_.picture_side_px;
    return WriteMapPicture(Path(picture), file_.graph, options);
  }

  void AddStage(const std::string& name) {
    stages_.push_back(MeasureStage(name, file_.graph, nullptr, &pool_));
  }

  Json EdgesJson() const {
    Json json = {{"chi2_given", edges_summary_.given_chi2},
                 {"chi2_pose_graph", edges_summary_.final_chi2},
                 {"chi2_final", GraphChi2(file_.graph.relative_poses(), PosesOf(file_.graph))},
                 {"start", ToString(edges_summary_.start)},
                 {"iterations", edges_summary_.optimization.iterations},
                 {"converged", edges_summary_.optimization.converged},
                 {"stop_reason", edges_summary_.optimization.stop_reason},
                 {"time_s", edges_summary_.time_s}};
    if (edges_summary_.chordal_chi2) json["chi2_chordal"] = *edges_summary_.chordal_chi2;
    return json;
  }

  Json JointJson() const {
    return {{"start", joint_starts_as_given_ ? "given" : "pose graph"},
            {"solver", joint_summary_.solver},
            {"termination", ToString(joint_summary_.termination)},
            {"message", joint_summary_.message},
            {"marginal_energy_seed", joint_summary_.seed_marginal_energy},
            {"marginal_energy_final", joint_summary_.final_marginal_energy},
            {"time_s", joint_summary_.total_time_s}};
  }

  Json StagesJson() const {
    Json json = Json::array();
    for (const Stage& stage : stages_) {
      json.push_back({{"stage", stage.name},
                      {"wall_thickness_m", stage.quality.wall_thickness_m},
                      {"mean_map_entropy", stage.quality.mean_map_entropy}});
    }
    return json;
  }

  Status WriteSummary() const {
    Json json = {{"log", options_.log},
                 {"format", ToString(file_.format)},
                 {"poses", file_.graph.num_poses()},
                 {"fixed_poses", file_.graph.fixed_poses().size()},
                 {"edges", file_.graph.relative_poses().size()},
                 {"scans", file_.graph.num_scans()},
                 {"returns", file_.graph.num_returns()},
                 {"pose_graph", EdgesJson()}};
    if (has_scans()) {
      json["joint"] = JointJson();
      json["stages"] = StagesJson();
    }
    AtomicFile file;
    PLUMBLINE_RETURN_IF_ERROR(file.Open(Path("summary.json")));
    // A path need not be UTF-8; JSON must be.
    file.stream() << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    return file.Commit();
  }

  std::string Path(const std::string& name) const {
    return (std::filesystem::path(options_.output_dir) / name).string();
  }

  const PoseGraphRunOptions& options_;
  ThreadPool pool_;
  PoseGraphFile file_;
  std::vector<double> given_poses_;
  bool joint_starts_as_given_ = false;
  PoseGraphSummary edges_summary_;
  SolverSummary joint_summary_;
  std::vector<Stage> stages_;
};

}  // namespace

Status RunPoseGraph(const PoseGraphRunOptions& options) { return PoseGraphRun(options).Run(); }

}  // namespace plumbline
