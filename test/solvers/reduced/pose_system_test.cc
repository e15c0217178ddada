#include "plumbline/solvers/reduced/pose_system.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

using testing::ElementsAre;

constexpr double kDamping = 1e-8;  // of the system, relative to its diagonal

/// Landmarks seen from a chain of poses with loops, by moments drawn by lot: none of the numbers is
/// special. The last pose is bound to nothing and sees nothing.
struct RandomProblem {
  SlamGraph graph;
  std::vector<double> poses;
  LineObservations observations;
  std::vector<LineLandmark> landmarks;
  FactorOptions factors;

  RandomProblem(int num_poses, int num_landmarks) {
    RandomStates random(31);
    for (int i = 0; i < num_poses; ++i) graph.AddPose(random.Pose(), i);
    for (int i = 0; i + 2 < num_poses; ++i) {
      const Pose2 motion = Between(graph.InitialPose(i), graph.InitialPose(i + 1)) *
                           Pose2(random.Gaussian(0.1), random.Gaussian(0.1), random.Gaussian(0.1));
      graph.AddOdometry({i, i + 1, motion});
      if (i % 4 != 1) continue;
      const int from = i % 8 == 1 ? i : i / 2, to = i % 8 == 1 ? i / 2 : i;  // both ways round
      graph.AddRelativePose({from, to, random.Pose(), CorrelatedCovariance()});
    }
    graph.FixPose(2);
    poses = graph.initial_poses();
    observations.first_of_landmark.push_back(0);
    for (int p = 0; p < num_landmarks; ++p) {
      AddLandmark(num_poses, p, &random);
      observations.first_of_landmark.push_back(observations.observations.size());
    }
    observations.first_of_pose.push_back(0);
    for (int pose = 0; pose < num_poses; ++pose) {
      for (std::size_t i = 0; i < observations.observations.size(); ++i) {
        if (observations.observations[i].pose == pose)
          observations.of_pose.push_back(static_cast<int>(i));
      }
      observations.first_of_pose.push_back(observations.of_pose.size());
    }
    ThreadPool pool(1);
    FitLandmarkLines(observations, Frames(), &pool, &landmarks);
  }

  // About 4 observations: positions along a line, give or take.
  void AddLandmark(int num_poses, int p, RandomStates* random) {
    LineLandmark landmark;
    landmark.origin = {random->Uniform(-5, 5), random->Uniform(-5, 5)};
    const Eigen::Vector2d tangent = random->Direction();
    const int stride = std::max(1, (num_poses - 1) / 4);
    for (int pose = p % stride; pose < num_poses - 1; pose += stride) {
      LineObservation s;
      s.pose = pose;
      s.landmark = p;
      s.weight = static_cast<float>(random->Uniform(1.0, 50.0));
      const Eigen::Vector2d in_world = landmark.origin + random->Uniform(-1, 1) * tangent +
                                       random->Gaussian(0.05) * random->Direction();
      s.center = (Pose2(&poses[3 * pose]).Inverse() * in_world).cast<float>();
      const Eigen::Vector2d a = random->Uniform(0.5, 3.0) * random->Direction();
      const Eigen::Vector2d b = random->Uniform(0.0, 0.3) * random->Direction();
      s.xx = static_cast<float>(a.x() * a.x() + b.x() * b.x());
      s.xy = static_cast<float>(a.x() * a.y() + b.x() * b.y());
      s.yy = static_cast<float>(a.y() * a.y() + b.y() * b.y());
      observations.observations.push_back(s);
    }
    landmarks.push_back(landmark);
  }

  std::vector<PoseFrame> Frames() const { return FramesOf(poses); }
  PoseTerms Terms() const { return PoseTerms(graph, factors); }
  Eigen::Index NumPoseUnknowns() const { return 3 * graph.num_poses(); }

