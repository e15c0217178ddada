#include "plumbline/core/slam_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Beams to the right, ahead and to the left of a laser that sits 0.5 m ahead of its robot.
LaserModel ThreeBeamLaser() {
  LaserModel laser;
  laser.num_beams = 3;
  laser.first_bearing_rad = -0.5 * kPi;
  laser.bearing_step_rad = 0.5 * kPi;
  laser.max_range_m = 10.0;
  laser.robot_from_laser = Pose2(0.5, 0.0, 0.0);
  return laser;
}

// Two poses: the first looks along y, the second along -x.
class SlamGraphTest : public testing::Test {
 protected:
  void SetUp() override {
    laser_ = graph_.AddLaser(ThreeBeamLaser());
    first_ = graph_.AddPose(Pose2(1.0, 2.0, 0.5 * kPi), 10.0);
    second_ = graph_.AddPose(Pose2(1.0, 5.0, kPi), 11.0);
  }

  static void ExpectPoint(const std::vector<double>& points, std::size_t r, double x, double y) {
    EXPECT_NEAR(points[2 * r], x, 1e-12) << "return " << r;
    EXPECT_NEAR(points[2 * r + 1], y, 1e-12) << "return " << r;
  }

  void ExpectFixed(std::size_t i, int pose, const Pose2& world_from_robot) const {
    const FixedPose& fixed = graph_.fixed_poses()[i];
    EXPECT_EQ(fixed.pose, pose);
    EXPECT_EQ(fixed.world_from_robot.x, world_from_robot.x);
    EXPECT_EQ(fixed.world_from_robot.y, world_from_robot.y);
    EXPECT_EQ(fixed.world_from_robot.yaw, world_from_robot.yaw);
  }

  // The last call, which returned this id, was refused.
  static void ExpectRefused(const std::string& message, SlamGraph* graph, int id = -1) {
    EXPECT_EQ(id, -1) << message;
    const Status status = graph->TakeStatus();
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr(message));
    EXPECT_TRUE(graph->status().ok());
  }
  void ExpectRefused(const std::string& message, int id = -1) {
    ExpectRefused(message, &graph_, id);
  }

  SlamGraph graph_;
  int laser_ = -1, first_ = -1, second_ = -1;
};

TEST_F(SlamGraphTest, IdsCountUpFromZero) {
  EXPECT_EQ(laser_, 0);
  EXPECT_EQ(first_, 0);
  EXPECT_EQ(second_, 1);
  EXPECT_EQ(graph_.num_poses(), 2);
  EXPECT_EQ(graph_.timestamp_s(1), 11.0);
  EXPECT_EQ(graph_.InitialPose(0).y, 2.0);
  EXPECT_THAT(graph_.initial_poses(), ElementsAre(1.0, 2.0, 0.5 * kPi, 1.0, 5.0, kPi));
}

