// How a seed was found, and whether a map contradicts itself.

#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/solvers/interface/map_consistency.h"
#include "plumbline/solvers/interface/odometry_report.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {
namespace py = pybind11;
namespace {

void BindConsistency(py::module_* module) {
  Fields<FreeSpaceConflict>(module, "FreeSpaceConflict",
                            "Whether returns of one scan lie where another scan looked through.")
      .Field("num_compared", &FreeSpaceConflict::num_compared,
             "returns that the other scan must have seen")
      .Field("num_conflicting", &FreeSpaceConflict::num_conflicting, "those it saw through")
      .Method("share", &FreeSpaceConflict::Share, "Of those compared; 0 without any.");
  Fields<ConflictPeak>(module, "ConflictPeak", "Where on its path a robot's scans conflict most.")
      .Field("conflict", &ConflictPeak::conflict, "of the stretch")
      .Field("pose", &ConflictPeak::pose, "pose id, in the middle of the stretch")
      .Field("usual_ratio", &ConflictPeak::usual_ratio, "of half of such stretches");
  Fields<SpaceConflict>(module, "SpaceConflict",
                        "One scan shows a surface where the other looked through.")
      .Field("viewer_scan", &SpaceConflict::viewer_scan, "scan id: looked through")
      .Field("scan", &SpaceConflict::scan, "scan id: shows the surface")
      .Field("world_point", &SpaceConflict::world_point, "(2,): one of the returns [m]");
  Fields<MapConsistency>(module, "MapConsistency",
                         "How well scans that saw the same places agree on what is free space.")
      .Field("within_pass", &MapConsistency::within_pass, "over pairs of scans of one pass")
      .Field("between_passes", &MapConsistency::between_passes, "of different passes")
      .Field("num_pairs_within", &MapConsistency::num_pairs_within, "pairs of scans of one pass")
      .Field("num_pairs_between", &MapConsistency::num_pairs_between, "of different passes")
      .Field("worst_within", &MapConsistency::worst_within,
             "the place whose two sides conflict most")
      .Field("worst_between", &MapConsistency::worst_between,
             "the stretch that conflicts most with other passes")
      .Field("contradicted_share", &MapConsistency::contradicted_share,
             "share of stretches with more than 3 times what can be explained")
      .Field("usual_ratio_at_rest", &MapConsistency::usual_ratio_at_rest,
             "half of the stretches have no more than this times what can be explained, without "
             "returns of what moves")
      .Field("places", &MapConsistency::places, "pairs of scans with many conflicts")
      .Method("ratio", py::overload_cast<>(&MapConsistency::Ratio, py::const_),
              "Conflicts of the worst place over those that can be explained.")
      .Method("is_contradictory", py::overload_cast<>(&MapConsistency::IsContradictory, py::const_),
              "Whether a part of the map must be wrong.");
}

void BindOdometryReport(py::module_* module) {
  Fields<OdometrySignReport>(module, "OdometrySignReport",
                             "Whether the odometry has lost the sign of its translation.")
      .Field("num_backward_steps", &OdometrySignReport::num_backward_steps, "one is enough")
      .Field("num_decided", &OdometrySignReport::num_decided, "by scan matching alone")
      .Field("num_contradicting", &OdometrySignReport::num_contradicting, "of these")
      .Field("sign_lost", &OdometrySignReport::sign_lost, "what follows");
  Fields<SystematicError>(module, "SystematicError", "An error that stays the same for a log.")
      .Field("value", &SystematicError::value, "per unit of the true motion")
      .Field("sigma", &SystematicError::sigma, "its standard deviation")
      .Method("is_significant", &SystematicError::IsSignificant, "Beyond chance.");
  Fields<ClockOffset>(module, "ClockOffset", "How far the clocks of odometry and laser differ.")
      .Field("value_s", &ClockOffset::value_s, "[s], positive where the wheels are ahead")
      .Field("sigma_s", &ClockOffset::sigma_s, "[s]; 0: unknown")
      .Method("is_significant", &ClockOffset::IsSignificant, "Beyond chance.");
  Fields<RandomError>(module, "RandomError", "Growth of the random error of one quantity.")
      .Field("estimated", &RandomError::estimated, "false: too few spans")
      .Field("num_spans", &RandomError::num_spans, "stretches of about 1 m or 1 rad")
      .Field("sigma_per_sqrt_m", &RandomError::sigma_per_sqrt_m, "[m or rad / sqrt(m)]")
      .Field("sigma_per_sqrt_rad", &RandomError::sigma_per_sqrt_rad, "[m or rad / sqrt(rad)]");
  Fields<PoseNoise>(module, "PoseNoise", "Independent errors of given poses.")
      .Field("position_m", &PoseNoise::position_m, "of x and of y [m]")
      .Field("yaw_rad", &PoseNoise::yaw_rad, "[rad]");
  Fields<OdometryNoiseReport>(module, "OdometryNoiseReport",
                              "What the scan matching says of the odometry.")
      .Field("gross_translation_scale", &OdometryNoiseReport::gross_translation_scale,
             "of the odometry as given; 1 if it is near 1, 0 if it was not used")
      .Field("clock_offset", &OdometryNoiseReport::clock_offset, "to the laser")
      .Field("translation_scale", &OdometryNoiseReport::translation_scale, "[m per m]")
      .Field("rotation_scale", &OdometryNoiseReport::rotation_scale, "[rad per rad]")
      .Field("heading_drift_rad_m", &OdometryNoiseReport::heading_drift_rad_m, "[rad/m]")
      .Field("translation", &OdometryNoiseReport::translation, "of the forward motion [m]")
      .Field("rotation", &OdometryNoiseReport::rotation, "of the turn [rad]")
      .Field("num_leaps", &OdometryNoiseReport::num_leaps,
             "steps that odometry and matching disagree on")
      .Field("num_still_steps", &OdometryNoiseReport::num_still_steps,
             "steps of wheels that stood still while the scans moved")
      .Field("motion", &OdometryNoiseReport::motion, "the same as noise of a single step")
      .Field("is_prediction", &OdometryNoiseReport::is_prediction, "no odometry was used")
      .Field("given_poses", &OdometryNoiseReport::given_poses,
             "their noise, if each scan was searched for around its pose; else zero");
}

void BindLoops(py::module_* module) {
  py::enum_<ClosureOutcome>(*module, "ClosureOutcome", "What became of a pair of places.")
      .value("ACCEPTED", ClosureOutcome::kAccepted)
      .value("NO_MATCH", ClosureOutcome::kNoMatch)
      .value("LOW_OVERLAP", ClosureOutcome::kLowOverlap)
      .value("FREE_SPACE_CONFLICT", ClosureOutcome::kFreeSpaceConflict)
      .value("AMBIGUOUS", ClosureOutcome::kAmbiguous)
      .value("CONTRADICTED", ClosureOutcome::kContradicted);
  Fields<LoopClosureRecord>(module, "LoopClosureRecord", "A match of two places.")
      .Field("from_pose", &LoopClosureRecord::from_pose, "pose id: the earlier visit")
      .Field("to_pose", &LoopClosureRecord::to_pose, "pose id: the later visit")
      .Field("from_from_to", &LoopClosureRecord::from_from_to, "the later seen from the earlier")
      .Field("outcome", &LoopClosureRecord::outcome, "what became of it");
  Fields<SuspectStep>(module, "SuspectStep", "Where the scans before and after disagreed.")
      .Field("first_pose_after", &SuspectStep::first_pose_after, "pose id")
      .Field("evidence", &SuspectStep::evidence, "from 0.15 to 1.6")
      .Field("broken", &SuspectStep::broken, "the step was wrong, closures put it right")
      .Field("unmatched", &SuspectStep::unmatched, "a scan matched nothing near by")
      .Field("turned_rad", &SuspectStep::turned_rad, "by the repair [rad]")
      .Field("num_closures_across", &SuspectStep::num_closures_across, "from before to after it")
      .Field("num_alternatives", &SuspectStep::num_alternatives, "other places that fit as well")
      .Method("is_unresolved", &SuspectStep::IsUnresolved, "It looks wrong, nothing settles it.");
  Fields<LoopClosingReport>(module, "LoopClosingReport", "What the search for loops found.")
      .Field("num_candidates", &LoopClosingReport::num_candidates, "places tried")
      .Field("num_closures", &LoopClosingReport::num_closures, "accepted and kept")
      .Field("num_contradicted", &LoopClosingReport::num_contradicted,
             "accepted first, then contradicted")
      .Field("matches", &LoopClosingReport::matches, "and what became of them")
      .Field("suspect_steps", &LoopClosingReport::suspect_steps, "in order of time")
      .Method("is_unresolved", &LoopClosingReport::IsUnresolved, "Whether a step is left open.");
}

void BindHypotheses(py::module_* module) {
  py::enum_<HypothesisKind>(*module, "HypothesisKind", "What is assumed about a drive.")
      .value("MATCHING", HypothesisKind::kMatching, "the scan matching is right")
      .value("ODOMETRY", HypothesisKind::kOdometry, "likewise, from the odometry's poses")
      .value("ODOMETRY_ALONE", HypothesisKind::kOdometryAlone, "no loop is closed")
      .value("ODOMETRY_HEADINGS", HypothesisKind::kOdometryHeadings,
             "the odometry has the headings")
      .value("WITHOUT_CLUSTER", HypothesisKind::kWithoutCluster, "a cluster of closures is wrong")
      .value("WITH_MATCH", HypothesisKind::kWithMatch, "a match that was no closure holds")
      .value("BROKEN_STEPS", HypothesisKind::kBrokenSteps, "some steps are wrong")
      .value("JOINED_PARTS", HypothesisKind::kJoinedParts, "the robot was carried");
  Fields<WeighedHypothesis>(module, "WeighedHypothesis",
                            "An explanation of the drive that was weighed.")
      .Field("kind", &WeighedHypothesis::kind, "what it assumes")
      .Field("num_closures", &WeighedHypothesis::num_closures, "in force, or in question")
      .Field("conflict", &WeighedHypothesis::conflict, "of its map")
      .Field("score", &WeighedHypothesis::score, "the lower, the better")
      .Field("adopted", &WeighedHypothesis::adopted, "the seed is made of it")
      .FieldBy(
          "poses",
          [](const WeighedHypothesis& hypothesis) {
            return ArrayOf(PoseArray(hypothesis.world_from_robot), 3);
          },
          "(N, 3): x, y [m], yaw [rad] per pose; empty for changes of single closures");
}

}  // namespace

