#include "plumbline/apps/report/session_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const std::vector<std::string> kNames = {"a.clf", "b.bag", "c\x1b.clf"};

SessionTie Tie(TieOutcome outcome) {
  SessionTie tie;
  tie.first = {0, 2};
  tie.second = {1};
  tie.outcome = outcome;
  tie.first_from_second = Pose2(1.5, -2.0, 0.25);
  tie.num_closures = 12;
  tie.num_witnesses = 3;
  tie.num_places = 6;
  tie.num_bent_places = 5;
  tie.conflict = {2000, 50};
  return tie;
}

TEST(SessionTextTest, SaysHowSessionsWereTied) {
  EXPECT_EQ(TiesText({Tie(TieOutcome::kTied)}, kNames),
            "  a.clf, c\\x1b.clf and b.bag: one map, by 12 loop closures at 3 places; 2.5 % of "
            "2,000 returns in conflict.\n");
}

TEST(SessionTextTest, SaysWhySessionsWereLeftApart) {
  EXPECT_THAT(TiesText({Tie(TieOutcome::kNoMatch)}, kNames), HasSubstr("no common place"));
  EXPECT_THAT(TiesText({Tie(TieOutcome::kFewPlaces)}, kNames),
              HasSubstr("12 loop closures at 3 places are too few"));
  EXPECT_THAT(TiesText({Tie(TieOutcome::kContradicted)}, kNames), HasSubstr("2.5 % of 2,000"));
  EXPECT_THAT(TiesText({Tie(TieOutcome::kBent)}, kNames), HasSubstr("5 of the 6 places"));
  EXPECT_THAT(TiesText({Tie(TieOutcome::kAmbiguous)}, kNames), HasSubstr("several ways"));
}

TEST(SessionTextTest, TiesAreNumberedFromOne) {
  const Json json = TiesJson({Tie(TieOutcome::kTied), Tie(TieOutcome::kNoMatch)});
  EXPECT_EQ(json.dump(),
            R"([{"first":[1,3],"second":[2],"outcome":"tied","first_from_second":[1.5,-2.0,0.25],)"
            R"("closures":12,"witnesses":3,"compared_returns":2000,"conflicting_returns":50},)"
            R"({"first":[1,3],"second":[2],"outcome":"no_match"}])");
}

TEST(SessionTextTest, ChangesAreListedByTheirSize) {
  const std::vector<SessionMark> marks = {{"a.clf", 0, 0, 5}, {"b.bag", 2, 5, 5}};
  std::vector<SessionChange> changes(40);
  changes[7].shown_by = 1;
  changes[7].looked_through_by = {0};
  changes[7].center = {1.25, -3.5};
  changes[7].size_m = 0.75;
  const ReportTable table = ChangesTable(marks, changes);
  EXPECT_THAT(table.rows, SizeIs(30));
  EXPECT_THAT(table.rows.front(), ElementsAre("1.2, -3.5", "0.75", "b.bag", "a.clf"));
  EXPECT_THAT(table.note, HasSubstr("40 surfaces"));
  const Json json = ChangesJson(marks, changes);
  EXPECT_EQ(json.size(), 40u);
  EXPECT_EQ(json[7].dump(),
            R"({"x":1.25,"y":-3.5,"size_m":0.75,"shown_by":3,"looked_through_by":[1]})");
}

}  // namespace
}  // namespace plumbline
