#include "plumbline/apps/run/map_run.h"

#include <cctype>
#include <iostream>
#include <iterator>
#include <utility>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/heap.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/apps/pictures/overlay_pictures.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/report/calibration_report.h"
#include "plumbline/apps/report/run_report.h"
#include "plumbline/apps/report/seeding_text.h"
#include "plumbline/apps/run/progress.h"
#include "plumbline/apps/run/refined_pose_graph.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

std::string StartTitle(StartType start, bool by_pose_graph) {
  switch (start) {
    case StartType::kOdometry:
      return "Start: odometry";
    case StartType::kIcp:
      return "Start: ICP, point to point";
    case StartType::kIcpPointToLine:
      return "Start: ICP, point to line";
    case StartType::kIcpGlobal:
      return "Start: ICP over all scans";
    case StartType::kSeed:
      break;
  }
  return by_pose_graph ? "Sequential matching" : "Seed";
}

std::string InLowerCase(std::string title) {
  title.front() = static_cast<char>(std::tolower(title.front()));
  return title;
}

}  // namespace

MapRun::MapRun(const MapLogOptions& options, const RunOutputOptions& outputs,
               const OutputFolder& output, const Truth* truth, RunSummary summary, ThreadPool* pool,
               LogMapping* mapping)
    : options_(options),
      outputs_(outputs),
      output_(output),
      truth_(truth),
      summary_(std::move(summary)),
      num_printed_warnings_(summary_.warnings.size()),
      pool_(pool),
      mapping_(mapping) {}

Status MapRun::RecordStart(const Stage* odometry) {
  const bool by_pose_graph = options_.solver.MovesPosesOnly();
  const MapState given{mapping_->graph.initial_poses(), {}};
  std::vector<WriteTask> tasks;
  if (odometry != nullptr) {
    summary_.stages.push_back(*odometry);
    tasks.push_back(Draw(given, "Odometry", "map_odometry.png"));
  }
  const std::string title = StartTitle(options_.start, by_pose_graph);
  Stage seed;
  tasks.push_back(Together([&] { return Measure(InLowerCase(title), mapping_->state, &seed); }));
  tasks.push_back(Draw(mapping_->state, title, "map_seed.png"));
  std::vector<MapState> refused;
  if (!by_pose_graph) DrawRefusedMaps(&refused, &tasks);
  tasks.push_back(WriteTrajectory("trajectory_seed.tum"));
  PLUMBLINE_RETURN_IF_ERROR(RunAll(tasks, pool_, mapping_->graph.peers()));
  summary_.stages.push_back(seed);
  return Status::Ok();
}

Status MapRun::Refine() {
  // Much of what the seeding left is too small for what comes now.
  GiveFreedMemoryBack(mapping_->graph.num_returns_of_all());
  std::cout << ProgressHeader() << '\n';
  options_.solver.callback = [](const IterationSummary& iteration) {
    std::cout << ProgressRow(iteration) << '\n' << std::flush;
    return StopSignal() == 0;
  };
  const Peers* peers = mapping_->graph.peers();
  const PeersTraffic before = peers != nullptr ? peers->traffic() : PeersTraffic();
  PLUMBLINE_RETURN_IF_ERROR(RefineLog(options_, pool_, mapping_));
  if (peers != nullptr) estimation_traffic_ = peers->traffic() - before;
  std::cout << '\n' << mapping_->report.solver.FullReport() << '\n';
  if (const std::size_t num_scans = mapping_->report.misplaced_poses.size(); num_scans > 0) {
    std::cout << "The estimation began again, for it had left " << num_scans
              << (num_scans == 1 ? " scan" : " scans") << " beside where the map shows the same.\n";
  }
  std::cout << CalibrationText(mapping_->report.calibration);
  return Status::Ok();
}

