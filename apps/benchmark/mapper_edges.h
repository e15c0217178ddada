#ifndef PLUMBLINE_APPS_BENCHMARK_MAPPER_EDGES_H_
#define PLUMBLINE_APPS_BENCHMARK_MAPPER_EDGES_H_

#include <vector>

#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// How the closures of a mapper are false.
enum class FalseClosures {
  kGross,   ///< each by itself, by metres
  kBiased,  ///< ten neighbours alike, by 0.1 to 0.5 m along the way: matches along a corridor
};

/// The edges that a mapper makes of a drive.
struct MapperEdges {
  std::vector<RelativePoseConstraint> edges;  ///< from pose to pose first, then the closures
  std::vector<char> is_false;                 ///< per edge
};

/// Steps from pose to pose that are 5 mm and 2 mrad off, and closures between poses of different
/// passes that look at the same place, 20 mm and 5 mrad off; the covariances say so. A share of the
/// closures is false, about, which their covariances do not say.
MapperEdges MakeMapperEdges(const std::vector<Pose2>& truth, FalseClosures kind, double share,
                            NoiseSource* source);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_MAPPER_EDGES_H_
