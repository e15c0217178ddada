#include "plumbline/solvers/reduced/patch_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/reduced/patch_sightings.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/test/noisy_room.h"

namespace plumbline {
namespace {

constexpr double kMarginRad = 0.17453292519943295;  // 10 degrees

SurfacePatch PatchFacing(double degrees) {
  SurfacePatch patch;
  patch.normal = {std::cos(DegToRad(degrees)), std::sin(DegToRad(degrees))};
  return patch;
}

double ShapeCost(const SurfacePatch& patch, double degrees) {
  const Eigen::Vector2d normal = PatchFacing(degrees).normal;
  return 0.5 * normal.dot(patch.ShapeTimes(normal));
}

// The terms between two patches that face these directions, seen together by some scans.
std::vector<SurfacePatch> TermsBetween(double first_deg, double second_deg, int num_scans = 1) {
  std::vector<SurfacePatch> patches = {PatchFacing(first_deg), PatchFacing(second_deg)};
  SetShapeTerms({{0, 1, num_scans}}, ShapeOptions(), kMarginRad, &patches);
  return patches;
}

TEST(PatchShapeTest, DrawsToTheNearestMultipleOfARightAngle) {
  for (const double category : {0.0, 90.0, 180.0, 270.0}) {
    const std::vector<SurfacePatch> patches = TermsBetween(20.0, 20.0 + category + 4.0);
    // Cheapest where the two are exactly parallel or orthogonal, each given the other.
    EXPECT_NEAR(ShapeCost(patches[0], 24.0), 0.0, 1e-9) << category;
    EXPECT_NEAR(ShapeCost(patches[1], 20.0 + category), 0.0, 1e-9) << category;
    // And as it is: sine over sigma, squared, with the robust weight of that error.
    const double error = std::sin(DegToRad(4.0)) / ShapeOptions().sigma_rad;
    const double gate = ShapeOptions().robust_gate_sigmas;
    const double weight = std::pow(gate * gate / (gate * gate + error * error), 2);
    EXPECT_NEAR(ShapeCost(patches[0], 20.0), 0.5 * weight * error * error, 1e-9) << category;
  }
}

TEST(PatchShapeTest, LeavesSlantedSurfacesAlone) {
  for (const double angle : {11.0, 45.0, 79.0, 101.0}) {
    const std::vector<SurfacePatch> patches = TermsBetween(0.0, angle);
    for (const SurfacePatch& patch : patches) {
      EXPECT_EQ(patch.shape_xx, 0.0) << angle;
      EXPECT_EQ(patch.shape_xy, 0.0) << angle;
      EXPECT_EQ(patch.shape_yy, 0.0) << angle;
    }
  }
}

TEST(PatchShapeTest, CountsOncePerScanAndNotFromCallToCall) {
  std::vector<SurfacePatch> patches = TermsBetween(0.0, 5.0, 3);
  const double three = ShapeCost(patches[0], 0.0);
  EXPECT_NEAR(three, 3.0 * ShapeCost(TermsBetween(0.0, 5.0)[0], 0.0), 1e-12);
  SetShapeTerms({{0, 1, 3}}, ShapeOptions(), kMarginRad, &patches);
  EXPECT_EQ(ShapeCost(patches[0], 0.0), three);
}

TEST(PatchShapeTest, FindsPatchesThatFollowEachOtherAlongScans) {
  // One pose, one scan of a square room; patches by hand: quarters of the scan, the last returns of
  // each without one.
  SyntheticScene scene;
  scene.faces = {{{-2, -2}, {2, -2}}, {{2, -2}, {2, 2}}, {{2, 2}, {-2, 2}}, {{-2, 2}, {-2, -2}}};
  scene.laser = PanoramicLaser(360);
  scene.poses = {{0, 0, 0}, {0, 0, 0}};
  const SlamGraph graph = MakeGraph(scene);
  SurfacePatches patches;
  for (int scan = 0; scan < 2; ++scan) {
    for (int beam = 0; beam < 360; ++beam) {
      // 90 beams each; a hole of one beam between 0 and 1, of 30 beams between 2 and 3.
      const int patch = beam / 90;
      const bool hole = beam == 90 || (patch == 2 && beam >= 240);
      patches.patch_of_return.push_back(hole ? SurfacePatches::kNone : patch);
    }
  }
  patches.patches.resize(4);
  ThreadPool pool(1);
  const std::vector<AdjacentPatches> adjacent =
      FindAdjacentPatches(graph, SurfaceOf(graph), patches, 0.2, &pool);
  ASSERT_EQ(adjacent.size(), 2u);
  EXPECT_EQ(adjacent[0].first, 0);
  EXPECT_EQ(adjacent[0].second, 1);
  EXPECT_EQ(adjacent[0].num_scans, 2);
  EXPECT_EQ(adjacent[1].first, 1);
  EXPECT_EQ(adjacent[1].second, 2);
}

TEST(PatchShapeTest, AStrongTermTurnsTheLine) {
  // One sighting of a stretch along x, and a neighbour that asks for a direction 5 degrees off.
  PatchSightings sightings;
  sightings.sightings.resize(1);
  sightings.sightings[0].weight = 100.0;
  sightings.sightings[0].xx = 10.0;
  sightings.sightings[0].yy = 0.01;
  sightings.first_of_patch = {0, 1};
  sightings.of_pose = {0};
  sightings.first_of_pose = {0, 1};
  ThreadPool pool(1);
  std::vector<SurfacePatch> patches = {PatchFacing(90.0)};
  const std::vector<PoseFrame> frames(1);
  FitPatchLines(sightings, frames, &pool, &patches);
  EXPECT_NEAR(std::abs(patches[0].normal.y()), 1.0, 1e-9);
  const Eigen::Vector2d tangent(std::cos(DegToRad(5.0)), std::sin(DegToRad(5.0)));
  patches[0].shape_xx = 1e6 * tangent.x() * tangent.x();
  patches[0].shape_xy = 1e6 * tangent.x() * tangent.y();
  patches[0].shape_yy = 1e6 * tangent.y() * tangent.y();
  const double cost = FitPatchLines(sightings, frames, &pool, &patches);
  EXPECT_NEAR(patches[0].normal.dot(tangent), 0.0, 1e-4);
  // What it costs the sighting to be seen aslant.
  EXPECT_NEAR(cost, 0.5 * 10.0 * std::pow(std::sin(DegToRad(5.0)), 2), 0.01);
}

}  // namespace
}  // namespace plumbline
