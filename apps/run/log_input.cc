#include "plumbline/apps/run/log_input.h"

#include <chrono>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <system_error>
#include <utility>
#include <vector>

#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/apps/readers/pose_graph_input.h"
#include "plumbline/apps/readers/pose_graph_log.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/front_end/motion_prediction.h"

namespace plumbline {
namespace {

// Doubts about the log of a run, which other programs do not care about.
std::vector<Warning> DoubtsAbout(const std::string& path, const SlamGraph& graph) {
  std::vector<Warning> warnings;
  if (LacksOdometry(graph)) {
    warnings.push_back(
        {"no_odometry",
         path + ": there is no odometry, or it never changes: the scans alone tell how the robot "
                "moved. Long bare corridors may come out too short or too long, and fast turns or "
                "gaps between scans may break the map"});
  }
  const std::string fault = ClockFault(graph.timestamps_s());
  if (!fault.empty()) {
    warnings.push_back(
        {"useless_clock", path + ": " + fault + "; the scans are taken in the order of the file"});
  }
  return warnings;
}

Status ReadPoseGraphWithScans(const std::string& path, int max_scans, double max_bytes,
                              RunSummary* summary, SlamGraph* graph) {
  const auto start = std::chrono::steady_clock::now();
  PoseGraphInput input;
  PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraph(path, max_bytes, &input));
  PrintWarnings(input.warnings);
  const Status made = LogOfPoseGraph(input.graph, max_scans, graph);
  if (!made.ok()) return Status::InvalidArgument(path + ": " + made.message());
  summary->log = path;
  summary->warnings = std::move(input.warnings);
  summary->num_scans = graph->num_scans();
  summary->num_returns = graph->num_returns();
  summary->read_time_s = SecondsSince(start);
  std::cout << "Read " << Legible(path) << " (" << input.format << "): " << graph->num_scans()
            << " scans, " << graph->num_returns()
            << " returns; its poses take the place of the odometry, its edges do not count ("
            << std::fixed << std::setprecision(2) << summary->read_time_s << " s)\n";
  return Status::Ok();
}

}  // namespace

Status ReadSession(const std::string& path, int max_scans, double max_bytes, RunSummary* summary,
                   SlamGraph* graph) {
  return IsPoseGraph(path) ? ReadPoseGraphWithScans(path, max_scans, max_bytes, summary, graph)
                           : ReadLogInput(path, max_scans, max_bytes, summary, graph);
}

Status ReadFixedMap(const std::string& path, double max_bytes, RunSummary* summary,
                    SlamGraph* graph) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !IsPoseGraph(path)) {
    return Status::InvalidArgument(path + ": no pose graph with scans; --save_map writes one");
  }
  PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraphWithScans(path, 0, max_bytes, summary, graph));
  for (int pose = 0; pose < graph->num_poses(); ++pose) {
    graph->FixPose(pose);
  }
  return graph->status();
}

Status ReadLogInput(const std::string& path, int max_scans, double max_bytes, RunSummary* summary,
                    SlamGraph* graph) {
  const auto start = std::chrono::steady_clock::now();
  LogNotes notes;
  PLUMBLINE_RETURN_IF_ERROR(ReadLogIntoGraph(path, max_scans, &notes, graph, max_bytes));
  const std::vector<Warning> doubts = DoubtsAbout(path, *graph);
  PrintWarnings(doubts);
  summary->log = path;
  summary->warnings = std::move(notes.warnings);
  summary->warnings.insert(summary->warnings.end(), doubts.begin(), doubts.end());
  summary->num_scans = graph->num_scans();
  summary->num_returns = graph->num_returns();
  summary->num_skipped_records = notes.counts.num_skipped_records;
  summary->no_return_level_m = notes.no_return_level_m;
  summary->read_time_s = SecondsSince(start);
  std::cout << "Read " << Legible(path) << ": " << graph->num_scans() << " scans, "
            << graph->num_returns() << " returns, " << notes.counts.num_skipped_records
            << " records skipped, " << notes.counts.num_out_of_order << " out of order ("
            << std::fixed << std::setprecision(2) << summary->read_time_s << " s)\n";
  if (notes.no_return_level_m) {
    std::cout << "  Readings from " << std::setprecision(3) << *notes.no_return_level_m
              << " m on are no returns\n";
  }
  return Status::Ok();
}

}  // namespace plumbline
