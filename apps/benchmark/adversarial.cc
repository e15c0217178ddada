#include "plumbline/apps/benchmark/adversarial.h"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <utility>

#include "plumbline/apps/benchmark/adversarial_problem.h"
#include "plumbline/apps/benchmark/map_errors.h"
#include "plumbline/apps/benchmark/run_cases.h"
#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/map_quality.h"
#include "plumbline/core/map_state.h"
#include "plumbline/solvers/acceptance/mirrored_scans.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

struct AttackLevels {
  Attack attack;
  std::vector<double> levels;
  bool in_a_log;  // whether it can be done to a log
};

const std::vector<AttackLevels>& AllAttacks() {
  static const std::vector<AttackLevels> attacks = {
      {Attack::kNone, {0.0}, true},
      {Attack::kTruth, {0.0}, false},
      {Attack::kDrift, {3.0, 10.0}, false},
      {Attack::kWrongClosures, {0.01, 0.03, 0.1}, false},
      {Attack::kGrossClosures, {0.0, 0.03, 0.1, 0.3}, false},
      {Attack::kBiasedClosures, {0.03, 0.1, 0.3}, false},
      {Attack::kJump, {0.3, 1.0, 3.0}, true},
      {Attack::kShuffled, {0.1, 1.0}, false},
      {Attack::kMirrored, {0.1, 1.0}, true},
      {Attack::kPeople, {0.1, 0.3}, true},
      {Attack::kMissingOdometry, {0.5, 1.0}, false},
      {Attack::kNoise, {0.2, 5.0}, true},
      {Attack::kRepeatedScan, {0.01, 0.1}, true}};
  return attacks;
}

MapFigures Measure(const SlamGraph& graph, const std::vector<double>& pose_array,
                   const std::vector<Pose2>& truth, ThreadPool* pool) {
  PoseErrors errors(StatisticsConvention::kEvo);
  errors.AddFitted(truth, PosesOf(pose_array));
  const PoseErrorStatistics statistics = errors.Statistics();
  const MapQuality quality =
      MeasureMapQuality(graph.MeasuredMap(pose_array), MapQualityOptions(), pool);
  return {statistics.translation_m.mean, DegToRad(statistics.rotation_deg.mean),
          quality.wall_thickness_m, quality.mean_map_entropy};
}

// What noise leaves of the same drive without any attack.
Status MeasureFloor(std::uint64_t seed, const SolverOptions& solver, ThreadPool* pool,
                    double* floor_m) {
  AdversarialProblem problem;
  PLUMBLINE_RETURN_IF_ERROR(MakeAdversarialProblem({Attack::kNone, 0.0, seed}, &problem));
  MapState state = problem.graph.InitialState();
  const SolverSummary summary = RefineState(solver, problem.graph, &state);
  if (!summary.IsSolutionUsable()) return Status::InvalidArgument(summary.message);
  *floor_m = Measure(problem.graph, state.poses, problem.truth, pool).pose_error_m;
  return Status::Ok();
}

// To refuse mirrored scans is to give the start back.
bool IsDueRefusal(const SlamGraph& graph, const std::vector<double>& poses) {
  return VoteOnTurns(graph, poses).SayMirrored();
}

Status MapProblem(const AdversarialProblem& problem, const SolverOptions& solver, ThreadPool* pool,
                  AdversarialOutcome* outcome) {
  MapLogOptions options;
  options.solver = solver;
  LogMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, problem.graph, pool, &mapping));
  PLUMBLINE_RETURN_IF_ERROR(SeedLog(options, {}, pool, &mapping));
  outcome->before = Measure(mapping.graph, mapping.state.poses, problem.truth, pool);
  Status refined = RefineLog(options, pool, &mapping);
  if (!refined.ok() && !IsDueRefusal(mapping.graph, mapping.state.poses)) return refined;
  outcome->alarm = !refined.ok() || !mapping.report.alarms.empty();
  outcome->after = Measure(mapping.graph, mapping.state.poses, problem.truth, pool);
  outcome->summary = std::move(mapping.report.solver);
  return Status::Ok();
}

