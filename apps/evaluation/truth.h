#ifndef PLUMBLINE_APPS_EVALUATION_TRUTH_H_
#define PLUMBLINE_APPS_EVALUATION_TRUTH_H_

#include <string>
#include <vector>

#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What a simulation knows of a log: the true pose of every scan and, where given, the point that
/// each return measured.
struct Truth {
  std::vector<TimedPose> trajectory;  ///< one per pose of the graph, in its order
  /// x, y [m] per return of the graph; empty if no hits were given, NaN for a return without one.
  std::vector<double> points;
};

/// Errors against the truth after the rigid motion that fits the trajectories best (least squares
/// over the positions), so that the choice of world frame does not count.
struct TruthError {
  double mean_pose_error_m = 0.0;
  double mean_pose_error_rad = 0.0;
  double mean_point_error_m = 0.0;  ///< over the returns with a true point; NaN if there are none
  double max_pose_error_m = 0.0;
};

/// Reads a TUM trajectory and, if hits_path is not empty, a table of lines `t beam x y`, and joins
/// them to the graph's poses by time (to 1 ms); poses of the same times one by one are joined in
/// their order. Files may be compressed. Fails like ChoosePairing. NotFound or
/// InvalidArgument if a file cannot be read, DataLoss if it is truncated or corrupt;
/// InvalidArgument, naming file, line and field, on a line that is none of these, and if a pose of
/// the graph has no truth. Replaces *truth on success only.
Status ReadTruth(const std::string& trajectory_path, const std::string& hits_path,
                 const SlamGraph& graph, Truth* truth);

/// For a state of the graph that the truth was joined to; one without points has them where the
/// measurements put them. Of a graph that is shared, every process has the whole truth (ShareTruth)
/// and gets the error over all parts.
TruthError CompareWithTruth(const SlamGraph& graph, const MapState& state, const Truth& truth);

/// Gives the truth of the whole graph, which the speaker has, to all processes. peers: null if
/// there are no others.
void ShareTruth(const Peers* peers, Truth* truth);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_TRUTH_H_
