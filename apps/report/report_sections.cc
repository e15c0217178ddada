#include "plumbline/apps/report/report_sections.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/report/units.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

std::string Mm(double length_m) {
  return std::isfinite(length_m) ? FixedText(kMmPerM * length_m, 1) + " mm" : "-";
}

// A figure of the last stage, and what it was at the first.
ReportFigure LastAndFirst(const std::string& label, const std::string& last,
                          const std::string& first, const std::string& name_of_first) {
  return {label, last, name_of_first + ": " + first};
}

// The costs of iterations are those of their round's associations; this is one energy for all.
ReportPlot ConvergencePlotOf(const SolverSummary& solver) {
  ReportPlot plot;
  plot.title = "Convergence";
  plot.value_label = "marginal energy";
  plot.note =
      "How well the poses explain the scans, with every point at its optimum and under the "
      "surfaces "
      "that these poses give. It compares between rounds, and between solvers that start alike.";
  ReportCurve rounds{"start and rounds", {}};
  for (const RoundEnergy& row : solver.round_energies) {
    rounds.points.push_back(
        {row.total_time_s, static_cast<double>(row.iteration), row.marginal_energy});
  }
  const double num_iterations = rounds.points.back().iteration;
  plot.curves = {std::move(rounds),
                 {"result", {{solver.total_time_s, num_iterations, solver.final_marginal_energy}}}};
  return plot;
}

void AddDisplacements(const PointDisplacements& moved, HtmlReport* report) {
  std::size_t num_points = 0;
  for (const std::size_t count : moved.sigma_counts) num_points += count;
  if (num_points == 0) return;
  report->figures.push_back({"Points moved", Mm(moved.mean_m),
                             "mean; up to " + FixedText(moved.max_beam_sigmas, 1) + " sigmas"});
  ReportHistogram sigmas{
      "Displacement of points, in sigmas",
      "standard deviations of the beam",
      {},
      {moved.sigma_counts.begin(), moved.sigma_counts.end()},
      "Points without a surface stay at the ends of their beams: they are in the "
      "first bin."};
  for (int i = 0; i < moved.kNumSigmaBins; ++i) {
    sigmas.lower_edges.push_back(i * moved.kSigmasPerBin);
  }
  ReportHistogram lengths{"Displacement of points, in mm",
                          "mm from the end of the beam",
                          {0.0},
                          {moved.octave_counts.begin(), moved.octave_counts.end()},
                          "Each bin is twice as wide as the one before."};
  for (int i = 1; i < moved.kNumOctaves; ++i) {
    lengths.lower_edges.push_back(kMmPerM * std::ldexp(moved.kFirstOctaveM, i - 1));
  }
  report->histograms.push_back(std::move(sigmas));
  report->histograms.push_back(std::move(lengths));
}

ReportTable TermsTable(const SolverSummary& solver) {
  ReportTable table{"Energy by term",
                    {"Term", "Residuals", "Before", "After", "RMS [sigma]", "RMS"},
                    {},
                    "Half the sum of squared whitened residuals, under the last associations."};
  for (const TermSummary& term : solver.terms) {
    if (term.count == 0) continue;
    const double rms = term.WhitenedRms();
    table.rows.push_back(
        {term.name, WithThousands(term.count), ShortText(term.initial_cost),
         ShortText(term.final_cost), FixedText(rms, 3),
         term.sigma > 0.0 ? FixedText(rms * term.sigma, 5) + " " + term.unit : ""});
  }
  return table;
}

ReportTable AcceptanceTable(const AcceptanceTest& acceptance) {
  const std::string chance = "+- " + ShortText(acceptance.held_out_noise) + " by chance";
  return {
      "Acceptance test: is the result better than the seed?",
      {"Over the landmarks of both states", "Seed", "Refined", "Passed"},
      {{"Energy", ShortText(acceptance.seed_energy), ShortText(acceptance.final_energy),
        acceptance.LowersEnergy() ? "yes" : "no"},
       {"Squared distance of held-out returns [sigma^2], " + chance,
        FixedText(acceptance.seed_held_out_error, 4), FixedText(acceptance.final_held_out_error, 4),
        acceptance.KeepsHeldOutError() ? "yes" : "no"}},
      WithThousands(acceptance.num_held_out) +
          " returns took no part in finding these poses and lines. If either figure speaks "
          "against the result it is refused, and the seed comes back. The energy has to fall; the "
          "held-out figure may rise to " +
          FixedText(acceptance.LargestHeldOutError(), 4) +
          (acceptance.with_other_constraints
               ? ": relative poses and custom factors are knowledge of "
                 "their own, which may cost the scans a "
                 "little."
               : ", twice what chance does.")};
}

