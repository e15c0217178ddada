#ifndef PLUMBLINE_SOLVERS_FRONT_END_KEYFRAME_GRAPH_H_
#define PLUMBLINE_SOLVERS_FRONT_END_KEYFRAME_GRAPH_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/odometry_report.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// A scan that stands for its surroundings in the local map and in the pose graph.
struct Keyframe {
  int pose = 0;
  int scan = 0;
  double path_m = 0.0;  ///< driven from the first pose to here
  /// What the match knows of its pose: as ScanMatch::information, but in axes of the robot.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  /// A scan since the keyframe before, or its own, matched nothing: that step is the odometry's.
  bool after_unmatched = false;
};

/// Ids of the scans.
std::vector<int> ScansOf(const std::vector<Keyframe>& keyframes);

/// The tie of a keyframe to the one before it.
struct SequentialEdge {
  RelativePoseConstraint constraint;  ///< from keyframe k to k + 1
  /// How badly the scans on its two sides agree, if much worse than elsewhere on the drive; else 0.
  double evidence = 0.0;
  /// If there is evidence, the first pose that disagrees with those before it.
  int first_pose_after = 0;
  /// The hypothesis at hand allows for the edge to be wrong: closures may contradict it.
  bool in_question = false;
  /// It is in question, and is wrong, as closures across it show or a hypothesis says: it no longer
  /// counts.
  bool broken = false;
  /// Another session begins on its far side: nothing was measured between the two. Broken, too.
  bool between_sessions = false;

  /// Its far side may be anywhere near by.
  bool untrusted() const {
    return broken || (in_question && evidence >= SuspectStep::kUntrustedEvidence);
  }
  /// What counts of it: a broken edge keeps the graph in one piece, and no more.
  RelativePoseConstraint InForce() const {
    RelativePoseConstraint in_force = constraint;
    constexpr double kSigmaM = 10.0, kSigmaRad = 3.0;
    constexpr double kVarianceM = kSigmaM * kSigmaM, kVarianceRad = kSigmaRad * kSigmaRad;
    if (broken) {
      in_force.covariance = Eigen::Vector3d(kVarianceM, kVarianceM, kVarianceRad).asDiagonal();
    }
    return in_force;
  }
};

/// Poses of the keyframes that were given with independent errors.
struct GivenKeyPoses {
  std::vector<Pose2> given_from_key;  ///< one per keyframe, or empty: the poses given are odometry
  PoseNoise noise;
  Pose2 world_from_given;  ///< estimated with the keyframes
};

/// The pose graph of the keyframes. Constraints name keyframes by index.
struct KeyframeGraph {
  std::vector<Keyframe> keyframes;    ///< in order of time
  std::vector<Pose2> world_from_key;  ///< one per keyframe
  std::vector<SequentialEdge> sequential;
  std::vector<RelativePoseConstraint> closures;  ///< from the earlier to the later keyframe
  /// Closures that the others contradicted: not to be found again.
  std::vector<RelativePoseConstraint> contradicted;
  /// Closures whose cluster the map contradicts: neither they nor closures that repeat them.
  std::vector<RelativePoseConstraint> refused;
  /// Matches that fall short of a closure, the best first.
  std::vector<RelativePoseConstraint> tentative;
  GivenKeyPoses given;
  /// Number of the first keyframes, which belong to a finished map and stay where they are.
  /// Such a graph has no given poses.
  int num_fixed = 0;

  int size() const { return static_cast<int>(keyframes.size()); }

  /// The first keyframe of the session that has this one, and the first one after it.
  int BeginOfSession(int key) const;
  int EndOfSession(int key) const;  ///< see BeginOfSession
};

/// Moves every pose with the keyframes before and after it, in the ratio of their distance in time.
/// before: world_from_robot of every pose as the keyframes were matched.
std::vector<Pose2> PosesFollowingKeyframes(const KeyframeGraph& keyframe_graph,
                                           const std::vector<Pose2>& before);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_KEYFRAME_GRAPH_H_
