#include "plumbline/solvers/acceptance/candidate.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

// Candidates of a drive through a room. The seed is the truth, shaken.
class CandidateTest : public testing::Test {
 protected:
  CandidateTest() {
    NoisyRoomOptions options;
    options.num_poses = 48;
    options.num_beams = 360;
    room_ = MakeNoisyRoom(options);
    truth_ = room_.state.poses;
    DisturbPoses(0.01, room_.graph, &room_.state);
    seed_ = room_.state.poses;
    surface_ = SurfaceOf(room_.graph);
    seed_cut_ = Cut(seed_);
  }

  LineLandmarks Cut(const std::vector<double>& poses) {
    LineLandmarkOptions options = LandmarkOptionsFor(factors_, AssociationOptions());
    options.hold_out = true;
    return CutIntoLandmarks(room_.graph, poses, surface_, options, &pool_);
  }
  CandidateEvaluator Evaluator() {
    return {room_.graph, surface_, factors_, {seed_, seed_cut_}, &pool_};
  }
  std::vector<double> TornAt(int first, int last) const {
    std::vector<double> poses = truth_;
    for (int i = first; i <= last; ++i) poses[3 * i] += 0.5;
    return poses;
  }

  ThreadPool pool_{2};
  FactorOptions factors_;
  NoisyRoom room_;
  std::vector<double> truth_, seed_;
  MeasuredSurface surface_;
  LineLandmarks seed_cut_;
};

TEST_F(CandidateTest, WhatIsBetterEverywhereStaysAsItIs) {
  Candidate candidate = Evaluator().Evaluate(truth_, Cut(truth_));
  EXPECT_TRUE(candidate.acceptance.IsBetter());
  EXPECT_TRUE(Evaluator().PutBackWorse(&candidate).empty());
  EXPECT_EQ(candidate.poses, truth_);
}

TEST_F(CandidateTest, TornPosesArePutBackAndAllOthersStay) {
  const std::vector<double> torn = TornAt(20, 22);
  Candidate candidate = Evaluator().Evaluate(torn, Cut(torn));
  EXPECT_FALSE(candidate.acceptance.IsBetter());
  EXPECT_GT(candidate.acceptance.num_worse_stretches, 0);
  const std::vector<WorseStretch> stretches = Evaluator().PutBackWorse(&candidate);
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].first, 20);
  EXPECT_EQ(stretches[0].last, 22);
  EXPECT_TRUE(candidate.acceptance.IsBetter()) << candidate.acceptance.Text();
  for (int i = 0; i < room_.graph.num_poses(); ++i) {
    const bool is_torn = i >= 20 && i <= 22;
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(candidate.poses[3 * i + k], truth_[3 * i + k], is_torn ? 0.05 : 0.0) << i;
    }
  }
}

TEST_F(CandidateTest, TheMapOfTornPosesIsNotPreferred) {
  const std::vector<double> torn = TornAt(20, 22);
  const Candidate bad = Evaluator().Evaluate(torn, Cut(torn)),
                  good = Evaluator().Evaluate(truth_, Cut(truth_));
  EXPECT_TRUE(Evaluator().IsPreferable(bad, good));
  EXPECT_FALSE(Evaluator().IsPreferable(good, bad));
}

TEST_F(CandidateTest, OfARefutedCandidateNothingButTheSeedIsToBeBeaten) {
  Candidate refuted = Evaluator().Evaluate(truth_, Cut(truth_));
  const Candidate no_better = Evaluator().Evaluate(seed_, Cut(seed_));
  Candidate nearer = Evaluator().Evaluate(truth_, Cut(truth_));
  for (std::size_t i = 0; i < nearer.poses.size(); ++i) {
    nearer.poses[i] += 0.5 * (seed_[i] - truth_[i]);
  }
  nearer = Evaluator().Evaluate(nearer.poses, Cut(nearer.poses));
  ASSERT_TRUE(nearer.acceptance.IsBetterAsAWhole());
  EXPECT_FALSE(Evaluator().IsPreferable(refuted, nearer));
  refuted.is_refuted = true;
  EXPECT_TRUE(Evaluator().IsPreferable(refuted, nearer));
  EXPECT_FALSE(Evaluator().IsPreferable(refuted, no_better));
}

}  // namespace
}  // namespace plumbline
