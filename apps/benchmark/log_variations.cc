#include "plumbline/apps/benchmark/log_variations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/laser_scan.h"

namespace plumbline {
namespace {

// Range of times around a relation's time in which a scan is the one it was made for [s]: logs and
// relations have microseconds.
constexpr double kSameTimeS = 1e-4;

double FirstTime(const CarmenLog& log) { return log.scans.front().timestamp_s; }
double LastTime(const CarmenLog& log) { return log.scans.back().timestamp_s; }

// Uniform integer from 0 to below `end`.
std::size_t DrawIndex(std::size_t end, NoiseSource* source) {
  return static_cast<std::size_t>(source->Uniform() * static_cast<double>(end));
}

double DrawEither(double a, double b, NoiseSource* source) {
  return source->Uniform() < 0.5 ? a : b;
}

void KeepSame(NoiseSource*, KnownLog*) {}

std::size_t DrawCut(NoiseSource* source, const CarmenLog& log) {
  constexpr double kMinShare = 0.1, kMaxShare = 0.4;
  return static_cast<std::size_t>(source->Uniform(kMinShare, kMaxShare) *
                                  static_cast<double>(log.scans.size()));
}

void StartLate(NoiseSource* source, KnownLog* known) {
  std::vector<CarmenScan>& scans = known->log.scans;
  scans.erase(scans.begin(), scans.begin() + DrawCut(source, known->log));
}

void EndEarly(NoiseSource* source, KnownLog* known) {
  std::vector<CarmenScan>& scans = known->log.scans;
  scans.resize(scans.size() - DrawCut(source, known->log));
}

void CutGaps(NoiseSource* source, KnownLog* known) {
  constexpr double kGapS = 3.0;
  constexpr double kMarginS = 10.0;  // from the ends of the drive, a quarter of it at most
  std::vector<CarmenScan>& scans = known->log.scans;
  const double first_s = FirstTime(known->log), last_s = LastTime(known->log);
  const double margin_s = std::min(kMarginS, 0.25 * (last_s - first_s));
  std::array<double, 5> starts_s;
  for (double& start_s : starts_s) start_s = source->Uniform(first_s + margin_s, last_s - margin_s);
  const auto is_in_gap = [&](const CarmenScan& scan) {
    return std::any_of(starts_s.begin(), starts_s.end(), [&](double start_s) {
      return scan.timestamp_s >= start_s && scan.timestamp_s < start_s + kGapS;
    });
  };
  scans.erase(std::remove_if(scans.begin(), scans.end(), is_in_gap), scans.end());
}

template <std::size_t kStep>
void Thin(NoiseSource* source, KnownLog* known) {
  std::vector<CarmenScan>& scans = known->log.scans;
  std::vector<CarmenScan> kept;
  for (std::size_t i = DrawIndex(kStep, source); i < scans.size(); i += kStep) {
    kept.push_back(std::move(scans[i]));
  }
  scans = std::move(kept);
}

void RunBackwards(NoiseSource*, KnownLog* known) {
  std::vector<CarmenScan>& scans = known->log.scans;
  const double first_s = FirstTime(known->log), last_s = LastTime(known->log);
  const auto reverse = [=](double* time_s) { *time_s = first_s + (last_s - *time_s); };
  std::reverse(scans.begin(), scans.end());
  for (CarmenScan& scan : scans) reverse(&scan.timestamp_s);
  for (Relation& relation : known->relations) {
    reverse(&relation.from_s);
    reverse(&relation.to_s);
  }
}

Pose2 Mirrored(const Pose2& pose) { return {pose.x, -pose.y, -pose.yaw}; }

// The beams stay counter-clockwise, as laser drivers report them.
void MirrorBuilding(NoiseSource*, KnownLog* known) {
  for (CarmenScan& scan : known->log.scans) {
    const auto num_steps = static_cast<double>(scan.ranges.size() - 1);
    scan.first_bearing_rad = -(scan.first_bearing_rad + num_steps * scan.bearing_step_rad);
    std::reverse(scan.ranges.begin(), scan.ranges.end());
    scan.odom_from_laser = Mirrored(scan.odom_from_laser);
    scan.odom_from_robot = Mirrored(scan.odom_from_robot);
  }
  for (Relation& relation : known->relations) {
    relation.from_from_to = Mirrored(relation.from_from_to);
  }
}

void TurnLaser(NoiseSource* source, KnownLog* known) {
  const double angle_rad = source->Uniform(-kPi, kPi);
  for (CarmenScan& scan : known->log.scans) {
    scan.odom_from_laser.yaw = NormalizeAngle(scan.odom_from_laser.yaw + angle_rad);
    scan.first_bearing_rad = NormalizeAngle(scan.first_bearing_rad - angle_rad);
  }
}

bool IsReturn(const CarmenScan& scan, double range_m) {
  return range_m >= LaserModel().min_range_m && range_m < scan.max_range_m;
}

// is_lost(scan, beam): whether the reading becomes "no return".
template <typename Predicate>
void LoseReadings(const Predicate& is_lost, KnownLog* known) {
  for (CarmenScan& scan : known->log.scans) {
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
      if (is_lost(scan, beam)) scan.ranges[beam] = scan.max_range_m;
    }
  }
}

void NarrowView(NoiseSource*, KnownLog* known) {
  LoseReadings(
      [](const CarmenScan& scan, std::size_t beam) {
        const std::size_t num_lost = scan.ranges.size() / 6;
        return beam < num_lost || beam >= scan.ranges.size() - num_lost;
      },
      known);
}

void ShortenRange(NoiseSource*, KnownLog* known) {
  constexpr double kRangeM = 8.0;
  LoseReadings(
      [](const CarmenScan& scan, std::size_t beam) { return !(scan.ranges[beam] < kRangeM); },
      known);
}

template <std::size_t kStep>
void ThinBeams(NoiseSource*, KnownLog* known) {
  LoseReadings([](const CarmenScan&, std::size_t beam) { return beam % kStep != 0; }, known);
}

void AddRangeNoise(NoiseSource* source, KnownLog* known) {
  constexpr double kSigmaM = 0.02;
  for (CarmenScan& scan : known->log.scans) {
    for (double& range_m : scan.ranges) {
      if (!IsReturn(scan, range_m)) continue;
      range_m = std::max(0.0, range_m + kSigmaM * source->Gaussian());
    }
  }
}

// Moves the laser rigidly with the robot.
void MoveRobot(const Pose2& odom_from_robot, CarmenScan* scan) {
  const Pose2 robot_from_laser = Between(scan->odom_from_robot, scan->odom_from_laser);
  scan->odom_from_robot = odom_from_robot;
  scan->odom_from_laser = odom_from_robot * robot_from_laser;
}

// Chains the odometry anew from changed steps: Pose2 change(step).
template <typename Change>
void ChangeSteps(const Change& change, KnownLog* known) {
  std::vector<CarmenScan>& scans = known->log.scans;
  Pose2 given = scans.front().odom_from_robot, changed = given;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const Pose2 step = Between(given, scans[i].odom_from_robot);
    given = scans[i].odom_from_robot;
    changed = changed * change(step);
    changed.yaw = NormalizeAngle(changed.yaw);
    MoveRobot(changed, &scans[i]);
  }
}