  /// Of the unknowns, those of free poses: which of the full system have rows.
  std::vector<Eigen::Index> FreeUnknowns() const {
    const PoseTerms terms = Terms();
    std::vector<Eigen::Index> unknowns;
    for (Eigen::Index i = 0; i < NumPoseUnknowns(); ++i) {
      if (!terms.is_constant[i / 3]) unknowns.push_back(i);
    }
    return unknowns;
  }

  PoseSystem System(int num_threads = 2) const {
    ThreadPool pool(num_threads);
    PoseSystem system;
    system.Linearize(observations, landmarks, Terms(), poses, Frames(), &pool);
    return system;
  }

  /// The matrix that Apply multiplies by.
  Eigen::MatrixXd AppliedMatrix(const PoseSystem& system) const {
    ThreadPool pool(2);
    const Eigen::Index size = system.gradient.size();
    Eigen::MatrixXd matrix(size, size);
    Eigen::VectorXd column;
    for (Eigen::Index i = 0; i < matrix.cols(); ++i) {
      system.Apply(observations, Eigen::VectorXd::Unit(matrix.cols(), i), &pool, &column);
      matrix.col(i) = column;
    }
    return matrix;
  }

  /// All residuals at a state: poses, then per landmark the angle [rad] by which its line is turned
  /// against `landmarks` and its offset [m].
  Eigen::VectorXd Residuals(const Eigen::VectorXd& state) const {
    std::vector<double> residuals;
    for (const LineObservation& s : observations.observations) {
      const Eigen::Index line = NumPoseUnknowns() + 2 * s.landmark;
      const Eigen::Vector2d& n = landmarks[s.landmark].normal;
      const double c = std::cos(state[line]), sine = std::sin(state[line]);
      const Eigen::Vector2d normal(c * n.x() - sine * n.y(), sine * n.x() + c * n.y());
      const Pose2 pose(state.data() + 3 * s.pose);
      const Eigen::Vector2d point = pose * s.centroid();
      residuals.push_back(std::sqrt(s.weight) *
                          (normal.dot(point - landmarks[s.landmark].origin) - state[line + 1]));
      Eigen::Matrix2d scatter;
      scatter << s.xx, s.xy, s.xy, s.yy;
      const Eigen::Vector2d in_robot = Pose2(0, 0, -pose.yaw) * normal;
      const Eigen::Vector2d spread = scatter.llt().matrixU() * in_robot;
      residuals.insert(residuals.end(), {spread.x(), spread.y()});
    }
    for (const auto& term : Terms().terms) {
      std::vector<double> of_term(term->num_blocks() * term->residuals_per_block());
      term->Evaluate(Term::kNoScan, {state.data(), nullptr}, of_term.data());
      residuals.insert(residuals.end(), of_term.begin(), of_term.end());
    }
    return Eigen::Map<Eigen::VectorXd>(residuals.data(),
                                       static_cast<Eigen::Index>(residuals.size()));
  }

  Eigen::VectorXd State() const {
    Eigen::VectorXd state =
        Eigen::VectorXd::Zero(NumPoseUnknowns() + 2 * static_cast<Eigen::Index>(landmarks.size()));
    for (Eigen::Index i = 0; i < NumPoseUnknowns(); ++i) state[i] = poses[i];
    for (std::size_t p = 0; p < landmarks.size(); ++p) {
      state[NumPoseUnknowns() + 2 * static_cast<Eigen::Index>(p) + 1] = landmarks[p].offset_m;
    }
    return state;
  }
};

Eigen::MatrixXd NumericJacobian(const RandomProblem& problem) {
  constexpr double kStep = 1e-5;
  Eigen::VectorXd state = problem.State();
  Eigen::MatrixXd jacobian(problem.Residuals(state).size(), state.size());
  for (Eigen::Index i = 0; i < state.size(); ++i) {
    const double value = state[i];
    state[i] = value + kStep;
    const Eigen::VectorXd ahead = problem.Residuals(state);
    state[i] = value - kStep;
    jacobian.col(i) = (ahead - problem.Residuals(state)) / (2.0 * kStep);
    state[i] = value;
  }
  return jacobian;
}

