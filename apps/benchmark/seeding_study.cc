#include "plumbline/apps/benchmark/seeding_study.h"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <optional>
#include <sstream>
#include <utility>

#include "plumbline/apps/benchmark/run_cases.h"
#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"
#include "plumbline/solvers/front_end/odometry_noise.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/seeding/close_all_loops.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kFaultStream = 5;  // 0 to 4 belong to simulator and buildings
constexpr double kScanPeriodS = 0.45;      // a scan every 0.18 m
constexpr int kSlipScans = 15;

// Uniform between two bounds.
double Draw(double low, double high, NoiseSource* source) {
  return low + (high - low) * source->Uniform();
}

double WithDrawnSign(double value, NoiseSource* source) {
  return source->Uniform() < 0.5 ? value : -value;
}

Fault DrawFault(FaultKind kind, NoiseSource* source) {
  Fault fault = Fault::Default(kind);
  const bool slips = kind == FaultKind::kSlip;
  if (fault.distance_m != 0.0) fault.distance_m = Draw(0.5, slips ? 3.0 : 6.0, source);
  if (fault.at_share != 0.0) {
    fault.at_share =
        kind == FaultKind::kFrozenToEnd ? Draw(0.6, 0.9, source) : Draw(0.2, 0.8, source);
  }
  if (slips) {
    fault.distance_m = WithDrawnSign(fault.distance_m, source);
    fault.time_s = kSlipScans * kScanPeriodS;
  }
  if (kind == FaultKind::kClockOffset) fault.time_s = WithDrawnSign(fault.time_s, source);
  if (kind == FaultKind::kMounting) fault.angle_rad = WithDrawnSign(fault.angle_rad, source);
  return fault;
}

SimulationOptions SimulationOf(const SeedingCase& run) {
  SimulationOptions options;
  options.scan_period_s = kScanPeriodS;
  options.seed = run.seed;
  options.odometry_noise = Scaled(options.odometry_noise, run.odometry_factor);
  if (run.scanner == StudyScanner::kPeople) {
    options.traffic = {4, true};
  } else if (run.scanner != StudyScanner::kFine) {
    options.laser.num_beams = 181;
    options.laser.first_bearing_rad = DegToRad(-90.0);
    options.laser.bearing_step_rad = DegToRad(1.0);
  }
  if (run.scanner == StudyScanner::kShort) {
    options.laser.max_range_m = 8.0;
    options.laser_noise.sigma_range_m = 0.015;
  } else if (run.scanner == StudyScanner::kThinned) {
    options.scan_period_s = 2.0;
  } else if (run.scanner == StudyScanner::kFast) {
    options.drive.speed_m_s = 1.0;
    options.drive.turn_rate_rad_s = DegToRad(80.0);
  }
  return options;
}

// By how much the heading changes over the stretch over which the robot is carried.
Status MeasureCarriedTurn(const World& world, const SimulationOptions& options, const Fault& fault,
                          double* turn_rad) {
  if (fault.kind != FaultKind::kCarried && fault.kind != FaultKind::kCarriedInGap) {
    return Status::Ok();
  }
  Drive drive;
  PLUMBLINE_RETURN_IF_ERROR(Drive::Plan(world, options.drive, &drive));
  const double from_m = fault.at_share * drive.length_m();
  *turn_rad = Between(drive.WorldFromRobot(drive.TimeAt(from_m)),
                      drive.WorldFromRobot(drive.TimeAt(from_m + fault.distance_m)))
                  .yaw;
  return Status::Ok();
}

// first_scan: as SimulateWithFault has it.
Status SimulateCase(const SeedingCase& run, SimulatedLog* log, std::size_t* first_scan,
                    double* carried_turn_rad) {
  const World world(GenerateBuilding(run.building, run.seed));
  const SimulationOptions options = SimulationOf(run);
  PLUMBLINE_RETURN_IF_ERROR(MeasureCarriedTurn(world, options, run.fault, carried_turn_rad));
  std::optional<World> second;
  if (run.fault.kind == FaultKind::kTwoBuildings) {
    second.emplace(GenerateBuilding(run.building, SecondSeed(run.seed)));
  }
  return SimulateWithFault(world, second ? &*second : nullptr, options, run.fault, log, first_scan);
}

