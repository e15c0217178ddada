#include "plumbline/core/joined_returns.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

// Beams 0.01 rad apart, from a laser that is mounted off centre and turned.
SlamGraph GraphOf(const std::vector<double>& ranges, double bearing_step_rad = 0.01) {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = static_cast<int>(ranges.size());
  laser.first_bearing_rad = -0.4;
  laser.bearing_step_rad = bearing_step_rad;
  laser.max_range_m = 10.0;
  laser.robot_from_laser = Pose2(0.3, -0.2, 2.0);
  graph.AddLaser(laser);
  graph.AddPose(Pose2(5.0, 6.0, 1.0), 0.0);
  graph.AddScan(0, 0, ranges);
  return graph;
}

std::vector<bool> JoinedOf(const std::vector<double>& ranges, double bearing_step_rad = 0.01) {
  const SlamGraph graph = GraphOf(ranges, bearing_step_rad);
  std::vector<Eigen::Vector2d> points;
  MeasuredPoints(graph, 0, &points);
  std::vector<bool> joined;
  FindJoinedReturns(graph, 0, points, 0.05, &joined);
  return joined;
}

TEST(JoinedReturns, MeasuredPointsAreTheGraphs) {
  const SlamGraph graph = GraphOf({1.0, 2.0, 10.0, 3.0});
  std::vector<Eigen::Vector2d> points;
  MeasuredPoints(graph, 0, &points);
  ASSERT_EQ(points.size(), 3u);
  for (std::size_t r = 0; r < points.size(); ++r) {
    EXPECT_NEAR((points[r] - graph.PointInRobot(r)).norm(), 0.0, 1e-12);
  }
}

TEST(JoinedReturns, EndAtARangeJump) {
  EXPECT_EQ(JoinedOf({2.0, 2.01, 2.02, 3.0, 3.01}),
            (std::vector<bool>{false, true, true, false, true}));
}

TEST(JoinedReturns, BridgeOneBeamWithoutReturn) {
  EXPECT_EQ(JoinedOf({2.0, 2.0, 10.0, 2.0, 10.0, 10.0, 2.0}),
            (std::vector<bool>{false, true, true, false}));
}

TEST(JoinedReturns, OfADriverThatDropsBeamsAreNeighbours) {
  constexpr double kNone = 10.0;
  // Every third beam, then one of these missing, then two.
  EXPECT_EQ(JoinedOf({2.0,   kNone, kNone, 2.0,   kNone, kNone, 2.0,   kNone, kNone, kNone, kNone,
                      kNone, 2.0,   kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, 2.0}),
            (std::vector<bool>{false, true, true, true, false}));
}

TEST(JoinedReturns, FewReturnsFarApartAreNoNeighbours) {
  constexpr double kNone = 10.0;
  EXPECT_EQ(
      JoinedOf({2.0, kNone, kNone, 2.0, kNone, kNone, kNone, kNone, 2.0, kNone, kNone, kNone, 2.0}),
      (std::vector<bool>{false, false, false, false}));
}

TEST(JoinedReturns, BeamsFarApartSayNothingOfWhatIsBetween) {
  EXPECT_EQ(JoinedOf({2.0, 2.0, 2.0}, 0.25), (std::vector<bool>{false, true, true}));
  EXPECT_EQ(JoinedOf({2.0, 2.0, 2.0}, 0.35), (std::vector<bool>{false, false, false}));
  EXPECT_EQ(JoinedOf({2.0, 2.0, 10.0, 2.0}, 0.2), (std::vector<bool>{false, true, false}));
}

TEST(JoinedReturns, PointsOfOneBeamAreNeighbours) {
  // A far wall seen at twice the density of the model's beams.
  SlamGraph graph = GraphOf(std::vector<double>(5, 10.0));
  const Pose2 robot_from_laser = graph.laser(0).robot_from_laser;
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 8; ++i) {
    points.push_back(robot_from_laser * BeamEnd(9.0 + 0.05 * (i % 2), -0.4 + 0.005 * i));
  }
  graph.AddPoints(0, 0, points);
  MeasuredPoints(graph, 1, &points);
  std::vector<bool> joined;
  FindJoinedReturns(graph, 1, points, 0.05, &joined);
  EXPECT_EQ(joined, (std::vector<bool>{false, true, true, true, true, true, true, true}));
}

TEST(JoinedReturns, TakeWhatIsWithinReachForNoise) {
  EXPECT_EQ(JoinedOf({0.2, 0.245}), (std::vector<bool>{false, true}));
  EXPECT_EQ(JoinedOf({0.2, 0.255}), (std::vector<bool>{false, false}));
}

}  // namespace
}  // namespace plumbline