Status MapRun::WriteMap(ExtraResults extras) {
  // Much of what the estimation left is too small for an array of points.
  GiveFreedMemoryBack(mapping_->graph.num_returns_of_all());
  extras_ = std::move(extras);
  std::string map_warning;
  RefinedMap map = RefinedMapOf(*mapping_);
  map.picture_area = AddMap("Refined", "map_refined.png");
  map.map_warning = &map_warning;
  MapPictureOptions closures;
  PLUMBLINE_RETURN_IF_ERROR(
      ShowClosures(mapping_->state, mapping_->report.seeding.loops.matches, &closures));
  // Processes take turns: this order gives two of them about as much to draw.
  std::vector<WriteTask> tasks = {WriteTrajectory("trajectory.tum"),
                                  DrawTask(output_.File("closures.png"), mapping_->graph,
                                           mapping_->state, closures, outputs_.picture_side_px)};
  const std::vector<WriteTask> of_map = MapWriteTasks(map, outputs_, output_);
  tasks.insert(tasks.end(), of_map.begin(), of_map.end());
  tasks.push_back(ByOne([this] {
    return WriteRefinedPoseGraph(output_.File("graph.g2o"), mapping_->state.poses,
                                 mapping_->report.seeding.pose_graph, mapping_->before_from_after);
  }));
  tasks.insert(tasks.end(), extras_.tasks.begin(), extras_.tasks.end());
  Status saved;
  if (outputs_.save_map) tasks.push_back(Together([&] { return SaveMap(&saved); }));
  // Long, but not first: at first there is least memory left.
  Stage measured, optimised;
  tasks.push_back(Together([&] {
    const std::string ranges = options_.calibration.IsOn() ? "calibrated" : "raw";
    return Measure("refined, " + ranges + " ranges", {mapping_->state.poses, {}}, &measured);
  }));
  tasks.push_back(
      Together([&] { return Measure("refined, optimised points", mapping_->state, &optimised); }));
  PLUMBLINE_RETURN_IF_ERROR(RunAll(tasks, pool_, mapping_->graph.peers()));
  if (!map_warning.empty()) summary_.warnings.push_back({"coarse_map", map_warning});
  if (!saved.ok()) {
    summary_.warnings.push_back({"map_not_saved", "map.g2o is not written: " + saved.message()});
  }
  summary_.stages.push_back(measured);
  summary_.stages.push_back(optimised);
  summary_.mapping = std::move(mapping_->report);
  return Status::Ok();
}

// Scans that the format has no place for are no reason to lose all else.
Status MapRun::SaveMap(Status* saved) const {
  *saved = WriteSavedMap(output_.File("map.g2o"), mapping_->graph, mapping_->state.poses,
                         options_.solver.factors.motion);
  return saved->code() == StatusCode::kInvalidArgument ? Status::Ok() : *saved;
}

Status MapRun::WriteReport(const std::string& signal_name) {
  if (mapping_->graph.peers() != nullptr) {
    summary_.processes = ProcessSummaries(mapping_->graph, estimation_traffic_);
  }
  return BySpeaker(mapping_->graph.peers(), [&] { return WriteReportOfAll(signal_name); });
}

Status MapRun::WriteReportOfAll(const std::string& signal_name) {
  summary_.stopped_by = signal_name;
  HtmlReport report = MakeRunReport(summary_);
  report.maps.assign(maps_.begin(), maps_.end());
  report.pictures = extras_.pictures;
  report.pictures.push_back({"Loops closed and refused", output_.File("closures.png")});
  report.pictures.push_back(
      {"Places that one scan shows and another looked through", output_.File("conflicts.png")});
  report.tables.insert(report.tables.begin(), extras_.tables.begin(), extras_.tables.end());
  PLUMBLINE_RETURN_IF_ERROR(WriteHtmlReport(output_.File("report.html"), report));
  Json summary = RunSummaryJson(summary_);
  summary.update(extras_.summary);
  return WriteJson(output_.File("summary.json"), summary);
}

