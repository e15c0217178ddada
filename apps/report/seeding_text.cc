#include "plumbline/apps/report/seeding_text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/apps/report/format.h"
#include "plumbline/apps/report/units.h"
#include "plumbline/core/angle.h"
#include "plumbline/solvers/alarm.h"

namespace plumbline {
namespace {

std::string Count(int number, const std::string& singular, const std::string& plural) {
  return std::to_string(number) + ' ' + (number == 1 ? singular : plural);
}
// "1 scan", "2 scans".
std::string Count(int number, const std::string& noun) { return Count(number, noun, noun + "s"); }

std::string StartText(StartType start) {
  if (start == StartType::kOdometry) return "  The solver starts at the odometry as it is.\n";
  if (start == StartType::kIcpGlobal) {
    return "  The solver starts where all scans that see the same place were matched, jointly.\n";
  }
  return std::string("  The solver starts where each scan was matched to the one before it, ") +
         (start == StartType::kIcp ? "point to point.\n" : "point to line.\n");
}

std::string MatchingText(const SequentialSeedingReport& report, bool is_prediction, int num_scans) {
  const std::string source = is_prediction ? "prediction" : "odometry";
  std::string text =
      "  " + Count(report.num_keyframes, "keyframe") + " among " + Count(num_scans, "scan") + ".\n";
  if (report.num_unmatched >= num_scans - 1) {
    text +=
        "  No scan matches another: every pose is the " + source + "'s, and nothing checks it.\n";
  } else if (report.num_unmatched > 0) {
    text += "  " + Count(report.num_unmatched, "scan") +
            (report.num_unmatched == 1 ? " matched nothing near by: its step is the "
                                       : " matched nothing near by: their steps are the ") +
            source + "'s.\n";
  }
  if (report.num_recovered > 0) {
    text +=
        "  " + Count(report.num_recovered, "scan") + " matched only well off the " + source + ".\n";
  }
  if (report.odometry_sign.sign_lost) {
    text += "  The odometry has lost the sign of its translation: " +
            Count(report.num_reversed_steps, "step") + " went backwards.\n";
  }
  return text;
}

std::string FaultText(const SystematicError& error, double factor, const char* format) {
  if (!error.IsSignificant()) return "";
  return "  The odometry " + Format(format, factor * error.value, factor * error.sigma) +
         "; its motions are corrected.\n";
}

std::string ClockText(const ClockOffset& offset) {
  if (!offset.IsSignificant()) return "";
  return Format("  The odometry is %.3f +- %.3f s ", std::abs(offset.value_s), offset.sigma_s) +
         (offset.value_s > 0.0 ? "ahead of" : "behind") +
         " the scans; its motions are corrected.\n";
}

std::string RandomText(const RandomError& error, double factor, const char* unit) {
  return Format("%.1f %s per root metre and %.1f %s per root radian",
                factor * error.sigma_per_sqrt_m, unit, factor * error.sigma_per_sqrt_rad, unit);
}

std::string OdometryText(const OdometryNoiseReport& noise) {
  if (noise.given_poses.position_m > 0.0) {
    return Format(
        "  The given poses have independent errors of %.2f m and %.1f deg (one sigma): each scan "
        "was "
        "searched for around its pose.\n",
        noise.given_poses.position_m, RadToDeg(noise.given_poses.yaw_rad));
  }
  if (noise.is_prediction) {
    return (noise.gross_translation_scale == 0.0
                ? std::string("  The odometry contradicts the scans and was not used: ")
                : std::string("  There was no odometry: ")) +
           Format(
               "each step was predicted from those before, to %.0f mm and %.1f deg (one sigma).\n",
               kMmPerM * noise.motion.translation_floor_m,
               RadToDeg(noise.motion.rotation_floor_rad));
  }
  std::string text;
  if (noise.gross_translation_scale != 1.0) {
    text += Format("  The odometry's distances are %.2f times the true ones and are corrected.\n",
                   noise.gross_translation_scale);
  }
  if (noise.num_still_steps > 0) {
    text += "  The wheels stood still for " + Count(noise.num_still_steps, "step") +
            " while the scans moved; these are predicted from those before.\n";
  }
  text +=
      ClockText(noise.clock_offset) +
      FaultText(noise.translation_scale, kPercent, "reads %+.2f +- %.2f %% in distance") +
      FaultText(noise.rotation_scale, kPercent, "reads %+.2f +- %.2f %% in turns") +
      FaultText(noise.heading_drift_rad_m, RadToDeg(1.0), "turns by %+.3f +- %.3f deg per metre");
  std::string random;
  if (noise.translation.estimated) {
    random += " " + RandomText(noise.translation, kMmPerM, "mm") + " in distance";
  }
  if (noise.rotation.estimated) {
    random += (random.empty() ? " " : ", ") + RandomText(noise.rotation, RadToDeg(1.0), "deg") +
              " in heading";
  }
  if (!random.empty()) text += "  Odometry noise (one sigma):" + random + ".\n";
  if (noise.num_leaps > 0) {
    text += "  In " + Count(noise.num_leaps, "step") +
            " odometry and scans disagree too much for noise: a slip, a collision or a scan "
            "matched to the wrong place.\n";
  }
  return text;
}

std::string RefusedText(const LoopClosingReport& loops) {
  std::string text;
  for (const auto& [outcome, count] : CountOutcomes(loops)) {
    if (outcome == ClosureOutcome::kAccepted) continue;
    std::string reason = ToString(outcome);
    std::replace(reason.begin(), reason.end(), '_', ' ');
    text += (text.empty() ? "; refused: " : ", ") + std::to_string(count) + ' ' + reason;
  }
  return text;
}

std::string LoopsText(const LoopClosingReport& loops, const MapConsistency& consistency) {
  if (loops.num_closures > 0) {
    return "  " + Count(loops.num_closures, "loop closure") + " among " +
           Count(loops.num_candidates, "place") + " tried" + RefusedText(loops) + ".\n";
  }
  const bool revisited = consistency.num_pairs_between > 0;
  if (!revisited && loops.matches.empty()) {
    return "  No place was visited twice: the drift cannot be checked.\n";
  }
  return "  No loop was closed among " + Count(loops.num_candidates, "place") + " tried" +
         RefusedText(loops) + (revisited ? ".\n" : ": the drift cannot be checked.\n");
}

std::string SuspectStepsText(const LoopClosingReport& loops, const SlamGraph& graph,
                             const std::vector<double>& poses) {
  std::string text;
  int num_unresolved = 0, num_kept = 0;
  for (const SuspectStep& step : loops.suspect_steps) {
    if (step.IsUnresolved()) {
      ++num_unresolved;
    } else if (!step.broken) {
      ++num_kept;
    } else {
      text += "  The step to " + PlaceOfPose(graph, poses, step.first_pose_after).Text() +
              " was wrong: " + Count(step.num_closures_across, "loop closure") + " put it right.\n";
    }
  }
  if (num_unresolved > 0) {
    text += "  " + Count(num_unresolved, "suspect step") + " that nothing settles.\n";
  }
  if (num_kept > 0) {
    text += "  " + Count(num_kept, "suspect step") + " that all else agrees with.\n";
  }
  return text;
}

// The revisions that were adopted, and where the poses began if that is not the matching.
std::string HypothesesText(const std::vector<WeighedHypothesis>& hypotheses) {
  std::string text;
  for (const WeighedHypothesis& hypothesis : hypotheses) {
    if (!hypothesis.adopted || hypothesis.kind == HypothesisKind::kMatching) continue;
    text += "  Of " + Count(static_cast<int>(hypotheses.size()), "hypothesis", "hypotheses") +
            " the scans agree best with this one: " + HypothesisText(hypothesis) + ".\n";
  }
  return text;
}

// Why there is no path of keyframes that could be checked.
std::string NoPathText(const SequentialSeedingReport& report) {
  const char* reason = "There is a single keyframe";
  if (report.num_keyframes == 0) {
    reason = "No scan shows a surface";
  } else if (report.num_unmatched == 0) {
    reason = "The robot hardly moved";  // each scan was matched to the keyframe, from close by
  }
  return std::string("  ") + reason + ": there is no loop to close and no drift to check.\n";
}

// Maps whose poses differ by less are the same one to the eye.
constexpr double kSameMapM = 0.5;

double LargestShiftM(const std::vector<Pose2>& a, const std::vector<Pose2>& b) {
  double largest_m = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest_m = std::max(largest_m, (a[i].translation() - b[i].translation()).norm());
  }
  return largest_m;
}

}  // namespace

