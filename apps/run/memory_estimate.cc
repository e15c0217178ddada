#include "plumbline/apps/run/memory_estimate.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "plumbline/apps/io/map_raster.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/core/sweep_motion.h"
#include "plumbline/solvers/interface/ceres_options.h"

namespace plumbline {
namespace {

constexpr double kBytesPerMb = 1e6, kBytesPerGb = 1e9;
constexpr double kBytesOfProgram = 25e6;
constexpr double kBytesPerPixel = 20.0;  // two pictures are drawn at a time

// What a stage takes beside the program.
struct Rates {
  double bytes_per_return, bytes_per_scan;
};
constexpr Rates kSeeding{24.0, 3.8e3};
constexpr Rates kResults{40.0, 2e3};
constexpr Rates kCalibration{50.0, 0.0};
constexpr double kJointBytesPerScan = 2e3;
// Of LogMapping::as_swept.
constexpr Rates kAsSwept{10.0, 0.0};

Rates JointRates(const SolverOptions& solver) {
  if (solver.MovesPosesOnly()) return kSeeding;
  double bytes_per_return = solver.IsOverLandmarks() ? 40.0 : 300.0;
  if (solver.type == SolverType::kAlternatingCg) bytes_per_return = 500.0;
  if (solver.type == SolverType::kCeres) {
    const bool iterates = solver.ceres->linear_solver_type == ceres::ITERATIVE_SCHUR;
    bytes_per_return = !solver.ceres->reduced ? 1600.0 : iterates ? 280.0 : 1300.0;
  }
  return {bytes_per_return, kJointBytesPerScan};
}

// Of the matrices of Ceres' dense linear solvers, beside what Rates say.
double DenseBytes(const SlamGraph& graph, const SolverOptions& solver) {
  if (solver.type != SolverType::kCeres) return 0.0;
  const auto num_returns = static_cast<double>(graph.num_returns());
  const double pose_columns = 3.0 * graph.num_poses();
  // Over landmarks: about what the first minute of a drive has.
  constexpr double kReturnsPerLandmark = 60.0, kReturnsPerObservation = 5.0;
  const bool reduced = solver.ceres->reduced;
  const double other_columns = 2.0 * num_returns / (reduced ? kReturnsPerLandmark : 1.0);
  const double rows = pose_columns + 3.0 * num_returns / (reduced ? kReturnsPerObservation : 1.0);
  const double columns = pose_columns + other_columns;
  // A pair of segments keeps up to three of its points from being eliminated.
  constexpr double kReturnsPerShapePair = 40.0;
  const bool keeps_points = !reduced && solver.factors.shape;
  const double kept_columns = keeps_points ? 6.0 * num_returns / kReturnsPerShapePair : 0.0;
  double entries = 0.0;
  switch (solver.ceres->linear_solver_type) {
    case ceres::DENSE_QR:
      entries = rows * columns;
      break;
    case ceres::DENSE_NORMAL_CHOLESKY:
      entries = columns * columns;
      break;
    case ceres::DENSE_SCHUR:
      entries = std::pow(pose_columns + kept_columns, 2);
      break;
    default:
      break;
  }
  return sizeof(double) * entries;
}

bool IsDense(const SolverOptions& solver) {
  const ceres::LinearSolverType type = solver.ceres->linear_solver_type;
  return solver.type == SolverType::kCeres &&
         (type == ceres::DENSE_QR || type == ceres::DENSE_NORMAL_CHOLESKY ||
          type == ceres::DENSE_SCHUR);
}

// Infinite if the system does not say.
double PhysicalMemory() {
  const auto num_pages = sysconf(_SC_PHYS_PAGES), page_size = sysconf(_SC_PAGE_SIZE);
  if (num_pages <= 0 || page_size <= 0) return std::numeric_limits<double>::infinity();
  return static_cast<double>(num_pages) * static_cast<double>(page_size);
}

// Of a picture of the map, as far as one can tell by the odometry; empty for a map of absurd size.
MapRaster RasterOfPicture(const SlamGraph& graph, const MapState& state, int picture_side_px) {
  MapRaster raster;
  const Status status =
      ChooseRaster(graph, state, MapPictureOptions().crop_share, picture_side_px, &raster);
  return status.ok() ? raster : MapRaster();
}

std::string MbText(double bytes) { return FixedText(bytes / kBytesPerMb, 0) + " MB"; }

// What would fit within the limit; empty if nothing does.
std::string Advice(const MemoryEstimate& estimate, double limit, const SlamGraph& graph,
                   const SolverOptions& solver) {
  std::string advice;
  const auto add = [&](const std::string& flag) {
    advice += (advice.empty() ? "" : " or ") + flag;
  };
  if (estimate.joint > limit && solver.type != SolverType::kReduced) add("--solver=reduced");
  const double num_scans = std::floor((limit - kBytesOfProgram) /
                                      (estimate.Peak() - kBytesOfProgram) * graph.num_scans());
  if (num_scans >= 1.0) add("--max_scans=" + FixedText(num_scans, 0));
  return advice.empty() ? "" : "; " + advice + " would need less";
}

// A dense matrix grows with the square of the log: what this machine does not hold is not tried.
Status CheckDenseSolver(const MemoryEstimate& estimate, const SolverOptions& solver) {
  if (!IsDense(solver) || estimate.Peak() <= PhysicalMemory()) return Status::Ok();
  return Status::InvalidArgument(std::string("--ceres=linear_solver_type=") +
                                 ceres::LinearSolverTypeToString(solver.ceres->linear_solver_type) +
                                 " needs about " + MbText(estimate.Peak()) +
                                 " of memory, but this machine has " + MbText(PhysicalMemory()) +
                                 "; sparse_schur or iterative_schur would need less");
}

}  // namespace

double MemoryEstimate::Peak() const { return std::max({seeding, joint, results}); }

void MemoryEstimate::Add(const MemoryEstimate& other) {
  seeding += other.seeding - kBytesOfProgram;
  joint += other.joint - kBytesOfProgram;
  results += other.results - other.pictures - pictures - kBytesOfProgram;
  pictures = std::max(pictures, other.pictures);
  results += pictures;
  picture_side_px = std::max(picture_side_px, other.picture_side_px);
}

std::string MemoryEstimate::Text() const {
  return "Memory needed, about: seeding " + MbText(seeding) + ", estimation " + MbText(joint) +
         ", results " + MbText(results) + '\n';
}

MemoryEstimate EstimateMemory(const SlamGraph& graph, const MapState& state,
                              const SolverOptions& solver, bool calibrates, int picture_side_px) {
  const auto bytes = [&graph](const Rates& rates) {
    return rates.bytes_per_return * static_cast<double>(graph.num_returns()) +
           rates.bytes_per_scan * graph.num_scans();
  };
  MemoryEstimate estimate;
  const double base = kBytesOfProgram + (HasSweeps(graph) ? bytes(kAsSwept) : 0.0);
  estimate.seeding = base + bytes(kSeeding);
  estimate.joint = base + bytes(JointRates(solver)) + DenseBytes(graph, solver);
  if (calibrates) estimate.joint += bytes(kCalibration);
  const MapRaster raster = RasterOfPicture(graph, state, picture_side_px);
  estimate.pictures = kBytesPerPixel * raster.width * raster.height;
  estimate.results = base + bytes(kResults) + estimate.pictures;
  estimate.picture_side_px = std::max(raster.width, raster.height);
  return estimate;
}

Status ParseMemorySize(const std::string& text, double* bytes) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const std::string unit = end;
  const double factor = unit == "GB" ? kBytesPerGb : unit == "MB" ? kBytesPerMb : 0.0;
  const bool has_unit = factor > 0.0 || (unit.empty() && number == 0.0);
  if (end == text.c_str() || !has_unit || !(number >= 0.0) || !std::isfinite(number)) {
    return Status::InvalidArgument("'" + text + "' is no size of memory such as 4GB or 500MB");
  }
  *bytes = number * factor;
  return Status::Ok();
}

