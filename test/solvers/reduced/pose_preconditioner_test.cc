#include "plumbline/solvers/reduced/pose_preconditioner.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/terms/pose_terms.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

/// Poses along a ring of straight walls, each seeing those near by, and what Linearize makes of it.
class Drive {
 public:
  explicit Drive(int num_poses) {
    constexpr double kSpacing_m = 0.5;
    const double radius_m = std::max(3.0, num_poses * kSpacing_m / (2.0 * kPi));
    for (int i = 0; i < num_poses; ++i) {
      const double turn = i * kSpacing_m / radius_m;
      const Pose2 pose(radius_m * std::sin(turn), -radius_m * std::cos(turn), turn);
      graph_.AddPose(pose, i);
    }
    of_pose_.resize(num_poses);
  }

  void Join(int from, int to) {
    const Pose2 noise(random_.Gaussian(0.02), random_.Gaussian(0.02), random_.Gaussian(0.01));
    const Pose2 motion = Between(graph_.InitialPose(from), graph_.InitialPose(to)) * noise;
    graph_.AddOdometry({from, to, motion});
  }
  void JoinAll(int first, int last) {
    for (int i = first; i < last; ++i) Join(i, i + 1);
  }
  void CloseLoop(int from, int to, double covariance) {
    graph_.AddRelativePose({from, to, Between(graph_.InitialPose(from), graph_.InitialPose(to)),
                            covariance * CorrelatedCovariance()});
  }
  void Fix(int pose) { graph_.FixPose(pose); }

  /// A landmark beside pose `first`, seen by all poses from there to `last`.
  void AddLandmark(int first, int last) {
    const Eigen::Vector2d along = random_.Direction(), place(0.0, random_.Uniform(-3, 3));
    LineLandmark landmark;
    landmark.origin = graph_.InitialPose(first) * place;
    for (int pose = first; pose <= last; ++pose) {
      const Pose2 robot_from_world = graph_.InitialPose(pose).Inverse();
      const Eigen::Vector2d in_robot = Pose2(0, 0, robot_from_world.yaw) * along;
      LineObservation s;
      s.pose = pose;
      s.landmark = static_cast<int>(landmarks_.size());
      s.weight = static_cast<float>(random_.Uniform(1e4, 1e5));
      const Eigen::Vector2d in_world = landmark.origin + random_.Uniform(-0.3, 0.3) * along;
      s.center = (robot_from_world * in_world).cast<float>();
      s.xx = static_cast<float>(0.03 * s.weight * in_robot.x() * in_robot.x() + 1e-4 * s.weight);
      s.xy = static_cast<float>(0.03 * s.weight * in_robot.x() * in_robot.y());
      s.yy = static_cast<float>(0.03 * s.weight * in_robot.y() * in_robot.y() + 1e-4 * s.weight);
      of_pose_[pose].push_back(static_cast<int>(observations_.observations.size()));
      observations_.observations.push_back(s);
    }
    landmarks_.push_back(landmark);
    first_of_landmark_.push_back(observations_.observations.size());
  }
  /// Landmarks along the poses of a stretch, each seen by up to 10 of them.
  void AddWalls(int first, int last) {
    for (int pose = first; pose <= last; ++pose) {
      for (int k = 0; k < 3; ++k) AddLandmark(pose, std::min(last, pose + 9));
    }
  }

  /// After all is added: moves the poses by some noise, so that there is something to solve.
  void Linearize(double noise = 0.01) {
    std::vector<double> poses = graph_.initial_poses();
    // A drift that grows bends the drive in long waves, which neighbours hardly notice.
    double drift_m = 0.0;
    for (int i = 1; i < graph_.num_poses(); ++i) {
      drift_m += random_.Gaussian(noise);
      poses[3 * i] += random_.Gaussian(noise);
      poses[3 * i + 1] += drift_m;
      poses[3 * i + 2] += random_.Gaussian(noise);
    }
    observations_.first_of_landmark = first_of_landmark_;
    observations_.of_pose.clear();
    observations_.first_of_pose = {0};
    for (const std::vector<int>& of_pose : of_pose_) {
      observations_.of_pose.insert(observations_.of_pose.end(), of_pose.begin(), of_pose.end());
      observations_.first_of_pose.push_back(observations_.of_pose.size());
    }
    frames_ = FramesOf(poses);
    FitLandmarkLines(observations_, frames_, &pool_, &landmarks_);
    system_.Linearize(observations_, landmarks_, PoseTerms(graph_, FactorOptions()), poses, frames_,
                      &pool_);
  }

  /// Of the system: three rows per free pose.
  Eigen::Index size() const { return system_.gradient.size(); }

  /// The three entries of a pose in a vector of the system; zero for a fixed one.
  Eigen::Vector3d Of(int pose, const Eigen::VectorXd& x) const {
    return system_.ByPose(x).middleRows<3>(3 * pose);
  }

