// Factors of a host's own behind Solve: positions, a compass and a wall that is known. What a host
// writes is all above the tests.

#include "plumbline/core/custom_factor.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/covariance.h"
#include "plumbline/solvers/full/alternating_cg.h"
#include "plumbline/solvers/full/problem_builder.h"
#include "plumbline/solvers/full/rounds_solver.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/sliding_window.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/solvers/terms/pose_terms.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A measured position of the robot, as of GPS.
struct Position {
  double x_m, y_m, sigma_m;

  template <typename T>
  bool operator()(const T* pose, T* residuals) const {
    residuals[0] = (pose[0] - x_m) / sigma_m;
    residuals[1] = (pose[1] - y_m) / sigma_m;
    return true;
  }
};
CustomFactor PositionOf(int pose, const Pose2& at, double sigma_m) {
  return {"position",
          std::make_shared<ceres::AutoDiffCostFunction<Position, 2, 3>>(
              new Position{at.x, at.y, sigma_m}),
          {pose},
          {},
          nullptr};
}

// A measured heading of the robot.
struct Heading {
  double yaw_rad, sigma_rad;

  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    using std::atan2, std::cos, std::sin;
    const T error = pose[2] - yaw_rad;
    residual[0] = atan2(sin(error), cos(error)) / sigma_rad;
    return true;
  }
};
CustomFactor HeadingOf(int pose, const Pose2& at, double sigma_rad) {
  return {
      "compass",
      std::make_shared<ceres::AutoDiffCostFunction<Heading, 1, 3>>(new Heading{at.yaw, sigma_rad}),
      {pose},
      {},
      nullptr};
}

// A map point lies on the wall x = x_m.
struct OnWall {
  double x_m, sigma_m;

  template <typename T>
  bool operator()(const T* point, T* residual) const {
    residual[0] = (point[0] - x_m) / sigma_m;
    return true;
  }
};
CustomFactor WallAt(std::size_t point, double x_m, double sigma_m) {
  return {"wall",
          std::make_shared<ceres::AutoDiffCostFunction<OnWall, 1, 2>>(new OnWall{x_m, sigma_m}),
          {},
          {point},
          nullptr};
}

// The length of the way from a pose to another, to a point and back.
struct Perimeter {
  template <typename T>
  bool operator()(const T* a, const T* b, const T* point, T* residual) const {
    using std::sqrt;
    const auto distance = [](const T* p, const T* q) {
      return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]));
    };
    residual[0] = (distance(a, b) + distance(b, point) + distance(point, a) - 9.0) / 0.5;
    return true;
  }
};

using CustomFactors = std::vector<CustomFactor>;

double DistanceM(const Pose2& a, const Pose2& b) {
  return (a.translation() - b.translation()).norm();
}

void ExpectSamePose(const Pose2& a, const Pose2& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.yaw, b.yaw);
}

void Add(const CustomFactors& factors, SlamGraph* graph) {
  for (const CustomFactor& f : factors) graph->AddFactor(f.name, f.cost, f.poses, f.points, f.loss);
}

// Two rooms; the second one has drifted as a whole, and nothing but loose odometry joins it to the
// first.
constexpr int kPosesPerRoom = 8;
constexpr int kNumPoses = 2 * kPosesPerRoom;
constexpr double kSecondRoomX = 20.0;

NoisyRoom DriftedRoom(const Pose2& drift) {
  SyntheticScene scene;
  scene.laser = PanoramicLaser(180);
  scene.range_sigma_m = 0.01;
  for (const double x : {0.0, kSecondRoomX}) {
    for (const Face& face : {Face{{-3, -2}, {3, -2}}, Face{{3, -2}, {3, 2}}, Face{{3, 2}, {-3, 2}},
                             Face{{-3, 2}, {-3, -2}}, Face{{0, 0.8}, {0, 2}}}) {
      const Eigen::Vector2d offset(x, 0.0);
      scene.faces.push_back({face.a + offset, face.b + offset});
    }
    for (int i = 0; i < kPosesPerRoom; ++i) {
      const double turn = 2.0 * kPi * i / kPosesPerRoom;
      scene.poses.push_back({x + 1.5 * std::cos(turn), 0.5 * std::sin(turn), turn});
    }
  }
  NoisyRoom room{MakeGraph(scene, 3), scene.poses, {}};
  room.state = room.graph.InitialState();
  const Pose2 second_room(kSecondRoomX, 0.0, 0.0);
  for (int i = kPosesPerRoom; i < kNumPoses; ++i) {
    const Pose2 in_room = second_room.Inverse() * room.truth[i];
    room.state.SetPose(i, second_room * drift * in_room);
  }
  room.state.points = room.graph.MeasuredMap(room.state.poses);
  for (int i = 0; i + 1 < kNumPoses; ++i) {
    const Pose2 step = Between(room.state.WorldFromRobot(i), room.state.WorldFromRobot(i + 1));
    room.graph.AddOdometry({i, i + 1, step});
  }
  return room;
}

