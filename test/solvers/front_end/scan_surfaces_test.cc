#include "plumbline/solvers/front_end/scan_surfaces.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

SlamGraph TwoViews() {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  scene.poses = {Pose2(), Pose2(0.3, 0.2, 0.4)};
  return MakeGraph(scene);
}

void ExpectEqual(const PackedSurface& actual, const SurfacePoints& expected) {
  const PackedSurface packed(expected);
  ASSERT_EQ(actual.size(), packed.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    EXPECT_EQ(actual[i].position, packed[i].position);
    EXPECT_EQ(actual[i].normal, packed[i].normal);
  }
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
    ExpectEqual(surfaces.Of(scan), all[scan]);
  }
  const SurfacePoints other{{{1.0, 2.0}, {0.0, -1.0}}};
  surfaces.Keep(1, PackedSurface(other));
  ExpectEqual(surfaces.Kept(1), other);
  ExpectEqual(surfaces.Of(1), other);
  ExpectEqual(surfaces.Of(0), all[0]);
  const std::vector<PackedSurface> kept = std::move(surfaces).TakeKept();
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
  EXPECT_TRUE(surfaces.Of(0).empty());
  EXPECT_EQ(surfaces.scan_of_pose(), (std::vector<int>{-1, 1}));
}

TEST(ScanSurfaces, OfAPartKnowWhatOtherProcessesHave) {
  const SlamGraph whole = TwoViews();
  const std::vector<SurfacePoints> all = SurfacesOf(whole);
  RunOnPeers(2, [&](const Peers& peers) {
    SlamGraph part = whole;
    ASSERT_TRUE(ShareGraph(&peers, {1, 0}, &part).ok());
    const MeasuredSurface measured = SurfaceOf(part);
    const ScanSurfaces surfaces(part, measured);
    EXPECT_EQ(surfaces.scan_of_pose(), (std::vector<int>{0, 1}));
    const int own = 1 - peers.rank(), others = peers.rank();
    ExpectEqual(surfaces.Of(own), all[own]);
    EXPECT_THROW(surfaces.Of(others), std::logic_error);
    // One process asks, all take part.
    std::vector<int> wanted;
    if (peers.rank() == 0) wanted = {own, others};
    ScanSurfaces with = surfaces.With(wanted);
    EXPECT_THROW(surfaces.FreeSpaceOf(others), std::logic_error);
    if (peers.rank() == 0) {
      ExpectEqual(with.Of(others), all[others]);
      const FreeSpaceScan viewer(whole, own), fetched = with.FreeSpaceOf(others);
      const Pose2 apart = Between(whole.InitialPose(own), whole.InitialPose(others));
      EXPECT_EQ(CompareBothWays(viewer, fetched, apart).num_compared,
                CompareBothWays(viewer, FreeSpaceScan(whole, others), apart).num_compared);
      with.Keep(others, PackedSurface(all[others]));
      ExpectEqual(surfaces.Kept(others), all[others]);
    }
  });
}

TEST(ScanSurfaces, ThePosesFirstScanThatShowsASurfaceIsMatched) {
  const SlamGraph views = TwoViews();
  SlamGraph graph = views;
  graph.AddScanOf(views, 0, 1);
  const SurfacePoints none, some{{{1.0, 0.0}, {-1.0, 0.0}}};
  EXPECT_EQ(ScanSurfaces(graph, Packed({some, some, some})).scan_of_pose(),
            (std::vector<int>{0, 1}));
  EXPECT_EQ(ScanSurfaces(graph, Packed({none, none, some})).scan_of_pose(),
            (std::vector<int>{-1, 2}));
}

TEST(ScanSurfaces, ThoseThatAreGivenAreAllThereAre) {
  const SlamGraph graph = TwoViews();
  std::vector<SurfacePoints> all = SurfacesOf(graph);
  all[1].clear();
  const ScanSurfaces surfaces(graph, Packed(all));
  ExpectEqual(PackedSurface(surfaces.Of(0)), all[0]);
  EXPECT_TRUE(surfaces.Of(1).empty());
  EXPECT_EQ(surfaces.scan_of_pose(), (std::vector<int>{0, -1}));
}

}  // namespace
}  // namespace plumbline