TEST_F(SlamGraphTest, KeepsReturnsOnlyAndPlacesThemByTheInitialGuess) {
  graph_.AddScan(first_, laser_, {1.0, kInfinity, 2.0});
  graph_.AddScan(second_, laser_, {std::nan(""), 3.0, 10.0});

  EXPECT_EQ(graph_.num_scans(), 2);
  EXPECT_EQ(graph_.num_returns(), 3u);
  EXPECT_EQ(graph_.scan(1).pose, second_);
  EXPECT_EQ(graph_.scan(1).first_return, 2u);
  EXPECT_EQ(graph_.scan(1).num_returns, 1u);
  EXPECT_THAT(graph_.returns().range_m, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(graph_.Bearings(), ElementsAre(-0.5 * kPi, 0.5 * kPi, 0.0));
  EXPECT_THAT(graph_.Beams(), ElementsAre(0, 2, 1));
  EXPECT_THAT(graph_.ScansOfReturns(), ElementsAre(0, 0, 1));

  const MapState state = graph_.InitialState();
  EXPECT_EQ(state.poses, graph_.initial_poses());
  ASSERT_EQ(state.points.size(), 6u);
  ExpectPoint(state.points, 0, 2.0, 2.5);   // Laser at (1, 2.5), its right is +x.
  ExpectPoint(state.points, 1, -1.0, 2.5);  // Its left is -x.
  ExpectPoint(state.points, 2, -2.5, 5.0);  // Laser at (0.5, 5), it looks along -x.
  EXPECT_TRUE(graph_.PointInRobot(1).isApprox(Eigen::Vector2d(0.5, 2.0)));
  EXPECT_NEAR(graph_.WorldFromLaser(0, state.poses).y, 2.5, 1e-12);
}

TEST_F(SlamGraphTest, PointsOfASweepAreThoseOfItsRanges) {
  // The laser of the fixture sits at (0.5, 0) and looks ahead: beams to the right, ahead, left.
  graph_.AddScan(first_, laser_, {1.0, 3.0, 2.0});
  const double far = 1000.0, none = std::nan("");
  graph_.AddPoints(first_, laser_,
                   {{0.5, 2.0}, {none, 1.0}, {0.5, -1.0}, {0.5, 0.0}, {far, 0.0}, {3.5, 0.0}});
  ASSERT_EQ(graph_.num_returns(), 6u);
  const std::vector<double> points = graph_.InitialState().points;
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(graph_.returns().range_m[3 + k], graph_.returns().range_m[k], 1e-12);
    EXPECT_NEAR(graph_.Bearing(3 + k), graph_.Bearing(k), 1e-12);
    EXPECT_EQ(graph_.Beam(3 + k), graph_.Beam(k));
    EXPECT_EQ(graph_.ScanOfReturn(3 + k), 1);
    EXPECT_TRUE(graph_.PointInRobot(3 + k).isApprox(graph_.PointInRobot(k)));
    EXPECT_NEAR(points[6 + 2 * k], points[2 * k], 1e-12);
  }
}

TEST_F(SlamGraphTest, PointsBetweenBeamsKeepTheirBearing) {
  graph_.AddPoints(first_, laser_, {{1.5, 1.2}, {1.5, 0.8}});
  EXPECT_THAT(graph_.Bearings(), ElementsAre(testing::DoubleNear(std::atan2(0.8, 1.0), 1e-7),
                                             testing::DoubleNear(std::atan2(1.2, 1.0), 1e-7)));
  EXPECT_THAT(graph_.Beams(), ElementsAre(1, 2));
}

TEST_F(SlamGraphTest, FindsTheScanOfAReturnAmongSmallEmptyAndLargeOnes) {
  LaserModel fine;
  fine.num_beams = 1000;
  fine.bearing_step_rad = 1e-3;
  const int laser = graph_.AddLaser(fine);
  std::vector<int> expected;
  for (int s = 0; s < 900; ++s) {
    const bool is_large = s % 300 == 200, is_empty = !is_large && s % 3 == 0;
    const std::vector<double> large(1000, 1.0), small = {1.0, kInfinity, 2.0};
    const std::vector<double> empty(3, kInfinity);
    graph_.AddScan(first_, is_large ? laser : laser_, is_large ? large : is_empty ? empty : small);
    expected.insert(expected.end(), is_large ? 1000 : is_empty ? 0 : 2, s);
  }
  ASSERT_EQ(graph_.num_returns(), expected.size());
  EXPECT_EQ(graph_.ScansOfReturns(), expected);
  for (std::size_t r = 0; r < expected.size(); ++r) {
    ASSERT_EQ(graph_.ScanOfReturn(r), expected[r]) << r;
  }
}

TEST_F(SlamGraphTest, BeamsMayNeedMoreThan16Bits) {
  LaserModel finest;
  finest.num_beams = 100000;
  finest.bearing_step_rad = 6e-5;
  finest.robot_from_laser = Pose2(1.0, -2.0, 0.5);
  const int laser = graph_.AddLaser(finest);
  const std::vector<int> beams = {0, 7, 65535, 65536, 99999};
  std::vector<double> ranges(finest.num_beams, kInfinity);
  for (const int beam : beams) ranges[beam] = 2.0;
  std::vector<double> upper(finest.num_beams, kInfinity);
  upper[65537] = 3.0;
  graph_.AddScan(first_, laser, ranges);
  graph_.AddScan(second_, laser, upper);
  graph_.AddScan(second_, laser_, {1.0, kInfinity, 2.0});
  EXPECT_THAT(graph_.Beams(), ElementsAre(0, 7, 65535, 65536, 99999, 65537, 0, 2));
  for (std::size_t r = 0; r < beams.size(); ++r) {
    EXPECT_EQ(graph_.Beam(r), beams[r]);
    EXPECT_EQ(graph_.Bearing(r), finest.Bearing(beams[r]));
    const Eigen::Vector2d in_laser = BeamEnd(2.0, finest.Bearing(beams[r]));
    EXPECT_LT((graph_.PointInRobot(r) - finest.robot_from_laser * in_laser).norm(), 1e-12);
  }
  EXPECT_EQ(graph_.RangesOfScan(1, kInfinity), upper);
  SlamGraph other;
  const int pose = other.AddPose(Pose2(), 0.0);
  other.AddScanOf(graph_, 0, pose);
  EXPECT_EQ(other.Beams(), beams);
}

