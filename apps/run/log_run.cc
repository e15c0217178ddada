#include "plumbline/apps/run/log_run.h"

#include <chrono>
#include <future>
#include <iomanip>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/evaluation/truth.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/report/run_summary.h"
#include "plumbline/apps/report/seeding_text.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/apps/run/log_input.h"
#include "plumbline/apps/run/map_run.h"
#include "plumbline/apps/run/memory_estimate.h"
#include "plumbline/apps/run/progress.h"
#include "plumbline/apps/run/seeding_progress.h"
#include "plumbline/apps/run/share_mapping.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {
namespace {

// One run, step by step.
class LogRun {
 public:
  explicit LogRun(const LogRunOptions& options)
      : options_(options),
        outputs_(options.outputs),
        pool_(options.mapping.solver.num_threads),
        output_(options.output_dir) {}

  Status Run() {
    PLUMBLINE_RETURN_IF_ERROR(Start());
    MapRun map(options_.mapping, outputs_, output_, TruthOrNull(), std::move(summary_), &pool_,
               &mapping_);
    PLUMBLINE_RETURN_IF_ERROR(RecordStart(&map));
    PLUMBLINE_RETURN_IF_ERROR(map.Refine());
    PLUMBLINE_RETURN_IF_ERROR(map.WriteMap());
    PLUMBLINE_RETURN_IF_ERROR(WriteWithStopSignal(
        [&](const std::string& signal_name) { return map.WriteReport(signal_name); }));
    map.PrintResults();
    return Status::Ok();
  }

