#ifndef PLUMBLINE_SOLVERS_INTERFACE_MAP_CONSISTENCY_H_
#define PLUMBLINE_SOLVERS_INTERFACE_MAP_CONSISTENCY_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// Whether returns of one scan lie where another scan looked through.
struct FreeSpaceConflict {
  int num_compared = 0;     ///< returns that the other scan must have seen
  int num_conflicting = 0;  ///< of these, the ones it saw through

  /// Of the returns compared, those that conflict; 0 without any.
  double Share() const {
    return num_compared > 0 ? static_cast<double>(num_conflicting) / num_compared : 0.0;
  }
  /// What it weighs against a match, in shares of matched points: a third of the returns in
  /// conflict is as bad as no match at all.
  double Penalty() const { return 3.0 * Share(); }
  /// Adds the counts of another comparison.
  FreeSpaceConflict& operator+=(const FreeSpaceConflict& other) {
    num_compared += other.num_compared;
    num_conflicting += other.num_conflicting;
    return *this;
  }
  /// Takes the counts of another comparison off.
  FreeSpaceConflict& operator-=(const FreeSpaceConflict& other) {
    num_compared -= other.num_compared;
    num_conflicting -= other.num_conflicting;
    return *this;
  }
};

/// Two scans, of which one shows a surface where the other looked through.
struct SpaceConflict {
  int viewer_scan = 0;                                    ///< looked through
  int scan = 0;                                           ///< shows the surface
  Eigen::Vector2d world_point = Eigen::Vector2d::Zero();  ///< one of the returns in question [m]
};

/// Where on its path a robot's scans conflict most, and how much.
struct ConflictPeak {
  FreeSpaceConflict conflict;  ///< of the stretch
  int pose = 0;                ///< in the middle of the stretch
  /// Half of the stretches of the same kind, where enough was compared, have no more than this
  /// times the conflicts that can be explained: how much people, doors, glass and bushes there are
  /// all over the place. Returns of what moves count as well: where people go, doors do.
  double usual_ratio = 0.0;
};

/// What the scan of one place of the path has to do with others.
struct ViewpointConflict {
  int pose = 0;                      ///< pose id
  FreeSpaceConflict within_pass;     ///< over the pairs of one pass that the scan is part of
  FreeSpaceConflict between_passes;  ///< over its pairs of different passes
};

/// How well the scans of a robot that saw the same places, in one pass or in several, agree on what
/// is free space. Returns of people and all else that moves count nowhere, but for what is usual.
struct MapConsistency {
  FreeSpaceConflict within_pass;     ///< sum over pairs of scans of one pass, both ways
  FreeSpaceConflict between_passes;  ///< sum over pairs of scans of different passes, both ways
  int num_pairs_within = 0;          ///< pairs of scans of one pass
  int num_pairs_between = 0;         ///< pairs of scans of different passes
  /// The place of the path whose two sides, up to 5 m each, conflict most with one another: where a
  /// jump of the poses would be.
  ConflictPeak worst_within;
  /// The stretch of 6 m of path that conflicts most with other passes.
  ConflictPeak worst_between;
  /// Share of such stretches with more than 3 times the conflicts that can be explained.
  double contradicted_share = 0.0;
  /// Half of such stretches, where enough was compared, have no more than this times the conflicts
  /// that can be explained, here without what moves.
  double usual_ratio_at_rest = 0.0;
  /// Per scan that was compared, in order of the path.
  std::vector<ViewpointConflict> viewpoints;
  /// One per pair and direction with many conflicting returns, in order of the scans.
  std::vector<SpaceConflict> places;

  /// Share of conflicting returns that people, doors, glass and noise explain: the share within one
  /// pass, but no less than doors that open and close bring about between two passes, and no more
  /// than a crowd does.
  double ExplicableShare() const;

  /// Share of conflicting returns within one pass, but no less than kLeastShare.
  double UsualShare() const;

  /// Within and between passes.
  FreeSpaceConflict AllConflicts() const;

  /// Conflicts of a peak over the ones that can be explained: by the explicable share, and by what
  /// is usual on this drive where that is more than a sixth of it. (Simulated drives have a
  /// fiftieth of it, and peaks below 1; real ones that are right have a tenth to a half, and peaks
  /// of 1.3 to 4 before what is usual is taken off: the share of a peak grows with the share of the
  /// rest.) What is usual excuses three times as much at most. Drawn towards 1 where little was
  /// compared, and 1 where nothing was.
  double Ratio(const ConflictPeak& peak) const;

  /// The same without what is usual.
  static double RatioOf(const FreeSpaceConflict& conflict, double explicable_share);
  /// Returns that agree, put to those of a peak: a person is no proof if little else was compared.
  /// As many as three or four pairs of scans of 180 beams compare; the worst stretches of the logs
  /// that this was tuned on compare 200 to 11000.
  static constexpr double kPriorReturns = 600.0;
  /// A part of a map is wrong that conflicts this many times as much as can be explained. The
  /// logs that this was tuned on have 0.8 to 1.8 at their worst, but for fr-clinic with 3.02.
  static constexpr double kMaxRatio = 3.0;

  /// Whether a part of the map must be wrong there: the ratio is above kMaxRatio.
  bool IsContradictory(const ConflictPeak& peak) const;

  /// The peak of the higher ratio, and what is said of it.
  const ConflictPeak& WorstPeak() const;
  /// Of the worst peak.
  double Ratio() const { return Ratio(WorstPeak()); }
  /// Sound maps stay below this ratio.
  static constexpr double kSuspiciousRatio = 2.0;
  /// That, or a quarter of all stretches contradict other passes, or half of them do a little.
  bool IsContradictory() const;

  /// Whether passes conflict with one another out of all proportion to what conflicts within each:
  /// as where places that look alike lie on each other, and none conflicts enough to prove it.
  /// Furniture that moved between sessions does that, too. A reason to look for another map of a
  /// single drive, and to warn if there is none.
  bool PassesDisagree() const;
  /// Above this many times the share within a pass, that taken as 0.002 at least. Right maps of the
  /// logs that this was tuned on have 0.7 to 2.5. Two floors of identical rooms, where a carried
  /// robot was matched to the wrong one, have 18 and 20.
  static constexpr double kMaxBetweenOverWithin = 6.0;
  /// What noise and grazing beams bring about in a drive without people.
  static constexpr double kLeastShare = 0.002;

  /// Share of conflicting returns of different passes over the one within a pass; not finite where
  /// one pass has no conflict.
  double BetweenOverWithin() const { return between_passes.Share() / within_pass.Share(); }
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_MAP_CONSISTENCY_H_
