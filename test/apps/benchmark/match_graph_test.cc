#include "plumbline/apps/benchmark/match_graph.h"

#include <gtest/gtest.h>

#include "plumbline/apps/benchmark/synthetic_drive.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/return_normals.h"

namespace plumbline {
namespace {

class MatchGraphTest : public testing::Test {
 protected:
  MatchGraphTest() {
    EXPECT_TRUE(MakeSyntheticDrive(2, {"", 0.01, 0.002, 1.0}, &drive_).ok());
    ThreadPool pool(1);
    const MeasuredSurface surface = MeasureSurface(drive_.graph, ReturnNormalOptions(), &pool);
    for (int scan = 0; scan < drive_.graph.num_scans(); ++scan) {
      surfaces_.push_back(ThinnedSurfaceOf(drive_.graph, scan, surface, 0.03));
    }
  }

  SyntheticDrive drive_;
  std::vector<SurfacePoints> surfaces_;
};

TEST_F(MatchGraphTest, ChainsConsecutiveScansAndClosesTheLoop) {
  const MatchGraph matches =
      BuildMatchGraph(drive_.graph, surfaces_, MotionOptions(), MatchGraphOptions());
  ASSERT_EQ(matches.chain.size(), 16u);
  ASSERT_GT(matches.edges.size(), 20u);
  bool closes_the_loop = false;
  for (std::size_t i = 0; i < matches.edges.size(); ++i) {
    const RelativePoseConstraint& edge = matches.edges[i];
    if (i < 15) {
      EXPECT_EQ(edge.from, static_cast<int>(i));
      EXPECT_EQ(edge.to, edge.from + 1);
    }
    closes_the_loop = closes_the_loop || edge.to - edge.from > 8;
    const Pose2 off = Between(Between(drive_.truth.poses[edge.from], drive_.truth.poses[edge.to]),
                              edge.from_from_to);
    EXPECT_LT(off.translation().norm(), 0.1) << edge.from << " to " << edge.to;
    EXPECT_LT(std::abs(off.yaw), 0.03) << edge.from << " to " << edge.to;
  }
  EXPECT_TRUE(closes_the_loop);
}

TEST_F(MatchGraphTest, WithoutSurfacesTheOdometryStands) {
  for (SurfacePoints& surface : surfaces_) surface.clear();
  const MatchGraph matches =
      BuildMatchGraph(drive_.graph, surfaces_, MotionOptions(), MatchGraphOptions());
  EXPECT_EQ(matches.edges.size(), 15u);
  for (int i = 0; i < 16; ++i) {
    EXPECT_NEAR(matches.chain[i].x, drive_.graph.InitialPose(i).x, 1e-9);
    EXPECT_NEAR(matches.chain[i].y, drive_.graph.InitialPose(i).y, 1e-9);
  }
}

}  // namespace
}  // namespace plumbline
