#include "plumbline/apps/benchmark/replay_report.h"

#include <algorithm>
#include <iomanip>
#include <iterator>
#include <sstream>
#include <vector>

#include "plumbline/apps/figures/line_chart.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/core/median.h"

namespace plumbline {
namespace {

constexpr ReplayedSolve kKinds[] = {ReplayedSolve::kWindow, ReplayedSolve::kLoops,
                                    ReplayedSolve::kFinal};

void WriteSolves(const std::string& name, const std::vector<ReplayStep>& solves,
                 std::ostream* table) {
  *table << std::left << std::setw(10) << name << std::right << std::setw(8) << solves.size();
  if (!solves.empty()) {
    std::vector<double> times_s;
    int num_placed = 0;
    for (const ReplayStep& solve : solves) {
      times_s.push_back(solve.time_s);
      num_placed += solve.num_placed;
    }
    for (const double time_s : {Median(times_s), Quantile(times_s, 0.99),
                                *std::max_element(times_s.begin(), times_s.end())}) {
      *table << std::setw(12) << time_s;
    }
    *table << std::setw(14) << num_placed;
  }
  *table << '\n';
}

void WriteDifferences(const PoseDifferences& differences, const std::string& when,
                      std::ostream* table) {
  *table << "poses       " << when << ": " << 1e3 * differences.mean_m << " mm from all at once in "
         << "the mean, " << 1e3 * differences.max_m << " mm at most; a step turned by "
         << 1e3 * differences.max_turn_rad << " mrad at most\n";
}

}  // namespace

std::string ReplayTable(const Replay& replay) {
  std::ostringstream table;
  table << std::fixed << std::setprecision(3);
  table << "solve       count    median s       p99 s     worst s  poses placed\n";
  for (const ReplayedSolve kind : kKinds) {
    std::vector<ReplayStep> solves;
    std::copy_if(replay.steps.begin(), replay.steps.end(), std::back_inserter(solves),
                 [kind](const ReplayStep& step) { return step.solve == kind; });
    WriteSolves(ToString(kind), solves, &table);
  }
  // The host waits for these.
  WriteSolves("online", {replay.steps.begin(), replay.steps.end() - 1}, &table);
  table << std::setprecision(1) << "energy      online " << replay.online_energy
        << ", after the final solve " << replay.final_energy << " (" << std::showpos
        << 100.0 * (replay.EnergyRatio() - 1.0) << std::noshowpos << " %), all at once "
        << replay.batch_energy << " (in " << std::setprecision(3) << replay.batch_time_s << " s)\n";
  WriteDifferences(replay.online_difference, "online", &table);
  WriteDifferences(replay.final_difference, "after the final solve", &table);
  return table.str();
}

Status WriteReplayCsv(const std::string& path, const Replay& replay) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "batch,poses,solve,closures,news,placed,time_s,initial_energy,final_energy\n"
      << std::setprecision(9);
  for (const ReplayStep& step : replay.steps) {
    out << step.batch << ',' << step.num_poses << ',' << ToString(step.solve) << ','
        << step.num_closures << ',' << step.num_news << ',' << step.num_placed << ',' << step.time_s
        << ',' << step.initial_energy << ',' << step.final_energy << '\n';
  }
  return file.Commit();
}

Status WriteReplayChart(const std::string& path, const Replay& replay) {
  LineChart chart;
  chart.x_label = "scans so far";
  chart.y_label = "time of the solve [s]";
  for (const ReplayedSolve kind : kKinds) {
    ChartSeries series;
    series.label = ToString(kind);
    for (const ReplayStep& step : replay.steps) {
      if (step.solve != kind) continue;
      series.x.push_back(step.num_poses);
      series.y.push_back(step.time_s);
    }
    chart.series.push_back(std::move(series));
  }
  return WriteLineChart(path, chart, 1200, 600);
}

}  // namespace plumbline
