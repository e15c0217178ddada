#include "plumbline/apps/saved_maps/cartographer_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/map_state.h"
#include "plumbline/test/apps/saved_maps/pbstream_testing.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CartographerGraphTest : public testing::Test {
 protected:
  Status Build(const PbState& given) {
    const Status read = ParseCartographerState(path_, PbFile(PbMessages(given)), &state_);
    EXPECT_TRUE(read.ok()) << read.message();
    return BuildGraph(state_, path_, &graph_, &notes_);
  }
  // A trajectory of its own that was loaded frozen, far away.
  static void AddFrozenTrajectory(PbState* state) {
    PbNode node = state->nodes[0];
    node.trajectory = 7;
    node.map_from_level.x += 10.0;
    state->nodes.push_back(node);
    state->submaps.push_back({7, 0, {10.0, 0.0, 0.0}});
  }
  std::vector<int> FixedPoses() const {
    std::vector<int> ids;
    for (const FixedPose& fixed : graph_.fixed_poses()) ids.push_back(fixed.pose);
    return ids;
  }
  double SigmaM(int edge) const {
    return std::sqrt(graph_.relative_poses()[edge].covariance(0, 0));
  }

  const std::string path_ = "a.pbstream";
  CartographerState state_;
  SlamGraph graph_;
  CartographerGraphNotes notes_;
};

TEST_F(CartographerGraphTest, NodesAndSubmapsBecomePosesAndMatchesEdges) {
  const PbState given = SmallPbState();
  const Status status = Build(given);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(graph_.num_poses(), 5);
  EXPECT_EQ(graph_.num_scans(), 3);
  EXPECT_NEAR(graph_.InitialPose(1).x, 0.5, 1e-15);
  EXPECT_NEAR(graph_.InitialPose(1).yaw, 0.3 - 0.3, 1e-15);
  EXPECT_NEAR(graph_.timestamp_s(1), 1621887394.0668822, 1e-6);
  EXPECT_NEAR(graph_.InitialPose(4).yaw, -0.2, 1e-15);
  EXPECT_EQ(graph_.timestamp_s(4), graph_.timestamp_s(2));
  ASSERT_EQ(graph_.relative_poses().size(), 4u);
  const std::vector<Pose2> poses = PosesOf(graph_.initial_poses());
  for (const RelativePoseConstraint& edge : graph_.relative_poses()) {
    const Pose2 expected = Between(poses[edge.from], poses[edge.to]);
    EXPECT_NEAR(edge.from_from_to.x, expected.x, 1e-14);
    EXPECT_NEAR(edge.from_from_to.y, expected.y, 1e-14);
    EXPECT_NEAR(NormalizeAngle(edge.from_from_to.yaw - expected.yaw), 0.0, 1e-14);
  }
  EXPECT_EQ(graph_.relative_poses()[3].from, 4);
  EXPECT_EQ(graph_.relative_poses()[3].to, 2);
  EXPECT_THAT(FixedPoses(), ElementsAre(3));  // the first submap
  EXPECT_THAT(notes_.frozen_trajectories, IsEmpty());
}

// In the world by their level frame, as Cartographer places them. Rounding to the raster of 1 mm is
// all that is lost, and that was lost before.
TEST_F(CartographerGraphTest, PointsStayWhereTheyAre) {
  PbState given = SmallPbState();
  std::vector<Eigen::Vector2d>& points = given.nodes[1].points_in_level;
  points.clear();
  for (int i = 0; i < 500; ++i) {
    const double angle = 0.0123 * i - 3.1, range_m = 0.3 + 0.0271 * i;
    points.emplace_back(range_m * std::cos(angle), range_m * std::sin(angle));
  }
  given.nodes[1].level_from_tracking =
      Turn(2.0) * Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitX());
  ASSERT_TRUE(Build(given).ok());
  const std::vector<double> map = graph_.InitialState().points;
  const ScanEntry& scan = graph_.scan(1);
  ASSERT_EQ(scan.num_returns, points.size());
  double raster_mm = 0.0, kept_mm = 0.0;
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d rounded = (1e3 * point).array().round() / 1e3;
    const Eigen::Vector2d expected = given.nodes[1].map_from_level * point;
    const Eigen::Vector2d on_raster = given.nodes[1].map_from_level * rounded;
    double to_expected = 1e9, to_raster = 1e9;
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const Eigen::Vector2d in_map(map[2 * r], map[2 * r + 1]);
      to_expected = std::min(to_expected, 1e3 * (in_map - expected).norm());
      to_raster = std::min(to_raster, 1e3 * (in_map - on_raster).norm());
    }
    raster_mm = std::max(raster_mm, to_expected);
    kept_mm = std::max(kept_mm, to_raster);
  }
  EXPECT_LT(raster_mm, std::sqrt(0.5) + 1e-6);
  EXPECT_LT(kept_mm, 1e-3);
}

TEST_F(CartographerGraphTest, BeamsAreAsFarApartAsMostPoints) {
  PbState given = SmallPbState();
  for (PbNode& node : given.nodes) {
    node.points_in_level.clear();
    for (int beam = 0; beam < 180; ++beam) {
      if (beam % 7 == 3) continue;  // no return
      const double angle = DegToRad(2.0 * beam + 0.5);
      node.points_in_level.emplace_back(30.0 * std::cos(angle), 30.0 * std::sin(angle));
    }
  }
  ASSERT_TRUE(Build(given).ok());
  EXPECT_EQ(graph_.laser(0).num_beams, 180);
  EXPECT_GT(graph_.laser(0).max_range_m, 30.0);
  EXPECT_LT(graph_.laser(0).max_range_m, 30.01);
  const std::size_t first = graph_.scan(1).first_return;
  const std::vector<int> beams = graph_.Beams();
  for (std::size_t k = 1; k < graph_.scan(1).num_returns; ++k) {
    EXPECT_GE(beams[first + k] - beams[first + k - 1], 1);
    EXPECT_LE(beams[first + k] - beams[first + k - 1], 2);
  }
  EXPECT_EQ(graph_.num_returns(), 3u * given.nodes[0].points_in_level.size());
}

