// Runs an experiment, on simulated drives or on a log, and sums up what came of it.

#include <gflags/gflags.h>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/benchmark/ablation.h"
#include "plumbline/apps/benchmark/benchmark_usage.h"
#include "plumbline/apps/benchmark/log_experiment.h"
#include "plumbline/apps/benchmark/log_report.h"
#include "plumbline/apps/benchmark/mapper_record.h"
#include "plumbline/apps/benchmark/online_day.h"
#include "plumbline/apps/benchmark/online_run.h"
#include "plumbline/apps/benchmark/replay.h"
#include "plumbline/apps/benchmark/replay_report.h"
#include "plumbline/apps/benchmark/scaling_study.h"
#include "plumbline/apps/benchmark/scan_solver_replay.h"
#include "plumbline/apps/benchmark/seeded_log.h"
#include "plumbline/apps/benchmark/sensor_matrix.h"
#include "plumbline/apps/benchmark/sensor_report.h"
#include "plumbline/apps/benchmark/solver_experiment.h"
#include "plumbline/apps/benchmark/stage_profile.h"
#include "plumbline/apps/benchmark/studies.h"
#include "plumbline/apps/benchmark/study_flags.h"
#include "plumbline/apps/benchmark/synthetic_report.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/apps/report/report_sections.h"
#include "plumbline/apps/run/flags.h"
#include "plumbline/solvers/map_log.h"

DEFINE_string(experiment, "",
              "What to run, one or more of these with commas: seeding_study, sessions_study, "
              "variations, solver_comparison, scaling, log, synthetic, ablation, online, replay, "
              "scan_solver, adversarial, sensors, profile");
DEFINE_string(
    log, "",
    "solver_comparison, log, ablation, online, replay, profile: CARMEN log, plain or .gz (empty: a "
    "simulated "
    "building; ablation: none); variations: CARMEN logs separated by commas, or @FILE with one per "
    "line, each with its relations beside it (a.relations for a.clf.gz); scan_solver: the log of "
    "--graph, whose odometry leads from node to node");
DEFINE_string(
    graph, "",
    "scan_solver: pose graph with scans, its vertices in the order in which a mapper made "
    "them (empty: that of a simulated mapper)");
DEFINE_string(
    relations, "",
    "solver_comparison, log, ablation, online, scan_solver: true relative poses of the log ('t1 t2 "
    "x y z roll pitch yaw')");
DEFINE_string(corrected_log, "",
              "log: the same drive with poses that another mapper corrected: its scans are mapped "
              "from these, and from the raw odometry");
DEFINE_string(
    output_dir, "",
    "Folder for the results, report.html among them; made if it is not there (empty: none, "
    "for seeding_study, sessions_study, variations, scaling, scan_solver and adversarial only)");
DEFINE_int32(sensor_seeds, 3, "sensors: seeds of buildings and noise for each case, 1 to this");
DEFINE_double(online_speed, 20.0,
              "online: scans come in this many times as fast as they were recorded (0: as fast as "
              "they are taken)");
DEFINE_double(online_hours, 0.0,
              "online: instead of a log, so many hours in a simulated building at 10 Hz, standing "
              "half of the time, as fast as they are taken (0: the log)");
DEFINE_bool(online_localised, false,
            "online, with --online_hours: in a map of the building, and without keeping old scans");
DEFINE_string(online_solver, "incremental",
              "replay: what refines the map while it grows: incremental (landmarks are kept from "
              "call to call) or window (the newest poses in a problem of their own each time, all "
              "poses where a loop closes)");
DEFINE_int32(batch_scans, plumbline::ReplayOptions().batch_poses,
             "replay: scans that arrive between two solves");
DEFINE_int32(window_free_poses, 0,
             "replay: newest poses that a solve moves (0: the default of --online_solver)");
DEFINE_int32(window_fixed_poses, plumbline::WindowOptions().max_fixed_poses,
             "replay by window: older poses that hold the map around them, at most");

namespace plumbline {
namespace {

// The log, or a simulated drive, with its seed. All threads have ended on return. solver: becomes
// what the joint estimation goes by.
Status MakeSeed(SolverOptions* solver, LogMapping* mapping) {
  MapLogOptions options;
  options.solver = *solver;
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&options.seeding));
  PLUMBLINE_RETURN_IF_ERROR(PrepareDrive(FLAGS_log, options, mapping));
  return SeedPreparedDrive(options, mapping, solver);
}