TEST_F(SlamGraphTest, ReturnsOffTheirBeamsAreWhereTheirPointsWere) {
  LaserModel fan;
  fan.num_beams = 61;
  fan.first_bearing_rad = -1.5;
  fan.bearing_step_rad = 0.05;
  fan.robot_from_laser = Pose2(0.3, 0.1, -0.7);
  const int laser = graph_.AddLaser(fan);
  // Up to 0.025 rad off their beams, and at the ends of the fan further.
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 160; ++i) {
    points.push_back(fan.robot_from_laser * BeamEnd(1.0 + 0.05 * i, -1.545 + 0.0194 * i));
  }
  graph_.AddPoints(first_, laser, points);
  ASSERT_EQ(graph_.num_returns(), points.size());
  for (std::size_t r = 0; r < points.size(); ++r) {
    EXPECT_LT((graph_.PointInRobot(r) - points[r]).norm(), 2e-6) << r;
  }
}

TEST_F(SlamGraphTest, PointsInOrderOfAFanThatTurnsClockwise) {
  LaserModel clockwise = ThreeBeamLaser();
  clockwise.first_bearing_rad = 0.5 * kPi;
  clockwise.bearing_step_rad = -0.5 * kPi;
  const int laser = graph_.AddLaser(clockwise);
  graph_.AddPoints(first_, laser, {{0.5, -1.0}, {3.5, 0.0}, {0.5, 2.0}});
  EXPECT_THAT(graph_.Beams(), ElementsAre(0, 1, 2));
  EXPECT_THAT(graph_.returns().range_m, ElementsAre(2.0, 3.0, 1.0));
}

TEST_F(SlamGraphTest, GivesTheRangesOfASweepBack) {
  const double none = std::numeric_limits<double>::infinity();
  graph_.AddScan(first_, laser_, {none, 3.0, 2.0});
  graph_.AddScan(first_, laser_, {1.0, std::nan(""), 1000.0});
  EXPECT_THAT(graph_.RangesOfScan(0, none), testing::ElementsAre(none, 3.0, 2.0));
  EXPECT_THAT(graph_.RangesOfScan(1, -1.0), testing::ElementsAre(1.0, -1.0, -1.0));
}

TEST_F(SlamGraphTest, AScanWithoutReturnsIsAScan) {
  graph_.AddScan(first_, laser_, {0.0, 0.0, 0.0});
  EXPECT_EQ(graph_.num_scans(), 1);
  EXPECT_EQ(graph_.scan(0).num_returns, 0u);
}

TEST_F(SlamGraphTest, TheMeasuredMapIsSeenFromThePosesAskedFor) {
  graph_.AddScan(first_, laser_, {1.0, 4.0, kInfinity});
  MapState state = graph_.InitialState();
  EXPECT_EQ(graph_.MeasuredMap(state.poses), state.points);
  state.SetPose(first_, Pose2(0.0, 0.0, 0.0));
  ExpectPoint(state.points, 0, 2.0, 2.5);
  const std::vector<double> measured = graph_.MeasuredMap(state.poses);
  ExpectPoint(measured, 0, 0.5, -1.0);
  ExpectPoint(measured, 1, 4.5, 0.0);
  EXPECT_NEAR(graph_.WorldFromLaser(0, state.poses).x, 0.5, 1e-12);
}

