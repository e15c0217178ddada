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
  EXPECT_EQ(Judge({Alignment(30000, 0.02, 8), Alignment(10000, 0.05, 5)}), TieOutcome::kTied);
}

// In a building that half a turn puts on itself, two sessions may have little in common where they
// lie as they do, and more where they do not.
TEST(JudgeTest, ARivalThatConflictsAsLittleMakesItAmbiguous) {
  const SessionAlignment best = Alignment(39000, 0.0015, 9), worse = Alignment(38000, 0.11, 8);
  EXPECT_EQ(Judge({best, worse, Alignment(12000, 0.002, 3)}), TieOutcome::kAmbiguous);
  EXPECT_EQ(Judge({best, worse, Alignment(12000, 0.002, 2)}), TieOutcome::kTied);
  EXPECT_EQ(Judge({best, worse, Alignment(12000, 0.05, 3)}), TieOutcome::kTied);
}

}  // namespace
}  // namespace plumbline
