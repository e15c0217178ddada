#include "plumbline/apps/run/pose_graph_run.h"

#include <Eigen/Core>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/readers/pose_graph_input.h"
#include "plumbline/apps/readers/pose_graph_log.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/report_sections.h"
#include "plumbline/apps/report/seeding_text.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/apps/run/memory_estimate.h"
#include "plumbline/apps/run/share_mapping.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/acceptance/mirrored_scans.h"
#include "plumbline/solvers/alarm.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/marginal_energy.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/pose_graph/refine_pose_graph.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

// Where the estimation by edges and scans starts.
enum class JointStart { kGiven, kPoseGraph, kScans };

std::string ToString(JointStart start) {
  switch (start) {
    case JointStart::kGiven:
      return "given";
    case JointStart::kScans:
      return "scans";
    default:
      return "pose graph";
  }
}

// One run, step by step.
class PoseGraphRun {
 public:
  explicit PoseGraphRun(const PoseGraphRunOptions& options)
      : options_(options),
        outputs_(options.outputs),
        pool_(options.solver.num_threads),
        output_(options.output_dir),
        solver_options_(options.solver) {}

  Status Run() {
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(options_.peers, [this] { return Start(); }));
    if (options_.peers != nullptr) PLUMBLINE_RETURN_IF_ERROR(Share());
    PLUMBLINE_RETURN_IF_ERROR(RecordMap("given", "map_given.png"));
    given_consistency_ = MeasureConsistency();
    if (by_edges_only()) {
      PLUMBLINE_RETURN_IF_ERROR(RunSolver());
    } else {
      RefineByEdges();
      PLUMBLINE_RETURN_IF_ERROR(RecordMap("pose graph", "map_pose_graph.png"));
      if (has_scans()) PLUMBLINE_RETURN_IF_ERROR(RefineJointly());
    }
    return WriteResults();
  }

 private:
  bool has_scans() const { return file_.graph.num_returns_of_all() > 0; }
  bool by_edges_only() const { return options_.solver.MovesPosesOnly(); }

  Status Start() {
    PLUMBLINE_RETURN_IF_ERROR(Read());
    if (options_.peers != nullptr && !has_scans()) {
      return Status::InvalidArgument(options_.log +
                                     ": a pose graph without scans has nothing to share among "
                                     "processes; plumbline_slam refines it");
    }
    PLUMBLINE_RETURN_IF_ERROR(CheckMemoryOfScans());
    PLUMBLINE_RETURN_IF_ERROR(CheckScans());
    KeepStopSignal();  // the given poses are a state to write
    PLUMBLINE_RETURN_IF_ERROR(output_.Make());
    return output_.RemoveOldResults();
  }

  Status Share() {
    state_ = MapState();
    file_.num_robot_poses =
        JoinOverPeers(options_.peers, std::vector<int>{file_.num_robot_poses}).front();
    PLUMBLINE_RETURN_IF_ERROR(
        ShareGraphByPlace(options_.peers, file_.graph.initial_poses(), &file_.graph));
    SaveMemory(*options_.peers, file_.graph.num_returns_of_all());
    state_ = file_.graph.InitialState();
    return Status::Ok();
  }

  Status Read() {
    PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraph(options_.log, options_.max_memory, &file_));
    state_ = file_.graph.InitialState();
    PrintWarnings(file_.warnings);
    std::cout << "Read " << Legible(options_.log) << " (" << file_.format
              << "): " << file_.graph.num_poses() << " poses, "
              << file_.graph.relative_poses().size() << " edges, " << file_.graph.num_scans()
              << " scans, " << file_.graph.num_returns() << " returns\n"
              << file_.note;
    return Status::Ok();
  }

  Status CheckMemoryOfScans() {
    if (!has_scans()) return Status::Ok();
    MemoryEstimate memory =
        EstimateMemory(file_.graph, state_, options_.solver, false, outputs_.picture_side_px);
    return FitMemory(options_.max_memory, file_.graph, options_.solver, &memory,
                     &outputs_.picture_side_px, &std::cout);
  }

  // Rather now than by the solver, with pictures written. It starts where file or edges say.
  Status CheckScans() const {
    if (!has_scans() || by_edges_only()) return Status::Ok();
    if (VoteOnTurns(file_.graph, state_.poses).SayRight()) return Status::Ok();
    MapState by_edges = state_;
    RefinePoseGraph(file_.graph, &by_edges);
    const Status mirrored = CheckScansAreNotMirrored(file_.graph, state_.poses, by_edges.poses);
    return mirrored.ok() ? mirrored
                         : Status::InvalidArgument(options_.log + ": " + mirrored.message());
  }

  void RefineByEdges() {
    edges_summary_ = RefinePoseGraph(
        file_.graph, &state_, [](double, const std::vector<Pose2>&) { return StopSignal() == 0; });
    std::cout << edges_summary_.BriefReport() << '\n';
  }

  // The edges' optimum is where to start from, unless the scans know better: a graph that came in
  // refined, with edges that are not as good as their covariances say.
  void ChooseJointStart() {
    const SlamGraph& graph = file_.graph;
    const FactorOptions& factors = options_.solver.factors;
    const MeasuredSurface surface = MeasureSurface(graph, NormalOptionsFor(factors.beam), &pool_);
    // The widest neighbourhoods: the narrow ones do not see a double wall.
    const auto energy = [&](const std::vector<double>& poses) {
      const TangentLines lines = LinesFromRadius(graph, poses, surface, options_.solver.association,
                                                 options_.solver.rounds.coarse_radius_m, &pool_);
      return MarginalEnergy(graph, poses, lines, factors, &pool_);
    };
    if (energy(graph.initial_poses()) < energy(state_.poses)) {
      start_ = JointStart::kGiven;
      state_ = graph.InitialState();
    }
    std::cout << "Edges and scans together: starting at the "
              << (start_ == JointStart::kGiven ? "given poses, which fit them better\n"
                                               : "optimum of the edges\n");
  }

  // A map that contradicts itself may be wrong throughout. Then the scans are matched as in a log.
  // If they contradict each other less in that map, it is the start, and the edges do not count.
  Status SeedByScans() {
    if (options_.peers != nullptr || !ScansAreInOrderOfTime()) return Status::Ok();
    const std::optional<MapConsistency> start = MeasureConsistency();
    if (!start || MapAlarms(*start, file_.graph, state_.poses).empty()) return Status::Ok();
    MapLogOptions options;
    options.seeding = options_.seeding;
    options.solver = options_.solver;
    LogMapping mapping;
    SlamGraph drive;
    PLUMBLINE_RETURN_IF_ERROR(LogOfPoseGraph(file_.graph, 0, &drive));
    PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, std::move(drive), &pool_, &mapping));
    if (!HasSameScans(mapping.graph)) return Status::Ok();
    const auto goes_on = [](SeedingPhase, int, int) { return StopSignal() == 0; };
    Status seeded = SeedLog(options, goes_on, &pool_, &mapping);
    if (!seeded.ok() && StopSignal() == 0) return seeded;
    const double seed_conflict = mapping.report.seeding.consistency.AllConflicts().Share();
    if (!seeded.ok() || seed_conflict >= start->AllConflicts().Share()) return Status::Ok();
    std::cout << "The given poses contradict the scans: starting where these match each other; the "
                 "edges do not count\n";
    start_ = JointStart::kScans;
    state_ = mapping.state;
    solver_options_ = RefinementOptions(options, mapping);
    graph_of_scans_ = std::move(mapping.graph);
    return Status::Ok();
  }

  // Whether a graph has the poses and returns of the file's, in the same order.
  bool HasSameScans(const SlamGraph& graph) const {
    const SlamGraph& given = file_.graph;
    if (graph.num_poses() != given.num_poses() || graph.num_scans() != given.num_scans() ||
        graph.num_returns() != given.num_returns()) {
      return false;
    }
    for (int scan = 0; scan < given.num_scans(); ++scan) {
      if (graph.scan(scan).pose != given.scan(scan).pose) return false;
    }
    return given.fixed_poses().size() == 1 && given.fixed_poses().front().pose == 0;
  }

  Status RefineJointly() {
    ChooseJointStart();
    PLUMBLINE_RETURN_IF_ERROR(SeedByScans());
    return RunSolver();
  }

  Status RunSolver() {
    SolverOptions options = solver_options_;
    std::cout << ProgressHeader() << '\n';
    options.callback = [](const IterationSummary& iteration) {
      std::cout << ProgressRow(iteration) << '\n' << std::flush;
      return StopSignal() == 0;
    };
    solver_summary_ =
        RefineState(options, graph_of_scans_ ? *graph_of_scans_ : file_.graph, &state_);
    if (!solver_summary_.IsSolutionUsable()) {
      return Status::InvalidArgument(solver_summary_.message);
    }
    if (!file_.names.empty()) {
      for (IgnoredEdge& edge : solver_summary_.ignored_edges) {
        edge.from = file_.names[edge.from];
        edge.to = file_.names[edge.to];
      }
    }
    std::cout << '\n' << solver_summary_.FullReport() << '\n';
    refined_consistency_ = MeasureConsistency();
    if (refined_consistency_) {
      alarms_ = MapAlarms(*refined_consistency_, file_.graph, state_.poses);
    }
    return Status::Ok();
  }

  // Only the order of time tells apart the passes of a robot through the same place.
  bool ScansAreInOrderOfTime() const {
    const SlamGraph& graph = file_.graph;
    const std::vector<ScanEntry>& scans = graph.all_scans();
    return std::is_sorted(scans.begin(), scans.end(), [&graph](const auto& a, const auto& b) {
      return graph.timestamp_s(a.pose) < graph.timestamp_s(b.pose);
    });
  }

  std::optional<MapConsistency> MeasureConsistency() {
    if (!has_scans() || !ScansAreInOrderOfTime()) return std::nullopt;
    return MeasureMapConsistency(file_.graph, PosesOf(state_.poses), &pool_);
  }

  Status WriteResults() {
    const std::string graph_name = "graph." + file_.format;
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(options_.peers, [&] { return WritePoses(graph_name); }));
    if (has_scans()) {
      PLUMBLINE_RETURN_IF_ERROR(WriteMap());
      PrintMap();
    }
    PLUMBLINE_RETURN_IF_ERROR(WriteWithStopSignal([&](const std::string& signal_name) {
      stopped_by_ = signal_name;
      return BySpeaker(options_.peers, [this] { return WriteReportAndSummary(); });
    }));
    std::cout << StopText(stopped_by_) << "Results in " << Legible(output_.path())
              << ": trajectory.tum, " << graph_name << ", summary.json\n";
    if (has_scans()) {
      std::cout << "  report.html                                       all of it to look at\n"
                << (by_edges_only() ? "  map_given.png                                     "
                                    : "  map_given.png, map_pose_graph.png                 ")
                << "pictures of the way there\n"
                << MapFilesText(refined_consistency_.has_value());
    }
    std::cout << std::flush;
    PrintWarnings(MapWarnings());
    std::cerr << AlarmText(alarms_);
    return Status::Ok();
  }

  Status WritePoses(const std::string& graph_name) const {
    PLUMBLINE_RETURN_IF_ERROR(WriteTumTrajectory(output_.File("trajectory.tum"),
                                                 TrajectoryOf(file_.graph, RobotState())));
    return file_.write(output_.File(graph_name), state_.poses);
  }

  Status WriteReportAndSummary() const {
    if (has_scans()) PLUMBLINE_RETURN_IF_ERROR(WriteReport());
    // The last one: its presence says that the others are there.
    return WriteSummary();
  }

  void PrintMap() const {
    std::cout << StageTable(stages_);
    if (refined_consistency_) {
      std::cout << ConsistencyText("The given map", *given_consistency_)
                << ConsistencyText("The refined map", *refined_consistency_) << '\n';
    } else {
      std::cout << "  The scans are not in order of time: whether the map contradicts itself is "
                   "not checked.\n\n";
    }
  }

  Status WriteMap() {
    maps_.push_back({"refined", output_.File("map_refined.png"), MapArea()});
    const MapState robot = RobotState();
    const std::vector<double> given_poses = RobotPoses(file_.graph.initial_poses());
    const RefinedMap map{&file_.graph,
                         &robot,
                         &given_poses,
                         "as given",
                         refined_consistency_ ? &*refined_consistency_ : nullptr,
                         &maps_.back().area,
                         &map_warning_};
    PLUMBLINE_RETURN_IF_ERROR(
        RunAll(MapWriteTasks(map, outputs_, output_), &pool_, options_.peers));
    AddStage("refined, raw ranges", {state_.poses, {}});
    AddStage("refined, optimised points", state_);
    return Status::Ok();
  }

  // Without the frames of the other system, which have no scans and are no places of the robot.
  std::vector<double> RobotPoses(const std::vector<double>& poses) const {
    return {poses.begin(), poses.begin() + 3 * file_.num_robot_poses};
  }
  MapState RobotState() const { return {RobotPoses(state_.poses), state_.points}; }

  // What a stage's map looks like and how good it is; nothing without scans.
  Status RecordMap(const std::string& stage, const std::string& picture) {
    if (!has_scans()) return Status::Ok();
    AddStage(stage, state_);
    MapPictureOptions options;
    options.title = stage;
    options.max_side_px = outputs_.picture_side_px;
    maps_.push_back({stage, output_.File(picture), MapArea()});
    return WriteMapPicture(output_.File(picture), file_.graph, RobotState(), options,
                           &maps_.back().area);
  }

  void AddStage(const std::string& name, const MapState& state) {
    stages_.push_back(MeasureStage(name, file_.graph, state, nullptr, &pool_));
  }

  Json EdgesJson() const {
    Json json = {{"chi2_given", edges_summary_.given_chi2},
                 {"chi2_pose_graph", edges_summary_.final_chi2},
                 {"chi2_final", GraphChi2(file_.graph.relative_poses(), PosesOf(state_.poses))},
                 {"start", ToString(edges_summary_.start)},
                 {"iterations", edges_summary_.optimization.iterations},
                 {"converged", edges_summary_.optimization.converged},
                 {"stop_reason", edges_summary_.optimization.stop_reason},
                 {"time_s", edges_summary_.time_s}};
    if (edges_summary_.chordal_chi2) json["chi2_chordal"] = *edges_summary_.chordal_chi2;
    return json;
  }

  Json JointJson() const {
    Json json = {{"start", ToString(start_)}};
    json.update(SolverJson(solver_summary_));
    return json;
  }

  std::vector<Warning> MapWarnings() const {
    if (map_warning_.empty()) return {};
    return {{"coarse_map", map_warning_}};
  }

  std::vector<Warning> AllWarnings() const {
    std::vector<Warning> warnings = file_.warnings;
    for (Warning& warning : MapWarnings()) warnings.push_back(std::move(warning));
    return warnings;
  }

  Status WriteSummary() const {
    Json json = {{"log", options_.log},
                 {"format", file_.format},
                 {"poses", file_.graph.num_poses()},
                 {"fixed_poses", file_.graph.fixed_poses().size()},
                 {"edges", file_.graph.relative_poses().size()},
                 {"scans", file_.graph.all_scans().size()},
                 {"returns", file_.graph.num_returns_of_all()}};
    if (by_edges_only()) {
      json["solver"] = SolverJson(solver_summary_);
    } else {
      json["pose_graph"] = EdgesJson();
      if (has_scans()) json["joint"] = JointJson();
    }
    if (has_scans()) json["stages"] = StagesJson(stages_);
    json["alarm"] = refined_consistency_ ? Json(!alarms_.empty()) : Json(nullptr);  // not checked
    json["alarm_reasons"] = AlarmsJson(alarms_);
    if (refined_consistency_) {
      json["consistency"] = {{"given", ConsistencyJson(*given_consistency_)},
                             {"refined", ConsistencyJson(*refined_consistency_)}};
    }
    json["stopped_by"] = StoppedByJson(stopped_by_);
    json["warnings"] = WarningsJson(AllWarnings());
    json["flags"] = FlagsInForce();
    return WriteJson(output_.File("summary.json"), json);
  }

  // Of each state: its name, and what is wrong with the edges there.
  std::vector<std::vector<std::string>> EdgeRows() const {
    const std::vector<RelativePoseConstraint>& edges = file_.graph.relative_poses();
    const double refined_chi2 = GraphChi2(edges, PosesOf(state_.poses));
    if (by_edges_only()) {
      return {{"given", ShortText(solver_summary_.seed_chi2)},
              {"refined", ShortText(refined_chi2)}};
    }
    return {{"given", ShortText(edges_summary_.given_chi2)},
            {"optimum of the edges", ShortText(edges_summary_.final_chi2)},
            {"edges and scans together", ShortText(refined_chi2)}};
  }

  Status WriteReport() const {
    HtmlReport report;
    report.title = std::filesystem::path(options_.log).filename().string();
    report.subtitle = WithThousands(file_.graph.num_poses()) + " poses, " +
                      WithThousands(file_.graph.relative_poses().size()) + " edges, " +
                      WithThousands(file_.graph.all_scans().size()) + " scans, " +
                      WithThousands(file_.graph.num_returns_of_all()) + " returns";
    AddAlarms(alarms_, refined_consistency_ ? "No sign that the map contradicts itself." : "",
              &report);
    AddWarnings(AllWarnings(), &report);
    AddStop(stopped_by_, &report);
    AddStages(stages_, &report);
    report.tables.push_back(
        {"Edges of the graph", {"State", "Sum of squared whitened errors"}, EdgeRows(), ""});
    if (refined_consistency_) {
      AddConsistency({{"Given", *given_consistency_}, {"Refined", *refined_consistency_}}, &report);
      report.pictures = {
          {"Places that one scan shows and another looked through", output_.File("conflicts.png")}};
    }
    if (!by_edges_only()) report.durations = {{"Edges of the graph", edges_summary_.time_s}};
    AddSolver(solver_summary_, &report);
    AddOptionsInForce(&report);
    report.maps = maps_;
    return WriteHtmlReport(output_.File("report.html"), report);
  }

  const PoseGraphRunOptions& options_;
  RunOutputOptions outputs_;  // as the memory allows them
  ThreadPool pool_;
  OutputFolder output_;
  PoseGraphInput file_;  // its graph's initial guesses are the given poses
  MapState state_;
  JointStart start_ = JointStart::kPoseGraph;
  SolverOptions solver_options_;
  // Solved instead of the file's graph if the scans give the start: matched steps take the place of
  // the edges.
  std::optional<SlamGraph> graph_of_scans_;
  PoseGraphSummary edges_summary_;
  SolverSummary solver_summary_;
  std::vector<Stage> stages_;
  // Not measured where the scans are not in order of time.
  std::optional<MapConsistency> given_consistency_, refined_consistency_;
  std::vector<Alarm> alarms_;
  std::string stopped_by_;   // name of the signal; empty if the solver came to its own end
  std::string map_warning_;  // see RefinedMap
  std::vector<ReportMap> maps_;
};

}  // namespace

Status RunPoseGraph(const PoseGraphRunOptions& options) { return PoseGraphRun(options).Run(); }

}  // namespace plumbline
