#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/test/core/synthetic_scene.h"

namespace plumbline {
namespace {

/// A room with a pillar and an inner wall, seen from a few places by a coarse laser: surfaces of
/// very different density.
SyntheticScene Room(double range_sigma_m) {
  SyntheticScene scene;
  scene.faces = {{{-3.0, -2.0}, {4.0, -2.0}},
                 {{4.0, -2.0}, {4.0, 3.0}},
                 {{4.0, 3.0}, {-3.0, 3.0}},
                 {{-3.0, 3.0}, {-3.0, -2.0}},
                 {{1.0, 1.0}, {1.8, 2.2}}};
  scene.discs = {{{-1.5, 1.0}, 0.4}};
  scene.poses = {{0.0, 0.0, 0.1},   {0.7, -0.4, 1.3}, {2.5, 0.0, 2.2}, {-0.5, -1.0, -2.0},
                 {-2.0, -0.5, 0.7}, {0.2, 2.3, -1.0}, {3.0, 2.0, 3.0}};
  scene.laser = PanoramicLaser(180);
  scene.laser.robot_from_laser = Pose2(0.1, -0.05, 0.4);
  scene.range_sigma_m = range_sigma_m;
  return scene;
}

/// The same lines of the initial state from the rule in words, for one point at a time and without
/// an index.
class Oracle {
 public:
  Oracle(const SlamGraph& graph, const std::vector<ReturnNormal>& normals,
         const AssociationOptions& options)
      : graph_(graph), state_(graph.InitialState()), options_(options) {
    nearest_.resize(graph.num_returns());
    for (std::size_t r = 0; r < graph.num_returns(); ++r) {
      const double yaw = graph.InitialPose(graph.scan(graph.ScanOfReturn(r)).pose).yaw;
      normals_.push_back(Eigen::Rotation2Dd(yaw) * normals[r].Direction());
      if (!normals[r].IsNone()) surface_.push_back(r);
    }
    for (const std::size_t r : surface_) {
      nearest_[r] = ByDistance(r);
      typical_radius_m_ += std::log(PilotRadius(r)) / surface_.size();
    }
    typical_radius_m_ = std::exp(typical_radius_m_);
  }

  TangentLine Fit(std::size_t r) const {
    const TangentLine none{0.0, 0.0, 0.0};
    if (normals_[r].isZero()) return none;
    const double typical_number =
        std::sqrt(static_cast<double>(options_.min_points) * options_.max_points);
    const double number = typical_number * typical_radius_m_ / PilotRadius(r);
    std::vector<std::size_t> members;
    bool several_scans = false;
    for (const std::size_t q : nearest_[r]) {
      const double cosine = std::clamp(normals_[q].dot(normals_[r]), -1.0, 1.0);
      if (std::acos(cosine) > kMaxNormalAngleRad) continue;
      const bool enough = static_cast<int>(members.size()) >= options_.min_points &&
                          static_cast<double>(members.size()) >= number;
      if (enough) break;
      members.push_back(q);
      several_scans = several_scans || graph_.ScanOfReturn(q) != graph_.ScanOfReturn(r);
    }
    if (static_cast<int>(members.size()) < options_.min_points || !several_scans) return none;
    return Line(members, r);
  }

 private:
  double Distance(std::size_t q, std::size_t r) const {
    return (MapPoint(state_, q) - MapPoint(state_, r)).norm();
  }

  // The max_points surface points nearest to r. In plain numbers, once for each pair: Eigen in a
  // comparison takes twenty times as long without optimisation.
  std::vector<std::size_t> ByDistance(std::size_t r) const {
    const double* points = state_.points.data();
    const double x = points[2 * r], y = points[2 * r + 1];
    std::vector<std::pair<double, std::size_t>> by_distance;  // squared
    by_distance.reserve(surface_.size());
    for (const std::size_t q : surface_) {
      const double dx = points[2 * q] - x, dy = points[2 * q + 1] - y;
      by_distance.emplace_back(dx * dx + dy * dy, q);
    }
    const std::size_t number = std::min<std::size_t>(surface_.size(), options_.max_points);
    std::partial_sort(by_distance.begin(), by_distance.begin() + number, by_distance.end());
    std::vector<std::size_t> nearest;
    for (std::size_t i = 0; i < number; ++i) nearest.push_back(by_distance[i].second);
    return nearest;
  }

  double PilotRadius(std::size_t r) const { return Distance(nearest_[r].back(), r); }

  TangentLine Line(const std::vector<std::size_t>& members, std::size_t r) const {
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
    for (const std::size_t q : members) centroid += MapPoint(state_, q) / members.size();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const std::size_t q : members) {
      const Eigen::Vector2d offset = MapPoint(state_, q) - centroid;
      covariance += offset * offset.transpose() / members.size();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>().computeDirect(covariance);
    const Eigen::Vector2d eigenvalues = solver.eigenvalues();
    if (eigenvalues[0] > options_.max_eigenvalue_ratio * eigenvalues[1]) return {0.0, 0.0, 0.0};
    Eigen::Vector2d normal = solver.eigenvectors().col(0);
    if (normal.dot(normals_[r]) < 0.0) normal = -normal;
    return {normal.x(), normal.y(), normal.dot(centroid)};
  }

