#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/test/core/synthetic_scene.h"

namespace plumbline {
namespace {

constexpr double kRadius = 0.3;
constexpr double kSigma = 0.01;

TangentLines LinesOf(const SlamGraph& graph, const std::vector<double>& poses,
                     int num_threads = 1) {
  ThreadPool pool(num_threads);
  return LinesFromRadius(graph, poses, SurfaceOf(graph), AssociationOptions(), kRadius, &pool);
}

TangentLines LinesOf(const SlamGraph& graph, int num_threads = 1) {
  return LinesOf(graph, graph.initial_poses(), num_threads);
}

double Height(const TangentLine& line, const Eigen::Vector2d& point) {
  return line.normal_x * point.x() + line.normal_y * point.y() - line.offset;
}

/// Angle [rad] between a line's normal and a direction, whatever their signs.
double Tilt(const TangentLine& line, const Eigen::Vector2d& normal) {
  return std::asin(std::abs(line.normal_x * normal.y() - line.normal_y * normal.x()));
}

SyntheticScene NoisyScene(const std::vector<Face>& faces, const std::vector<Pose2>& poses) {
  SyntheticScene scene;
  scene.faces = faces;
  scene.poses = poses;
  scene.range_sigma_m = kSigma;
  return scene;
}

const std::vector<Pose2> kPoses = {{-0.3, 0.0, 0.2}, {0.0, 0.1, 1.0},   {0.2, -0.2, -2.0},
                                   {0.4, 0.2, 3.0},  {-0.1, -0.3, 0.0}, {0.1, 0.3, -0.7}};

TEST(RadiusLinesTest, AWallIsFoundBetterThanASinglePoint) {
  const SlamGraph graph = MakeGraph(NoisyScene({{{-2.0, 1.5}, {2.0, 1.5}}}, kPoses));
  const MapState state = graph.InitialState();
  const TangentLines lines = LinesOf(graph);
  EXPECT_GE(lines.CountReturns(), graph.num_returns() * 95 / 100);
  for (std::size_t r = 0; r < lines.size(); ++r) {
    if (!lines.HasLine(r)) continue;
    // Beams are at most 1.5 m x 0.5 deg / cos^2(53 deg) = 3.6 cm apart, so six scans put at least
    // n = 100 points on 0.6 m, and n = 50 where the wall ends. Offset good to sigma / sqrt(n) at
    // the centroid, direction to sigma / sqrt(n) / (0.6 m / sqrt(12)); half that length at the
    // ends.
    const double x = MapPoint(state, r).x();
    const bool inside = std::abs(x) < 1.7;
    const double sigma = kSigma / std::sqrt(inside ? 100.0 : 50.0);
    const double half_deviation = inside ? 0.173 : 0.087;
    const double reach = inside ? 0.11 : 0.2;  // from the centroid
    EXPECT_LE(Tilt(lines[r], {0.0, 1.0}), 5.0 * sigma / half_deviation) << x;
    EXPECT_LE(std::abs(Height(lines[r], {x, 1.5})),
              5.0 * sigma * std::hypot(1.0, reach / half_deviation))
        << x;
  }
}

TEST(RadiusLinesTest, TheSidesOfACornerStayApart) {
  const SlamGraph graph =
      MakeGraph(NoisyScene({{{2.0, -1.0}, {2.0, 2.0}}, {{2.0, 2.0}, {-1.0, 2.0}}}, kPoses));
  const MapState state = graph.InitialState();
  const TangentLines lines = LinesOf(graph);
  EXPECT_GE(lines.CountReturns(), graph.num_returns() * 9 / 10);
  for (std::size_t r = 0; r < lines.size(); ++r) {
    const Eigen::Vector2d point = MapPoint(state, r);
    // Within the noise of the corner itself a point may belong to either side.
    const double to_corner_m = (Eigen::Vector2d(2.0, 2.0) - point).norm();
    if (!lines.HasLine(r) || to_corner_m < 4.0 * kSigma) continue;
    const bool on_top = point.y() - point.x() > 0.0;
    const Eigen::Vector2d normal = on_top ? Eigen::Vector2d::UnitY() : Eigen::Vector2d::UnitX();
    const Eigen::Vector2d foot =
        on_top ? Eigen::Vector2d(point.x(), 2.0) : Eigen::Vector2d(2.0, point.y());
    EXPECT_LE(Tilt(lines[r], normal), DegToRad(3.0)) << point.transpose();
    EXPECT_LE(std::abs(Height(lines[r], foot)), 0.008) << point.transpose();
  }
}

TEST(RadiusLinesTest, TheTwoFacesOfAThinWallStayApart) {
  for (const double thickness_m : {0.05, 0.1}) {
    const double upper = 0.5 * thickness_m;
    std::vector<Pose2> poses;
    for (const Pose2& pose : kPoses) {
      poses.push_back({pose.x, pose.y + 1.5, pose.yaw});
      poses.push_back({pose.x, pose.y - 1.5, pose.yaw});
    }
    const SlamGraph graph = MakeGraph(
        NoisyScene({{{-1.5, upper}, {1.5, upper}}, {{-1.5, -upper}, {1.5, -upper}}}, poses));
    const MapState state = graph.InitialState();
    const TangentLines lines = LinesOf(graph);
    EXPECT_GE(lines.CountReturns(), graph.num_returns() * 95 / 100);
    for (std::size_t r = 0; r < lines.size(); ++r) {
      if (!lines.HasLine(r)) continue;
      const bool from_above = graph.InitialPose(graph.ScanOfReturn(r)).y > 0.0;
      const Eigen::Vector2d foot(MapPoint(state, r).x(), from_above ? upper : -upper);
      EXPECT_LE(std::abs(Height(lines[r], foot)), 0.01) << foot.transpose();
    }
  }
}

TEST(RadiusLinesTest, ADiscIsFollowedAlongItsTangents) {
  SyntheticScene scene = NoisyScene({}, {});
  scene.discs = {{{0.3, -0.2}, 1.0}};
  for (int i = 0; i < 12; ++i) {
    const double angle = i * kPi / 6.0;
    scene.poses.push_back({0.3 + 2.5 * std::cos(angle), -0.2 + 2.5 * std::sin(angle), angle});
  }
  const SlamGraph graph = MakeGraph(scene);
  const MapState state = graph.InitialState();
  const TangentLines lines = LinesOf(graph);
  EXPECT_GE(lines.CountReturns(), graph.num_returns() * 9 / 10);
  for (std::size_t r = 0; r < lines.size(); ++r) {
    if (!lines.HasLine(r)) continue;
    const Eigen::Vector2d radial = (MapPoint(state, r) - scene.discs[0].center).normalized();
    // The points of a cell share a line, as do those of the disc of cells around it: a cell's half
    // diagonal of 0.11 m turns the tangent by 0.11 rad, and the same again if the disc is filled
    // unevenly.
    EXPECT_LE(Tilt(lines[r], radial), 0.22);
    // An arc of +-0.375 m bulges by 7 cm from its ends to its crown.
    EXPECT_LE(std::abs(Height(lines[r], scene.discs[0].center + radial)), 0.07);
  }
}

TEST(RadiusLinesTest, ClutterHasNone) {
  // Foliage: every beam ends somewhere in a ring of half a metre.
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(1.5, 2.0);
  SlamGraph graph;
  const int laser = graph.AddLaser(PanoramicLaser(720));
  for (const Pose2& world_from_robot : kPoses) {
    const int pose = graph.AddPose(world_from_robot, 0.0);
    std::vector<double> ranges(720);
    for (double& range : ranges) range = uniform(engine);
    graph.AddScan(pose, laser, ranges);
  }
  // One in ten has a normal by chance, and few of those meet others that draw a line with them.
  EXPECT_LE(LinesOf(graph).CountReturns(), graph.num_returns() / 50);
}

TEST(RadiusLinesTest, ASingleScanHasNone) {
  SyntheticScene scene = NoisyScene({{{-2.0, 1.5}, {2.0, 1.5}}}, {{0.0, 0.0, 0.0}});
  const SlamGraph single = MakeGraph(scene);
  EXPECT_EQ(LinesOf(single).CountReturns(), 0u);
  AssociationOptions of_one_pose;
  of_one_pose.several_poses = false;
  ThreadPool pool(1);
  EXPECT_GT(LinesFromRadius(single, single.initial_poses(), SurfaceOf(single), of_one_pose, kRadius,
                            &pool)
                .CountReturns(),
            0u);
  scene.poses.push_back({0.0, 0.0, 0.0});
  EXPECT_GT(LinesOf(MakeGraph(scene)).CountReturns(), 0u);
}

TEST(RadiusLinesTest, TheRadiusGrowsOnSparseSurface) {
  // Beams 1 deg and 0.26 m apart: two scans put 4 to 6 points on the 0.6 to 0.75 m of the radius
  // itself, and 10 on the 1.2 to 1.5 m of twice the radius or those of four times.
  SyntheticScene scene =
      NoisyScene({{{15.0, -3.0}, {15.0, 3.0}}}, {{0.0, 0.0, 0.0}, {0.1, 0.1, 0.0}});
  scene.laser = PanoramicLaser(360);
  const SlamGraph graph = MakeGraph(scene);
  const MapState state = graph.InitialState();
  const TangentLines lines = LinesOf(graph);
  EXPECT_GE(lines.CountReturns(), graph.num_returns() * 9 / 10);
  for (std::size_t r = 0; r < lines.size(); ++r) {
    if (!lines.HasLine(r)) continue;
    EXPECT_LE(std::abs(Height(lines[r], {15.0, MapPoint(state, r).y()})), 0.02);
  }
  // One more factor of four is out of reach.
  scene.faces = {{{60.0, -12.0}, {60.0, 12.0}}};
  EXPECT_EQ(LinesOf(MakeGraph(scene)).CountReturns(), 0u);
}

/// A room seen from within, as wide as it takes to fall on many cells.
SyntheticScene Room() {
  return NoisyScene({{{-2.0, -1.5}, {2.5, -1.5}},
                     {{2.5, -1.5}, {2.5, 2.0}},
                     {{2.5, 2.0}, {-2.0, 2.0}},
                     {{-2.0, 2.0}, {-2.0, -1.5}}},
                    kPoses);
}

TEST(RadiusLinesTest, TheyMoveAlongWithTheWorld) {
  const SlamGraph graph = MakeGraph(Room());
  const MapState state = graph.InitialState();
  const TangentLines lines = LinesOf(graph);
  const Pose2 new_from_old(13.7, -4.9, 0.6);
  const Eigen::Rotation2Dd turn(new_from_old.yaw);
  MapState moved = state;
  for (int p = 0; p < graph.num_poses(); ++p) {
    moved.SetPose(p, new_from_old * state.WorldFromRobot(p));
  }
  moved.points = graph.MeasuredMap(moved.poses);
  const TangentLines moved_lines = LinesOf(graph, moved.poses);
  int compared = 0;
  for (std::size_t r = 0; r < lines.size(); ++r) {
    if (!lines.HasLine(r) || !moved_lines.HasLine(r)) continue;
    ++compared;
    const Eigen::Vector2d normal = turn * Eigen::Vector2d(lines[r].normal_x, lines[r].normal_y);
    // The cells fall elsewhere, so other points of the same wall make the line.
    EXPECT_LE(Tilt(moved_lines[r], normal), DegToRad(4.0));
    EXPECT_NEAR(std::abs(Height(moved_lines[r], MapPoint(moved, r))),
                std::abs(Height(lines[r], MapPoint(state, r))), 0.01);
  }
  EXPECT_GE(compared, static_cast<int>(lines.size()) * 9 / 10);
}

TEST(RadiusLinesTest, AllThreadCountsAgree) {
  SyntheticScene scene = Room();
  scene.laser = PanoramicLaser(180);
  for (int i = 0; i < 140; ++i) scene.poses.push_back({0.005 * i, -0.003 * i, 0.1 * i});
  const SlamGraph graph = MakeGraph(scene);
  const TangentLines one = LinesOf(graph, 1), three = LinesOf(graph, 3);
  ASSERT_EQ(one.size(), three.size());
  EXPECT_GT(one.CountReturns(), one.size() / 2);
  for (std::size_t r = 0; r < one.size(); ++r) {
    ASSERT_EQ(one[r].normal_x, three[r].normal_x);
    ASSERT_EQ(one[r].normal_y, three[r].normal_y);
    ASSERT_EQ(one[r].offset, three[r].offset);
  }
}

TEST(RadiusLinesTest, AGraphWithoutReturnsHasNone) { EXPECT_EQ(LinesOf(SlamGraph()).size(), 0u); }

}  // namespace
}  // namespace plumbline
