#ifndef PLUMBLINE_APPS_SIMULATION_TRAFFIC_H_
#define PLUMBLINE_APPS_SIMULATION_TRAFFIC_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/drive.h"
#include "plumbline/apps/simulation/world.h"

namespace plumbline {

/// What moves in a building while the robot drives.
struct TrafficOptions {
  int num_people = 0;  ///< who walk around the robot, up to 1000, at most 4 m ahead of it or behind
  bool doors_move = false;  ///< doors slide shut and open again; by default they stand open

  bool IsOn() const { return num_people > 0 || doors_move; }
  bool Check(std::string* error) const;
};

/// Where everybody and every door is at any time. Nobody comes closer to the robot than 0.5 m, and
/// no door shuts within 1.5 m of it.
class Traffic {
 public:
  /// The same seed gives the same traffic. Keeps a reference to the drive.
  Traffic(const Building& building, const Drive& drive, const TrafficOptions& options,
          std::uint64_t seed);

  /// What is in the way `time_s` after the start: people as discs, shut doors as faces.
  World At(double time_s, const Eigen::Vector2d& robot) const;

 private:
  // Comes and goes; amplitude 1.
  struct Swing {
    double period_s, phase_rad;
    double At(double time_s) const;
  };
  struct Person {
    Swing along, across;
    double radius_m;
  };
  struct Door {
    Face leaf;
    Swing swing;
  };

  const Drive& drive_;
  std::vector<Person> people_;
  std::vector<Door> doors_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_TRAFFIC_H_
