#include "plumbline/solvers/landmarks/line_landmarks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"
#include "plumbline/core/line_fit.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/surface_cells.h"

namespace plumbline {
namespace {

// By default from 0.1 m, since shorter stretches of surface have no direction beside a laser's
// noise, up to 0.8 m.
constexpr int kNumFitLevels = 4;
constexpr double kLargestOverFinest = 8.0;
// Fewest returns of a landmark.
constexpr int kMinPoints = 5;

// The grid is turned against the walls, by atan(1/2), so that none runs along an edge between
// cells: noise would decide which side its returns belong to.
constexpr double kGridTurnRad = 0.46364760900080615;

// What a cell's returns cost under the best lines found for them.
struct Partition {
  double scatter = 0.0;  // sum of squared distances [m^2]
  double covered = 0.0;  // returns on a line
  int num_lines = 0;
  bool whole = false;  // one line for all of the cell

  Partition& operator+=(const Partition& other) {
    scatter += other.scatter;
    covered += other.covered;
    num_lines += other.num_lines;
    return *this;
  }
};

class Quadtree {
 public:
  Quadtree(const SurfaceCells& finest, const LineLandmarkOptions& options) : options_(options) {
    levels_.push_back(finest);
    while (static_cast<int>(levels_.size()) < kNumFitLevels) {
      levels_.push_back(Coarsened(&levels_.back()));
    }
  }

  std::vector<LineLandmark> Cut(const SurfaceGrid& grid) {
    ChooseFromBelow();
    std::vector<LineLandmark> landmarks;
    landmark_of_cell_.resize(levels_.size());
    for (std::size_t level = levels_.size(); level-- > 0;) {
      const SurfaceCells& cells = levels_[level];
      landmark_of_cell_[level].assign(cells.size(), LineLandmarks::kNone);
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const bool is_top = level + 1 == levels_.size();
        int& landmark = landmark_of_cell_[level][i];
        if (!is_top) landmark = landmark_of_cell_[level + 1][cells[i].parent];
        if (landmark != LineLandmarks::kNone || !partitions_[level][i].whole) continue;
        landmark = static_cast<int>(landmarks.size());
        landmarks.push_back(MakeLandmark(cells, i, grid));
      }
    }
    return landmarks;
  }

  int LandmarkOfCell(int finest) const { return landmark_of_cell_.front()[finest]; }

  /// The landmark that a return may lie on: its line faces the laser, and the return is at most
  /// max_sigmas off it. Of the smallest cell around the return that has any such landmark, the one
  /// that it is fewest sigmas off. in_grid: the return in the grid's axes.
  int LandmarkAt(const Eigen::Vector2d& in_grid, const Eigen::Vector2d& point,
                 const Eigen::Vector2d& laser, double max_sigmas,
                 const std::vector<LineLandmark>& landmarks) const {
    int best = LineLandmarks::kNone;
    double least_squared = max_sigmas * max_sigmas;
    for (std::size_t level = 0; best == LineLandmarks::kNone && level < levels_.size(); ++level) {
      const SurfaceCellKey key = levels_[level].KeyOf(in_grid.x(), in_grid.y(), 0);
      for (const int cell : levels_[level].Square(key.x, key.y)) {
        if (cell == SurfaceCells::kNone) continue;
        const int id = landmark_of_cell_[level][cell];
        if (id == LineLandmarks::kNone) continue;
        const LineLandmark& landmark = landmarks[id];
        if (landmark.normal.dot(laser - point) <= 0.0) continue;
        const double variance = options_.noise.surface_variance +
                                options_.noise.BeamVariance(point - laser, landmark.normal);
        const double squared = std::pow(landmark.Distance(point), 2) / variance;
        if (squared >= least_squared) continue;
        best = id;
        least_squared = squared;
      }
    }
    return best;
  }

 private:
  // Chooses for every cell between one line and what its quarters chose.
  void ChooseFromBelow() {
    partitions_.resize(levels_.size());
    std::vector<Partition> quarters(levels_[0].size());
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      const SurfaceCells& cells = levels_[level];
      std::vector<Partition>& partitions = partitions_[level];
      partitions.resize(cells.size());
      for (std::size_t i = 0; i < cells.size(); ++i) {
        partitions[i] = Choose(cells[i], quarters[i]);
      }
      if (level + 1 == levels_.size()) break;
      quarters.assign(levels_[level + 1].size(), Partition());
      for (std::size_t i = 0; i < cells.size(); ++i) quarters[cells[i].parent] += partitions[i];
    }
  }

  Partition Choose(const SurfaceCell& cell, const Partition& quarters) const {
    const PointMoments& moments = cell.moments;
    if (moments.weight < kMinPoints) return Split(quarters);
    const LineFit fit = FitLine(moments);
    if (fit.EigenvalueRatio() > options_.max_eigenvalue_ratio) return Split(quarters);
    const Partition whole{fit.smaller_eigenvalue * moments.weight, moments.weight, 1, true};
    return SplitPays(whole, quarters) ? Split(quarters) : whole;
  }

  static Partition Split(Partition quarters) {
    quarters.whole = false;
    return quarters;
  }

