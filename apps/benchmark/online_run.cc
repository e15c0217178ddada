#include "plumbline/apps/benchmark/online_run.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <limits>
#include <optional>
#include <sstream>
#include <thread>

#include "plumbline/apps/benchmark/memory_use.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/median.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/online_mapper.h"

namespace plumbline {
namespace {

using OnlineClock = std::chrono::steady_clock;

// Longest time [s] over which relative poses of the final map are compared.
constexpr double kLocalSpanS = 10.0;

// Processor time of the calling thread [s].
double ThreadTimeS() {
  timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<LaserModel> LasersOf(const SlamGraph& graph) {
  std::vector<LaserModel> lasers;
  lasers.reserve(graph.num_lasers());
  for (int laser = 0; laser < graph.num_lasers(); ++laser) lasers.push_back(graph.laser(laser));
  return lasers;
}

// Per pose, whether the odometry tells where it is.
std::vector<char> MeasuredPoses(const SlamGraph& graph) {
  std::vector<char> measured(graph.num_poses(), graph.odometry().empty() ? 0 : 1);
  for (const OdometryConstraint& step : graph.odometry()) {
    if (!step.is_measured) measured[step.to] = 0;
  }
  return measured;
}

class OnlineFeeder {
 public:
  OnlineFeeder(const MapLogOptions& options, double speed, const SlamGraph& drive, OnlineRun* run)
      : speed_(speed),
        drive_(drive),
        has_odometry_(MeasuredPoses(drive)),
        run_(run),
        mapper_(LasersOf(drive), OnlineMapperOptions{options}) {}

  Status Drive(const std::function<void(int)>& done) {
    constexpr int kScansPerReport = 1000;
    run_->start_memory_bytes = ResidentMemoryBytes();
    begin_ = OnlineClock::now();
    for (int scan = 0; scan < drive_.num_scans(); ++scan) {
      PLUMBLINE_RETURN_IF_ERROR(Add(scan));
      const bool is_last = scan + 1 == drive_.num_scans();
      if (done && ((scan + 1) % kScansPerReport == 0 || is_last)) done(scan + 1);
    }
    run_->drive_s = SecondsSince(begin_);
    const auto waiting = OnlineClock::now();
    PLUMBLINE_RETURN_IF_ERROR(mapper_.Wait());
    run_->wait_s = SecondsSince(waiting);
    return Status::Ok();
  }

  Status TakeResults() {
    OnlineMap map;
    PLUMBLINE_RETURN_IF_ERROR(mapper_.GetMap(&map));
    run_->online = Timed(map.map_from_robot);
    run_->num_remappings = map.num_remappings;
    run_->num_closures = map.num_closures;
    run_->num_alarms = static_cast<int>(map.alarms.size());
    const auto finishing = OnlineClock::now();
    LogMapping mapping;
    PLUMBLINE_RETURN_IF_ERROR(mapper_.Finish(&mapping));
    run_->finish_s = SecondsSince(finishing);
    run_->final_map = Timed(PosesOf(mapping.state.poses));
    run_->num_final_alarms = static_cast<int>(mapping.report.alarms.size());
    return Status::Ok();
  }

 private:
  double TimeOf(int scan) const { return drive_.timestamp_s(drive_.scan(scan).pose); }

  Status Add(int scan) {
    const int pose = drive_.scan(scan).pose;
    const LaserScan measured{TimeOf(scan),
                             drive_.RangesOfScan(scan, std::numeric_limits<double>::infinity())};
    std::optional<Pose2> odometry;
    if (has_odometry_[pose] != 0) odometry = drive_.InitialPose(pose);
    run_->recorded_s = TimeOf(scan) - TimeOf(0);
    if (speed_ > 0.0) {
      std::this_thread::sleep_until(begin_ +
                                    std::chrono::duration_cast<OnlineClock::duration>(
                                        std::chrono::duration<double>(run_->recorded_s / speed_)));
    }
    const auto start = OnlineClock::now();
    const double start_cpu_s = ThreadTimeS();
    arrivals_.push_back(start);
    OnlinePose now;
    const int laser = drive_.scan(scan).laser;
    Status status = mapper_.AddScan(measured, odometry, &now, laser);
    if (!status.ok() && odometry) {
      ++run_->num_jumps;
      status = mapper_.AddScan(measured, std::nullopt, &now, laser);
    }
    PLUMBLINE_RETURN_IF_ERROR(status);
    const double cpu_s = ThreadTimeS() - start_cpu_s;
    const double lag_s =
        now.num_pending > 0 ? SecondsSince(arrivals_[arrivals_.size() - now.num_pending]) : 0.0;
    run_->scans.push_back(
        {SecondsSince(start), cpu_s, lag_s, now.num_pending, ResidentMemoryBytes()});
    run_->live.push_back({measured.timestamp_s, now.map_from_robot});
    return Status::Ok();
  }

  std::vector<TimedPose> Timed(const std::vector<Pose2>& poses) const {
    std::vector<TimedPose> timed;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      timed.push_back({TimeOf(static_cast<int>(i)), poses[i]});
    }
    return timed;
  }

  const double speed_;
  const SlamGraph& drive_;
  const std::vector<char> has_odometry_;
  OnlineRun* run_;
  OnlineMapper mapper_;
  OnlineClock::time_point begin_;
  std::vector<OnlineClock::time_point> arrivals_;
};

std::vector<Pose2> Untimed(const std::vector<TimedPose>& timed) {
  std::vector<Pose2> poses;
  poses.reserve(timed.size());
  for (const TimedPose& pose : timed) poses.push_back(pose.world_from_robot);
  return poses;
}

// From each pose to the last one within kLocalSpanS.
std::vector<Relation> LocalRelations(const std::vector<TimedPose>& poses) {
  std::vector<Relation> relations;
  std::size_t to = 0;
  for (const TimedPose& from : poses) {
    while (to + 1 < poses.size() && poses[to + 1].timestamp_s <= from.timestamp_s + kLocalSpanS) {
      ++to;
    }
    if (poses[to].timestamp_s <= from.timestamp_s) continue;
    relations.push_back({from.timestamp_s, poses[to].timestamp_s,
                         Between(from.world_from_robot, poses[to].world_from_robot)});
  }
  return relations;
}

void WriteRelations(const std::string& name, const std::vector<TimedPose>& poses,
                    const std::vector<Relation>& relations, std::ostream* table) {
  const RelationsMetric metric = MeasureRelations(relations, poses, RelationsOptions());
  *table << "  " << std::left << std::setw(28) << name << std::right << std::setw(10)
         << metric.local.translation_m.mean << std::setw(10) << metric.local.translation_m.median
         << std::setw(10) << metric.all.translation_m.mean << '\n';
}

void WriteQuantiles(const std::string& name, const std::vector<double>& values,
                    std::ostream* table) {
  *table << "  " << std::left << std::setw(28) << name << std::right << std::setw(10)
         << Median(values) << std::setw(10) << Quantile(values, 0.99) << std::setw(10)
         << *std::max_element(values.begin(), values.end()) << '\n';
}

}  // namespace

Status RunOnline(const MapLogOptions& options, double speed, const SlamGraph& drive,
                 const std::function<void(int num_scans)>& done, OnlineRun* run) {
  OnlineRun result;
  OnlineFeeder feeder(options, speed, drive, &result);
  PLUMBLINE_RETURN_IF_ERROR(feeder.Drive(done));
  PLUMBLINE_RETURN_IF_ERROR(feeder.TakeResults());
  *run = std::move(result);
  return Status::Ok();
}

std::string OnlineTable(const OnlineRun& run, const std::vector<Relation>& relations) {
  constexpr double kBytesPerMB = 1e6;
  std::ostringstream table;
  table << std::fixed << std::setprecision(1) << run.scans.size() << " scans of " << run.recorded_s
        << " s in " << run.drive_s << " s; " << run.num_jumps
        << " without their odometry, which jumped\n";
  const std::vector<Relation> truth = relations.empty() ? LocalRelations(run.final_map) : relations;
  table << std::setprecision(4)
        << (relations.empty() ? "Relative poses of the final map" : "Relations")
        << ", error [m]\n                             <= 10 s: mean    median  all: mean\n";
  WriteRelations("live, each when it was given", run.live, truth, &table);
  WriteRelations("map at the end of the drive", run.online, truth, &table);
  WriteRelations("final map", run.final_map, truth, &table);
  const PoseDifferences off = ComparePoses(Untimed(run.online), Untimed(run.final_map));
  table << "Poses at the end of the drive, off the final map: " << off.mean_m << " m in the mean, "
        << off.max_m << " m at most\n";
  std::vector<double> add_ms, cpu_ms, lag_s;
  std::size_t peak_bytes = 0;
  for (const OnlineScanRecord& scan : run.scans) {
    add_ms.push_back(1e3 * scan.add_s);
    cpu_ms.push_back(1e3 * scan.cpu_s);
    lag_s.push_back(scan.lag_s);
    peak_bytes = std::max(peak_bytes, scan.memory_bytes);
  }
  table << std::setprecision(3) << "                                  median       p99     worst\n";
  WriteQuantiles("time per scan [ms]", add_ms, &table);
  WriteQuantiles("its processor time [ms]", cpu_ms, &table);
  WriteQuantiles("lag of the background [s]", lag_s, &table);
  table << std::setprecision(1) << "At the end: " << run.wait_s
        << " s until the background had caught up, " << run.finish_s << " s for the final map\n"
        << "Memory: " << static_cast<double>(run.start_memory_bytes) / kBytesPerMB
        << " MB with the log, " << static_cast<double>(peak_bytes) / kBytesPerMB
        << " MB at most while driving\n"
        << run.num_closures << " closures, " << run.num_remappings
        << " maps of the drive so far in the background, " << run.num_alarms << " alarms online, "
        << run.num_final_alarms << " of the final map\n";
  return table.str();
}

Status WriteOnlineCsv(const std::string& path, const OnlineRun& run) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "time_s,x_m,y_m,yaw_rad,add_s,cpu_s,lag_s,pending,memory_bytes\n" << std::setprecision(17);
  for (std::size_t i = 0; i < run.scans.size(); ++i) {
    const OnlineScanRecord& scan = run.scans[i];
    const Pose2& pose = run.live[i].world_from_robot;
    out << run.live[i].timestamp_s << ',' << pose.x << ',' << pose.y << ',' << pose.yaw << ','
        << scan.add_s << ',' << scan.cpu_s << ',' << scan.lag_s << ',' << scan.num_pending << ','
        << scan.memory_bytes << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
