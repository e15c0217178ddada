#ifndef PLUMBLINE_APPS_IO_PLY_READER_H_
#define PLUMBLINE_APPS_IO_PLY_READER_H_

#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// Reads x, y [m] of each vertex in turn from a binary little-endian PLY file whose first element
/// is `vertex`, with finite x and y of type double, as WritePointsPly writes it; other scalar
/// properties are skipped. NotFound or InvalidArgument if the file cannot be read, DataLoss if it
/// ends early, InvalidArgument, naming file and line of the header (or the vertex), on any other
/// file. Replaces *points on success only.
Status ReadPointsPly(const std::string& path, std::vector<double>* points);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_PLY_READER_H_
