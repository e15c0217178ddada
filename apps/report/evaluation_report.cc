#include "plumbline/apps/report/evaluation_report.h"

#include <nlohmann/json.hpp>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/report/format.h"
#include "plumbline/apps/report/report_json.h"

namespace plumbline {
namespace {

std::string StatisticsRow(const char* name, const char* unit, const ErrorStatistics& statistics) {
  return Format("%-26s%-6s%10.4f%10.4f%10.4f%10.4f%10.4f%10.4f", name, unit, statistics.mean,
                statistics.std, statistics.rmse, statistics.median, statistics.p95, statistics.max);
}

std::string ErrorRows(const char* name, const PoseErrorStatistics& errors) {
  if (errors.num_matched == 0) return Format("%-26snone\n", name);
  return StatisticsRow(name, "m", errors.translation_m) +
         Format("%10zu%11zu\n", errors.num_matched, errors.num_unmatched) +
         StatisticsRow("", "deg", errors.rotation_deg) + "\n";
}

std::string ErrorHeader() {
  return Format("%-26s%-6s%10s%10s%10s%10s%10s%10s%10s%11s\n", "", "unit", "mean", "std", "rmse",
                "median", "p95", "max", "matched", "unmatched");
}

std::string SharpnessRows(const char* name, const MapSharpness& map) {
  std::string rows;
  for (const SharpnessAtRadius& at : map.radii) {
    rows += Format("%-26s%6.2f m%15.2f mm%14.4f%10zu\n", name, at.radius_m,
                   1e3 * at.quality.wall_thickness_m, at.quality.mean_map_entropy,
                   at.quality.num_samples);
    name = "";
  }
  return rows;
}

std::string ConflictRow(const char* name, const FreeSpaceConflict& conflict) {
  return Format("%-26s%12d%12d%10.2f %%", name, conflict.num_compared, conflict.num_conflicting,
                1e2 * conflict.Share());
}

std::string ConsistencyTable(const MapConsistency& map) {
  std::string text =
      Format("%-26s%12s%12s%12s\n", "returns in free space", "compared", "conflicting", "share");
  text += ConflictRow("within a pass", map.within_pass) + '\n';
  text += ConflictRow("  its worst place", map.worst_within.conflict) + '\n';
  text += ConflictRow("between passes", map.between_passes);
  if (map.within_pass.num_conflicting > 0) {
    text += Format("%10.2f times that within a pass", map.BetweenOverWithin());
  }
  text += '\n' + ConflictRow("  their worst stretch", map.worst_between.conflict);
  text += Format("\n  The worst has %.2f times the conflicts that can be explained%s.\n",
                 map.Ratio(), map.IsContradictory() ? ": the map contradicts itself" : "");
  return text;
}

Json StatisticsJson(const ErrorStatistics& statistics) {
  return {{"mean", statistics.mean},     {"std", statistics.std}, {"rmse", statistics.rmse},
          {"median", statistics.median}, {"p95", statistics.p95}, {"max", statistics.max}};
}

Json ErrorsJson(const PoseErrorStatistics& errors) {
  return {{"matched", errors.num_matched},
          {"unmatched", errors.num_unmatched},
          {"translation_m", StatisticsJson(errors.translation_m)},
          {"rotation_deg", StatisticsJson(errors.rotation_deg)}};
}

Json MapJson(const MapSharpness& map) {
  return {{"points", map.num_points}, {"radii", SharpnessJson(map.radii)}};
}

Json EvaluationJson(const Evaluation& evaluation) {
  Json json = Json::object();
  if (evaluation.relations) {
    json["relations"] = {{"all", ErrorsJson(evaluation.relations->all)},
                         {"local", ErrorsJson(evaluation.relations->local)},
                         {"revisits", ErrorsJson(evaluation.relations->revisits)}};
  }
  if (evaluation.trajectory) {
    json["absolute"] = ErrorsJson(evaluation.trajectory->absolute);
    json["absolute"]["paired_by_order"] = evaluation.truth_by_order;
    json["relative"] = {{"frames", ErrorsJson(evaluation.trajectory->relative_frames)},
                        {"metres", ErrorsJson(evaluation.trajectory->relative_metres)}};
  }
  if (evaluation.raw_ranges) {
    json["map_raw_ranges"] = MapJson(*evaluation.raw_ranges);
    json["map_raw_ranges"]["scans_without_pose"] = evaluation.num_scans_without_pose;
    json["map_raw_ranges"]["paired_by_order"] = evaluation.log_by_order;
  }
  if (evaluation.consistency) json["map_consistency"] = ConsistencyJson(*evaluation.consistency);
  if (evaluation.points) json["map_points"] = MapJson(*evaluation.points);
  return json;
}

}  // namespace

std::string EvaluationTables(const Evaluation& evaluation) {
  std::string text;
  if (evaluation.relations || evaluation.trajectory) text += ErrorHeader();
  if (evaluation.relations) {
    text += ErrorRows("relations, all", evaluation.relations->all);
    text += ErrorRows("relations, local", evaluation.relations->local);
    text += ErrorRows("relations, revisits", evaluation.relations->revisits);
  }
  if (evaluation.trajectory) {
    text += ErrorRows("absolute (ATE)", evaluation.trajectory->absolute);
    text += ErrorRows("relative (RPE), frames", evaluation.trajectory->relative_frames);
    text += ErrorRows("relative (RPE), metres", evaluation.trajectory->relative_metres);
    if (evaluation.truth_by_order) {
      text += "  the clock is useless: pose i is compared with true pose i\n";
    }
  }
  if (evaluation.raw_ranges || evaluation.points) {
    if (!text.empty()) text += '\n';
    text +=
        Format("%-26s%8s%18s%14s%10s\n", "", "radius", "wall thickness", "map entropy", "samples");
  }
  if (evaluation.raw_ranges) text += SharpnessRows("map, raw ranges", *evaluation.raw_ranges);
  if (evaluation.points) text += SharpnessRows("map, points", *evaluation.points);
  if (evaluation.num_scans_without_pose > 0) {
    text +=
        Format("  %zu scans have no pose and are left out\n", evaluation.num_scans_without_pose);
  }
  if (evaluation.log_by_order) text += "  the clock is useless: scan i is put at pose i\n";
  if (evaluation.consistency) text += '\n' + ConsistencyTable(*evaluation.consistency);
  return text;
}

Status WriteEvaluationJson(const std::string& path, const Evaluation& evaluation) {
  return WriteJson(path, EvaluationJson(evaluation));
}

Status WriteEvaluationCsv(const std::string& path, const Evaluation& evaluation) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  file.stream() << "figure,value\n";
  const Json figures = EvaluationJson(evaluation).flatten();
  for (const auto& [pointer, value] : figures.items()) {
    const std::string number = value.dump();  // NaN becomes null
    file.stream() << pointer.substr(1) << ',' << (number == "null" ? "" : number) << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
