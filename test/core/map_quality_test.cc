#include "plumbline/core/map_quality.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

MapQuality Measure(const std::vector<double>& points, const MapQualityOptions& options = {},
                   int num_threads = 1) {
  ThreadPool pool(num_threads);
  return MeasureMapQuality(points, options, &pool);
}

double Entropy(double determinant) { return 0.5 * std::log(determinant) + std::log(2.0 * kPi) + 1; }

// A wall of 20 m along a slanted line, its points off it by `sigma_m`.
std::vector<double> Wall(double sigma_m, int num_points) {
  std::mt19937 engine(1);
  std::normal_distribution<double> off(0.0, sigma_m);
  std::vector<double> points;
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (int i = 0; i < num_points; ++i) {
    const double u = 20.0 * i / num_points, v = off(engine);
    points.insert(points.end(), {100.0 + c * u - s * v, -50.0 + s * u + c * v});
  }
  return points;
}

std::vector<double> Blob(double sigma_m, int num_points) {
  std::mt19937 engine(2);
  std::normal_distribution<double> gaussian(0.0, sigma_m);
  std::vector<double> points(2 * num_points);
  for (double& coordinate : points) coordinate = gaussian(engine);
  return points;
}

std::vector<double> Clutter(int num_points) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  std::vector<double> points(2 * num_points);
  for (double& coordinate : points) coordinate = uniform(engine);
  return points;
}

TEST(MapQualityTest, ThicknessOfAWallIsItsSigma) {
  for (const double sigma_m : {0.005, 0.02}) {
    EXPECT_NEAR(Measure(Wall(sigma_m, 100000)).wall_thickness_m, sigma_m, 0.02 * sigma_m);
  }
}

// Within a radius R of a point on a thin line, the others are uniform over 2 R: variance R^2 / 3.
TEST(MapQualityTest, EntropyOfAThinWallIsThatOfItsStretchAndThickness) {
  const MapQualityOptions options;
  const double sigma_m = 0.002, along_m2 = options.radius_m * options.radius_m / 3.0;
  EXPECT_NEAR(Measure(Wall(sigma_m, 100000), options).mean_map_entropy,
              Entropy(sigma_m * sigma_m * along_m2), 0.03);
}

// A radius that holds all of a Gaussian blob sees its covariance at every sample.
TEST(MapQualityTest, EntropyOfAGaussianBlob) {
  MapQualityOptions options;
  options.radius_m = 1.0;
  const double sigma_m = 0.05;
  const MapQuality quality = Measure(Blob(sigma_m, 20000), options);
  EXPECT_NEAR(quality.mean_map_entropy, Entropy(std::pow(sigma_m, 4)), 0.02);
  EXPECT_NEAR(quality.wall_thickness_m, sigma_m, 0.02 * sigma_m);
}

TEST(MapQualityTest, ADoubledWallIsThickerByHalfItsGap) {
  std::vector<double> points;
  for (int i = 0; i < 4000; ++i) points.insert(points.end(), {0.002 * i, i % 2 == 0 ? 0.0 : 0.06});
  EXPECT_NEAR(Measure(points).wall_thickness_m, 0.03, 0.001);
}

TEST(MapQualityTest, AgreesWithBruteForce) {
  MapQualityOptions options;
  options.radius_m = 0.3;
  const std::vector<double> points = Clutter(1200);
  std::vector<double> thicknesses;
  double entropy = 0.0;
  for (std::size_t i = 0; i < points.size(); i += 2) {
    std::vector<Eigen::Vector2d> near;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (std::size_t j = 0; j < points.size(); j += 2) {
      if (std::hypot(points[j] - points[i], points[j + 1] - points[i + 1]) > options.radius_m) {
        continue;
      }
      near.emplace_back(points[j], points[j + 1]);
      mean += near.back();
    }
    if (near.size() < 10) continue;
    mean /= static_cast<double>(near.size());
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const Eigen::Vector2d& p : near) covariance += (p - mean) * (p - mean).transpose();
    covariance /= static_cast<double>(near.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance);
    thicknesses.push_back(std::sqrt(solver.eigenvalues()[0]));
    entropy += Entropy(covariance.determinant());
  }
  ASSERT_GT(thicknesses.size(), 1000u);
  ASSERT_LT(thicknesses.size(), 1200u);  // some neighbourhoods, in the corners, are too small
  std::sort(thicknesses.begin(), thicknesses.end());

  // Points are kept to some nanometres.
  const MapQuality quality = Measure(points, options);
  EXPECT_EQ(quality.num_samples, thicknesses.size());
  EXPECT_NEAR(quality.wall_thickness_m, thicknesses[thicknesses.size() / 2], 1e-6);
  EXPECT_NEAR(quality.mean_map_entropy, entropy / thicknesses.size(), 1e-6);
}

