#ifndef PLUMBLINE_APPS_IO_POSE_GRAPH_WRITER_H_
#define PLUMBLINE_APPS_IO_POSE_GRAPH_WRITER_H_

#include <string>
#include <vector>

#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// Puts a graph into words, as a g2o file to write or to convert: its initial guesses of the poses,
/// numbered from 0, each followed by its scans; FIX; edges, first those of the odometry, then the
/// relative poses.
///
/// An odometry constraint has no covariance of its own: its edge has the one that `motion` gives
/// it. Information is the inverse of the covariance. A scan is a ROBOTLASER1 record with the time
/// and, as its odometry, the pose of its vertex. A beam without a return reads more than the
/// maximum range, by so much that ReadCarmenLog does not take readings just below the maximum for
/// the same. Map points are not in the file, nor are times of vertices without a scan. Lasers
/// that are mounted differently are, but ReadPoseGraphFile refuses them.
///
/// Read back, poses, ranges and motions are the same to the last bit; the mounting of the lasers
/// and the covariances to rounding.
///
/// InvalidArgument if returns do not lie on the beams of their laser, one each, as those that came
/// in by AddPoints need not: the record has no place for them. Replaces *file on success only.
Status MakePoseGraphFile(SlamGraph graph, const MotionOptions& motion, PoseGraphFile* file);

/// Writes the file in either format with these poses (as MapState::poses, for its graph); all else
/// stays as it is, number by number, and so do vertices whose pose is the one in the file. The
/// numbers of the others round-trip exactly, yaw in [-pi, pi). The formats' inventors gave TORO
/// neither FIX nor laser records; they are kept, for ReadPoseGraphFile takes them and TORO's own
/// programs skip records they do not know. Unavailable if the file cannot be written.
Status WritePoseGraphFile(const std::string& path, PoseGraphFormat format,
                          const PoseGraphFile& file, const std::vector<double>& poses);

/// Writes the g2o file of a graph that MakePoseGraphFile describes, with these poses (as
/// MapState::poses) for its vertices and with more edges at its end. Its text, several times as
/// large as the graph, is never all in memory. Processes that share the graph write one file
/// (collective). Fails like MakePoseGraphFile, and like WritePoseGraphFile.
Status WritePoseGraph(const std::string& path, const SlamGraph& graph, const MotionOptions& motion,
                      const std::vector<RelativePoseConstraint>& more_edges,
                      const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_POSE_GRAPH_WRITER_H_
