// A raw log in; a trajectory, a map of every laser return, pictures and numbers out.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <cctype>
#include <chrono>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/alarm.h"
#include "plumbline/apps/calibration_report.h"
#include "plumbline/apps/checkpoint.h"
#include "plumbline/apps/command_line.h"
#include "plumbline/apps/flags.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/map_picture.h"
#include "plumbline/apps/io/overlay_pictures.h"
#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/memory_estimate.h"
#include "plumbline/apps/output_folder.h"
#include "plumbline/apps/pose_graph_run.h"
#include "plumbline/apps/progress.h"
#include "plumbline/apps/read_log.h"
#include "plumbline/apps/refined_pose_graph.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/apps/report/run_report.h"
#include "plumbline/apps/run_outputs.h"
#include "plumbline/apps/run_summary.h"
#include "plumbline/apps/seeding_progress.h"
#include "plumbline/apps/seeding_report.h"
#include "plumbline/apps/stage.h"
#include "plumbline/apps/stop_signal.h"
#include "plumbline/apps/truth.h"
#include "plumbline/core/graph_poses.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/seeding/frozen_laser.h"
#include "plumbline/solvers/seeding/seed.h"
#include "plumbline/solvers/solve.h"

DEFINE_string(
    log, "",
    "Log to map (CARMEN, or ROS bag), or pose graph to refine (g2o, TORO); text plain or .gz");
DEFINE_string(output_dir, "", "Folder for the results; made if it is not there");
DEFINE_int32(max_scans, 0, "Use the first scans of the log only [scans]; 0: all of them");
DEFINE_int32(picture_side_px, plumbline::RunOutputOptions().picture_side_px,
             "Longer side of the pictures, at most [px]");
DEFINE_double(map_resolution_m, plumbline::RunOutputOptions().map_resolution_m,
              "Side of a cell of the occupancy grid, map.pgm [m]");
DEFINE_string(truth, "", "True trajectory (TUM) of a simulated log, to measure errors against");
DEFINE_string(calibrate, "",
              "Sensor parameters to estimate along with the map, separated by commas: mounting, "
              "range_bias, range_scale, odometry_scale");
DEFINE_string(hits, "", "True point of every return ('t beam x y'), to go with --truth");
DEFINE_string(checkpoint, "", "File to keep the state after the seeding in, to --resume from");
DEFINE_string(resume, "",
              "Checkpoint of an earlier run over the same log with the same options: goes on from "
              "there, to the same results");