// Positions of the second room's poses.
CustomFactors Positions(const NoisyRoom& room, double sigma_m) {
  CustomFactors factors;
  for (int i = kPosesPerRoom; i < kNumPoses; ++i) {
    factors.push_back(PositionOf(i, room.truth[i], sigma_m));
  }
  return factors;
}

// The far wall of the second room, for what its first pose sees of it.
CustomFactors Wall(const NoisyRoom& room) {
  const double wall_x = kSecondRoomX + 3.0;
  const MapState truth{PoseArray(room.truth), room.graph.MeasuredMap(PoseArray(room.truth))};
  CustomFactors factors;
  for (std::size_t r = 0; r < room.graph.num_returns(); ++r) {
    const Eigen::Vector2d point = MapPoint(truth, r);
    if (std::abs(point.x() - wall_x) < 0.05 && std::abs(point.y()) < 1.9) {
      factors.push_back(WallAt(r, wall_x, 0.001));
    }
  }
  EXPECT_GT(factors.size(), 100u);
  return factors;
}

double SecondRoomError(const NoisyRoom& room) {
  double sum = 0.0;
  for (int i = kPosesPerRoom; i < kNumPoses; ++i) {
    sum += (room.state.WorldFromRobot(i).translation() - room.truth[i].translation()).norm();
  }
  return sum / kPosesPerRoom;
}

// A minimiser of the host's, too.
class OwnSolver final : public RoundsSolver {
 public:
  const char* name() const override { return "own"; }
  InnerResult Minimize(const RoundProblem& problem, const ProgressCallback& report,
                       MapState* state) const override {
    return SolveByAlternatingCg(problem.energy, problem.options.alternating_cg, report, state);
  }
};

struct Choice {
  const char* name;
  SolverType type;
  bool reduced_ceres;
  bool own;

  SolverOptions Options() const {
    SolverOptions options;
    options.type = type;
    options.ceres->reduced = reduced_ceres;
    if (own) options.own_solver = std::make_shared<OwnSolver>();
    return options;
  }
};
constexpr Choice kOverLandmarks[] = {{"reduced", SolverType::kReduced, false, false},
                                     {"ceres_reduced", SolverType::kCeres, true, false}};
constexpr Choice kOverPoints[] = {{"alternating_cg", SolverType::kAlternatingCg, false, false},
                                  {"ceres", SolverType::kCeres, false, false},
                                  {"own", SolverType::kReduced, false, true}};

void ExpectRefused(const SolverOptions& options, const NoisyRoom& room,
                   const std::vector<std::string>& words) {
  MapState state = room.state;
  const SolverSummary summary = RefineState(options, room.graph, &state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  for (const std::string& word : words) EXPECT_THAT(summary.message, HasSubstr(word));
  EXPECT_EQ(state, room.state);
}

class OverLandmarks : public testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(CustomFactor, OverLandmarks, testing::ValuesIn(kOverLandmarks),
                         [](const auto& info) { return std::string(info.param.name); });
class OverPoints : public testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(CustomFactor, OverPoints, testing::ValuesIn(kOverPoints),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(OverLandmarks, PositionsPullADriftedMapIntoPlace) {
  NoisyRoom room = DriftedRoom({0.2, -0.1, 0.03});
  room.graph.FixPose(0);
  SolverOptions options = GetParam().Options();
  Add(Positions(room, 0.05), &room.graph);
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.02);
  const TermSummary term = TermOfSummary(summary, "position");
  EXPECT_EQ(term.count, static_cast<std::size_t>(kPosesPerRoom));
  EXPECT_EQ(term.residuals_per_block, 2);
  EXPECT_LT(term.final_cost, 0.05 * term.initial_cost);
}

TEST_P(OverLandmarks, ACompassTurnsTheMap) {
  NoisyRoom room = DriftedRoom({0.2, -0.1, 0.1});
  room.graph.FixPose(0);
  SolverOptions options = GetParam().Options();
  const int pose = kPosesPerRoom + 2;
  Add({PositionOf(pose, room.truth[pose], 0.01), HeadingOf(pose, room.truth[pose], 0.001)},
      &room.graph);
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.02);
  EXPECT_NEAR(room.state.WorldFromRobot(pose).yaw, room.truth[pose].yaw, 0.005);
}

