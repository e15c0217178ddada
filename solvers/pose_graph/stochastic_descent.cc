#include "plumbline/solvers/pose_graph/stochastic_descent.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/sqrt_information.h"
#include "plumbline/solvers/pose_graph/pose_sets.h"

namespace plumbline {
namespace {

// Ends when no edge of an iteration moves its end by more than this [m], and [rad].
constexpr double kStepTolerance = 1e-6;

using Eigen::Array3d;

// Differences of consecutive poses, numbered along the chains: [begin, end).
struct Range {
  int begin = 0;
  int end = 0;

  int size() const { return end - begin; }
};

// What leads from one pose to another: the differences of `plus` less those of `minus`.
struct Path {
  Range minus, plus;

  int size() const { return minus.size() + plus.size(); }
};

struct PathEdge {
  int from;
  int to;
  Pose2 from_from_to;
  Eigen::Matrix3d information;  // in the frame of `from`
  Path path;
};

// For every pose the differences that lead to it from the pose it hangs on; none for a pose that
// stays.
std::vector<Range> HangUp(const std::vector<RelativePoseConstraint>& edges, int num_poses,
                          const std::vector<int>& fixed) {
  PoseSets sets(num_poses);
  for (const RelativePoseConstraint& edge : edges) sets.Join(edge.from, edge.to);
  std::vector<bool> stays(num_poses, false), held(num_poses, false);
  for (const int pose : fixed) {
    if (pose < num_poses) stays[pose] = held[sets.Find(pose)] = true;
  }
  std::vector<std::vector<int>> members(num_poses);  // of the set, by its name
  for (int pose = 0; pose < num_poses; ++pose) {
    const int set = sets.Find(pose);
    if (!held[set]) stays[pose] = held[set] = true;
    members[set].push_back(pose);
  }
  std::vector<Range> ranges(num_poses);
  int count = 0;
  const auto hang = [&](int pose, int* begin) {
    if (stays[pose]) *begin = count;
    if (!stays[pose]) ranges[pose] = {*begin, ++count};
  };
  for (const std::vector<int>& chain : members) {
    // Backwards from the first pose that stays, then forwards from each.
    auto first = std::find_if(chain.begin(), chain.end(), [&](int pose) { return stays[pose]; });
    int begin = count;
    for (auto it = first; it != chain.begin();) hang(*--it, &begin);
    for (auto it = first; it != chain.end(); ++it) hang(*it, &begin);
  }
  return ranges;
}

Path PathBetween(Range from, Range to) {
  // One of the two is empty, or they hang on different poses, unless they begin alike.
  if (from.begin == to.begin) from.begin = to.begin = std::min(from.end, to.end);
  return {from, to};
}

// Sums over the first differences of what was added to them, in O(log n) for one call: a binary
// indexed tree (Fenwick 1994). Adding in proportion to the differences' weights takes two of them,
// for what grows with the sum of the weights and for what does not.
class ShareSums {
 public:
  // weights: of each difference.
  explicit ShareSums(const std::vector<Array3d>& weights)
      : weight_(weights.size() + 1, Array3d::Zero()), nodes_(weights.size() + 2) {
    for (std::size_t i = 0; i < weights.size(); ++i) weight_[i + 1] = weight_[i] + weights[i];
  }

  Array3d Weight(const Range& range) const { return weight_[range.end] - weight_[range.begin]; }

  // Adds share times its weight to each difference of the range.
  void Add(const Range& range, const Array3d& share) {
    if (range.size() == 0) return;
    AddFrom(range.begin, share);
    AddFrom(range.end, -share);
  }

  Array3d Sum(const Range& range) const { return Prefix(range.end) - Prefix(range.begin); }

 private:
  struct Node {
    Array3d slope = Array3d::Zero();
    Array3d offset = Array3d::Zero();
  };

  void AddFrom(int begin, const Array3d& share) {
    const Array3d offset = share * weight_[begin];
    for (std::size_t i = begin + 1; i < nodes_.size(); i += i & (~i + 1)) {
      nodes_[i].slope += share;
      nodes_[i].offset += offset;
    }
  }

  Array3d Prefix(int end) const {
    Node sum;
    for (std::size_t i = end + 1; i > 0; i &= i - 1) {
      sum.slope += nodes_[i].slope;
      sum.offset += nodes_[i].offset;
    }
    return sum.slope * weight_[end] - sum.offset;
  }

  std::vector<Array3d> weight_;  // of all differences before
  std::vector<Node> nodes_;
};

class Descent {
 public:
  Descent(const std::vector<RelativePoseConstraint>& edges, const std::vector<Pose2>& poses,
          const std::vector<int>& fixed)
      : poses_(poses) {
    std::vector<RelativePoseConstraint> sound;
    std::vector<Eigen::Matrix3d> informations;
    for (const RelativePoseConstraint& edge : edges) {
      Eigen::Matrix3d root;
      if (!SqrtInformation(edge.covariance, &root)) continue;
      sound.push_back(edge);
      informations.emplace_back(root.transpose() * root);
    }
    ranges_ = HangUp(sound, static_cast<int>(poses.size()), fixed);
    for (std::size_t e = 0; e < sound.size(); ++e) {
      const auto& [from, to, motion, covariance] = sound[e];
      const Path path = PathBetween(ranges_[from], ranges_[to]);
      if (path.size() > 0) edges_.push_back({from, to, motion, informations[e], path});
    }
  }

