#include "plumbline/apps/io/transform_tree.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace plumbline {
namespace {

bool IsEarlier(double stamp_s, const StampedTransform& sample) { return stamp_s < sample.stamp_s; }

// Almost always at the end.
void Insert(const StampedTransform& sample, std::vector<StampedTransform>* samples) {
  samples->insert(std::upper_bound(samples->begin(), samples->end(), sample.stamp_s, IsEarlier),
                  sample);
}

}  // namespace

Pose2 InPlane(const Eigen::Isometry3d& transform) {
  const Eigen::Vector3d x_axis = transform.linear().col(0);
  return {transform.translation().x(), transform.translation().y(),
          std::atan2(x_axis.y(), x_axis.x())};
}

bool TransformTree::IsIgnored(const std::string& parent, const std::string& child) {
  if (parent.empty() || child.empty()) {
    ++num_without_name_;
    return true;
  }
  if (parent == child) ++num_to_itself_[child];
  return parent == child;
}

TransformTree::Edge* TransformTree::FindOrAdd(const std::string& parent, const std::string& child) {
  std::vector<Edge>& edges = edges_[child];
  const auto known = std::find_if(edges.begin(), edges.end(),
                                  [&](const Edge& edge) { return edge.parent == parent; });
  if (known != edges.end()) return &*known;
  edges.emplace_back().parent = parent;
  return &edges.back();
}

void TransformTree::Add(const std::string& parent, const std::string& child,
                        const StampedTransform& sample) {
  if (IsIgnored(parent, child)) return;
  Insert(sample, &FindOrAdd(parent, child)->samples);
}

void TransformTree::AddBad(const std::string& parent, const std::string& child,
                           const std::string& kind, const std::string& fault) {
  if (IsIgnored(parent, child)) return;
  FindOrAdd(parent, child)->bad.Add(kind, fault);
}

const TransformTree::Edge* TransformTree::FindEdge(const std::string& parent,
                                                   const std::string& child) const {
  const auto edges = edges_.find(child);
  if (edges == edges_.end()) return nullptr;
  for (const Edge& edge : edges->second) {
    if (edge.parent == parent) return &edge;
  }
  return nullptr;
}

const std::vector<StampedTransform>& TransformTree::Samples(const std::string& parent,
                                                            const std::string& child) const {
  static const std::vector<StampedTransform> none;
  const Edge* edge = FindEdge(parent, child);
  return edge == nullptr ? none : edge->samples;
}

std::vector<std::string> TransformTree::Ancestors(const std::string& frame,
                                                  const std::string& wanted) const {
  std::vector<std::string> frames = {frame};
  std::set<std::string> known = {frame};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto edges = frames[i] == wanted ? edges_.end() : edges_.find(frames[i]);
    if (edges == edges_.end()) continue;
    for (const Edge& edge : edges->second) {
      if (known.insert(edge.parent).second) frames.push_back(edge.parent);
    }
  }
  return frames;
}

Status TransformTree::PathUp(const std::string& frame, const std::string& wanted,
                             std::vector<std::string>* path) const {
  path->clear();
  const std::vector<std::string> ancestors = Ancestors(frame, wanted);
  // Frames that lie on a way to the wanted one, from there downwards.
  std::map<std::string, std::vector<std::string>> below;
  for (const std::string& ancestor : ancestors) {
    const auto edges = edges_.find(ancestor);
    if (ancestor == wanted || edges == edges_.end()) continue;
    for (const Edge& edge : edges->second) below[edge.parent].push_back(ancestor);
  }
  std::set<std::string> reaches = {wanted};
  std::vector<std::string> open = {wanted};
  while (!open.empty()) {
    const std::vector<std::string> next = below[open.back()];
    open.pop_back();
    for (const std::string& lower : next) {
      if (reaches.insert(lower).second) open.push_back(lower);
    }
  }
  if (reaches.count(frame) == 0 ||
      std::find(ancestors.begin(), ancestors.end(), wanted) == ancestors.end()) {
    return Status::Ok();
  }
  std::vector<std::string> result = {frame};
  while (result.back() != wanted) {
    const std::string* parent = nullptr;
    for (const Edge& edge : edges_.at(result.back())) {
      if (reaches.count(edge.parent) == 0) continue;
      if (parent != nullptr) {
        return Status::InvalidArgument("frame '" + result.back() + "' has two parents, '" +
                                       *parent + "' and '" + edge.parent + "', and both lead to '" +
                                       wanted + "'");
      }
      parent = &edge.parent;
    }
    result.push_back(*parent);
  }
  PLUMBLINE_RETURN_IF_ERROR(CheckEdges(result));
  *path = std::move(result);
  return Status::Ok();
}

