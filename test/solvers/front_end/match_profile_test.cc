#include "plumbline/solvers/front_end/match_profile.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

constexpr double kTurnRad = 0.4;  // of the corridor against the axes of the map

// A corridor of 2 m whose walls step back by `depth_m` for a metre now and then, never twice at the
// same distance.
SyntheticScene CorridorWithNiches(double depth_m) {
  const Pose2 world_from_corridor(0.0, 0.0, kTurnRad);
  SyntheticScene scene;
  const auto add_wall = [&](double side, const std::vector<double>& niches) {
    double from = -50.0;
    const auto add = [&](double xa, double ya, double xb, double yb) {
      scene.faces.push_back({world_from_corridor * Eigen::Vector2d(xa, side * ya),
                             world_from_corridor * Eigen::Vector2d(xb, side * yb)});
    };
    for (const double x : niches) {
      add(from, 1.0, x, 1.0);
      add(x, 1.0, x, 1.0 + depth_m);
      add(x, 1.0 + depth_m, x + 1.0, 1.0 + depth_m);
      add(x + 1.0, 1.0 + depth_m, x + 1.0, 1.0);
      from = x + 1.0;
    }
    add(from, 1.0, 50.0, 1.0);
  };
  add_wall(1.0, {-6.0, -3.2, 1.7, 5.1});
  add_wall(-1.0, {-7.4, -1.1, 3.3, 6.8});
  scene.laser.max_range_m = 8.0;
  scene.range_sigma_m = 0.02;
  return scene;
}

struct Case {
  LocalMap map;
  SurfacePoints scan;
  Pose2 truth;
};

// The map of a few scans, and another scan from amidst them.
Case MakeCase(SyntheticScene scene, unsigned seed) {
  const Pose2 world_from_corridor(0.0, 0.0, kTurnRad);
  for (const double x : {-0.4, 0.0, 0.4, 0.1}) {
    scene.poses.push_back(world_from_corridor * Pose2(x, 0.0, 0.0));
  }
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene, seed));
  Case made{LocalMap(LocalMap::kCellM), surfaces[3], scene.poses[3]};
  made.map.Rebuild(std::vector<const SurfacePoints*>{&surfaces[0], &surfaces[1], &surfaces[2]},
                   {scene.poses[0], scene.poses[1], scene.poses[2]});
  return made;
}

// From this far along the corridor.
ScanMatch MatchFrom(const Case& made, double off_m) {
  PosePrediction start;
  start.world_from_robot = made.truth * Pose2(off_m, 0.0, 0.0);
  ScanMatchOptions options;
  options.coarse_gate_m = 0.3;
  return MatchScan(made.map, made.scan, start, options);
}

double ErrorAlong(const ScanMatch& match, const Pose2& truth) {
  return Between(truth, match.world_from_robot).x;
}

double VarianceAlong(const Eigen::Matrix3d& covariance) {
  const Eigen::Vector2d along(std::cos(kTurnRad), std::sin(kTurnRad));
  return along.dot(covariance.topLeftCorner<2, 2>() * along);
}

TEST(MatchProfile, TellsHowBadlyAPoseAlongACorridorIsKnown) {
  double squares_by_information = 0.0, squares_by_profile = 0.0;
  constexpr int kCases = 40;
  for (int i = 0; i < kCases; ++i) {
    const Case made = MakeCase(CorridorWithNiches(0.05), 1 + i);
    ScanMatch match = MatchFrom(made, i % 2 == 0 ? 0.5 : -0.5);
    const double by_information = VarianceAlong(MatchCovariance(match.information));
    squares_by_information += std::pow(ErrorAlong(match, made.truth), 2) / by_information;
    const Eigen::Matrix3d covariance =
        ProfileMatch(made.map, made.scan, ScanMatchOptions(), &match);
    EXPECT_LT(VarianceAlong(covariance), 0.5 * 0.5);
    squares_by_profile += std::pow(ErrorAlong(match, made.truth), 2) / VarianceAlong(covariance);
  }
  EXPECT_GT(std::sqrt(squares_by_information / kCases), 3.0);
  EXPECT_LT(std::sqrt(squares_by_profile / kCases), 1.0);
}

TEST(MatchProfile, FindsTheBestPlaceAlongACorridor) {
  int num_stuck = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Case made = MakeCase(CorridorWithNiches(0.05), seed);
    ScanMatch match = MatchFrom(made, 0.7);
    if (std::abs(ErrorAlong(match, made.truth)) < 0.3) continue;
    ++num_stuck;
    ProfileMatch(made.map, made.scan, ScanMatchOptions(), &match);
    EXPECT_LT(DistanceM(match.world_from_robot, made.truth), 0.15) << seed;
  }
  EXPECT_GE(num_stuck, 10);
}

// Where a step of the samples leads off the only maximum, the information tells how wide it is.
TEST(MatchProfile, LeavesAMatchInARoomAsItIs) {
  SyntheticScene room = Room();
  room.range_sigma_m = 0.02;
  const Case made = MakeCase(room, 1);
  ScanMatch match = MatchFrom(made, 0.1);
  const ScanMatch before = match;
  const Eigen::Matrix3d covariance = ProfileMatch(made.map, made.scan, ScanMatchOptions(), &match);
  EXPECT_LT(DistanceM(match.world_from_robot, before.world_from_robot), 1e-3);
  EXPECT_NEAR(match.world_from_robot.yaw, before.world_from_robot.yaw, 1e-3);
  EXPECT_TRUE(covariance.isApprox(MatchCovariance(before.information), 0.05));
}

TEST(MatchProfile, LeavesAMatchAlongABareCorridorAsItIs) {
  const Case made = MakeCase(CorridorWithNiches(0.0), 1);
  ScanMatch match = MatchFrom(made, 0.5);
  const ScanMatch before = match;
  const Eigen::Matrix3d covariance = ProfileMatch(made.map, made.scan, ScanMatchOptions(), &match);
  EXPECT_EQ(match.world_from_robot.x, before.world_from_robot.x);
  EXPECT_EQ(match.world_from_robot.y, before.world_from_robot.y);
  EXPECT_GT(VarianceAlong(covariance), 1.0);
}

// What little the information says along such a corridor is mostly taken for noise of the normals.
TEST(MatchProfile, FindsWhatTheInformationLacks) {
  int num_lacking = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Case made = MakeCase(CorridorWithNiches(0.05), seed);
    ScanMatch match = MatchFrom(made, 0.3);
    if (VarianceAlong(MatchCovariance(match.information)) < 1.0) continue;
    ++num_lacking;
    const Eigen::Matrix3d covariance =
        ProfileMatch(made.map, made.scan, ScanMatchOptions(), &match);
    EXPECT_LT(VarianceAlong(covariance), 0.5 * 0.5) << seed;
    EXPECT_LT(DistanceM(match.world_from_robot, made.truth), 0.1) << seed;
    EXPECT_EQ(covariance, covariance.transpose()) << seed;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()(0), 0.0);
  }
  EXPECT_GT(num_lacking, 0);
}

}  // namespace
}  // namespace plumbline