// The rows of constant poses are dropped from the full system.
void ExpectSchurComplementOfTheFullSystem(const RandomProblem& problem) {
  const Eigen::MatrixXd jacobian = NumericJacobian(problem);
  const Eigen::VectorXd residuals = problem.Residuals(problem.State());
  const Eigen::MatrixXd full = jacobian.transpose() * jacobian;
  const Eigen::Index n = problem.NumPoseUnknowns(), m = full.cols() - n;
  Eigen::MatrixXd expected = full.topLeftCorner(n, n) -
                             full.topRightCorner(n, m) * full.bottomRightCorner(m, m).llt().solve(
                                                             full.bottomLeftCorner(m, n));
  for (Eigen::Index i = 0; i < n; ++i) {
    // A pose that nothing holds stays where it is.
    expected(i, i) = full(i, i) > 0.0 ? expected(i, i) + kDamping * full(i, i) : 1.0;
  }
  const PoseSystem system = problem.System();
  const Eigen::MatrixXd actual = problem.AppliedMatrix(system);
  const std::vector<Eigen::Index> unknowns = problem.FreeUnknowns();
  const Eigen::Index num_rows = static_cast<Eigen::Index>(unknowns.size());
  ASSERT_EQ(system.gradient.size(), num_rows);
  const Eigen::VectorXd scale = full.topLeftCorner(n, n).diagonal().cwiseMax(1.0).cwiseSqrt();
  const Eigen::VectorXd gradient = jacobian.transpose() * residuals;
  for (Eigen::Index row = 0; row < num_rows; ++row) {
    const Eigen::Index i = unknowns[row];
    for (Eigen::Index column = 0; column < num_rows; ++column) {
      const Eigen::Index k = unknowns[column];
      EXPECT_NEAR(actual(row, column), expected(i, k), 1e-7 * scale[i] * scale[k])
          << i << ", " << k;
    }
    EXPECT_NEAR(system.gradient[row], gradient[i], 1e-7 * scale[i] * residuals.norm()) << i;
  }
  // The lines fit best: their own gradient is zero.
  EXPECT_LT(gradient.tail(m).norm(), 1e-6 * gradient.norm());
}

TEST(PoseSystemTest, IsTheSchurComplementOfTheFullGaussNewtonSystem) {
  ExpectSchurComplementOfTheFullSystem(RandomProblem(9, 12));
}

TEST(PoseSystemTest, NeighbouringConstantPosesDropOutToo) {
  RandomProblem problem(9, 12);
  for (const int pose : {0, 3, 7}) problem.graph.FixPose(pose);
  ExpectSchurComplementOfTheFullSystem(problem);
}

// As in a window: its size is that of what moves, however many poses hold it.
TEST(PoseSystemTest, OnlyFreePosesHaveRows) {
  RandomProblem problem(9, 12);
  for (const int pose : {0, 1, 3, 4, 6, 8}) problem.graph.FixPose(pose);
  constexpr int kNone = PoseSystem::kConstant;
  const PoseSystem system = problem.System();
  EXPECT_THAT(system.pose_of_row, ElementsAre(5, 7));
  EXPECT_THAT(system.row_of_pose,
              ElementsAre(kNone, kNone, kNone, kNone, kNone, 0, kNone, 1, kNone));
  EXPECT_EQ(system.diagonal.size(), 2u);
  EXPECT_EQ(system.gradient.size(), 6);
  const Eigen::VectorXd step = Eigen::VectorXd::LinSpaced(6, 1.0, 6.0);
  const std::vector<double> moved = system.Moved(problem.poses, step);
  const Eigen::MatrixXd by_pose = system.ByPose(step);
  ASSERT_EQ(by_pose.rows(), problem.NumPoseUnknowns());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const int row = system.row_of_pose[i / 3];
    const double expected = row == kNone ? 0.0 : step[3 * row + static_cast<int>(i % 3)];
    EXPECT_EQ(by_pose(static_cast<Eigen::Index>(i), 0), expected) << i;
    EXPECT_EQ(moved[i], problem.poses[i] + expected) << i;
  }
}