Status SolveProblem(const AdversarialProblem& problem, const SolverOptions& solver,
                    ThreadPool* pool, AdversarialOutcome* outcome) {
  MapState state = problem.graph.InitialState();
  outcome->before = Measure(problem.graph, state.poses, problem.truth, pool);
  outcome->summary = RefineState(solver, problem.graph, &state);
  if (!outcome->summary.IsSolutionUsable() && !IsDueRefusal(problem.graph, state.poses)) {
    return Status::InvalidArgument(outcome->summary.message);
  }
  outcome->after = Measure(problem.graph, state.poses, problem.truth, pool);
  const std::vector<char>& is_false = problem.is_false;
  outcome->num_false_edges = static_cast<int>(std::count(is_false.begin(), is_false.end(), true));
  for (const IgnoredEdge& ignored : outcome->summary.ignored_edges) {
    ++(is_false[ignored.edge] ? outcome->num_false_edges_ignored
                              : outcome->num_sound_edges_ignored);
  }
  return Status::Ok();
}

// Runs of one attack at one level.
struct Row {
  std::vector<double> before_m, after_m, thickness_before_m, thickness_after_m;
  int runs = 0, returned = 0, worse_warned = 0, worse_silent = 0, blurrier = 0;
  int false_edges = 0, false_ignored = 0, sound_ignored = 0;

  void Add(const AdversarialOutcome& outcome) {
    ++runs;
    const TerminationType end = outcome.summary.termination;
    returned += end == TerminationType::kNoImprovement || end == TerminationType::kFailure ? 1 : 0;
    if (outcome.PosesAreWorse()) ++(outcome.alarm ? worse_warned : worse_silent);
    blurrier += outcome.MapIsBlurrier() ? 1 : 0;
    false_edges += outcome.num_false_edges;
    false_ignored += outcome.num_false_edges_ignored;
    sound_ignored += outcome.num_sound_edges_ignored;
    before_m.push_back(outcome.before.pose_error_m);
    after_m.push_back(outcome.after.pose_error_m);
    thickness_before_m.push_back(outcome.before.wall_thickness_m);
    thickness_after_m.push_back(outcome.after.wall_thickness_m);
  }

  std::string Text(const std::string& name) const {
    std::ostringstream text;
    text << std::left << std::setw(34) << name << std::right << std::setw(5) << runs << std::fixed
         << std::setprecision(1);
    for (const std::vector<double>* lengths :
         {&before_m, &after_m, &thickness_before_m, &thickness_after_m}) {
      text << std::setw(10) << 1e3 * QuartilesOf(*lengths).median;
    }
    text << std::setw(9) << returned << std::setw(8) << worse_warned << std::setw(8) << worse_silent
         << std::setw(10) << blurrier << std::setw(8) << false_edges << std::setw(9)
         << false_ignored << std::setw(7) << sound_ignored << '\n';
    return text.str();
  }
};

std::string NameOf(const AdversarialCase& run) {
  std::ostringstream name;
  name << (run.seeded ? "log: " : "graph: ") << ToString(run.attack);
  if (run.level > 0.0) name << ' ' << run.level;
  return name.str();
}

}  // namespace

const char* ToString(Attack attack) {
  switch (attack) {
    case Attack::kNone:
      return "none";
    case Attack::kTruth:
      return "start at the truth";
    case Attack::kDrift:
      return "drift times";
    case Attack::kWrongClosures:
      return "wrong closures";
    case Attack::kGrossClosures:
      return "mapper's gross closures";
    case Attack::kBiasedClosures:
      return "mapper's biased closures";
    case Attack::kJump:
      return "jump [m]";
    case Attack::kShuffled:
      return "shuffled poses";
    case Attack::kMirrored:
      return "mirrored scans";
    case Attack::kPeople:
      return "people";
    case Attack::kMissingOdometry:
      return "missing odometry";
    case Attack::kNoise:
      return "noise told times";
    case Attack::kRepeatedScan:
      return "scans of another place";
  }
  return "?";
}

bool AdversarialOutcome::MapIsBlurrier() const {
  // Both figures come from samples: a hundredth is their noise.
  constexpr double kShare = 0.01, kEntropy = 0.01;
  return after.wall_thickness_m > (1.0 + kShare) * before.wall_thickness_m &&
         after.mean_map_entropy > before.mean_map_entropy + kEntropy;
}

