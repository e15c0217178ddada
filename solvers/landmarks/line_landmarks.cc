#include "plumbline/solvers/landmarks/line_landmarks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/line_fit.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/shared_cells.h"
#include "plumbline/solvers/association/surface_cells.h"
#include "plumbline/solvers/landmarks/landmark_quadtree.h"

namespace plumbline {
namespace {

constexpr std::size_t kReturnsPerChunk = 16384;

SharedLandmarks LandmarksIn(const SharedBlocks& blocks,
                            const std::vector<LandmarkQuadtree::CellOfLandmark>& cells,
                            const Peers& peers) {
  static_assert(LandmarkQuadtree::kNumLevels - 1 <= CellBlock::kLog2Side);
  std::vector<std::vector<int>> of_rank(peers.size());
  for (std::size_t landmark = 0; landmark < cells.size(); ++landmark) {
    const LandmarkQuadtree::CellOfLandmark& cell = cells[landmark];
    const auto block = blocks.find(CellBlock::Of(cell.key.x, cell.key.y, cell.level));
    if (block == blocks.end()) continue;
    for (const int rank : block->second) {
      if (rank != peers.rank()) of_rank[rank].push_back(static_cast<int>(landmark));
    }
  }
  return {&peers, cells.size(), std::move(of_rank)};
}

// Far away or at a grazing angle, a return has too few neighbours for a normal of its own, but
// says as much of where the laser is as any other. One of what moves says nothing.
void AddReturnsWithoutNormal(const SlamGraph& graph, const std::vector<double>& poses,
                             const MeasuredSurface& surface, const LandmarkQuadtree& quadtree,
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
          const ScanReturns returns = graph.ReturnsOfScan(static_cast<int>(s));
          for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
            if (!surface.normals[r].IsNone() || graph.Moves(r)) continue;
            const PlacedBeam beam(returns, r, frame);
            result->landmark_of_return[r] = quadtree.LandmarkAt(
                grid_axes.RotateBack(beam.end), beam, kMaxSigmas, result->landmarks);
          }
        }
      });
}

}  // namespace

double LineLandmarkOptions::SquaredSigmasOff(const LineLandmark& line,
                                             const PlacedBeam& beam) const {
  if (line.normal.dot(beam.direction) >= 0.0) return std::numeric_limits<double>::infinity();
  const double variance =
      noise.surface_variance + noise.BeamVariance(beam.range_m, beam.direction, line.normal);
  return std::pow(line.Distance(beam.end), 2) / variance;
}

LineLandmarkOptions LandmarkOptionsFor(const FactorOptions& factors,
                                       const AssociationOptions& association) {
  // Cells of 4 to 32 standard deviations at least: below 9, even a perfect wall fails
  // kMaxEigenvalueRatio.
  constexpr double kLargestOverNoise = 32.0;
  LineLandmarkOptions options;
  options.noise = NoiseOf(factors);
  options.largest_m =
      std::max(association.landmark_size_m, kLargestOverNoise * options.noise.StandardDeviation());
  return options;
}

SurfaceGrid LandmarkGrid(double dominant_direction_rad, double largest_m) {
  // The cells are turned against the walls, by atan(1/2), so that none runs along an edge between
  // cells: noise would decide which side its returns belong to.
  constexpr double kTurnRad = 0.46364760900080615;
  return {LandmarkQuadtree::FinestCell(largest_m), dominant_direction_rad + kTurnRad,
          dominant_direction_rad};
}

LineLandmarks CutIntoLandmarks(const SlamGraph& graph, const std::vector<double>& poses,
                               const MeasuredSurface& surface, const LineLandmarkOptions& options,
                               ThreadPool* pool) {
  const SurfaceGrid grid =
      LandmarkGrid(DominantDirection(graph, poses, surface, pool), options.largest_m);
  LineLandmarks result;
  SurfaceCells cells = SortIntoCells(graph, poses, surface, grid, pool, &result.landmark_of_return,
                                     options.hold_out);
  const SharedBlocks shared_blocks = AddCellsOfPeers(
      graph, poses, surface, grid, CellReach::kReturns, &cells, &result.landmark_of_return);
  LandmarkQuadtree quadtree(cells, options);
  result.landmarks = quadtree.Cut(grid);
  if (graph.peers() != nullptr) {
    result.shared = LandmarksIn(shared_blocks, quadtree.cells_of_landmarks(), *graph.peers());
  }
  pool->ForEachChunk(
      graph.num_returns(), kReturnsPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) {
          int& landmark = result.landmark_of_return[r];
          landmark = landmark == SurfaceCells::kNone ? LineLandmarks::kNone
                                                     : quadtree.LandmarkOfCell(landmark);
        }
      });
  if (options.joins_without_normal) {
    AddReturnsWithoutNormal(graph, poses, surface, quadtree, grid, pool, &result);
  }
  return result;
}

void AddLandmarkLines(const LineLandmarks& landmarks, ThreadPool* pool, TangentLines* lines) {
  const int first = lines->num_lines();
  for (const LineLandmark& landmark : landmarks.landmarks) {
    const double offset = landmark.offset_m + landmark.normal.dot(landmark.origin);
    lines->Add({landmark.normal.x(), landmark.normal.y(), offset});
  }
  pool->ForEachChunk(lines->size(), kReturnsPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t r = begin; r < end; ++r) {
                         const int id = landmarks.landmark_of_return[r];
                         if (id != LineLandmarks::kNone && !lines->HasLine(r))
                           lines->Assign(r, first + id);
                       }
                     });
}

}  // namespace plumbline
