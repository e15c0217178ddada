#include "plumbline/solvers/hypotheses/posterior.h"

#include <gtest/gtest.h>

#include <utility>

namespace plumbline {
namespace {

MapConsistency MapWith(int num_compared, int num_conflicting) {
  MapConsistency map;
  map.within_pass = {1000, 10};
  map.between_passes = {num_compared, num_conflicting};
  return map;
}

// Keyframes a metre apart along x.
KeyframeGraph StraightDrive(int num_keys) {
  KeyframeGraph keys;
  for (int k = 0; k < num_keys; ++k) {
    keys.keyframes.emplace_back();
    keys.keyframes.back().pose = keys.keyframes.back().scan = k;
    keys.keyframes.back().path_m = k;
    keys.world_from_key.emplace_back(k, 0.0, 0.0);
    if (k == 0) continue;
    SequentialEdge edge;
    edge.constraint = {k - 1, k, Pose2(1.0, 0.0, 0.0), 1e-4 * Eigen::Matrix3d::Identity()};
    keys.sequential.push_back(edge);
  }
  return keys;
}

class PosteriorTest : public testing::Test {
 protected:
  PosteriorTest() {
    posterior_.Begin(MapWith(10000, 100));
    posterior_.Calibrate(MapWith(10000, 100));
  }

  static EnergyTerms Terms(const MapHypothesis& hypothesis) {
    return Posterior::TermsOf(hypothesis);
  }
  double Energy(const MapHypothesis& hypothesis) { return posterior_.Energy(Terms(hypothesis)); }

  static MapHypothesis PlainDrive() {
    MapHypothesis plain;
    plain.keys = StraightDrive(10);
    plain.consistency = MapWith(10000, 100);
    return plain;
  }

  Posterior posterior_{/*of_one_session=*/true};
};

TEST_F(PosteriorTest, AgreementLowersTheEnergyAndConflictRaisesIt) {
  const double usual = posterior_.ScanEnergy({10000, 100});
  EXPECT_DOUBLE_EQ(usual, 0.0);  // the share within the pass of the map
  EXPECT_LT(posterior_.ScanEnergy({12000, 100}), usual);
  EXPECT_DOUBLE_EQ(posterior_.ScanEnergy({10000, 150}), usual + 50.0);
}

TEST_F(PosteriorTest, APlainDriveAssumesNothing) {
  const EnergyTerms terms = Terms(PlainDrive());
  EXPECT_EQ(terms.assumptions, 0.0);
  EXPECT_EQ(terms.relocated_m, 0.0);
  EXPECT_EQ(terms.conflict.num_compared, 11000);
  EXPECT_EQ(terms.conflict.num_conflicting, 110);
}

TEST_F(PosteriorTest, ASlipCostsOneUnitAndItsLength) {
  MapHypothesis slipped = PlainDrive();
  slipped.keys.sequential[4].broken = true;
  for (int k = 5; k < slipped.keys.size(); ++k) slipped.keys.world_from_key[k].x += 3.0;
  EXPECT_DOUBLE_EQ(Terms(slipped).relocated_m, 3.0);
  EXPECT_GT(Energy(slipped), Energy(PlainDrive()) + posterior_.unit());
}

TEST_F(PosteriorTest, TheEndOfASessionIsNoSlip) {
  MapHypothesis sessions = PlainDrive();
  sessions.keys.sequential[4].broken = sessions.keys.sequential[4].between_sessions = true;
  for (int k = 5; k < sessions.keys.size(); ++k) sessions.keys.world_from_key[k].x += 3.0;
  EXPECT_EQ(Terms(sessions).relocated_m, 0.0);
  EXPECT_EQ(Energy(sessions), Energy(PlainDrive()));
}

TEST_F(PosteriorTest, ASlipThatStrainsTheGraphCostsItsLengthOnly) {
  MapHypothesis slipped = PlainDrive();
  slipped.keys.sequential[4].broken = true;
  slipped.assumed.num_strained = 1;
  for (int k = 5; k < slipped.keys.size(); ++k) slipped.keys.world_from_key[k].x += 0.2;
  EXPECT_GT(Energy(slipped), Energy(PlainDrive()));
  EXPECT_LT(Energy(slipped), Energy(PlainDrive()) + posterior_.unit());
}

TEST_F(PosteriorTest, RemovedClosuresCostMoreThanAddedOnes) {
  MapHypothesis removed = PlainDrive(), added = PlainDrive();
  removed.assumed.num_removed = 1;
  added.assumed.num_added = 1;
  EXPECT_GT(Energy(added), Energy(PlainDrive()));
  EXPECT_GT(Energy(removed), Energy(added));
}

TEST_F(PosteriorTest, AStartFromTheOdometryCosts) {
  for (const HypothesisKind kind : {HypothesisKind::kOdometry, HypothesisKind::kOdometryAlone,
                                    HypothesisKind::kOdometryHeadings}) {
    MapHypothesis other = PlainDrive();
    other.kind = kind;
    EXPECT_GT(Energy(other), Energy(PlainDrive())) << ToString(kind);
  }
}

TEST_F(PosteriorTest, WhatIsUsualFollowsTheBestMap) {
  const double unit = posterior_.unit(), usual = posterior_.ScanEnergy({10000, 100});
  MapConsistency worse = MapWith(10000, 200), better = MapWith(10000, 50);
  worse.within_pass = {1000, 20};
  better.within_pass = {1000, 5};
  posterior_.Calibrate(worse);
  EXPECT_EQ(posterior_.unit(), unit);
  EXPECT_EQ(posterior_.ScanEnergy({10000, 100}), usual);
  posterior_.Calibrate(better);
  EXPECT_LT(posterior_.unit(), unit);
  EXPECT_GT(posterior_.ScanEnergy({10000, 100}), usual);
}

TEST_F(PosteriorTest, PassesOfSeveralSessionsMayDisagree) {
  const MapConsistency map = MapWith(1000, 900);
  EXPECT_TRUE(posterior_.PassesDisagree(map));
  EXPECT_FALSE(Posterior(/*of_one_session=*/false).PassesDisagree(map));
}

}  // namespace
}  // namespace plumbline
