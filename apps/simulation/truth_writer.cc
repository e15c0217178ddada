#include "plumbline/apps/simulation/truth_writer.h"

#include <ios>
#include <ostream>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/trajectory_io.h"

namespace plumbline {

Status WriteTrueTrajectory(const std::string& path, const SimulatedLog& log) {
  std::vector<TimedPose> trajectory;
  for (const SimulatedScan& scan : log.scans) {
    trajectory.push_back({scan.scan.timestamp_s, scan.world_from_robot});
  }
  return WriteTumTrajectory(path, trajectory);
}

Status WriteTrueHits(const std::string& path, const SimulatedLog& log) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << std::fixed;
  out.precision(6);
  for (const SimulatedScan& scan : log.scans) {
    for (std::size_t beam = 0; beam < scan.hits.size(); ++beam) {
      const Eigen::Vector2d& hit = scan.hits[beam];
      if (!hit.allFinite()) continue;
      out << scan.scan.timestamp_s << ' ' << beam << ' ' << hit.x() << ' ' << hit.y() << '\n';
    }
  }
  return file.Commit();
}

}  // namespace plumbline
