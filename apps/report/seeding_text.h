#ifndef PLUMBLINE_APPS_REPORT_SEEDING_TEXT_H_
#define PLUMBLINE_APPS_REPORT_SEEDING_TEXT_H_

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// How many matches of places met each outcome; outcomes that none met are left out.
std::map<ClosureOutcome, int> CountOutcomes(const LoopClosingReport& loops);

/// What a hypothesis says, as "without 12 closures of poses 8928-8992 with poses 54-6346".
std::string HypothesisText(const WeighedHypothesis& hypothesis);

/// The hypotheses that were refused although they came nearest to the one that was adopted, the
/// best first, `most` at most. Of them those with a map of their own: one that is neither the
/// odometry's nor, to half a metre, the one that was adopted, `poses`, or one of a better one.
std::vector<const WeighedHypothesis*> RunnersUp(const std::vector<WeighedHypothesis>& hypotheses,
                                                const std::vector<Pose2>& poses, std::size_t most);

/// What people need to know of a seeding, a fact per line, indented: what was matched, how good the
/// odometry is, which loops were closed, which steps were wrong. graph: a scan per pose; poses: of
/// the seed, (x, y, yaw) each.
std::string SeedingText(const SeedingReport& report, const SlamGraph& graph,
                        const std::vector<double>& poses);

/// A line on the range noise that the scans show, if that is taken instead of the options'
/// (BeamNoise).
std::string RangeNoiseText(const MapLogOptions& options, const MappingReport& report);

/// A line on whether the map contradicts itself, or cannot be checked as no scan sees what others
/// show; nothing if the robot went too little way for its scans to be compared. name: of the map.
std::string ConsistencyText(const std::string& name, const MapConsistency& consistency);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_SEEDING_TEXT_H_
