#ifndef PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_WRITER_H_
#define PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_WRITER_H_

#include <ostream>
#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// Writes a state of Cartographer, the content of a file that ReadCartographerState has read, with
/// other poses of its nodes and submaps: as MapState::poses, in the order of BuildGraph. Height and
/// tilt of the poses stay, and so does all else, byte by byte: point clouds, grids, constraints,
/// poses of landmarks, sensor data. A pose that is the one in the file stays as it is written.
void WriteCartographerState(const std::string& content, const std::vector<double>& poses,
                            std::ostream* stream);

/// The same to a file. Unavailable if it cannot be written.
Status WriteCartographerState(const std::string& path, const std::string& content,
                              const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_WRITER_H_