TEST_P(OverLandmarks, RefuseWhatSeesPoints) {
  NoisyRoom room = DriftedRoom({0.05, 0.0, 0.0});
  SolverOptions options = GetParam().Options();
  Add(Wall(room), &room.graph);
  ExpectRefused(options, room, {"\"wall\"", "points", "alternating_cg"});
}

// In rounds the lines hold the map back until the next one, so sigmas are small and so is the
// drift.
TEST_P(OverPoints, PositionsPullADriftedMapIntoPlace) {
  NoisyRoom room = DriftedRoom({0.03, -0.02, 0.0});
  room.graph.FixPose(0);
  const double before_m = SecondRoomError(room);
  SolverOptions options = GetParam().Options();
  Add(Positions(room, 0.001), &room.graph);
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.4 * before_m);
  EXPECT_EQ(TermOfSummary(summary, "position").count, static_cast<std::size_t>(kPosesPerRoom));
}

TEST_P(OverPoints, AKnownWallPullsItsPoints) {
  NoisyRoom room = DriftedRoom({0.03, 0.0, 0.0});
  room.graph.FixPose(0);
  const double before_m = SecondRoomError(room);
  SolverOptions options = GetParam().Options();
  Add(Wall(room), &room.graph);
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.6 * before_m);
  const TermSummary term = TermOfSummary(summary, "wall");
  EXPECT_GT(term.count, 100u);
  EXPECT_LT(term.WhitenedRms(), 1.0);
}

TEST(CustomFactorTest, CostsAndDerivativesAreThoseOfCeres) {
  NoisyRoom room = DriftedRoom({0.03, -0.02, 0.01});
  FactorOptions factors;
  const auto perimeter =
      std::make_shared<ceres::AutoDiffCostFunction<Perimeter, 1, 3, 3, 2>>(new Perimeter);
  const auto loss = std::make_shared<ceres::CauchyLoss>(1.5);
  Add(Positions(room, 0.01), &room.graph);
  Add(Wall(room), &room.graph);
  Add({{"perimeter", perimeter, {2, 5}, {77}, loss},
       {"perimeter", perimeter, {9, 3}, {1400}, loss}},
      &room.graph);
  std::vector<double> pose_gradient, point_gradient;
  ThreadPool pool(2);
  const Associations associations = AssociationsOf(room.graph, room.state);
  const Energy energy(room.graph, associations, factors, &pool);
  TermCosts costs;
  ASSERT_TRUE(energy.Evaluate(room.state.poses, room.state.points, &costs,
                              {&pose_gradient, &point_gradient}));

  JointProblem joint = BuildJointProblem(room.graph, associations, factors, &room.state);
  ceres::Problem::EvaluateOptions all;
  for (int p = 0; p < kNumPoses; ++p) all.parameter_blocks.push_back(&room.state.poses[3 * p]);
  for (std::size_t r = 0; r < room.graph.num_returns(); ++r) {
    all.parameter_blocks.push_back(&room.state.points[2 * r]);
  }
  double cost = 0.0;
  std::vector<double> gradient, combined = pose_gradient;
  ASSERT_TRUE(joint.problem->Evaluate(all, &cost, nullptr, &gradient, nullptr));
  EXPECT_NEAR(costs.Total(), cost, 1e-9 * cost);
  combined.insert(combined.end(), point_gradient.begin(), point_gradient.end());
  ASSERT_EQ(combined.size(), gradient.size());
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    ASSERT_NEAR(combined[i], gradient[i], 1e-9 * (1.0 + std::abs(gradient[i]))) << i;
  }
  // Curvature along a direction: the change of the gradient without loss, by Gauss-Newton.
  EXPECT_GT(energy.Curvature(room.state.poses, room.state.points, &pose_gradient, &point_gradient,
                             [](const Term& term) { return term.name() == "perimeter"; }),
            0.0);
}

