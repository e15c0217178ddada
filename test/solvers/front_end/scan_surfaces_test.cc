#include "plumbline/solvers/front_end/scan_surfaces.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

SlamGraph TwoViews() {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  scene.poses = {Pose2(), Pose2(0.3, 0.2, 0.4)};
  return MakeGraph(scene);
}

void ExpectEqual(const SurfacePoints& actual, const SurfacePoints& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    EXPECT_EQ(actual[i].position, expected[i].position);
    EXPECT_EQ(actual[i].normal, expected[i].normal);
  }
}

TEST(ScanSurfaces, MakesWhatItDoesNotKeep) {
  const SlamGraph graph = TwoViews();
  const MeasuredSurface measured = SurfaceOf(graph);
  const std::vector<SurfacePoints> all = SurfacesOf(graph);
  ASSERT_GT(all[0].size(), 100u);
  ScanSurfaces surfaces(graph, measured);
  for (const int scan : {0, 1}) {
    EXPECT_TRUE(surfaces.Kept(scan).empty());
    EXPECT_FALSE(surfaces.IsEmpty(scan));
    ExpectEqual(surfaces.Of(scan), all[scan]);
  }
  const SurfacePoints other{{{1.0, 2.0}, {0.0, -1.0}}};
  surfaces.Keep(1, other);
  ExpectEqual(surfaces.Kept(1), other);
  ExpectEqual(surfaces.Of(1), other);
  ExpectEqual(surfaces.Of(0), all[0]);
  const std::vector<SurfacePoints> kept = std::move(surfaces).TakeKept();
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_TRUE(kept[0].empty());
  ExpectEqual(kept[1], other);
  ExpectEqual(ScanSurfaces(graph, measured, kept).Of(1), other);
}

TEST(ScanSurfaces, AScanWithoutNormalsIsEmpty) {
  const SlamGraph graph = TwoViews();
  MeasuredSurface measured = SurfaceOf(graph);
  for (std::size_t r = 0; r < graph.scan(1).first_return; ++r) {
    measured.normals[r] = ReturnNormal();
  }
  const ScanSurfaces surfaces(graph, measured);
  EXPECT_TRUE(surfaces.IsEmpty(0));
  EXPECT_TRUE(surfaces.Of(0).empty());
  EXPECT_EQ(MatchedScanOfPoses(graph, surfaces), (std::vector<int>{-1, 1}));
}

TEST(ScanSurfaces, ThoseThatAreGivenAreAllThereAre) {
  const SlamGraph graph = TwoViews();
  std::vector<SurfacePoints> all = SurfacesOf(graph);
  all[1].clear();
  const ScanSurfaces surfaces(all);
  ExpectEqual(surfaces.Of(0), all[0]);
  EXPECT_TRUE(surfaces.IsEmpty(1));
  EXPECT_EQ(MatchedScanOfPoses(graph, surfaces), (std::vector<int>{0, -1}));
}

}  // namespace
}  // namespace plumbline
