#include "plumbline/apps/run/sessions_run.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <utility>

#include "plumbline/apps/evaluation/session_changes.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/pictures/session_pictures.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/run_summary.h"
#include "plumbline/apps/report/seeding_text.h"
#include "plumbline/apps/report/session_text.h"
#include "plumbline/apps/run/log_input.h"
#include "plumbline/apps/run/map_run.h"
#include "plumbline/apps/run/memory_estimate.h"
#include "plumbline/apps/run/progress.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/apps/run/seeding_progress.h"
#include "plumbline/apps/run/share_mapping.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/map_sessions.h"

namespace plumbline {
namespace {

// File names, or whole paths where two are the same.
std::vector<std::string> NamesOf(const std::vector<std::string>& logs) {
  std::vector<std::string> names;
  names.reserve(logs.size());
  for (const std::string& log : logs) {
    names.push_back(std::filesystem::path(log).filename().string());
  }
  std::vector<std::string> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  const bool all_differ = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  return all_differ ? names : logs;
}

// What is written of a map, and where.
struct MapResults {
  SessionMap* map = nullptr;
  std::unique_ptr<OutputFolder> own_folder;  // null: the folder of the run
  std::vector<SessionMark> marks;            // of its sessions
  std::vector<SessionChange> changes;        // between them
  bool alarm = false;
  std::unique_ptr<MapRun> run;
};

// One run, step by step.
class SessionsRun {
 public:
  explicit SessionsRun(const SessionsRunOptions& options)
      : options_(options),
        outputs_(options.outputs),
        pool_(options.mapping.solver.num_threads),
        output_(options.output_dir),
        paths_(options.logs) {
    if (!options.fixed_map.empty()) paths_.push_back(options.fixed_map);
    names_ = NamesOf(paths_);
    read_.resize(paths_.size());
    sessions_.resize(paths_.size());
  }

