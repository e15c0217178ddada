#ifndef PLUMBLINE_APPS_LIVE_SAVE_LIVE_MAP_H_
#define PLUMBLINE_APPS_LIVE_SAVE_LIVE_MAP_H_

#include <string>

#include "plumbline/apps/live/live_node.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// Writes a map into a folder: the files of plumbline_slam --save_map for the same scans. The
/// folder appears with all of them or not at all; an earlier map there is replaced at once.
/// mapping: a finished one, as OnlineMapper::MapNow gives it, by `options`. resolution_m: of
/// map.pgm [m].
///
/// InvalidArgument if the folder holds other files; Unavailable if the system refuses. A killed
/// program may leave FOLDER.saving.
Status SaveLiveMap(const MapLogOptions& options, double resolution_m, const std::string& folder,
                   MappedDrive drive);

/// Reads the scans of a saved map, map.g2o, for LiveNode::UseMap. is_fixed: its poses are fixed, to
/// localise in it. InvalidArgument, naming the file, if it is no map with scans; fails like
/// ReadPoseGraph.
Status ReadSavedMap(const std::string& path, bool is_fixed, SlamGraph* map);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_SAVE_LIVE_MAP_H_
