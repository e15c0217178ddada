#include "plumbline/apps/benchmark/sensor_matrix.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/apps/benchmark/synthetic_drive.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/floor.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kGlassStream = 6;  // the simulator has 0, 1 and 5, floors 2 to 4

// Beams side by side over the whole field of view, its middle ahead. A full turn has no beam twice.
LaserModel Laser(double field_deg, double step_deg) {
  LaserModel laser;
  laser.num_beams = static_cast<int>(std::lround(field_deg / step_deg)) + (field_deg < 360 ? 1 : 0);
  laser.first_bearing_rad = DegToRad(-0.5 * field_deg);
  laser.bearing_step_rad = DegToRad(step_deg);
  laser.max_range_m = 30.0;
  return laser;
}

std::function<Building(std::uint64_t)> Make(BuildingKind kind) {
  return [kind](std::uint64_t seed) { return GenerateBuilding(kind, seed); };
}

// Two corridors of 45 m with a niche every 4 m.
Building MakeCorridors(std::uint64_t seed) {
  FloorStyle style;
  style.room_width_m = 4.0;
  style.block_widths_m = {4.0, 40.0, 4.0};
  for (double& depth : style.row_depths_m) depth = 0.5;
  style.core_depth_m = 12.0;
  style.corridor_wall_m = 0.4;
  style.corridor_width_m = style.cross_corridor_width_m = 2.4;
  style.door_width_m = 1.2;
  style.irregularity = 0.3;
  style.drive_length_m = 140.0;
  Building building = MakeFloor(style, seed);
  building.name = "corridors " + std::to_string(seed);
  return building;
}

void MakeGlass(double share, std::uint64_t seed, Building* building) {
  NoiseSource source(seed, kGlassStream);
  for (Face& face : building->faces) face.is_glass = source.Uniform() < share;
}

Truth TruthFor(const SimulatedLog& log, const SlamGraph& graph) {
  MapEstimate exact = TruthOf(log, graph);
  Truth truth;
  for (std::size_t i = 0; i < exact.poses.size(); ++i) {
    truth.trajectory.push_back({log.scans[i].scan.timestamp_s, exact.poses[i]});
  }
  truth.points = std::move(exact.points);
  return truth;
}

double ShareWithoutTruth(const Truth& truth) {
  std::size_t without = 0;
  for (std::size_t i = 0; i < truth.points.size(); i += 2) {
    if (std::isnan(truth.points[i])) ++without;
  }
  return 2.0 * static_cast<double>(without) / static_cast<double>(truth.points.size());
}

// What the joint estimation makes of a start within a centimetre of the truth.
Status MeasureFloor(const SolverOptions& solver, const MeasuredSurface& surface,
                    const SlamGraph& graph, const Truth& truth, ThreadPool* pool, double* floor_m) {
  MapState state = graph.InitialState();
  for (int i = 0; i < graph.num_poses(); ++i) {
    const Pose2 off(0.01 * std::sin(2.1 * i), 0.01 * std::sin(1.3 * i), 0.003 * std::sin(3.3 * i));
    state.SetPose(i, truth.trajectory[i].world_from_robot * off);
  }
  state.points = graph.MeasuredMap(state.poses);
  const SolverSummary summary = RefineState(solver, surface, graph, &state);
  if (!summary.IsSolutionUsable()) return Status::InvalidArgument(summary.message);
  *floor_m = MeasureStage("floor", graph, state, &truth, pool).error->mean_pose_error_m;
  return Status::Ok();
}

// On one thread.
Status RunCase(const SensorCase& sensor, const SolverOptions& solver, const SeedingOptions& seeding,
               SensorOutcome* outcome) {
  Building building = sensor.make_building(outcome->seed);
  MakeGlass(sensor.glass_share, outcome->seed, &building);
  SimulationOptions simulation = sensor.simulation;
  simulation.seed = outcome->seed;
  SimulatedLog log;
  SlamGraph graph;
  PLUMBLINE_RETURN_IF_ERROR(Simulate(World(std::move(building)), simulation, &log));
  if (sensor.sweeps_unknown) log.laser.beam_period_s = 0.0;
  PLUMBLINE_RETURN_IF_ERROR(MakeGraph(log, &graph));
  const Truth truth = TruthFor(log, graph);
  outcome->num_scans = graph.num_scans();
  outcome->outlier_share = ShareWithoutTruth(truth);

  MapLogOptions options;
  options.seeding = seeding;
  options.solver = solver;
  options.solver.num_threads = 1;
  options.solver.factors.shape = sensor.shape;
  ThreadPool pool(1);
  LogMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, std::move(graph), &pool, &mapping));
  PLUMBLINE_RETURN_IF_ERROR(SeedLog(options, {}, &pool, &mapping));
  outcome->seeded = MeasureStage("seed", mapping.graph, mapping.state, &truth, &pool);
  PLUMBLINE_RETURN_IF_ERROR(MeasureFloor(RefinementOptions(options, mapping), mapping.surface,
                                         mapping.graph, truth, &pool, &outcome->floor_m));
  PLUMBLINE_RETURN_IF_ERROR(RefineLog(options, &pool, &mapping));
  outcome->refined = MeasureStage("refined", mapping.graph, mapping.state, &truth, &pool);
  outcome->alarm = !mapping.report.alarms.empty();
  return Status::Ok();
}

}  // namespace