TEST_F(SlamGraphTest, AStateIsExtendedByWhatTheGraphHasMore) {
  graph_.AddScan(first_, laser_, {1.0, 4.0, kInfinity});
  MapState state = graph_.InitialState();
  state.SetPose(first_, Pose2(0.0, 0.0, 0.0));
  state.points[0] = 7.0;
  const int third = graph_.AddPose(Pose2(3.0, 4.0, 0.0), 12.0);
  graph_.AddScan(third, laser_, {kInfinity, 2.0, kInfinity});
  graph_.AddScan(first_, laser_, {kInfinity, 3.0, kInfinity});
  graph_.ExtendState(&state);
  EXPECT_THAT(state.poses, ElementsAre(0.0, 0.0, 0.0, 1.0, 5.0, kPi, 3.0, 4.0, 0.0));
  ASSERT_EQ(state.points.size(), 8u);
  // What was there stays.
  EXPECT_EQ(state.points[0], 7.0);
  ExpectPoint(state.points, 1, 1.0, 6.5);
  // What is new is seen from the initial guess of its pose, or from where the state has it.
  ExpectPoint(state.points, 2, 5.5, 4.0);
  ExpectPoint(state.points, 3, 3.5, 0.0);
}

TEST_F(SlamGraphTest, ExtendingStartsFromNothingAndEndsWithNothingToDo) {
  graph_.AddScan(first_, laser_, {1.0, 4.0, kInfinity});
  MapState state;
  graph_.ExtendState(&state);
  EXPECT_EQ(state, graph_.InitialState());
  state.SetPose(second_, Pose2(7.0, 8.0, 9.0));
  const MapState before = state;
  graph_.ExtendState(&state);
  EXPECT_EQ(state, before);
  EXPECT_EQ(SlamGraph().InitialState(), MapState());
}

TEST_F(SlamGraphTest, BadInputIsNamedAndChangesNothing) {
  LaserModel broken = ThreeBeamLaser();
  broken.num_beams = -3;
  ExpectRefused("laser 1: num_beams = -3", graph_.AddLaser(broken));
  ExpectRefused("pose 2", graph_.AddPose(Pose2(0.0, kInfinity, 0.0), 12.0));
  ExpectRefused("pose 2", graph_.AddPose(Pose2(), std::nan("")));
  ExpectRefused("scan 0: no pose with id 2", graph_.AddScan(2, laser_, {1.0, 1.0, 1.0}));
  ExpectRefused("scan 0: no pose with id -1", graph_.AddScan(-1, laser_, {1.0, 1.0, 1.0}));
  ExpectRefused("scan 0: no laser with id 1", graph_.AddScan(0, 1, {1.0, 1.0, 1.0}));
  ExpectRefused("1 ranges for a laser of 3 beams", graph_.AddScan(0, laser_, {1.0}));
  ExpectRefused("scan 0: no laser with id 1", graph_.AddPoints(0, 1, {}));
  LaserModel narrow = ThreeBeamLaser();
  narrow.bearing_step_rad = 0.1;
  narrow.first_bearing_rad = -0.1;
  const int narrow_id = graph_.AddLaser(narrow);
  ExpectRefused("scan 0: point 1 lies outside of the laser's beams",
                graph_.AddPoints(0, narrow_id, {{2.0, 0.0}, {0.5, 1.0}}));
  graph_.AddOdometry({0, 7, Pose2()});
  ExpectRefused("odometry 0 (0 -> 7): no pose with id 7");
  graph_.AddOdometry({1, 1, Pose2()});
  ExpectRefused("odometry 0 (1 -> 1)");
  graph_.AddOdometry({0, 1, Pose2(0, 0, kInfinity)});
  ExpectRefused("odometry 0 (0 -> 1)");
  graph_.AddRelativePose({-2, 1, Pose2(), Eigen::Matrix3d::Identity()});
  ExpectRefused("relative pose 0 (-2 -> 1): no pose with id -2");

  EXPECT_EQ(graph_.num_poses(), 2);
  EXPECT_EQ(graph_.num_scans(), 0);
  EXPECT_EQ(graph_.num_returns(), 0u);
  EXPECT_TRUE(graph_.InitialState().points.empty());
  EXPECT_TRUE(graph_.odometry().empty());
  EXPECT_TRUE(graph_.relative_poses().empty());
}

