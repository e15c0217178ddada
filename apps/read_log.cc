#include "plumbline/apps/read_log.h"

#include <iostream>
#include <utility>

#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"

namespace plumbline {
namespace {

// The graph mounts all scans alike, which makes nonsense of a second laser on the robot.
void WarnOfOtherMountings(const std::string& path, const LaserMounting& mounting) {
  const std::string disagreement = mounting.Disagreement();
  if (disagreement.empty()) return;
  std::cerr << "warning: " << path << ": " << disagreement
            << "; all are mounted at the median. Are there two lasers, or the poses of another "
               "mapper?\n";
}

}  // namespace

Status ReadLogIntoGraph(const std::string& path, int max_scans, LogCounts* counts,
                        SlamGraph* graph) {
  CarmenLog log;
  PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(path, CarmenReadOptions(), &log));
  for (const CarmenIssue& issue : log.issues) std::cerr << "skipped " << issue.message << '\n';
  WarnOfOtherMountings(path, EstimateLaserMounting(log));
  SlamGraph result;
  PLUMBLINE_RETURN_IF_ERROR(BuildGraph(log, max_scans, &result));
  if (result.num_returns() == 0) {
    return Status::InvalidArgument(path + ": no scan has a return within the laser's range");
  }
  *counts = {log.num_issues, log.num_out_of_order};
  *graph = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