void AddOdometryNoise(NoiseSource* source, KnownLog* known) {
  constexpr double kLengthPerLength = 0.1;     // [m per m]
  constexpr double kSidewaysPerLength = 0.02;  // [m per m]
  constexpr double kTurnPerTurn = 0.15;        // [rad per rad]
  constexpr double kTurnPerRootLength = 0.03;  // [rad per root of m]
  ChangeSteps(
      [&](const Pose2& step) {
        const double length = source->Gaussian(), sideways = source->Gaussian();
        const double turn = source->Gaussian(), drift = source->Gaussian();
        return Pose2(step.x * (1.0 + kLengthPerLength * length),
                     step.y + kSidewaysPerLength * sideways * std::abs(step.x),
                     step.yaw + kTurnPerTurn * turn * std::abs(step.yaw) +
                         kTurnPerRootLength * drift * std::sqrt(std::abs(step.x)));
      },
      known);
}

void ScaleOdometry(double translation, double rotation, KnownLog* known) {
  ChangeSteps(
      [=](const Pose2& step) {
        return Pose2(translation * step.x, translation * step.y, rotation * step.yaw);
      },
      known);
}

void MiscaleOdometry(NoiseSource* source, KnownLog* known) {
  const double translation = DrawEither(0.95, 1.05, source);
  const double rotation = DrawEither(0.93, 1.07, source);
  ScaleOdometry(translation, rotation, known);
}

void ShrinkOdometry(NoiseSource*, KnownLog* known) { ScaleOdometry(0.3, 1.0, known); }
void ReverseOdometry(NoiseSource*, KnownLog* known) { ScaleOdometry(-1.0, 1.0, known); }
void KeepHeadingsOnly(NoiseSource*, KnownLog* known) { ScaleOdometry(0.0, 1.0, known); }

void RemoveOdometry(NoiseSource*, KnownLog* known) {
  const Pose2 odom_from_robot = known->log.scans.front().odom_from_robot;
  for (CarmenScan& scan : known->log.scans) MoveRobot(odom_from_robot, &scan);
  // Without odometry this parameter would replace the mounting that the relations belong to.
  known->log.params.erase("robot_frontlaser_offset");
}