TEST(CustomFactorTest, TheReducedSystemHasItToo) {
  NoisyRoom room = DriftedRoom({0.03, -0.02, 0.01});
  const FactorOptions factors;
  auto robust = PositionOf(4, {}, 0.1);
  robust.name = "robust";
  robust.loss = std::make_shared<ceres::CauchyLoss>(1.5);
  Add(Positions(room, 0.01), &room.graph);
  Add({robust}, &room.graph);
  ThreadPool pool(1);
  const PoseTerms terms(room.graph, factors);
  LineObservations none;
  none.first_of_landmark = {0};
  PoseSystem system;
  system.Linearize(none, {}, terms, room.state.poses, FramesOf(room.state.poses), &pool);
  const Energy energy(room.graph, AssociationsOf(room.graph, room.state), factors, &pool);
  TermCosts costs;
  std::vector<double> expected;
  ASSERT_TRUE(energy.Evaluate(room.state.poses, room.state.points, &costs, {&expected},
                              [](const Term& term) { return !term.SeesPoints(); }));
  EXPECT_NEAR(terms.Cost(room.state.poses), costs.Total(), 1e-9 * costs.Total());
  const Eigen::MatrixXd gradient = system.ByPose(system.gradient);
  for (Eigen::Index i = 0; i < gradient.rows(); ++i) {
    EXPECT_NEAR(gradient(i, 0), expected[i], 1e-9 * (1.0 + std::abs(expected[i]))) << i;
  }
}

TEST(CustomFactorTest, IsInWindowsAsFarAsItSeesThem) {
  NoisyRoom room = DriftedRoom({0.2, -0.1, 0.0});
  SolverOptions options;
  Add(Positions(room, 0.05), &room.graph);
  Add({PositionOf(0, room.truth[0], 0.05)}, &room.graph);  // of a pose outside
  WindowOptions window;
  window.num_free_poses = kPosesPerRoom;
  const SolverSummary summary = SolveWindow(options, window, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.02);
  EXPECT_EQ(TermOfSummary(summary, "position").count, static_cast<std::size_t>(kPosesPerRoom));

  options.type = SolverType::kAlternatingCg;
  Add(Wall(room), &room.graph);
  EXPECT_GT(TermOfSummary(SolveWindow(options, window, room.graph, &room.state), "wall").count,
            100u);
  options.type = SolverType::kReduced;
  EXPECT_THAT(SolveWindow(options, window, room.graph, &room.state).message, HasSubstr("\"wall\""));
}

TEST(CustomFactorTest, GivesAPoseThatNothingElseHoldsACovariance) {
  NoisyRoom room = DriftedRoom({});
  SolverOptions options;
  const int last = kNumPoses - 1;
  std::vector<Eigen::Matrix3d> covariances;
  const auto compute = [&] {
    return ComputePoseCovariances(options, room.graph, room.state, {{last, last}}, &covariances);
  };
  EXPECT_THAT(compute().message(), HasSubstr("nothing holds pose 15"));
  Add(Positions(room, 0.02), &room.graph);
  ASSERT_TRUE(compute().ok());
  // Eight positions of 0.02 m hold the room that the pose is in.
  EXPECT_NEAR(std::sqrt(covariances[0](0, 0)), 0.02 / std::sqrt(8.0), 0.005);
  options.type = SolverType::kAlternatingCg;
  Add(Wall(room), &room.graph);
  EXPECT_THAT(compute().message(), HasSubstr("\"wall\" sees points"));
}

TEST(CustomFactorTest, HasItsResidualsReported) {
  NoisyRoom room = DriftedRoom({0.2, -0.1, 0.0});
  SolverOptions options;
  Add(Positions(room, 0.05), &room.graph);
  Residuals residuals;
  ASSERT_TRUE(EvaluateResiduals(options, room.graph, room.state, &residuals).ok());
  ASSERT_EQ(residuals.others.size(), 1u);
  EXPECT_EQ(residuals.others[0].name, "position");
  EXPECT_EQ(residuals.others[0].size, 2);
  ASSERT_EQ(residuals.others[0].values.size(), 2u * kPosesPerRoom);
  EXPECT_NEAR(residuals.others[0].values[0], 4.0, 1e-9);
  EXPECT_NEAR(residuals.others[0].values[1], -2.0, 1e-9);
}

