#include "plumbline/apps/benchmark/sessions_study.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include "plumbline/apps/benchmark/run_cases.h"
#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/report/units.h"
#include "plumbline/apps/simulation/floor.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/map_sessions.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

constexpr double kVisitScanPeriodS = 0.45;      // a scan every 0.18 m
constexpr std::uint64_t kOtherBuilding = 1000;  // added to the seed

struct Drives {
  std::vector<std::vector<Pose2>> truth;  // per session and scan
  std::vector<SlamGraph> graphs;
};

Status AddDrive(BuildingKind kind, std::uint64_t seed, std::uint64_t visit, Drives* drives) {
  SimulationOptions options;
  options.scan_period_s = kVisitScanPeriodS;
  options.seed = SeedOfVisit(seed, visit);
  SimulatedLog log;
  PLUMBLINE_RETURN_IF_ERROR(Simulate(World(GenerateVisit(kind, seed, visit)), options, &log));
  drives->graphs.emplace_back();
  PLUMBLINE_RETURN_IF_ERROR(MakeGraph(log, &drives->graphs.back()));
  drives->truth.emplace_back();
  for (const SimulatedScan& scan : log.scans) {
    drives->truth.back().push_back(scan.world_from_robot);
  }
  return Status::Ok();
}

// The visits, and then the drive through the other building.
Status SimulateCase(const SessionsCase& run, Drives* drives) {
  for (int visit = 0; visit < run.num_visits; ++visit) {
    PLUMBLINE_RETURN_IF_ERROR(AddDrive(run.building, run.seed, visit, drives));
  }
  return AddDrive(run.building, run.seed + kOtherBuilding, 0, drives);
}

std::vector<Pose2> TruthOf(const SessionMap& map, const Drives& drives) {
  std::vector<Pose2> truth;
  for (const SessionOfMap& session : map.sessions) {
    const std::vector<Pose2>& of_session = drives.truth[session.session];
    truth.insert(truth.end(), of_session.begin(), of_session.end());
  }
  return truth;
}

ErrorStatistics ErrorsOf(const std::vector<Pose2>& truth, const std::vector<double>& poses) {
  PoseErrors errors(StatisticsConvention::kEvo);
  errors.AddFitted(truth, PosesOf(poses));
  return errors.Statistics().translation_m;
}

// What the joint estimation makes of the map from a start within a centimetre of the truth: of the
// truth itself nothing would be better.
Status MeasureFloor(const MapLogOptions& options, const SessionMap& map,
                    const std::vector<Pose2>& truth, double* floor_m) {
  MapState state;
  state.poses = PoseArray(truth);
  for (int i = 0; i < state.num_poses(); ++i) {
    const Pose2 off(0.01 * std::sin(2.1 * i), 0.01 * std::sin(1.3 * i), 0.003 * std::sin(3.3 * i));
    state.SetPose(i, truth[i] * off);
  }
  const SolverSummary summary =
      RefineState(RefinementOptions(options, map.mapping), map.mapping.graph, &state);
  if (!summary.IsSolutionUsable()) return Status::InvalidArgument(summary.message);
  *floor_m = ErrorsOf(truth, state.poses).mean;
  return Status::Ok();
}

// Runs of one class, counted by what became of them.
struct SessionsTally {
  int runs = 0, complete = 0, right = 0, wrong_alarm = 0, wrong_silent = 0, alarm = 0;
  double error_m = 0.0, floor_m = 0.0, time_s = 0.0;

  void Add(const SessionsOutcome& outcome) {
    ++runs;
    complete += outcome.IsComplete() ? 1 : 0;
    right += outcome.IsRight() ? 1 : 0;
    alarm += outcome.IsRight() && outcome.has_alarm ? 1 : 0;
    if (!outcome.IsRight()) ++(outcome.has_alarm ? wrong_alarm : wrong_silent);
    error_m += outcome.mean_error_m;
    floor_m += outcome.floor_m;
    time_s += outcome.time_s;
  }
};

// Of the outcomes that `belongs` picks; none if there are none.
template <typename Predicate>
void WriteSessionsRow(const std::string& name, const std::vector<SessionsOutcome>& outcomes,
                      const Predicate& belongs, std::ostream* table) {
  SessionsTally tally;
  for (const SessionsOutcome& outcome : outcomes) {
    if (belongs(outcome.run)) tally.Add(outcome);
  }
  if (tally.runs == 0) return;
  *table << std::left << std::setw(16) << name << std::right << std::setw(5) << tally.runs
         << std::setw(10) << tally.complete << std::setw(7) << tally.right << std::setw(14)
         << tally.alarm << std::setw(14) << tally.wrong_alarm << std::setw(15) << tally.wrong_silent
         << std::fixed << std::setprecision(1) << std::setw(16)
         << kMmPerM * tally.error_m / tally.runs << std::setw(17)
         << kMmPerM * tally.floor_m / tally.runs << std::setw(10) << tally.time_s << '\n';
}

}  // namespace

