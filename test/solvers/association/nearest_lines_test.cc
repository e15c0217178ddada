#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/held_out_returns.h"
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
  explicit Oracle(const SlamGraph& graph) : state_(graph.InitialState()) {
    for (int s = 0; s < graph.num_scans(); ++s) {
      const ScanEntry& scan = graph.scan(s);
      const std::size_t first = HeldOutReturns::FirstOf(graph, s);
      for (std::size_t k = 0; k < scan.num_returns; ++k) {
        if (!HeldOutReturns::Contain(k, first)) neighbors_.push_back(scan.first_return + k);
      }
    }
    for (std::size_t r = 0; r < graph.num_returns(); ++r) {
      nearest_.push_back(ByDistance(r));
      typical_radius_m_ += std::log(PilotRadius(r)) / static_cast<double>(graph.num_returns());
    }
    typical_radius_m_ = std::exp(typical_radius_m_);
  }

  /// Its normal has either sign.
  TangentLine Fit(std::size_t r) const {
    const double number = std::sqrt(kFewest * kMost) * typical_radius_m_ / PilotRadius(r);
    std::vector<std::size_t> members;
    for (const std::size_t q : nearest_[r]) {
      const auto size = static_cast<double>(members.size());
      if (size >= kFewest && size >= number) break;
      members.push_back(q);
    }
    return Line(members);
  }

 private:
  static constexpr double kFewest = 10.0, kMost = 50.0;  // of the paper

  // The neighbours of r, nearest first. In plain numbers, once for each pair: Eigen in a comparison
  // takes twenty times as long without optimisation.
  std::vector<std::size_t> ByDistance(std::size_t r) const {
    const double* points = state_.points.data();
    const double x = points[2 * r], y = points[2 * r + 1];
    std::vector<std::pair<double, std::size_t>> by_distance;  // squared
    by_distance.reserve(neighbors_.size());
    for (const std::size_t q : neighbors_) {
      const double dx = points[2 * q] - x, dy = points[2 * q + 1] - y;
      by_distance.emplace_back(dx * dx + dy * dy, q);
    }
    const auto number = std::min(neighbors_.size(), static_cast<std::size_t>(kMost));
    std::partial_sort(by_distance.begin(), by_distance.begin() + number, by_distance.end());
    std::vector<std::size_t> nearest;
    for (std::size_t i = 0; i < number; ++i) nearest.push_back(by_distance[i].second);
    return nearest;
  }

  double PilotRadius(std::size_t r) const {
    return (MapPoint(state_, nearest_[r].back()) - MapPoint(state_, r)).norm();
  }

  TangentLine Line(const std::vector<std::size_t>& members) const {
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
    for (const std::size_t q : members) centroid += MapPoint(state_, q) / members.size();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const std::size_t q : members) {
      const Eigen::Vector2d offset = MapPoint(state_, q) - centroid;
      covariance += offset * offset.transpose() / members.size();
    }
    const Eigen::Vector2d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>()
                                       .computeDirect(covariance)
                                       .eigenvectors()
                                       .col(0);
    return {normal.x(), normal.y(), normal.dot(centroid)};
  }

  const MapState state_;
  std::vector<std::size_t> neighbors_;             // all returns but those that are held out
  std::vector<std::vector<std::size_t>> nearest_;  // neighbours of each return
  double typical_radius_m_ = 0.0;
};

// Of the initial state.
TangentLines LinesOf(const SlamGraph& graph, int num_threads = 1) {
  ThreadPool pool(num_threads);
  return LinesFromNearest(graph, graph.InitialState().points, &pool);
}

TEST(NearestLinesTest, FollowTheRule) {
  const SlamGraph graph = MakeGraph(Room(0.01), 1);
  const TangentLines lines = LinesOf(graph);
  const Oracle oracle(graph);
  ASSERT_EQ(lines.size(), graph.num_returns());
  EXPECT_EQ(lines.CountReturns(), graph.num_returns());
  for (std::size_t r = 0; r < lines.size(); ++r) {
    const TangentLine expected = oracle.Fit(r);
    const double cosine =
        lines[r].normal_x * expected.normal_x + lines[r].normal_y * expected.normal_y;
    ASSERT_NEAR(std::abs(cosine), 1.0, 1e-9) << r;
    ASSERT_NEAR(lines[r].offset, std::copysign(1.0, cosine) * expected.offset, 1e-6) << r;
  }
}

TEST(NearestLinesTest, LieOnTheWall) {
  SyntheticScene scene;
  scene.faces = {{{-2.0, 3.0}, {2.0, 3.0}}};
  scene.poses = {{-0.5, 0.0, 0.3}, {0.0, 0.5, 0.0}, {0.5, 0.0, -0.8}};
  scene.range_sigma_m = 0.002;
  const SlamGraph graph = MakeGraph(scene);
  const MapState state = graph.InitialState();
  const TangentLines lines = LinesOf(graph);
  EXPECT_EQ(lines.CountReturns(), graph.num_returns());
  for (std::size_t r = 0; r < lines.size(); ++r) {
    EXPECT_GT(std::abs(lines[r].normal_y), 0.99);
    const double x = MapPoint(state, r).x();
    // Ten points and more: 5 sigma.
    EXPECT_NEAR(lines[r].normal_x * x + lines[r].normal_y * 3.0, lines[r].offset, 0.004);
  }
}

TEST(NearestLinesTest, NeedTenPoints) {
  SyntheticScene scene = Room(0.0);
  scene.poses.resize(1);
  scene.laser = PanoramicLaser(9);
  EXPECT_EQ(LinesOf(MakeGraph(scene)).CountReturns(), 0u);
  scene.laser = PanoramicLaser(36);
  const SlamGraph graph = MakeGraph(scene);
  EXPECT_EQ(LinesOf(graph).CountReturns(), graph.num_returns());
}

TEST(NearestLinesTest, AGraphWithoutReturnsHasNone) { EXPECT_EQ(LinesOf(SlamGraph()).size(), 0u); }

TEST(NearestLinesTest, AllThreadCountsAgree) {
  SyntheticScene scene = Room(0.01);
  scene.laser = PanoramicLaser(1440);  // More than one chunk of points.
  const SlamGraph graph = MakeGraph(scene);
  const TangentLines one = LinesOf(graph, 1);
  const TangentLines three = LinesOf(graph, 3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t r = 0; r < one.size(); ++r) {
    ASSERT_EQ(one[r].normal_x, three[r].normal_x);
    ASSERT_EQ(one[r].normal_y, three[r].normal_y);
    ASSERT_EQ(one[r].offset, three[r].offset);
  }
}

}  // namespace
}  // namespace plumbline
