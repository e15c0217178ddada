#include <cmath>

#include "plumbline/apps/evaluation/trajectory_metrics.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/test/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile file;
  const std::string path = file.Holding(data, size);
  std::vector<TimedPose> trajectory;
  if (!ReadTumTrajectory(path, &trajectory).ok()) return 0;
  const TrajectoryMetrics metrics =
      MeasureTrajectory(trajectory, trajectory, TrajectoryMetricsOptions());
  Require(metrics.absolute.num_matched == trajectory.size());
  Require(std::isfinite(metrics.absolute.translation_m.mean));
  Require(WriteTumTrajectory(path, trajectory).ok());
  std::vector<TimedPose> again;
  Require(ReadTumTrajectory(path, &again).ok());
  Require(again.size() == trajectory.size());
  return 0;
}
