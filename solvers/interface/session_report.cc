#include "plumbline/solvers/interface/session_report.h"

namespace plumbline {

const char* ToString(TieOutcome outcome) {
  switch (outcome) {
    case TieOutcome::kTied:
      return "tied";
    case TieOutcome::kNoMatch:
      return "no_match";
    case TieOutcome::kFewPlaces:
      return "few_places";
    case TieOutcome::kContradicted:
      return "contradicted";
    case TieOutcome::kBent:
      return "bent";
    case TieOutcome::kAmbiguous:
      return "ambiguous";
  }
  return "unknown";
}

}  // namespace plumbline
