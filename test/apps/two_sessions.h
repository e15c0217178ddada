#ifndef PLUMBLINE_TEST_APPS_TWO_SESSIONS_H_
#define PLUMBLINE_TEST_APPS_TWO_SESSIONS_H_

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/apps/evaluation/session_changes.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {

/// A room on two days: a graph of the scans of both, one after the other.
struct TwoSessions {
  SlamGraph graph;
  std::vector<SessionMark> marks;
};

/// On the first day there is what `first` holds besides the walls (Room), on the second day
/// `second`.
inline TwoSessions MakeTwoSessions(const std::vector<Face>& first,
                                   const std::vector<Face>& second) {
  TwoSessions sessions;
  for (const std::vector<Face>& furniture : {first, second}) {
    SyntheticScene scene = Room();
    scene.faces.insert(scene.faces.end(), furniture.begin(), furniture.end());
    scene.poses = {Pose2(-2.0, 1.5, 0.0), Pose2(-1.5, 1.5, 0.2), Pose2(-1.0, 1.4, 0.4)};
    const SlamGraph day = MakeGraph(scene);
    const int number = static_cast<int>(sessions.marks.size());
    sessions.marks.push_back({number == 0 ? "first.clf" : "second.clf", number,
                              sessions.graph.num_scans(), day.num_scans()});
    for (int pose = 0; pose < day.num_poses(); ++pose) {
      const int id = sessions.graph.AddPose(day.InitialPose(pose), number + 0.1 * pose);
      sessions.graph.AddScanOf(day, pose, id);
    }
  }
  return sessions;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_TWO_SESSIONS_H_