std::vector<SensorCase> SensorCases() {
  SensorCase base{"base", "180 deg, 0.5 deg, 30 m, 12 mm", Make(BuildingKind::kRandom), {}};
  base.simulation.laser = Laser(180.0, 0.5);
  std::vector<SensorCase> cases = {base};
  const auto add = [&](const char* group, const char* name) -> SensorCase& {
    cases.push_back(base);
    cases.back().group = group;
    cases.back().name = name;
    return cases.back();
  };
  add("field of view", "270 deg").simulation.laser = Laser(270.0, 0.5);
  add("field of view", "360 deg").simulation.laser = Laser(360.0, 0.5);
  add("beam step", "0.25 deg").simulation.laser = Laser(180.0, 0.25);
  add("beam step", "1 deg").simulation.laser = Laser(180.0, 1.0);
  add("greatest range", "4 m").simulation.laser.max_range_m = 4.0;
  add("greatest range", "8 m").simulation.laser.max_range_m = 8.0;
  add("greatest range", "100 m").simulation.laser.max_range_m = 100.0;
  add("range noise", "5 mm").simulation.laser_noise.sigma_range_m = 0.005;
  add("range noise", "30 mm").simulation.laser_noise.sigma_range_m = 0.03;
  add("range noise", "50 mm").simulation.laser_noise.sigma_range_m = 0.05;
  add("mounting", "0.3 m ahead, 0.1 m left, 20 deg").simulation.laser.robot_from_laser = {
      0.3, 0.1, DegToRad(20.0)};
  LaserModel& reversed = add("mounting", "beams from left to right").simulation.laser;
  reversed.first_bearing_rad = -reversed.first_bearing_rad;
  reversed.bearing_step_rad = -reversed.bearing_step_rad;
  const double speed_m_s = base.simulation.drive.speed_m_s;
  add("few scans", "one per 0.5 m").simulation.scan_period_s = 0.5 / speed_m_s;
  add("few scans", "one per 1 m").simulation.scan_period_s = 1.0 / speed_m_s;
  // As fast as a robot drives in a building; its laser turns without a pause.
  constexpr double kSweepS = 0.15;
  SensorCase at_once = base;
  at_once.simulation.scan_period_s = kSweepS;
  at_once.simulation.drive.speed_m_s = 0.7;
  at_once.simulation.drive.turn_rate_rad_s = DegToRad(60.0);
  SensorCase swept = at_once;
  swept.simulation.laser.beam_period_s = kSweepS / swept.simulation.laser.num_beams;
  for (const auto& [name, sweeping] : {std::pair("at once", &at_once), std::pair("0.15 s", &swept),
                                       std::pair("0.15 s, not known", &swept)}) {
    add("sweep at 0.7 m/s, 60 deg/s", name).simulation = sweeping->simulation;
  }
  cases.back().sweeps_unknown = true;
  add("things that move", "4 people").simulation.traffic.num_people = 4;
  add("things that move", "10 people").simulation.traffic.num_people = 10;
  add("things that move", "20 people").simulation.traffic.num_people = 20;
  add("things that move", "doors").simulation.traffic.doors_move = true;
  add("things that move", "4 people, doors").simulation.traffic = {4, true};
  add("glass", "20 % of all faces").glass_share = 0.2;
  add("building", "long corridors").make_building = MakeCorridors;
  SensorCase& hall = add("building", "hall, range 8 m");
  hall.make_building = Make(BuildingKind::kHall);
  hall.simulation.laser.max_range_m = 8.0;
  add("building", "hall").make_building = Make(BuildingKind::kHall);
  add("building", "round").make_building = Make(BuildingKind::kRound);
  add("building", "slanted").make_building = Make(BuildingKind::kSlanted);
  const std::size_t num_without_shape = cases.size();
  for (std::size_t i = 0; i < num_without_shape; ++i) {
    if (i > 0 && cases[i].name != "round" && cases[i].name != "slanted") continue;
    SensorCase with_shape = cases[i];
    with_shape.group = "shape potential";
    if (i == 0) with_shape.name = "office";
    with_shape.shape = true;
    cases.push_back(std::move(with_shape));
  }
  return cases;
}

bool SensorOutcome::IsWorse() const {
  return refined.error->mean_pose_error_m > seeded.error->mean_pose_error_m + floor_m;
}

bool SensorOutcome::IsSilentlyLost() const {
  return !alarm && !(refined.error->max_pose_error_m <= kLostM);
}

Status RunSensorCases(const std::vector<SensorCase>& cases, int num_seeds,
                      const SolverOptions& solver, const SeedingOptions& seeding, ThreadPool* pool,
                      std::vector<SensorOutcome>* outcomes) {
  const std::size_t num_runs = cases.size() * static_cast<std::size_t>(num_seeds);
  std::vector<SensorOutcome> results(num_runs);
  std::vector<Status> statuses(num_runs);
  pool->ForEachChunk(num_runs, 1, [&](std::size_t i, std::size_t, std::size_t) {
    results[i].case_index = static_cast<int>(i) / num_seeds;
    results[i].seed = i % num_seeds + 1;
    const SensorCase& sensor = cases[results[i].case_index];
    const Status status = RunCase(sensor, solver, seeding, &results[i]);
    if (status.ok()) return;
    statuses[i] =
        Status::InvalidArgument(sensor.group + ", " + sensor.name + ", seed " +
                                std::to_string(results[i].seed) + ": " + status.message());
  });
  for (const Status& status : statuses) PLUMBLINE_RETURN_IF_ERROR(status);
  *outcomes = std::move(results);
  return Status::Ok();
}

}  // namespace plumbline
