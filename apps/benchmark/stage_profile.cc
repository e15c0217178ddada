#include "plumbline/apps/benchmark/stage_profile.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <iomanip>
#include <limits>
#include <sstream>
#include <system_error>
#include <utility>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/core/seconds_since.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Bytes per return of the arrays that all stages share.
constexpr double kReading = 6.0;   // range and beam
constexpr double kNormals = 8.0;   // to find the seed by, in single precision
constexpr double kSurface = 8.0;   // reading and normal, in 16 bits
constexpr double kPoint = 16.0;    // of the map
constexpr double kNumber = 4.0;    // of its cell, landmark or line
constexpr double kWritten = 28.0;  // in points.ply; points.pcd is as long

class StageClock {
 public:
  explicit StageClock(LogProfile* profile) : profile_(*profile) {}

  // Ends the stage that began where the last one ended.
  void End(const std::string& name, double bytes) {
    StageProfile stage;
    stage.name = name;
    stage.time_s = SecondsSince(start_);
    stage.cpu_time_s = static_cast<double>(std::clock() - cpu_start_) / CLOCKS_PER_SEC;
    stage.bytes = bytes;
    profile_.stages.push_back(std::move(stage));
    start_ = Clock::now();
    cpu_start_ = std::clock();
  }

 private:
  LogProfile& profile_;
  Clock::time_point start_ = Clock::now();
  std::clock_t cpu_start_ = std::clock();
};

// Each thread copies a part of its own, larger than any cache.
double MeasureCopying(ThreadPool* pool) {
  constexpr std::size_t kBytesPerThread = std::size_t{64} << 20;
  constexpr int kRepeats = 4;
  const std::size_t num_threads = pool->num_threads();
  std::vector<char> from(num_threads * kBytesPerThread, 1), to(from.size(), 2);
  double best_s = std::numeric_limits<double>::infinity();
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const auto start = Clock::now();
    pool->ForEachChunk(from.size(), kBytesPerThread,
                       [&](std::size_t, std::size_t begin, std::size_t end) {
                         std::memcpy(&to[begin], &from[begin], end - begin);
                       });
    best_s = std::min(best_s, SecondsSince(start));
  }
  return 2.0 * static_cast<double>(from.size()) / best_s;
}

// Sums side by side, so that none waits for another.
double MeasureArithmetic() {
  constexpr int kSteps = 10000000;
  constexpr int kRepeats = 4;
  std::array<double, 8> sums{};
  double best_s = std::numeric_limits<double>::infinity();
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const auto start = Clock::now();
    for (int step = 0; step < kSteps; ++step) {
      for (double& sum : sums) sum = sum * 0.999 + 1e-3;
    }
    best_s = std::min(best_s, SecondsSince(start));
  }
  // Looks at the sums, so that they are formed.
  const bool is_finite =
      std::all_of(sums.begin(), sums.end(), [](double sum) { return std::isfinite(sum); });
  return is_finite ? static_cast<double>(sums.size()) * kSteps / best_s : 0.0;
}

double BytesOfFile(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return error ? 0.0 : static_cast<double>(size);
}

// The bytes of a joint estimation over landmarks: its rounds cut the surfaces, lay them out and
// weigh them; the acceptance test cuts the seed and the result once more; then the lines and points
// are found, and the terms evaluated before and after.
double JointBytes(const SolverSummary& summary, double num_returns) {
  const double cut = kSurface + 2.0 * kNumber, laid_out = 2.0 * kNumber, weighed = kSurface;
  const double num_rounds = static_cast<double>(summary.landmark_rounds.size());
  const double lines = kSurface + 2.0 * kNumber, points = kSurface + kNumber + kPoint;
  const double terms = 2.0 * (kReading + kPoint + kNumber);
  return num_returns *
         (num_rounds * (cut + laid_out + weighed) + 2.0 * cut + lines + points + terms);
}

}  // namespace

MachineSpeed MeasureMachine(ThreadPool* pool) {
  return {MeasureCopying(pool), MeasureArithmetic()};
}

