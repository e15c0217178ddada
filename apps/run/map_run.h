#ifndef PLUMBLINE_APPS_RUN_MAP_RUN_H_
#define PLUMBLINE_APPS_RUN_MAP_RUN_H_

#include <cstddef>
#include <deque>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "plumbline/apps/evaluation/truth.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/run_summary.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/apps/run/write_tasks.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// What a run adds to the results that every map has.
struct ExtraResults {
  std::vector<WriteTask> tasks;         ///< write its files
  std::vector<ReportPicture> pictures;  ///< written by the tasks
  std::vector<ReportTable> tables;
  Json summary = Json::object();  ///< members of summary.json
  std::string files_text;         ///< lines for people: what the files are
};

/// The way from the seed of a log, or of several, to all files in the output folder. Prints what
/// happens. To be called in the order of its functions. If the graph has peers, each of them has a
/// MapRun of the same options, with which it writes its part of the files (collective).
class MapRun {
 public:
  /// summary: of the run up to here; its warnings have been printed. All else is only referred to;
  /// truth may be null.
  MapRun(const MapLogOptions& options, const RunOutputOptions& outputs, const OutputFolder& output,
         const Truth* truth, RunSummary summary, ThreadPool* pool, LogMapping* mapping);

  /// Draws and measures where the estimation starts. odometry: measurement of the map at the
  /// graph's initial poses, which is drawn as well; null if that is nothing to show.
  Status RecordStart(const Stage* odometry);

  /// Estimates the map (RefineLog) until a stop signal comes.
  Status Refine();

  /// Writes the map, its pictures and its trajectories, and takes the report out of the mapping.
  Status WriteMap(ExtraResults extras = {});

  /// Writes report.html and, as the last one, summary.json: its presence says that the others are
  /// there. signal_name: of the signal that has ended the run early; empty if none did.
  Status WriteReport(const std::string& signal_name);

  /// Prints where the results are, and warnings.
  void PrintResults() const;

 private:
  // One more map of the report; gives where its picture shows it.
  MapArea* AddMap(const std::string& name, const std::string& file);
  WriteTask Draw(const MapState& state, const std::string& title, const std::string& file);
  // Adds tasks, and the states that they refer to.
  void DrawRefusedMaps(std::vector<MapState>* states, std::vector<WriteTask>* tasks);
  // One of several tasks, each on a thread.
  Status Measure(const std::string& name, const MapState& state, Stage* stage) const;
  WriteTask WriteTrajectory(const std::string& name) const;
  Status SaveMap(Status* saved) const;
  Status WriteReportOfAll(const std::string& signal_name);
  std::string RefusedMapsText() const;
  std::string PeakMemoryText() const;

  MapLogOptions options_;
  const RunOutputOptions& outputs_;
  const OutputFolder& output_;
  const Truth* truth_;
  RunSummary summary_;
  const std::size_t num_printed_warnings_;  // the first of the summary's
  PeersTraffic estimation_traffic_;         // of a shared graph
  ThreadPool* pool_;
  LogMapping* mapping_;
  ExtraResults extras_;
  std::deque<ReportMap> maps_;  // tasks refer to them
  std::size_t num_refused_maps_ = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_MAP_RUN_H_