std::vector<SessionsCase> SessionsCases(int num_runs, std::uint64_t first_seed) {
  std::vector<SessionsCase> cases(num_runs);
  for (int i = 0; i < num_runs; ++i) {
    cases[i].building = i % 6 == 5 ? BuildingKind::kRepetitive : BuildingKind::kRandom;
    cases[i].seed = first_seed + i;
  }
  return cases;
}

Status RunSessionsCase(const SessionsCase& run, const MapLogOptions& options,
                       SessionsOutcome* outcome) {
  Drives drives;
  PLUMBLINE_RETURN_IF_ERROR(SimulateCase(run, &drives));
  MapLogOptions mapping_options = options;
  mapping_options.solver.num_threads = 1;
  const auto start = std::chrono::steady_clock::now();
  SessionsMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(MapSessions(mapping_options, std::move(drives.graphs), {}, &mapping));
  SessionsOutcome result;
  result.run = run;
  result.time_s = SecondsSince(start);
  const SessionMap* largest = nullptr;
  for (const SessionMap& map : mapping.maps) {
    result.num_scans += map.mapping.graph.num_scans();
    result.has_alarm = result.has_alarm || !map.mapping.report.alarms.empty();
    // The drive through the other building is the last session.
    const bool has_other = map.sessions.back().session == run.num_visits;
    const int num_visits = static_cast<int>(map.sessions.size()) - (has_other ? 1 : 0);
    if (has_other) result.num_wrong_ties += num_visits;
    if (num_visits > result.num_tied) {
      result.num_tied = num_visits;
      largest = &map;
    }
    if (has_other && num_visits > 0) continue;  // there is no truth to compare it with
    const double max_m = ErrorsOf(TruthOf(map, drives), map.mapping.state.poses).max;
    result.max_error_m = std::max(result.max_error_m, max_m);
  }
  const std::vector<Pose2> truth = TruthOf(*largest, drives);
  result.mean_error_m = ErrorsOf(truth, largest->mapping.state.poses).mean;
  PLUMBLINE_RETURN_IF_ERROR(MeasureFloor(mapping_options, *largest, truth, &result.floor_m));
  *outcome = result;
  return Status::Ok();
}

Status RunSessionsStudy(const std::vector<SessionsCase>& cases, const MapLogOptions& options,
                        ThreadPool* pool, std::vector<SessionsOutcome>* outcomes) {
  return RunCases(
      cases, pool,
      [&](const SessionsCase& run, SessionsOutcome* outcome) {
        return RunSessionsCase(run, options, outcome);
      },
      outcomes);
}

std::string SessionsTable(const std::vector<SessionsOutcome>& outcomes) {
  std::ostringstream table;
  table << "building         runs  all tied  right  right, alarm  wrong, alarm  wrong, SILENT  "
           "mean error, mm  from truth, mm   time, s\n";
  for (const BuildingKind kind : {BuildingKind::kRandom, BuildingKind::kRepetitive}) {
    WriteSessionsRow(
        ToString(kind), outcomes, [kind](const SessionsCase& run) { return run.building == kind; },
        &table);
  }
  WriteSessionsRow(
      "all", outcomes, [](const SessionsCase&) { return true; }, &table);
  return table.str();
}

Status WriteSessionsCsv(const std::string& path, const std::vector<SessionsOutcome>& outcomes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "building,seed,visits,scans,tied,wrong_ties,alarm,max_error_m,mean_error_m,floor_m,right,"
         "time_s\n";
  out << std::setprecision(6);
  for (const SessionsOutcome& outcome : outcomes) {
    const SessionsCase& run = outcome.run;
    out << ToString(run.building) << ',' << run.seed << ',' << run.num_visits << ','
        << outcome.num_scans << ',' << outcome.num_tied << ',' << outcome.num_wrong_ties << ','
        << outcome.has_alarm << ',' << outcome.max_error_m << ',' << outcome.mean_error_m << ','
        << outcome.floor_m << ',' << outcome.IsRight() << ',' << outcome.time_s << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