std::vector<AdversarialCase> AdversarialCases(int num_seeds) {
  std::vector<AdversarialCase> cases;
  for (const bool seeded : {false, true}) {
    for (const AttackLevels& attack : AllAttacks()) {
      if (seeded && !attack.in_a_log) continue;
      for (const double level : attack.levels) {
        for (int seed = 1; seed <= num_seeds; ++seed) {
          cases.push_back({attack.attack, level, static_cast<std::uint64_t>(seed), seeded});
        }
      }
    }
  }
  return cases;
}

Status RunAdversarialCase(const AdversarialCase& run, SolverOptions solver,
                          AdversarialOutcome* outcome) {
  solver.num_threads = 1;
  ThreadPool pool(1);
  AdversarialOutcome result;
  result.run = run;
  PLUMBLINE_RETURN_IF_ERROR(MeasureFloor(run.seed, solver, &pool, &result.floor_m));
  AdversarialProblem problem;
  PLUMBLINE_RETURN_IF_ERROR(MakeAdversarialProblem(run, &problem));
  if (run.attack == Attack::kNoise) solver.factors.beam.sigma_range_m *= run.level;
  PLUMBLINE_RETURN_IF_ERROR(
      (run.seeded ? MapProblem : SolveProblem)(problem, solver, &pool, &result));
  *outcome = std::move(result);
  return Status::Ok();
}

Status RunAdversarialStudy(const std::vector<AdversarialCase>& cases, const SolverOptions& solver,
                           ThreadPool* pool, std::vector<AdversarialOutcome>* outcomes) {
  return RunCases(
      cases, pool,
      [&](const AdversarialCase& run, AdversarialOutcome* outcome) {
        return RunAdversarialCase(run, solver, outcome);
      },
      outcomes);
}

std::string AdversarialTable(const std::vector<AdversarialOutcome>& outcomes) {
  std::string table =
      "                                   runs   pose error [mm]           wall [mm]     seed  "
      "poses worse,      map       false   ignored  sound\n"
      "                                         before     after    before     after returned  "
      "warned  silent  blurrier   edges of these  ignored\n";
  Row all;
  for (std::size_t i = 0; i < outcomes.size();) {
    const std::string name = NameOf(outcomes[i].run);
    Row row;
    for (; i < outcomes.size() && NameOf(outcomes[i].run) == name; ++i) {
      row.Add(outcomes[i]);
      all.Add(outcomes[i]);
    }
    table += row.Text(name);
  }
  return table + all.Text("all");
}

Status WriteAdversarialCsv(const std::string& path,
                           const std::vector<AdversarialOutcome>& outcomes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "attack,level,seed,seeded,floor_m,pose_error_before_m,pose_error_after_m,"
         "heading_error_before_rad,heading_error_after_rad,wall_before_m,wall_after_m,"
         "entropy_before,entropy_after,alarm,energy_before,energy_after,held_out_returns,held_out_"
         "before,"
         "held_out_after,held_out_noise,false_edges,false_edges_ignored,sound_edges_ignored,"
         "termination\n"
      << std::setprecision(8);
  for (const AdversarialOutcome& o : outcomes) {
    const AcceptanceTest& acceptance = o.summary.acceptance;
    out << ToString(o.run.attack) << ',' << o.run.level << ',' << o.run.seed << ',' << o.run.seeded
        << ',' << o.floor_m << ',' << o.before.pose_error_m << ',' << o.after.pose_error_m << ','
        << o.before.pose_error_rad << ',' << o.after.pose_error_rad << ','
        << o.before.wall_thickness_m << ',' << o.after.wall_thickness_m << ','
        << o.before.mean_map_entropy << ',' << o.after.mean_map_entropy << ',' << o.alarm << ','
        << acceptance.seed_energy << ',' << acceptance.final_energy << ','
        << acceptance.num_held_out << ',' << acceptance.seed_held_out_error << ','
        << acceptance.final_held_out_error << ',' << acceptance.held_out_noise << ','
        << o.num_false_edges << ',' << o.num_false_edges_ignored << ',' << o.num_sound_edges_ignored
        << ',' << ToString(o.summary.termination) << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
