#include "plumbline/apps/run/log_input.h"

#include <chrono>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <system_error>
#include <vector>

#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/program/implausible_readings.h"
#include "plumbline/apps/program/pose_graph_input.h"
#include "plumbline/apps/program/pose_graph_log.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/front_end/motion_prediction.h"

namespace plumbline {
namespace {

void WarnOfMissingOdometry(const std::string& path) {
  std::cerr << "warning: " << Legible(path)
            << ": there is no odometry, or it never changes: the scans alone tell how the robot "
               "moved. Long bare corridors may come out too short or too long, and fast turns or "
               "gaps between scans may break the map\n";
}

// No fault of the map: the order of the scans is enough.
void NoteUselessClock(const std::string& path, const SlamGraph& graph) {
  const std::string fault = ClockFault(TimesOf(graph));
  if (fault.empty()) return;
  std::cerr << "note: " << Legible(path) << ": " << fault
            << "; the scans are taken in the order of the file\n";
}

Status ReadPoseGraphWithScans(const std::string& path, int max_scans, double max_bytes,
                              RunSummary* summary, SlamGraph* graph) {
  const auto start = std::chrono::steady_clock::now();
  PoseGraphInput input;
  PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraph(path, max_bytes, &input));
  std::vector<std::string> warnings = ImplausibleReadings(input.graph);
  warnings.insert(warnings.end(), input.warnings.begin(), input.warnings.end());
  for (const std::string& warning : warnings) {
    std::cerr << "warning: " << Legible(path) << ": " << warning << '\n';
  }
  const Status made = LogOfPoseGraph(input.graph, max_scans, graph);
  if (!made.ok()) return Status::InvalidArgument(path + ": " + made.message());
  summary->log = path;
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
    PLUMBLINE_RETURN_IF_ERROR(graph->FixPose(pose));
  }
  return Status::Ok();
}

Status ReadLogInput(const std::string& path, int max_scans, double max_bytes, RunSummary* summary,
                    SlamGraph* graph) {
  const auto start = std::chrono::steady_clock::now();
  LogCounts counts;
  PLUMBLINE_RETURN_IF_ERROR(ReadLogIntoGraph(path, max_scans, &counts, graph, max_bytes));
  if (LacksOdometry(*graph)) WarnOfMissingOdometry(path);
  NoteUselessClock(path, *graph);
  summary->log = path;
  summary->num_scans = graph->num_scans();
  summary->num_returns = graph->num_returns();
  summary->num_skipped_records = counts.num_skipped_records;
  summary->read_time_s = SecondsSince(start);
  std::cout << "Read " << Legible(path) << ": " << graph->num_scans() << " scans, "
            << graph->num_returns() << " returns, " << counts.num_skipped_records
            << " records skipped, " << counts.num_out_of_order << " out of order (" << std::fixed
            << std::setprecision(2) << summary->read_time_s << " s)\n";
  return Status::Ok();
}

}  // namespace plumbline
