#include "plumbline/solvers/reduced/calibration_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/landmark_energy.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr double kGateSigmas = 1e3;  // all returns count in full

// Weights that do not depend on the state: then the energy is what the system is the derivative of.
FactorOptions EvenWeights() {
  FactorOptions factors;
  factors.beam.sigma_range_m = 1e-4;
  factors.beam.sigma_bearing_rad = 1e-5;
  factors.manifold.sigma_m = 0.01;
  return factors;
}

// Poses and landmarks of a room, to be calibrated.
class CalibrationSystemTest : public testing::Test {
 protected:
  void Make(double range_sigma_m, double odometry_sigma) {
    NoisyRoomOptions options;
    options.range_sigma_m = range_sigma_m;
    options.odometry_sigma = odometry_sigma;
    given_ = MakeNoisyRoom(options);
    calibrated_.emplace(given_.graph, given_.state.poses);
    // Away from zero, where factors and exponents could hide.
    CalibrationVector theta;
    theta << 0.01, -0.02, 0.03, 0.015, 0.02, -0.01;
    calibrated_->Set(theta, given_.state.poses);
    const MeasuredSurface surface = SurfaceOf(calibrated_->graph());
    cut_ = CutIntoLandmarks(calibrated_->graph(), calibrated_->poses(), surface,
                            LandmarkOptionsFor(factors_, AssociationOptions()), &pool_);
    // Without a normal, next to a corner, some are on the line of the other wall: not exact data.
    for (std::size_t r = 0; r < surface.normals.size(); ++r) {
      if (surface.normals[r].IsNone()) cut_.landmark_of_return[r] = LineLandmarks::kNone;
    }
  }

  // At the parameters and poses of the moment, the lines refitted.
  double Energy() {
    const SlamGraph& graph = calibrated_->graph();
    ReturnCompressor compressor(graph, calibrated_->Noise(factors_), &pool_);
    observations_ = compressor.LayOut(cut_.landmarks.size(), cut_.landmark_of_return);
    landmarks_ = cut_.landmarks;
    frames_ = FramesOf(calibrated_->poses());
    SettleLines(compressor, frames_, kGateSigmas, &pool_, &observations_, &landmarks_);
    const GemanMcClure loss = GemanMcClure::FromGate(kGateSigmas);
    slopes_ = compressor.RangeSlopes(landmarks_, frames_, loss, observations_);
    return compressor.Weigh(landmarks_, frames_, loss, &observations_) +
           calibrated_->Terms(factors_).Cost(calibrated_->poses());
  }

  // moved: of the rows of the system.
  double EnergyAt(const CalibrationVector& theta, const Eigen::VectorXd& moved) {
    const CalibrationVector before = calibrated_->theta();
    const std::vector<double> poses = calibrated_->poses();
    calibrated_->Set(theta, calibrated_->Carried(theta, pose_system_.Moved(poses, moved)));
    const double energy = Energy();
    calibrated_->Set(before, poses);
    return energy;
  }

  CalibrationSystem Linearize() {
    Energy();
    const PoseTerms terms = calibrated_->Terms(factors_);
    pose_system_.Linearize(observations_, landmarks_, terms, calibrated_->poses(), frames_, &pool_);
    return CalibrationSystem(*calibrated_, calibrated_->Edges(factors_), observations_, slopes_,
                             landmarks_, frames_, pose_system_);
  }

  const FactorOptions factors_ = EvenWeights();
  ThreadPool pool_{2};
  NoisyRoom given_;
  std::optional<CalibratedGraph> calibrated_;
  LineLandmarks cut_;
  LineObservations observations_;
  std::vector<RangeSlope> slopes_;
  std::vector<LineLandmark> landmarks_;
  std::vector<PoseFrame> frames_;
  PoseSystem pose_system_;
};