std::map<ClosureOutcome, int> CountOutcomes(const LoopClosingReport& loops) {
  std::map<ClosureOutcome, int> counts;
  for (const LoopClosureRecord& match : loops.matches) ++counts[match.outcome];
  return counts;
}

std::string HypothesisText(const WeighedHypothesis& hypothesis) {
  const auto range = [](int first, int last) {
    return std::to_string(first) + (last > first ? "-" + std::to_string(last) : "");
  };
  const std::string closures = Count(hypothesis.num_closures, "closure") + " of poses " +
                               range(hypothesis.first_later_pose, hypothesis.last_later_pose) +
                               " with poses " +
                               range(hypothesis.first_earlier_pose, hypothesis.last_earlier_pose);
  switch (hypothesis.kind) {
    case HypothesisKind::kMatching:
      return "sequential matching and all closures that agree";
    case HypothesisKind::kOdometry:
      return "the poses of the odometry as given and all closures that agree";
    case HypothesisKind::kOdometryAlone:
      return "the poses of the odometry as given, and no closures";
    case HypothesisKind::kOdometryHeadings:
      return "sequential matching with the headings of the odometry, and all closures that agree";
    case HypothesisKind::kWithoutCluster:
      return "without " + closures;
    case HypothesisKind::kWithMatch:
      return "with " + closures;
    case HypothesisKind::kBrokenSteps:
      return "steps of the robot that may be wrong";
    case HypothesisKind::kJoinedParts:
      return Format("carried before pose %d: %.1f m ahead, %.1f m to the left, turned by %.0f deg",
                    hypothesis.first_pose_after, hypothesis.carried_to.x, hypothesis.carried_to.y,
                    RadToDeg(hypothesis.carried_to.yaw));
  }
  return "unknown";
}