Status CompareAllSolvers(const OutputFolder& output, HtmlReport* page) {
  return CompareSolversByFlags(FLAGS_log, FLAGS_relations, output, page);
}

Status MapLogByAll(const OutputFolder& output, HtmlReport* page) {
  LogExperimentInputs inputs;
  inputs.log = FLAGS_log;
  inputs.relations = FLAGS_relations;
  inputs.corrected_log = FLAGS_corrected_log;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&inputs.solver));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&inputs.seeding));
  LogExperiment experiment;
  PLUMBLINE_RETURN_IF_ERROR(RunLogExperiment(
      inputs,
      [](const LogStart& start, const LogStage& stage) {
        std::cout << "  " << start.name << ": " << stage.name << '\n' << std::flush;
      },
      &experiment));
  PrintText("Mappers on one log", LogTables(experiment), page);
  PLUMBLINE_RETURN_IF_ERROR(WriteLogJson(output.File("log.json"), experiment));
  PLUMBLINE_RETURN_IF_ERROR(WriteLogRelationsCsv(output.File("log_relations.csv"), experiment));
  PLUMBLINE_RETURN_IF_ERROR(WriteLogSharpnessCsv(output.File("log_sharpness.csv"), experiment));
  page->pictures.push_back(
      {"The same returns, mapped in several ways", output.File("log_maps.png")});
  return WriteMapFigure(output.File("log_maps.png"), experiment.maps, MapFigureOptions());
}

Status MapLogOptionsFromFlags(MapLogOptions* options) {
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&options->solver));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&options->seeding));
  return StartFromFlags(options->solver, &options->start);
}

Status Synthetic(const OutputFolder& output, HtmlReport* page) {
  MapLogOptions options;
  PLUMBLINE_RETURN_IF_ERROR(MapLogOptionsFromFlags(&options));
  ThreadPool pool(options.solver.num_threads);
  const std::vector<SyntheticNoise> noises = SyntheticNoises();
  std::vector<SyntheticOutcome> outcomes;
  PLUMBLINE_RETURN_IF_ERROR(RunSyntheticExperiment(FLAGS_seeds, noises, options, &pool, &outcomes));
  PrintText("Short drives with few scans", SyntheticTable(noises, outcomes), page);
  constexpr int kCharted = 1;  // the middle one of the levels of range noise
  PLUMBLINE_RETURN_IF_ERROR(WriteSyntheticCsv(output.File("synthetic.csv"), noises, outcomes));
  PLUMBLINE_RETURN_IF_ERROR(WriteSyntheticJson(output.File("synthetic.json"), noises, outcomes));
  PLUMBLINE_RETURN_IF_ERROR(WritePoseErrorChart(output.File("synthetic_pose_error.png"),
                                                noises[kCharted], kCharted, outcomes));
  PLUMBLINE_RETURN_IF_ERROR(WriteMapErrorChart(output.File("synthetic_map_error.png"),
                                               noises[kCharted], kCharted, outcomes));
  page->pictures.push_back({"Errors of the poses", output.File("synthetic_pose_error.png")});
  page->pictures.push_back({"Errors of the map points", output.File("synthetic_map_error.png")});
  page->pictures.push_back({"The maps of one drive", output.File("synthetic_maps.png")});
  return WriteSyntheticMaps(output.File("synthetic_maps.png"),
                            MedianSeed(outcomes, kCharted, Mapper::kPlainIcp), noises[kCharted],
                            options);
}

Status Ablation(const OutputFolder& output, HtmlReport* page) {
  SolverOptions solver;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  AblationInput log;
  log.full = solver;
  if (!FLAGS_relations.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(ReadRelations(FLAGS_relations, &log.relations));
  }
  std::vector<AblationTable> tables;
  const auto add = [&](const AblationTable& table) {
    tables.push_back(table);
    PrintText("What each part contributes", AblationText(table) + '\n', page);
  };
  ThreadPool pool(solver.num_threads);
  AblationTable table;
  PLUMBLINE_RETURN_IF_ERROR(AblateSyntheticDrives(FLAGS_seeds, solver, &pool, &table));
  add(table);
  constexpr int kNumBuildings = 7;
  PLUMBLINE_RETURN_IF_ERROR(
      AblateBuildings(std::min(FLAGS_seeds, kNumBuildings), solver, &pool, &table));
  add(table);
  if (!FLAGS_log.empty()) {
    LogNotes notes;
    PLUMBLINE_RETURN_IF_ERROR(ReadLogIntoGraph(FLAGS_log, 0, &notes, &log.graph));
    const std::string name = FLAGS_log.substr(FLAGS_log.find_last_of('/') + 1);
    PLUMBLINE_RETURN_IF_ERROR(AblateLog(name, std::move(log), &table));
    add(table);
  }
  PLUMBLINE_RETURN_IF_ERROR(WriteAblationCsv(output.File("ablation.csv"), tables));
  return WriteAblationJson(output.File("ablation.json"), tables);
}

