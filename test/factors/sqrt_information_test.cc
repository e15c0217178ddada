#include "plumbline/factors/sqrt_information.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "plumbline/core/slam_graph.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

TEST(SqrtInformation, InvertsStandardDeviationsOfADiagonal) {
  Eigen::Matrix3d u;
  ASSERT_TRUE(SqrtInformation(Eigen::Vector3d(0.25, 4.0, 0.01).asDiagonal(), &u));
  EXPECT_TRUE(u.isApprox(Eigen::Matrix3d(Eigen::Vector3d(2.0, 0.5, 10.0).asDiagonal())));
}

TEST(SqrtInformation, IsTheUpperCholeskyFactorOfTheInformation) {
  const Eigen::Matrix3d covariance = CorrelatedCovariance();
  Eigen::Matrix3d u;
  ASSERT_TRUE(SqrtInformation(covariance, &u));
  EXPECT_EQ(u(1, 0), 0.0);
  EXPECT_EQ(u(2, 0), 0.0);
  EXPECT_EQ(u(2, 1), 0.0);
  EXPECT_GT(u.diagonal().minCoeff(), 0.0);
  EXPECT_TRUE((u.transpose() * u).isApprox(covariance.inverse(), 1e-12));
  // The transposed factor, a common slip, weighs a correlated error differently.
  const Eigen::Vector3d e(0.1, -0.2, 0.05);
  const double mahalanobis = e.dot(covariance.inverse() * e);
  EXPECT_NEAR((u * e).squaredNorm(), mahalanobis, 1e-12 * mahalanobis);
  EXPECT_GT(std::abs((u.transpose() * e).squaredNorm() - mahalanobis), 0.1 * mahalanobis);
}

TEST(SqrtInformation, KeepsDigitsWhenScalesDiffer) {
  // Unit correlation structure at standard deviations of 100 m, 1 mm and 1e-5 rad.
  const Eigen::Vector3d sigmas(100.0, 1e-3, 1e-5);
  Eigen::Matrix3d correlation;
  correlation << 1.0, 0.5, -0.3, 0.5, 1.0, 0.2, -0.3, 0.2, 1.0;
  Eigen::Matrix3d u;
  ASSERT_TRUE(SqrtInformation(sigmas.asDiagonal() * correlation * sigmas.asDiagonal(), &u));
  const Eigen::Matrix3d scaled = u * sigmas.asDiagonal();
  EXPECT_TRUE((scaled.transpose() * scaled).isApprox(correlation.inverse(), 1e-12));
}

TEST(SqrtInformation, RefusesWhatIsNoCovariance) {
  const Eigen::Matrix3d untouched = Eigen::Matrix3d::Constant(7.0);
  Eigen::Matrix3d asymmetric = CorrelatedCovariance();
  asymmetric(0, 1) += 0.001;
  Eigen::Matrix3d singular = CorrelatedCovariance();
  singular.row(2) = singular.row(1);
  singular.col(2) = singular.col(1);
  Eigen::Matrix3d not_a_number = CorrelatedCovariance();
  not_a_number(2, 2) = kNaN;
  Eigen::Matrix3d infinite = CorrelatedCovariance();
  infinite(0, 0) = kInfinity;
  const Eigen::Matrix3d zero = Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d indefinite = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  for (const Eigen::Matrix3d& bad :
       {asymmetric, singular, not_a_number, infinite, zero, indefinite}) {
    Eigen::Matrix3d u = untouched;
    EXPECT_FALSE(SqrtInformation(bad, &u)) << bad;
    EXPECT_EQ(u, untouched);
  }
}

TEST(SqrtInformation, TakesWhateverCovarianceTheGraphTakes) {
  std::mt19937 engine(3);
  std::normal_distribution<double> gaussian;
  SlamGraph graph;
  int num_taken = 0;
  for (int pose = 0; pose < 2; ++pose) graph.AddPose(Pose2(), 0.0);
  for (int i = 0; i < 1000; ++i) {
    // Singular but for rounding: some of these factor in one order of the rows only.
    Eigen::Matrix<double, 3, 2> root;
    for (int k = 0; k < 6; ++k) root.data()[k] = gaussian(engine);
    const Eigen::Matrix3d covariance = root * root.transpose();
    graph.AddRelativePose({0, 1, Pose2(), covariance});
    if (!graph.TakeStatus().ok()) continue;
    ++num_taken;
    Eigen::Matrix3d unused;
    EXPECT_TRUE(SqrtInformation(covariance, &unused)) << covariance;
  }
  EXPECT_GT(num_taken, 100);
  EXPECT_LT(num_taken, 900);
}

}  // namespace
}  // namespace plumbline