std::string FitPictures(double limit, MemoryEstimate* estimate, int* picture_side_px) {
  constexpr int kSmallestSidePx = 300;
  // Pictures take memory by the square of their sides.
  const double others = estimate->results - estimate->pictures;
  if (limit == 0.0 || estimate->results <= limit || estimate->pictures <= 0.0) return "";
  const double share = std::sqrt(std::max(limit - others, 0.0) / estimate->pictures);
  const int side_px = static_cast<int>(share * estimate->picture_side_px);
  if (side_px < kSmallestSidePx) return "";
  const double kept = static_cast<double>(side_px) / estimate->picture_side_px;
  estimate->pictures *= kept * kept;
  estimate->results = others + estimate->pictures;
  estimate->picture_side_px = *picture_side_px = side_px;
  return "To stay within --max_memory, pictures have sides of " + std::to_string(side_px) +
         " pixels at most\n";
}

std::string FitGrid(const MemoryEstimate& expected, const SlamGraph& graph, const MapState& seed,
                    double limit, RunOutputOptions* outputs) {
  if (limit > 0.0) outputs->LimitGrid(std::max(limit - expected.results, 0.1 * limit));
  double num_cells = 0.0;
  if (!CheckGridSize(graph, seed, outputs->GridOptions(), &num_cells).ok()) return "";
  const double grid = OccupancyGridOptions::kBytesPerCell * num_cells;
  const double results = expected.results + grid;
  constexpr double kMuchMore = 1.25;
  if (results <= kMuchMore * expected.Peak()) return "";
  return "The results may need more memory than that, up to " + MbText(results) +
         ": the occupancy grid takes up to " + MbText(grid) + '\n';
}

Status FitMemory(double limit, const SlamGraph& graph, const SolverOptions& solver,
                 MemoryEstimate* estimate, int* picture_side_px, std::ostream* out) {
  *out << estimate->Text() << std::flush;
  if (limit == 0.0) return CheckDenseSolver(*estimate, solver);
  MemoryEstimate fitted = *estimate;
  int side_px = *picture_side_px;
  const std::string text = FitPictures(limit, &fitted, &side_px);
  if (fitted.Peak() > limit) {
    return Status::InvalidArgument("the run needs about " + MbText(estimate->Peak()) +
                                   " of memory, but --max_memory allows " + MbText(limit) +
                                   Advice(*estimate, limit, graph, solver));
  }
  *estimate = fitted;
  *picture_side_px = side_px;
  *out << text << std::flush;
  return Status::Ok();
}

}  // namespace plumbline
