#include "plumbline/core/line_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

namespace plumbline {
namespace {

struct WeightedPoint {
  Eigen::Vector2d position;
  double weight;
};

// An elongated random cloud in a random direction.
std::vector<WeightedPoint> RandomCloud(std::mt19937* engine) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double direction = 3.0 * uniform(*engine);
  const Eigen::Vector2d along(std::cos(direction), std::sin(direction));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d center(uniform(*engine), uniform(*engine));
  std::vector<WeightedPoint> cloud;
  for (int i = 0; i < 25; ++i) {
    const Eigen::Vector2d offset = uniform(*engine) * along + 0.2 * uniform(*engine) * across;
    cloud.push_back({center + offset, 1.5 + uniform(*engine)});
  }
  return cloud;
}

PointMoments MomentsOf(const std::vector<WeightedPoint>& cloud, const Eigen::Vector2d& origin) {
  PointMoments moments;
  for (const WeightedPoint& p : cloud) {
    const Eigen::Vector2d offset = p.position - origin;
    moments.Add(offset.x(), offset.y(), p.weight);
  }
  return moments;
}

// Two passes, centred before squaring, and Eigen's own decomposition.
LineFit BruteForceFit(const std::vector<WeightedPoint>& cloud) {
  double weight = 0.0;
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  for (const WeightedPoint& p : cloud) {
    weight += p.weight;
    centroid += p.weight * p.position;
  }
  centroid /= weight;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const WeightedPoint& p : cloud) {
    const Eigen::Vector2d offset = p.position - centroid;
    covariance += p.weight / weight * offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance);
  return {centroid, solver.eigenvectors().col(0), solver.eigenvalues()[0], solver.eigenvalues()[1]};
}

void ExpectSameLine(const LineFit& actual, const LineFit& expected, double tolerance) {
  EXPECT_LT((actual.centroid - expected.centroid).norm(), tolerance);
  EXPECT_NEAR(std::abs(actual.normal.dot(expected.normal)), 1.0, tolerance);
  EXPECT_NEAR(actual.normal.norm(), 1.0, 1e-14);
  EXPECT_NEAR(actual.smaller_eigenvalue, expected.smaller_eigenvalue, tolerance);
  EXPECT_NEAR(actual.larger_eigenvalue, expected.larger_eigenvalue, tolerance);
}

TEST(LineFit, AgreesWithAnEigenDecomposition) {
  std::mt19937 engine(7);
  for (int i = 0; i < 100; ++i) {
    const std::vector<WeightedPoint> cloud = RandomCloud(&engine);
    ExpectSameLine(FitLine(MomentsOf(cloud, Eigen::Vector2d::Zero())), BruteForceFit(cloud), 1e-13);
  }
}

TEST(LineFit, AgreesFarFromTheWorldsOriginIfMomentsAreTakenNearby) {
  std::mt19937 engine(8);
  const Eigen::Vector2d origin(5e5, -3e5);
  for (int i = 0; i < 20; ++i) {
    std::vector<WeightedPoint> cloud = RandomCloud(&engine);
    for (WeightedPoint& p : cloud) p.position += origin;
    LineFit fit = FitLine(MomentsOf(cloud, origin));
    fit.centroid += origin;
    ExpectSameLine(fit, BruteForceFit(cloud), 1e-9);
  }
}

TEST(LineFit, MomentsOfDisjointSetsAdd) {
  std::mt19937 engine(9);
  const std::vector<WeightedPoint> cloud = RandomCloud(&engine);
  const Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  PointMoments sum = MomentsOf({cloud.begin(), cloud.begin() + 10}, origin);
  sum += MomentsOf({cloud.begin() + 10, cloud.end()}, origin);
  ExpectSameLine(FitLine(sum), BruteForceFit(cloud), 1e-13);
}

TEST(LineFit, ExactLinesHaveNoThickness) {
  for (const double direction : {0.0, 0.5, 1.5707963267948966, 2.5}) {
    const Eigen::Vector2d along(std::cos(direction), std::sin(direction));
    PointMoments moments;
    for (const double t : {-1.0, 0.0, 1.0}) moments.Add(2.0 + t * along.x(), 3.0 + t * along.y());
    const LineFit fit = FitLine(moments);
    EXPECT_NEAR(fit.normal.dot(along), 0.0, 1e-14);
    EXPECT_NEAR(fit.larger_eigenvalue, 2.0 / 3.0, 1e-14);
    EXPECT_NEAR(fit.EigenvalueRatio(), 0.0, 1e-14);
    EXPECT_GE(fit.smaller_eigenvalue, 0.0);
  }
}

TEST(LineFit, RatioIsOneForASinglePointAndARoundBlob) {
  PointMoments moments;
  moments.Add(0.0, 0.0);
  EXPECT_EQ(FitLine(moments).EigenvalueRatio(), 1.0);
  EXPECT_TRUE(FitLine(moments).normal.allFinite());
  for (const double sign : {-1.0, 1.0}) {
    moments.Add(sign, 0.0);
    moments.Add(0.0, sign);
  }
  EXPECT_DOUBLE_EQ(FitLine(moments).EigenvalueRatio(), 1.0);
}

}  // namespace
}  // namespace plumbline
