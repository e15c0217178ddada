#ifndef PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_MAP_H_
#define PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_MAP_H_

#include <string>
#include <vector>

#include "plumbline/apps/saved_maps/boost_archive.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// The two files of a map that slam_toolbox has saved, archives of Boost.Serialization of
/// KartoClasses(). Both hold the scans.
struct SlamToolboxMap {
  std::string path;      ///< x.posegraph
  BoostArchive mapper;   ///< x.posegraph: the graph, and the state and parameters of the mapper
  BoostArchive dataset;  ///< x.data: the lasers
};

/// Whether a file is an archive of Boost.Serialization, or is named x.posegraph.
bool IsSlamToolboxMap(const std::string& path);

/// x.posegraph and, beside it, x.data.
std::vector<std::string> SlamToolboxFiles(const std::string& path);

/// Reads x.posegraph and x.data, if they and what is kept of them take at most max_bytes of memory
/// (0: no limit). NotFound or InvalidArgument if one of them cannot be read, InvalidArgument for a
/// file of another name, and like BoostArchive::Read, naming the file. Replaces *map on success
/// only.
Status ReadSlamToolboxMap(const std::string& path, double max_bytes, SlamToolboxMap* map);

/// The scans of the graph in the order in which they were taken, that of their ids.
std::vector<ArchiveObject> GraphScansOf(const SlamToolboxMap& map);
/// The edges of the graph; any pointer in them may be null.
std::vector<ArchiveObject> GraphEdgesOf(const SlamToolboxMap& map);
/// The scans in the dataset.
std::vector<ArchiveObject> DatasetScansOf(const SlamToolboxMap& map);

/// What a scan is called by, once in a map.
int ScanId(const ArchiveObject& scan);
/// x, y [m], yaw [rad] of a Pose2.
Pose2 PoseOf(const ArchiveObject& pose);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_MAP_H_
