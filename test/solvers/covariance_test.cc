#include "plumbline/solvers/covariance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr double kRangeSigmaM = 0.01, kOdometrySigma = 0.01;

// What a user would say of a room with flat walls and of this noise, which has no outliers.
SolverOptions ToldTheNoise() {
  SolverOptions options;
  options.num_threads = 1;
  options.factors.beam.sigma_range_m = kRangeSigmaM;
  options.factors.beam.sigma_bearing_rad = 1e-4;
  options.factors.manifold.sigma_m = 1e-3;
  options.factors.manifold.robust_gate_sigmas = 20.0;
  MotionOptions& motion = options.factors.motion;
  motion.rotation_per_rotation = motion.rotation_per_translation_rad_m = 1e-6;
  motion.translation_per_translation = motion.translation_per_rotation_m_rad = 1e-6;
  motion.translation_floor_m = motion.rotation_floor_rad = kOdometrySigma;
  return options;
}

// A drive through a room, at the truth but for the noise of its measurements.
NoisyRoom SimulatedRun(unsigned seed) {
  NoisyRoom room;
  SyntheticScene scene;
  scene.faces = {{{-3, -2}, {3, -2}},
                 {{3, -2}, {3, 2}},
                 {{3, 2}, {-3, 2}},
                 {{-3, 2}, {-3, -2}},
                 {{0, 0.8}, {0, 2}}};
  scene.laser = PanoramicLaser(180);
  scene.range_sigma_m = kRangeSigmaM;
  for (int i = 0; i < 8; ++i) {
    scene.poses.push_back({-2.0 + 0.5 * i, -0.5 + 0.05 * i, 0.2 * i});
  }
  room.truth = scene.poses;
  room.graph = MakeGraph(scene, seed);
  RandomStates random(seed + 1000);
  for (int i = 0; i + 1 < room.graph.num_poses(); ++i) {
    const Pose2 noise(random.Gaussian(kOdometrySigma), random.Gaussian(kOdometrySigma),
                      random.Gaussian(kOdometrySigma));
    room.graph.AddOdometry({i, i + 1, Between(scene.poses[i], scene.poses[i + 1]) * noise});
  }
  room.state = room.graph.InitialState();
  return room;
}

Eigen::Vector3d Difference(const Pose2& estimate, const Pose2& truth) {
  return {estimate.x - truth.x, estimate.y - truth.y, NormalizeAngle(estimate.yaw - truth.yaw)};
}

std::vector<Eigen::Matrix3d> CovariancesOf(const SlamGraph& graph, const MapState& state,
                                           const std::vector<PosePair>& pairs,
                                           const SolverOptions& options = ToldTheNoise()) {
  std::vector<Eigen::Matrix3d> covariances;
  const Status status = ComputePoseCovariances(options, graph, state, pairs, &covariances);
  EXPECT_TRUE(status.ok()) << status.message();
  return covariances;
}

// Normalised squared errors of many runs are chi-squared: three degrees of freedom each.
TEST(CovarianceTest, ErrorsOfAHundredRunsAreAsLargeAsTheCovariancesSay) {
  constexpr int kNumRuns = 100, kMiddle = 4, kLast = 7;
  double middle = 0.0, last = 0.0, relative = 0.0;
  for (unsigned run = 0; run < kNumRuns; ++run) {
    NoisyRoom room = SimulatedRun(run);
    ASSERT_TRUE(RefineState(ToldTheNoise(), room.graph, &room.state).IsSolutionUsable());
    const std::vector<Eigen::Matrix3d> c = CovariancesOf(
        room.graph, room.state, {{kMiddle, kMiddle}, {kMiddle, kLast}, {kLast, kLast}});
    const Pose2 a = room.state.WorldFromRobot(kMiddle), b = room.state.WorldFromRobot(kLast);
    const Eigen::Vector3d error_a = Difference(a, room.truth[kMiddle]);
    const Eigen::Vector3d error_b = Difference(b, room.truth[kLast]);
    const Eigen::Vector3d error_ab =
        Difference(Between(a, b), Between(room.truth[kMiddle], room.truth[kLast]));
    middle += error_a.dot(c[0].ldlt().solve(error_a)) / kNumRuns;
    last += error_b.dot(c[2].ldlt().solve(error_b)) / kNumRuns;
    relative +=
        error_ab.dot(RelativePoseCovariance(a, b, c[0], c[1], c[2]).ldlt().solve(error_ab)) /
        kNumRuns;
  }
  // 2.5 and 97.5 per cent of chi-squared with 300 degrees of freedom, over 100.
  constexpr double kLow = 2.539, kHigh = 3.499;
  for (const double nees : {middle, last, relative}) {
    EXPECT_GT(nees, kLow);
    EXPECT_LT(nees, kHigh);
  }
}

