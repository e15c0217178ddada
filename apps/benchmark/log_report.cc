#include "plumbline/apps/benchmark/log_report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/report/format.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/units.h"

namespace plumbline {
namespace {

constexpr int kNameWidth = 56;

std::string NameCell(const std::string& name) { return Format("%-*s", kNameWidth, name.c_str()); }

// "0.0303 +- 0.0222", or a dash if nothing was measured.
std::string ErrorCell(double mean, double std, int precision) {
  if (std::isnan(mean)) return Format("%20s", "-");
  return Format("%20s", Format("%.*f +- %.*f", precision, mean, precision, std).c_str());
}

std::string ErrorCells(const PoseErrorStatistics& errors) {
  return ErrorCell(errors.translation_m.mean, errors.translation_m.std, 4) +
         ErrorCell(errors.rotation_deg.mean, errors.rotation_deg.std, 3);
}

// Decimals that a rounded number was given with, trailing zeros apart.
int Decimals(double value) {
  int decimals = 1;
  for (double scaled = 10.0 * value; decimals < 6; ++decimals, scaled *= 10.0) {
    if (std::abs(scaled - std::round(scaled)) < 1e-6) break;
  }
  return decimals;
}

// Both with the digits of the longer one, as they were published.
std::string PublishedCell(const MeanAndStd& figure) {
  return ErrorCell(figure.mean, figure.std, std::max(Decimals(figure.mean), Decimals(figure.std)));
}

std::string PublishedRow(const PublishedFigure& figure) {
  return NameCell("  " + figure.system + " (" + figure.source + ")") +
         PublishedCell(figure.translation_m) +
         (figure.rotation_deg ? PublishedCell(*figure.rotation_deg) : "") + '\n';
}

std::string RelationsTable(const LogExperiment& experiment) {
  std::string table = NameCell("relations, mean +- std");
  for (const char* heading :
       {"all [m]", "all [deg]", "local [m]", "local [deg]", "revisits [m]", "revisits [deg]"}) {
    table += Format("%20s", heading);
  }
  table += '\n';
  for (const LogStart& start : experiment.starts) {
    table += start.name + Format(", %d scans\n", start.num_scans);
    for (const LogStage& stage : start.stages) {
      table += NameCell("  " + stage.name) + ErrorCells(stage.relations->all) +
               ErrorCells(stage.relations->local) + ErrorCells(stage.relations->revisits) + '\n';
    }
  }
  if (!experiment.published.empty()) table += "published\n";
  for (const PublishedFigure& figure : experiment.published) table += PublishedRow(figure);
  return table + '\n';
}

std::string SharpnessRow(const std::string& name, const MapSharpness& map,
                         const std::string& seconds) {
  std::string row = NameCell("  " + name);
  for (const SharpnessAtRadius& at : map.radii) {
    row +=
        Format("%10.1f%9.3f", kMmPerM * at.quality.wall_thickness_m, at.quality.mean_map_entropy);
  }
  return row + Format("%10s\n", seconds.c_str());
}

std::string SharpnessTable(const LogExperiment& experiment) {
  std::string table = NameCell("thickness [mm], entropy; radius:");
  for (const SharpnessAtRadius& at : experiment.starts.front().stages.front().raw_ranges.radii) {
    table += Format("%17.2f m", at.radius_m);
  }
  table += "   seconds\n";
  for (const LogStart& start : experiment.starts) {
    table += start.name + Format(", %d scans, %zu returns\n", start.num_scans, start.num_returns);
    for (const LogStage& stage : start.stages) {
      const std::string name = stage.points ? stage.name + ", raw ranges" : stage.name;
      table += SharpnessRow(name, stage.raw_ranges, Format("%.2f", stage.time_s));
      if (stage.points) table += SharpnessRow(stage.name + ", points", *stage.points, "");
    }
  }
  return table;
}

void WriteErrorLine(const std::string& start, const std::string& stage, const char* which,
                    const PoseErrorStatistics& errors, std::ostream* out) {
  *out << '"' << start << "\",\"" << stage << "\"," << which;
  for (const ErrorStatistics* statistics : {&errors.translation_m, &errors.rotation_deg}) {
    for (const double value : {statistics->mean, statistics->std}) {
      *out << ',';
      if (std::isfinite(value)) *out << value;
    }
  }
  *out << ',' << errors.num_matched << ',' << errors.num_unmatched << '\n';
}

void WriteSharpnessLines(const LogStart& start, const LogStage& stage, const char* kind,
                         const MapSharpness& map, std::ostream* out) {
  for (const SharpnessAtRadius& at : map.radii) {
    *out << '"' << start.name << "\",\"" << stage.name << "\"," << kind << ',' << at.radius_m << ','
         << at.quality.wall_thickness_m << ',' << at.quality.mean_map_entropy << '\n';
  }
}

Json ErrorsJson(const PoseErrorStatistics& errors) {
  return {{"mean_m", errors.translation_m.mean},  {"std_m", errors.translation_m.std},
          {"mean_deg", errors.rotation_deg.mean}, {"std_deg", errors.rotation_deg.std},
          {"matched", errors.num_matched},        {"unmatched", errors.num_unmatched}};
}

Json StageJson(const LogStage& stage) {
  Json json = {{"stage", stage.name}};
  if (stage.relations) {
    json["relations"] = {{"all", ErrorsJson(stage.relations->all)},
                         {"local", ErrorsJson(stage.relations->local)},
                         {"revisits", ErrorsJson(stage.relations->revisits)}};
  }
  json["sharpness_of_raw_ranges"] = SharpnessJson(stage.raw_ranges.radii);
  if (stage.points) json["sharpness_of_points"] = SharpnessJson(stage.points->radii);
  return json;
}

Json PublishedJson(const PublishedFigure& figure) {
  Json json = {{"system", figure.system},
               {"source", figure.source},
               {"mean_m", figure.translation_m.mean},
               {"std_m", figure.translation_m.std}};
  if (figure.rotation_deg) {
    json["mean_deg"] = figure.rotation_deg->mean;
    json["std_deg"] = figure.rotation_deg->std;
  }
  return json;
}

}  // namespace

std::string LogTables(const LogExperiment& experiment) {
  const bool has_relations = experiment.starts.front().stages.front().relations.has_value();
  return (has_relations ? RelationsTable(experiment) : "") + SharpnessTable(experiment);
}

Status WriteLogRelationsCsv(const std::string& path, const LogExperiment& experiment) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "start,stage,relations,mean_m,std_m,mean_deg,std_deg,matched,unmatched\n"
      << std::setprecision(12);
  for (const LogStart& start : experiment.starts) {
    for (const LogStage& stage : start.stages) {
      if (!stage.relations) continue;
      WriteErrorLine(start.name, stage.name, "all", stage.relations->all, &out);
      WriteErrorLine(start.name, stage.name, "local", stage.relations->local, &out);
      WriteErrorLine(start.name, stage.name, "revisits", stage.relations->revisits, &out);
    }
  }
  for (const PublishedFigure& figure : experiment.published) {
    out << "\"published, " << figure.source << "\",\"" << figure.system << "\",all,"
        << figure.translation_m.mean << ',' << figure.translation_m.std << ',';
    if (figure.rotation_deg) {
      out << figure.rotation_deg->mean << ',' << figure.rotation_deg->std;
    } else {
      out << ',';
    }
    out << ",,\n";
  }
  return file.Commit();
}

Status WriteLogSharpnessCsv(const std::string& path, const LogExperiment& experiment) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "start,stage,points,radius_m,wall_thickness_m,mean_map_entropy\n" << std::setprecision(12);
  for (const LogStart& start : experiment.starts) {
    for (const LogStage& stage : start.stages) {
      WriteSharpnessLines(start, stage, "raw_ranges", stage.raw_ranges, &out);
      if (stage.points) WriteSharpnessLines(start, stage, "optimised", *stage.points, &out);
    }
  }
  return file.Commit();
}

Status WriteLogJson(const std::string& path, const LogExperiment& experiment) {
  Json starts = Json::array(), published = Json::array();
  for (const LogStart& start : experiment.starts) {
    Json stages = Json::array();
    for (const LogStage& stage : start.stages) stages.push_back(StageJson(stage));
    starts.push_back({{"start", start.name},
                      {"scans", start.num_scans},
                      {"returns", start.num_returns},
                      {"stages", stages}});
  }
  for (const PublishedFigure& figure : experiment.published) {
    published.push_back(PublishedJson(figure));
  }
  return WriteJson(path, {{"log", experiment.log}, {"starts", starts}, {"published", published}});
}

}  // namespace plumbline