TEST_F(SlamGraphTest, KeepsTheFirstErrorAndChangesNothingAfterIt) {
  EXPECT_TRUE(graph_.status().ok());
  EXPECT_EQ(graph_.AddScan(first_, laser_, {1.0, 2.0, 3.0}), 0);
  EXPECT_EQ(graph_.AddScan(second_, laser_, {1.0, 2.0}), -1);
  const std::string message = "scan 1: 2 ranges for a laser of 3 beams";
  EXPECT_EQ(graph_.status().message(), message);

  LaserModel turned = ThreeBeamLaser();
  turned.robot_from_laser.yaw = 1.0;
  EXPECT_EQ(graph_.AddLaser(turned), -1);
  EXPECT_EQ(graph_.AddLaser(ThreeBeamLaser()), -1);
  EXPECT_EQ(graph_.AddPose(Pose2(), 12.0), -1);
  EXPECT_EQ(graph_.AddScan(second_, laser_, {1.0, 2.0, 3.0}), -1);
  EXPECT_EQ(graph_.AddSweep(second_, laser_, {1.0, 2.0, 3.0}, Pose2()), -1);
  EXPECT_EQ(graph_.AddPoints(second_, laser_, {{2.5, 0.1}}), -1);
  EXPECT_EQ(graph_.AddScanOf(graph_, 0, second_), -1);
  graph_.AddOdometry({0, 1, Pose2()});
  graph_.AddRelativePose({0, 0, Pose2()});  // bad, too
  graph_.FixPose(second_);
  EXPECT_EQ(graph_.status().message(), message);
  EXPECT_EQ(graph_.num_lasers(), 1);
  EXPECT_EQ(graph_.num_poses(), 2);
  EXPECT_EQ(graph_.num_scans(), 1);
  EXPECT_EQ(graph_.num_returns(), 3u);
  EXPECT_TRUE(graph_.odometry().empty());
  EXPECT_TRUE(graph_.relative_poses().empty());
  EXPECT_FALSE(graph_.has_named_fixed_poses());

  SlamGraph copy = graph_;
  EXPECT_EQ(copy.TakeStatus().message(), message);
  EXPECT_TRUE(copy.status().ok());
  EXPECT_EQ(copy.AddScan(second_, laser_, {1.0, 2.0, 3.0}), 1);
  EXPECT_EQ(graph_.status().message(), message);
}

TEST_F(SlamGraphTest, RefusesWhatIsNoCovariance) {
  Eigen::Matrix3d skew = Eigen::Matrix3d::Identity();
  skew(0, 1) = 0.1;
  Eigen::Matrix3d with_nan = Eigen::Matrix3d::Identity();
  with_nan(2, 2) = std::nan("");
  Eigen::Matrix3d indefinite = Eigen::Matrix3d::Identity();
  indefinite(0, 1) = indefinite(1, 0) = 2.0;
  for (const Eigen::Matrix3d& bad :
       {skew, with_nan, indefinite, Eigen::Matrix3d(Eigen::Matrix3d::Zero())}) {
    graph_.AddRelativePose({0, 1, Pose2(), bad});
    ExpectRefused("relative pose 0 (0 -> 1): covariance");
  }
  EXPECT_TRUE(graph_.relative_poses().empty());

  Eigen::Matrix3d rounded = Eigen::Matrix3d::Identity();  // Symmetric up to rounding is fine.
  rounded(0, 1) = 0.1;
  rounded(1, 0) = std::nextafter(0.1, 1.0);
  graph_.AddRelativePose({0, 1, Pose2(), rounded});
  EXPECT_EQ(graph_.relative_poses().size(), 1u);
}

