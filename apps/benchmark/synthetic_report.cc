#include "plumbline/apps/benchmark/synthetic_report.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "plumbline/apps/benchmark/match_graph.h"
#include "plumbline/apps/benchmark/plain_icp.h"
#include "plumbline/apps/figures/choose_details.h"
#include "plumbline/apps/figures/line_chart.h"
#include "plumbline/apps/figures/map_figure.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/report/format.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// A row of the table in the paper: means [m] and variances, whose unit it does not give.
struct PaperFigures {
  Mapper mapper;
  double pose_mean_m, pose_variance, point_mean_m, point_variance;
};
constexpr PaperFigures kPaper[] = {{Mapper::kPlainIcp, 0.597, 0.199, 0.702, 0.238},
                                   {Mapper::kOlson, 0.088, 0.115, 0.115, 0.005},
                                   {Mapper::kPublished, 0.035, 0.048, 0.047, 0.002}};

// The algorithms of the paper's charts, and a bound.
constexpr Mapper kCharted[] = {Mapper::kPlainIcp, Mapper::kOlson, Mapper::kPublished,
                               Mapper::kPlumbline, Mapper::kKnownWalls};
struct Pictured {
  Mapper mapper;
  const char* title;  // short: beside a scale bar
};
constexpr Pictured kPictured[] = {{Mapper::kPlainIcp, "ICP"},
                                  {Mapper::kOlson, "SG"},
                                  {Mapper::kPublished, "published"},
                                  {Mapper::kPlumbline, "Plumbline"}};

std::string Describe(const SyntheticNoise& noise) {
  std::ostringstream text;
  text << "range " << 1e3 * noise.sigma_range_m << " mm, bearing "
       << RadToDeg(noise.sigma_bearing_rad) << " deg, odometry x " << noise.odometry_factor;
  return text.str();
}

std::string FiguresCell(const Quartiles& mean_m, const Quartiles& variance_m2) {
  return Format("%9.4f [%.4f, %.4f]%9.1e", mean_m.median, mean_m.low, mean_m.high,
                variance_m2.median);
}

std::string PaperCell(const PaperFigures* paper, double PaperFigures::*mean,
                      double PaperFigures::*variance) {
  if (paper == nullptr) return Format("%14s", "-");
  return Format("%8.3f %.3f", paper->*mean, paper->*variance);
}

const PaperFigures* FindPaperFigures(Mapper mapper) {
  const auto* found = std::find_if(std::begin(kPaper), std::end(kPaper),
                                   [&](const PaperFigures& row) { return row.mapper == mapper; });
  return found == std::end(kPaper) ? nullptr : found;
}

std::string TableHeading() {
  std::string means, units;
  for (const char* errors : {"pose error [m]", "map error [m]"}) {
    means += Format("%27s%9s%14s", errors, "variance", "in the paper");
    units += Format("%27s%9s%14s", "median [quartiles]", "m^2", "mean   var");
  }
  return Format("%-28s", "") + means + "  heading   failed\n" + Format("%-28s", "") + units +
         "      deg\n";
}

std::string TableRow(const SyntheticSummary& row) {
  const PaperFigures* paper = FindPaperFigures(row.mapper);
  const bool is_placed_by_truth = row.mapper == Mapper::kTruePoses;
  return Format("  %-26s", ToString(row.mapper)) +
         (is_placed_by_truth ? Format("%36s", "-")
                             : FiguresCell(row.pose_mean_m, row.pose_variance_m2)) +
         PaperCell(paper, &PaperFigures::pose_mean_m, &PaperFigures::pose_variance) +
         FiguresCell(row.point_mean_m, row.point_variance_m2) +
         PaperCell(paper, &PaperFigures::point_mean_m, &PaperFigures::point_variance) +
         Format("%9.3f%4d of %d\n", RadToDeg(row.heading_mean_rad.median), row.num_failures,
                row.num_runs);
}

Json QuartilesJson(const Quartiles& quartiles) {
  return {{"low", quartiles.low}, {"median", quartiles.median}, {"high", quartiles.high}};
}

