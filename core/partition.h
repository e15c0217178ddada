#ifndef PLUMBLINE_CORE_PARTITION_H_
#define PLUMBLINE_CORE_PARTITION_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Divides places into num_parts >= 1 parts of about the same weight, each with few neighbours:
/// halves along the longer side of what is left, again and again. places: x, y, yaw each, as
/// MapState::poses; weights: one per place. Gives the part of each place, from 0. The same input
/// gives the same parts.
std::vector<int> PartitionByPlace(const std::vector<double>& places,
                                  const std::vector<std::size_t>& weights, int num_parts);

/// Divides places into as many parts, each of about as many that follow each other.
std::vector<int> PartitionByTime(int num_places, int num_parts);

/// Number of returns taken at each pose, those of a graph's peers included.
std::vector<std::size_t> ReturnsPerPose(const SlamGraph& graph);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_PARTITION_H_