TEST(PoseSystemTest, WithoutFreePosesThereAreNoRows) {
  RandomProblem problem(9, 12);
  for (int pose = 0; pose < 9; ++pose) problem.graph.FixPose(pose);
  const PoseSystem system = problem.System();
  EXPECT_EQ(system.gradient.size(), 0);
  EXPECT_EQ(problem.AppliedMatrix(system).size(), 0);
  EXPECT_EQ(system.Moved(problem.poses, Eigen::VectorXd()), problem.poses);
  EXPECT_TRUE(system.ByPose(Eigen::VectorXd()).isZero(0.0));
}

TEST(PoseSystemTest, TheGradientIsThatOfTheCostWithLinesRefitted) {
  RandomProblem problem(9, 12);
  const PoseSystem system = problem.System();
  const Eigen::VectorXd& gradient = system.gradient;
  const PoseTerms terms = problem.Terms();
  ThreadPool pool(1);
  const auto cost = [&] {
    return FitLandmarkLines(problem.observations, problem.Frames(), &pool, &problem.landmarks) +
           terms.Cost(problem.poses);
  };
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    constexpr double kStep = 1e-6;
    double& coordinate = problem.poses[3 * system.pose_of_row[i / 3] + i % 3];
    const double value = coordinate;
    coordinate = value + kStep;
    const double ahead = cost();
    coordinate = value - kStep;
    const double behind = cost();
    coordinate = value;
    EXPECT_NEAR(gradient[i], (ahead - behind) / (2.0 * kStep), 1e-5 * (1.0 + std::abs(gradient[i])))
        << i;
  }
}

/// What all observations of one landmark cost under a line.
double CostOfLine(const RandomProblem& problem, std::size_t p, double angle, double offset_m) {
  const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
  double cost = 0.0;
  for (const LineObservation& s : problem.observations.observations) {
    if (s.landmark != static_cast<int>(p)) continue;
    const Pose2 pose(&problem.poses[3 * s.pose]);
    const Eigen::Vector2d point = pose * s.centroid();
    const double distance = normal.dot(point - problem.landmarks[p].origin) - offset_m;
    const Eigen::Vector2d in_robot = Pose2(0, 0, -pose.yaw) * normal;
    cost += 0.5 * (s.weight * distance * distance + in_robot.dot(s.ScatterTimes(in_robot)));
  }
  return cost;
}

TEST(PoseSystemTest, FittedLinesCostLeastOfAllLines) {
  RandomProblem problem(9, 12);
  ThreadPool pool(1);
  const std::vector<LineLandmark> before = problem.landmarks;
  double total = 0.0;
  const double cost =
      FitLandmarkLines(problem.observations, problem.Frames(), &pool, &problem.landmarks);
  for (std::size_t p = 0; p < problem.landmarks.size(); ++p) {
    const LineLandmark& landmark = problem.landmarks[p];
    EXPECT_EQ(landmark.origin, before[p].origin);
    EXPECT_NEAR(landmark.normal.norm(), 1.0, 1e-14);
    const double fitted_angle = std::atan2(landmark.normal.y(), landmark.normal.x());
    const double fitted = CostOfLine(problem, p, fitted_angle, landmark.offset_m);
    total += fitted;
    for (double angle = 0.0; angle < kPi; angle += 0.02) {
      for (double offset_m = -0.5; offset_m <= 0.5; offset_m += 0.02) {
        EXPECT_LE(fitted, CostOfLine(problem, p, angle, offset_m));
      }
    }
    for (const double step : {-1e-4, 1e-4}) {
      EXPECT_LT(fitted, CostOfLine(problem, p, fitted_angle + step, landmark.offset_m));
      EXPECT_LT(fitted, CostOfLine(problem, p, fitted_angle, landmark.offset_m + step));
    }
  }
  EXPECT_NEAR(cost, total, 1e-8 * total);
}