Json SummaryJson(const SyntheticSummary& row) {
  return {{"algorithm", ToString(row.mapper)},
          {"runs", row.num_runs},
          {"failures", row.num_failures},
          {"pose_error_mean_m", QuartilesJson(row.pose_mean_m)},
          {"pose_error_variance_m2", QuartilesJson(row.pose_variance_m2)},
          {"map_error_mean_m", QuartilesJson(row.point_mean_m)},
          {"map_error_variance_m2", QuartilesJson(row.point_variance_m2)},
          {"heading_error_mean_rad", QuartilesJson(row.heading_mean_rad)}};
}

// Median and quartiles over the seeds, value by value.
ChartSeries SeriesOf(const std::vector<SyntheticOutcome>& outcomes, int noise, Mapper mapper,
                     std::vector<double> SyntheticOutcome::*errors, std::size_t first,
                     double x_step) {
  std::vector<const SyntheticOutcome*> runs;
  for (const SyntheticOutcome& run : outcomes) {
    if (run.noise == noise && run.mapper == mapper) runs.push_back(&run);
  }
  ChartSeries series;
  series.label = ToString(mapper);
  const std::size_t size = runs.empty() ? 0 : (runs.front()->*errors).size();
  for (std::size_t i = first; i < size; ++i) {
    std::vector<double> values;
    values.reserve(runs.size());
    for (const SyntheticOutcome* run : runs) values.push_back((run->*errors)[i]);
    const Quartiles quartiles = QuartilesOf(values);
    series.x.push_back(x_step * static_cast<double>(i));
    series.y.push_back(quartiles.median);
    series.low.push_back(quartiles.low);
    series.high.push_back(quartiles.high);
  }
  return series;
}

MapPanel TruthPanel(const MapEstimate& truth) {
  MapPanel panel;
  panel.title = "truth";
  panel.trajectory = truth.poses;
  for (std::size_t i = 0; i < truth.points.size(); i += 2) {
    if (std::isnan(truth.points[i])) continue;  // of a return that is not the building's
    panel.points.insert(panel.points.end(), {truth.points[i], truth.points[i + 1]});
  }
  return panel;
}

constexpr int kChartWidthPx = 1600, kChartHeightPx = 1000;

}  // namespace

std::string SyntheticTable(const std::vector<SyntheticNoise>& noises,
                           const std::vector<SyntheticOutcome>& outcomes) {
  std::string table;
  int last_noise = -1;
  for (const SyntheticSummary& row : SummariseOutcomes(outcomes)) {
    if (row.noise != last_noise) {
      table += (last_noise < 0 ? "" : "\n") + noises[row.noise].name + ": " +
               Describe(noises[row.noise]) + '\n' + TableHeading();
      last_noise = row.noise;
    }
    table += TableRow(row);
  }
  return table +
         "\nMean and variance are over the poses or points of a run; shown are medians over the "
         "seeds.\n" +
         Format("Failed: a pose more than %.1f m off; failures count in all figures.\n",
                SyntheticOutcome::kFailureM) +
         Format("The gates of ICP and SG, %.1f and %.1f m, give the paper's errors at 30 mm.\n",
                PlainIcpOptions().gate_m, MatchGraphOptions().icp.gate_m);
}

Status WriteSyntheticCsv(const std::string& path, const std::vector<SyntheticNoise>& noises,
                         const std::vector<SyntheticOutcome>& outcomes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "seed,sigma_range_m,sigma_bearing_rad,odometry_factor,algorithm,pose_error_mean_m,"
         "pose_error_variance_m2,pose_error_max_m,map_error_mean_m,map_error_variance_m2,"
         "heading_error_mean_rad,failed\n"
      << std::setprecision(6);
  for (const SyntheticOutcome& run : outcomes) {
    const SyntheticNoise& noise = noises[run.noise];
    out << run.seed << ',' << noise.sigma_range_m << ',' << noise.sigma_bearing_rad << ','
        << noise.odometry_factor << ",\"" << ToString(run.mapper) << "\"," << run.pose_m.mean << ','
        << run.pose_m.variance << ',' << run.max_pose_m << ',' << run.point_m.mean << ','
        << run.point_m.variance << ',' << run.heading_rad.mean << ',' << run.Failed() << '\n';
  }
  return file.Commit();
}