TEST(CovarianceTest, IsTheInverseOfTheFullMatrixWithAllItsParts) {
  NoisyRoom room = SimulatedRun(3);
  ASSERT_TRUE(RefineState(ToldTheNoise(), room.graph, &room.state).IsSolutionUsable());
  const int n = room.graph.num_poses();
  std::vector<PosePair> pairs;
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) pairs.push_back({a, b});
  }
  const std::vector<Eigen::Matrix3d> blocks = CovariancesOf(room.graph, room.state, pairs);
  Eigen::MatrixXd joint(3 * n, 3 * n);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    joint.block<3, 3>(3 * pairs[i].a, 3 * pairs[i].b) = blocks[i];
  }
  EXPECT_LT((joint - joint.transpose()).cwiseAbs().maxCoeff(), 1e-7 * joint.maxCoeff());
  // The first pose is known, the others are held by what they see.
  EXPECT_TRUE(joint.topRows<3>().isZero(0.0));
  EXPECT_TRUE(joint.leftCols<3>().isZero(0.0));
  const Eigen::MatrixXd free = joint.bottomRightCorner(3 * n - 3, 3 * n - 3);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(free).info(), Eigen::Success);
  EXPECT_GT(joint(3 * n - 3, 3 * n - 3), 1e-7);
  EXPECT_LT(joint(3 * n - 3, 3 * n - 3), kRangeSigmaM * kRangeSigmaM);
}

TEST(CovarianceTest, FixedPosesAreKnownExactlyAndShareNothing) {
  NoisyRoom room = SimulatedRun(2);
  const Eigen::Matrix3d loose = CovariancesOf(room.graph, room.state, {{4, 4}})[0];
  for (const int pose : {2, 5}) room.graph.FixPose(pose);
  const std::vector<Eigen::Matrix3d> c = CovariancesOf(
      room.graph, room.state, {{2, 2}, {5, 5}, {2, 5}, {2, 4}, {4, 2}, {5, 0}, {0, 5}, {4, 4}});
  for (int i = 0; i < 7; ++i) EXPECT_EQ(c[i], Eigen::Matrix3d::Zero()) << "pair " << i;
  // Between two poses that are known, another is known better than far from one.
  EXPECT_GT(c[7].diagonal().minCoeff(), 0.0);
  EXPECT_TRUE((c[7].diagonal().array() < loose.diagonal().array()).all());
  for (int pose = 0; pose < room.graph.num_poses(); ++pose) {
    room.graph.FixPose(pose);
  }
  EXPECT_EQ(CovariancesOf(room.graph, room.state, {{3, 3}})[0], Eigen::Matrix3d::Zero());
}

TEST(CovarianceTest, TheOnlyPoseIsTheFixedOne) {
  SyntheticScene scene;
  scene.faces = {{{2, -1}, {2, 1}}, {{-1, 2}, {1, 2}}};
  scene.poses = {{0.1, 0.2, 0.3}};
  const SlamGraph graph = MakeGraph(scene);
  EXPECT_EQ(CovariancesOf(graph, graph.InitialState(), {{0, 0}})[0], Eigen::Matrix3d::Zero());
}

TEST(CovarianceTest, OdometryAloneAddsUpAlongTheWay) {
  NoisyRoom room = SimulatedRun(1);
  SlamGraph graph;
  LaserModel laser = PanoramicLaser(8);
  graph.AddLaser(laser);
  for (int i = 0; i < 4; ++i) {
    graph.AddPose({1.0 * i, 0.0, 0.0}, i);
    if (i > 0) {
      graph.AddOdometry({i - 1, i, {1.0, 0.0, 0.0}});
    }
  }
  graph.AddScan(0, 0, std::vector<double>(8, 1.0));
  const Eigen::Matrix3d c = CovariancesOf(graph, graph.InitialState(), {{3, 3}})[0];
  const double step = kOdometrySigma * kOdometrySigma;
  EXPECT_NEAR(c(0, 0), 3.0 * step, 1e-3 * step);
  EXPECT_NEAR(c(2, 2), 3.0 * step, 1e-3 * step);
  // Headings of two poses before it, 2 m and 1 m away, turn what lies beyond them.
  EXPECT_NEAR(c(1, 1), 3.0 * step + (4.0 + 1.0) * step, 1e-3 * step);
  EXPECT_NEAR(c(1, 2), (2.0 + 1.0) * step, 1e-3 * step);
}