TEST(PoseSystemTest, HeldLinesCostWhatTheySayAndCoupleNothing) {
  RandomProblem problem(9, 12);
  ThreadPool pool(1);
  double total = 0.0;
  for (std::size_t p = 0; p < problem.landmarks.size(); ++p) {
    LineLandmark& landmark = problem.landmarks[p];
    landmark.offset_m += 0.05;  // off where it fits best
    total += CostOfLine(problem, p, std::atan2(landmark.normal.y(), landmark.normal.x()),
                        landmark.offset_m);
  }
  const double cost =
      LandmarkLineCost(problem.observations, problem.Frames(), problem.landmarks, &pool);
  EXPECT_NEAR(cost, total, 1e-8 * total);
  const double fitted =
      FitLandmarkLines(problem.observations, problem.Frames(), &pool, &problem.landmarks);
  EXPECT_LT(fitted, cost);
  EXPECT_NEAR(LandmarkLineCost(problem.observations, problem.Frames(), problem.landmarks, &pool),
              fitted, 1e-10 * fitted);
}

TEST(PoseSystemTest, ALineWithoutWeightStaysAndMovesNothing) {
  RandomProblem problem(9, 12);
  for (LineObservation& s : problem.observations.observations) {
    s.weight = s.xx = s.xy = s.yy = 0.0;
  }
  const std::vector<LineLandmark> before = problem.landmarks;
  ThreadPool pool(1);
  EXPECT_EQ(FitLandmarkLines(problem.observations, problem.Frames(), &pool, &problem.landmarks),
            0.0);
  for (std::size_t p = 0; p < before.size(); ++p) {
    EXPECT_EQ(problem.landmarks[p].normal, before[p].normal);
    EXPECT_EQ(problem.landmarks[p].offset_m, before[p].offset_m);
  }
  const Eigen::MatrixXd matrix = problem.AppliedMatrix(problem.System());
  EXPECT_TRUE(matrix.allFinite());
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(matrix).info(), Eigen::Success);
}

TEST(PoseSystemTest, MovingTheWorldMovesNothingElse) {
  // Landmarks have origins of their own, so nothing is lost a thousand kilometres away.
  RandomProblem problem(9, 12);
  ThreadPool pool(1);
  const double cost =
      FitLandmarkLines(problem.observations, problem.Frames(), &pool, &problem.landmarks);
  for (std::size_t i = 0; i < problem.poses.size(); i += 3) problem.poses[i] += 1048576.0;
  for (LineLandmark& landmark : problem.landmarks) landmark.origin.x() += 1048576.0;
  EXPECT_NEAR(FitLandmarkLines(problem.observations, problem.Frames(), &pool, &problem.landmarks),
              cost, 1e-6 * cost);
}

TEST(PoseSystemTest, AnyNumberOfThreadsGivesTheSameBits) {
  RandomProblem problem(300, 600);
  ThreadPool one(1);
  const PoseSystem reference = problem.System(1);
  Eigen::VectorXd v(reference.gradient.size()), expected, product;
  RandomStates random(1);
  for (double& entry : v) entry = random.Uniform(-1, 1);
  reference.Apply(problem.observations, v, &one, &expected);
  std::vector<LineLandmark> lines = problem.landmarks, expected_lines = problem.landmarks;
  const double cost =
      FitLandmarkLines(problem.observations, problem.Frames(), &one, &expected_lines);
  for (const int num_threads : {2, 3, 8}) {
    ThreadPool pool(num_threads);
    const PoseSystem system = problem.System(num_threads);
    EXPECT_EQ(system.gradient, reference.gradient);
    system.Apply(problem.observations, v, &pool, &product);
    EXPECT_EQ(product, expected);
    EXPECT_EQ(FitLandmarkLines(problem.observations, problem.Frames(), &pool, &lines), cost);
    for (std::size_t p = 0; p < lines.size(); ++p) {
      EXPECT_EQ(lines[p].normal, expected_lines[p].normal);
      EXPECT_EQ(lines[p].offset_m, expected_lines[p].offset_m);
    }
  }
}

}  // namespace
}  // namespace plumbline