std::vector<const WeighedHypothesis*> RunnersUp(const std::vector<WeighedHypothesis>& hypotheses,
                                                const std::vector<Pose2>& poses, std::size_t most) {
  std::vector<const WeighedHypothesis*> refused;
  for (const WeighedHypothesis& hypothesis : hypotheses) {
    if (!hypothesis.adopted && !hypothesis.world_from_robot.empty() &&
        hypothesis.kind != HypothesisKind::kOdometryAlone) {
      refused.push_back(&hypothesis);
    }
  }
  std::stable_sort(refused.begin(), refused.end(),
                   [](const auto* a, const auto* b) { return a->score < b->score; });
  std::vector<const WeighedHypothesis*> runners_up;
  for (const WeighedHypothesis* hypothesis : refused) {
    const auto is_same = [&](const std::vector<Pose2>& other) {
      return LargestShiftM(hypothesis->world_from_robot, other) < kSameMapM;
    };
    const bool is_known = is_same(poses) || std::any_of(runners_up.begin(), runners_up.end(),
                                                        [&](const WeighedHypothesis* better) {
                                                          return is_same(better->world_from_robot);
                                                        });
    if (!is_known && runners_up.size() < most) runners_up.push_back(hypothesis);
  }
  return runners_up;
}

std::string SeedingText(const SeedingReport& report, const SlamGraph& graph,
                        const std::vector<double>& poses) {
  if (graph.all_scans().size() == 1)
    return "  A single scan: there is nothing to match or to check.\n";
  if (report.start != StartType::kSeed && report.sequential.num_keyframes == 0) {
    return StartText(report.start) + "  No loop was closed.\n";
  }
  std::string text = report.start == StartType::kSeed ? "" : StartText(report.start);
  text += MatchingText(report.sequential, report.odometry_noise.is_prediction,
                       static_cast<int>(graph.all_scans().size()));
  if (report.moving_share > 0.0) {
    text += Format(
        "  People and all else that moves: %.1f %% of the returns, left out of the map's "
        "surfaces.\n",
        kPercent * report.moving_share);
  }
  if (report.sequential.num_keyframes <= 1) return text + NoPathText(report.sequential);
  return text + OdometryText(report.odometry_noise) + LoopsText(report.loops, report.consistency) +
         HypothesesText(report.hypotheses) + SuspectStepsText(report.loops, graph, poses);
}

std::string RangeNoiseText(const MapLogOptions& options, const MappingReport& report) {
  const double assumed_m = options.solver.factors.beam.sigma_range_m;
  const double taken_m = BeamNoise(options, report).sigma_range_m;
  if (taken_m <= assumed_m) return "";
  return Format("  Range noise (one sigma): %.0f mm by neighbouring beams; %.0f mm were assumed.\n",
                kMmPerM * taken_m, kMmPerM * assumed_m);
}

std::string ConsistencyText(const std::string& name, const MapConsistency& consistency) {
  if (consistency.num_pairs_within + consistency.num_pairs_between == 0) return "";
  if (consistency.within_pass.num_compared + consistency.between_passes.num_compared == 0) {
    return "  " + name + " cannot be checked: no scan looks where another one shows something.\n";
  }
  return "  " + name + (consistency.IsContradictory() ? " contradicts itself" : " is consistent") +
         Format(
             ": its worst place has %.1f times the free-space conflicts that can be explained.\n",
             consistency.Ratio()) +
         (consistency.PassesDisagree() ? "  Its visits disagree with one another.\n" : "");
}

}  // namespace plumbline