void MapRun::PrintResults() const {
  std::cout
      << StopText(summary_.stopped_by) << StageTable(summary_.stages)
      << ConsistencyText("The refined map", summary_.mapping.consistency) << "\nPeak memory "
      << PeakMemoryText() << " MB. Results in " << Legible(output_.path())
      << ":\n  report.html                                       all of it to look at, in a "
         "browser\n"
      << (maps_.front().name == "Odometry" ? "  map_odometry.png, map_seed.png                    "
                                           : "  map_seed.png                                      ")
      << "pictures of the way there\n"
      << RefusedMapsText() << MapFilesText(true) << extras_.files_text
      << "  closures.png                                      loops closed and refused\n"
         "  trajectory.tum, trajectory_seed.tum               pose of the robot per scan\n"
         "  graph.g2o                                         these poses and the seed's "
         "edges, closures included\n"
      << (outputs_.save_map
              ? "  map.g2o                                           the map with all scans, to "
                "add other logs to\n"
              : "")
      << "  summary.json                                      options and figures\n"
      << std::flush;
  PrintWarnings({summary_.warnings.begin() + static_cast<std::ptrdiff_t>(num_printed_warnings_),
                 summary_.warnings.end()});
  std::cerr << AlarmText(summary_.mapping.alarms);
}

std::string MapRun::PeakMemoryText() const {
  constexpr std::size_t kBytesPerMb = 1000000;
  if (summary_.processes.empty()) return std::to_string(PeakMemoryBytes() / kBytesPerMb);
  std::string text;
  for (const ProcessSummary& process : summary_.processes) {
    text += (text.empty() ? "" : ", ") + std::to_string(process.peak_memory_bytes / kBytesPerMb);
  }
  return text;
}

std::string MapRun::RefusedMapsText() const {
  if (num_refused_maps_ == 0) return "";
  return num_refused_maps_ == 1
             ? "  map_runner_up.png                                 explanation that was refused\n"
             : "  map_runner_up.png, map_refused.png                explanations that were "
               "refused\n";
}

// The maps of other explanations of the drive, for people who doubt the one that was adopted.
void MapRun::DrawRefusedMaps(std::vector<MapState>* states, std::vector<WriteTask>* tasks) {
  constexpr const char* kFiles[] = {"map_runner_up.png", "map_refused.png"};
  states->reserve(std::size(kFiles));  // the tasks refer to them
  for (const WeighedHypothesis* other :
       RunnersUp(mapping_->report.seeding.hypotheses, PosesOf(mapping_->state.poses),
                 std::size(kFiles))) {
    const std::string title = num_refused_maps_ == 0 ? "Runner-up" : "Refused";
    states->push_back({PoseArray(other->world_from_robot), {}});
    tasks->push_back(Draw(states->back(), title, kFiles[num_refused_maps_++]));
    maps_.back().name += ": " + HypothesisText(*other);
  }
}

MapArea* MapRun::AddMap(const std::string& name, const std::string& file) {
  maps_.push_back({name, output_.File(file), MapArea()});
  return &maps_.back().area;
}

WriteTask MapRun::Draw(const MapState& state, const std::string& title, const std::string& file) {
  MapPictureOptions picture;
  picture.title = title;
  return DrawTask(output_.File(file), mapping_->graph, state, picture, outputs_.picture_side_px,
                  AddMap(title, file));
}

Status MapRun::Measure(const std::string& name, const MapState& state, Stage* stage) const {
  ThreadPool one_thread(1);
  *stage = MeasureStage(name, mapping_->graph, state, truth_, &one_thread);
  return Status::Ok();
}

WriteTask MapRun::WriteTrajectory(const std::string& name) const {
  return ByOne([this, name] {
    return WriteTumTrajectory(output_.File(name), TrajectoryOf(mapping_->graph, mapping_->state));
  });
}

}  // namespace plumbline
