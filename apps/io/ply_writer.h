#ifndef PLUMBLINE_APPS_IO_PLY_WRITER_H_
#define PLUMBLINE_APPS_IO_PLY_WRITER_H_

#include <string>

#include "plumbline/apps/io/return_records.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Writes every map point as a vertex of a binary little-endian PLY file: `x y z` [m] in the world
/// frame, z = 0, and `scan`, the id of the scan it was seen in. Coordinates are doubles: a float
/// resolves no better than 0.06 mm at 1 km from the origin and worse beyond.
Status WritePointsPly(const std::string& path, const SlamGraph& graph, const MapState& state);

/// Its first step, for the caller to commit.
Status StorePointsPly(const std::string& path, const SlamGraph& graph, const MapState& state,
                      ReturnRecords* file);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_PLY_WRITER_H_
