#include "plumbline/apps/benchmark/replay_report.h"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <vector>

#include "plumbline/apps/figures/line_chart.h"
#include "plumbline/apps/io/atomic_file.h"

namespace plumbline {
namespace {

constexpr ReplayedSolve kKinds[] = {ReplayedSolve::kWindow, ReplayedSolve::kLoops,
                                    ReplayedSolve::kFinal};

void WriteTimes(const std::string& name, std::vector<double> times_s, std::ostream* table) {
  *table << std::left << std::setw(10) << name << std::right << std::setw(8) << times_s.size();
  if (!times_s.empty()) {
    std::sort(times_s.begin(), times_s.end());
    const std::size_t middle = times_s.size() / 2;
    const double median_s =
        times_s.size() % 2 == 1 ? times_s[middle] : 0.5 * (times_s[middle - 1] + times_s[middle]);
    *table << std::setw(12) << median_s << std::setw(12) << times_s.back();
  }
  *table << '\n';
}

}  // namespace

std::string ReplayTable(const Replay& replay) {
  std::ostringstream table;
  table << std::fixed << std::setprecision(3);
  table << "solve       count    median s     worst s\n";
  std::vector<double> all_s;
  for (const ReplayedSolve kind : kKinds) {
    std::vector<double> times_s;
    for (const ReplayStep& step : replay.steps) {
      if (step.solve == kind) times_s.push_back(step.time_s);
    }
    all_s.insert(all_s.end(), times_s.begin(), times_s.end());
    WriteTimes(ToString(kind), std::move(times_s), &table);
  }
  WriteTimes("all", std::move(all_s), &table);
  table << std::setprecision(1) << "energy      online " << replay.online_energy
        << ", after the final solve " << replay.final_energy << ", all at once "
        << replay.batch_energy << " (in " << std::setprecision(3) << replay.batch_time_s << " s)\n"
        << "difference  energy " << std::showpos << 100.0 * (replay.EnergyRatio() - 1.0)
        << std::noshowpos << " %, poses " << 1000.0 * replay.mean_difference_m
        << " mm in the mean, " << 1000.0 * replay.max_difference_m << " mm at most\n";
  return table.str();
}

Status WriteReplayCsv(const std::string& path, const Replay& replay) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "batch,poses,solve,closures,news,time_s,initial_energy,final_energy\n"
      << std::setprecision(9);
  for (const ReplayStep& step : replay.steps) {
    out << step.batch << ',' << step.num_poses << ',' << ToString(step.solve) << ','
        << step.num_closures << ',' << step.num_news << ',' << step.time_s << ','
        << step.initial_energy << ',' << step.final_energy << '\n';
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
