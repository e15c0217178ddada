#include "plumbline/apps/convert/replace_poses.h"

#include <limits>
#include <vector>

#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/apps/io/trajectory_io.h"

namespace plumbline {
namespace {

// The trajectory's pose for each of the graph's.
Status Match(const std::string& path, const std::vector<TimedPose>& trajectory,
             const SlamGraph& graph, std::vector<TimedPose>* matches) {
  const PoseTimeline timeline(trajectory);
  int first_without = -1, num_without = 0;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    const TimedPose* match = timeline.Nearest(graph.timestamp_s(pose), kSameTime_s);
    if (match != nullptr) {
      matches->push_back(*match);
    } else if (num_without++ == 0) {
      first_without = pose;
    }
  }
  if (num_without == 0) return Status::Ok();
  const double time_s = graph.timestamp_s(first_without);
  const TimedPose* nearest = timeline.Nearest(time_s, std::numeric_limits<double>::infinity());
  return Status::InvalidArgument(
      path + ": no pose at " + ExactText(time_s) + " s, the time of pose " +
      std::to_string(first_without) + "; the nearest is at " + ExactText(nearest->timestamp_s) +
      " s. " + std::to_string(num_without) + " of " + std::to_string(graph.num_poses()) +
      " poses have none within " + ExactText(kSameTime_s) + " s");
}

}  // namespace

Status ReplacePoses(const std::string& trajectory_path, const SlamGraph& graph, MapState* state) {
  std::vector<TimedPose> trajectory;
  PLUMBLINE_RETURN_IF_ERROR(ReadTumTrajectory(trajectory_path, &trajectory));
  Pairing pairing;
  PLUMBLINE_RETURN_IF_ERROR(ChoosePairing({trajectory_path, TimesOf(trajectory)},
                                          {"the log or graph", graph.timestamps_s()}, kSameTime_s,
                                          &pairing));
  if (!pairing.by_order) {
    std::vector<TimedPose> matches;
    PLUMBLINE_RETURN_IF_ERROR(Match(trajectory_path, trajectory, graph, &matches));
    trajectory = std::move(matches);
  }
  std::vector<Pose2> poses;
  poses.reserve(trajectory.size());
  for (const TimedPose& pose : trajectory) poses.push_back(pose.world_from_robot);
  state->poses = PoseArray(poses);
  state->points = graph.MeasuredMap(state->poses);
  return Status::Ok();
}

}  // namespace plumbline
