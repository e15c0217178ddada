#include "plumbline/apps/benchmark/online_day.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <utility>

#include "plumbline/apps/benchmark/memory_use.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/median.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/online_mapper.h"

namespace plumbline {
namespace {

using DayClock = std::chrono::steady_clock;

constexpr double kDayPeriodS = 0.1;
constexpr double kDayStepM = 0.1;
constexpr int kMaxPending = 10;

Status SimulateWay(SimulatedLog* way) {
  SimulationOptions options;
  options.scan_period_s = kDayPeriodS;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  options.laser_noise.sigma_range_m = 0.0;  // comes with each scan of the day
  return Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, way);
}

// The map of the way, with fixed poses.
Status MapWay(const MapLogOptions& mapping, const SimulatedLog& way, SavedMap* map) {
  SlamGraph graph;
  PLUMBLINE_RETURN_IF_ERROR(MakeGraph(way, &graph));
  LogMapping mapped;
  PLUMBLINE_RETURN_IF_ERROR(MapLog(mapping, std::move(graph), {}, &mapped));
  const std::vector<Pose2> poses = PosesOf(mapped.state.poses);
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    const int id =
        map->graph.AddPose(poses[pose], mapped.graph.timestamp_s(static_cast<int>(pose)));
    map->graph.FixPose(id);
  }
  for (int scan = 0; scan < mapped.graph.num_scans(); ++scan) {
    map->graph.AddScanOf(mapped.graph, scan, mapped.graph.scan(scan).pose);
  }
  for (const OdometryConstraint& step : mapped.graph.odometry()) map->graph.AddOdometry(step);
  map->map_from_robot = poses.front();
  return map->graph.status();
}

// Which scan of the way comes next: there, stand, back, stand.
class DayPlan {
 public:
  explicit DayPlan(int num_scans) : num_scans_(num_scans) {}

  int ScanAt(int step) const {
    const int part = step / num_scans_ % 4, within = step % num_scans_;
    if (part == 0) return within;
    if (part == 1) return num_scans_ - 1;
    return part == 2 ? num_scans_ - 1 - within : 0;
  }
  bool Stands(int step) const { return step / num_scans_ % 2 == 1; }
  bool BeginsStand(int step) const {
    constexpr int kSettling = 10;
    return Stands(step) && step % num_scans_ == kSettling;
  }
  bool EndsStand(int step) const { return Stands(step) && step % num_scans_ == num_scans_ - 1; }

 private:
  const int num_scans_;
};

class DayFeeder {
 public:
  DayFeeder(const SimulatedLog& way, OnlineMapper* mapper, OnlineDay* day)
      : way_(way), plan_(static_cast<int>(way.scans.size())), mapper_(*mapper), day_(*day) {}

  Status Feed(int num_scans, const std::function<void(int)>& done) {
    constexpr int kScansPerReport = 10000;
    const auto begin = DayClock::now();
    for (int step = 0; step < num_scans; ++step) {
      PLUMBLINE_RETURN_IF_ERROR(Add(step));
      if (done && (step + 1) % kScansPerReport == 0) done(step + 1);
    }
    PLUMBLINE_RETURN_IF_ERROR(mapper_.Wait());
    day_.num_scans = num_scans;
    day_.recorded_s = kDayPeriodS * num_scans;
    day_.wall_s = SecondsSince(begin);
    day_.end_memory_bytes = ResidentMemoryBytes();
    return Status::Ok();
  }

 private:
  Status Add(int step) {
    const SimulatedScan& scan = way_.scans[plan_.ScanAt(step)];
    if (last_ != nullptr) {
      odometry_ = odometry_ * Between(last_->odom_from_robot, scan.odom_from_robot);
    }
    last_ = &scan;
    const auto start = DayClock::now();
    OnlinePose now;
    PLUMBLINE_RETURN_IF_ERROR(mapper_.AddScan(Noisy(scan.scan, step), odometry_, &now));
    day_.add_ms.push_back(1e3 * SecondsSince(start));
    Record(step, scan, now);
    arrivals_.push_back(start);
    const int num_pending = std::min<int>(now.num_pending, static_cast<int>(arrivals_.size()));
    day_.lag_s.push_back(num_pending > 0 ? SecondsSince(arrivals_[arrivals_.size() - num_pending])
                                         : 0.0);
    if (now.num_pending > kMaxPending) return mapper_.Wait();
    return Status::Ok();
  }