DEFINE_string(max_memory, "0",
              "Refuse a run that needs more than this by estimate, as 4GB or 500MB; 0: no limit");

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// One run of the program, step by step.
class SlamRun {
 public:
  Status CheckFlags() {
    if (FLAGS_log.empty()) return Status::InvalidArgument("--log is missing; see --help");
    if (FLAGS_output_dir.empty()) {
      return Status::InvalidArgument("--output_dir is missing; see --help");
    }
    if (FLAGS_max_scans < 0) return Status::InvalidArgument("--max_scans must be >= 0");
    if (FLAGS_truth.empty() && !FLAGS_hits.empty()) {
      return Status::InvalidArgument("--hits needs --truth");
    }
    PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver_options_));
    PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&seeding_options_));
    outputs_.picture_side_px = FLAGS_picture_side_px;
    outputs_.map_resolution_m = FLAGS_map_resolution_m;
    const Status memory = ParseMemorySize(FLAGS_max_memory, &max_memory_);
    if (!memory.ok()) return Status::InvalidArgument("--max_memory: " + memory.message());
    outputs_.LimitMemory(max_memory_);
    std::string error;
    if (!outputs_.Check(&error)) return Status::InvalidArgument("results: " + error);
    const Status parsed = ParseCalibration(FLAGS_calibrate, &calibration_options_);
    if (!parsed.ok()) return Status::InvalidArgument("--calibrate: " + parsed.message());
    if (calibration_options_.IsOn() && MovesPosesOnly(solver_options_.type)) {
      return Status::InvalidArgument(
          "--calibrate does not go with --solver=" + std::string(ToString(solver_options_.type)) +
          ", which looks at no returns");
    }
    pool_.emplace(solver_options_.num_threads);
    return Status::Ok();
  }

  Status Run() {
    if (IsPoseGraphFile(FLAGS_log)) return RefinePoseGraphFile();
    PLUMBLINE_RETURN_IF_ERROR(ReadLog());
    odometry_poses_ = graph_.poses();
    PLUMBLINE_RETURN_IF_ERROR(FindSeed());
    PLUMBLINE_RETURN_IF_ERROR(BeginResults());
    const bool by_pose_graph = MovesPosesOnly(solver_options_.type);
    if (by_pose_graph) PLUMBLINE_RETURN_IF_ERROR(OpenLoops());
    seed_poses_ = graph_.poses();
    PLUMBLINE_RETURN_IF_ERROR(
        RecordMap(by_pose_graph ? "Sequential matching" : "Seed", "map_seed.png"));
    if (!by_pose_graph) PLUMBLINE_RETURN_IF_ERROR(DrawRefusedMaps());
    PLUMBLINE_RETURN_IF_ERROR(Trajectory("trajectory_seed.tum"));
    PLUMBLINE_RETURN_IF_ERROR(Refine());
    PLUMBLINE_RETURN_IF_ERROR(WriteResults());
    return checkpoint_written_;
  }

 private:
  Status RefinePoseGraphFile() const {
    if (FLAGS_max_scans > 0 || !FLAGS_truth.empty() || calibration_options_.IsOn() ||
        !FLAGS_checkpoint.empty() || !FLAGS_resume.empty()) {
      return Status::InvalidArgument(
          "--max_scans, --truth, --calibrate, --checkpoint and --resume go with a log, but " +
          FLAGS_log + " is a pose graph");
    }
    return RunPoseGraph({FLAGS_log, FLAGS_output_dir, outputs_, solver_options_, max_memory_});
  }

  Status ReadLog() {
    const auto start = Clock::now();
    LogCounts counts;
    PLUMBLINE_RETURN_IF_ERROR(ReadLogIntoGraph(FLAGS_log, FLAGS_max_scans, &counts, &graph_));
    PLUMBLINE_RETURN_IF_ERROR(DropRepeatedScans(&graph_, &summary_.frozen_laser));
    // Rather now than at the end of the run, with most of the results written.
    PLUMBLINE_RETURN_IF_ERROR(CheckRobotMap(FLAGS_log, graph_, outputs_.map_resolution_m));
    if (!FLAGS_truth.empty()) {
      truth_.emplace();
      PLUMBLINE_RETURN_IF_ERROR(ReadTruth(FLAGS_truth, FLAGS_hits, graph_, &*truth_));
    }
    summary_.log = FLAGS_log;
    summary_.num_scans = graph_.num_scans();
    summary_.num_returns = graph_.num_returns();
    summary_.num_skipped_records = counts.num_skipped_records;
    summary_.read_time_s = SecondsSince(start);
    std::cout << "Read " << FLAGS_log << ": " << graph_.num_scans() << " scans, "
              << graph_.num_returns() << " returns, " << counts.num_skipped_records
              << " records skipped, " << counts.num_out_of_order << " out of order (" << std::fixed
              << std::setprecision(2) << summary_.read_time_s << " s)\n";
    const MemoryEstimate memory = EstimateMemory(
        graph_, solver_options_, calibration_options_.IsOn(), outputs_.picture_side_px);
    std::cout << memory.Text() << std::flush;
    PLUMBLINE_RETURN_IF_ERROR(CheckMemory(memory, max_memory_, graph_, solver_options_));
    return StoppedDuring("reading");
  }

  // The seed: of the scans, or of an earlier run's checkpoint.
  Status FindSeed() {
    RunFingerprint fingerprint;
    if (!FLAGS_resume.empty() || !FLAGS_checkpoint.empty()) {
      PLUMBLINE_RETURN_IF_ERROR(FingerprintOfRun(FLAGS_log, &fingerprint));
    }
    surface_ = MeasureSurface(graph_, NormalOptionsFor(solver_options_.factors.beam), &*pool_);
    if (FLAGS_resume.empty()) {
      PLUMBLINE_RETURN_IF_ERROR(PrepareOutputs());
      PLUMBLINE_RETURN_IF_ERROR(Seed());
    } else {
      PLUMBLINE_RETURN_IF_ERROR(
          ReadCheckpoint(FLAGS_resume, fingerprint, &graph_, &summary_.seeding));
      PLUMBLINE_RETURN_IF_ERROR(PrepareOutputs());
      std::cout << "Seeding: as in " << FLAGS_resume << '\n';
    }
    std::cout << SeedingText(summary_.seeding, graph_)
              << ConsistencyText("The seed", summary_.seeding.consistency) << std::flush;
    if (FLAGS_checkpoint.empty()) return Status::Ok();
    checkpoint_written_ = WriteCheckpoint(FLAGS_checkpoint, fingerprint, graph_, summary_.seeding);
    if (checkpoint_written_.ok()) std::cout << "Checkpoint: " << FLAGS_checkpoint << std::endl;
    return Status::Ok();
  }

  // Before the work is done: what cannot be written to is known then.
  Status PrepareOutputs() const {
    if (!FLAGS_checkpoint.empty()) {
      PLUMBLINE_RETURN_IF_ERROR(AtomicFile().Open(FLAGS_checkpoint));
    }
    return output_.Make();
  }

  Status Seed() {
    const auto start = Clock::now();
    SeedingBars bars(StandardOutputIsTerminal(), &std::cout);
    const auto progress = [&](SeedingPhase phase, int num_done, int num_total) {
      bars.Update(phase, num_done, num_total);
      return StopSignal() == 0;
    };
    const Status seeded =
        SeedGraph(seeding_options_, solver_options_.factors.motion, surface_.normals, progress,
                  &*pool_, &graph_, &summary_.seeding);
    if (!seeded.ok()) PLUMBLINE_RETURN_IF_ERROR(StoppedDuring("seeding"));
    PLUMBLINE_RETURN_IF_ERROR(seeded);
    summary_.seed_time_s = SecondsSince(start);
    bars.Finish();
    std::cout << "Seeding: done (" << summary_.seed_time_s << " s)\n";
    return Status::Ok();
  }

  // From here on there is a map to write, also if the run is stopped. Not before: an earlier run's
  // results outlive one that comes to nothing.
  Status BeginResults() {
    PLUMBLINE_RETURN_IF_ERROR(
        output_.RemoveOldResults({FLAGS_log, FLAGS_truth, FLAGS_hits, FLAGS_resume}));
    graph_.poses().swap(odometry_poses_);
    graph_.ResetPointsFromPoses();
    Status recorded = RecordMap("Odometry", "map_odometry.png");
    graph_.poses().swap(odometry_poses_);
    graph_.ResetPointsFromPoses();
    return recorded;
  }

  // A solver of pose graphs has the work still to do that the seeding did by its own.
  Status OpenLoops() {
    MoveTo(summary_.seeding.sequential_poses);
    for (const RelativePoseConstraint& edge : summary_.seeding.pose_graph) {
      PLUMBLINE_RETURN_IF_ERROR(graph_.AddRelativePose(edge));
    }
    return Status::Ok();
  }

  // The seed's lasers stay where they were: its map is drawn with the mounting that was found.
  void CarrySeedAlong() {
    for (int pose = 0; pose < graph_.num_poses(); ++pose) {
      const Pose2 carried = Pose2(&seed_poses_[3 * pose]) * before_from_after_;
      seed_poses_[3 * pose] = carried.x;
      seed_poses_[3 * pose + 1] = carried.y;
      seed_poses_[3 * pose + 2] = carried.yaw;
    }
  }

  Status Refine() {
    const Pose2 mounting = graph_.laser(0).robot_from_laser;
    std::cout << ProgressHeader() << '\n';
    solver_options_.callback = [](const IterationSummary& iteration) {
      std::cout << ProgressRow(iteration) << '\n' << std::flush;
      return StopSignal() == 0;
    };
    // Calibration has its own view of what is wrong with the odometry.
    if (!calibration_options_.IsOn()) {
      solver_options_.factors.motion =
          RefinementMotion(summary_.seeding.odometry_noise, solver_options_.factors.motion);
    }
    summary_.solver = calibration_options_.IsOn()
                          ? SolveWithCalibration(solver_options_, calibration_options_, &graph_,
                                                 &summary_.calibration)
                          : Solve(solver_options_, surface_, &graph_);
    surface_ = MeasuredSurface();  // of no more use, and as large as what the results need
    if (!summary_.solver.IsSolutionUsable()) {
      return Status::InvalidArgument(summary_.solver.message);
    }
    if (calibration_options_.IsOn()) {
      before_from_after_ = mounting * graph_.laser(0).robot_from_laser.Inverse();
      CarrySeedAlong();
    }
    std::cout << '\n'
              << summary_.solver.FullReport() << '\n'
              << CalibrationText(summary_.calibration);
    if (summary_.solver.termination == TerminationType::kUserStopped) {
      summary_.stopped_by = StopSignalName();
      std::cout << StopText(summary_.stopped_by);
    }
    summary_.refined_consistency = MeasureMapConsistency(graph_, PosesOf(graph_), &*pool_);
    summary_.alarms = RunAlarms(summary_.seeding, summary_.refined_consistency, graph_);
    for (Alarm& alarm : FrozenLaserAlarms(summary_.frozen_laser, graph_)) {
      summary_.alarms.push_back(std::move(alarm));
    }
    return Status::Ok();
  }

  Status WriteResults() {
    maps_.push_back({"Refined", output_.File("map_refined.png"), MapArea()});
    std::string map_warning;
    const RefinedMap map{
        &graph_,     &seed_poses_, "seed", &summary_.refined_consistency, &maps_.back().area,
        &map_warning};
    std::vector<WriteTask> tasks = MapWriteTasks(map, outputs_, output_);
    tasks.push_back([&] { return Trajectory("trajectory.tum"); });
    tasks.push_back([&] {
      return WriteRefinedPoseGraph(output_.File("graph.g2o"), graph_, summary_.seeding.pose_graph,
                                   before_from_after_);
    });
    tasks.push_back([&] {
      return WriteClosurePicture(output_.File("closures.png"), graph_,
                                 summary_.seeding.loops.matches, outputs_.picture_side_px);
    });
    Stage optimised;
    tasks.push_back([&] { return Measure("refined, optimised points", &optimised); });
    PLUMBLINE_RETURN_IF_ERROR(RunAll(tasks, &*pool_));
    if (!map_warning.empty()) summary_.warnings.push_back(map_warning);
    graph_.ResetPointsFromPoses();
    const std::string ranges = calibration_options_.IsOn() ? "calibrated" : "raw";
    summary_.stages.push_back(
        MeasureStage("refined, " + ranges + " ranges", graph_, TruthOrNull(), &*pool_));
    summary_.stages.push_back(optimised);
    PLUMBLINE_RETURN_IF_ERROR(WriteReport());
    // The last one: its presence says that the others are there.
    PLUMBLINE_RETURN_IF_ERROR(WriteRunSummary(output_.File("summary.json"), summary_));
    PrintResults();
    return Status::Ok();
  }

  Status WriteReport() const {
    HtmlReport report = MakeRunReport(summary_);
    report.maps = maps_;
    report.pictures = {
        {"Loops closed and refused", output_.File("closures.png")},
        {"Places that one scan shows and another looked through", output_.File("conflicts.png")}};
    return WriteHtmlReport(output_.File("report.html"), report);
  }

  std::string RefusedMapsText() const {
    if (num_refused_maps_ == 0) return "";
    return num_refused_maps_ == 1
               ? "  map_runner_up.png                                 explanation that was "
                 "refused\n"
               : "  map_runner_up.png, map_refused.png                explanations that were "
                 "refused\n";
  }

  void PrintResults() const {
    std::cout
        << StageTable(summary_.stages)
        << ConsistencyText("The refined map", summary_.refined_consistency) << "\nPeak memory "
        << PeakMemoryBytes() / 1000000 << " MB. Results in " << output_.path()
        << ":\n  report.html                                       all of it to look at, in a "
           "browser\n"
           "  map_odometry.png, map_seed.png                    pictures of the way there\n"
        << RefusedMapsText() << MapFilesText(true)
        << "  closures.png                                      loops closed and refused\n"
           "  trajectory.tum, trajectory_seed.tum               pose of the robot per scan\n"
           "  graph.g2o                                         these poses and the seed's edges, "
           "closures included\n"
           "  summary.json                                      options and figures\n"
        << std::flush;
    for (const std::string& warning : summary_.warnings)
      std::cerr << "warning: " << warning << '\n';
    std::cerr << AlarmText(summary_.alarms);
  }

  // The maps of other explanations of the drive, for people who doubt the one that was adopted.
  Status DrawRefusedMaps() {
    constexpr const char* kFiles[] = {"map_runner_up.png", "map_refused.png"};
    const std::vector<Pose2> seed = PosesOf(graph_);
    for (const WeighedHypothesis* other :
         RunnersUp(summary_.seeding.hypotheses, seed, std::size(kFiles))) {
      MoveTo(other->world_from_robot);
      const std::string title = num_refused_maps_ == 0 ? "Runner-up" : "Refused";
      maps_.push_back({title, output_.File(kFiles[num_refused_maps_++]), MapArea()});
      PLUMBLINE_RETURN_IF_ERROR(Draw(&maps_.back()));
      maps_.back().name += ": " + HypothesisText(*other);
    }
    if (num_refused_maps_ > 0) MoveTo(seed);
    return Status::Ok();
  }
  void MoveTo(const std::vector<Pose2>& world_from_robot) {
    for (int pose = 0; pose < graph_.num_poses(); ++pose) {
      graph_.SetPose(pose, world_from_robot[pose]);
    }
    graph_.ResetPointsFromPoses();
  }

  // What the map looks like as it stands, and how good it is.
  Status RecordMap(const std::string& title, const std::string& picture) {
    maps_.push_back({title, output_.File(picture), MapArea()});
    summary_.stages.emplace_back();
    std::string stage = title;
    stage.front() = static_cast<char>(std::tolower(stage.front()));
    return RunAll({[&] { return Draw(&maps_.back()); },
                   [&] { return Measure(stage, &summary_.stages.back()); }},
                  &*pool_);
  }
  Status Draw(ReportMap* map) const {
    MapPictureOptions options;
    options.title = map->name;
    options.max_side_px = outputs_.picture_side_px;
    return WriteMapPicture(map->png_path, graph_, options, &map->area);
  }
  // One of several tasks, each on a thread.
  Status Measure(const std::string& name, Stage* stage) const {
    ThreadPool one_thread(1);
    *stage = MeasureStage(name, graph_, TruthOrNull(), &one_thread);
    return Status::Ok();
  }
  const Truth* TruthOrNull() const { return truth_ ? &*truth_ : nullptr; }
  Status Trajectory(const std::string& name) const {
    return WriteTumTrajectory(output_.File(name), TrajectoryOf(graph_));
  }

  SolverOptions solver_options_;
  SeedingOptions seeding_options_;
  RunOutputOptions outputs_;
  CalibrationOptions calibration_options_;
  std::optional<ThreadPool> pool_;
  const OutputFolder output_{FLAGS_output_dir};
  SlamGraph graph_;
  MeasuredSurface surface_;
  Status checkpoint_written_;  // a run that cannot keep its seed goes on: it is all the run has
  double max_memory_ = 0.0;    // [bytes], 0: no limit
  std::vector<double> odometry_poses_, seed_poses_;
  Pose2 before_from_after_;  // how a calibrated mounting moved the frame of the robot
  std::optional<Truth> truth_;
  RunSummary summary_;
  std::vector<ReportMap> maps_;
  std::size_t num_refused_maps_ = 0;
};

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  FLAGS_logtostderr = true;
  plumbline::ParseCommandLine(
      "Maps a raw log (CARMEN or ROS bag), or refines a pose graph: joint estimation of all poses "
      "and all laser "
      "returns.\n\n"
      "  plumbline_slam --log=fr079.clf.gz --output_dir=out\n"
      "  plumbline_slam --log=fr079.clf.gz --output_dir=out --solver=ceres "
      "--ceres_linear_solver=sparse_schur",
      argc, argv);
  plumbline::CatchSignals();
  plumbline::SlamRun run;
  return plumbline::ExitCodeAfterStop(
      plumbline::RunProgram([&run] { return run.CheckFlags(); }, [&run] { return run.Run(); }));
}