  const SlamGraph& graph_;
  const MapState state_;
  const AssociationOptions& options_;
  std::vector<Eigen::Vector2d> normals_;           // world
  std::vector<std::size_t> surface_;               // returns that have one
  std::vector<std::vector<std::size_t>> nearest_;  // to each of them, itself included
  double typical_radius_m_ = 0.0;
};

// Of the initial state.
TangentLines LinesOf(const SlamGraph& graph, const AssociationOptions& options,
                     int num_threads = 1) {
  ThreadPool pool(num_threads);
  return LinesFromNearest(graph, graph.InitialState(), SurfaceOf(graph).normals, options, &pool);
}

TEST(NearestLinesTest, FollowTheRule) {
  AssociationOptions few;
  few.min_points = 4;
  few.max_points = 12;
  AssociationOptions fixed_number;
  fixed_number.max_points = fixed_number.min_points = 20;
  unsigned seed = 1;
  for (const AssociationOptions& options : {AssociationOptions(), few, fixed_number}) {
    const SlamGraph graph = MakeGraph(Room(0.01), seed++);
    const TangentLines lines = LinesOf(graph, options);
    const Oracle oracle(graph, SurfaceOf(graph).normals, options);
    ASSERT_EQ(lines.size(), graph.num_returns());
    EXPECT_GE(lines.CountReturns(), graph.num_returns() / 3);
    for (std::size_t r = 0; r < lines.size(); ++r) {
      const TangentLine expected = oracle.Fit(r);
      ASSERT_NEAR(lines[r].normal_x, expected.normal_x, 1e-6) << r;
      ASSERT_NEAR(lines[r].normal_y, expected.normal_y, 1e-6) << r;
      ASSERT_NEAR(lines[r].offset, expected.offset, 1e-6) << r;
    }
  }
}

TEST(NearestLinesTest, EveryPointHasOneWithoutNormals) {
  const SlamGraph graph = MakeGraph(Room(0.01), 1);
  AssociationOptions options;
  options.several_poses = false;
  options.max_eigenvalue_ratio = 1.0;
  ThreadPool pool(1);
  const TangentLines lines = LinesFromNearest(graph, graph.InitialState(), {}, options, &pool);
  EXPECT_EQ(lines.CountReturns(), graph.num_returns());
  // With normals the points around corners, which have none, go without.
  EXPECT_LT(LinesOf(graph, options).CountReturns(), graph.num_returns());
}

TEST(NearestLinesTest, LieOnTheWallAndLookAtTheRobot) {
  SyntheticScene scene;
  scene.faces = {{{-2.0, 3.0}, {2.0, 3.0}}};
  scene.poses = {{-0.5, 0.0, 0.3}, {0.0, 0.5, 0.0}, {0.5, 0.0, -0.8}};
  scene.range_sigma_m = 0.002;
  const SlamGraph graph = MakeGraph(scene);
  const MapState state = graph.InitialState();
  const TangentLines lines = LinesOf(graph, AssociationOptions());
  EXPECT_GE(lines.CountReturns(), graph.num_returns() * 9 / 10);
  for (std::size_t r = 0; r < lines.size(); ++r) {
    if (!lines.HasLine(r)) continue;
    EXPECT_LT(lines[r].normal_y, -0.99);
    const double x = MapPoint(state, r).x();
    // Ten points and more: 5 sigma.
    EXPECT_NEAR(lines[r].normal_x * x + lines[r].normal_y * 3.0, lines[r].offset, 0.004);
  }
}

TEST(NearestLinesTest, NeedSeveralScansAndEnoughPoints) {
  SyntheticScene scene = Room(0.0);
  scene.poses.resize(1);
  EXPECT_EQ(LinesOf(MakeGraph(scene), AssociationOptions()).CountReturns(), 0u);
  scene.poses.push_back(scene.poses.front());
  const SlamGraph graph = MakeGraph(scene);
  EXPECT_GT(LinesOf(graph, AssociationOptions()).CountReturns(), 0u);
  AssociationOptions demanding;
  demanding.min_points = demanding.max_points = static_cast<int>(graph.num_returns()) + 1;
  EXPECT_EQ(LinesOf(graph, demanding).CountReturns(), 0u);
}

TEST(NearestLinesTest, AGraphWithoutReturnsHasNone) {
  EXPECT_EQ(LinesOf(SlamGraph(), AssociationOptions()).size(), 0u);
}

TEST(NearestLinesTest, AllThreadCountsAgree) {
  SyntheticScene scene = Room(0.01);
  scene.laser = PanoramicLaser(1440);  // More than one chunk of points.
  const SlamGraph graph = MakeGraph(scene);
  const TangentLines one = LinesOf(graph, AssociationOptions(), 1);
  const TangentLines three = LinesOf(graph, AssociationOptions(), 3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t r = 0; r < one.size(); ++r) {
    ASSERT_EQ(one[r].normal_x, three[r].normal_x);
    ASSERT_EQ(one[r].normal_y, three[r].normal_y);
    ASSERT_EQ(one[r].offset, three[r].offset);
  }
}

}  // namespace
}  // namespace plumbline
