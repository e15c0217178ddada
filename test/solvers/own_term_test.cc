// Residuals of a host's own behind Solve: positions, a compass and a wall that is known. What a
// host writes is all above the tests.

#include "plumbline/factors/own_term.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
#include "plumbline/solvers/terms/own_terms.h"
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
OwnResidual PositionOf(int pose, const Pose2& at, double sigma_m) {
  return {std::make_shared<ceres::AutoDiffCostFunction<Position, 2, 3>>(
              new Position{at.x, at.y, sigma_m}),
          {pose},
          {}};
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
OwnResidual HeadingOf(int pose, const Pose2& at, double sigma_rad) {
  return {
      std::make_shared<ceres::AutoDiffCostFunction<Heading, 1, 3>>(new Heading{at.yaw, sigma_rad}),
      {pose},
      {}};
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
OwnResidual WallAt(std::size_t point, double x_m, double sigma_m) {
  return {std::make_shared<ceres::AutoDiffCostFunction<OnWall, 1, 2>>(new OnWall{x_m, sigma_m}),
          {},
          {point}};
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

std::shared_ptr<OwnTerm> TermOfResiduals(const char* name, std::vector<OwnResidual> residuals) {
  auto term = std::make_shared<OwnTerm>();
  term->name = name;
  term->residuals = std::move(residuals);
  return term;
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
std::shared_ptr<OwnTerm> Positions(const NoisyRoom& room, double sigma_m) {
  std::vector<OwnResidual> residuals;
  for (int i = kPosesPerRoom; i < kNumPoses; ++i) {
    residuals.push_back(PositionOf(i, room.truth[i], sigma_m));
  }
  return TermOfResiduals("position", std::move(residuals));
}

// The far wall of the second room, for what its first pose sees of it.
std::shared_ptr<OwnTerm> Wall(const NoisyRoom& room) {
  const double wall_x = kSecondRoomX + 3.0;
  const MapState truth{PoseArray(room.truth), room.graph.MeasuredMap(PoseArray(room.truth))};
  std::vector<OwnResidual> residuals;
  for (std::size_t r = 0; r < room.graph.num_returns(); ++r) {
    const Eigen::Vector2d point = MapPoint(truth, r);
    if (std::abs(point.x() - wall_x) < 0.05 && std::abs(point.y()) < 1.9) {
      residuals.push_back(WallAt(r, wall_x, 0.001));
    }
  }
  EXPECT_GT(residuals.size(), 100u);
  return TermOfResiduals("wall", std::move(residuals));
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
INSTANTIATE_TEST_SUITE_P(OwnTerm, OverLandmarks, testing::ValuesIn(kOverLandmarks),
                         [](const auto& info) { return std::string(info.param.name); });
class OverPoints : public testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(OwnTerm, OverPoints, testing::ValuesIn(kOverPoints),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(OverLandmarks, PositionsPullADriftedMapIntoPlace) {
  NoisyRoom room = DriftedRoom({0.2, -0.1, 0.03});
  SolverOptions options = GetParam().Options();
  options.factors.own_terms = {Positions(room, 0.05)};
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
  SolverOptions options = GetParam().Options();
  const int pose = kPosesPerRoom + 2;
  options.factors.own_terms = {
      TermOfResiduals("position", {PositionOf(pose, room.truth[pose], 0.01)}),
      TermOfResiduals("compass", {HeadingOf(pose, room.truth[pose], 0.001)})};
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.02);
  EXPECT_NEAR(room.state.WorldFromRobot(pose).yaw, room.truth[pose].yaw, 0.005);
}

TEST_P(OverLandmarks, RefuseWhatSeesPoints) {
  const NoisyRoom room = DriftedRoom({0.05, 0.0, 0.0});
  SolverOptions options = GetParam().Options();
  options.factors.own_terms = {Wall(room)};
  ExpectRefused(options, room, {"\"wall\"", "points", "alternating_cg"});
}

// In rounds the lines hold the map back until the next one, so sigmas are small and so is the
// drift.
TEST_P(OverPoints, PositionsPullADriftedMapIntoPlace) {
  NoisyRoom room = DriftedRoom({0.03, -0.02, 0.0});
  const double before_m = SecondRoomError(room);
  SolverOptions options = GetParam().Options();
  options.factors.own_terms = {Positions(room, 0.001)};
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.4 * before_m);
  EXPECT_EQ(TermOfSummary(summary, "position").count, static_cast<std::size_t>(kPosesPerRoom));
}

TEST_P(OverPoints, AKnownWallPullsItsPoints) {
  NoisyRoom room = DriftedRoom({0.03, 0.0, 0.0});
  const double before_m = SecondRoomError(room);
  SolverOptions options = GetParam().Options();
  options.factors.own_terms = {Wall(room)};
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.6 * before_m);
  const TermSummary term = TermOfSummary(summary, "wall");
  EXPECT_GT(term.count, 100u);
  EXPECT_LT(term.WhitenedRms(), 1.0);
}

TEST(OwnTerm, CostsAndDerivativesAreThoseOfCeres) {
  NoisyRoom room = DriftedRoom({0.03, -0.02, 0.01});
  FactorOptions factors;
  const auto perimeter =
      std::make_shared<ceres::AutoDiffCostFunction<Perimeter, 1, 3, 3, 2>>(new Perimeter);
  const auto loss = std::make_shared<ceres::CauchyLoss>(1.5);
  factors.own_terms = {Positions(room, 0.01), Wall(room),
                       TermOfResiduals("perimeter", {{perimeter, {2, 5}, {77}, loss},
                                                     {perimeter, {9, 3}, {1400}, loss}})};
  factors.own_terms.push_back(TermOfResiduals("robust", {PositionOf(3, {}, 0.1)}));
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

TEST(OwnTerm, TheReducedSystemHasItToo) {
  const NoisyRoom room = DriftedRoom({0.03, -0.02, 0.01});
  FactorOptions factors;
  auto robust = PositionOf(4, {}, 0.1);
  robust.loss = std::make_shared<ceres::CauchyLoss>(1.5);
  factors.own_terms = {Positions(room, 0.01), TermOfResiduals("robust", {robust})};
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

TEST(OwnTerm, IsInWindowsAsFarAsItSeesThem) {
  NoisyRoom room = DriftedRoom({0.2, -0.1, 0.0});
  SolverOptions options;
  const auto positions = Positions(room, 0.05);
  positions->residuals.push_back(PositionOf(0, room.truth[0], 0.05));  // of a pose outside
  options.factors.own_terms = {positions};
  WindowOptions window;
  window.num_free_poses = kPosesPerRoom;
  const SolverSummary summary = SolveWindow(options, window, room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_LT(SecondRoomError(room), 0.02);
  EXPECT_EQ(TermOfSummary(summary, "position").count, static_cast<std::size_t>(kPosesPerRoom));

  options.type = SolverType::kAlternatingCg;
  options.factors.own_terms = {Wall(room)};
  EXPECT_GT(TermOfSummary(SolveWindow(options, window, room.graph, &room.state), "wall").count,
            100u);
  options.type = SolverType::kReduced;
  EXPECT_THAT(SolveWindow(options, window, room.graph, &room.state).message, HasSubstr("\"wall\""));
  positions->residuals.push_back(PositionOf(99, {}, 0.05));
  options.factors.own_terms = {positions};
  EXPECT_THAT(SolveWindow(options, window, room.graph, &room.state).message, HasSubstr("pose 99"));
}

TEST(OwnTerm, GivesAPoseThatNothingElseHoldsACovariance) {
  const NoisyRoom room = DriftedRoom({});
  SolverOptions options;
  const int last = kNumPoses - 1;
  std::vector<Eigen::Matrix3d> covariances;
  const auto compute = [&] {
    return ComputePoseCovariances(options, room.graph, room.state, {{last, last}}, &covariances);
  };
  EXPECT_THAT(compute().message(), HasSubstr("nothing holds pose 15"));
  options.factors.own_terms = {Positions(room, 0.02)};
  ASSERT_TRUE(compute().ok());
  // Eight positions of 0.02 m hold the room that the pose is in.
  EXPECT_NEAR(std::sqrt(covariances[0](0, 0)), 0.02 / std::sqrt(8.0), 0.005);
  options.type = SolverType::kAlternatingCg;
  options.factors.own_terms = {Wall(room)};
  EXPECT_THAT(compute().message(), HasSubstr("\"wall\" sees points"));
}

TEST(OwnTerm, HasItsResidualsReported) {
  const NoisyRoom room = DriftedRoom({0.2, -0.1, 0.0});
  SolverOptions options;
  options.factors.own_terms = {Positions(room, 0.05)};
  Residuals residuals;
  ASSERT_TRUE(EvaluateResiduals(options, room.graph, room.state, &residuals).ok());
  ASSERT_EQ(residuals.others.size(), 1u);
  EXPECT_EQ(residuals.others[0].name, "position");
  EXPECT_EQ(residuals.others[0].size, 2);
  ASSERT_EQ(residuals.others[0].values.size(), 2u * kPosesPerRoom);
  EXPECT_NEAR(residuals.others[0].values[0], 4.0, 1e-9);
  EXPECT_NEAR(residuals.others[0].values[1], -2.0, 1e-9);
}

TEST(OwnTerm, IsRefusedBySolversThatLookAtRelativePosesOnly) {
  NoisyRoom room = DriftedRoom({});
  room.graph.AddRelativePose({0, 1, Between(room.truth[0], room.truth[1])});
  SolverOptions options;
  options.factors.own_terms = {Positions(room, 0.05)};
  for (const SolverType type : {SolverType::kPoseGraph, SolverType::kSgd}) {
    options.type = type;
    ExpectRefused(options, room, {"\"position\"", ToString(type), "reduced"});
  }
  CalibrationOptions calibration;
  calibration.range_bias = true;
  Calibration found;
  EXPECT_THAT(
      SolveWithCalibration(SolverOptions(options), calibration, room.graph, &room.state, &found)
          .message,
      HasSubstr("\"position\""));
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

TEST(OwnTerm, MistakesAreNamed) {
  const NoisyRoom room = DriftedRoom({});
  const Pose2 origin;
  const auto refuse = [&](OwnResidual residual, const std::string& word) {
    SolverOptions options;
    options.factors.own_terms = {
        TermOfResiduals("gps", {PositionOf(1, origin, 0.1), std::move(residual)})};
    ExpectRefused(options, room, {"\"gps\": residual 1 ", word});
  };
  refuse(PositionOf(99, origin, 0.1), "sees pose 99, but the graph has 16");
  refuse(PositionOf(-1, origin, 0.1), "sees pose -1");
  refuse({nullptr, {1}, {}}, "no cost function");
  refuse({PositionOf(1, origin, 0.1).cost, {1, 2}, {}}, "blocks of 3");
  refuse({PositionOf(1, origin, 0.1).cost, {}, {}}, "neither a pose nor a point");
  refuse({std::make_shared<ceres::AutoDiffCostFunction<Perimeter, 1, 3, 3, 2>>(new Perimeter),
          {2, 2},
          {1}},
         "sees a block twice");
  refuse(HeadingOf(1, origin, 0.1), "has 1 rows, but the first one 2");
  refuse(PositionOf(1, {kNaN, 0.0, 0.0}, 0.1), "not finite");

  SolverOptions options;
  options.type = SolverType::kAlternatingCg;
  options.factors.own_terms = {TermOfResiduals("wall", {WallAt(1u << 30, 0.0, 0.1)})};
  ExpectRefused(options, room, {"sees point", "returns"});
  options.factors.own_terms = {TermOfResiduals("", {})};
  ExpectRefused(options, room, {"no name"});
  options.factors.own_terms = {nullptr};
  ExpectRefused(options, room, {"term"});
}

TEST(OwnTerm, WhatThrowsOrIsUndefinedIsRefused) {
  const NoisyRoom room = DriftedRoom({});
  SolverOptions options;
  const auto moody = std::make_shared<ceres::AutoDiffCostFunction<Moody, 1, 3>>(new Moody);
  ASSERT_LT(room.state.WorldFromRobot(3).x, 0.0);
  ASSERT_LT(room.state.WorldFromRobot(4).x, -1.2);
  for (const int pose : {3, 4}) {
    options.factors.own_terms = {TermOfResiduals("moody", {{moody, {pose}, {}}})};
    ExpectRefused(options, room, {"\"moody\": residual 0 throws, fails or is not finite"});
  }
}

TEST(OwnTerm, WithoutResidualsChangesNothing) {
  NoisyRoom room = DriftedRoom({0.1, 0.0, 0.0});
  DisturbPoses(0.02, room.graph, &room.state);
  MapState other = room.state;
  SolverOptions options;
  RefineState(options, room.graph, &room.state);
  options.factors.own_terms = {TermOfResiduals("empty", {})};
  const SolverSummary summary = RefineState(options, room.graph, &other);
  EXPECT_EQ(TermOfSummary(summary, "empty").count, 0u);
  EXPECT_EQ(other, room.state);
}

}  // namespace
}  // namespace plumbline
