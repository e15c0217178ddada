#include "plumbline/apps/benchmark/mapper_edges.h"

#include <Eigen/Core>

namespace plumbline {
namespace {

constexpr double kLeastPathM = 10.0;  // between the two poses of a closure
constexpr double kReachM = 1.5;
constexpr int kAlike = 10;  // neighbouring closures

Pose2 Noise(const Eigen::Vector3d& sigmas, NoiseSource* source) {
  const double x = sigmas.x() * source->Gaussian(), y = sigmas.y() * source->Gaussian();
  return {x, y, sigmas.z() * source->Gaussian()};
}

// What false closures are off by, one after the other.
class Falsehood {
 public:
  Falsehood(FalseClosures kind, double share, NoiseSource* source)
      : is_biased_(kind == FalseClosures::kBiased), share_(share), source_(source) {}

  // Of the next closure; false: it is right.
  bool Next(Pose2* error) {
    *error = Pose2();
    if (!is_biased_) {
      if (source_->Uniform() >= share_) return false;
      *error = Noise({2.0, 2.0, 0.5}, source_);
      return true;
    }
    if (num_left_ == 0 && source_->Uniform() * kAlike * (1.0 - share_) < share_) {
      num_left_ = kAlike;
      const double sign = source_->Uniform() < 0.5 ? -1.0 : 1.0;
      bias_m_ = sign * source_->Uniform(0.1, 0.5);
    }
    if (num_left_ == 0) return false;
    --num_left_;
    error->x = bias_m_;
    return true;
  }

 private:
  const bool is_biased_;
  const double share_;
  NoiseSource* source_;
  int num_left_ = 0;
  double bias_m_ = 0.0;
};

}  // namespace

MapperEdges MakeMapperEdges(const std::vector<Pose2>& truth, FalseClosures kind, double share,
                            NoiseSource* source) {
  const Eigen::Vector3d step_sigmas(0.005, 0.005, 0.002), closure_sigmas(0.02, 0.02, 0.005);
  MapperEdges result;
  const auto add = [&](int from, int to, const Pose2& error, const Eigen::Vector3d& sigmas,
                       bool is_false) {
    const Pose2 motion = Between(truth[from], truth[to]) * error * Noise(sigmas, source);
    result.edges.push_back({from, to, motion, sigmas.cwiseAbs2().asDiagonal()});
    result.is_false.push_back(is_false);
  };
  const int num_poses = static_cast<int>(truth.size());
  const auto distance_m = [&](int a, int b) {
    return (truth[a].translation() - truth[b].translation()).norm();
  };
  std::vector<double> path_m(truth.size());
  for (int to = 1; to < num_poses; ++to) {
    path_m[to] = path_m[to - 1] + distance_m(to - 1, to);
    add(to - 1, to, Pose2(), step_sigmas, false);
  }
  Falsehood falsehood(kind, share, source);
  for (int to = 1; to < num_poses; ++to) {
    int nearest = 0;
    for (int from = 0; path_m[from] + kLeastPathM <= path_m[to]; ++from) {
      if (distance_m(from, to) < distance_m(nearest, to)) nearest = from;
    }
    if (path_m[nearest] + kLeastPathM > path_m[to] || distance_m(nearest, to) > kReachM) continue;
    Pose2 error;
    const bool is_false = falsehood.Next(&error);
    add(nearest, to, error, closure_sigmas, is_false);
  }
  return result;
}

}  // namespace plumbline