  Eigen::MatrixXd Matrix() {
    Eigen::MatrixXd matrix(size(), size());
    Eigen::VectorXd column;
    for (Eigen::Index i = 0; i < size(); ++i) {
      system_.Apply(observations_, Eigen::VectorXd::Unit(size(), i), &pool_, &column);
      matrix.col(i) = column;
    }
    return matrix;
  }

  /// P^-1.
  Eigen::MatrixXd PreconditionerMatrix() {
    const PosePreconditioner preconditioner(system_, observations_, frames_, &pool_);
    Eigen::MatrixXd matrix(size(), size());
    Eigen::VectorXd column;
    for (Eigen::Index i = 0; i < size(); ++i) {
      preconditioner.Apply(Eigen::VectorXd::Unit(size(), i), &column);
      matrix.col(i) = column;
    }
    return matrix;
  }

  Eigen::VectorXd Solve(double tolerance, int max_iterations, int* iterations,
                        int num_threads = 2) const {
    ThreadPool pool(num_threads);
    const PosePreconditioner preconditioner(system_, observations_, frames_, &pool);
    Eigen::VectorXd x;
    *iterations = SolvePoseSystem(system_, observations_, preconditioner, -system_.gradient,
                                  tolerance, max_iterations, &pool, &x)
                      .iterations;
    return x;
  }

  /// The preconditioner is symmetric positive definite, and the iteration arrives where a dense
  /// factorisation does. Gives the number of iterations.
  int ExpectSolves() {
    const Eigen::MatrixXd inverse = PreconditionerMatrix();
    EXPECT_LT((inverse - inverse.transpose()).norm(), 1e-6 * inverse.norm());
    const Eigen::VectorXd scale = inverse.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * inverse * scale.asDiagonal();
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().minCoeff(), 0.0);
    int iterations = 0;
    const Eigen::VectorXd x = Solve(1e-9, 2000, &iterations);
    const Eigen::MatrixXd matrix = Matrix();
    const Eigen::VectorXd expected = matrix.ldlt().solve(-system_.gradient);
    // In the norm of the system: free modes count for nothing.
    const Eigen::VectorXd error = x - expected;
    EXPECT_LT(error.dot(matrix * error), 1e-10 * expected.dot(matrix * expected));
    return iterations;
  }

  /// A force on poses that nothing holds moves them as one rigid body, and no other pose.
  void ExpectMovesRigidly(int first, int last) {
    const PosePreconditioner preconditioner(system_, observations_, frames_, &pool_);
    Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(size(), 3);
    for (int i = first; i <= last; ++i) {
      const Eigen::Vector2d arm = frames_[i].translation() - frames_[first].translation();
      rigid.middleRows<3>(3 * system_.row_of_pose[i]) << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x(), 0.0,
          0.0, 1.0;
    }
    for (int k = 0; k < 3; ++k) {
      Eigen::VectorXd moved;
      preconditioner.Apply(rigid.col(k), &moved);
      const Eigen::VectorXd share = rigid.colPivHouseholderQr().solve(moved);
      EXPECT_LT((moved - rigid * share).norm(), 1e-3 * moved.norm()) << k;
    }
  }

 private:
  SlamGraph graph_;
  RandomStates random_{13};
  LineObservations observations_;
  std::vector<LineLandmark> landmarks_;
  std::vector<std::size_t> first_of_landmark_{0};
  std::vector<std::vector<int>> of_pose_;
  std::vector<PoseFrame> frames_;
  ThreadPool pool_{2};
  PoseSystem system_;
};

TEST(PosePreconditionerTest, SolvesAChainWithLoopsInFewIterations) {
  Drive drive(90);
  drive.JoinAll(0, 89);
  drive.AddWalls(0, 89);
  drive.CloseLoop(0, 89, 1e-3);
  drive.CloseLoop(70, 20, 1e-2);
  drive.Linearize();
  EXPECT_LE(drive.ExpectSolves(), 80);
  int iterations = 0;
  drive.Solve(1e-2, 200, &iterations);
  EXPECT_LE(iterations, 12);
}

TEST(PosePreconditionerTest, IterationsDoNotGrowWithTheDrive) {
  int iterations[2];
  for (int i = 0; i < 2; ++i) {
    const int num_poses = i == 0 ? 100 : 1600;  // the second beyond the largest number of groups
    Drive drive(num_poses);
    drive.JoinAll(0, num_poses - 1);
    drive.AddWalls(0, num_poses - 1);
    drive.CloseLoop(0, num_poses - 1, 1e-3);
    drive.Linearize();
    drive.Solve(1e-2, 200, &iterations[i]);
  }
  EXPECT_LE(iterations[1], 2 * iterations[0]);
}

