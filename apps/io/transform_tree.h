#ifndef PLUMBLINE_APPS_IO_TRANSFORM_TREE_H_
#define PLUMBLINE_APPS_IO_TRANSFORM_TREE_H_

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What the plane keeps of a transform: x, y, and the direction of the x axis.
Pose2 InPlane(const Eigen::Isometry3d& transform);

/// Where a frame lies in the one above it at a time.
struct StampedTransform {
  double stamp_s = 0.0;
  Eigen::Isometry3d parent_from_child = Eigen::Isometry3d::Identity();
};

/// The frames of a robot as ROS' tf has them: each has at most one parent, to which it may move.
class TransformTree {
 public:
  /// Takes a sample of an edge. The order of the stamps is free. A frame's second parent is kept in
  /// mind and makes lookups through the frame fail.
  void Add(const std::string& parent, const std::string& child, const StampedTransform& sample);

  /// The frame itself, its parent, and so on up to the root. A name that the tree does not know is
  /// its own root. InvalidArgument, naming the frame, on two parents or a cycle.
  Status PathUp(const std::string& frame, std::vector<std::string>* path) const;

  /// Samples of the edge above a frame, in order of time; the frame needs a parent.
  const std::vector<StampedTransform>& Samples(const std::string& frame) const {
    return edges_.at(frame).samples;
  }

  /// target_from_source at a time. Edges are interpolated between their samples (translation
  /// linearly, rotation on the shortest way) and rest before the first and after the last one.
  /// Empty if no edges join the two. Fails like PathUp.
  Status Find(const std::string& target, const std::string& source, double stamp_s,
              std::optional<Eigen::Isometry3d>* target_from_source) const;

  /// Every frame that is named, with commas, to tell a user; "none" if there is none.
  std::string FrameNames() const;

 private:
  struct Edge {
    std::string parent, second_parent;
    std::vector<StampedTransform> samples;

    Eigen::Isometry3d At(double stamp_s) const;
  };

  std::map<std::string, Edge> edges_;  // by the lower frame
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_TRANSFORM_TREE_H_