// Moves everything after one keyframe ahead, as if matching and odometry had measured it.
void InjectJump(const SeedingCase& run, SequentialTrajectory* trajectory) {
  std::vector<Keyframe>& keys = trajectory->keyframes;
  const double path_m = run.fault.at_share * keys.back().path_m;
  auto first = std::find_if(keys.begin(), keys.end() - 1,
                            [&](const Keyframe& key) { return key.path_m > path_m; });
  const Pose2 at = trajectory->world_from_robot[first->pose];
  const Eigen::Vector2d shift = BeamEnd(run.fault.distance_m, at.yaw);
  Pose2& step = trajectory->odometry[first->pose];
  step = step * Pose2(run.fault.distance_m, 0.0, 0.0);
  for (std::size_t pose = first->pose; pose < trajectory->world_from_robot.size(); ++pose) {
    trajectory->world_from_robot[pose].x += shift.x();
    trajectory->world_from_robot[pose].y += shift.y();
  }
  for (; first != keys.end(); ++first) first->path_m += run.fault.distance_m;
}

Status SeedWithInjectedJump(const SeedingCase& run, const SeedingOptions& seeding,
                            const MotionOptions& motion, const MeasuredSurface& surface,
                            ThreadPool* pool, const SlamGraph& graph, std::vector<Pose2>* poses,
                            SeedingReport* report) {
  ScanSurfaces surfaces(graph, surface);
  SequentialTrajectory trajectory;
  PLUMBLINE_RETURN_IF_ERROR(
      SeedSequentially(seeding, motion, {}, pool, &surfaces, &trajectory, &report->sequential));
  const MotionOptions noise = EstimateOdometryNoise(trajectory, motion).motion;
  InjectJump(run, &trajectory);
  KeyframeGraph keys;
  PLUMBLINE_RETURN_IF_ERROR(
      CloseAllLoops(noise, surfaces, {}, nullptr, pool, &trajectory, &keys, report));
  *poses = std::move(trajectory.world_from_robot);
  return Status::Ok();
}

// Of the poses from `first` to before `end`, after the rigid motion that fits them best.
void AddErrors(const SimulatedLog& log, const std::vector<Pose2>& estimated, std::size_t first,
               std::size_t end, PoseErrors* errors) {
  std::vector<Pose2> truth;
  for (std::size_t i = first; i < end; ++i) truth.push_back(log.scans[i].world_from_robot);
  errors->AddFitted(truth, {estimated.begin() + first, estimated.begin() + end});
}

// first_scan: as SimulateWithFault has it.
ErrorStatistics ErrorsOf(const SimulatedLog& log, const std::vector<Pose2>& estimated,
                         FaultKind fault, std::size_t first_scan) {
  const bool is_parted = IsAlarmDue(fault);
  PoseErrors errors(StatisticsConvention::kEvo);
  AddErrors(log, estimated, 0, is_parted ? first_scan : estimated.size(), &errors);
  if (fault == FaultKind::kTwoBuildings) {
    AddErrors(log, estimated, first_scan, estimated.size(), &errors);
  }
  return errors.Statistics().translation_m;
}

// Runs of one class, counted by what became of them.
struct Tally {
  int runs = 0, right_quiet = 0, right_alarm = 0, wrong_alarm = 0, wrong_silent = 0, repaired = 0;
  int refined_wrong = 0, refined_silent = 0;
  double time_s = 0.0;

  void Add(const SeedingOutcome& outcome) {
    ++runs;
    repaired += outcome.repaired ? 1 : 0;
    time_s += outcome.time_s;
    int& count = outcome.IsRight() ? (outcome.alarm ? right_alarm : right_quiet)
                                   : (outcome.alarm ? wrong_alarm : wrong_silent);
    ++count;
    if (outcome.IsRefinedRight()) return;
    ++(outcome.refined_alarm ? refined_wrong : refined_silent);
  }
};

