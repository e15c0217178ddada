#include "plumbline/core/no_return_level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr double kStepRad = DegToRad(1.0);

// Sweeps of 360 beams in a square room of 12 m, from places along its middle.
std::vector<std::vector<double>> Room(int num_sweeps) {
  std::vector<std::vector<double>> sweeps(num_sweeps);
  for (int s = 0; s < num_sweeps; ++s) {
    const double x = -2.0 + 4.0 * s / num_sweeps;
    for (int beam = 0; beam < 360; ++beam) {
      const double c = std::cos(beam * kStepRad), w = std::sin(beam * kStepRad);
      const double along = (c > 0.0 ? 6.0 - x : 6.0 + x) / std::max(1e-9, std::abs(c));
      sweeps[s].push_back(std::min(along, 6.0 / std::max(1e-9, std::abs(w))));
    }
  }
  return sweeps;
}

// Every `each`-th beam, others in each sweep, reads the level. Gives the lowest of these readings.
double AddNoReturns(double level_m, double noise_m, int each,
                    std::vector<std::vector<double>>* sweeps) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, noise_m);
  double lowest_m = level_m;
  for (std::size_t s = 0; s < sweeps->size(); ++s) {
    std::vector<double>& ranges = (*sweeps)[s];
    for (std::size_t beam = s % each; beam < ranges.size(); beam += each) {
      ranges[beam] = level_m + (noise_m > 0.0 ? noise(random) : 0.0);
      lowest_m = std::min(lowest_m, ranges[beam]);
    }
  }
  return lowest_m;
}

std::optional<double> Level(const std::vector<std::vector<double>>& sweeps, double max_range_m) {
  std::vector<SweepReadings> readings;
  for (const std::vector<double>& ranges : sweeps) {
    readings.push_back({&ranges, kStepRad, max_range_m});
  }
  return FindNoReturnLevel(readings);
}

// No reading of the level is left below the one that is found, and hardly any other is above it.
void ExpectFound(double level_m, double noise_m, double max_range_m) {
  std::vector<std::vector<double>> sweeps = Room(12);
  const double lowest_m = AddNoReturns(level_m, noise_m, 7, &sweeps);
  const std::optional<double> found = Level(sweeps, max_range_m);
  ASSERT_TRUE(found) << level_m << " +- " << noise_m;
  EXPECT_LE(*found, lowest_m);
  EXPECT_GE(*found, level_m - 0.001 * level_m - 0.2);
}

TEST(NoReturnLevelTest, AFixedReadingBelowTheMaximumIsFound) {
  ExpectFound(29.96, 0.0, 30.0);
  ExpectFound(15.96, 0.0, 16.0);
  ExpectFound(65.533, 0.0, 100.0);
  ExpectFound(81.83, 0.0, std::numeric_limits<double>::infinity());
}

TEST(NoReturnLevelTest, AReadingWithNoiseIsFound) {
  ExpectFound(29.96, 0.01, 30.0);
  ExpectFound(11.96, 0.01, 12.0);
  ExpectFound(65.533, 0.01, 100.0);
}

// As SICK's codes outdoors: a few true readings right below them are no tail.
TEST(NoReturnLevelTest, TrueReadingsRightBelowALevelAreKept) {
  std::vector<std::vector<double>> sweeps = Room(12);
  AddNoReturns(81.91, 0.0, 7, &sweeps);
  for (int i = 0; i < 12; ++i) sweeps[i][100] = 81.825 - 0.01 * i;
  const std::optional<double> found = Level(sweeps, std::numeric_limits<double>::infinity());
  ASSERT_TRUE(found);
  EXPECT_EQ(*found, 0.999 * 81.91);
}

TEST(NoReturnLevelTest, ReadingsFromTheMaximumOnDoNotCount) {
  std::vector<std::vector<double>> sweeps = Room(12);
  AddNoReturns(30.0, 0.0, 5, &sweeps);
  EXPECT_FALSE(Level(sweeps, 30.0));
  EXPECT_TRUE(Level(sweeps, 31.0));
}

TEST(NoReturnLevelTest, WallsAreNone) {
  EXPECT_FALSE(Level(Room(12), 30.0));
  EXPECT_FALSE(Level(Room(1), 30.0));
  EXPECT_FALSE(Level({}, 30.0));
  EXPECT_FALSE(Level({{}, {}}, 30.0));
  EXPECT_FALSE(Level({std::vector<double>(360, 5.0)}, 30.0));  // all there is
}

// A far wall through the gap between two near ones, seen by a robot that stands: one direction.
TEST(NoReturnLevelTest, AFarWallThroughAGapIsNone) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<std::vector<double>> sweeps(50, std::vector<double>(360, 2.0));
  for (std::vector<double>& ranges : sweeps) {
    for (int beam = 40; beam < 52; ++beam) ranges[beam] = 8.0 + noise(random);
  }
  EXPECT_FALSE(Level(sweeps, 30.0));
}

// As a point cloud: returns in any order, some beams without one.
std::optional<double> LevelOfShuffled(const std::vector<std::vector<double>>& sweeps) {
  std::mt19937 random(7);
  std::vector<std::vector<double>> ranges(sweeps.size()), bearings_rad(sweeps.size());
  std::vector<SweepReadings> readings;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    std::vector<std::size_t> order(sweeps[s].size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t beam : order) {
      if (beam % 10 == 9) continue;
      ranges[s].push_back(sweeps[s][beam]);
      bearings_rad[s].push_back(static_cast<double>(beam) * kStepRad - kPi);
    }
    readings.push_back(
        {&ranges[s], kStepRad, std::numeric_limits<double>::infinity(), &bearings_rad[s]});
  }
  return FindNoReturnLevel(readings);
}

TEST(NoReturnLevelTest, ReadingsInAnyOrderAreJudgedByTheirDirections) {
  std::vector<std::vector<double>> sweeps = Room(12);
  const double lowest_m = AddNoReturns(29.96, 0.01, 7, &sweeps);
  const std::optional<double> found = LevelOfShuffled(sweeps);
  ASSERT_TRUE(found);
  EXPECT_LE(*found, lowest_m);
  EXPECT_GE(*found, 29.7);
  // A far wall through a gap, with the noise of a laser: one direction.
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (std::vector<double>& ranges : sweeps) {
    ranges.assign(360, 2.0);
    for (int beam = 40; beam < 52; ++beam) ranges[beam] = 8.0 + noise(random);
  }
  EXPECT_FALSE(LevelOfShuffled(sweeps));
}

TEST(NoReturnLevelTest, FewReadingsAreNone) {
  std::vector<std::vector<double>> sweeps = Room(1);
  for (const int beam : {3, 90, 200}) sweeps[0][beam] = 29.96;
  EXPECT_FALSE(Level(sweeps, 30.0));
}

}  // namespace
}  // namespace plumbline
