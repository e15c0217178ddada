#include "plumbline/solvers/sessions/session_alignment.h"

#include <gtest/gtest.h>

#include <vector>

namespace plumbline {
namespace {

SessionAlignment Alignment(int num_compared, double conflict_share, int num_witnesses) {
  SessionAlignment alignment;
  FreeSpaceConflict& all = alignment.conflict;
  all.num_compared = num_compared;
  all.num_conflicting = static_cast<int>(conflict_share * num_compared);
  alignment.num_witnesses = num_witnesses;
  alignment.score = all.num_conflicting - 0.1 * num_compared;
  return alignment;
}

TEST(JudgeTest, WithoutAnAlignmentNothingMatches) { EXPECT_EQ(Judge({}), TieOutcome::kNoMatch); }

TEST(JudgeTest, OneGoodAlignmentTies) {
  EXPECT_EQ(Judge({Alignment(30000, 0.02, 8)}), TieOutcome::kTied);
  EXPECT_EQ(Judge({Alignment(30000, 0.02, 8), Alignment(30000, 0.3, 8)}), TieOutcome::kTied);
}

TEST(JudgeTest, ConflictsAndTooFewPlacesSpeakAgainstIt) {
  EXPECT_EQ(Judge({Alignment(30000, 0.2, 8)}), TieOutcome::kContradicted);
  EXPECT_EQ(Judge({Alignment(30000, 0.02, 2)}), TieOutcome::kFewPlaces);
}

TEST(JudgeTest, SessionsThatAreBentAtMostPlacesAreOfDifferentBuildings) {
  SessionAlignment bent = Alignment(30000, 0.02, 8);
  bent.num_places = 8;
  bent.num_bent_places = 5;
  EXPECT_EQ(Judge({bent}), TieOutcome::kBent);
  bent.num_bent_places = 4;  // furniture was moved
  EXPECT_EQ(Judge({bent}), TieOutcome::kTied);
}

TEST(JudgeTest, ARivalThatExplainsHalfAsMuchMakesItAmbiguous) {
  EXPECT_EQ(Judge({Alignment(30000, 0.02, 8), Alignment(20000, 0.03, 5)}), TieOutcome::kAmbiguous);
  EXPECT_EQ(Judge({Alignment(30000, 0.02, 8), Alignment(10000, 0.03, 5)}), TieOutcome::kTied);
}

}  // namespace
}  // namespace plumbline