Status Sensors(const OutputFolder& output, HtmlReport* page) {
  SolverOptions solver;
  SeedingOptions seeding;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&seeding));
  ThreadPool pool(solver.num_threads);
  const std::vector<SensorCase> cases = SensorCases();
  std::vector<SensorOutcome> outcomes;
  PLUMBLINE_RETURN_IF_ERROR(
      RunSensorCases(cases, FLAGS_sensor_seeds, solver, seeding, &pool, &outcomes));
  PrintText("Other scanners and buildings", SensorTable(cases, outcomes), page);
  PLUMBLINE_RETURN_IF_ERROR(WriteSensorCsv(output.File("sensors.csv"), cases, outcomes));
  return WriteSensorJson(output.File("sensors.json"), cases, outcomes);
}

void PrintNumScans(int num_scans) { std::cout << "  " << num_scans << " scans\n" << std::flush; }

Status MapOnline(const OutputFolder& output, HtmlReport* page) {
  MapLogOptions options;
  PLUMBLINE_RETURN_IF_ERROR(MapLogOptionsFromFlags(&options));
  if (FLAGS_online_hours > 0.0) {
    OnlineDay day;
    PLUMBLINE_RETURN_IF_ERROR(
        RunOnlineDay(options, {FLAGS_online_hours, FLAGS_online_localised}, PrintNumScans, &day));
    PrintText("A day of a robot", OnlineDayTable(day), page);
    return Status::Ok();
  }
  std::vector<Relation> relations;
  if (!FLAGS_relations.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(ReadRelations(FLAGS_relations, &relations));
  }
  SlamGraph drive;
  PLUMBLINE_RETURN_IF_ERROR(ReadDrive(FLAGS_log, &drive));
  OnlineRun run;
  PLUMBLINE_RETURN_IF_ERROR(RunOnline(options, FLAGS_online_speed, drive, PrintNumScans, &run));
  PrintText("Maps while the robot drives", OnlineTable(run, relations), page);
  return WriteOnlineCsv(output.File("online.csv"), run);
}

void PrintStep(const ReplayStep& step) {
  std::cout << "  " << step.num_poses << " scans, " << step.num_closures
            << " closures: " << ToString(step.solve) << ", " << std::fixed << std::setprecision(3)
            << step.time_s << " s\n"
            << std::flush;
}

Status ReplayOptionsFromFlags(ReplayOptions* options) {
  if (!FromString(FLAGS_online_solver, &options->online_solver)) {
    return Status::InvalidArgument("--online_solver=" + FLAGS_online_solver +
                                   ": want incremental or window");
  }
  options->batch_poses = FLAGS_batch_scans;
  if (FLAGS_window_free_poses != 0) {
    options->window.num_free_poses = FLAGS_window_free_poses;
    options->incremental.num_free_poses = FLAGS_window_free_poses;
  }
  options->window.max_fixed_poses = FLAGS_window_fixed_poses;
  std::string error;
  if (!options->Check(&error)) return Status::InvalidArgument("the flags set " + error);
  return Status::Ok();
}

Status ReplayDrive(const OutputFolder& output, HtmlReport* page) {
  ReplayOptions options;
  PLUMBLINE_RETURN_IF_ERROR(ReplayOptionsFromFlags(&options));
  SolverOptions solver;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  LogMapping seed;
  PLUMBLINE_RETURN_IF_ERROR(MakeSeed(&solver, &seed));
  // A host that is still driving does not know which steps are broken.
  solver.factors.downweighted_steps.clear();
  Replay replay;
  PLUMBLINE_RETURN_IF_ERROR(
      RunReplay(solver, options, seed.graph, seed.state, seed.report.seeding, PrintStep, &replay));
  PrintText("A host that maps while driving", ReplayTable(replay), page);
  page->pictures.push_back({"Time of each solve", output.File("replay.png")});
  MapState replayed;
  replayed.poses = PoseArray(replay.world_from_robot);
  PLUMBLINE_RETURN_IF_ERROR(
      WriteTumTrajectory(output.File("trajectory.tum"), TrajectoryOf(seed.graph, replayed)));
  PLUMBLINE_RETURN_IF_ERROR(WriteReplayCsv(output.File("replay.csv"), replay));
  return WriteReplayChart(output.File("replay.png"), replay);
}

