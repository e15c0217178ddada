#include "plumbline/apps/report/session_text.h"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/report/format.h"
#include "plumbline/apps/report/units.h"

namespace plumbline {
namespace {

std::string ClosuresText(const SessionTie& tie) {
  return std::to_string(tie.num_closures) +
         (tie.num_closures == 1 ? " loop closure at " : " loop closures at ") +
         std::to_string(tie.num_witnesses) + (tie.num_witnesses == 1 ? " place" : " places");
}

std::string ConflictText(const SessionTie& tie) {
  return Format("%.1f %% of ", kPercent * tie.conflict.Share()) +
         WithThousands(tie.conflict.num_compared) + " returns in conflict";
}

std::string OutcomeText(const SessionTie& tie) {
  switch (tie.outcome) {
    case TieOutcome::kTied:
      return "one map, by " + ClosuresText(tie) + "; " + ConflictText(tie);
    case TieOutcome::kNoMatch:
      return "no common place was found";
    case TieOutcome::kFewPlaces:
      return "not tied: " + ClosuresText(tie) + " are too few to believe";
    case TieOutcome::kContradicted:
      return "not tied: the best of what would fit has " + ConflictText(tie);
    case TieOutcome::kBent:
      return "not tied: " + std::to_string(tie.num_bent_places) + " of the " +
             std::to_string(tie.num_places) +
             " places that match seem to fit only if the sessions are bent";
    case TieOutcome::kAmbiguous:
      return "not tied: several ways to put them together fit as well";
  }
  return "unknown";
}

Json NumbersFromOne(const std::vector<int>& sessions) {
  Json numbers = Json::array();
  for (const int session : sessions) numbers.push_back(session + 1);
  return numbers;
}

}  // namespace

std::string JoinedNames(const std::vector<int>& sessions, const std::vector<std::string>& names) {
  std::string text;
  for (const int session : sessions) text += (text.empty() ? "" : ", ") + names[session];
  return text;
}

std::string TiesText(const std::vector<SessionTie>& ties, const std::vector<std::string>& names) {
  std::string text;
  for (const SessionTie& tie : ties) {
    text += "  " +
            Legible(JoinedNames(tie.first, names) + " and " + JoinedNames(tie.second, names)) +
            ": " + OutcomeText(tie) + ".\n";
  }
  return text;
}

Json TiesJson(const std::vector<SessionTie>& ties) {
  Json json = Json::array();
  for (const SessionTie& tie : ties) {
    Json row = {{"first", NumbersFromOne(tie.first)},
                {"second", NumbersFromOne(tie.second)},
                {"outcome", ToString(tie.outcome)}};
    if (tie.outcome != TieOutcome::kNoMatch) {
      const Pose2& pose = tie.first_from_second;
      row.update({{"first_from_second", {pose.x, pose.y, pose.yaw}},
                  {"closures", tie.num_closures},
                  {"witnesses", tie.num_witnesses},
                  {"compared_returns", tie.conflict.num_compared},
                  {"conflicting_returns", tie.conflict.num_conflicting}});
    }
    json.push_back(row);
  }
  return json;
}

ReportTable ChangesTable(const std::vector<SessionMark>& sessions,
                         const std::vector<SessionChange>& changes) {
  constexpr std::size_t kMostRows = 30;
  std::vector<SessionChange> sorted = changes;
  std::stable_sort(
      sorted.begin(), sorted.end(),
      [](const SessionChange& a, const SessionChange& b) { return a.size_m > b.size_m; });
  if (sorted.size() > kMostRows) sorted.resize(kMostRows);
  ReportTable table{"What changed between sessions",
                    {"x, y [m]", "Size [m]", "Shown by", "Looked through by"},
                    {},
                    WithThousands(changes.size()) + " surfaces in all; summary.json has them."};
  for (const SessionChange& change : sorted) {
    std::string others;
    for (const int other : change.looked_through_by) {
      others += (others.empty() ? "" : ", ") + sessions[other].name;
    }
    table.rows.push_back({Format("%.1f, %.1f", change.center.x(), change.center.y()),
                          Format("%.2f", change.size_m), sessions[change.shown_by].name, others});
  }
  return table;
}

Json ChangesJson(const std::vector<SessionMark>& sessions,
                 const std::vector<SessionChange>& changes) {
  Json json = Json::array();
  for (const SessionChange& change : changes) {
    Json others = Json::array();
    for (const int other : change.looked_through_by) others.push_back(sessions[other].number + 1);
    json.push_back({{"x", change.center.x()},
                    {"y", change.center.y()},
                    {"size_m", change.size_m},
                    {"shown_by", sessions[change.shown_by].number + 1},
                    {"looked_through_by", others}});
  }
  return json;
}

}  // namespace plumbline
