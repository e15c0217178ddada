#ifndef PLUMBLINE_APPS_IO_POSE_GRAPH_FILE_H_
#define PLUMBLINE_APPS_IO_POSE_GRAPH_FILE_H_

#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Text formats of pose graphs. They differ in the names of two records and in the order of the
/// information matrix.
enum class PoseGraphFormat {
  kG2o,   ///< VERTEX_SE2, EDGE_SE2 with I11 I12 I13 I22 I23 I33
  kToro,  ///< VERTEX2, EDGE2 with I11 I12 I22 I33 I13 I23
};
/// Also the usual extension of such files: "g2o" or "toro".
const char* ToString(PoseGraphFormat format);

/// A pose graph and the file it came in.
struct PoseGraphFile {
  PoseGraphFormat format = PoseGraphFormat::kG2o;
  /// Initial guesses in the order of the vertices, relative poses in the order of the edges,
  /// covariance = inverse of the information.
  SlamGraph graph;
  std::vector<long long> vertex_ids;  ///< the file's name of each pose; any integers
  std::vector<std::string> lines;     ///< the file's text, without line ends
};

/// Tells by the first record whether a file, plain or gzip-compressed, is a pose graph, readable or
/// not; by its extension if there is no record, or a scan, as in a log. False for a file that
/// cannot be opened.
bool IsPoseGraphFile(const std::string& path);

/// Reads a pose graph, plain or gzip-compressed. Records (blank-separated; units m, rad):
///
///   VERTEX_SE2 id x y yaw                           VERTEX2 likewise
///   EDGE_SE2 from to x y yaw information            EDGE2 likewise; pose of `to` seen from `from`,
///                                                   the information in the axes of `to`
///   FIX id ...                                      poses to hold; the first vertex if there is
///                                                   none
///   ROBOTLASER1 ...                                 as in a CARMEN log (carmen_log.h): a scan
///                                                   taken at the vertex most recently read
///   PARAMS_..., comments (#)                        of no effect
///
/// Edges may come before their vertices. A pose has the time of its first scan, or else its index.
/// All lasers must sit at the same place on the robot.
///
/// InvalidArgument, naming file, line and field, on any other record (a constraint that is left out
/// would silently change the result), a field that cannot be read, an information matrix that is
/// not positive definite, two vertices of one id, an edge that joins a vertex with itself, ids
/// without a vertex, a vertex that no edges connect with the first one; if there is no vertex; and
/// if text and scans take more than max_bytes of memory (0: no limit).
/// DataLoss on scans that cannot be read and on a truncated or corrupt compressed file, NotFound or
/// InvalidArgument if the file cannot be read. Replaces *file on success only.
Status ReadPoseGraphFile(const std::string& path, PoseGraphFile* file, double max_bytes = 0.0);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_POSE_GRAPH_FILE_H_