TEST(MapQualityTest, NothingToMeasureGivesZero) {
  for (const auto& points : {std::vector<double>{}, Wall(0.0, 9), Clutter(5)}) {
    const MapQuality quality = Measure(points);
    EXPECT_EQ(quality.num_samples, 0u);
    EXPECT_EQ(quality.wall_thickness_m, 0.0);
    EXPECT_EQ(quality.mean_map_entropy, 0.0);
  }
}

TEST(MapQualityTest, PointsOnTopOfEachOtherHaveAFiniteEntropy) {
  const MapQuality quality = Measure(std::vector<double>(40, 1.25));
  EXPECT_EQ(quality.num_samples, 20u);
  EXPECT_EQ(quality.wall_thickness_m, 0.0);
  EXPECT_NEAR(quality.mean_map_entropy, Entropy(1e-16), 1e-12);
}

TEST(MapQualityTest, DoesNotDependOnTheNumberOfThreads) {
  const std::vector<double> points = Clutter(20000);
  const MapQuality one = Measure(points, {}, 1), three = Measure(points, {}, 3);
  EXPECT_EQ(one.num_samples, three.num_samples);
  EXPECT_EQ(one.wall_thickness_m, three.wall_thickness_m);
  EXPECT_EQ(one.mean_map_entropy, three.mean_map_entropy);
}

// The first half of the points is a thin wall, the second half a thick one: samples taken evenly
// see both, and their median lies between.
TEST(MapQualityTest, SamplesAreTakenFromAllPoints) {
  std::vector<double> points = Wall(0.004, 20000);
  std::vector<double> thick = Wall(0.02, 20000);
  for (double& coordinate : thick) coordinate += 1000.0;
  points.insert(points.end(), thick.begin(), thick.end());
  const MapQuality quality = Measure(points);
  EXPECT_EQ(quality.num_samples, 20000u);  // of 40000

  const double thin = Entropy(0.004 * 0.004 * 0.0075), wide = Entropy(0.02 * 0.02 * 0.0075);
  EXPECT_NEAR(quality.mean_map_entropy, 0.5 * (thin + wide), 0.1);
}

TEST(MapQualityTest, ChecksItsOptions) {
  std::string error;
  EXPECT_TRUE(MapQualityOptions().Check(&error));
  MapQualityOptions options;
  options.radius_m = 0.0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_EQ(error, "radius_m = 0, but it must be > 0.0");
}

TEST(MapQualityTest, ProcessesThatShareAGraphMeasureItsPointsTogether) {
  SyntheticScene scene;
  scene.faces = {{{0, 0}, {8, 0}}, {{8, 0}, {8, 5}}, {{8, 5}, {0, 5}}, {{0, 5}, {0, 0}}};
  for (int i = 0; i < 40; ++i) scene.poses.emplace_back(1.0 + 0.15 * i, 2.0, 0.1 * i);
  scene.range_sigma_m = 0.01;
  const SlamGraph graph = MakeGraph(scene);
  const MapState state = graph.InitialState();
  const MapQuality expected = Measure(state.points);
  ASSERT_GT(expected.num_samples, 10000u);
  RunOnParts(graph, 3, [&](const SlamGraph& part) {
    ThreadPool pool(1);
    const MapQuality quality =
        MeasureMapQuality(part, part.InitialState().points, MapQualityOptions(), &pool);
    EXPECT_EQ(quality.num_samples, expected.num_samples);
    EXPECT_NEAR(quality.wall_thickness_m, expected.wall_thickness_m, 1e-9);
    EXPECT_NEAR(quality.mean_map_entropy, expected.mean_map_entropy, 1e-9);
  });
}

}  // namespace
}  // namespace plumbline