TEST_F(CalibrationSystemTest, GradientOfEveryParameter) {
  Make(0.01, 0.01);
  const CalibrationSystem system = Linearize();
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(pose_system_.gradient.size());
  for (int p = 0; p < kNumCalibrationParameters; ++p) {
    constexpr double kStep = 1e-4;
    const CalibrationVector step = kStep * CalibrationVector::Unit(p);
    const double numeric = (EnergyAt(calibrated_->theta() + step, still) -
                            EnergyAt(calibrated_->theta() - step, still)) /
                           (2.0 * kStep);
    // Measured points are single precision.
    EXPECT_NEAR(system.gradient[p], numeric,
                5e-3 * std::abs(numeric) + 0.05 * std::sqrt(system.information(p, p)))
        << "parameter " << p;
    EXPECT_GT(std::abs(numeric), 0.0);
  }
}

// With exact data at the truth the energy is the quadratic form of the bordered system.
TEST_F(CalibrationSystemTest, CurvatureOfPosesAndParametersTogether) {
  Make(0.0, 0.0);
  calibrated_->Set(CalibrationVector::Zero(), calibrated_->poses());
  const CalibrationSystem system = Linearize();
  const Eigen::Index size = pose_system_.gradient.size();
  ASSERT_EQ(system.border.rows(), size);
  RandomStates random(3);
  const double base = Energy();
  for (int p = 0; p < kNumCalibrationParameters; ++p) {
    constexpr double kStep = 1e-3;
    Eigen::VectorXd v(size), product;
    for (double& entry : v) entry = random.Gaussian(0.3);
    pose_system_.Apply(observations_, v, &pool_, &product);
    const double expected =
        v.dot(product) + 2.0 * v.dot(system.border.col(p)) + system.information(p, p);
    const double energy = EnergyAt(kStep * CalibrationVector::Unit(p), kStep * v) - base;
    EXPECT_NEAR(energy, 0.5 * kStep * kStep * expected, 0.02 * energy) << "parameter " << p;
    // The mixed part alone, which the poses' own curvature could hide.
    const double mixed = EnergyAt(kStep * CalibrationVector::Unit(p), kStep * v) -
                         EnergyAt(-kStep * CalibrationVector::Unit(p), kStep * v);
    EXPECT_NEAR(mixed, 2.0 * kStep * kStep * v.dot(system.border.col(p)),
                0.02 * std::abs(mixed) + 0.01 * energy)
        << "parameter " << p;
  }
}

TEST_F(CalibrationSystemTest, SolutionFulfilsTheBorderedSystem) {
  Make(0.01, 0.01);
  const CalibrationSystem system = Linearize();
  CalibrationVector prior_sigmas;
  prior_sigmas << 0.1, 0.1, 0.1, 0.05, 0.01, 0.05;
  const CalibrationVector theta = calibrated_->theta();
  const std::vector<int> active = {kMountingX, kRangeBias, kLogOdometryScale};
  CalibrationStep step;
  ASSERT_TRUE(SolveCalibrationStep(system, pose_system_, observations_, frames_, active,
                                   prior_sigmas, theta, nullptr, &pool_, &step)
                  .ok());
  // The first pose is fixed, the rows are those of the others.
  EXPECT_TRUE(step.poses.head<3>().isZero(0.0));
  EXPECT_TRUE(step.response.topRows<3>().isZero(0.0));
  const Eigen::VectorXd by_row = step.poses.tail(pose_system_.gradient.size());
  ASSERT_EQ(by_row.size() + 3, step.poses.size());
  Eigen::VectorXd product;
  pose_system_.Apply(observations_, by_row, &pool_, &product);
  const Eigen::VectorXd poses = product + system.border * step.theta + pose_system_.gradient;
  EXPECT_LT(poses.norm(), 1e-2 * pose_system_.gradient.norm());
  for (const int p : active) {
    const double row = system.border.col(p).dot(by_row) +
                       system.information.row(p).dot(step.theta) + system.gradient[p] +
                       (theta[p] + step.theta[p]) / (prior_sigmas[p] * prior_sigmas[p]);
    EXPECT_NEAR(row * std::sqrt(step.covariance(p, p)), 0.0, 0.05) << "parameter " << p;
    EXPECT_LT(step.covariance(p, p), prior_sigmas[p] * prior_sigmas[p]);
  }
  EXPECT_EQ(step.theta[kMountingY], 0.0);
  EXPECT_EQ(step.covariance(kLogRangeScale, kLogRangeScale), 0.0);
}

}  // namespace
}  // namespace plumbline
