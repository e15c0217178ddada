#include "plumbline/solvers/alarm.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <sstream>

namespace plumbline {
namespace {

// Of the floors of the seeding study (apps/benchmark) that ended with such an alarm, the share
// whose map was wrong; see "How sure a warning is" there.
constexpr double kWrongIfContradictory = 0.94;
constexpr double kWrongIfUnresolved = 0.07;

// Smallest share of returns with a normal on which matching can rest. Real logs have 0.58 (bushes)
// to 0.98, 4 beams over 360 deg have 0.01.
constexpr double kMinSurfaceShare = 0.1;
// Largest share of scans that match nothing near by. Real logs have 0.017 at most, 4 beams over 360
// deg have 0.8.
constexpr double kMaxUnmatchedShare = 0.25;

constexpr char kBeforeRefinement[] = " before the refinement, though not after it";

// The alarm of one peak, if that peak by itself is a contradiction.
void CheckPeak(const MapConsistency& consistency, const ConflictPeak& peak, const std::string& what,
               const SlamGraph& graph, const std::vector<double>& poses,
               std::vector<Alarm>* alarms) {
  if (!consistency.IsContradictory(peak)) return;
  std::ostringstream reason;
  reason << what << std::fixed << std::setprecision(1) << " (" << consistency.Ratio(peak)
         << " times the conflicts that people, doors and noise explain)";
  alarms->push_back({PlaceOfPose(graph, poses, peak.pose), reason.str(), kWrongIfContradictory});
}

Alarm UnresolvedStep(const SuspectStep& step, const SlamGraph& graph,
                     const std::vector<double>& poses) {
  std::string reason = "the scans before and after disagree, and ";
  if (step.num_alternatives > 0) {
    reason += "all that comes later fits at " + std::to_string(step.num_alternatives) + " other " +
              (step.num_alternatives == 1 ? "place" : "places") + " as well";
  } else if (step.num_closures_across >= SuspectStep::kMinClosuresAcross) {
    reason += "the repair turned all that comes later, which might fit elsewhere as well";
  } else {
    reason += step.num_closures_across == 0 ? "no loop closure ties" : "a single loop closure ties";
    reason += " them together: all that comes later may be displaced";
  }
  return {PlaceOfPose(graph, poses, step.first_pose_after), reason, kWrongIfUnresolved};
}

// Of several sessions, which no odometry joins, another one may disagree for what has moved.
bool IsOneDrive(const SlamGraph& graph) {
  return static_cast<int>(graph.odometry().size()) + 1 >= graph.num_poses();
}

Alarm DisagreeingPasses(const MapConsistency& consistency, const SlamGraph& graph,
                        const std::vector<double>& poses) {
  std::ostringstream reason;
  reason << std::fixed << std::setprecision(2) << "visits look through each other's surfaces ("
         << 100.0 * consistency.between_passes.Share()
         << " % of what they compare) far more often than the scans of one visit do ("
         << 100.0 * consistency.within_pass.Share()
         << " %): places that look alike may lie on each other";
  return {PlaceOfPose(graph, poses, consistency.worst_between.pose), reason.str(), std::nullopt};
}

// Of the refined map, or else of the seed.
void CheckPasses(const SeedingReport& seeding, const MapConsistency& refined,
                 const SlamGraph& graph, const std::vector<double>& poses,
                 std::vector<Alarm>* alarms) {
  if (!IsOneDrive(graph)) return;
  if (refined.PassesDisagree()) {
    alarms->push_back(DisagreeingPasses(refined, graph, poses));
  } else if (seeding.consistency.PassesDisagree()) {
    alarms->push_back(DisagreeingPasses(seeding.consistency, graph, poses));
    alarms->back().reason += kBeforeRefinement;
  }
}

}  // namespace

std::string ScanPlace::Text() const {
  std::ostringstream text;
  text << (scan ? "scan " + std::to_string(*scan) : "a pose without scan") << std::fixed
       << std::setprecision(2) << " (t = " << time_s << " s, x = " << world_position.x()
       << " m, y = " << world_position.y() << " m)";
  return text.str();
}

std::string Alarm::Text() const {
  if (!wrong_share) return reason;
  return reason + " (" + std::to_string(std::lround(100.0 * *wrong_share)) +
         " % of the simulated maps with such a warning were wrong)";
}

ScanPlace PlaceOfPose(const SlamGraph& graph, const std::vector<double>& poses, int pose) {
  ScanPlace place;
  const std::vector<ScanEntry>& scans = graph.all_scans();
  const auto found = std::find_if(scans.begin(), scans.end(),
                                  [pose](const ScanEntry& scan) { return scan.pose == pose; });
  if (found != scans.end()) place.scan = static_cast<int>(found - scans.begin());
  place.time_s = graph.timestamp_s(pose);
  place.world_position = Pose2(&poses[3 * pose]).translation();
  return place;
}

std::string AlarmText(const std::vector<Alarm>& alarms) {
  constexpr std::size_t kMaxLines = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(alarms.size(), kMaxLines); ++i) {
    text += std::string("WARNING: the map ") + (alarms[i].IsProbable() ? "is probably" : "may be") +
            " wrong around " + alarms[i].place.Text() + ": " + alarms[i].Text() + ".\n";
  }
  if (alarms.size() > kMaxLines) {
    text += "WARNING: and around " + std::to_string(alarms.size() - kMaxLines) + " more places.\n";
  }
  return text;
}

