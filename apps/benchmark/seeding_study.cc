#include "plumbline/apps/benchmark/seeding_study.h"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <sstream>
#include <utility>

#include "plumbline/apps/evaluation/alignment.h"
#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/graph_poses.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/solvers/seeding/surface_points.h"
#include "plumbline/solvers/solve.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kJumpStream = 5;  // 0 to 4 belong to simulator and buildings

SimulationOptions SimulationOf(const SeedingCase& run) {
  SimulationOptions options;
  options.scan_period_s = 0.45;  // a scan every 0.18 m
  options.seed = run.seed;
  options.odometry_noise = Scaled(options.odometry_noise, run.odometry_factor);
  return options;
}

Status SimulateCase(const SeedingCase& run, SimulatedLog* log, double* carried_turn_rad) {
  const World world(GenerateBuilding(run.building, run.seed));
  SimulationOptions options = SimulationOf(run);
  if (run.jump == Jump::kCarried) {
    Drive drive;
    PLUMBLINE_RETURN_IF_ERROR(Drive::Plan(world, options.drive, &drive));
    const double from_m = run.jump_share * drive.length_m();
    options.carry = {from_m, run.jump_m};
    *carried_turn_rad = Between(drive.WorldFromRobot(drive.TimeAt(from_m)),
                                drive.WorldFromRobot(drive.TimeAt(from_m + run.jump_m)))
                            .yaw;
  }
  return Simulate(world, options, log);
}

// Moves everything after one key scan ahead, as if matching and odometry had measured it.
void InjectJump(const SeedingCase& run, SequentialTrajectory* trajectory) {
  std::vector<KeyScan>& keys = trajectory->key_scans;
  const double path_m = run.jump_share * keys.back().path_m;
  auto first = std::find_if(keys.begin(), keys.end() - 1,
                            [&](const KeyScan& key) { return key.path_m > path_m; });
  const Pose2 at = trajectory->world_from_robot[first->pose];
  const Eigen::Vector2d shift = BeamEnd(run.jump_m, at.yaw);
  Pose2& step = trajectory->odometry[first->pose];
  step = step * Pose2(run.jump_m, 0.0, 0.0);
  for (std::size_t pose = first->pose; pose < trajectory->world_from_robot.size(); ++pose) {
    trajectory->world_from_robot[pose].x += shift.x();
    trajectory->world_from_robot[pose].y += shift.y();
  }
  for (; first != keys.end(); ++first) first->path_m += run.jump_m;
}

Status SeedWithInjectedJump(const SeedingCase& run, const SeedingOptions& seeding,
                            const MotionOptions& motion,
                            const std::vector<Eigen::Vector2f>& normals, ThreadPool* pool,
                            SlamGraph* graph, SeedingReport* report) {
  const std::vector<SurfacePoints> surfaces =
      ThinnedSurfacePoints(*graph, normals, seeding.point_spacing_m, pool);
  SequentialTrajectory trajectory;
  PLUMBLINE_RETURN_IF_ERROR(SeedSequentially(seeding.sequential, motion, *graph, surfaces, {}, pool,
                                             &trajectory, &report->sequential));
  const MotionOptions noise = EstimateOdometryNoise(trajectory, motion).motion;
  InjectJump(run, &trajectory);
  PLUMBLINE_RETURN_IF_ERROR(
      CloseAllLoops(seeding, noise, *graph, surfaces, {}, pool, &trajectory, report));
  for (int pose = 0; pose < graph->num_poses(); ++pose) {
    graph->SetPose(pose, trajectory.world_from_robot[pose]);
  }
  return Status::Ok();
}

void MeasureErrors(const SimulatedLog& log, const SlamGraph& graph, SeedingOutcome* outcome) {
  const std::vector<Pose2> estimated = PosesOf(graph);
  std::vector<Pose2> truth;
  truth.reserve(estimated.size());
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    truth.push_back(log.scans[pose].world_from_robot);
  }
  const Pose2 truth_from_world = AlignTrajectories(estimated, truth);
  PoseErrors errors(StatisticsConvention::kEvo);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    errors.Add(truth[i], truth_from_world * estimated[i]);
  }
  const ErrorStatistics translation = errors.Statistics().translation_m;
  outcome->max_error_m = translation.max;
  outcome->mean_error_m = translation.mean;
}

// Runs of one class, counted by what became of them.
struct Tally {
  int runs = 0, right_quiet = 0, right_alarm = 0, wrong_alarm = 0, wrong_silent = 0, repaired = 0;

  void Add(const SeedingOutcome& outcome) {
    ++runs;
    repaired += outcome.repaired ? 1 : 0;
    int& count = outcome.IsRight() ? (outcome.alarm ? right_alarm : right_quiet)
                                   : (outcome.alarm ? wrong_alarm : wrong_silent);
    ++count;
  }
};

