#ifndef PLUMBLINE_APPS_IO_PCD_WRITER_H_
#define PLUMBLINE_APPS_IO_PCD_WRITER_H_

#include <string>

#include "plumbline/apps/io/return_records.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Writes every map point to a binary PCD file, version 0.7: `x y z` [m], z = 0, and `scan`, the id
/// of the scan it was seen in.
///
/// Coordinates are floats, because PCL's point types take nothing else (before version 1.15 it
/// leaves double fields unread). A float resolves 0.5 mm up to 8 km. So that maps in wide
/// coordinates such as UTM keep that, points are relative to the first pose's position rounded to
/// 10 km: zero for a map that begins within 5 km of the origin. The header's VIEWPOINT holds that
/// offset, world point = VIEWPOINT + point.
Status WritePointsPcd(const std::string& path, const SlamGraph& graph, const MapState& state);

/// Its first step, for the caller to commit.
Status StorePointsPcd(const std::string& path, const SlamGraph& graph, const MapState& state,
                      ReturnRecords* file);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_PCD_WRITER_H_
