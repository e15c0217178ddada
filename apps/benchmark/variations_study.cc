#include "plumbline/apps/benchmark/variations_study.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iomanip>
#include <mutex>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "plumbline/apps/benchmark/run_cases.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/seconds_since.h"

namespace plumbline {
namespace {

// Name of a log without folder, and without everything from the first ".clf" or ".log" on.
std::string LogName(const std::string& path) {
  const std::string file = std::filesystem::path(path).filename().string();
  return file.substr(0, std::min(file.find(".clf"), file.find(".log")));
}

Status ReadKnownLog(const std::string& path, KnownLog* known) {
  const std::string relations = RelationsBeside(path);
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::exists(relations, ignored)) {
    return Status::NotFound(path + ": its relations are missing; want '" + relations + "'");
  }
  KnownLog result;
  result.name = LogName(path);
  PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(path, CarmenReadOptions(), &result.log));
  PLUMBLINE_RETURN_IF_ERROR(ReadRelations(relations, &result.relations));
  *known = std::move(result);
  return Status::Ok();
}

bool IsUnvaried(const LogVariation& variation) { return &variation == &LogVariations().front(); }

// Hands outcomes on in the order of their numbers, from any thread.
class OrderedOutcomes {
 public:
  OrderedOutcomes(std::size_t size, const std::function<void(const VariationOutcome&)>& done)
      : done_(done), waiting_(size) {}

  void Add(std::size_t number, const VariationOutcome& outcome) {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_[number] = outcome;
    for (; next_ < waiting_.size() && waiting_[next_].has_value(); ++next_) {
      if (done_) done_(*waiting_[next_]);
    }
  }

 private:
  const std::function<void(const VariationOutcome&)>& done_;
  std::mutex mutex_;
  std::vector<std::optional<VariationOutcome>> waiting_;
  std::size_t next_ = 0;
};

struct MappedLog {
  std::vector<TimedPose> trajectory;
  VariationOutcome outcome;
};

double MeanError(const std::vector<Relation>& relations, const std::vector<TimedPose>& trajectory) {
  return MeasureRelations(relations, trajectory, RelationsOptions()).all.translation_m.mean;
}

// Maps a log as MapLog does, on one thread, and fills in all of the outcome but the reference.
Status MapKnownLog(const MapLogOptions& options, KnownLog known, MappedLog* mapped) {
  using Clock = std::chrono::steady_clock;
  SlamGraph graph;
  PLUMBLINE_RETURN_IF_ERROR(BuildGraph(
      std::move(known.log), 0, [] {}, &graph));
  if (graph.num_returns() == 0) return Status::InvalidArgument("no scan has a return");
  VariationOutcome& outcome = mapped->outcome;
  outcome.num_scans = graph.num_scans();
  outcome.num_relations = known.relations.size();
  MapLogOptions one_thread = options;
  one_thread.solver.num_threads = 1;
  ThreadPool pool(1);
  LogMapping mapping;
  const auto start = Clock::now();
  PLUMBLINE_RETURN_IF_ERROR(PrepareLog(one_thread, std::move(graph), &pool, &mapping));
  std::optional<double> matched_s;
  const auto progress = [&](SeedingPhase phase, int, int) {
    if (phase == SeedingPhase::kClosingLoops && !matched_s) matched_s = SecondsSince(start);
    return true;
  };
  PLUMBLINE_RETURN_IF_ERROR(SeedLog(one_thread, progress, &pool, &mapping));
  outcome.seeding_s = SecondsSince(start);
  outcome.matching_s = matched_s.value_or(outcome.seeding_s);
  outcome.has_seed_alarm = mapping.report.seeding.alarm;
  outcome.seed_error_m = MeanError(known.relations, TrajectoryOf(mapping.graph, mapping.state));
  PLUMBLINE_RETURN_IF_ERROR(RefineLog(one_thread, &pool, &mapping));
  outcome.time_s = SecondsSince(start);
  outcome.has_alarm = !mapping.report.alarms.empty();
  mapped->trajectory = TrajectoryOf(mapping.graph, mapping.state);
  outcome.error_m = MeanError(known.relations, mapped->trajectory);
  return Status::Ok();
}

class VariationsStudy {
 public:
  VariationsStudy(const std::vector<KnownLog>& logs, const std::vector<VariationCase>& cases,
                  const MapLogOptions& options,
                  const std::function<void(const VariationOutcome&)>& done, ThreadPool* pool)
      : logs_(logs), cases_(cases), options_(options), pool_(pool), in_order_(cases.size(), done) {
    for (std::size_t i = 0; i < cases.size(); ++i) numbers_.push_back(i);
    const auto varied = std::stable_partition(numbers_.begin(), numbers_.end(), [&](std::size_t i) {
      return IsUnvaried(*cases[i].variation);
    });
    varied_.assign(varied, numbers_.end());
    numbers_.erase(varied, numbers_.end());
  }

