#include "plumbline/apps/benchmark/sensor_report.h"

#include <algorithm>
#include <cstddef>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "plumbline/apps/benchmark/map_errors.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/units.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// A figure of a stage, in the units of the table and under the name of the files.
struct StageFigure {
  const char* name;
  double (*of)(const Stage& stage);
  double table_unit;
  int precision;
};
constexpr StageFigure kStageFigures[] = {
    {"pose_error_m", [](const Stage& s) { return s.error->mean_pose_error_m; }, kMmPerM, 1},
    {"pose_error_max_m", [](const Stage& s) { return s.error->max_pose_error_m; }, kMmPerM, 1},
    {"heading_error_rad", [](const Stage& s) { return s.error->mean_pose_error_rad; }, 180.0 / kPi,
     3},
    {"map_error_m", [](const Stage& s) { return s.error->mean_point_error_m; }, kMmPerM, 1},
    {"wall_thickness_m", [](const Stage& s) { return s.quality.wall_thickness_m; }, kMmPerM, 1}};
constexpr int kPoseError = 0, kMaxPoseError = 1;

std::vector<const SensorOutcome*> RunsOf(const std::vector<SensorOutcome>& outcomes,
                                         std::size_t case_index) {
  std::vector<const SensorOutcome*> runs;
  for (const SensorOutcome& run : outcomes) {
    if (run.case_index == static_cast<int>(case_index)) runs.push_back(&run);
  }
  return runs;
}

std::vector<double> ValuesOf(const std::vector<const SensorOutcome*>& runs,
                             Stage SensorOutcome::*stage, const StageFigure& figure) {
  std::vector<double> values;
  values.reserve(runs.size());
  for (const SensorOutcome* run : runs) values.push_back(figure.of(run->*stage));
  return values;
}

void WriteRow(const SensorCase& sensor, const std::vector<const SensorOutcome*>& runs,
              std::ostream* table) {
  double outlier_share = 0.0;
  int num_alarms = 0, num_failed = 0;
  for (const SensorOutcome* run : runs) {
    outlier_share += run->outlier_share / static_cast<double>(runs.size());
    num_alarms += run->alarm ? 1 : 0;
    num_failed += run->Failed() ? 1 : 0;
  }
  const auto cell = [&](double value, int width, int precision) {
    *table << std::fixed << std::setprecision(precision) << std::setw(width) << value;
  };
  *table << "  " << std::left << std::setw(34) << sensor.name << std::right;
  cell(1e2 * outlier_share, 6, 1);
  for (const StageFigure& figure : kStageFigures) {
    if (&figure == &kStageFigures[kMaxPoseError]) {
      const std::vector<double> poses =
          ValuesOf(runs, &SensorOutcome::refined, kStageFigures[kPoseError]);
      cell(*std::max_element(poses.begin(), poses.end()) * kMmPerM, 9, 1);
      continue;
    }
    for (Stage SensorOutcome::*const stage : {&SensorOutcome::seeded, &SensorOutcome::refined}) {
      const double median = QuartilesOf(ValuesOf(runs, stage, figure)).median;
      cell(median * figure.table_unit, 9, figure.precision);
    }
  }
  *table << std::setw(8) << num_alarms << std::setw(8) << num_failed << '\n';
}

void WriteFailure(const SensorCase& sensor, const SensorOutcome& run, std::ostream* table) {
  *table << "Failed: " << sensor.group << ", " << sensor.name << ", seed " << run.seed << ": "
         << std::fixed << std::setprecision(1) << "mean pose error "
         << kMmPerM * run.seeded.error->mean_pose_error_m << " -> "
         << kMmPerM * run.refined.error->mean_pose_error_m << " mm, greatest "
         << kMmPerM * run.seeded.error->max_pose_error_m << " -> "
         << kMmPerM * run.refined.error->max_pose_error_m << " mm"
         << (run.IsSilentlyLost() ? ", without a warning" : "") << '\n';
}

Json StageJson(const Stage& stage) {
  Json json;
  for (const StageFigure& figure : kStageFigures) json[figure.name] = figure.of(stage);
  return json;
}