TEST(CustomFactorTest, IsRefusedBySolversThatLookAtRelativePosesOnly) {
  NoisyRoom room = DriftedRoom({});
  room.graph.AddRelativePose({0, 1, Between(room.truth[0], room.truth[1])});
  SolverOptions options;
  Add(Positions(room, 0.05), &room.graph);
  for (const SolverType type : {SolverType::kPoseGraph, SolverType::kSgd}) {
    options.type = type;
    ExpectRefused(options, room, {"\"position\"", ToString(type), "reduced"});
  }
}

// Undefined in the left half of the world, and throws on its far side.
struct Moody {
  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    if (pose[0] < T(-1.2)) throw std::runtime_error("no");
    using std::sqrt;
    residual[0] = sqrt(pose[0]);
    return true;
  }
};

TEST(CustomFactorTest, MistakesAreNamed) {
  const NoisyRoom room = DriftedRoom({});
  const Pose2 origin;
  const auto refuse = [&](const CustomFactor& factor, const std::string& word) {
    SlamGraph graph = room.graph;
    Add({PositionOf(1, origin, 0.1), factor}, &graph);
    EXPECT_EQ(graph.factors().size(), 1u);
    EXPECT_THAT(graph.status().message(), HasSubstr("factor 1 (\"" + factor.name + "\"): " + word));
  };
  refuse(PositionOf(99, origin, 0.1), "sees pose 99, but the graph has 16");
  refuse(PositionOf(-1, origin, 0.1), "sees pose -1");
  refuse(WallAt(1u << 30, 0.0, 0.1), "sees point 1073741824, but the graph has");
  refuse({"gps", nullptr, {1}, {}, nullptr}, "has no cost function");
  const auto cost = PositionOf(1, origin, 0.1).cost;
  refuse({"gps", cost, {1, 2}, {}, nullptr}, "sees 2 poses and 0 points, blocks of 3 and 2, but");
  refuse({"gps", cost, {}, {}, nullptr}, "sees neither a pose nor a point");
  refuse({"", cost, {1}, {}, nullptr}, "has no name");
  refuse({"ring",
          std::make_shared<ceres::AutoDiffCostFunction<Perimeter, 1, 3, 3, 2>>(new Perimeter),
          {2, 2},
          {1},
          nullptr},
         "sees a block twice");
  CustomFactor heading = HeadingOf(1, origin, 0.1);
  heading.name = "position";
  refuse(heading, "has 1 residuals, but the first of its name 2");
}

TEST(CustomFactorTest, WhatIsNotFiniteIsRefused) {
  NoisyRoom room = DriftedRoom({});
  Add({PositionOf(1, {kNaN, 0.0, 0.0}, 0.1)}, &room.graph);
  ExpectRefused(SolverOptions(), room, {"factor 0 (\"position\")", "not finite"});
}

TEST(CustomFactorTest, WhatThrowsOrIsUndefinedIsRefused) {
  const NoisyRoom room = DriftedRoom({});
  const auto moody = std::make_shared<ceres::AutoDiffCostFunction<Moody, 1, 3>>(new Moody);
  ASSERT_LT(room.state.WorldFromRobot(3).x, 0.0);
  ASSERT_LT(room.state.WorldFromRobot(4).x, -1.2);
  for (const int pose : {3, 4}) {
    NoisyRoom with_factor = room;
    with_factor.graph.AddFactor("moody", moody, {pose});
    ExpectRefused(SolverOptions(), with_factor,
                  {"factor 0 (\"moody\"): throws, fails or is not finite"});
  }
}

// A room whose map was made in a frame of its own, turned and moved against the world.
struct TurnedRoom {
  NoisyRoom room = DriftedRoom({});
  std::vector<Pose2> in_world;

  TurnedRoom() {
    const Pose2 world_from_map(120.0, -40.0, 2.2);
    for (const Pose2& pose : room.truth) in_world.push_back(world_from_map * pose);
  }
  double LargestErrorM(const MapState& state) const {
    double largest_m = 0.0;
    for (int i = 0; i < kNumPoses; ++i) {
      largest_m = std::max(largest_m, DistanceM(state.WorldFromRobot(i), in_world[i]));
    }
    return largest_m;
  }
};

