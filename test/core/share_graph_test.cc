#include "plumbline/core/share_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

using testing::ElementsAre;

// Two lasers in a room, one of whose scans has bearings of its own; the first pose is fixed.
SlamGraph MakeWhole() {
  SyntheticScene scene;
  scene.faces = {{{0.0, 0.0}, {8.0, 0.0}},
                 {{8.0, 0.0}, {8.0, 5.0}},
                 {{8.0, 5.0}, {0.0, 5.0}},
                 {{0.0, 5.0}, {0.0, 0.0}}};
  for (int i = 0; i < 6; ++i) scene.poses.emplace_back(1.0 + i, 2.0 + 0.1 * i, 0.2 * i);
  SlamGraph graph = MakeGraph(scene);
  LaserModel other = PanoramicLaser(90);
  other.robot_from_laser = Pose2(0.2, 0.0, 0.1);
  const int laser = graph.AddLaser(other);
  std::vector<double> ranges(90, 1.5);
  ranges[3] = 0.0;
  graph.AddSweep(1, laser, ranges, Pose2(0.1, 0.02, 0.05));
  for (int pose = 1; pose < graph.num_poses(); ++pose) {
    const Pose2 step = Between(graph.InitialPose(pose - 1), graph.InitialPose(pose));
    graph.AddOdometry({pose - 1, pose, step});
  }
  RelativePoseConstraint edge{0, 4, Pose2(4.0, 0.4, 0.8)};
  edge.covariance(0, 1) = edge.covariance(1, 0) = 0.1;
  graph.AddRelativePose(edge);
  graph.FixPose(2);
  return graph;
}

void ExpectSameScan(const SlamGraph& graph, int scan, const SlamGraph& expected, int of_expected) {
  const ScanEntry &entry = graph.scan(scan), &other = expected.scan(of_expected);
  EXPECT_EQ(entry.pose, other.pose);
  EXPECT_TRUE(graph.LaserOfScan(scan) == expected.LaserOfScan(of_expected));
  ASSERT_EQ(entry.num_returns, other.num_returns);
  EXPECT_EQ(entry.has_own_bearings, other.has_own_bearings);
  for (std::size_t k = 0; k < entry.num_returns; ++k) {
    const std::size_t r = entry.first_return + k, s = other.first_return + k;
    EXPECT_EQ(graph.returns().range_m[r], expected.returns().range_m[s]);
    EXPECT_EQ(graph.Beam(r), expected.Beam(s));
    EXPECT_EQ(graph.ScanOfReturn(r), scan);
    EXPECT_EQ(graph.Bearing(r), expected.Bearing(s));
  }
}

TEST(ShareGraphTest, GivesEveryProcessAllButTheScansOfOthers) {
  const SlamGraph whole = MakeWhole();
  std::vector<std::size_t> num_scans(3);
  RunOnParts(whole, 3, [&](const SlamGraph& part) {
    const int rank = part.peers()->rank();
    num_scans[rank] = part.num_scans();
    EXPECT_EQ(part.initial_poses(), whole.initial_poses());
    EXPECT_EQ(part.timestamp_s(3), whole.timestamp_s(3));
    EXPECT_EQ(part.num_lasers(), 2);
    ASSERT_EQ(part.odometry().size(), whole.odometry().size());
    EXPECT_EQ(part.odometry()[2].from_from_to.x, whole.odometry()[2].from_from_to.x);
    ASSERT_EQ(part.relative_poses().size(), 1u);
    EXPECT_EQ(part.relative_poses()[0].covariance, whole.relative_poses()[0].covariance);
    ASSERT_EQ(part.fixed_poses().size(), 1u);
    EXPECT_EQ(part.fixed_poses()[0].pose, 2);
    EXPECT_EQ(part.num_returns_of_all(), whole.num_returns());
    EXPECT_EQ(part.all_scans().size(), static_cast<std::size_t>(whole.num_scans()));
    for (int scan = 0; scan < part.num_scans(); ++scan) {
      EXPECT_TRUE(part.HasScansOf(part.scan(scan).pose));
      ExpectSameScan(part, scan, whole, part.IdAmongAll(scan));
      const std::size_t first = part.scan(scan).first_return;
      EXPECT_EQ(part.ReturnIdAmongAll(first), whole.scan(part.IdAmongAll(scan)).first_return);
    }
  });
  EXPECT_THAT(num_scans, testing::Each(testing::Ge(2u)));
  EXPECT_EQ(num_scans[0] + num_scans[1] + num_scans[2], 7u);
}