Json CaseJson(const SensorCase& sensor) {
  const SimulationOptions& simulation = sensor.simulation;
  const LaserModel& laser = simulation.laser;
  const Pose2& mounting = laser.robot_from_laser;
  return {{"group", sensor.group},
          {"case", sensor.name},
          {"num_beams", laser.num_beams},
          {"first_bearing_rad", laser.first_bearing_rad},
          {"bearing_step_rad", laser.bearing_step_rad},
          {"max_range_m", laser.max_range_m},
          {"robot_from_laser", {mounting.x, mounting.y, mounting.yaw}},
          {"sigma_range_m", simulation.laser_noise.sigma_range_m},
          {"scan_period_s", simulation.scan_period_s},
          {"people", simulation.traffic.num_people},
          {"doors_move", simulation.traffic.doors_move},
          {"glass_share", sensor.glass_share},
          {"shape", sensor.shape},
          {"runs", Json::array()}};
}

}  // namespace

std::string SensorTable(const std::vector<SensorCase>& cases,
                        const std::vector<SensorOutcome>& outcomes) {
  std::ostringstream table;
  table
      << "                                     out-   pose error, mean [mm]        heading [deg]  "
         "      map error [mm]    thickness [mm]\n"
         "                                    liers     seed  refined    worst     seed  refined  "
         "   seed  refined     seed  refined  warned  failed\n";
  std::string group;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const std::vector<const SensorOutcome*> runs = RunsOf(outcomes, i);
    if (runs.empty()) continue;
    if (cases[i].group != group) table << cases[i].group << '\n';
    group = cases[i].group;
    WriteRow(cases[i], runs, &table);
  }
  table
      << "\nOutliers: returns that are not the building's, in per cent, in the mean. Medians over "
         "the seeds; worst: of the refined.\n";
  for (const SensorOutcome& run : outcomes) {
    if (run.Failed()) WriteFailure(cases[run.case_index], run, &table);
  }
  return table.str();
}

Status WriteSensorCsv(const std::string& path, const std::vector<SensorCase>& cases,
                      const std::vector<SensorOutcome>& outcomes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "group,case,seed,scans,outlier_share";
  for (const char* stage : {"seed", "refined"}) {
    for (const StageFigure& figure : kStageFigures) out << ',' << stage << '_' << figure.name;
  }
  out << ",floor_pose_error_m,alarm,worse,silently_lost\n" << std::setprecision(6);
  for (const SensorOutcome& run : outcomes) {
    const SensorCase& sensor = cases[run.case_index];
    out << '"' << sensor.group << "\",\"" << sensor.name << "\"," << run.seed << ','
        << run.num_scans << ',' << run.outlier_share;
    for (const Stage* stage : {&run.seeded, &run.refined}) {
      for (const StageFigure& figure : kStageFigures) out << ',' << figure.of(*stage);
    }
    out << ',' << run.floor_m << ',' << run.alarm << ',' << run.IsWorse() << ','
        << run.IsSilentlyLost() << '\n';
  }
  return file.Commit();
}

Status WriteSensorJson(const std::string& path, const std::vector<SensorCase>& cases,
                       const std::vector<SensorOutcome>& outcomes) {
  Json json = Json::array();
  for (const SensorCase& sensor : cases) json.push_back(CaseJson(sensor));
  for (const SensorOutcome& run : outcomes) {
    json[run.case_index]["runs"].push_back({{"seed", run.seed},
                                            {"scans", run.num_scans},
                                            {"outlier_share", run.outlier_share},
                                            {"seeded", StageJson(run.seeded)},
                                            {"refined", StageJson(run.refined)},
                                            {"floor_pose_error_m", run.floor_m},
                                            {"alarm", run.alarm},
                                            {"worse", run.IsWorse()},
                                            {"silently_lost", run.IsSilentlyLost()}});
  }
  return WriteJson(path, {{"lost_m", SensorOutcome::kLostM}, {"cases", json}});
}

}  // namespace plumbline