Status ReplayMapper(const OutputFolder&, HtmlReport* page) {
  SolverOptions solver;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  MapperRecord record;
  PLUMBLINE_RETURN_IF_ERROR(FLAGS_graph.empty()
                                ? SimulateMapper(&record)
                                : ReadMapper(FLAGS_graph, FLAGS_log, FLAGS_relations, &record));
  ScanSolverReplay replay;
  PLUMBLINE_RETURN_IF_ERROR(ReplayScanSolver(
      solver, record.graph,
      [](const ScanSolverCall& call) {
        std::cout << "  " << call.num_nodes << " nodes, " << call.num_edges
                  << " edges: " << std::fixed << std::setprecision(3) << call.wall_s << " s\n"
                  << std::flush;
      },
      &replay));
  PrintText("Scan solver of a mapper",
            ScanSolverTable(replay) + MapperErrors(record, replay.world_from_robot), page);
  return FLAGS_csv.empty() ? Status::Ok() : WriteScanSolverCsv(FLAGS_csv, replay);
}

Status Profile(const OutputFolder& output, HtmlReport* page) {
  MapLogOptions options;
  PLUMBLINE_RETURN_IF_ERROR(MapLogOptionsFromFlags(&options));
  ThreadPool pool(options.solver.num_threads);
  LogProfile profile;
  PLUMBLINE_RETURN_IF_ERROR(ProfileLog(FLAGS_log, options, output, &pool, &profile));
  PrintText("Stages of a run", ProfileTable(profile), page);
  page->pictures.push_back({"The map", output.File("map_refined.png")});
  return WriteProfileCsv(output.File("profile.csv"), profile);
}

Status Variations(const OutputFolder& /*output*/, HtmlReport* page) {
  return StudyVariations(FLAGS_log, page);
}

struct Experiment {
  const char* name;
  Status (*run)(const OutputFolder& output, HtmlReport* page);
  const char* files;  // that it writes in the output folder, separated by spaces
  bool needs_log;
  bool needs_output_dir;
  bool runs_other_solvers;  // whichever --solver names
  const char* ignored;      // flags of plumbline_slam that say nothing here, separated by spaces
  bool writes_csv = false;  // --csv
};
constexpr Experiment kExperiments[] = {
    {"seeding_study", SeedingStudy, "", false, false, false, "solver start shape", true},
    {"sessions_study", SessionsStudy, "", false, false, false, "start", true},
    {"variations", Variations, "", true, false, false, "start relations sweep_time_s", true},
    {"solver_comparison", CompareAllSolvers,
     "solver_comparison.json solver_comparison.csv solver_comparison.png", false, true, true,
     "solver"},
    {"scaling", Scaling, "", false, false, false, "solver start", true},
    {"log", MapLogByAll, "log.json log_relations.csv log_sharpness.csv log_maps.png", true, true,
     true, "start"},
    {"synthetic", Synthetic,
     "synthetic.csv synthetic.json synthetic_pose_error.png synthetic_map_error.png "
     "synthetic_maps.png",
     false, true, true, ""},
    {"ablation", Ablation, "ablation.csv ablation.json", false, true, true, "start"},
    {"online", MapOnline, "online.csv", false, true, false, ""},
    {"replay", ReplayDrive, "trajectory.tum replay.csv replay.png", false, true, false, "start"},
    {"scan_solver", ReplayMapper, "", false, false, false, "start", true},
    {"adversarial", Adversarial, "", false, false, false, "start", true},
    {"sensors", Sensors, "sensors.csv sensors.json", false, true, false, "start shape"},
    {"profile", Profile,
     "profile.csv map_refined.png before_after.png conflicts.png map.pgm map.yaml points.ply "
     "points.pcd",
     true, true, false, ""}};

Status FindExperiment(const std::string& name, const Experiment** found) {
  for (const Experiment& experiment : kExperiments) {
    if (name == experiment.name) {
      *found = &experiment;
      return Status::Ok();
    }
  }
  return Status::InvalidArgument("--experiment='" + name +
                                 "': there is none of that name; see --help");
}