Status ProfileLog(const std::string& path, const MapLogOptions& options, const OutputFolder& output,
                  ThreadPool* pool, LogProfile* profile) {
  LogProfile result;
  result.machine = MeasureMachine(pool);
  StageClock clock(&result);
  LogNotes notes;
  SlamGraph graph;
  PLUMBLINE_RETURN_IF_ERROR(ReadLogIntoGraph(path, 0, &notes, &graph));
  result.num_returns = graph.num_returns();
  const auto n = static_cast<double>(graph.num_returns());
  clock.End("reading", BytesOfFile(path) + n * kReading);
  LogMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, std::move(graph), pool, &mapping));
  clock.End("surfaces", n * (kReading + kNormals + kPoint));
  bool is_matching = true;
  const auto end_matching = [&] {
    if (std::exchange(is_matching, false)) clock.End("matching scans", n * (kReading + kNormals));
  };
  const auto progress = [&](SeedingPhase phase, int, int) {
    if (phase == SeedingPhase::kClosingLoops) end_matching();
    return true;
  };
  PLUMBLINE_RETURN_IF_ERROR(SeedLog(options, progress, pool, &mapping));
  end_matching();  // a short drive has no loops to close
  clock.End("closing loops", n * (kReading + kNormals + kPoint));
  PLUMBLINE_RETURN_IF_ERROR(RefineLog(options, pool, &mapping));
  clock.End("joint estimation", JointBytes(mapping.report.solver, n));
  MeasureStage("", mapping.graph, mapping.state, nullptr, pool);
  clock.End("sharpness of a map", n * (2.0 * kPoint + kNumber));
  PLUMBLINE_RETURN_IF_ERROR(
      RunAll(MapWriteTasks(RefinedMapOf(mapping), RunOutputOptions(), output), pool));
  clock.End("pictures and points", n * (5.0 * kPoint + 2.0 * kWritten));
  *profile = std::move(result);
  return Status::Ok();
}

std::string ProfileTable(const LogProfile& profile) {
  constexpr double kMsPerS = 1e3, kNsPerS = 1e9, kPerGiga = 1e-9;
  const auto num_returns = static_cast<double>(profile.num_returns);
  std::ostringstream table;
  table << std::fixed << std::setprecision(1) << "This machine copies "
        << profile.machine.copied_bytes_per_s * kPerGiga
        << " GB/s (read and written), and a core does "
        << profile.machine.multiply_adds_per_s * kPerGiga
        << " billion multiply-adds/s. Per return: nanoseconds of CPU, the multiply-adds that they "
           "are "
           "worth, and bytes to move at least; the floor is the time to move these.\n"
        << std::left << std::setw(24) << "stage" << std::right << std::setw(9) << "seconds"
        << std::setw(8) << "CPU s" << std::setw(7) << "cores" << std::setw(9) << "ns/ret."
        << std::setw(11) << "mul-adds" << std::setw(9) << "bytes" << std::setw(10) << "floor ms"
        << std::setw(9) << "x floor" << '\n';
  const auto add_row = [&](const StageProfile& stage) {
    const double floor_s = stage.bytes / profile.machine.copied_bytes_per_s;
    table << std::left << std::setw(24) << stage.name << std::right << std::setprecision(3)
          << std::setw(9) << stage.time_s << std::setw(8) << stage.cpu_time_s
          << std::setprecision(2) << std::setw(7) << stage.cpu_time_s / stage.time_s
          << std::setprecision(0) << std::setw(9) << kNsPerS * stage.cpu_time_s / num_returns
          << std::setw(11) << profile.machine.multiply_adds_per_s * stage.cpu_time_s / num_returns
          << std::setw(9) << stage.bytes / num_returns << std::setprecision(1) << std::setw(10)
          << kMsPerS * floor_s << std::setw(9) << stage.time_s / floor_s << '\n';
  };
  StageProfile total;
  total.name = "all";
  for (const StageProfile& stage : profile.stages) {
    add_row(stage);
    total.time_s += stage.time_s;
    total.cpu_time_s += stage.cpu_time_s;
    total.bytes += stage.bytes;
  }
  add_row(total);
  return table.str();
}

Status WriteProfileCsv(const std::string& path, const LogProfile& profile) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "stage,returns,time_s,cpu_time_s,bytes,copied_bytes_per_s,multiply_adds_per_s\n"
      << std::setprecision(8);
  for (const StageProfile& stage : profile.stages) {
    out << '"' << stage.name << "\"," << profile.num_returns << ',' << stage.time_s << ','
        << stage.cpu_time_s << ',' << stage.bytes << ',' << profile.machine.copied_bytes_per_s
        << ',' << profile.machine.multiply_adds_per_s << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
