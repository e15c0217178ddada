#include "plumbline/apps/benchmark/comparison_report.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "plumbline/apps/benchmark/convergence_plot.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/units.h"
#include "plumbline/solvers/interface/ceres_options.h"

namespace plumbline {
namespace {

// The radius at which the README and plumbline_slam give the sharpness of a map [m].
constexpr double kTableRadius = 0.15;

// A number of a fixed width, or a dash.
std::string TableCell(const std::optional<double>& value, int width, int precision) {
  std::ostringstream cell;
  cell << std::fixed << std::setprecision(precision) << std::setw(width);
  if (value) {
    cell << *value;
  } else {
    cell << '-';
  }
  return cell.str();
}

const MapQuality& QualityAt(const MapSharpness& sharpness, double radius_m) {
  const SharpnessAtRadius* nearest = &sharpness.radii.front();
  for (const SharpnessAtRadius& at : sharpness.radii) {
    if (std::abs(at.radius_m - radius_m) < std::abs(nearest->radius_m - radius_m)) nearest = &at;
  }
  return nearest->quality;
}

std::string TableRow(const SolverFigures& figures, std::size_t name_width, double best_energy) {
  std::string name = figures.solver;
  name.resize(name_width, ' ');
  if (figures.median_run == nullptr) return name + "failed: " + figures.failures.front() + '\n';
  const SolverRun& run = *figures.median_run;
  const MapQuality& quality = QualityAt(run.points, kTableRadius);
  std::ostringstream row;
  row << name << std::setw(7) << run.num_rounds << std::setw(7) << run.num_iterations
      << TableCell(figures.time_s, 9, 2) << TableCell(run.cpu_time_s(), 8, 2)
      << TableCell(figures.final_energy, 13, 1)
      << TableCell(100.0 * (figures.final_energy / best_energy - 1.0), 9, 3)
      << TableCell(figures.time_ratio, 8, 1)
      << TableCell(figures.peak_memory_bytes / kBytesPerMb, 9, 0)
      << TableCell(figures.memory_ratio, 8, 2)
      << TableCell(run.relations ? std::optional<double>(run.relations->mean_m) : std::nullopt, 11,
                   4)
      << TableCell(kMmPerM * quality.wall_thickness_m, 10, 2)
      << TableCell(quality.mean_map_entropy, 9, 3);
  if (!figures.failures.empty()) row << "  (" << figures.failures.size() << " runs failed)";
  row << "  " << run.termination << '\n';
  return row.str();
}

std::string InputAndStart(const Comparison& comparison) {
  return comparison.input.substr(comparison.input.find_last_of('/') + 1) +
         ", start: " + comparison.start;
}

// Of the table's first column.
std::size_t NameWidth(const Comparison& comparison) {
  std::size_t width = std::string("solver").size();
  for (const ComparedSolver& solver : comparison.solvers) {
    width = std::max(width, solver.name.size());
  }
  return width + 1;
}

// How far above the best energy a state is: what the plots show. A tenth of what counts as reaching
// an energy is added, so that the best state itself has a place on a logarithmic axis.
constexpr char kGapLabel[] = "marginal energy above the best [fraction; best at 1e-5]";
double PlottedGap(const TracePoint& point, double best_energy) {
  return point.marginal_energy / best_energy - 1.0 + 1e-5;
}

bool IsPlotted(const SolverRun& run) { return run.failure.empty() && run.repeat == 1; }

ReportTable PageTable(const Comparison& comparison) {
  ReportTable table{"Solvers compared: " + InputAndStart(comparison),
                    {"Solver", "Energy", "Above the best", "Seconds", "Time ratio", "Peak memory",
                     "Wall thickness", "Relations", "Outcome"},
                    {},
                    "Time ratio: time to the solver's own final energy (within 0.01 %), over that "
                    "of the first solver to the same."};
  const double best = BestEnergy(comparison.runs);
  const auto text = [](const std::optional<double>& value, int digits) {
    return value ? FixedText(*value, digits) : "-";
  };
  for (const SolverFigures& figures : SumUp(comparison.solvers, comparison.runs)) {
    if (figures.median_run == nullptr) {
      std::vector<std::string> row(table.header.size(), "-");
      row.front() = figures.solver;
      row.back() = "failed: " + figures.failures.front();
      table.rows.push_back(std::move(row));
      continue;
    }
    const SolverRun& run = *figures.median_run;
    table.rows.push_back(
        {figures.solver, FixedText(figures.final_energy, 0),
         FixedText(100.0 * (figures.final_energy / best - 1.0), 3) + " %",
         FixedText(figures.time_s, 2), text(figures.time_ratio, 1),
         FixedText(figures.peak_memory_bytes / kBytesPerMb, 0) + " MB",
         FixedText(kMmPerM * QualityAt(run.points, kTableRadius).wall_thickness_m, 2) + " mm",
         run.relations ? FixedText(run.relations->mean_m, 4) + " m" : "-", run.termination});
  }
  return table;
}

Json OptionalJson(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json RelationsJson(const std::optional<RelationsFigures>& relations) {
  if (!relations) return nullptr;
  return {{"mean_m", relations->mean_m},
          {"std_m", relations->std_m},
          {"mean_deg", relations->mean_deg},
          {"std_deg", relations->std_deg}};
}

// The limit of a row, which may differ from the flag (ComparisonLimits).
Json LimitJson(const SolverOptions& options) {
  if (options.type == SolverType::kCeres) {
    return {{"ceres_max_num_iterations", options.ceres->max_num_iterations}};
  }
  if (options.type == SolverType::kAlternatingCg) {
    return {{"cg_max_sweeps", options.alternating_cg.max_sweeps}};
  }
  return Json::object();
}

Json FiguresJson(const SolverFigures& figures, const ComparedSolver& solver,
                 const std::vector<ComparedSolver>& solvers) {
  Json json = {{"solver", figures.solver},
               {"limit", LimitJson(solver.options)},
               {"failures", figures.failures}};
  if (figures.median_run == nullptr) return json;
  const SolverRun& run = *figures.median_run;
  Json reach = Json::object();
  for (std::size_t i = 0; i < solvers.size(); ++i) {
    reach[solvers[i].name] = OptionalJson(figures.time_to_reach_s[i]);
  }
  json.update({{"termination", run.termination},
               {"rounds", run.num_rounds},
               {"iterations", run.num_iterations},
               {"time_s", figures.time_s},
               {"cpu_time_s", run.cpu_time_s()},
               {"final_marginal_energy", figures.final_energy},
               {"time_to_final_energy_of_s", reach},
               {"time_over_first", OptionalJson(figures.time_ratio)},
               {"start_memory_bytes", run.start_memory_bytes},
               {"peak_memory_bytes", figures.peak_memory_bytes},
               {"memory_over_first", OptionalJson(figures.memory_ratio)},
               {"relations", RelationsJson(run.relations)},
               {"sharpness_of_raw_ranges", SharpnessJson(run.raw_ranges.radii)},
               {"sharpness_of_points", SharpnessJson(run.points.radii)}});
  return json;
}

}  // namespace

std::string ComparisonTable(const Comparison& comparison) {
  std::ostringstream table;
  const std::size_t name_width = NameWidth(comparison);
  table << std::left << std::setw(static_cast<int>(name_width)) << "solver"
        << " rounds  iter.  seconds   CPU s       energy  above %  x time"
           "       MB    x MB  relations m   wall mm  entropy\n";
  const double best = BestEnergy(comparison.runs);
  for (const SolverFigures& figures : SumUp(comparison.solvers, comparison.runs)) {
    table << TableRow(figures, name_width, best);
  }
  table << "energy: marginal, of the result; above: the best state of any solver. x time: to the "
           "solver's own final\nenergy (within 0.01 %), over the time of "
        << comparison.solvers.front().name
        << " to the same. x MB: peak memory likewise. Wall thickness and\nentropy: optimised "
           "points, within 0.15 m.\n";
  return table.str();
}

Status WriteComparisonCsv(const std::string& path, const Comparison& comparison) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  const double best = BestEnergy(comparison.runs);
  out << "solver,repeat,iteration,time_s,cpu_time_s,marginal_energy,gap\n" << std::setprecision(12);
  for (const SolverRun& run : comparison.runs) {
    if (!run.failure.empty()) continue;
    for (const TracePoint& point : run.trace) {
      out << '"' << run.solver << "\"," << run.repeat << ',' << point.iteration << ','
          << point.time_s << ',' << point.cpu_time_s << ',' << point.marginal_energy << ','
          << point.marginal_energy - best << '\n';
    }
  }
  return file.Commit();
}

Status WriteComparisonJson(const std::string& path, const Comparison& comparison) {
  Json solvers = Json::array();
  const std::vector<SolverFigures> all = SumUp(comparison.solvers, comparison.runs);
  for (std::size_t i = 0; i < all.size(); ++i) {
    solvers.push_back(FiguresJson(all[i], comparison.solvers[i], comparison.solvers));
  }
  return WriteJson(path, {{"input", comparison.input},
                          {"start", comparison.start},
                          {"scans", comparison.num_scans},
                          {"returns", comparison.num_returns},
                          {"repeats", comparison.options.repeats},
                          {"time_limit_s", comparison.options.time_limit_s},
                          {"best_marginal_energy", BestEnergy(comparison.runs)},
                          {"solvers", solvers},
                          {"flags", FlagsInForce()}});
}

Status WriteComparisonPlot(const std::string& path, const Comparison& comparison) {
  const double best = BestEnergy(comparison.runs);
  ConvergencePlot plot;
  plot.title = InputAndStart(comparison);
  plot.x_label = "time of the solver [s]";
  plot.y_label = kGapLabel;
  for (const SolverRun& run : comparison.runs) {
    if (!IsPlotted(run)) continue;
    ConvergenceLine line;
    line.label = run.solver;
    for (const TracePoint& point : run.trace) {
      line.points.emplace_back(point.time_s, PlottedGap(point, best));
    }
    plot.lines.push_back(std::move(line));
  }
  return WriteConvergencePlot(path, plot);
}

void AddComparison(const Comparison& comparison, HtmlReport* page) {
  page->tables.push_back(PageTable(comparison));
  ReportPlot plot{"Energy over time", kGapLabel, {}, "The first run of each solver."};
  const double best = BestEnergy(comparison.runs);
  for (const SolverRun& run : comparison.runs) {
    if (!IsPlotted(run)) continue;
    ReportCurve curve{run.solver, {}};
    for (const TracePoint& point : run.trace) {
      curve.points.push_back(
          {point.time_s, static_cast<double>(point.iteration), PlottedGap(point, best)});
    }
    plot.curves.push_back(std::move(curve));
  }
  page->plots.push_back(plot);
}

}  // namespace plumbline
