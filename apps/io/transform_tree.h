#ifndef PLUMBLINE_APPS_IO_TRANSFORM_TREE_H_
#define PLUMBLINE_APPS_IO_TRANSFORM_TREE_H_

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/io/bad_records.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What the plane keeps of a transform: x, y, and the direction of the x axis.
Pose2 InPlane(const Eigen::Isometry3d& transform);

/// Where a frame lies in the one above it at a time.
struct StampedTransform {
  double stamp_s = 0.0;
  Eigen::Isometry3d parent_from_child = Eigen::Isometry3d::Identity();
  double received_s = 0.0;  ///< by the clock of the recorder [s]
};

/// Frames from one to another: up from both to a frame that they have in common.
struct TransformPath {
  std::vector<std::string> up_from_target, up_from_source;  ///< each with both of its ends
};

/// The frames of a robot as ROS' tf has them. A frame may have several parents as long as only one
/// way leads to the wanted frame.
class TransformTree {
 public:
  /// Takes a sample of an edge. The order of the stamps is free. Counts and ignores, as tf2 does,
  /// an edge from a frame to itself and one with an empty name.
  void Add(const std::string& parent, const std::string& child, const StampedTransform& sample);

  /// Counts a sample of an edge that is no transform. kind: of the fault; fault: names the message.
  void AddBad(const std::string& parent, const std::string& child, const std::string& kind,
              const std::string& fault);

  /// The frames from `frame` up to `wanted`, both included; empty if `wanted` is not above `frame`.
  /// InvalidArgument, naming a frame, if several ways lead there, or if an edge of the way has more
  /// bad samples than BadRecordLimits allow or no good ones.
  Status PathUp(const std::string& frame, const std::string& wanted,
                std::vector<std::string>* path) const;

  /// The frame itself, its parent, and so on: up to a root, to a frame with several parents or to
  /// a frame that is above itself.
  std::vector<std::string> PathToRoot(const std::string& frame) const;

  /// The frames right below a frame, by name.
  std::vector<std::string> Children(const std::string& parent) const;

  /// Good samples of an edge, in order of time; empty if there is no such edge.
  const std::vector<StampedTransform>& Samples(const std::string& parent,
                                               const std::string& child) const;

  /// The way from one frame to another; empty if no edges join the two. Fails like PathUp.
  Status FindPath(const std::string& target, const std::string& source,
                  std::optional<TransformPath>* path) const;

  /// target_from_source along a path of this tree at a time [s]. Edges are interpolated between
  /// their samples (translation linearly, rotation on the shortest way) and rest before the first
  /// and after the last one.
  Eigen::Isometry3d At(const TransformPath& path, double stamp_s) const;

  /// Every frame that is named, with commas, to tell a user; "none" if there is none.
  std::string FrameNames() const;

  /// The edges and samples that were ignored, for a user; empty if there are none.
  std::string IgnoredText() const;
  /// The bad samples along a path, a text per edge, for a user.
  std::vector<std::string> BadSamplesText(const TransformPath& path) const;

  /// The same tree with the times at which the samples were recorded.
  TransformTree ByRecordClock() const;

 private:
  struct Edge {
    std::string parent;
    std::vector<StampedTransform> samples;
    BadRecords bad;

    Eigen::Isometry3d At(double stamp_s) const;
    std::string BadText(const std::string& child) const;
  };

  Edge* FindOrAdd(const std::string& parent, const std::string& child);
  const Edge* FindEdge(const std::string& parent, const std::string& child) const;
  bool IsIgnored(const std::string& parent, const std::string& child);
  // `frame` and all frames above it, the nearest first; none above `wanted`.
  std::vector<std::string> Ancestors(const std::string& frame, const std::string& wanted) const;
  Status CheckEdges(const std::vector<std::string>& path) const;

  std::map<std::string, std::vector<Edge>> edges_;  // by the lower frame
  std::map<std::string, std::size_t> num_to_itself_;
  std::size_t num_without_name_ = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_TRANSFORM_TREE_H_