TEST_F(SlamGraphTest, RefusesWhatIsBeyondAllLimits) {
  for (const Pose2& far : {Pose2(1e8, 0, 0), Pose2(0, -1e300, 0), Pose2(0, 0, 1e7)}) {
    ExpectRefused("pose 2: coordinates or time are not finite, or ", graph_.AddPose(far, 0.0));
    graph_.AddOdometry({0, 1, far});
    ExpectRefused("odometry 0 (0 -> 1): relative pose is not finite");
  }
  ExpectRefused("pose 2: coordinates or time", graph_.AddPose(Pose2(), 1e13));
  for (const double sigma : {1e-10, 1e10}) {
    graph_.AddRelativePose({0, 1, Pose2(), sigma * sigma * Eigen::Matrix3d::Identity()});
    ExpectRefused("relative pose 0 (0 -> 1): a standard deviation is not within 1e-9 and 1e9");
  }
  LaserModel laser = ThreeBeamLaser();
  laser.max_range_m = 1e6;
  ExpectRefused("laser 1: max_range_m = 1e+06", graph_.AddLaser(laser));
  laser = ThreeBeamLaser();
  laser.num_beams = 100001;
  ExpectRefused("laser 1: num_beams = 100001", graph_.AddLaser(laser));
  EXPECT_EQ(graph_.num_poses(), 2);
}

TEST_F(SlamGraphTest, EqualLasersAreOne) {
  const int again = graph_.AddLaser(ThreeBeamLaser());
  EXPECT_EQ(again, laser_);
  LaserModel turned = ThreeBeamLaser();
  turned.robot_from_laser.yaw = 1.0;
  const int other = graph_.AddLaser(turned);
  EXPECT_EQ(other, 1);
  EXPECT_EQ(graph_.laser(other).robot_from_laser.yaw, 1.0);
}

TEST_F(SlamGraphTest, TheFirstPoseIsFixedUnlessAnotherIsNamed) {
  EXPECT_TRUE(SlamGraph().fixed_poses().empty());
  ASSERT_EQ(graph_.fixed_poses().size(), 1u);
  ExpectFixed(0, first_, Pose2(1.0, 2.0, 0.5 * kPi));

  graph_.FixPose(second_);
  ASSERT_EQ(graph_.fixed_poses().size(), 1u);
  ExpectFixed(0, second_, Pose2(1.0, 5.0, kPi));

  graph_.FixPose(first_);
  ASSERT_EQ(graph_.fixed_poses().size(), 2u);
  ExpectFixed(0, second_, Pose2(1.0, 5.0, kPi));
  ExpectFixed(1, first_, Pose2(1.0, 2.0, 0.5 * kPi));
  graph_.FixPose(2);
  ExpectRefused("fixed pose 2: no pose with id 2");
  graph_.FixPose(-1);
  ExpectRefused("fixed pose -1: no pose with id -1");
}

TEST_F(SlamGraphTest, APoseCanBeFixedElsewhereThanAtItsGuess) {
  graph_.FixPose(second_, Pose2(7.0, 8.0, 9.0));
  graph_.FixPose(first_);
  ExpectFixed(0, second_, Pose2(7.0, 8.0, 9.0));
  EXPECT_EQ(graph_.InitialPose(second_).y, 5.0);
  // The last word counts, and keeps the place in the list.
  graph_.FixPose(second_, Pose2(3.0, 4.0, 5.0));
  ASSERT_EQ(graph_.fixed_poses().size(), 2u);
  ExpectFixed(0, second_, Pose2(3.0, 4.0, 5.0));
  graph_.FixPose(second_);
  ExpectFixed(0, second_, Pose2(1.0, 5.0, kPi));

  graph_.FixPose(2, Pose2());
  ExpectRefused("fixed pose 2: no pose with id 2");
  graph_.FixPose(second_, Pose2(kInfinity, 0.0, 0.0));
  ExpectRefused("fixed pose 1: coordinates");
  graph_.FixPose(second_, Pose2(0.0, 1e8, 0.0));
  ExpectRefused("fixed pose 1: coordinates");
  ASSERT_EQ(graph_.fixed_poses().size(), 2u);
  ExpectFixed(0, second_, Pose2(1.0, 5.0, kPi));
}