TEST_P(OverLandmarks, PositionsMoveTheMapIntoTheWorld) {
  TurnedRoom turned;
  for (int i = 0; i < kNumPoses; ++i) {
    Add({PositionOf(i, turned.in_world[i], 1.0)}, &turned.room.graph);
  }
  EXPECT_TRUE(turned.room.graph.fixed_poses().empty());
  const SolverSummary summary =
      RefineState(GetParam().Options(), turned.room.graph, &turned.room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_LT(turned.LargestErrorM(turned.room.state), 0.02);
  EXPECT_LT(TermOfSummary(summary, "position").WhitenedRms(), 0.02);
}

TEST_P(OverPoints, PositionsMoveTheMapIntoTheWorld) {
  TurnedRoom turned;
  for (int i = 0; i < kNumPoses; ++i) {
    Add({PositionOf(i, turned.in_world[i], 1.0)}, &turned.room.graph);
  }
  const SolverSummary summary =
      RefineState(GetParam().Options(), turned.room.graph, &turned.room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_LT(turned.LargestErrorM(turned.room.state), 0.03);
}

TEST(CustomFactorTest, ACompassAloneTurnsTheMapAboutItsFirstPose) {
  TurnedRoom turned;
  Add({HeadingOf(3, turned.in_world[3], 0.01), HeadingOf(9, turned.in_world[9], 0.01)},
      &turned.room.graph);
  const Pose2 first = turned.room.graph.InitialPose(0);
  const SolverSummary summary = RefineState(SolverOptions(), turned.room.graph, &turned.room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  const Pose2 found = turned.room.state.WorldFromRobot(0);
  EXPECT_NEAR(found.x, first.x, 1e-3);
  EXPECT_NEAR(found.y, first.y, 1e-3);
  EXPECT_NEAR(NormalizeAngle(found.yaw - turned.in_world[0].yaw), 0.0, 0.01);
  EXPECT_LT(TermOfSummary(summary, "gauge").final_cost, 1e-3);
}

// The distance between two poses.
struct Distance {
  double distance_m;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    using std::sqrt;
    const T dx = a[0] - b[0], dy = a[1] - b[1];
    residual[0] = (sqrt(dx * dx + dy * dy) - distance_m) / 0.01;
    return true;
  }
};

TEST(CustomFactorTest, WhatSaysNothingOfTheWorldLeavesTheFirstPoseFixed) {
  NoisyRoom room = DriftedRoom({0.05, 0.0, 0.0});
  const double distance_m = DistanceM(room.truth[0], room.truth[9]);
  room.graph.AddFactor(
      "distance",
      std::make_shared<ceres::AutoDiffCostFunction<Distance, 1, 3, 3>>(new Distance{distance_m}),
      {0, 9});
  ASSERT_EQ(room.graph.fixed_poses().size(), 1u);
  const Pose2 first = room.graph.InitialPose(0);
  ASSERT_TRUE(RefineState(SolverOptions(), room.graph, &room.state).IsSolutionUsable());
  ExpectSamePose(room.state.WorldFromRobot(0), first);
}

TEST(CustomFactorTest, FixedPosesStayWhereTheyAreNamed) {
  TurnedRoom turned;
  Add({PositionOf(9, turned.in_world[9], 0.1)}, &turned.room.graph);
  turned.room.graph.FixPose(2);
  const Pose2 fixed = turned.room.graph.InitialPose(2);
  ASSERT_TRUE(
      RefineState(SolverOptions(), turned.room.graph, &turned.room.state).IsSolutionUsable());
  ExpectSamePose(turned.room.state.WorldFromRobot(2), fixed);
}

TEST(CustomFactorTest, IsServedByACalibration) {
  TurnedRoom turned;
  SlamGraph& graph = turned.room.graph;
  for (int i = 0; i < kNumPoses; ++i) Add({PositionOf(i, turned.in_world[i], 0.02)}, &graph);
  CalibrationOptions calibration;
  calibration.range_scale = true;
  // What a laser that reads 1 % too much measures.
  MeasurementCorrections too_long;
  for (const float range_m : graph.returns().range_m) too_long.range_m.push_back(1.01 * range_m);
  const SlamGraph scaled = graph.Corrected(too_long);
  MapState state{turned.room.state.poses, {}};
  Calibration found;
  const SolverSummary summary =
      SolveWithCalibration(SolverOptions(), calibration, scaled, &state, &found);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  ASSERT_EQ(found.parameters.size(), 1u);
  EXPECT_NEAR(found.parameters[0].value, 1.0 / 1.01, 0.003);
  EXPECT_LT(turned.LargestErrorM(state), 0.03);
}

}  // namespace
}  // namespace plumbline
