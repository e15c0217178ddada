#ifndef PLUMBLINE_SOLVERS_ALARM_H_
#define PLUMBLINE_SOLVERS_ALARM_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/acceptance.h"
#include "plumbline/solvers/interface/map_consistency.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// A scan of a graph, as people look for it.
struct ScanPlace {
  std::optional<int> scan;  ///< none if none was taken there
  double time_s = 0.0;      ///< of the scan, or of the pose if there is none
  Eigen::Vector2d world_position = Eigen::Vector2d::Zero();  ///< of the robot [m]

  /// For people, with time and position.
  std::string Text() const;
};

/// The first scan taken at a pose. poses: (x, y, yaw) each.
ScanPlace PlaceOfPose(const SlamGraph& graph, const std::vector<double>& poses, int pose);

/// Why a map is probably wrong, or may be, and where.
struct Alarm {
  ScanPlace place;     ///< where
  std::string reason;  ///< why, for people
  /// How sure that is: of simulated drives with a fault and such an alarm, the share whose map was
  /// wrong. None if too few had it.
  std::optional<double> wrong_share;

  /// More likely than not, by the maps that had such an alarm.
  bool IsProbable() const { return wrong_share.value_or(0.0) > 0.5; }
  /// For people: why, and how sure that is.
  std::string Text() const;
};

/// A warning per line, for people: the first few, and how many more there are.
std::string AlarmText(const std::vector<Alarm>& alarms);

/// Where a map contradicts itself, as `consistency` says of these poses: at most one alarm for the
/// scans of one pass and one for those of different passes.
std::vector<Alarm> MapAlarms(const MapConsistency& consistency, const SlamGraph& graph,
                             const std::vector<double>& poses);

/// Where the laser was frozen: nothing but the odometry tells of these poses.
std::vector<Alarm> FrozenLaserAlarms(const std::vector<FrozenStretch>& frozen,
                                     const SlamGraph& graph, const std::vector<double>& poses);

/// Where scans fit the map, but not where they lie (FindMisplacedScans): at most one alarm.
/// misplaced: such poses.
std::vector<Alarm> MisplacedScanAlarms(const std::vector<int>& misplaced, const SlamGraph& graph,
                                       const std::vector<double>& poses);

/// At most one alarm, if held-out returns fit a result clearly worse than its start that is
/// returned all the same, as by kPublished, which has no acceptance test.
std::vector<Alarm> WorseThanStartAlarms(const AcceptanceTest& acceptance, const SlamGraph& graph,
                                        const std::vector<double>& poses);

/// At most one alarm, if hardly any return shows a surface or many scans match nothing near by:
/// then poses are the odometry's, and no comparison of scans tells whether they are right.
/// surface_share: share of the returns with a normal. unmatched_share: share of the scans.
std::vector<Alarm> UncheckedMapAlarms(double surface_share, double unmatched_share,
                                      const SlamGraph& graph, const std::vector<double>& poses);

/// Where one of several sessions was bent to fit the others.
std::vector<Alarm> BentStretchAlarms(const std::vector<BentStretch>& bent, const SlamGraph& graph,
                                     const std::vector<double>& poses);

/// What is wrong after seeding and refinement: steps that the seeding left unresolved, and
/// contradictions of the refined map. A seed whose passes disagree counts, too: the refinement may
/// hide that. Other contradictions of the seed that the refinement has removed do not count.
/// Places are given by `poses`.
std::vector<Alarm> RunAlarms(const SeedingReport& seeding, const MapConsistency& refined,
                             const SlamGraph& graph, const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ALARM_H_