// Of the outcomes that `belongs` picks; none if there are none.
template <typename Predicate>
void WriteRow(const std::string& name, const std::vector<SeedingOutcome>& outcomes,
              const Predicate& belongs, std::ostream* table) {
  Tally tally;
  for (const SeedingOutcome& outcome : outcomes) {
    if (belongs(outcome.run)) tally.Add(outcome);
  }
  if (tally.runs == 0) return;
  *table << std::left << std::setw(16) << name << std::right << std::setw(5) << tally.runs
         << std::setw(14) << tally.right_quiet << std::setw(14) << tally.right_alarm
         << std::setw(14) << tally.wrong_alarm << std::setw(15) << tally.wrong_silent
         << std::setw(10) << tally.repaired << std::fixed << std::setprecision(1) << std::setw(8)
         << 100.0 * (tally.right_quiet + tally.right_alarm) / tally.runs << std::setw(11)
         << tally.time_s << std::setw(23) << tally.refined_wrong << std::setw(15)
         << tally.refined_silent << '\n';
}

}  // namespace

const char* ToString(StudyScanner scanner) {
  switch (scanner) {
    case StudyScanner::kFine:
      return "fine";
    case StudyScanner::kShort:
      return "short";
    case StudyScanner::kThinned:
      return "thinned";
    case StudyScanner::kFast:
      return "fast";
    case StudyScanner::kPeople:
      return "people";
  }
  return "unknown";
}

bool FromString(const std::string& name, StudyScanner* scanner) {
  for (const StudyScanner known :
       {StudyScanner::kFine, StudyScanner::kShort, StudyScanner::kThinned, StudyScanner::kFast,
        StudyScanner::kPeople}) {
    if (name != ToString(known)) continue;
    *scanner = known;
    return true;
  }
  return false;
}

bool IsAlarmDue(FaultKind kind) {
  return kind == FaultKind::kFrozenToEnd || kind == FaultKind::kTwoBuildings;
}

std::vector<SeedingCase> SeedingCases(int num_runs, std::uint64_t first_seed) {
  constexpr double kOdometryFactors[] = {0.5, 1.0, 2.0};
  constexpr FaultKind kNone = FaultKind::kNone;
  constexpr FaultKind kRound[] = {
      kNone, FaultKind::kCarried,  FaultKind::kInjected,     FaultKind::kCarriedInGap,
      kNone, FaultKind::kSlip,     FaultKind::kDroppedScans, FaultKind::kClockOffset,
      kNone, FaultKind::kRepeated, FaultKind::kFrozen,       FaultKind::kFrozenToEnd,
      kNone, FaultKind::kMounting, FaultKind::kTwoBuildings};
  constexpr int kRoundLength = sizeof(kRound) / sizeof(kRound[0]);
  std::vector<SeedingCase> cases;
  for (int i = 0; i < num_runs; ++i) {
    const int step = i / 2;
    SeedingCase run;
    run.building = i % 2 == 0 ? BuildingKind::kRandom : BuildingKind::kRepetitive;
    run.seed = first_seed + step;
    // A round is a multiple of three, so each round begins with another factor.
    run.odometry_factor = kOdometryFactors[(step + step / kRoundLength) % 3];
    NoiseSource source(2 * run.seed + i % 2, kFaultStream);
    run.fault = DrawFault(kRound[step % kRoundLength], &source);
    cases.push_back(run);
  }
  return cases;
}

