#include "plumbline/solvers/incremental/edges_by_pose.h"

namespace plumbline {

void EdgesByPose::Extend(const SlamGraph& graph, const FactorOptions& factors) {
  motions_of_pose_.resize(graph.num_poses());
  relative_poses_of_pose_.resize(graph.num_poses());
  factors_of_pose_.resize(graph.num_poses());
  for (std::size_t i = motions_.size(); i < graph.odometry().size(); ++i) {
    motions_.push_back(MotionEdge(graph.odometry()[i], factors.motion));
    motions_of_pose_[motions_.back().from].push_back(i);
    motions_of_pose_[motions_.back().to].push_back(i);
  }
  for (std::size_t i = relative_poses_.size(); i < graph.relative_poses().size(); ++i) {
    relative_poses_.push_back(RelativePoseEdge(graph.relative_poses()[i]));
    relative_poses_of_pose_[relative_poses_.back().from].push_back(i);
    relative_poses_of_pose_[relative_poses_.back().to].push_back(i);
  }
  for (std::size_t i = factors_.size(); i < graph.factors().size(); ++i) {
    factors_.push_back(graph.factors()[i]);
    for (const int pose : factors_.back().poses) factors_of_pose_[pose].push_back(i);
  }
}

void EdgesByPose::Ignore(const SlamGraph& graph, const std::vector<std::size_t>& ignored) {
  for (const std::size_t i : ignored_) {
    relative_poses_[i] = RelativePoseEdge(graph.relative_poses()[i]);
  }
  for (const std::size_t i : ignored) {
    relative_poses_[i].residual.sqrt_information /= kIgnoredSigmaFactor;
  }
  ignored_ = ignored;
}

}  // namespace plumbline