  const std::vector<Pose2>& poses() const { return poses_; }

  // Goes through all edges once; returns the largest step of an edge's end [m], [rad].
  double Iterate(int iteration) {
    Shuffle();
    Array3d gamma;
    ShareSums sums(InverseOfM(&gamma));
    const Array3d rate = 1.0 / (gamma * iteration);
    double largest = 0.0;
    for (const PathEdge& edge : edges_) {
      const Pose2 from = PoseNow(edge.from, sums);
      const Pose2 wanted = from * edge.from_from_to, to = PoseNow(edge.to, sums);
      const Array3d residual(wanted.x - to.x, wanted.y - to.y, NormalizeAngle(wanted.yaw - to.yaw));
      const Array3d gradient = 2.0 * (InWorld(edge, from.yaw) * residual.matrix()).array();
      Array3d step = edge.path.size() * rate * gradient;
      step = (step.abs() > residual.abs()).select(residual, step);
      const Array3d share = step / (sums.Weight(edge.path.plus) + sums.Weight(edge.path.minus));
      sums.Add(edge.path.plus, share);
      sums.Add(edge.path.minus, -share);
      largest = std::max(largest, step.abs().maxCoeff());
    }
    for (std::size_t p = 0; p < poses_.size(); ++p) {
      poses_[p] = PoseNow(static_cast<int>(p), sums);
    }
    return largest;
  }

  bool AllFinite() const { return std::all_of(poses_.begin(), poses_.end(), IsFinite); }

 private:
  // Neighbours in a file often pull the same way. The generator gives the same everywhere, which
  // std::shuffle need not.
  void Shuffle() {
    for (std::size_t e = edges_.size(); e > 1; --e) std::swap(edges_[e - 1], edges_[random_() % e]);
  }

  static Eigen::Matrix3d InWorld(const PathEdge& edge, double yaw) {
    return RotateAxes(edge.information, yaw);
  }

  Pose2 PoseNow(int pose, const ShareSums& sums) const {
    const Array3d moved = sums.Sum(ranges_[pose]);
    const Pose2& before = poses_[pose];
    return {before.x + moved.x(), before.y + moved.y(), before.yaw + moved.z()};
  }

  // Per difference; zero where no edge spans it. gamma: smallest diagonal of an edge's information,
  // which M cannot be below, but for the rounding of what is added and taken away again.
  std::vector<Array3d> InverseOfM(Array3d* gamma) const {
    int num_differences = 0;
    for (const Range& range : ranges_) num_differences = std::max(num_differences, range.end);
    gamma->setConstant(std::numeric_limits<double>::infinity());
    std::vector<Array3d> change(num_differences + 1, Array3d::Zero());  // of M from one to the next
    std::vector<int> spans(num_differences + 1, 0);
    for (const PathEdge& edge : edges_) {
      const Array3d weight = InWorld(edge, poses_[edge.from].yaw).diagonal();
      *gamma = gamma->min(weight);
      for (const Range& range : {edge.path.minus, edge.path.plus}) {
        change[range.begin] += weight;
        change[range.end] -= weight;
        ++spans[range.begin];
        --spans[range.end];
      }
    }
    std::vector<Array3d> inverse(num_differences, Array3d::Zero());
    Array3d m = Array3d::Zero();
    int num_spans = 0;
    for (int i = 0; i < num_differences; ++i) {
      m += change[i];
      num_spans += spans[i];
      if (num_spans > 0) inverse[i] = 1.0 / m.max(*gamma);
    }
    return inverse;
  }

  std::vector<Pose2> poses_;
  std::vector<Range> ranges_;  // per pose
  std::vector<PathEdge> edges_;
  std::mt19937 random_;
};

}  // namespace

PoseGraphResult DescendStochastically(const std::vector<RelativePoseConstraint>& edges,
                                      std::vector<Pose2>* world_from_pose,
                                      const std::vector<int>& fixed,
                                      const DescentCallback& callback) {
  const DefaultFloatEnvironment float_environment;
  Descent descent(edges, *world_from_pose, fixed);
  PoseGraphResult result;
  result.stop_reason = "all iterations done";
  while (result.iterations < kMaxDescentIterations) {
    const double step = descent.Iterate(++result.iterations);
    if (!descent.AllFinite()) {
      result.stop_reason = "the poses have left the range of a double";
      return result;
    }
    if (callback && !callback(result.iterations, descent.poses())) {
      result.stop_reason = "stopped by its caller";
      break;
    }
    if (step <= kStepTolerance) {
      result.converged = true;
      result.stop_reason = "no edge moves its end by more than the tolerance";
      break;
    }
  }
  *world_from_pose = descent.poses();
  return result;
}

}  // namespace plumbline
