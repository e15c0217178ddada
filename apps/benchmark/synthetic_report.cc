#include "plumbline/apps/benchmark/synthetic_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "plumbline/apps/figures/choose_details.h"
#include "plumbline/apps/figures/line_chart.h"
#include "plumbline/apps/figures/map_figure.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// Mean errors [m] of poses and map points in the synthetic experiment of the method's paper.
struct Published {
  const char* name;
  double pose_m, point_m;
};
constexpr Published kPublished[] = {
    {"ICP", 0.597, 0.702}, {"SGD", 0.088, 0.115}, {"the method", 0.035, 0.047}};

// What charts show: not the raw ranges at true poses, nor the seed, which is not a result.
constexpr Mapper kCharted[] = {
    Mapper::kOdometry,  Mapper::kPointToPoint, Mapper::kPointToLine, Mapper::kStochasticDescent,
    Mapper::kPoseGraph, Mapper::kPublished,    Mapper::kPlumbline,   Mapper::kKnownWalls};
struct Pictured {
  Mapper mapper;
  const char* title;
};
constexpr Pictured kPictured[] = {{Mapper::kTruePoses, "true poses, raw ranges"},
                                  {Mapper::kPointToPoint, "pairwise ICP"},
                                  {Mapper::kStochasticDescent, "pose graph, SGD"},
                                  {Mapper::kPublished, "published method"},
                                  {Mapper::kPlumbline, "Plumbline"}};

std::string Describe(const SyntheticNoise& noise) {
  std::ostringstream text;
  text << "range " << 1e3 * noise.sigma_range_m << " mm, bearing "
       << RadToDeg(noise.sigma_bearing_rad) << " deg, odometry x " << noise.odometry_factor;
  return text.str();
}

void WriteRow(const SyntheticSummary& row, std::ostream* table) {
  const auto cell = [&](double value, int width, int precision) {
    *table << std::fixed << std::setprecision(precision) << std::setw(width) << value;
  };
  const auto spread = [&](const Quartiles& quartiles) {
    cell(quartiles.median, 9, 4);
    *table << " [";
    cell(quartiles.low, 6, 4);
    *table << ", ";
    cell(quartiles.high, 6, 4);
    *table << ']';
  };
  const bool is_placed_by_truth = row.mapper == Mapper::kTruePoses;
  *table << "  " << std::left << std::setw(26) << ToString(row.mapper) << std::right;
  if (is_placed_by_truth) {
    *table << std::setw(39) << "-";
  } else {
    spread(row.pose_mean_m);
    *table << std::scientific << std::setprecision(1) << std::setw(12)
           << row.pose_variance_m2.median;
  }
  spread(row.point_mean_m);
  *table << std::scientific << std::setprecision(1) << std::setw(12)
         << row.point_variance_m2.median;
  cell(RadToDeg(row.heading_mean_rad.median), 10, 3);
  *table << std::setw(7) << row.num_failures << " of " << row.num_runs << '\n';
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

constexpr int kChartWidthPx = 1600, kChartHeightPx = 1000;

}  // namespace

std::string SyntheticTable(const std::vector<SyntheticNoise>& noises,
                           const std::vector<SyntheticOutcome>& outcomes) {
  std::ostringstream table;
  int last_noise = -1;
  for (const SyntheticSummary& row : SummariseOutcomes(outcomes)) {
    if (row.noise != last_noise) {
      table
          << (last_noise < 0 ? "" : "\n") << noises[row.noise].name << ": "
          << Describe(noises[row.noise])
          << "\n                              pose error [m]             variance      map error "
             "[m]             variance   heading  failed\n                              median "
             "[quartiles]             m^2         median [quartiles]            m^2         deg\n";
      last_noise = row.noise;
    }
    WriteRow(row, &table);
  }
  table << "\nMedians over the seeds of a run's mean and variance. Failed: a pose more than "
        << std::setprecision(1) << std::fixed << SyntheticOutcome::kFailureM
        << " m off; failures count in all figures.\nPublished (synthetic experiment of the "
           "method's paper), pose / map error [m]:";
  for (const Published& row : kPublished) {
    table << (&row == kPublished ? " " : "; ") << row.name << std::setprecision(3) << ' '
          << row.pose_m << " / " << row.point_m;
  }
  table << '\n';
  return table.str();
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
  for (const Published& row : kPublished) {
    published.push_back({{"algorithm", row.name},
                         {"pose_error_mean_m", row.pose_m},
                         {"map_error_mean_m", row.point_m}});
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
  for (const auto& [mapper, title] : kPictured) {
    MapEstimate& map = maps[static_cast<int>(mapper)];
    MapPanel panel;
    panel.title = title;
    panel.points = map.points;
    panel.trajectory = map.poses;
    figure.panels.push_back(std::move(panel));
  }
  figure.details = ChooseDetails(maps[static_cast<int>(Mapper::kPoseGraph)].points,
                                 maps[static_cast<int>(Mapper::kPlumbline)].points, 2, kDetailM);
  return WriteMapFigure(path, figure, MapFigureOptions());
}

}  // namespace plumbline
