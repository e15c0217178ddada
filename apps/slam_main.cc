// A raw log in; a trajectory, a map of every laser return, pictures and numbers out.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <cctype>
#include <chrono>
#include <future>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/evaluation/truth.h"
#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/apps/pictures/overlay_pictures.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/program/pose_graph_input.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/report/calibration_report.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/apps/report/run_report.h"
#include "plumbline/apps/report/run_summary.h"
#include "plumbline/apps/report/seeding_text.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/apps/run/checkpoint.h"
#include "plumbline/apps/run/flags.h"
#include "plumbline/apps/run/memory_estimate.h"
#include "plumbline/apps/run/pose_graph_run.h"
#include "plumbline/apps/run/progress.h"
#include "plumbline/apps/run/refined_pose_graph.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/apps/run/seeding_progress.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/map_log.h"

DEFINE_string(
    log, "",
    "Log to map (CARMEN, or bag of ROS 1 or ROS 2, file or folder), or pose graph to refine (g2o, "
    "TORO, or a saved map: a state of Cartographer, .pbstream, or a map of slam_toolbox, "
    ".posegraph); text plain or .gz");
DEFINE_string(output_dir, "",
              "Folder for the results; made if it is not there, and for one run at a time");
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
DEFINE_string(
    checkpoint, "",
    "File to keep the state after the seeding in, to --resume from; may be that of --resume");
DEFINE_string(resume, "",
              "Checkpoint of an earlier run over the same log with the same options: goes on from "
              "there, to the same results");
DEFINE_string(max_memory, "0",
              "Refuse a run that needs more than this by estimate, as 4GB or 500MB; 0: no limit");