Status WriteSyntheticJson(const std::string& path, const std::vector<SyntheticNoise>& noises,
                          const std::vector<SyntheticOutcome>& outcomes) {
  Json published = Json::array();
  for (const PaperFigures& row : kPaper) {
    published.push_back({{"algorithm", ToString(row.mapper)},
                         {"pose_error_mean_m", row.pose_mean_m},
                         {"pose_error_variance", row.pose_variance},
                         {"map_error_mean_m", row.point_mean_m},
                         {"map_error_variance", row.point_variance}});
  }
  Json levels = Json::array();
  for (const SyntheticNoise& noise : noises) {
    levels.push_back({{"name", noise.name},
                      {"sigma_range_m", noise.sigma_range_m},
                      {"sigma_bearing_rad", noise.sigma_bearing_rad},
                      {"odometry_factor", noise.odometry_factor},
                      {"algorithms", Json::array()}});
  }
  for (const SyntheticSummary& row : SummariseOutcomes(outcomes)) {
    levels[row.noise]["algorithms"].push_back(SummaryJson(row));
  }
  return WriteJson(path, {{"failure_threshold_m", SyntheticOutcome::kFailureM},
                          {"noise_levels", levels},
                          {"published", published}});
}

Status WritePoseErrorChart(const std::string& path, const SyntheticNoise& noise, int noise_index,
                           const std::vector<SyntheticOutcome>& outcomes) {
  LineChart chart;
  chart.title = "Noise: " + Describe(noise);
  chart.x_label = "pose index";
  chart.y_label = "error of its position [m], median and quartiles";
  chart.log_y = true;
  for (const Mapper mapper : kCharted) {
    // The first pose is where it is by definition.
    chart.series.push_back(
        SeriesOf(outcomes, noise_index, mapper, &SyntheticOutcome::pose_errors_m, 1, 1.0));
  }
  return WriteLineChart(path, chart, kChartWidthPx, kChartHeightPx);
}

Status WriteMapErrorChart(const std::string& path, const SyntheticNoise& noise, int noise_index,
                          const std::vector<SyntheticOutcome>& outcomes) {
  constexpr double kBeamsPerStretch = 16.0 * 720.0 / SyntheticOutcome::kNumStretches;
  LineChart chart;
  chart.title = "Noise: " + Describe(noise);
  chart.x_label = "map point, in order of scans and beams";
  chart.y_label = "mean error over 180 beams [m], median and quartiles";
  chart.log_y = true;
  for (const Mapper mapper : kCharted) {
    chart.series.push_back(SeriesOf(outcomes, noise_index, mapper,
                                    &SyntheticOutcome::point_errors_m, 0, kBeamsPerStretch));
  }
  return WriteLineChart(path, chart, kChartWidthPx, kChartHeightPx);
}

Status WriteSyntheticMaps(const std::string& path, std::uint64_t seed, const SyntheticNoise& noise,
                          const MapLogOptions& options) {
  constexpr double kDetailM = 2.5;
  SyntheticDrive drive;
  std::array<MapEstimate, kNumMappers> maps;
  PLUMBLINE_RETURN_IF_ERROR(MakeSyntheticDrive(seed, noise, &drive));
  PLUMBLINE_RETURN_IF_ERROR(MakeMaps(drive, noise, options, &maps));
  MapFigure figure;
  figure.panels.push_back(TruthPanel(drive.truth));
  for (const auto& [mapper, title] : kPictured) {
    const MapEstimate& map = maps[static_cast<int>(mapper)];
    figure.panels.push_back({title, map.points, map.poses, {}});
  }
  figure.details = ChooseDetails(maps[static_cast<int>(Mapper::kOlson)].points,
                                 maps[static_cast<int>(Mapper::kPlumbline)].points, 2, kDetailM);
  MapFigureOptions picture;
  picture.point_px = 5;  // 11520 points are too few for single pixels
  return WriteMapFigure(path, figure, picture);
}

}  // namespace plumbline