TEST_F(SlamGraphTest, TakesScansOfAnotherGraph) {
  graph_.AddScan(first_, laser_, {1.0, kInfinity, 3.0});
  graph_.AddPoints(second_, laser_, {{2.5, 0.1}, {2.6, 0.2}, {3.0, -0.4}});
  SlamGraph other;
  ExpectRefused("scan 0: no pose with id 0", &other, other.AddScanOf(graph_, 0, 0));
  const int pose = other.AddPose(Pose2(7.0, 8.0, 0.0), 0.0);
  other.AddScanOf(graph_, 1, pose);
  other.AddScanOf(other, 0, pose);  // from itself, too
  ExpectRefused("the other graph has no scan with id 2", &other, other.AddScanOf(graph_, 2, pose));
  ExpectRefused("the other graph has no scan with id -1", &other,
                other.AddScanOf(graph_, -1, pose));
  ASSERT_EQ(other.num_scans(), 2);
  ASSERT_EQ(other.num_returns(), 6u);
  const std::vector<double> points = other.InitialState().points;
  EXPECT_EQ(other.LaserOfScan(1), ThreeBeamLaser());
  for (std::size_t r = 0; r < 6; ++r) {
    const std::size_t from = graph_.scan(1).first_return + r % 3;
    EXPECT_EQ(other.returns().range_m[r], graph_.returns().range_m[from]);
    EXPECT_EQ(other.Bearing(r), graph_.Bearing(from));
    EXPECT_EQ(other.Beam(r), graph_.Beam(from));
    EXPECT_EQ(other.ScanOfReturn(r), static_cast<int>(r / 3));
    const Eigen::Vector2d expected = Pose2(7.0, 8.0, 0.0) * other.PointInRobot(r);
    ExpectPoint(points, r, expected.x(), expected.y());
  }
}

TEST_F(SlamGraphTest, OdometryCanBeCorrected) {
  graph_.AddOdometry({0, 1, Pose2(1.0, 0.0, 0.0)});
  const SlamGraph corrected = graph_.Corrected({{Pose2(-1.0, 0.0, 0.0)}, {}, {}, {}, {}});
  EXPECT_EQ(corrected.odometry()[0].from_from_to.x, -1.0);
  EXPECT_EQ(corrected.odometry()[0].to, 1);
  EXPECT_EQ(graph_.odometry()[0].from_from_to.x, 1.0);
}

TEST_F(SlamGraphTest, MountingAndRangesCanBeCorrected) {
  graph_.AddScan(first_, laser_, {1.0, 2.0, kInfinity});
  const SlamGraph corrected = graph_.Corrected({{}, {Pose2(0.0, 0.0, 0.0)}, {1.0, 3.0}, {}, {}});
  const std::vector<double> points = corrected.InitialState().points;
  ExpectPoint(points, 0, 2.0, 2.0);
  ExpectPoint(points, 1, 1.0, 5.0);
  EXPECT_TRUE(corrected.PointInRobot(1).isApprox(Eigen::Vector2d(3.0, 0.0)));
  EXPECT_EQ(graph_.laser(laser_).robot_from_laser.x, 0.5);
  EXPECT_THAT(graph_.returns().range_m, ElementsAre(1.0, 2.0));
  // A return stays one.
  const SlamGraph clamped = graph_.Corrected({{}, {}, {-1.0, 100.0}, {}, {}});
  EXPECT_FLOAT_EQ(clamped.returns().range_m[0], clamped.laser(laser_).min_range_m);
  EXPECT_TRUE(clamped.laser(laser_).IsReturn(clamped.returns().range_m[0]));
  EXPECT_TRUE(clamped.laser(laser_).IsReturn(clamped.returns().range_m[1]));
  EXPECT_FLOAT_EQ(clamped.returns().range_m[1], 10.0);
}

TEST_F(SlamGraphTest, RoundingMakesNoReturnOfWhatIsNone) {
  const double max_range_m = graph_.laser(laser_).max_range_m;
  const double just_below_m = std::nextafter(max_range_m, 0.0);  // rounds to the maximum
  graph_.AddScan(first_, laser_, {just_below_m, 0.05, max_range_m});
  ASSERT_EQ(graph_.num_returns(), 2u);
  for (const float range_m : graph_.returns().range_m) {
    EXPECT_TRUE(graph_.laser(laser_).IsReturn(range_m)) << range_m;
  }
}

