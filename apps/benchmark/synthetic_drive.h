#ifndef PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_DRIVE_H_
#define PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_DRIVE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/apps/simulation/world.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How noisy a drive is.
struct SyntheticNoise {
  std::string name;
  double sigma_range_m = 0.03;     ///< of a reading [m]
  double sigma_bearing_rad = 0.0;  ///< of the direction in which a beam leaves [rad]
  double odometry_factor = 1.0;    ///< times all errors of the default OdometryNoise

  LaserNoise Laser() const;
  OdometryNoise Odometry() const;
};

/// A short drive with few scans far apart, where every scan has to count: once around a block of a
/// small office floor at right angles, about 36 m, 16 scans of 720 beams all around.
struct SyntheticDrive {
  Building building;
  SimulatedLog log;
  SlamGraph graph;    ///< what a mapper may know, as MakeGraph gives it
  MapEstimate truth;  ///< NaN for the points of returns that are not the building's
};

/// The same seed and noise give the same drive; drives of one seed and different noise are through
/// the same building. InvalidArgument on noise out of range.
Status MakeSyntheticDrive(std::uint64_t seed, const SyntheticNoise& noise, SyntheticDrive* drive);

/// The ends of the beams as measured, placed by these poses. x, y [m] per return.
std::vector<double> PlacedReturns(const SlamGraph& graph, const std::vector<Pose2>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_DRIVE_H_