TEST(ShareGraphTest, FailsInAllProcessesOnLasersThatCannotBeToldApart) {
  SlamGraph whole = MakeWhole();
  LaserModel third = PanoramicLaser(90);
  whole.AddLaser(third);
  MeasurementCorrections corrections;
  corrections.robot_from_laser.resize(3);  // where two of them are equal
  whole = whole.Corrected(corrections);
  RunOnPeers(2, [&](const Peers& peers) {
    SlamGraph part;
    if (peers.rank() == 0) part = whole;
    const Status status = ShareGraph(&peers, std::vector<int>(whole.num_poses()), &part);
    EXPECT_EQ(status.message(), "lasers 1 and 2 are equal");
  });
}

TEST(ShareGraphTest, FailsInAllProcessesOnAGraphThatRefusedAMeasurement) {
  SlamGraph whole = MakeWhole();
  whole.AddScan(0, 0, {1.0});
  ASSERT_FALSE(whole.status().ok());
  RunOnPeers(2, [&](const Peers& peers) {
    SlamGraph part;
    if (peers.rank() == 0) part = whole;
    const Status status = ShareGraph(&peers, std::vector<int>(whole.num_poses()), &part);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(status.message(), whole.status().message());
  });
}

TEST(ShareAnewTest, IsAsIfTheGraphHadBeenSharedSoFromTheStart) {
  const SlamGraph whole = MakeWhole();
  RunOnParts(whole, 3, [&](const SlamGraph& part) {
    const std::vector<int> ranks = {2, 0, 1, 0, 2, 2};
    SlamGraph moved = part;
    ThreadPool pool(1);
    MeasuredSurface surface = MeasureSurface(part, ReturnNormalOptions(), &pool);
    ShareAnew(ranks, &moved, &surface);
    const MeasuredSurface anew = MeasureSurface(moved, ReturnNormalOptions(), &pool);
    ASSERT_EQ(surface.normals.size(), anew.normals.size());
    for (std::size_t r = 0; r < surface.normals.size(); ++r) {
      EXPECT_EQ(surface.normals[r].Direction(), anew.normals[r].Direction());
    }
    SlamGraph expected = whole;
    ASSERT_TRUE(ShareGraph(part.peers(), ranks, &expected).ok());
    EXPECT_EQ(moved.rank_of_pose(), ranks);
    EXPECT_EQ(moved.relative_poses().size(), whole.relative_poses().size());
    ASSERT_EQ(moved.num_scans(), expected.num_scans());
    for (int scan = 0; scan < moved.num_scans(); ++scan) {
      EXPECT_EQ(moved.IdAmongAll(scan), expected.IdAmongAll(scan));
      ExpectSameScan(moved, scan, expected, scan);
    }
  });
}

TEST(FetchScansTest, BringsScansOfOtherProcessesInTheOrderAskedFor) {
  const SlamGraph whole = MakeWhole();
  RunOnParts(whole, 3, [&](const SlamGraph& part) {
    const std::vector<int> ids =
        part.peers()->rank() == 1 ? std::vector<int>{6, 0, 5, 2, 0} : std::vector<int>{};
    const SlamGraph fetched = FetchScans(part, ids);
    ASSERT_EQ(fetched.num_scans(), static_cast<int>(ids.size()));
    for (int i = 0; i < fetched.num_scans(); ++i) ExpectSameScan(fetched, i, whole, ids[i]);
  });
}

TEST(OverPeersTest, SumsAndJoinsByRank) {
  RunOnPeers(3, [](const Peers& peers) {
    std::vector<std::uint32_t> counts = {1u, static_cast<std::uint32_t>(peers.rank())};
    SumOverPeers(&peers, &counts);
    EXPECT_THAT(counts, ElementsAre(3u, 3u));
    std::vector<int> own(peers.rank(), 10 * peers.rank());
    EXPECT_THAT(JoinOverPeers(&peers, own), ElementsAre(10, 20, 20));
  });
}

TEST(OverPeersTest, TellsAllOfTheFirstFailure) {
  RunOnPeers(3, [](const Peers& peers) {
    EXPECT_TRUE(FirstFailure(&peers, Status::Ok()).ok());
    const bool fails = peers.rank() > 0;
    const Status status = FirstFailure(
        &peers, fails ? Status::NotFound("no " + std::to_string(peers.rank())) : Status::Ok());
    EXPECT_EQ(status.code(), StatusCode::kNotFound);
    EXPECT_EQ(status.message(), "rank 1: no 1");
    int num_calls = 0;
    const Status spoken = BySpeaker(&peers, [&] {
      ++num_calls;
      return Status::Unavailable("disk full");
    });
    EXPECT_EQ(spoken.message(), "disk full");
    EXPECT_EQ(num_calls, peers.rank() == 0 ? 1 : 0);
  });
}

}  // namespace
}  // namespace plumbline
