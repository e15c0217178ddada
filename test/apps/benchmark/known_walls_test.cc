#include "plumbline/apps/benchmark/known_walls.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plumbline/apps/benchmark/map_errors.h"

namespace plumbline {
namespace {

FactorOptions FactorsFor(const SyntheticNoise& noise) {
  FactorOptions factors;
  factors.beam.sigma_range_m = std::max(noise.sigma_range_m, 1e-3);
  factors.beam.sigma_bearing_rad = std::max(noise.sigma_bearing_rad, 1e-4);
  return factors;
}

TEST(KnownWalls, FindsTheTruthThroughNoiselessBeamsWhateverTheOdometrySays) {
  const SyntheticNoise noise{"", 0.0, 0.0, 1.0};
  SyntheticDrive drive;
  ASSERT_TRUE(MakeSyntheticDrive(1, noise, &drive).ok());
  const MapErrors before =
      MeasureMapErrors({drive.truth.poses, drive.graph.InitialState().points}, drive.truth);
  EXPECT_GT(MeanAndVarianceOf(before.point_m).mean, 0.5);
  const MapErrors errors =
      MeasureMapErrors(EstimateGivenTruth(drive, FactorsFor(noise), Told::kWalls), drive.truth);
  for (const double error_m : errors.pose_m) EXPECT_LT(error_m, 2e-4);  // ranges are in mm
  EXPECT_LT(MeanAndVarianceOf(errors.point_m).mean, 5e-4);
}

TEST(KnownWalls, ErrsByWhatTheNoiseOfTheBeamsSays) {
  // Some 180 returns face each side: about noise / sqrt(180) in either direction.
  const SyntheticNoise noise{"", 0.03, 0.0017, 1.0};
  double sum_m = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SyntheticDrive drive;
    ASSERT_TRUE(MakeSyntheticDrive(seed, noise, &drive).ok());
    const MapErrors errors =
        MeasureMapErrors(EstimateGivenTruth(drive, FactorsFor(noise), Told::kWalls), drive.truth);
    sum_m += MeanAndVarianceOf(errors.pose_m).mean / 3.0;
    // A point may slide along its surface, but not leave it.
    const MapErrors raw = MeasureMapErrors(
        {drive.truth.poses, PlacedReturns(drive.graph, drive.truth.poses)}, drive.truth);
    EXPECT_LT(MeanAndVarianceOf(errors.point_m).mean, 0.5 * MeanAndVarianceOf(raw.point_m).mean);
  }
  EXPECT_GT(sum_m, 0.0005);
  EXPECT_LT(sum_m, 0.003);
}

// Less is known, so that the poses are worse; with exact beams they still find the truth.
TEST(KnownWalls, WallsThatAreNotToldAreFound) {
  const SyntheticNoise exact{"", 0.0, 0.0, 1.0}, noisy{"", 0.03, 0.0017, 1.0};
  const auto error_m = [](const SyntheticNoise& noise, Told told) {
    double sum_m = 0.0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SyntheticDrive drive;
      EXPECT_TRUE(MakeSyntheticDrive(seed, noise, &drive).ok());
      const MapEstimate map = EstimateGivenTruth(drive, FactorsFor(noise), told);
      sum_m += MeanAndVarianceOf(MeasureMapErrors(map, drive.truth).pose_m).mean / 3.0;
    }
    return sum_m;
  };
  EXPECT_LT(error_m(exact, Told::kWhoseReturn), 5e-4);
  EXPECT_LT(error_m(exact, Told::kDirections), 5e-4);
  EXPECT_GT(error_m(noisy, Told::kWhoseReturn), 1.1 * error_m(noisy, Told::kDirections));
  EXPECT_GT(error_m(noisy, Told::kDirections), 1.1 * error_m(noisy, Told::kWalls));
}

}  // namespace
}  // namespace plumbline