TEST(PosePreconditionerTest, TheChainAloneIsSolvedAtOnce) {
  // No lines, and too few poses for a second group: P differs from S by the group's share alone.
  Drive drive(6);
  drive.JoinAll(0, 5);
  drive.Linearize();
  EXPECT_LE(drive.ExpectSolves(), 8);
}

TEST(PosePreconditionerTest, SolvesOneFreePose) {
  Drive drive(2);
  for (int k = 0; k < 3; ++k) drive.AddLandmark(0, 1);
  drive.Linearize();
  ASSERT_EQ(drive.size(), 3);
  EXPECT_LE(drive.ExpectSolves(), 3);
}

TEST(PosePreconditionerTest, WithoutFreePosesThereIsNothingToSolve) {
  Drive drive(3);
  drive.JoinAll(0, 2);
  drive.AddWalls(0, 2);
  for (int pose = 0; pose < 3; ++pose) drive.Fix(pose);
  drive.Linearize();
  int iterations = 1;
  EXPECT_EQ(drive.Solve(1e-6, 10, &iterations).size(), 0);
  EXPECT_EQ(iterations, 0);
}

TEST(PosePreconditionerTest, SolvesIslands) {
  // The second stretch is joined to the first by nothing, and free to drift as a whole.
  Drive drive(40);
  drive.JoinAll(0, 19);
  drive.JoinAll(20, 39);
  drive.AddWalls(0, 19);
  drive.AddWalls(20, 39);
  drive.Linearize();
  EXPECT_LE(drive.ExpectSolves(), 100);
}

TEST(PosePreconditionerTest, AGroupThatNothingHoldsMovesRigidly) {
  Drive drive(25);
  for (const int first : {1, 9, 17}) {  // as free poses are grouped
    drive.JoinAll(first, first + 7);
    drive.AddWalls(first, first + 7);
  }
  drive.Linearize();
  for (const int first : {1, 9, 17}) drive.ExpectMovesRigidly(first, first + 7);
}

TEST(PosePreconditionerTest, LeavesPosesThatNothingSees) {
  Drive drive(30);
  drive.JoinAll(0, 11);
  drive.JoinAll(13, 28);
  drive.AddWalls(0, 11);
  drive.AddWalls(13, 28);
  drive.CloseLoop(5, 20, 1e-3);
  drive.Linearize();  // 12 and 29 are alone
  drive.ExpectSolves();
  int iterations = 0;
  const Eigen::VectorXd x = drive.Solve(1e-6, 500, &iterations);
  EXPECT_LT(drive.Of(12, x).norm(), 1e-5);
  EXPECT_LT(drive.Of(29, x).norm(), 1e-5);
}

TEST(PosePreconditionerTest, FixedPosesDoNotMove) {
  Drive drive(50);
  drive.JoinAll(0, 49);
  drive.AddWalls(0, 49);
  drive.Linearize();
  int iterations = 0;
  const Eigen::VectorXd free = drive.Solve(1e-6, 500, &iterations);
  Drive held(50);
  held.JoinAll(0, 49);
  held.AddWalls(0, 49);
  for (const int pose : {0, 20, 49}) held.Fix(pose);
  held.Linearize(0.0);
  EXPECT_LE(held.ExpectSolves(), 80);
  const Eigen::VectorXd x = held.Solve(1e-6, 500, &iterations);
  EXPECT_EQ(x.size(), 3 * 47);
  for (const int pose : {0, 20, 49}) EXPECT_EQ(held.Of(pose, x), Eigen::Vector3d::Zero()) << pose;
  EXPECT_NE(held.Of(21, x), Eigen::Vector3d::Zero());
  EXPECT_GT(drive.Of(49, free).norm(), 1e-3);
}

TEST(PosePreconditionerTest, TheLoopEndsAtTheToleranceOrTheLimit) {
  Drive drive(60);
  drive.JoinAll(0, 59);
  drive.AddWalls(0, 59);
  drive.Linearize();
  int loose = 0, tight = 0, limited = 0;
  drive.Solve(1e-1, 500, &loose);
  drive.Solve(1e-6, 500, &tight);
  drive.Solve(1e-6, 3, &limited);
  EXPECT_GT(loose, 0);
  EXPECT_LT(loose, tight);
  EXPECT_LT(tight, 500);
  EXPECT_EQ(limited, 3);
}

TEST(PosePreconditionerTest, AnyNumberOfThreadsGivesTheSameBits) {
  Drive drive(300);
  drive.JoinAll(0, 299);
  drive.AddWalls(0, 299);
  drive.Linearize();
  int expected_iterations = 0, iterations = 0;
  const Eigen::VectorXd expected = drive.Solve(1e-4, 100, &expected_iterations, 1);
  for (const int num_threads : {2, 3, 8}) {
    EXPECT_EQ(drive.Solve(1e-4, 100, &iterations, num_threads), expected);
    EXPECT_EQ(iterations, expected_iterations);
  }
}

}  // namespace
}  // namespace plumbline
