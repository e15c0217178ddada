#include <cmath>

#include "plumbline/apps/simulation/building_reader.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/test/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile file;
  Building building;
  if (!ReadBuilding(file.Holding(data, size), &building).ok()) return 0;
  double path_length_m = 0.0;
  for (std::size_t i = 1; i < building.path.size(); ++i) {
    path_length_m += (building.path[i].position - building.path[i - 1].position).norm();
  }
  const World world(std::move(building));
  const double range_m = world.CastRay({0.1, 0.2}, 0.3);
  Require(range_m >= 0.0);
  constexpr double kMaxPathM = 100.0;
  if (path_length_m > kMaxPathM) return 0;
  SimulationOptions options;
  options.laser.num_beams = 5;
  SimulatedLog log;
  if (!Simulate(world, options, &log).ok()) return 0;
  Require(!log.scans.empty() && std::isfinite(log.path_length_m));
  return 0;
}