std::vector<Alarm> MapAlarms(const MapConsistency& consistency, const SlamGraph& graph,
                             const std::vector<double>& poses) {
  std::vector<Alarm> alarms;
  CheckPeak(consistency, consistency.worst_within,
            "scans before and after look through each other's surfaces", graph, poses, &alarms);
  CheckPeak(consistency, consistency.worst_between,
            "scans of other visits look through the surfaces seen there", graph, poses, &alarms);
  if (alarms.empty() && consistency.IsContradictory()) {
    std::ostringstream reason;
    reason << "many of the places that were seen on several visits contradict each other, "
              "this one most of all";
    alarms.push_back({PlaceOfPose(graph, poses, consistency.worst_between.pose), reason.str(),
                      kWrongIfContradictory});
  }
  return alarms;
}

std::vector<Alarm> FrozenLaserAlarms(const std::vector<FrozenStretch>& frozen,
                                     const SlamGraph& graph, const std::vector<double>& poses) {
  std::vector<Alarm> alarms;
  for (const FrozenStretch& stretch : frozen) {
    std::ostringstream reason;
    reason << "the laser gave the same scan " << stretch.num_repeated << " times more, up to scan "
           << stretch.last_scan << ", while the wheels drove " << std::fixed << std::setprecision(1)
           << stretch.moved_m
           << " m: the repetitions are left out, and these poses are the odometry's";
    alarms.push_back({PlaceOfPose(graph, poses, graph.all_scans()[stretch.first_scan].pose),
                      reason.str(), std::nullopt});
  }
  return alarms;
}

std::vector<Alarm> MisplacedScanAlarms(const std::vector<int>& misplaced, const SlamGraph& graph,
                                       const std::vector<double>& poses) {
  if (misplaced.empty()) return {};
  const std::string scans = misplaced.size() == 1
                                ? "this scan lies"
                                : std::to_string(misplaced.size()) + " scans, from here on, lie";
  return {{PlaceOfPose(graph, poses, misplaced.front()),
           scans + " some decimetres beside where the map shows what they saw", std::nullopt}};
}

std::vector<Alarm> WorseThanStartAlarms(const AcceptanceTest& acceptance, const SlamGraph& graph,
                                        const std::vector<double>& poses) {
  if (poses.empty() || acceptance.KeepsHeldOutError()) return {};
  std::ostringstream reason;
  reason << std::fixed << std::setprecision(3)
         << "the solver made the map worse than its start: the error of held-out returns rose from "
         << acceptance.seed_held_out_error << " to " << acceptance.final_held_out_error
         << " sigmas^2";
  return {{PlaceOfPose(graph, poses, 0), reason.str(), std::nullopt}};
}

std::vector<Alarm> UncheckedMapAlarms(double surface_share, double unmatched_share,
                                      const SlamGraph& graph, const std::vector<double>& poses) {
  const bool lacks_surfaces = surface_share < kMinSurfaceShare;
  if (poses.empty() || (!lacks_surfaces && unmatched_share <= kMaxUnmatchedShare)) return {};
  std::ostringstream reason;
  reason << std::fixed << std::setprecision(1);
  if (lacks_surfaces) {
    reason << "only " << 100.0 * surface_share << " % of the returns show a surface";
  } else {
    reason << 100.0 * unmatched_share << " % of the scans match nothing near by";
  }
  reason << ", so many poses are the odometry's, and nothing tells whether they are right";
  return {{PlaceOfPose(graph, poses, 0), reason.str(), std::nullopt}};
}

std::vector<Alarm> BentStretchAlarms(const std::vector<BentStretch>& bent, const SlamGraph& graph,
                                     const std::vector<double>& poses) {
  std::vector<Alarm> alarms;
  for (const BentStretch& stretch : bent) {
    std::ostringstream reason;
    reason << "this session is bent by " << std::fixed << std::setprecision(2) << stretch.bend_m
           << " m here to fit the others: something may have moved between them";
    alarms.push_back({PlaceOfPose(graph, poses, stretch.last_pose), reason.str(), std::nullopt});
  }
  return alarms;
}

std::vector<Alarm> RunAlarms(const SeedingReport& seeding, const MapConsistency& refined,
                             const SlamGraph& graph, const std::vector<double>& poses) {
  std::vector<Alarm> alarms = MapAlarms(refined, graph, poses);
  if (alarms.empty()) CheckPasses(seeding, refined, graph, poses, &alarms);
  for (const SuspectStep& step : seeding.loops.suspect_steps) {
    if (step.IsUnresolved()) alarms.push_back(UnresolvedStep(step, graph, poses));
  }
  return alarms;
}

}  // namespace plumbline