// Where a part of the drive was treated on its own.
ReportTable LocalTable(const SolverSummary& solver) {
  ReportTable table{
      "Parts of the drive",
      {"Where", "Seed", "As refined at first", "What was done"},
      {},
      "Stretches: squared distance of held-out returns [sigma^2]. Odometry steps: how "
      "far they are off the seed, in standard deviations."};
  for (const DownweightedStep& downweighted : solver.downweighted_steps) {
    table.rows.push_back({"odometry step " + std::to_string(downweighted.step),
                          ShortText(downweighted.sigma_factor), "",
                          "downweighted: it tore poses off the map"});
  }
  for (const WorseStretch& stretch : solver.put_back) {
    table.rows.push_back(
        {"poses " + std::to_string(stretch.first) + " to " + std::to_string(stretch.last),
         FixedText(stretch.seed_error, 2), FixedText(stretch.state_error, 2), "put back"});
  }
  return table;
}

ReportStagePlot ErrorPlot(const std::vector<Stage>& stages) {
  ReportStagePlot plot{"Error by stage", "mm", {}, {{"pose", {}}, {"map", {}}}, ""};
  for (const Stage& stage : stages) {
    if (!stage.error) continue;
    plot.stages.push_back(stage.name);
    plot.series[0].values.push_back(kMmPerM * stage.error->mean_pose_error_m);
    plot.series[1].values.push_back(kMmPerM * stage.error->mean_point_error_m);
  }
  plot.note = "Mean distance of poses and of map points from the truth, the axis logarithmic.";
  return plot;
}

ReportTable IgnoredTable(const SolverSummary& solver) {
  ReportTable table{"Edges that the scans contradict, ignored",
                    {"From", "To", "Off the result by", "", "Standard deviations"},
                    {},
                    std::to_string(solver.ignored_edges.size()) +
                        " edges; the farthest are shown, summary.json has all."};
  constexpr std::size_t kMaxShown = 20;
  for (const IgnoredEdge& edge : solver.FarthestIgnoredEdges(kMaxShown)) {
    table.rows.push_back(
        {std::to_string(edge.from), std::to_string(edge.to), FixedText(edge.off_m, 2) + " m",
         FixedText(RadToDeg(edge.off_rad), 1) + " deg", FixedText(edge.sigmas, 0)});
  }
  return table;
}

std::string ConflictText(const FreeSpaceConflict& conflict) {
  if (conflict.num_compared == 0) return "-";
  return FixedText(kPercent * conflict.Share(), 2) + " % of " +
         WithThousands(conflict.num_compared);
}

}  // namespace

void AddAlarms(const std::vector<Alarm>& alarms, const std::string& all_clear, HtmlReport* report) {
  for (const Alarm& alarm : alarms) {
    report->alarms.push_back("Around " + alarm.place.Text() + ": " + alarm.Text() + ".");
  }
  report->all_clear = all_clear;
}

void AddWarnings(const std::vector<Warning>& warnings, HtmlReport* report) {
  for (const Warning& warning : warnings) {
    report->warnings.push_back(warning.message + " [" + warning.id + "]");
  }
}

void AddStop(const std::string& signal_name, HtmlReport* report) {
  if (signal_name.empty()) return;
  report->figures.push_back({"Stopped early", signal_name, "the best state so far"});
}