Status TransformTree::CheckEdges(const std::vector<std::string>& path) const {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Edge& edge = *FindEdge(path[i], path[i - 1]);
    const std::size_t num_bad = edge.bad.num();
    if (num_bad == 0) continue;
    if (edge.samples.empty() || num_bad > BadRecordLimits().Of(num_bad + edge.samples.size())) {
      return Status::InvalidArgument(edge.BadText(path[i - 1]));
    }
  }
  return Status::Ok();
}

std::string TransformTree::Edge::BadText(const std::string& child) const {
  return bad.Text(bad.num() + samples.size(),
                  "transforms from '" + parent + "' to '" + child + "'");
}

std::vector<std::string> TransformTree::PathToRoot(const std::string& frame) const {
  std::vector<std::string> path = {frame};
  std::set<std::string> known = {frame};
  for (auto edges = edges_.find(frame); edges != edges_.end() && edges->second.size() == 1;
       edges = edges_.find(path.back())) {
    const Edge& edge = edges->second.front();
    if (edge.samples.empty() || !known.insert(edge.parent).second) break;
    path.push_back(edge.parent);
  }
  return path;
}

std::vector<std::string> TransformTree::Children(const std::string& parent) const {
  std::vector<std::string> children;
  for (const auto& [child, edges] : edges_) {
    if (FindEdge(parent, child) != nullptr) children.push_back(child);
  }
  return children;
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

Status TransformTree::FindPath(const std::string& target, const std::string& source,
                               std::optional<TransformPath>* path) const {
  path->reset();
  const std::vector<std::string> above_target = Ancestors(target, source);
  const std::vector<std::string> above_source = Ancestors(source, target);
  // Straight up or down where that is possible.
  auto meeting = std::find(above_source.begin(), above_source.end(), target);
  if (meeting == above_source.end() &&
      std::find(above_target.begin(), above_target.end(), source) != above_target.end()) {
    meeting = above_source.begin();
  }
  if (meeting == above_source.end()) {
    meeting = std::find_first_of(above_source.begin(), above_source.end(), above_target.begin(),
                                 above_target.end());
  }
  if (meeting == above_source.end()) return Status::Ok();
  TransformPath found;
  PLUMBLINE_RETURN_IF_ERROR(PathUp(target, *meeting, &found.up_from_target));
  PLUMBLINE_RETURN_IF_ERROR(PathUp(source, *meeting, &found.up_from_source));
  *path = std::move(found);
  return Status::Ok();
}

Eigen::Isometry3d TransformTree::At(const TransformPath& path, double stamp_s) const {
  const auto top_from_first = [&](const std::vector<std::string>& frames) {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    for (std::size_t i = 1; i < frames.size(); ++i) {
      result = FindEdge(frames[i], frames[i - 1])->At(stamp_s) * result;
    }
    return result;
  };
  return top_from_first(path.up_from_target).inverse() * top_from_first(path.up_from_source);
}

std::string TransformTree::FrameNames() const {
  std::set<std::string> names;
  for (const auto& [child, edges] : edges_) {
    names.insert(child);
    for (const Edge& edge : edges) names.insert(edge.parent);
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::string TransformTree::IgnoredText() const {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  for (const auto& [frame, count] : num_to_itself_) {
    add(std::to_string(count) + " from '" + frame + "' to itself");
  }
  if (num_without_name_ > 0)
    add(std::to_string(num_without_name_) + " without the name of a frame");
  for (const auto& [child, edges] : edges_) {
    if (edges.size() < 2) continue;
    std::string parents;
    for (const Edge& edge : edges) parents += (parents.empty() ? "'" : ", '") + edge.parent + "'";
    add("'" + child + "' has several parents, " + parents +
        ": those that do not lead to the wanted frame");
  }
  return text;
}

std::vector<std::string> TransformTree::BadSamplesText(const TransformPath& path) const {
  std::vector<std::string> texts;
  for (const std::vector<std::string>* frames : {&path.up_from_target, &path.up_from_source}) {
    for (std::size_t i = 1; i < frames->size(); ++i) {
      const Edge& edge = *FindEdge((*frames)[i], (*frames)[i - 1]);
      if (edge.bad.num() > 0) texts.push_back(edge.BadText((*frames)[i - 1]));
    }
  }
  return texts;
}

TransformTree TransformTree::ByRecordClock() const {
  TransformTree tree = *this;
  for (auto& [child, edges] : tree.edges_) {
    for (Edge& edge : edges) {
      std::vector<StampedTransform> samples;
      samples.swap(edge.samples);
      for (StampedTransform& sample : samples) {
        sample.stamp_s = sample.received_s;
        Insert(sample, &edge.samples);
      }
    }
  }
  return tree;
}

}  // namespace plumbline
