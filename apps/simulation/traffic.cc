#include "plumbline/apps/simulation/traffic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kTrafficStream = 5;  // the simulator has 0 and 1, floors 2 to 4

constexpr double kReachM = 4.0;     // of a person, along the robot's path
constexpr double kSidestepM = 0.7;  // and across it
constexpr double kPersonalM = 0.5;  // that the robot has around its centre
constexpr double kDoorwayM = 1.5;   // that it has around a door
constexpr double kOpenShare = 0.3;  // of a door's swing: open below, shut above

}  // namespace

bool TrafficOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(num_people, 0, 1000);
  return true;
}

double Traffic::Swing::At(double time_s) const {
  return std::sin(2.0 * kPi * time_s / period_s + phase_rad);
}

Traffic::Traffic(const Building& building, const Drive& drive, const TrafficOptions& options,
                 std::uint64_t seed)
    : drive_(drive) {
  NoiseSource source(seed, kTrafficStream);
  const auto swing = [&](double shortest_s, double longest_s) {
    const double period_s = shortest_s + (longest_s - shortest_s) * source.Uniform();
    return Swing{period_s, 2.0 * kPi * source.Uniform()};
  };
  for (int i = 0; i < options.num_people; ++i) {
    const Swing along = swing(25.0, 50.0), across = swing(5.0, 15.0);
    people_.push_back({along, across, 0.18 + 0.1 * source.Uniform()});
  }
  if (!options.doors_move) return;
  for (const Face& leaf : building.doors) doors_.push_back({leaf, swing(40.0, 120.0)});
}

World Traffic::At(double time_s, const Eigen::Vector2d& robot) const {
  Building moving;
  const double path_s_per_m = drive_.duration_s() / drive_.length_m();
  for (const Person& person : people_) {
    const double lead_s = kReachM * path_s_per_m * person.along.At(time_s);
    const Pose2 on_path =
        drive_.WorldFromRobot(std::clamp(time_s + lead_s, 0.0, drive_.duration_s()));
    const Eigen::Vector2d place =
        on_path * Eigen::Vector2d(0.0, kSidestepM * person.across.At(time_s));
    if ((place - robot).norm() - person.radius_m < kPersonalM) continue;  // steps out of its way
    moving.discs.push_back({place, person.radius_m});
  }
  for (const Door& door : doors_) {
    const Eigen::Vector2d middle = 0.5 * (door.leaf.a + door.leaf.b);
    if (door.swing.At(time_s) < kOpenShare || (middle - robot).norm() < kDoorwayM) continue;
    moving.faces.push_back(door.leaf);
  }
  return World(std::move(moving));
}

}  // namespace plumbline