  Status Run(std::vector<VariationOutcome>* outcomes) {
    PLUMBLINE_RETURN_IF_ERROR(CheckVariations());
    unvaried_.resize(logs_.size());
    std::vector<VariationOutcome> result(cases_.size());
    PLUMBLINE_RETURN_IF_ERROR(RunAll(numbers_, &result));
    PLUMBLINE_RETURN_IF_ERROR(RunAll(varied_, &result));
    *outcomes = std::move(result);
    return Status::Ok();
  }

 private:
  Status CheckVariations() {
    std::vector<char> ignored;
    return RunCases(
        cases_, pool_,
        [&](const VariationCase& run, char*) {
          VariedLog varied;
          return VaryLog(*run.variation, run.seed, logs_[run.log], &varied);
        },
        &ignored);
  }

  Status RunAll(const std::vector<std::size_t>& numbers, std::vector<VariationOutcome>* result) {
    std::vector<char> ignored;
    return RunCases(
        numbers, pool_,
        [&](std::size_t number, char*) { return RunOne(number, &(*result)[number]); }, &ignored);
  }

  // Maps one log. The map of the log without variation is made before the others.
  Status RunOne(std::size_t number, VariationOutcome* outcome) {
    const VariationCase& run = cases_[number];
    VariedLog varied;
    PLUMBLINE_RETURN_IF_ERROR(VaryLog(*run.variation, run.seed, logs_[run.log], &varied));
    MappedLog mapped;
    const Status status = MapKnownLog(options_, std::move(varied.known), &mapped);
    if (!status.ok()) {
      return Status::InvalidArgument(logs_[run.log].name + ", variation " + run.variation->name +
                                     ", seed " + std::to_string(run.seed) + ": " +
                                     status.message());
    }
    if (IsUnvaried(*run.variation)) unvaried_[run.log] = std::move(mapped.trajectory);
    *outcome = std::move(mapped.outcome);
    outcome->log = logs_[run.log].name;
    outcome->variation = run.variation->name;
    outcome->seed = run.seed;
    outcome->reference_error_m = MeanError(varied.unvaried_relations, unvaried_[run.log]);
    in_order_.Add(number, *outcome);
    return Status::Ok();
  }

  const std::vector<KnownLog>& logs_;
  const std::vector<VariationCase>& cases_;
  const MapLogOptions& options_;
  ThreadPool* const pool_;
  OrderedOutcomes in_order_;
  std::vector<std::size_t> numbers_, varied_;     // of cases without and with a variation
  std::vector<std::vector<TimedPose>> unvaried_;  // trajectories, per log
};

// Runs of one class, counted by their outcome.
struct VariationsTally {
  int runs = 0, right_quiet = 0, right_warned = 0, wrong_warned = 0, wrong_silent = 0;
  double matching_s = 0.0, seeding_s = 0.0, time_s = 0.0;

  void Add(const VariationOutcome& outcome) {
    ++runs;
    ++(outcome.IsRight() ? (outcome.has_alarm ? right_warned : right_quiet)
                         : (outcome.has_alarm ? wrong_warned : wrong_silent));
    matching_s += outcome.matching_s;
    seeding_s += outcome.seeding_s;
    time_s += outcome.time_s;
  }
};

// Counts the outcomes that `belongs` picks; no row if there are none.
template <typename Predicate>
void WriteVariationsRow(const std::string& name, const std::vector<VariationOutcome>& outcomes,
                        const Predicate& belongs, std::ostream* table) {
  VariationsTally tally;
  for (const VariationOutcome& outcome : outcomes) {
    if (belongs(outcome)) tally.Add(outcome);
  }
  if (tally.runs == 0) return;
  *table << std::left << std::setw(16) << name << std::right << std::setw(5) << tally.runs
         << std::setw(14) << tally.right_quiet << std::setw(15) << tally.right_warned
         << std::setw(15) << tally.wrong_warned << std::setw(15) << tally.wrong_silent << std::fixed
         << std::setprecision(1) << std::setw(9)
         << 100.0 * (tally.right_quiet + tally.right_warned) / tally.runs << std::setw(13)
         << tally.matching_s << std::setw(12) << tally.seeding_s << std::setw(10) << tally.time_s
         << '\n';
}

std::string TallyHeader(const std::string& first) {
  std::ostringstream header;
  header << std::left << std::setw(16) << first
         << " runs  right, quiet  right, warned  wrong, warned  wrong, SILENT  right %  matching, s"
            "  seeding, s   all, s\n";
  return header.str();
}

}  // namespace

std::string RelationsBeside(const std::string& log) {
  return (std::filesystem::path(log).parent_path() / (LogName(log) + ".relations")).string();
}