  // Whether several lines explain the returns better than one: beyond what the additional
  // parameters explain of mere noise (F test), and by enough to matter. Where poses are still
  // wrong, dense returns make any wave significant.
  bool SplitPays(const Partition& whole, const Partition& quarters) const {
    constexpr double kWorthwhileShare = 0.7;
    constexpr double kSignificantF = 4.0;
    constexpr double kLostSigmas = 3.0;  // what a return costs that is left without a line
    if (quarters.num_lines < 2) return false;
    const double free_of_quarters = whole.covered - 2.0 * quarters.num_lines;
    if (free_of_quarters <= 0.0) return false;
    const double lost_variance =
        kLostSigmas * kLostSigmas * std::pow(options_.noise.StandardDeviation(), 2);
    const double lost_scatter = (whole.covered - quarters.covered) * lost_variance;
    const double scatter = quarters.scatter + lost_scatter;
    const double variance = scatter / free_of_quarters;
    const double variance_of_whole = whole.scatter / (whole.covered - 2.0);
    const double explained = (whole.scatter - scatter) / (2.0 * (quarters.num_lines - 1));
    return variance < kWorthwhileShare * variance_of_whole && explained > kSignificantF * variance;
  }

  LineLandmark MakeLandmark(const SurfaceCells& cells, std::size_t i,
                            const SurfaceGrid& grid) const {
    const Pose2 world_from_grid(0.0, 0.0, grid.cell_yaw_rad);
    const LineFit fit = FitLine(cells[i].moments);
    LineLandmark landmark;
    landmark.origin = world_from_grid * cells.Center(cells[i].key);
    landmark.normal = world_from_grid * fit.normal;
    landmark.offset_m = fit.normal.dot(fit.centroid);
    // A line has two normals; that of a surface faces where its returns were seen from.
    const double facing_rad = grid.octant_yaw_rad + cells[i].key.octant * 0.25 * kPi;
    if (landmark.normal.dot(Eigen::Vector2d(std::cos(facing_rad), std::sin(facing_rad))) < 0.0) {
      landmark.normal = -landmark.normal;
      landmark.offset_m = -landmark.offset_m;
    }
    return landmark;
  }

  const LineLandmarkOptions& options_;
  std::vector<SurfaceCells> levels_;                // from the finest
  std::vector<std::vector<Partition>> partitions_;  // of each cell of each level
  std::vector<std::vector<int>> landmark_of_cell_;  // the same
};

// Far away or at a grazing angle, a return has too few neighbours for a normal of its own, but
// says as much of where the laser is as any other.
void AddReturnsWithoutNormal(const SlamGraph& graph, const std::vector<double>& poses,
                             const MeasuredSurface& surface, const Quadtree& quadtree,
                             const SurfaceGrid& grid, ThreadPool* pool, LineLandmarks* result) {
  constexpr double kMaxSigmas = 3.0;
  constexpr std::size_t kScansPerChunk = 16;
  const double grid_pose[3] = {0.0, 0.0, grid.cell_yaw_rad};
  const PoseFrame grid_axes(grid_pose);
  pool->ForEachChunk(
      graph.num_scans(), kScansPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
          const ScanEntry& scan = graph.scan(static_cast<int>(s));
          const PoseFrame frame(&poses[3 * scan.pose]);
          const Eigen::Vector2d laser =
              graph.WorldFromLaser(static_cast<int>(s), poses).translation();
          for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
            if (!surface.normals[r].isZero(0.0f)) continue;
            const Eigen::Vector2d point =
                frame.Rotate(surface.points[r].cast<double>()) + frame.translation();
            result->landmark_of_return[r] = quadtree.LandmarkAt(
                grid_axes.RotateBack(point), point, laser, kMaxSigmas, result->landmarks);
          }
        }
      });
}

}  // namespace

LineLandmarkOptions LandmarkOptionsFor(const FactorOptions& factors,
                                       const AssociationOptions& association) {
  // Cells of 4 to 32 standard deviations at least: below 9, even a perfect wall fails the default
  // eigenvalue ratio of 0.15.
  constexpr double kLargestOverNoise = 32.0;
  LineLandmarkOptions options;
  options.max_eigenvalue_ratio = association.max_eigenvalue_ratio;
  options.noise = NoiseOf(factors);
  options.largest_m =
      std::max(association.landmark_size_m, kLargestOverNoise * options.noise.StandardDeviation());
  return options;
}

LineLandmarks CutIntoLandmarks(const SlamGraph& graph, const std::vector<double>& poses,
                               const MeasuredSurface& surface, const LineLandmarkOptions& options,
                               ThreadPool* pool) {
  SurfaceGrid grid;
  grid.cell_m = options.largest_m / kLargestOverFinest;
  grid.octant_yaw_rad = DominantDirection(graph, poses, surface, pool);
  grid.cell_yaw_rad = grid.octant_yaw_rad + kGridTurnRad;
  LineLandmarks result;
  const SurfaceCells cells = SortIntoCells(graph, poses, surface, grid, pool,
                                           &result.landmark_of_return, options.hold_out);
  Quadtree quadtree(cells, options);
  result.landmarks = quadtree.Cut(grid);
  constexpr std::size_t kReturnsPerChunk = 65536;
  pool->ForEachChunk(
      graph.num_returns(), kReturnsPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) {
          int& landmark = result.landmark_of_return[r];
          landmark = landmark == SurfaceCells::kNone ? LineLandmarks::kNone
                                                     : quadtree.LandmarkOfCell(landmark);
        }
      });
  AddReturnsWithoutNormal(graph, poses, surface, quadtree, grid, pool, &result);
  return result;
}

void AddLandmarkLines(const LineLandmarks& landmarks, std::vector<TangentLine>* lines) {
  for (std::size_t r = 0; r < lines->size(); ++r) {
    const int id = landmarks.landmark_of_return[r];
    if (id == LineLandmarks::kNone || Associations::HasLine((*lines)[r])) continue;
    const LineLandmark& landmark = landmarks.landmarks[id];
    const double offset = landmark.offset_m + landmark.normal.dot(landmark.origin);
    (*lines)[r] = {landmark.normal.x(), landmark.normal.y(), offset};
  }
}

}  // namespace plumbline
