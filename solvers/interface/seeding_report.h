#ifndef PLUMBLINE_SOLVERS_INTERFACE_SEEDING_REPORT_H_
#define PLUMBLINE_SOLVERS_INTERFACE_SEEDING_REPORT_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/map_consistency.h"
#include "plumbline/solvers/interface/odometry_report.h"
#include "plumbline/solvers/interface/seeding_options.h"

namespace plumbline {

/// Scans of one laser that show the same returns, bit for bit, although the robot drove on: a
/// driver that hands out its last sweep again and again.
struct FrozenStretch {
  int laser = 0;            ///< laser id
  int first_scan = 0;       ///< scan id: the genuine one
  int last_scan = 0;        ///< scan id: the last repetition
  int num_repeated = 0;     ///< scans of this laser after the first, up to the last
  double moved_m = 0.0;     ///< length of the path meanwhile, by odometry [m]
  double turned_rad = 0.0;  ///< sum of the turns meanwhile, without sign, by odometry [rad]
};

/// A stretch of one session of several that lies otherwise in their map than by its own scans.
struct BentStretch {
  int first_pose = 0;   ///< pose ids in the map
  int last_pose = 0;    ///< see first_pose
  double bend_m = 0.0;  ///< how far off its end is, seen from its start
};

/// What the sequential matching found.
struct SequentialSeedingReport {
  OdometrySignReport odometry_sign;  ///< whether the odometry has lost the sign of its translation
  int num_keyframes = 0;             ///< of all scans
  int num_reversed_steps = 0;        ///< steps driven against the odometry's sign
  int num_recovered = 0;             ///< scans that were matched only from a start off the odometry
  /// Scans that follow the odometry: nothing near by fits, or not well enough to believe in a slip.
  int num_unmatched = 0;
};

/// What became of a pair of places that looked alike.
enum class ClosureOutcome {
  kAccepted,
  kNoMatch,            ///< nothing in the window fits
  kLowOverlap,         ///< too little of the scan lies on surfaces of the map
  kFreeSpaceConflict,  ///< one visit looked through what the other one saw
  kAmbiguous,          ///< another place fits as well
  kContradicted,       ///< the pose graph or the map cannot agree with it
};

const char* ToString(ClosureOutcome outcome);

/// A match of two places, by the poses of the graph, and what became of it.
struct LoopClosureRecord {
  int from_pose = 0;   ///< pose id: the earlier visit
  int to_pose = 0;     ///< pose id: the later visit
  Pose2 from_from_to;  ///< the later robot as the earlier one sees it
  ClosureOutcome outcome = ClosureOutcome::kAccepted;  ///< what became of it
};

/// A place of the path where the scans before and after it disagreed.
struct SuspectStep {
  int first_pose_after = 0;  ///< pose id: the first one that disagrees with those before
  /// Of the disagreement, up to 1.6; from 0.15 on where that alone makes the step suspect.
  double evidence = 0.0;
  bool broken = false;  ///< the step was wrong; closures across it put it right
  /// A scan here matched nothing near by, which is rare on this drive: a step is the odometry's.
  bool unmatched = false;
  /// How far the repair has turned what lies beyond it [rad]. Many buildings look alike turned by a
  /// right angle or half a turn, and nothing but the odometry says which it was.
  double turned_rad = 0.0;
  int num_closures_across = 0;  ///< loop closures from before the step to after it
  /// Other places where what lies beyond it would contradict the map as little.
  int num_alternatives = 0;

  /// It looks wrong, and too few closures tie its two sides together.
  bool IsUntied() const;
  /// It looks wrong, and nothing else says for certain how what lies before and after it is tied
  /// together.
  bool IsUnresolved() const;
  /// An edge with this much evidence against it ties nothing together on its own. Real drives
  /// through sound places stay below it but for one edge of a thousand.
  static constexpr double kUntrustedEvidence = 0.5;
  /// Far from a right angle, and more than a step that is merely off. Not tuned.
  static constexpr double kMaxCertainTurnRad = 0.5;
  /// It gives way to this many closures across it: one alone could be a mistake.
  static constexpr int kMinClosuresAcross = 2;
};

/// What the search for loop closures found.
struct LoopClosingReport {
  int num_candidates = 0;    ///< places tried, over all rounds
  int num_closures = 0;      ///< accepted and kept
  int num_contradicted = 0;  ///< accepted first, then contradicted by the pose graph
  /// Every match that became a closure, was contradicted, or was refused: next to a suspect edge,
  /// where matches are tried once, or in the last round, which tries the others anew.
  std::vector<LoopClosureRecord> matches;
  std::vector<SuspectStep> suspect_steps;  ///< in order of time