TEST_F(SlamGraphTest, BearingsCanBeCorrectedAndPutBack) {
  graph_.AddScan(first_, laser_, {1.0, 2.0, 3.0});
  graph_.AddScan(second_, laser_, {1.0, 2.0, 3.0});
  const std::vector<double> by_model = graph_.Bearings();
  std::vector<double> turned = by_model;
  turned[4] += 0.125;  // of the second scan
  const SlamGraph corrected = graph_.Corrected({{}, {}, {}, turned, {}});
  EXPECT_EQ(corrected.Bearings(), turned);
  EXPECT_FALSE(corrected.scan(0).has_own_bearings);
  EXPECT_TRUE(corrected.scan(1).has_own_bearings);
  EXPECT_LT((corrected.PointInLaser(4) - BeamEnd(2.0, turned[4])).norm(), 1e-12);
  const SlamGraph back = corrected.Corrected({{}, {}, {}, by_model, {}});
  EXPECT_EQ(back.Bearings(), by_model);
  EXPECT_FALSE(back.scan(1).has_own_bearings);
}

TEST_F(SlamGraphTest, LasersAreKnownByTheirPresentMounting) {
  LaserModel laser = ThreeBeamLaser();
  std::vector<Pose2> mountings = {laser.robot_from_laser};
  int id = 0;
  for (int i = 1; i < 100; ++i) {
    laser.robot_from_laser.x = 0.01 * ((37 * i) % 100) - 5.0;
    mountings.push_back(laser.robot_from_laser);
    id = graph_.AddLaser(laser);
    EXPECT_EQ(id, i);
  }
  laser.robot_from_laser = mountings[42];
  id = graph_.AddLaser(laser);
  EXPECT_EQ(id, 42);
  // Two of them come to be alike: the first one counts.
  const Pose2 given = mountings[42];
  mountings[42] = mountings[7];
  SlamGraph corrected = graph_.Corrected({{}, mountings, {}, {}, {}});
  laser.robot_from_laser = mountings[7];
  id = corrected.AddLaser(laser);
  EXPECT_EQ(id, 7);
  laser.robot_from_laser = given;
  id = corrected.AddLaser(laser);
  EXPECT_EQ(id, 100);
  EXPECT_EQ(corrected.laser(id).robot_from_laser.x, given.x);
}

TEST_F(SlamGraphTest, ReturnsThatMoveAreKnownWhereverTheScanGoes) {
  graph_.AddScan(first_, laser_, {1.0, 2.0, 3.0});
  graph_.AddScan(second_, laser_, {1.0, 2.0, 3.0});
  EXPECT_FALSE(graph_.Moves(1));
  graph_ = std::move(graph_).Corrected({{}, {}, {}, {}, {1, 5}});
  // On top of those that were known.
  graph_ = std::move(graph_).Corrected({{}, {}, {}, {}, {3}});
  const std::vector<bool> expected = {false, true, false, true, false, true};
  for (std::size_t r = 0; r < expected.size(); ++r) EXPECT_EQ(graph_.Moves(r), expected[r]) << r;
  // None of a scan that comes later.
  graph_.AddScan(second_, laser_, {1.0, 2.0, 3.0});
  EXPECT_FALSE(graph_.Moves(7));
  SlamGraph other;
  const int pose = other.AddPose(Pose2(), 0.0);
  other.AddScanOf(graph_, 1, pose);
  for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(other.Moves(r), expected[3 + r]) << r;
}

TEST_F(SlamGraphTest, WhatIsNotCorrectedStaysAsItIs) {
  graph_.AddScan(first_, laser_, {1.0, 2.0, kInfinity});
  graph_.AddOdometry({0, 1, Pose2(1.0, 0.0, 0.0)});
  graph_.FixPose(second_);
  const MapState state = graph_.InitialState();
  const SlamGraph same = graph_.Corrected({});
  EXPECT_EQ(same.InitialState(), state);
  EXPECT_EQ(same.odometry()[0].from_from_to.x, 1.0);
  EXPECT_EQ(same.fixed_poses()[0].pose, second_);
  EXPECT_EQ(same.timestamp_s(second_), 11.0);
  // In place.
  graph_ = std::move(graph_).Corrected({{Pose2(2.0, 0.0, 0.0)}, {}, {}, {}, {}});
  EXPECT_EQ(graph_.InitialState(), state);
  EXPECT_EQ(graph_.odometry()[0].from_from_to.x, 2.0);
}

}  // namespace
}  // namespace plumbline