Status ReadKnownLogs(const std::vector<std::string>& paths, std::vector<KnownLog>* logs) {
  std::vector<KnownLog> result(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    PLUMBLINE_RETURN_IF_ERROR(ReadKnownLog(paths[i], &result[i]));
  }
  *logs = std::move(result);
  return Status::Ok();
}

Status ParseVariations(const std::string& names, std::vector<const LogVariation*>* variations) {
  std::vector<const LogVariation*> found;
  std::string known = "all";
  for (const LogVariation& variation : LogVariations()) {
    if (names == "all") found.push_back(&variation);
    known += std::string(", ") + variation.name;
  }
  std::istringstream stream(names == "all" ? "" : names);
  for (std::string name; std::getline(stream, name, ',');) {
    found.push_back(FindLogVariation(name));
    if (found.back() != nullptr) continue;
    return Status::InvalidArgument("there is no variation '" + name + "'; want some of " + known);
  }
  if (found.empty()) return Status::InvalidArgument("no variation; want some of " + known);
  *variations = std::move(found);
  return Status::Ok();
}

std::vector<VariationCase> VariationCases(std::size_t num_logs,
                                          const std::vector<const LogVariation*>& variations,
                                          int num_seeds, std::uint64_t first_seed) {
  std::vector<VariationCase> cases;
  for (std::size_t log = 0; log < num_logs; ++log) {
    cases.push_back({log, &LogVariations().front(), first_seed});
    for (const LogVariation* variation : variations) {
      if (IsUnvaried(*variation)) continue;
      for (int i = 0; i < (variation->is_random ? num_seeds : 1); ++i) {
        cases.push_back({log, variation, first_seed + i});
      }
    }
  }
  return cases;
}

Status RunVariationsStudy(const std::vector<KnownLog>& logs,
                          const std::vector<VariationCase>& cases, const MapLogOptions& options,
                          const std::function<void(const VariationOutcome&)>& done,
                          ThreadPool* pool, std::vector<VariationOutcome>* outcomes) {
  return VariationsStudy(logs, cases, options, done, pool).Run(outcomes);
}

std::string VariationHeader() {
  return "log              variation    seed   scans  relations   error, m  unvaried, m  verdict"
         "         seeding, s\n";
}

std::string VariationRow(const VariationOutcome& outcome) {
  std::ostringstream row;
  const std::string verdict =
      std::string(outcome.IsRight() ? "right, " : "wrong, ") + (outcome.has_alarm   ? "warned"
                                                                : outcome.IsRight() ? "quiet"
                                                                                    : "SILENT");
  row << std::left << std::setw(16) << outcome.log << ' ' << std::setw(12) << outcome.variation
      << std::right << std::setw(5) << outcome.seed << std::setw(8) << outcome.num_scans
      << std::setw(11) << outcome.num_relations << std::fixed << std::setprecision(4)
      << std::setw(11) << outcome.error_m << std::setw(13) << outcome.reference_error_m << "  "
      << std::left << std::setw(13) << verdict << std::right << std::setprecision(2)
      << std::setw(13) << outcome.seeding_s << '\n';
  return row.str();
}

std::string VariationsTable(const std::vector<VariationOutcome>& outcomes) {
  std::ostringstream table;
  table << TallyHeader("variation");
  for (const LogVariation& variation : LogVariations()) {
    WriteVariationsRow(
        variation.name, outcomes,
        [&](const VariationOutcome& outcome) { return outcome.variation == variation.name; },
        &table);
  }
  table << TallyHeader("log");
  std::vector<std::string> logs;
  for (const VariationOutcome& outcome : outcomes) {
    if (std::find(logs.begin(), logs.end(), outcome.log) == logs.end()) logs.push_back(outcome.log);
  }
  for (const std::string& log : logs) {
    WriteVariationsRow(
        log, outcomes, [&](const VariationOutcome& outcome) { return outcome.log == log; }, &table);
  }
  WriteVariationsRow(
      "all", outcomes, [](const VariationOutcome&) { return true; }, &table);
  return table.str();
}

Status WriteVariationsCsv(const std::string& path, const std::vector<VariationOutcome>& outcomes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "log,variation,seed,scans,relations,error_m,seed_error_m,reference_error_m,right,alarm,"
         "seed_alarm,matching_s,seeding_s,time_s\n";
  out << std::setprecision(6);
  for (const VariationOutcome& outcome : outcomes) {
    out << outcome.log << ',' << outcome.variation << ',' << outcome.seed << ','
        << outcome.num_scans << ',' << outcome.num_relations << ',' << outcome.error_m << ','
        << outcome.seed_error_m << ',' << outcome.reference_error_m << ',' << outcome.IsRight()
        << ',' << outcome.has_alarm << ',' << outcome.has_seed_alarm << ',' << outcome.matching_s
        << ',' << outcome.seeding_s << ',' << outcome.time_s << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