 private:
  Status Start() {
    const Peers* peers = options_.peers;
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(peers, [this] { return Read(); }));
    ShareTruth(peers, &truth_);
    if (SeedTogether()) {
      PLUMBLINE_RETURN_IF_ERROR(FindSeed(peers));
      AwaitLimits();
      return Status::Ok();
    }
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(peers, [this] { return FindSeed(nullptr); }));
    if (peers == nullptr) return Status::Ok();
    AwaitLimits();
    return ShareMapping(peers, options_.mapping, &pool_, &mapping_);
  }

  // Not where the speaker has to look at the whole log.
  bool SeedTogether() const {
    return options_.peers != nullptr &&
           CanShareSeeding(*options_.peers, CanSeedTogether(options_.mapping, mapping_));
  }

  void AwaitLimits() {
    if (options_.peers == nullptr) return;
    options_.peers->WaitForAll();
    ShareLimits(options_.peers, &outputs_);
  }

  Status Read() {
    SlamGraph graph;
    PLUMBLINE_RETURN_IF_ERROR(
        ReadLogInput(options_.log, options_.max_scans, options_.max_memory, &summary_, &graph));
    PLUMBLINE_RETURN_IF_ERROR(CheckLimits(graph));
    const auto start = std::chrono::steady_clock::now();
    PLUMBLINE_RETURN_IF_ERROR(TakeLog(options_.mapping, std::move(graph), &pool_, &mapping_));
    summary_.seed_time_s = SecondsSince(start);
    if (mapping_.report.sweep_order) {
      std::cout << "Sweeps: measured " << ToString(*mapping_.report.sweep_order)
                << ", by what the scans say\n";
    }
    if (options_.truth.empty()) return Status::Ok();
    return ReadTruth(options_.truth, options_.hits, mapping_.graph, &truth_);
  }

  // What would end the run at its end is found before the work. May make pictures smaller.
  Status CheckLimits(const SlamGraph& graph) {
    const MapState odometry{graph.initial_poses(), {}};
    PLUMBLINE_RETURN_IF_ERROR(
        CheckRobotMap(options_.log, graph, odometry, outputs_.map_resolution_m));
    const SolverOptions& solver = options_.mapping.solver;
    memory_ = EstimateMemory(graph, odometry, solver, options_.mapping.calibration.IsOn(),
                             outputs_.picture_side_px);
    return FitMemory(options_.max_memory, graph, solver, &memory_, &outputs_.picture_side_px,
                     &std::cout);
  }

  // together: the processes that find the seed together; null if this one does alone.
  Status FindSeed(const Peers* together) {
    // What cannot be written is known before the work.
    PLUMBLINE_RETURN_IF_ERROR(BySpeaker(together, [this] { return MakeFolder(); }));
    EndIfStoppedWhile("seeding", output_.made_folders());
    if (together != nullptr) PLUMBLINE_RETURN_IF_ERROR(ShareLog(together, &mapping_));
    PLUMBLINE_RETURN_IF_ERROR(Seed());
    KeepStopSignal();
    // Collective if the graph is shared. What it limits, all take from the speaker.
    const std::string grid_text =
        FitGrid(memory_, mapping_.graph, mapping_.state, options_.max_memory, &outputs_);
    const SeedingReport& seeding = mapping_.report.seeding;
    std::cout << RangeNoiseText(options_.mapping, mapping_.report)
              << SeedingText(seeding, mapping_.graph, mapping_.state.poses)
              << ConsistencyText("The seed", seeding.consistency) << grid_text << std::flush;
    return Status::Ok();
  }

  // Not to be cut off by a signal: it tries out a file.
  Status MakeFolder() {
    KeepStopSignal();
    return output_.Make();
  }

  // The odometry's map is measured meanwhile: matching scans keeps one thread busy.
  Status Seed() {
    const auto start = std::chrono::steady_clock::now();
    // Several processes measure it together, later.
    if (options_.peers == nullptr) StartMeasuring();
    SeedingBars bars(StandardOutputIsTerminal(), &std::cout);
    const auto progress = [&](SeedingPhase phase, int num_done, int num_total) {
      bars.Update(phase, num_done, num_total);
      return true;
    };
    PLUMBLINE_RETURN_IF_ERROR(SeedLog(options_.mapping, progress, &pool_, &mapping_));
    summary_.seed_time_s += SecondsSince(start);
    bars.Finish();
    std::cout << "Seeding: done (" << std::fixed << std::setprecision(2) << summary_.seed_time_s
              << " s)\n";
    return Status::Ok();
  }

  // From here on there is a map to write, also if the run is stopped. Not before: an earlier run's
  // results outlive one that comes to nothing.
  Status RecordStart(MapRun* map) {
    PLUMBLINE_RETURN_IF_ERROR(
        BySpeaker(options_.peers, [this] { return output_.RemoveOldResults(); }));
    const Stage stage = OdometryStage();
    const OdometryNoiseReport& noise = mapping_.report.seeding.odometry_noise;
    const bool is_given = !noise.is_prediction || noise.gross_translation_scale == 0.0 ||
                          noise.given_poses.position_m > 0.0;
    return map->RecordStart(is_given ? &stage : nullptr);
  }

  Stage OdometryStage() {
    if (options_.peers != nullptr) {
      return MeasureStage("odometry", mapping_.graph, {mapping_.graph.initial_poses(), {}},
                          TruthOrNull(), &pool_);
    }
    return odometry_stage_.get();
  }

  // Of a graph of its own, which takes less memory than an array of its points: the seeding changes
  // that of the mapping.
  void StartMeasuring() {
    const auto when = pool_.num_threads() > 1 ? std::launch::async : std::launch::deferred;
    odometry_stage_ = std::async(when, [this, given = mapping_.graph]() mutable {
      const SlamGraph graph = std::move(given);  // freed once it is measured
      ThreadPool one_thread(1);
      return MeasureStage("odometry", graph, {graph.initial_poses(), {}}, TruthOrNull(),
                          &one_thread);
    });
  }

  const Truth* TruthOrNull() const { return options_.truth.empty() ? nullptr : &truth_; }

  const LogRunOptions& options_;
  RunOutputOptions outputs_;  // as the memory allows them
  MemoryEstimate memory_;     // of a map whose extent nobody knows yet
  ThreadPool pool_;
  OutputFolder output_;
  LogMapping mapping_;
  Truth truth_;                        // where it is given
  std::future<Stage> odometry_stage_;  // refers to the truth
  RunSummary summary_;
};

}  // namespace

Status RunLog(const LogRunOptions& options) { return LogRun(options).Run(); }

}  // namespace plumbline
