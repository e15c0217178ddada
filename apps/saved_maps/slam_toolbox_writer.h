#ifndef PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_WRITER_H_
#define PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_WRITER_H_

#include <string>
#include <vector>

#include "plumbline/apps/saved_maps/slam_toolbox_map.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Writes a map with other poses of its scans, as MapState::poses in the order of GraphScansOf(),
/// to a path x.posegraph and to x.data beside it. slam_toolbox opens it as it opens the given map.
///
/// The corrected poses change in both files, and each scan is marked as moved, upon which
/// slam_toolbox places its points anew. The edges between scans that have moved say what the new
/// poses say, with the covariances that they had: slam_toolbox optimises them at every loop
/// closure, which would else bring the given map back. All else stays, byte by byte, and so do
/// scans whose poses are the given ones, and the edges between them.
///
/// Unavailable if a file cannot be written.
Status WriteSlamToolboxMap(const std::string& path, const SlamToolboxMap& map,
                           const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_WRITER_H_