void BindSeedReports(py::module_* module) {
  BindConsistency(module);
  BindOdometryReport(module);
  BindLoops(module);
  BindHypotheses(module);
  Fields<SequentialSeedingReport>(module, "SequentialSeedingReport", "What scan matching found.")
      .Field("odometry_sign", &SequentialSeedingReport::odometry_sign)
      .Field("num_keyframes", &SequentialSeedingReport::num_keyframes, "of all scans")
      .Field("num_reversed_steps", &SequentialSeedingReport::num_reversed_steps,
             "driven against the odometry's sign")
      .Field("num_recovered", &SequentialSeedingReport::num_recovered,
             "matched from a start off the odometry")
      .Field("num_unmatched", &SequentialSeedingReport::num_unmatched, "follow the odometry");
  Fields<SeedingReport>(module, "SeedingReport", "How a seed was found, and whether to trust it.")
      .Field("start", &SeedingReport::start, "where the solver starts")
      .Field("sequential", &SeedingReport::sequential, "scan matching")
      .Field("moving_share", &SeedingReport::moving_share,
             "of the returns, left out of the matching as people; 0 if so few that they were not")
      .Field("odometry_noise", &SeedingReport::odometry_noise, "by what the scans say")
      .Field("loops", &SeedingReport::loops, "loops closed and refused")
      .Field("consistency", &SeedingReport::consistency, "of the seed")
      .Field("hypotheses", &SeedingReport::hypotheses, "in the order of their weighing")
      .Field("pose_graph", &SeedingReport::pose_graph, "the seed's last pose graph")
      .Field("corrections", &SeedingReport::corrections,
             "of the odometry, and what moves, for SlamGraph.corrected")
      .Field("alarm", &SeedingReport::alarm, "the seed is probably wrong")
      .Method("repaired", &SeedingReport::Repaired,
              "Whether a wrong step of the matching was found and put right.");
}

}  // namespace plumbline