void AddStages(const std::vector<Stage>& stages, HtmlReport* report) {
  if (stages.empty()) return;
  const Stage& first = stages.front();
  const Stage& last = stages.back();
  ReportTable table{"Map quality by stage", {"Stage", "Wall thickness", "Map entropy"}, {}, ""};
  const auto thickness = [](const Stage& stage) {
    return stage.quality.num_samples > 0 ? Mm(stage.quality.wall_thickness_m) : "-";
  };
  const auto entropy = [](const Stage& stage) {
    return stage.quality.num_samples > 0 ? FixedText(stage.quality.mean_map_entropy, 3) : "-";
  };
  if (first.error) {
    for (const char* column : {"Pose error", "Heading error", "Map error"}) {
      table.header.push_back(column);
    }
  }
  for (const Stage& stage : stages) {
    std::vector<std::string> row = {stage.name, thickness(stage), entropy(stage)};
    if (stage.error) {
      row.push_back(Mm(stage.error->mean_pose_error_m));
      row.push_back(FixedText(RadToDeg(stage.error->mean_pose_error_rad), 3) + " deg");
      row.push_back(Mm(stage.error->mean_point_error_m));
    }
    table.rows.push_back(std::move(row));
  }
  table.note = "Smaller is sharper, for both. Measured without truth, clutter included.";
  report->tables.push_back(std::move(table));
  report->figures.push_back(
      LastAndFirst("Wall thickness", thickness(last), thickness(first), first.name));
  report->figures.push_back(LastAndFirst("Map entropy", entropy(last), entropy(first), first.name));
  if (first.error) report->stage_plots.push_back(ErrorPlot(stages));
  if (last.error && first.error) {
    report->figures.push_back(LastAndFirst("Pose error", Mm(last.error->mean_pose_error_m),
                                           Mm(first.error->mean_pose_error_m), first.name));
  }
}

void AddSolver(const SolverSummary& solver, HtmlReport* report) {
  if (!solver.round_energies.empty()) report->plots.push_back(ConvergencePlotOf(solver));
  if (solver.num_relative_poses > 0) {
    report->figures.push_back({"Pose graph", FixedText(solver.total_time_s, 2) + " s",
                               solver.solver + ", " + ToString(solver.termination)});
    report->tables.push_back(
        {"Relative poses",
         {"State", "Sum of squared whitened errors"},
         {{"start", ShortText(solver.seed_chi2)}, {"end", ShortText(solver.final_chi2)}},
         ""});
    return;
  }
  report->tables.push_back(AcceptanceTable(solver.acceptance));
  if (!solver.downweighted_steps.empty() || !solver.put_back.empty()) {
    report->tables.push_back(LocalTable(solver));
  }
  if (!solver.ignored_edges.empty()) report->tables.push_back(IgnoredTable(solver));
  report->tables.push_back(TermsTable(solver));
  AddDisplacements(solver.displacements, report);
  report->figures.push_back({"Joint estimation", FixedText(solver.total_time_s, 2) + " s",
                             solver.solver + ", " + ToString(solver.termination)});
  const double known_s = solver.association_time_s + solver.setup_time_s + solver.solve_time_s;
  report->durations.push_back({"Joint estimation: associations", solver.association_time_s});
  if (solver.setup_time_s > 0.0) {
    report->durations.push_back({"Joint estimation: setting up", solver.setup_time_s});
  }
  report->durations.push_back({"Joint estimation: minimisation", solver.solve_time_s});
  report->durations.push_back({"Joint estimation: energies, points and the rest",
                               std::max(0.0, solver.total_time_s - known_s)});
}

void AddConsistency(const std::vector<std::pair<std::string, MapConsistency>>& maps,
                    HtmlReport* report) {
  ReportTable table{
      "Free-space conflicts",
      {"Map", "Worst place", "Within a pass", "Between passes"},
      {},
      "Returns of one scan that another scan looked through. Worst place: times what people, doors "
      "and noise explain; a map that goes far beyond contradicts itself."};
  for (const auto& [name, map] : maps) {
    const bool is_known = map.within_pass.num_compared + map.between_passes.num_compared > 0;
    table.rows.push_back({name, is_known ? FixedText(map.Ratio(), 1) + " times" : "-",
                          ConflictText(map.within_pass), ConflictText(map.between_passes)});
  }
  report->tables.push_back(std::move(table));
}

void AddOptionsInForce(HtmlReport* report) {
  for (const gflags::CommandLineFlagInfo& flag : ProgramFlags()) {
    const bool is_number = flag.type == "double";
    const auto text = [is_number](const std::string& value) {
      return is_number ? ShortText(std::stod(value)) : value;
    };
    report->options.push_back(
        {flag.name, text(flag.current_value), text(flag.default_value), flag.description});
  }
}

}  // namespace plumbline
