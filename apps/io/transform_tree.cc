#include "plumbline/apps/io/transform_tree.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace plumbline {
namespace {

bool IsEarlier(double stamp_s, const StampedTransform& sample) { return stamp_s < sample.stamp_s; }

}  // namespace

Pose2 InPlane(const Eigen::Isometry3d& transform) {
  const Eigen::Vector3d x_axis = transform.linear().col(0);
  return {transform.translation().x(), transform.translation().y(),
          std::atan2(x_axis.y(), x_axis.x())};
}

void TransformTree::Add(const std::string& parent, const std::string& child,
                        const StampedTransform& sample) {
  Edge& edge = edges_[child];
  if (edge.parent.empty()) edge.parent = parent;
  if (parent != edge.parent) {
    edge.second_parent = parent;
    return;
  }
  // Almost always at the end.
  const auto place =
      std::upper_bound(edge.samples.begin(), edge.samples.end(), sample.stamp_s, IsEarlier);
  edge.samples.insert(place, sample);
}

Status TransformTree::PathUp(const std::string& frame, std::vector<std::string>* path) const {
  std::vector<std::string> result = {frame};
  for (auto edge = edges_.find(frame); edge != edges_.end(); edge = edges_.find(result.back())) {
    const std::string& parent = edge->second.parent;
    if (!edge->second.second_parent.empty()) {
      return Status::InvalidArgument("frame '" + edge->first + "' has two parents, '" + parent +
                                     "' and '" + edge->second.second_parent + "'");
    }
    if (std::find(result.begin(), result.end(), parent) != result.end()) {
      return Status::InvalidArgument("frame '" + parent + "' is above itself");
    }
    result.push_back(parent);
  }
  *path = std::move(result);
  return Status::Ok();
}

Eigen::Isometry3d TransformTree::Edge::At(double stamp_s) const {
  const auto after = std::upper_bound(samples.begin(), samples.end(), stamp_s, IsEarlier);
  if (after == samples.begin()) return after->parent_from_child;
  const auto before = std::prev(after);
  if (after == samples.end()) return before->parent_from_child;
  const double share = (stamp_s - before->stamp_s) / (after->stamp_s - before->stamp_s);
  const Eigen::Isometry3d &from = before->parent_from_child, &to = after->parent_from_child;
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(from.linear()).slerp(share, Eigen::Quaterniond(to.linear()));
  return Eigen::Translation3d((1.0 - share) * from.translation() + share * to.translation()) *
         rotation;
}

Status TransformTree::Find(const std::string& target, const std::string& source, double stamp_s,
                           std::optional<Eigen::Isometry3d>* target_from_source) const {
  std::vector<std::string> up_from_target, up_from_source;
  PLUMBLINE_RETURN_IF_ERROR(PathUp(target, &up_from_target));
  PLUMBLINE_RETURN_IF_ERROR(PathUp(source, &up_from_source));
  target_from_source->reset();
  const auto meeting = std::find_first_of(up_from_source.begin(), up_from_source.end(),
                                          up_from_target.begin(), up_from_target.end());
  if (meeting == up_from_source.end()) return Status::Ok();
  const auto meeting_from = [&](const std::vector<std::string>& path) {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    for (auto frame = path.begin(); *frame != *meeting; ++frame) {
      result = edges_.at(*frame).At(stamp_s) * result;
    }
    return result;
  };
  *target_from_source = meeting_from(up_from_target).inverse() * meeting_from(up_from_source);
  return Status::Ok();
}

std::string TransformTree::FrameNames() const {
  std::set<std::string> names;
  for (const auto& [child, edge] : edges_) names.insert({child, edge.parent});
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

}  // namespace plumbline
