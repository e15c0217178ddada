#ifndef PLUMBLINE_APPS_REPORT_REPORT_JSON_H_
#define PLUMBLINE_APPS_REPORT_REPORT_JSON_H_

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "plumbline/apps/evaluation/map_sharpness.h"
#include "plumbline/apps/io/warning.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/alarm.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

// Insertion order is easier on the reader than the alphabet.
using Json = nlohmann::ordered_json;

/// The program's flags by name, as numbers, booleans or text.
Json FlagsInForce();

Json SolverJson(const SolverSummary& solver);

/// One object per stage; errors only where the truth is known, null for what cannot be measured.
Json StagesJson(const std::vector<Stage>& stages);

/// One object per radius.
Json SharpnessJson(const std::vector<SharpnessAtRadius>& radii);

Json ConsistencyJson(const MapConsistency& map);

/// One object per alarm: scan (null if none was taken there), time, place, reason.
Json AlarmsJson(const std::vector<Alarm>& alarms);

/// One object per warning: id, message.
Json WarningsJson(const std::vector<Warning>& warnings);

/// Of the signal that has ended an estimation early; null for an empty name.
Json StoppedByJson(const std::string& signal_name);

/// Unavailable if the file cannot be written. Text that is not UTF-8, as a path may be,
/// gets replacement characters; numbers that are not finite become null.
Status WriteJson(const std::string& path, const Json& json);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_REPORT_JSON_H_