TEST(CovarianceTest, RelativeCovarianceOfAPoseToItselfIsNone) {
  const Pose2 pose(1.0, 2.0, 0.7);
  const Eigen::Matrix3d c = CorrelatedCovariance();
  EXPECT_LT(RelativePoseCovariance(pose, pose, c, c, c).norm(), 1e-12);
}

TEST(CovarianceTest, RelativeCovarianceFollowsFromTheDerivatives) {
  const Pose2 a(0.4, -1.0, 0.6), b(2.0, 0.5, -0.3);
  Eigen::Matrix<double, 3, 6> derivative;
  for (int i = 0; i < 6; ++i) {
    constexpr double kStep = 1e-6;
    const auto moved = [&](double step) {
      double v[6] = {a.x, a.y, a.yaw, b.x, b.y, b.yaw};
      v[i] += step;
      return Between(Pose2(v), Pose2(v + 3));
    };
    derivative.col(i) = Difference(moved(kStep), moved(-kStep)) / (2.0 * kStep);
  }
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Identity();
  root(4, 1) = 0.8;
  root(5, 0) = -0.4;
  root(3, 2) = 0.3;
  const Eigen::Matrix<double, 6, 6> joint = root * root.transpose();
  const Eigen::Matrix3d aa = joint.topLeftCorner<3, 3>(), ab = joint.topRightCorner<3, 3>(),
                        bb = joint.bottomRightCorner<3, 3>();
  EXPECT_LT((RelativePoseCovariance(a, b, aa, ab, bb) - derivative * joint * derivative.transpose())
                .norm(),
            1e-6);
}

TEST(CovarianceTest, IsTheSameForAnyNumberOfThreads) {
  const NoisyRoom room = SimulatedRun(5);
  SolverOptions several = ToldTheNoise();
  several.num_threads = 3;
  EXPECT_EQ(CovariancesOf(room.graph, room.state, {{2, 6}})[0],
            CovariancesOf(room.graph, room.state, {{2, 6}}, several)[0]);
}

TEST(CovarianceTest, APoseAlongABareCorridorIsHeldByItsOdometryOnly) {
  SyntheticScene scene;
  scene.faces = {{{-50, -1}, {50, -1}}, {{-50, 1}, {50, 1}}};
  scene.laser = PanoramicLaser(360);
  scene.laser.max_range_m = 6.0;
  scene.poses = {{0.0, 0.0, 0.0}, {0.5, 0.1, 0.1}, {1.0, 0.0, -0.1}};
  SlamGraph graph = MakeGraph(scene);
  const MapState state = graph.InitialState();
  std::vector<Eigen::Matrix3d> covariances;
  EXPECT_THAT(
      ComputePoseCovariances(ToldTheNoise(), graph, state, {{2, 2}}, &covariances).message(),
      HasSubstr("nothing holds pose 2 in every direction"));
  for (int i = 0; i < 2; ++i) {
    graph.AddOdometry({i, i + 1, Between(scene.poses[i], scene.poses[i + 1])});
  }
  const Eigen::Matrix3d c = CovariancesOf(graph, state, {{2, 2}})[0];
  EXPECT_NEAR(c(0, 0), 2.0 * kOdometrySigma * kOdometrySigma, 0.1 * c(0, 0));
  EXPECT_LT(c(1, 1), 0.01 * c(0, 0));
}

TEST(CovarianceTest, NamesWhatIsWrong) {
  NoisyRoom room = SimulatedRun(1);
  std::vector<Eigen::Matrix3d> covariances(1, Eigen::Matrix3d::Ones());
  const auto message = [&](const std::vector<PosePair>& pairs, const SolverOptions& options) {
    const Status status =
        ComputePoseCovariances(options, room.graph, room.state, pairs, &covariances);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(covariances.size(), 1u) << "must stay as it was";
    return status.message();
  };
  EXPECT_THAT(message({{0, 8}}, ToldTheNoise()), HasSubstr("pose 8, but the graph has 8 poses"));
  EXPECT_THAT(message({{-1, 0}}, ToldTheNoise()), HasSubstr("pose -1"));
  SolverOptions bad = ToldTheNoise();
  bad.factors.beam.sigma_range_m = 0.0;
  EXPECT_THAT(message({{1, 1}}, bad), HasSubstr("sigma_range_m"));
  room.graph.AddPose({100.0, 0.0, 0.0}, 99.0);
  room.graph.ExtendState(&room.state);
  EXPECT_THAT(message({{1, 1}}, ToldTheNoise()), HasSubstr("nothing ties pose 8"));
}

}  // namespace
}  // namespace plumbline