Status FindExperiments(std::vector<const Experiment*>* wanted) {
  std::istringstream names(FLAGS_experiment);
  for (std::string name; std::getline(names, name, ',');) {
    wanted->push_back(nullptr);
    PLUMBLINE_RETURN_IF_ERROR(FindExperiment(name, &wanted->back()));
  }
  return wanted->empty() ? FindExperiment("", nullptr) : Status::Ok();
}

Status CheckNoComparisonFlag() {
  for (const char* flag : {"solvers", "repeats", "time_limit_s"}) {
    if (gflags::GetCommandLineFlagInfoOrDie(flag).is_default) continue;
    return Status::InvalidArgument(std::string("--") + flag +
                                   " is ignored by --experiment=" + FLAGS_experiment);
  }
  return Status::Ok();
}

// CheckFlags has found the names of the experiments in order.
std::vector<std::string> FilesInFolder(const std::string& folder) {
  std::vector<const Experiment*> wanted;
  if (!FindExperiments(&wanted).ok()) return {};
  const OutputFolder output(folder);
  std::vector<std::string> files = {output.File("report.html")};
  for (const Experiment* experiment : wanted) {
    std::istringstream names(experiment->files);
    for (std::string name; names >> name;) files.push_back(output.File(name));
  }
  return files;
}

// True if one of the wanted experiments is this one.
bool IsWanted(Status (*run)(const OutputFolder&, HtmlReport*)) {
  std::vector<const Experiment*> wanted;
  if (!FindExperiments(&wanted).ok()) return false;
  return std::any_of(wanted.begin(), wanted.end(),
                     [run](const Experiment* wants) { return wants->run == run; });
}

std::vector<std::string> FilesOfLogFlag(const std::string& value) {
  return IsWanted(Variations) ? FilesOfVariedLogs(value) : LogFiles(value);
}

// Each experiment that writes the table writes it anew.
std::vector<std::string> TablesOfExperiments(const std::string& csv) {
  std::vector<const Experiment*> wanted;
  if (!FindExperiments(&wanted).ok()) return {};
  const auto num_tables = std::count_if(wanted.begin(), wanted.end(),
                                        [](const Experiment* wants) { return wants->writes_csv; });
  return std::vector<std::string>(std::max<std::ptrdiff_t>(1, num_tables), csv);
}

const std::vector<FileFlag>& FileFlags() {
  static const std::vector<FileFlag> flags = {
      {"log", &FLAGS_log, FileUse::kInput, FilesOfLogFlag},
      {"graph", &FLAGS_graph, FileUse::kInput},
      {"relations", &FLAGS_relations, FileUse::kInput},
      {"corrected_log", &FLAGS_corrected_log, FileUse::kInput},
      {"csv", &FLAGS_csv, FileUse::kOutput, TablesOfExperiments},
      {"output_dir", &FLAGS_output_dir, FileUse::kOutputFolder, FilesInFolder}};
  return flags;
}