Status RunSeedingCase(const SeedingCase& run, const SeedingOptions& seeding,
                      const FactorOptions& factors, SeedingOutcome* outcome) {
  SeedingOutcome result;
  result.run = run;
  SimulatedLog log;
  SlamGraph graph;
  std::size_t first_scan = 0;
  PLUMBLINE_RETURN_IF_ERROR(SimulateCase(run, &log, &first_scan, &result.carried_turn_rad));
  PLUMBLINE_RETURN_IF_ERROR(MakeGraph(log, &graph));

  const auto start = std::chrono::steady_clock::now();
  ThreadPool pool(1);
  MapLogOptions options;
  options.seeding = seeding;
  options.solver.factors = factors;
  options.solver.num_threads = 1;
  LogMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, std::move(graph), &pool, &mapping));
  std::vector<Pose2> poses;
  SeedingReport& report = mapping.report.seeding;
  if (run.fault.kind == FaultKind::kInjected) {
    PLUMBLINE_RETURN_IF_ERROR(SeedWithInjectedJump(run, seeding, factors.motion, mapping.surface,
                                                   &pool, mapping.graph, &poses, &report));
  } else {
    PLUMBLINE_RETURN_IF_ERROR(SeedLog(options, {}, &pool, &mapping));
    poses = PosesOf(mapping.state.poses);
  }
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;

  result.num_scans = mapping.graph.num_scans();
  result.path_length_m = log.path_length_m;
  result.alarm = report.alarm || !mapping.report.frozen_laser.empty();
  result.repaired = report.Repaired();
  result.time_s = duration.count();
  const ErrorStatistics errors = ErrorsOf(log, poses, run.fault.kind, first_scan);
  result.max_error_m = errors.max;
  result.mean_error_m = errors.mean;

  mapping.start_poses = mapping.state.poses = PoseArray(poses);
  PLUMBLINE_RETURN_IF_ERROR(RefineLog(options, &pool, &mapping));
  result.max_refined_error_m =
      ErrorsOf(log, PosesOf(mapping.state.poses), run.fault.kind, first_scan).max;
  result.refined_alarm = !mapping.report.alarms.empty();
  *outcome = result;
  return Status::Ok();
}

Status RunSeedingStudy(const std::vector<SeedingCase>& cases, const SeedingOptions& seeding,
                       const FactorOptions& factors, ThreadPool* pool,
                       std::vector<SeedingOutcome>* outcomes) {
  return RunCases(
      cases, pool,
      [&](const SeedingCase& run, SeedingOutcome* outcome) {
        return RunSeedingCase(run, seeding, factors, outcome);
      },
      outcomes);
}

std::string SeedingTable(const std::vector<SeedingOutcome>& outcomes) {
  std::ostringstream table;
  table
      << "fault            runs  right, quiet  right, alarm  wrong, alarm  wrong, SILENT  repaired"
         " right %  seeding, s  refined: wrong, alarm  wrong, SILENT\n";
  for (const FaultKind kind : kFaultKinds) {
    WriteRow(
        ToString(kind), outcomes, [kind](const SeedingCase& run) { return run.fault.kind == kind; },
        &table);
  }
  for (const BuildingKind kind : {BuildingKind::kRandom, BuildingKind::kRepetitive}) {
    WriteRow(
        std::string("all ") + ToString(kind), outcomes,
        [kind](const SeedingCase& run) { return run.building == kind; }, &table);
  }
  WriteRow(
      "all", outcomes, [](const SeedingCase&) { return true; }, &table);
  return table.str();
}

Status WriteSeedingCsv(const std::string& path, const std::vector<SeedingOutcome>& outcomes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "scanner,building,seed,odometry_factor,fault,fault_at_share,fault_distance_m,fault_time_s,"
         "fault_angle_rad,carried_turn_rad,scans,path_length_m,max_error_m,mean_error_m,right,"
         "alarm,repaired,time_s,max_refined_error_m,refined_right,refined_alarm\n";
  out << std::setprecision(6);
  for (const SeedingOutcome& outcome : outcomes) {
    const SeedingCase& run = outcome.run;
    const Fault& fault = run.fault;
    out << ToString(run.scanner) << ',' << ToString(run.building) << ',' << run.seed << ','
        << run.odometry_factor << ',' << ToString(fault.kind) << ',' << fault.at_share << ','
        << fault.distance_m << ',' << fault.time_s << ',' << fault.angle_rad << ','
        << outcome.carried_turn_rad << ',' << outcome.num_scans << ',' << outcome.path_length_m
        << ',' << outcome.max_error_m << ',' << outcome.mean_error_m << ',' << outcome.IsRight()
        << ',' << outcome.alarm << ',' << outcome.repaired << ',' << outcome.time_s << ','
        << outcome.max_refined_error_m << ',' << outcome.IsRefinedRight() << ','
        << outcome.refined_alarm << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