  LaserScan Noisy(LaserScan scan, int step) {
    constexpr double kSigmaM = 0.012;
    for (double& range : scan.ranges) {
      if (range < way_.laser.max_range_m) range += kSigmaM * noise_.Gaussian();
    }
    scan.timestamp_s = kDayPeriodS * step;
    return scan;
  }

  void Record(int step, const SimulatedScan& scan, const OnlinePose& now) {
    const Pose2 truth = Between(way_.scans[0].world_from_robot, scan.world_from_robot);
    const Eigen::Vector2d position = now.map_from_robot.translation();
    if (now.is_in_map) day_.error_m.push_back((position - truth.translation()).norm());
    if (plan_.BeginsStand(step)) stand_ = position;
    if (plan_.EndsStand(step)) day_.drift_m.push_back((position - stand_).norm());
    day_.peak_memory_bytes = std::max(day_.peak_memory_bytes, ResidentMemoryBytes());
  }

  const SimulatedLog& way_;
  const DayPlan plan_;
  OnlineMapper& mapper_;
  OnlineDay& day_;
  NoiseSource noise_{1, 0};
  const SimulatedScan* last_ = nullptr;
  Pose2 odometry_;
  Eigen::Vector2d stand_ = Eigen::Vector2d::Zero();
  std::vector<DayClock::time_point> arrivals_;
};

void WriteDayRow(const std::string& name, const std::vector<double>& values, std::ostream* table) {
  if (values.empty()) return;
  *table << "  " << std::left << std::setw(34) << name << std::right << std::setw(10)
         << Median(values) << std::setw(10) << Quantile(values, 0.99) << std::setw(10)
         << *std::max_element(values.begin(), values.end()) << '\n';
}

}  // namespace

Status RunOnlineDay(const MapLogOptions& mapping, const OnlineDayOptions& options,
                    const std::function<void(int num_scans)>& done, OnlineDay* day) {
  SimulatedLog way;
  PLUMBLINE_RETURN_IF_ERROR(SimulateWay(&way));
  OnlineMapperOptions online{mapping};
  std::optional<OnlineMapper> mapper;
  if (options.is_localised) {
    SavedMap map;
    PLUMBLINE_RETURN_IF_ERROR(MapWay(mapping, way, &map));
    online.keeps_scans = false;
    mapper.emplace(std::vector<LaserModel>{way.laser}, online, std::move(map));
  } else {
    online.min_step_m = kDayStepM;
    mapper.emplace(std::vector<LaserModel>{way.laser}, online);
  }
  OnlineDay result;
  result.start_memory_bytes = ResidentMemoryBytes();
  constexpr double kSecondsPerHour = 3600.0;
  const int num_scans = static_cast<int>(options.hours * kSecondsPerHour / kDayPeriodS);
  PLUMBLINE_RETURN_IF_ERROR(DayFeeder(way, &*mapper, &result).Feed(num_scans, done));
  OnlineMap map;
  PLUMBLINE_RETURN_IF_ERROR(mapper->GetMap(&map));
  result.num_closures = map.num_closures;
  result.num_remappings = map.num_remappings;
  *day = std::move(result);
  return Status::Ok();
}

std::string OnlineDayTable(const OnlineDay& day) {
  constexpr double kBytesPerMB = 1e6;
  const auto megabytes = [](std::size_t bytes) { return static_cast<double>(bytes) / kBytesPerMB; };
  std::ostringstream table;
  table << std::fixed << std::setprecision(1) << day.num_scans << " scans of " << day.recorded_s
        << " s in " << day.wall_s << " s; " << day.error_m.size() << " in the map\n"
        << std::setprecision(4)
        << "                                        median       p99     worst\n";
  WriteDayRow("error of the live pose [m]", day.error_m, &table);
  WriteDayRow("drift over a stand [m]", day.drift_m, &table);
  WriteDayRow("time per scan [ms]", day.add_ms, &table);
  WriteDayRow("lag of the background [s]", day.lag_s, &table);
  table << std::setprecision(1) << "Memory: " << megabytes(day.start_memory_bytes) << " MB before, "
        << megabytes(day.peak_memory_bytes) << " MB at most, " << megabytes(day.end_memory_bytes)
        << " MB at the end\n"
        << day.num_closures << " closures, " << day.num_remappings
        << " maps of the drive so far in the background\n";
  return table.str();
}

}  // namespace plumbline