void WriteRow(const std::string& name, const Tally& tally, std::ostream* table) {
  *table << std::left << std::setw(24) << name << std::right << std::setw(6) << tally.runs
         << std::setw(13) << tally.right_quiet << std::setw(13) << tally.right_alarm
         << std::setw(13) << tally.wrong_alarm << std::setw(14) << tally.wrong_silent
         << std::setw(10) << tally.repaired << std::fixed << std::setprecision(1) << std::setw(11)
         << 100.0 * (tally.right_quiet + tally.right_alarm) / std::max(1, tally.runs) << " %\n";
}

}  // namespace

const char* ToString(Jump jump) {
  switch (jump) {
    case Jump::kNone:
      return "none";
    case Jump::kCarried:
      return "carried";
    case Jump::kInjected:
      return "injected";
  }
  return "?";
}

std::vector<SeedingCase> SeedingCases(int num_runs) {
  constexpr double kOdometryFactors[] = {0.5, 1.0, 2.0};
  std::vector<SeedingCase> cases;
  for (int i = 0; i < num_runs; ++i) {
    SeedingCase run;
    run.building = i % 2 == 0 ? BuildingKind::kRandom : BuildingKind::kRepetitive;
    run.seed = i / 2 + 1;
    run.odometry_factor = kOdometryFactors[i / 8 % 3];
    if (i / 2 % 2 == 1) {
      NoiseSource source(i, kJumpStream);
      run.jump = i / 4 % 2 == 0 ? Jump::kCarried : Jump::kInjected;
      run.jump_m = 0.5 + 5.5 * source.Uniform();
      run.jump_share = 0.2 + 0.6 * source.Uniform();
    }
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
  PLUMBLINE_RETURN_IF_ERROR(SimulateCase(run, &log, &result.carried_turn_rad));
  PLUMBLINE_RETURN_IF_ERROR(MakeGraph(log, &graph));

  const auto start = std::chrono::steady_clock::now();
  ThreadPool pool(1);
  const std::vector<Eigen::Vector2f> normals =
      EstimateReturnNormals(graph, NormalOptionsFor(factors.beam), &pool);
  SeedingReport report;
  PLUMBLINE_RETURN_IF_ERROR(
      run.jump == Jump::kInjected
          ? SeedWithInjectedJump(run, seeding, factors.motion, normals, &pool, &graph, &report)
          : SeedGraph(seeding, factors.motion, normals, {}, &pool, &graph, &report));
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;

  result.num_scans = graph.num_scans();
  result.path_length_m = log.path_length_m;
  result.alarm = report.alarm;
  result.repaired = report.Repaired();
  result.time_s = duration.count();
  MeasureErrors(log, graph, &result);
  *outcome = result;
  return Status::Ok();
}

Status RunSeedingStudy(const std::vector<SeedingCase>& cases, const SeedingOptions& seeding,
                       const FactorOptions& factors, ThreadPool* pool,
                       std::vector<SeedingOutcome>* outcomes) {
  std::vector<SeedingOutcome> results(cases.size());
  std::vector<Status> statuses(cases.size());
  pool->ForEachChunk(cases.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    statuses[i] = RunSeedingCase(cases[i], seeding, factors, &results[i]);
  });
  for (const Status& status : statuses) PLUMBLINE_RETURN_IF_ERROR(status);
  *outcomes = std::move(results);
  return Status::Ok();
}

std::string SeedingTable(const std::vector<SeedingOutcome>& outcomes) {
  std::ostringstream table;
  table << "buildings   jump          runs  right, quiet  false alarm  wrong, alarm  wrong, SILENT"
           "  repaired  consistent\n";
  Tally all;
  for (const BuildingKind building : {BuildingKind::kRandom, BuildingKind::kRepetitive}) {
    for (const Jump jump : {Jump::kNone, Jump::kCarried, Jump::kInjected}) {
      Tally tally;
      for (const SeedingOutcome& outcome : outcomes) {
        if (outcome.run.building != building || outcome.run.jump != jump) continue;
        tally.Add(outcome);
        all.Add(outcome);
      }
      std::string name = ToString(building);
      name.resize(12, ' ');
      WriteRow(name + ToString(jump), tally, &table);
    }
  }
  WriteRow("all", all, &table);
  return table.str();
}

Status WriteSeedingCsv(const std::string& path, const std::vector<SeedingOutcome>& outcomes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "building,seed,odometry_factor,jump,jump_m,jump_share,carried_turn_rad,scans,path_length_"
         "m,max_error_m,"
         "mean_error_m,alarm,repaired,time_s\n";
  out << std::setprecision(6);
  for (const SeedingOutcome& outcome : outcomes) {
    const SeedingCase& run = outcome.run;
    out << ToString(run.building) << ',' << run.seed << ',' << run.odometry_factor << ','
        << ToString(run.jump) << ',' << run.jump_m << ',' << run.jump_share << ','
        << outcome.carried_turn_rad << ',' << outcome.num_scans << ',' << outcome.path_length_m
        << ',' << outcome.max_error_m << ',' << outcome.mean_error_m << ',' << outcome.alarm << ','
        << outcome.repaired << ',' << outcome.time_s << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
