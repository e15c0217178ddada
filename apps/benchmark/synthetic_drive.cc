#include "plumbline/apps/benchmark/synthetic_drive.h"

#include <utility>

#include "plumbline/apps/simulation/floor.h"
#include "plumbline/apps/simulation/noise_source.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kStyleStream = 2;  // as for all floors
constexpr int kNumScans = 16;

// One block between four rows of rooms; the drive goes around it once.
Building MakeBuilding(std::uint64_t seed) {
  NoiseSource source(seed, kStyleStream);
  const auto draw = [&](double low, double high) { return low + (high - low) * source.Uniform(); };
  FloorStyle style;
  for (const double mean : {3.5, 6.5, 3.5}) {
    style.block_widths_m.push_back(draw(mean - 0.7, mean + 0.7));
  }
  for (double& depth : style.row_depths_m) depth = draw(2.4, 3.0);
  style.corridor_width_m = draw(2.0, 2.6);
  style.cross_corridor_width_m = draw(1.8, 2.6);
  style.room_width_m = draw(3.0, 4.5);
  style.irregularity = 1.0;
  style.furniture_per_room = 6;
  style.furniture_per_corridor_m = 0.15;
  style.route = RouteKind::kTour;
  Building building = MakeFloor(style, seed);
  building.name = "synthetic building " + std::to_string(seed);
  return building;
}

Status SimulateDrive(std::uint64_t seed, const SyntheticNoise& noise, SyntheticDrive* drive) {
  const World world(drive->building);
  SimulationOptions options;
  options.laser.num_beams = 720;
  options.laser.first_bearing_rad = -kPi;
  options.laser.bearing_step_rad = 2.0 * kPi / options.laser.num_beams;
  options.laser_noise = noise.Laser();
  options.odometry_noise = noise.Odometry();
  options.seed = seed;
  Drive plan;
  PLUMBLINE_RETURN_IF_ERROR(Drive::Plan(world, options.drive, &plan));
  // A hair less than the even share: rounding must not cost the last scan.
  options.scan_period_s = plan.duration_s() / (kNumScans - 1 + 1e-6);
  return Simulate(world, options, &drive->log);
}

}  // namespace

LaserNoise SyntheticNoise::Laser() const {
  LaserNoise laser;
  laser.sigma_range_m = sigma_range_m;
  laser.sigma_bearing_rad = sigma_bearing_rad;
  return laser;
}

OdometryNoise SyntheticNoise::Odometry() const { return Scaled(OdometryNoise(), odometry_factor); }

Status MakeSyntheticDrive(std::uint64_t seed, const SyntheticNoise& noise, SyntheticDrive* drive) {
  SyntheticDrive result;
  result.building = MakeBuilding(seed);
  PLUMBLINE_RETURN_IF_ERROR(SimulateDrive(seed, noise, &result));
  PLUMBLINE_RETURN_IF_ERROR(MakeGraph(result.log, &result.graph));
  result.truth = TruthOf(result.log, result.graph);
  *drive = std::move(result);
  return Status::Ok();
}

std::vector<double> PlacedReturns(const SlamGraph& graph, const std::vector<Pose2>& poses) {
  std::vector<double> coordinates;
  for (const Pose2& pose : poses) {
    coordinates.insert(coordinates.end(), {pose.x, pose.y, pose.yaw});
  }
  return graph.MeasuredMap(coordinates);
}

}  // namespace plumbline
