#include "plumbline/solvers/front_end/range_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr int kNumBeams = 181;
constexpr double kStepRad = DegToRad(1.0);

// Range from a place in a room of 8 m x 6 m to its walls.
double RangeToWalls(double x, double y, double bearing_rad) {
  const double c = std::cos(bearing_rad), s = std::sin(bearing_rad);
  const double across = c > 0.0 ? (8.0 - x) / c : x / std::max(-c, 1e-9);
  const double along = s > 0.0 ? (6.0 - y) / s : y / std::max(-s, 1e-9);
  return std::min(across, along);
}

// What becomes of the exact range of a beam; 0: no return.
using Reading = std::function<double(int beam, double range_m)>;

// Scans from all over the room.
SlamGraph Scans(int num_scans, const Reading& reading) {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = kNumBeams;
  laser.first_bearing_rad = DegToRad(-90.0);
  laser.bearing_step_rad = kStepRad;
  laser.max_range_m = 30.0;
  const int laser_id = graph.AddLaser(laser);
  for (int i = 0; i < num_scans; ++i) {
    const Pose2 here(1.0 + 0.013 * i, 1.0 + 0.009 * i, 0.0);
    const int pose = graph.AddPose(here, 0.1 * i);
    std::vector<double> ranges_m;
    for (int beam = 0; beam < kNumBeams; ++beam) {
      ranges_m.push_back(reading(beam, RangeToWalls(here.x, here.y, laser.Bearing(beam))));
    }
    graph.AddScan(pose, laser_id, ranges_m);
  }
  return graph;
}

class Noise {
 public:
  explicit Noise(double sigma_m) : error_m_(0.0, sigma_m) {}
  double operator()(double range_m) { return range_m + error_m_(source_); }

 private:
  std::mt19937 source_;
  std::normal_distribution<double> error_m_;
};

TEST(MeasureRangeNoise, IsThatOfTheReadings) {
  for (const double sigma_m : {0.003, 0.012, 0.03, 0.06}) {
    Noise noise(sigma_m);
    const SlamGraph graph = Scans(200, [&](int, double range_m) { return noise(range_m); });
    EXPECT_NEAR(MeasureRangeNoise(graph), sigma_m, 0.05 * sigma_m);
  }
}

TEST(MeasureRangeNoise, CountsTheRoundingOfReadings) {
  constexpr double kStepM = 0.05, kNoiseM = 0.02;
  Noise noise(kNoiseM);
  const SlamGraph graph =
      Scans(200, [&](int, double range_m) { return kStepM * std::round(noise(range_m) / kStepM); });
  const double sum_m = std::hypot(kNoiseM, kStepM / std::sqrt(12.0));
  EXPECT_NEAR(MeasureRangeNoise(graph), sum_m, 0.1 * sum_m);
}

TEST(MeasureRangeNoise, IsNotThatOfClutter) {
  // On a third of what the laser sees, leaves.
  Noise noise(0.01), leaves(0.2);
  const SlamGraph graph = Scans(200, [&](int beam, double range_m) {
    return noise(beam < kNumBeams / 3 ? leaves(range_m) : range_m);
  });
  EXPECT_GT(MeasureRangeNoise(graph), 0.01);
  EXPECT_LT(MeasureRangeNoise(graph), 0.02);
}

TEST(MeasureRangeNoise, IsUnknownWithoutNeighbouringBeams) {
  Noise noise(0.03);
  EXPECT_EQ(MeasureRangeNoise(SlamGraph()), 0.0);
  EXPECT_EQ(MeasureRangeNoise(Scans(1, [&](int, double range_m) { return noise(range_m); })), 0.0);
  EXPECT_EQ(
      MeasureRangeNoise(Scans(
          200, [&](int beam, double range_m) { return beam % 3 == 0 ? 0.0 : noise(range_m); })),
      0.0);
}

}  // namespace
}  // namespace plumbline