// Odometry at a time between two scans, or at the nearer end of the log.
Pose2 OdometryAt(double time_s, const std::vector<double>& times_s,
                 const std::vector<Pose2>& odometry) {
  const auto after = std::upper_bound(times_s.begin() + 1, times_s.end() - 1, time_s);
  const std::size_t i = after - times_s.begin() - 1;
  const double period_s = std::max(1e-6, times_s[i + 1] - times_s[i]);
  const double share = std::clamp((time_s - times_s[i]) / period_s, 0.0, 1.0);
  const Pose2 step = Between(odometry[i], odometry[i + 1]);
  return odometry[i] * Pose2(share * step.x, share * step.y, share * step.yaw);
}

void ShiftClock(NoiseSource* source, KnownLog* known) {
  constexpr double kMaxShiftS = 0.1;
  const double shift_s = source->Uniform(-kMaxShiftS, kMaxShiftS);
  std::vector<double> times_s;
  std::vector<Pose2> odometry;
  for (const CarmenScan& scan : known->log.scans) {
    times_s.push_back(scan.timestamp_s);
    odometry.push_back(scan.odom_from_robot);
  }
  for (CarmenScan& scan : known->log.scans) {
    MoveRobot(OdometryAt(scan.timestamp_s + shift_s, times_s, odometry), &scan);
  }
}

// Stream of random numbers of a variation: FNV-1a hash of its name, so that further variations
// change no numbers.
std::uint32_t StreamOf(const std::string& name) {
  std::uint32_t hash = 2166136261U;
  for (const char letter : name) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
  return hash;
}

std::vector<double> SortedTimes(const CarmenLog& log) {
  std::vector<double> times_s;
  for (const CarmenScan& scan : log.scans) times_s.push_back(scan.timestamp_s);
  std::sort(times_s.begin(), times_s.end());
  return times_s;
}

bool HasScanAt(double time_s, const std::vector<double>& sorted_times_s) {
  const auto first =
      std::lower_bound(sorted_times_s.begin(), sorted_times_s.end(), time_s - kSameTimeS);
  return first != sorted_times_s.end() && *first <= time_s + kSameTimeS;
}

}  // namespace

const std::vector<LogVariation>& LogVariations() {
  static const std::vector<LogVariation> variations = {{"same", false, KeepSame},
                                                       {"late", true, StartLate},
                                                       {"early", true, EndEarly},
                                                       {"gaps", true, CutGaps},
                                                       {"thin2", true, Thin<2>},
                                                       {"thin5", true, Thin<5>},
                                                       {"backwards", false, RunBackwards},
                                                       {"mirror", false, MirrorBuilding},
                                                       {"turned", true, TurnLaser},
                                                       {"fov120", false, NarrowView},
                                                       {"range8", false, ShortenRange},
                                                       {"beams2", false, ThinBeams<2>},
                                                       {"beams4", false, ThinBeams<4>},
                                                       {"noise2cm", true, AddRangeNoise},
                                                       {"odo2", true, AddOdometryNoise},
                                                       {"odoscale", true, MiscaleOdometry},
                                                       {"shift", true, ShiftClock},
                                                       {"scale03", false, ShrinkOdometry},
                                                       {"reversed", false, ReverseOdometry},
                                                       {"xy_constant", false, KeepHeadingsOnly},
                                                       {"no_odometry", false, RemoveOdometry}};
  return variations;
}

const LogVariation* FindLogVariation(const std::string& name) {
  const std::vector<LogVariation>& all = LogVariations();
  const auto found = std::find_if(all.begin(), all.end(), [&](const LogVariation& variation) {
    return name == variation.name;
  });
  return found == all.end() ? nullptr : &*found;
}

Status VaryLog(const LogVariation& variation, std::uint64_t seed, const KnownLog& known,
               VariedLog* varied) {
  constexpr std::size_t kMinScans = 2;
  const auto error = [&](const std::string& problem) {
    return Status::InvalidArgument(known.name + ", variation " + variation.name + ": " + problem);
  };
  if (known.log.scans.size() < kMinScans) return error("the log has fewer than two scans");
  VariedLog result;
  result.known = known;
  NoiseSource source(seed, StreamOf(variation.name));
  variation.apply(&source, &result.known);
  if (result.known.log.scans.size() < kMinScans) return error("fewer than two scans are left");
  const std::vector<double> times_s = SortedTimes(result.known.log);
  std::vector<Relation> kept;
  for (std::size_t i = 0; i < known.relations.size(); ++i) {
    const Relation& relation = result.known.relations[i];
    if (!HasScanAt(relation.from_s, times_s) || !HasScanAt(relation.to_s, times_s)) continue;
    kept.push_back(relation);
    result.unvaried_relations.push_back(known.relations[i]);
  }
  if (kept.empty()) return error("no relation has a scan at both of its times");
  result.known.relations = std::move(kept);
  *varied = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