  Status Run() {
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(peers(), [this] { return Read(); }));
    // What cannot be written is known before the work.
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(peers(), [this] { return MakeFolder(); }));
    EndIfStoppedWhile("seeding", output_.made_folders());
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(peers(), [this] { return TakeLogsOver(); }));
    PLUMBLINE_RETURN_IF_ERROR(FindSeeds());
    KeepStopSignal();
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(peers(), [this] { return output_.RemoveOldResults(); }));
    MakeMapRuns();
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(peers(), [this] { return MakeMapFolders(); }));
    for (MapResults& results : results_) PLUMBLINE_RETURN_IF_ERROR(Refine(&results));
    for (MapResults& results : results_) PLUMBLINE_RETURN_IF_ERROR(WriteMap(&results));
    PLUMBLINE_RETURN_IF_ERROR(WriteWithStopSignal(
        [this](const std::string& signal_name) { return WriteReports(signal_name); }));
    for (const MapResults& results : results_) {
      PrintNameOf(results);
      results.run->PrintResults();
    }
    return Status::Ok();
  }

 private:
  const Peers* peers() const { return options_.peers; }

  Status Read() {
    MemoryEstimate memory;
    std::size_t largest = 0;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      EndIfStoppedWhile("reading " + paths_[i]);
      SlamGraph& graph = sessions_[i].graph;
      PLUMBLINE_RETURN_IF_ERROR(ReadSessionOrFixedMap(i, &graph));
      const MapState odometry{graph.initial_poses(), {}};
      PLUMBLINE_RETURN_IF_ERROR(
          CheckRobotMap(paths_[i], graph, odometry, outputs_.map_resolution_m));
      const MemoryEstimate own =
          EstimateMemory(graph, odometry, options_.mapping.solver, false, outputs_.picture_side_px);
      if (i == 0) {
        memory = own;
      } else {
        memory.Add(own);
      }
      if (read_[i].num_scans > read_[largest].num_scans) largest = i;
    }
    return FitMemory(options_.max_memory, sessions_[largest].graph, options_.mapping.solver,
                     &memory, &outputs_.picture_side_px, &std::cout);
  }

  Status ReadSessionOrFixedMap(std::size_t index, SlamGraph* graph) {
    if (index < options_.logs.size()) {
      return ReadSession(paths_[index], options_.max_scans, options_.max_memory, &read_[index],
                         graph);
    }
    return ReadFixedMap(paths_[index], options_.max_memory, &read_[index], graph);
  }

  // Not to be cut off by a signal: it tries out a file.
  Status MakeFolder() {
    KeepStopSignal();
    return output_.Make();
  }

  Status TakeLogsOver() {
    const auto start = std::chrono::steady_clock::now();
    for (LogMapping& session : sessions_) {
      PLUMBLINE_RETURN_IF_ERROR(
          TakeLog(options_.mapping, std::move(session.graph), &pool_, &session));
    }
    seed_time_s_ = SecondsSince(start);
    return Status::Ok();
  }

  // Processes find them together, unless one of the logs has to be looked at as a whole.
  Status FindSeeds() {
    if (peers() == nullptr) return Seed();
    ShareLimits(peers(), &outputs_);
    const auto is_fit = [this](const LogMapping& session) {
      return CanSeedTogether(options_.mapping, session);
    };
    if (!CanShareSeeding(*peers(), std::all_of(sessions_.begin(), sessions_.end(), is_fit))) {
      PLUMBLINE_RETURN_IF_ERROR(BySpeaker(peers(), [this] { return Seed(); }));
      return ShareSessions(peers(), options_.mapping, &pool_, &mapping_);
    }
    std::size_t num_returns = 0;
    for (LogMapping& session : sessions_) {
      PLUMBLINE_RETURN_IF_ERROR(ShareLog(peers(), &session));
      num_returns += session.graph.num_returns_of_all();
    }
    SaveMemory(*peers(), num_returns);
    return Seed();
  }

  Status Seed() {
    const auto start = std::chrono::steady_clock::now();
    SeedingBars bars(StandardOutputIsTerminal(), &std::cout);
    const auto progress = [&](SeedingPhase phase, int num_done, int num_total) {
      bars.Update(phase, num_done, num_total);
      return true;
    };
    PLUMBLINE_RETURN_IF_ERROR(
        SeedSessions(options_.mapping, std::move(sessions_), progress, &pool_, &mapping_));
    bars.Finish();
    seed_time_s_ += SecondsSince(start);
    std::cout << "Seeding: done (" << std::fixed << std::setprecision(2) << seed_time_s_ << " s)\n"
              << TiesText(mapping_.ties, names_) << std::flush;
    if (!is_one_map()) {
      std::cerr << "note: not all logs show a common place: there are " << mapping_.maps.size()
                << " maps\n";
    }
    return Status::Ok();
  }

  bool is_one_map() const { return mapping_.maps.size() == 1; }

  void MakeMapRuns() {
    for (SessionMap& map : mapping_.maps) {
      MapResults& results = results_.emplace_back();
      results.map = &map;
      RunSummary summary;
      for (const SessionOfMap& session : map.sessions) {
        const RunSummary& read = read_[session.session];
        summary.log += (summary.log.empty() ? "" : ",") + read.log;
        summary.num_scans += read.num_scans;
        summary.num_returns += read.num_returns;
        summary.num_skipped_records += read.num_skipped_records;
        summary.read_time_s += read.read_time_s;
        summary.warnings.insert(summary.warnings.end(), read.warnings.begin(), read.warnings.end());
        results.marks.push_back(
            {names_[session.session], session.session, session.first_scan, session.num_scans});
      }
      summary.seed_time_s = seed_time_s_;
      if (!is_one_map()) {
        results.own_folder =
            std::make_unique<OutputFolder>(output_.MapFolder(static_cast<int>(results_.size())));
      }
      results.run = std::make_unique<MapRun>(options_.mapping, outputs_, FolderOf(results), nullptr,
                                             std::move(summary), &pool_, &map.mapping);
    }
  }

  Status MakeMapFolders() const {
    for (const MapResults& results : results_) {
      if (results.own_folder) PLUMBLINE_RETURN_IF_ERROR(results.own_folder->Make());
    }
    return Status::Ok();
  }

  const OutputFolder& FolderOf(const MapResults& results) const {
    return results.own_folder ? *results.own_folder : output_;
  }

  void PrintNameOf(const MapResults& results) const {
    if (is_one_map()) return;
    std::cout << "\nMap of " << Legible(JoinedNames(NumbersOf(*results.map), names_)) << ":\n";
  }

  static std::vector<int> NumbersOf(const SessionMap& map) {
    std::vector<int> numbers;
    for (const SessionOfMap& session : map.sessions) numbers.push_back(session.session);
    return numbers;
  }

  Status Refine(MapResults* results) {
    PrintNameOf(*results);
    const LogMapping& mapping = results->map->mapping;
    const SeedingReport& seeding = mapping.report.seeding;
    std::cout << RangeNoiseText(options_.mapping, mapping.report)
              << SeedingText(seeding, mapping.graph, mapping.state.poses)
              << ConsistencyText("The seed", seeding.consistency) << std::flush;
    PLUMBLINE_RETURN_IF_ERROR(results->run->RecordStart(nullptr));
    return results->run->Refine();
  }

  Status WriteMap(MapResults* results) {
    const LogMapping& mapping = results->map->mapping;
    const OutputFolder& folder = FolderOf(*results);
    results->alarm = !mapping.report.alarms.empty();
    ExtraResults extras;
    extras.summary = {{"sessions", SessionsJson(*results)}};
    if (results->marks.size() > 1) {
      PLUMBLINE_RETURN_IF_ERROR(FindSessionChanges(mapping.graph, mapping.state, results->marks,
                                                   outputs_.GridOptions(), &results->changes));
      extras.summary["changes"] = ChangesJson(results->marks, results->changes);
      extras.tables = {SessionsTable(*results), ChangesTable(results->marks, results->changes)};
      extras.pictures = {{"Sessions", folder.File("sessions.png")},
                         {"What changed between sessions", folder.File("changes.png")}};
      extras.files_text =
          "  sessions.png, changes.png                         the map by session, and where they "
          "differ\n"
          "  trajectory_1.tum, ...                             pose of the robot per scan of each "
          "log\n";
      extras.tasks = {
          DrawTask(folder.File("sessions.png"), mapping.graph, mapping.state,
                   ShowSessions(results->marks), outputs_.picture_side_px),
          DrawTask(folder.File("changes.png"), mapping.graph, mapping.state,
                   ShowChanges(results->marks, results->changes), outputs_.picture_side_px)};
      for (const SessionOfMap& session : results->map->sessions) {
        extras.tasks.push_back(ByOne([&] { return WriteTrajectoryOf(session, mapping, folder); }));
      }
    }
    if (is_one_map()) extras.summary.update(RunJson());
    return results->run->WriteMap(std::move(extras));
  }

  static Status WriteTrajectoryOf(const SessionOfMap& session, const LogMapping& mapping,
                                  const OutputFolder& folder) {
    const std::vector<TimedPose> all = TrajectoryOf(mapping.graph, mapping.state);
    const auto first = all.begin() + session.first_pose;
    return WriteTumTrajectory(
        folder.File("trajectory_" + std::to_string(session.session + 1) + ".tum"),
        {first, first + session.num_poses});
  }

  Status WriteReports(const std::string& signal_name) {
    for (MapResults& results : results_) {
      PLUMBLINE_RETURN_IF_ERROR(results.run->WriteReport(signal_name));
    }
    if (is_one_map()) return Status::Ok();
    return BySpeaker(peers(), [&] { return WriteSummary(signal_name); });
  }

  Status WriteSummary(const std::string& signal_name) const {
    Json json = RunJson();
    json["stopped_by"] = StoppedByJson(signal_name);
    json["peak_memory_bytes"] = PeakMemoryBytes();
    json["flags"] = FlagsInForce();
    return WriteJson(output_.File("summary.json"), json);
  }

  Json SessionsJson(const MapResults& results) const {
    Json json = Json::array();
    for (const SessionOfMap& session : results.map->sessions) {
      const RunSummary& read = read_[session.session];
      json.push_back({{"number", session.session + 1},
                      {"log", read.log},
                      {"fixed", session.session == static_cast<int>(options_.logs.size())},
                      {"first_scan", session.first_scan},
                      {"scans", session.num_scans},
                      {"returns", read.num_returns},
                      {"skipped_records", read.num_skipped_records},
                      {"seed_alarm", session.report.seeding.alarm}});
    }
    return json;
  }

  // How the sessions were put together.
  Json RunJson() const {
    Json maps = Json::array();
    for (const MapResults& results : results_) {
      Json sessions = Json::array();
      for (const int session : NumbersOf(*results.map)) sessions.push_back(session + 1);
      const std::string folder = is_one_map() ? "." : FolderOf(results).path();
      maps.push_back({{"folder", std::filesystem::path(folder).filename().string()},
                      {"sessions", sessions},
                      {"alarm", results.alarm}});
    }
    return {{"maps", maps}, {"ties", TiesJson(mapping_.ties)}};
  }

  ReportTable SessionsTable(const MapResults& results) const {
    ReportTable table{"Sessions", {"Number", "Log", "Scans", "Returns", "Seed by itself"}, {}, ""};
    for (const SessionOfMap& session : results.map->sessions) {
      const RunSummary& read = read_[session.session];
      table.rows.push_back({std::to_string(session.session + 1), names_[session.session],
                            WithThousands(session.num_scans), WithThousands(read.num_returns),
                            session.report.seeding.alarm ? "contradicts itself" : "consistent"});
    }
    return table;
  }

  const SessionsRunOptions& options_;
  RunOutputOptions outputs_;  // as the memory allows them
  ThreadPool pool_;
  OutputFolder output_;
  std::vector<std::string> paths_;    // per session: of the logs, then of the fixed map
  std::vector<std::string> names_;    // for people, per session
  std::vector<RunSummary> read_;      // per session, what is known from reading it
  std::vector<LogMapping> sessions_;  // until they are seeded
  double seed_time_s_ = 0.0;
  SessionsMapping mapping_;
  std::deque<MapResults> results_;  // per map
};

}  // namespace

Status RunSessions(const SessionsRunOptions& options) { return SessionsRun(options).Run(); }

}  // namespace plumbline