Status CheckFlags() {
  std::vector<const Experiment*> wanted;
  PLUMBLINE_RETURN_IF_ERROR(FindExperiments(&wanted));
  for (const Experiment* experiment : wanted) {
    if (experiment->needs_log && FLAGS_log.empty()) {
      return Status::InvalidArgument("--log is missing; see --help");
    }
    if (experiment->needs_output_dir && FLAGS_output_dir.empty()) {
      return Status::InvalidArgument("--output_dir is missing; see --help");
    }
  }
  if (FLAGS_log.empty() && !(FLAGS_relations.empty() && FLAGS_corrected_log.empty())) {
    return Status::InvalidArgument("--relations and --corrected_log need --log");
  }
  constexpr int kMostRuns = 1000000;  // more would take years
  for (const auto& [name, value] :
       {std::pair("buildings", FLAGS_buildings == 0 ? 1 : FLAGS_buildings),
        std::pair("seeds", FLAGS_seeds), std::pair("sensor_seeds", FLAGS_sensor_seeds),
        std::pair("variation_seeds", FLAGS_variation_seeds)}) {
    if (value >= 1 && value <= kMostRuns) continue;
    return Status::InvalidArgument("--" + std::string(name) + " must be from 1 to " +
                                   std::to_string(kMostRuns));
  }
  constexpr double kMinSpeed = 0.01, kMaxSpeed = 1e6;
  if (FLAGS_online_speed != 0.0 &&
      !(FLAGS_online_speed >= kMinSpeed && FLAGS_online_speed <= kMaxSpeed)) {
    return Status::InvalidArgument("--online_speed must be 0 or from 0.01 to 1e6");
  }
  constexpr double kMaxHours = 24.0;
  if (!(FLAGS_online_hours >= 0.0 && FLAGS_online_hours <= kMaxHours)) {
    return Status::InvalidArgument("--online_hours must be from 0 to 24");
  }
  ReplayOptions replay;
  PLUMBLINE_RETURN_IF_ERROR(ReplayOptionsFromFlags(&replay));
  StudyScanner scanner;
  PLUMBLINE_RETURN_IF_ERROR(StudyScannerFromFlag(&scanner));
  std::vector<const LogVariation*> variations;
  PLUMBLINE_RETURN_IF_ERROR(VariationsFromFlag(&variations));
  std::vector<int> counts;
  const Status status = ParseScanCounts(FLAGS_scans, &counts);
  if (!status.ok()) return Status::InvalidArgument("--scans: " + status.message());
  SolverOptions solver;
  SeedingOptions seeding;
  PLUMBLINE_RETURN_IF_ERROR(CheckComparisonNumbers());
  PLUMBLINE_RETURN_IF_ERROR(IsWanted(CompareAllSolvers) ? CheckComparedSolvers()
                                                        : CheckNoComparisonFlag());
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  const bool one_solver = std::none_of(wanted.begin(), wanted.end(), [](const Experiment* wants) {
    return wants->runs_other_solvers;
  });
  if (one_solver) PLUMBLINE_RETURN_IF_ERROR(CheckNoFlagIsIgnored(solver));
  for (const Experiment* experiment : wanted) {
    std::istringstream ignored(experiment->ignored);
    for (std::string flag; ignored >> flag;) {
      if (gflags::GetCommandLineFlagInfoOrDie(flag.c_str()).is_default) continue;
      return Status::InvalidArgument("--" + flag +
                                     " is ignored by --experiment=" + experiment->name);
    }
    const bool is_incremental =
        experiment->run == ReplayMapper ||
        (experiment->run == ReplayDrive && replay.online_solver == OnlineSolver::kIncremental);
    if (is_incremental && solver.type != SolverType::kReduced) {
      return Status::InvalidArgument(std::string("--solver=") + ToString(solver.type) +
                                     " does not go with --experiment=" + experiment->name +
                                     ", which runs the incremental solver");
    }
  }
  return SeedingOptionsFromFlags(&seeding);
}

// So that no experiment leaves its results, or a folder for them, before one refuses a file.
Status CheckInputFiles() {
  if (IsWanted(Variations)) PLUMBLINE_RETURN_IF_ERROR(CheckVariedLogs(FLAGS_log));
  const bool takes_list = FLAGS_experiment == "variations";
  for (const std::string& path : {takes_list ? "" : FLAGS_log, FLAGS_corrected_log}) {
    if (path.empty()) continue;
    CarmenLog log;
    SlamGraph graph;
    PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(path, CarmenReadOptions(), &log));
    const Status built = BuildGraph(log, 0, &graph);
    if (!built.ok()) return Status::InvalidArgument(path + ": " + built.message());
    if (graph.num_returns() == 0) {
      return Status::InvalidArgument(path + ": no scan has a return within the laser's range");
    }
  }
  std::vector<Relation> relations;
  return FLAGS_relations.empty() ? Status::Ok() : ReadRelations(FLAGS_relations, &relations);
}

Status Run() {
  std::vector<const Experiment*> wanted;
  PLUMBLINE_RETURN_IF_ERROR(FindExperiments(&wanted));
  EndIfStoppedWhile("reading the inputs");
  PLUMBLINE_RETURN_IF_ERROR(CheckInputFiles());
  OutputFolder output(FLAGS_output_dir);
  if (!FLAGS_output_dir.empty()) {
    KeepStopSignal();
    PLUMBLINE_RETURN_IF_ERROR(output.Make());
  }
  EndIfStoppedWhileWriting(output.made_folders());
  HtmlReport page;
  page.title = "Experiments: " + FLAGS_experiment;
  page.subtitle = FLAGS_log;
  for (const Experiment* experiment : wanted) {
    PLUMBLINE_RETURN_IF_ERROR(experiment->run(output, &page));
  }
  if (FLAGS_output_dir.empty()) return Status::Ok();
  AddOptionsInForce(&page);
  return WriteHtmlReport(output.File("report.html"), page);
}

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  plumbline::StartProgram(plumbline::kBenchmarkUsage, argc, argv);
  return plumbline::RunProgram(plumbline::FileFlags(), plumbline::CheckFlags, plumbline::Run);
}