  /// Whether a suspect step is left that nothing settles.
  bool IsUnresolved() const;
};

/// What a hypothesis about a drive assumes.
enum class HypothesisKind {
  kMatching,          ///< the sequential matching is right, and so are the loop closures
  kOdometry,          ///< likewise, from the poses that the odometry gave
  kOdometryAlone,     ///< the odometry is right as it is; no loop is closed
  kOdometryHeadings,  ///< as kMatching, but over long stretches the odometry has the headings
  kWithoutCluster,    ///< one cluster of closures is a mistake: places look alike, or changed
  kWithMatch,         ///< a match that is no closure by itself holds: the map is better with it
  kBrokenSteps,       ///< some steps are wrong: a slip, or the robot was carried
  kJoinedParts,       ///< the robot was carried: what lies beyond a step fits at another place
};

const char* ToString(HypothesisKind kind);

/// A hypothesis that was weighed, and how well its map agrees with itself.
struct WeighedHypothesis {
  HypothesisKind kind = HypothesisKind::kMatching;  ///< what it assumes
  /// kWithoutCluster, kWithMatch: poses of the closures in question, at their later and their
  /// earlier ends.
  int first_later_pose = 0;
  int last_later_pose = 0;     ///< see first_later_pose
  int first_earlier_pose = 0;  ///< see first_later_pose
  int last_earlier_pose = 0;   ///< see first_later_pose
  int num_closures = 0;        ///< in force; kWithoutCluster, kWithMatch: in question
  /// kJoinedParts: where the keyframe after the step lies, seen from the one before it, and the
  /// first pose after the step.
  Pose2 carried_to;
  int first_pose_after = 0;  ///< see carried_to
  /// Compared and conflicting returns within and between passes.
  FreeSpaceConflict conflict;
  /// Negative log posterior, up to a constant, in conflicting returns: the lower, the better. It
  /// sums the conflicts beyond the usual share and the cost of assumptions.
  double score = 0.0;
  bool adopted = false;  ///< the seed is made of it
  /// The map that it makes: a pose per pose of the graph. kWithoutCluster, kWithMatch: none.
  std::vector<Pose2> world_from_robot;
};

/// What the seeding found, and whether to trust it.
struct SeedingReport {
  /// Where the solver starts. Without kSeed only what else needs it was sought: for solvers of pose
  /// graphs all, for the others nothing but the consistency of the start.
  StartType start = StartType::kSeed;
  SequentialSeedingReport sequential;  ///< scan matching
  /// Share of the returns that is of people and all else that moves, if that is so much that it was
  /// left out of the matching: scans were matched, and surfaces are fitted, without it. Else 0.
  double moving_share = 0.0;
  OdometryNoiseReport odometry_noise;         ///< how the odometry errs, by what the scans say
  LoopClosingReport loops;                    ///< loops closed and refused, and suspect steps
  MapConsistency consistency;                 ///< of the seed, or of another start
  std::vector<WeighedHypothesis> hypotheses;  ///< in the order in which they were weighed
  /// The seed's last pose graph, by the graph's poses; see seed_pose_graph.h.
  std::vector<RelativePoseConstraint> pose_graph;
  /// What the odometry should have said of the motion, with a lost sign and significant systematic
  /// errors corrected, and which returns are of what moves if they were left out of the matching
  /// (in a map of several sessions, the graph has that). SlamGraph::Corrected applies it, and a
  /// joint estimation should get that.
  MeasurementCorrections corrections;
  /// world_from_robot of every pose before loops were closed.
  std::vector<Pose2> sequential_poses;
  /// The seed is probably wrong: the map contradicts itself, or the scans before and after a step
  /// disagree and nothing else ties them together, or its passes disagree, if it is of one drive.
  bool alarm = false;

  /// Whether a wrong step of the sequential matching was found and put right.
  bool Repaired() const;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_SEEDING_REPORT_H_