namespace plumbline {
namespace {

const std::vector<FileFlag>& FileFlags() {
  static const std::vector<FileFlag> flags = {
      {"log", &FLAGS_log, FileUse::kInput, LogFiles},
      {"truth", &FLAGS_truth, FileUse::kInput},
      {"hits", &FLAGS_hits, FileUse::kInput},
      {"resume", &FLAGS_resume, FileUse::kInput},
      // A run that goes on from a checkpoint may go on keeping its state there.
      {"checkpoint", &FLAGS_checkpoint, FileUse::kOutput, nullptr, "resume"},
      {"output_dir", &FLAGS_output_dir, FileUse::kOutputFolder, ResultsIn}};
  return flags;
}

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
    PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&options_.solver));
    PLUMBLINE_RETURN_IF_ERROR(StartFromFlags(options_.solver, &options_.start));
    PLUMBLINE_RETURN_IF_ERROR(CheckNoFlagIsIgnored(options_.solver, options_.start));
    PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&options_.seeding));
    outputs_.picture_side_px = FLAGS_picture_side_px;
    outputs_.map_resolution_m = FLAGS_map_resolution_m;
    const Status memory = ParseMemorySize(FLAGS_max_memory, &max_memory_);
    if (!memory.ok()) return Status::InvalidArgument("--max_memory: " + memory.message());
    outputs_.LimitMemory(max_memory_);
    std::string error;
    if (!outputs_.Check(&error)) return Status::InvalidArgument("results: " + error);
    const Status parsed = ParseCalibration(FLAGS_calibrate, &options_.calibration);
    if (!parsed.ok()) return Status::InvalidArgument("--calibrate: " + parsed.message());
    if (options_.calibration.IsOn() && options_.solver.MovesPosesOnly()) {
      return Status::InvalidArgument(
          "--calibrate does not go with --solver=" + std::string(ToString(options_.solver.type)) +
          ", which looks at no returns");
    }
    pool_.emplace(options_.solver.num_threads);
    return Status::Ok();
  }

  Status Run() {
    EndIfStoppedWhile("reading " + FLAGS_log);
    if (IsPoseGraph(FLAGS_log)) return RefinePoseGraphFile();
    PLUMBLINE_RETURN_IF_ERROR(ReadLog());
    PLUMBLINE_RETURN_IF_ERROR(FindSeed());
    PLUMBLINE_RETURN_IF_ERROR(RecordStart());
    PLUMBLINE_RETURN_IF_ERROR(Refine());
    PLUMBLINE_RETURN_IF_ERROR(WriteResults());
    return checkpoint_written_;
  }

 private:
  Status RefinePoseGraphFile() const {
    for (const char* flag :
         {"start", "max_scans", "truth", "calibrate", "checkpoint", "resume", "sweep_time_s"}) {
      const gflags::CommandLineFlagInfo info = gflags::GetCommandLineFlagInfoOrDie(flag);
      if (info.current_value == info.default_value) continue;
      return Status::InvalidArgument("--" + info.name + " goes with a log, but " + FLAGS_log +
                                     " is a pose graph");
    }
    return RunPoseGraph({FLAGS_log, FLAGS_output_dir, outputs_, options_.solver, max_memory_});
  }

  Status ReadLog() {
    const auto start = Clock::now();
    const bool needs_fingerprint = !FLAGS_resume.empty() || !FLAGS_checkpoint.empty();
    LogStamp stamp;
    if (needs_fingerprint) {
      PLUMBLINE_RETURN_IF_ERROR(FingerprintOfRun(FLAGS_log, &fingerprint_, &stamp));
    }
    LogCounts counts;
    SlamGraph graph;
    PLUMBLINE_RETURN_IF_ERROR(
        ReadLogIntoGraph(FLAGS_log, FLAGS_max_scans, &counts, &graph, max_memory_));
    if (needs_fingerprint) PLUMBLINE_RETURN_IF_ERROR(CheckUnchanged(FLAGS_log, stamp));
    if (LacksOdometry(graph)) WarnOfMissingOdometry();
    NoteUselessClock(graph);
    // What would end the run at its end is found before the work.
    const MapState odometry = graph.InitialState();
    PLUMBLINE_RETURN_IF_ERROR(CheckRobotMap(FLAGS_log, odometry, outputs_.map_resolution_m));
    summary_.log = FLAGS_log;
    summary_.num_scans = graph.num_scans();
    summary_.num_returns = graph.num_returns();
    summary_.num_skipped_records = counts.num_skipped_records;
    summary_.read_time_s = SecondsSince(start);
    std::cout << "Read " << Legible(FLAGS_log) << ": " << graph.num_scans() << " scans, "
              << graph.num_returns() << " returns, " << counts.num_skipped_records
              << " records skipped, " << counts.num_out_of_order << " out of order (" << std::fixed
              << std::setprecision(2) << summary_.read_time_s << " s)\n";
    const MemoryEstimate memory = EstimateMemory(
        graph, odometry, options_.solver, options_.calibration.IsOn(), outputs_.picture_side_px);
    std::cout << memory.Text() << std::flush;
    PLUMBLINE_RETURN_IF_ERROR(CheckMemory(memory, max_memory_, graph, options_.solver));
    const auto prepare = Clock::now();
    PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options_, std::move(graph), &*pool_, &mapping_));
    summary_.seed_time_s = SecondsSince(prepare);
    if (mapping_.report.sweep_order) {
      std::cout << "Sweeps: measured " << ToString(*mapping_.report.sweep_order)
                << ", by what the scans say\n";
    }
    if (FLAGS_truth.empty()) return Status::Ok();
    truth_.emplace();
    return ReadTruth(FLAGS_truth, FLAGS_hits, mapping_.graph, &*truth_);
  }

  static void WarnOfMissingOdometry() {
    std::cerr << "warning: " << Legible(FLAGS_log)
              << ": there is no odometry, or it never changes: the scans alone tell how the robot "
                 "moved. Long bare corridors may come out too short or too long, and fast turns or "
                 "gaps between scans may break the map\n";
  }

  // No fault of the map: the order of the scans is enough.
  static void NoteUselessClock(const SlamGraph& graph) {
    const std::string fault = ClockFault(TimesOf(graph));
    if (fault.empty()) return;
    std::cerr << "note: " << Legible(FLAGS_log) << ": " << fault
              << "; the scans are taken in the order of the file\n";
  }

  // The seed: of the scans, or of an earlier run's checkpoint.
  Status FindSeed() {
    if (FLAGS_resume.empty()) {
      PLUMBLINE_RETURN_IF_ERROR(MakeFolder());  // what cannot be written is known before the work
      EndIfStoppedWhile("seeding", output_.made_folders());
      PLUMBLINE_RETURN_IF_ERROR(Seed());
      KeepStopSignal();
    } else {
      EndIfStoppedWhile("reading " + FLAGS_resume);
      PLUMBLINE_RETURN_IF_ERROR(Resume());
      PLUMBLINE_RETURN_IF_ERROR(MakeFolder());
      std::cout << "Seeding: as in " << Legible(FLAGS_resume) << '\n';
    }
    const SeedingReport& seeding = mapping_.report.seeding;
    std::cout << SeedingText(seeding, mapping_.graph, mapping_.state.poses)
              << ConsistencyText("The seed", seeding.consistency) << std::flush;
    if (FLAGS_checkpoint.empty()) return Status::Ok();
    checkpoint_written_ =
        WriteCheckpoint(FLAGS_checkpoint, fingerprint_, mapping_.start_poses, seeding);
    if (checkpoint_written_.ok())
      std::cout << "Checkpoint: " << Legible(FLAGS_checkpoint) << std::endl;
    return Status::Ok();
  }

  // Not to be cut off by a signal: it tries out a file.
  Status MakeFolder() {
    KeepStopSignal();
    return output_.Make();
  }

  Status Resume() {
    std::vector<double> start_poses;
    SeedingReport seeding;
    PLUMBLINE_RETURN_IF_ERROR(
        ReadCheckpoint(FLAGS_resume, fingerprint_, mapping_.graph, &start_poses, &seeding));
    return StartFromSeed(options_, std::move(start_poses), std::move(seeding), &mapping_);
  }

  // The odometry's map is measured meanwhile: matching scans keeps one thread busy.
  Status Seed() {
    const auto start = Clock::now();
    StartMeasuringOdometry();
    SeedingBars bars(StandardOutputIsTerminal(), &std::cout);
    const auto progress = [&](SeedingPhase phase, int num_done, int num_total) {
      bars.Update(phase, num_done, num_total);
      return true;
    };
    PLUMBLINE_RETURN_IF_ERROR(SeedLog(options_, progress, &*pool_, &mapping_));
    summary_.seed_time_s += SecondsSince(start);
    bars.Finish();
    std::cout << "Seeding: done (" << summary_.seed_time_s << " s)\n";
    return Status::Ok();
  }

  // From here on there is a map to write, also if the run is stopped. Not before: an earlier run's
  // results outlive one that comes to nothing.
  Status RecordStart() {
    PLUMBLINE_RETURN_IF_ERROR(output_.RemoveOldResults());
    const bool by_pose_graph = options_.solver.MovesPosesOnly();
    if (!odometry_stage_.valid()) StartMeasuringOdometry();  // resumed: nothing was seeded
    const Stage odometry = odometry_stage_.get();
    std::vector<WriteTask> tasks;
    if (!mapping_.report.seeding.odometry_noise.is_prediction) {
      summary_.stages.push_back(odometry);
      maps_.push_back({"Odometry", output_.File("map_odometry.png"), MapArea()});
      tasks.push_back([this] { return Draw(odometry_, &maps_.front()); });
    }
    const std::string title = StartTitle(by_pose_graph);
    maps_.push_back({title, output_.File("map_seed.png"), MapArea()});
    Stage seed;
    tasks.push_back([&] { return Measure(InLowerCase(title), mapping_.state, &seed); });
    tasks.push_back([this] { return Draw(mapping_.state, &maps_.back()); });
    PLUMBLINE_RETURN_IF_ERROR(RunAll(tasks, &*pool_));
    summary_.stages.push_back(seed);
    odometry_ = MapState();
    if (!by_pose_graph) PLUMBLINE_RETURN_IF_ERROR(DrawRefusedMaps());
    return Trajectory("trajectory_seed.tum");
  }

  std::string StartTitle(bool by_pose_graph) const {
    switch (options_.start) {
      case StartType::kOdometry:
        return "Start: odometry";
      case StartType::kIcp:
        return "Start: ICP, point to point";
      case StartType::kIcpPointToLine:
        return "Start: ICP, point to line";
      case StartType::kSeed:
        break;
    }
    return by_pose_graph ? "Sequential matching" : "Seed";
  }

  Status Refine() {
    std::cout << ProgressHeader() << '\n';
    options_.solver.measure_rounds = true;  // for report.html
    options_.solver.callback = [](const IterationSummary& iteration) {
      std::cout << ProgressRow(iteration) << '\n' << std::flush;
      return StopSignal() == 0;
    };
    PLUMBLINE_RETURN_IF_ERROR(RefineLog(options_, &*pool_, &mapping_));
    std::cout << '\n'
              << mapping_.report.solver.FullReport() << '\n'
              << CalibrationText(mapping_.report.calibration);
    return Status::Ok();
  }

  Status WriteResults() {
    maps_.push_back({"Refined", output_.File("map_refined.png"), MapArea()});
    std::string map_warning;
    RefinedMap map = RefinedMapOf(mapping_);
    map.picture_area = &maps_.back().area;
    map.map_warning = &map_warning;
    std::vector<WriteTask> tasks = MapWriteTasks(map, outputs_, output_);
    tasks.push_back([&] { return Trajectory("trajectory.tum"); });
    tasks.push_back([&] {
      return WriteRefinedPoseGraph(output_.File("graph.g2o"), mapping_.state.poses,
                                   mapping_.report.seeding.pose_graph, mapping_.before_from_after);
    });
    tasks.push_back([&] {
      return WriteClosurePicture(output_.File("closures.png"), mapping_.graph, mapping_.state,
                                 mapping_.report.seeding.loops.matches, outputs_.picture_side_px);
    });
    Stage measured, optimised;
    tasks.push_back([&] {
      const std::string ranges = options_.calibration.IsOn() ? "calibrated" : "raw";
      const MapState state{mapping_.state.poses, mapping_.graph.MeasuredMap(mapping_.state.poses)};
      return Measure("refined, " + ranges + " ranges", state, &measured);
    });
    tasks.push_back(
        [&] { return Measure("refined, optimised points", mapping_.state, &optimised); });
    PLUMBLINE_RETURN_IF_ERROR(RunAll(tasks, &*pool_));
    if (!map_warning.empty()) summary_.warnings.push_back(map_warning);
    summary_.stages.push_back(measured);
    summary_.stages.push_back(optimised);
    summary_.mapping = std::move(mapping_.report);
    PLUMBLINE_RETURN_IF_ERROR(WriteWithStopSignal([&](const std::string& signal_name) {
      summary_.stopped_by = signal_name;
      PLUMBLINE_RETURN_IF_ERROR(WriteReport());
      // The last one: its presence says that the others are there.
      return WriteRunSummary(output_.File("summary.json"), summary_);
    }));
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
        << StopText(summary_.stopped_by) << StageTable(summary_.stages)
        << ConsistencyText("The refined map", summary_.mapping.consistency) << "\nPeak memory "
        << PeakMemoryBytes() / 1000000 << " MB. Results in " << Legible(output_.path())
        << ":\n  report.html                                       all of it to look at, in a "
           "browser\n"
        << (summary_.mapping.seeding.odometry_noise.is_prediction
                ? "  map_seed.png                                      "
                : "  map_odometry.png, map_seed.png                    ")
        << "pictures of the way there\n"
        << RefusedMapsText() << MapFilesText(true)
        << "  closures.png                                      loops closed and refused\n"
           "  trajectory.tum, trajectory_seed.tum               pose of the robot per scan\n"
           "  graph.g2o                                         these poses and the seed's edges, "
           "closures included\n"
           "  summary.json                                      options and figures\n"
        << std::flush;
    for (const std::string& warning : summary_.warnings)
      std::cerr << "warning: " << warning << '\n';
    std::cerr << AlarmText(summary_.mapping.alarms);
  }

  // The maps of other explanations of the drive, for people who doubt the one that was adopted.
  Status DrawRefusedMaps() {
    constexpr const char* kFiles[] = {"map_runner_up.png", "map_refused.png"};
    for (const WeighedHypothesis* other :
         RunnersUp(mapping_.report.seeding.hypotheses, PosesOf(mapping_.state.poses),
                   std::size(kFiles))) {
      MapState state;
      state.poses = PoseArray(other->world_from_robot);
      state.points = mapping_.graph.MeasuredMap(state.poses);
      const std::string title = num_refused_maps_ == 0 ? "Runner-up" : "Refused";
      maps_.push_back({title, output_.File(kFiles[num_refused_maps_++]), MapArea()});
      PLUMBLINE_RETURN_IF_ERROR(Draw(state, &maps_.back()));
      maps_.back().name += ": " + HypothesisText(*other);
    }
    return Status::Ok();
  }

  void StartMeasuringOdometry() {
    odometry_ = mapping_.graph.InitialState();
    const auto when = pool_->num_threads() > 1 ? std::launch::async : std::launch::deferred;
    odometry_stage_ = std::async(when, [this] {
      ThreadPool one_thread(1);
      return MeasureStage("odometry", odometry_, TruthOrNull(), &one_thread);
    });
  }
  static std::string InLowerCase(std::string title) {
    title.front() = static_cast<char>(std::tolower(title.front()));
    return title;
  }
  Status Draw(const MapState& state, ReportMap* map) const {
    MapPictureOptions options;
    options.title = map->name;
    options.max_side_px = outputs_.picture_side_px;
    return WriteMapPicture(map->png_path, mapping_.graph, state, options, &map->area);
  }
  // One of several tasks, each on a thread.
  Status Measure(const std::string& name, const MapState& state, Stage* stage) const {
    ThreadPool one_thread(1);
    *stage = MeasureStage(name, state, TruthOrNull(), &one_thread);
    return Status::Ok();
  }
  const Truth* TruthOrNull() const { return truth_ ? &*truth_ : nullptr; }
  Status Trajectory(const std::string& name) const {
    return WriteTumTrajectory(output_.File(name), TrajectoryOf(mapping_.graph, mapping_.state));
  }

  MapLogOptions options_;
  RunOutputOptions outputs_;
  std::optional<ThreadPool> pool_;
  OutputFolder output_{FLAGS_output_dir};
  LogMapping mapping_;
  RunFingerprint fingerprint_;  // if there is a checkpoint to read or to write
  Status checkpoint_written_;   // a run that cannot keep its seed goes on: it is all the run has
  double max_memory_ = 0.0;     // [bytes], 0: no limit
  std::optional<Truth> truth_;
  MapState odometry_;                  // until its map is recorded
  std::future<Stage> odometry_stage_;  // refers to the two before
  RunSummary summary_;
  std::vector<ReportMap> maps_;
  std::size_t num_refused_maps_ = 0;
};

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  FLAGS_logtostderr = true;
  plumbline::StartProgram(
      "Maps a raw log (CARMEN, or bag of ROS 1 or ROS 2), or refines a pose graph or a saved map: "
      "joint estimation of all poses and all laser returns.\n\n"
      "  plumbline_slam --log=fr079.clf.gz --output_dir=out\n"
      "  plumbline_slam --log=fr079.clf.gz --output_dir=out --solver=ceres "
      "--ceres_linear_solver=sparse_schur",
      argc, argv);
  google::InitGoogleLogging(argv[0]);
  plumbline::SlamRun run;
  return plumbline::RunProgram(
      plumbline::FileFlags(), [&run] { return run.CheckFlags(); }, [&run] { return run.Run(); });
}