TEST_F(CartographerGraphTest, ANodeWithoutPointsHasNoScan) {
  PbState given = SmallPbState();
  given.nodes[0].points_in_level.clear();
  ASSERT_TRUE(Build(given).ok());
  EXPECT_EQ(graph_.num_scans(), 2);
  EXPECT_EQ(graph_.scan(0).pose, 1);
  for (PbNode& node : given.nodes) node.points_in_level.clear();
  ASSERT_TRUE(Build(given).ok());
  EXPECT_EQ(graph_.num_scans(), 0);
}

TEST_F(CartographerGraphTest, SigmasAreThoseOfACellOrOfWhatMatchesAreOff) {
  PbState given = SmallPbState();
  ASSERT_TRUE(Build(given).ok());
  EXPECT_NEAR(notes_.sigma_m, 0.05 / std::sqrt(12.0), 1e-12);
  // Half of the points are at 2.3 m or nearer.
  EXPECT_NEAR(notes_.sigma_rad, notes_.sigma_m / std::hypot(2.0, 1.125), 1e-9);
  EXPECT_EQ(notes_.num_contradicted, 0);
  for (PbConstraint& constraint : given.constraints) {
    constraint.submap_from_level = constraint.submap_from_level * Pose2(0.1, -0.1, 0.2);
  }
  ASSERT_TRUE(Build(given).ok());
  EXPECT_EQ(notes_.num_contradicted, 0);
  EXPECT_GT(notes_.sigma_m, 0.05);
  EXPECT_LT(notes_.sigma_m, 0.2);
  EXPECT_NEAR(notes_.sigma_rad, 1.4826 * 0.2, 1e-6);
}

TEST_F(CartographerGraphTest, WrongMatchesCountForLess) {
  PbState given = SmallPbState();
  given.constraints[3].submap_from_level = given.constraints[3].submap_from_level * Pose2(3, 4, 0);
  ASSERT_TRUE(Build(given).ok());
  EXPECT_EQ(notes_.num_contradicted, 1);
  EXPECT_NEAR(SigmaM(0), notes_.sigma_m, 1e-12);
  EXPECT_NEAR(SigmaM(3), 5.0 / 3.0, 1e-9);
}

// Cartographer leaves out the constraints of a submap that is not finished, and keeps its nodes.
TEST_F(CartographerGraphTest, LooseNodesAreTiedByTheLocalSlam) {
  PbState given = SmallPbState();
  given.nodes[1].local_from_level.x += 0.0625;
  given.constraints.erase(given.constraints.begin() + 1);
  ASSERT_TRUE(Build(given).ok());
  ASSERT_EQ(graph_.relative_poses().size(), 5u);
  const RelativePoseConstraint &to = graph_.relative_poses()[3], &from = graph_.relative_poses()[4];
  EXPECT_EQ(to.from, 0);
  EXPECT_EQ(to.to, 1);
  EXPECT_EQ(from.from, 1);
  EXPECT_EQ(from.to, 2);
  // The tracking frame is turned by -0.4 at node 0.
  EXPECT_NEAR(to.from_from_to.x, 0.5625 * std::cos(0.4), 1e-12);
  EXPECT_NEAR(to.from_from_to.y, 0.5625 * std::sin(0.4), 1e-12);
}

TEST_F(CartographerGraphTest, FrozenTrajectoriesStay) {
  PbState given = SmallPbState();
  AddFrozenTrajectory(&given);
  PbState connected = given;
  connected.constraints.push_back({2, 0, {-10.0, 0.125, 0.0}, false});
  const Status status = Build(connected);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_THAT(notes_.frozen_trajectories, ElementsAre(7));
  EXPECT_THAT(FixedPoses(), ElementsAre(3, 6));  // its node, its submap
  EXPECT_THAT(Build(given).message(),
              HasSubstr(path_ + ": no constraints connect node 0 of trajectory 0 with the "
                                "trajectories that were loaded frozen"));
}

TEST_F(CartographerGraphTest, WhatIsNotConnectedIsRefused) {
  PbState given = SmallPbState();
  AddFrozenTrajectory(&given);
  given.constraints.push_back({2, 3, {0.0, 0.0, 0.0}, true});  // moves by itself
  EXPECT_THAT(Build(given).message(), HasSubstr(path_ + ": no constraints connect node 0 of "
                                                        "trajectory 7 with the first submap"));
  given = SmallPbState();
  given.constraints.clear();
  EXPECT_THAT(Build(given).message(),
              HasSubstr(path_ + ": there are no constraints within submaps"));
}

TEST_F(CartographerGraphTest, NumbersBeyondLimitsAreRefused) {
  PbState given = SmallPbState();
  given.nodes[1].time_ticks = std::int64_t{1} << 62;
  EXPECT_TRUE(Build(given).ok());  // the year 14,600
  CartographerState state = state_;
  state.nodes[1].time_s = 1e13;
  EXPECT_THAT(BuildGraph(state, path_, &graph_, &notes_).message(),
              HasSubstr(path_ + ": pose 1: coordinates or time"));
}

}  // namespace
}  // namespace plumbline
