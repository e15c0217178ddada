#include "plumbline/solvers/landmarks/landmark_quadtree.h"

#include <cmath>

#include "plumbline/core/angle.h"
#include "plumbline/core/line_fit.h"

namespace plumbline {
namespace {

// Fewest returns of a landmark.
constexpr int kMinPoints = 5;

}  // namespace

LandmarkQuadtree::LandmarkQuadtree(const SurfaceCells& finest, const LineLandmarkOptions& options)
    : options_(options) {
  levels_.push_back(finest);
  while (static_cast<int>(levels_.size()) < kNumLevels) {
    levels_.push_back(Coarsened(&levels_.back()));
  }
}

std::vector<LineLandmark> LandmarkQuadtree::Cut(const SurfaceGrid& grid) {
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
      cells_of_landmarks_.push_back({static_cast<int>(level), cells[i].key});
    }
  }
  return landmarks;
}

int LandmarkQuadtree::LandmarkAt(const Eigen::Vector2d& in_grid, const PlacedBeam& beam,
                                 double max_sigmas,
                                 const std::vector<LineLandmark>& landmarks) const {
  int best = LineLandmarks::kNone;
  double least_squared = max_sigmas * max_sigmas;
  const double largest_variance = options_.noise.LargestVariance(beam.range_m);
  for (std::size_t level = 0; best == LineLandmarks::kNone && level < levels_.size(); ++level) {
    const SurfaceCellKey key = levels_[level].KeyOf(in_grid.x(), in_grid.y(), 0);
    for (const int cell : levels_[level].Square(key.x, key.y)) {
      if (cell == SurfaceCells::kNone) continue;
      const int id = landmark_of_cell_[level][cell];
      if (id == LineLandmarks::kNone) continue;
      if (std::pow(landmarks[id].Distance(beam.end), 2) >= least_squared * largest_variance)
        continue;
      const double squared = options_.SquaredSigmasOff(landmarks[id], beam);
      if (squared >= least_squared) continue;
      best = id;
      least_squared = squared;
    }
  }
  return best;
}

// Chooses for every cell between one line and what its quarters chose.
void LandmarkQuadtree::ChooseFromBelow() {
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

LandmarkQuadtree::Partition LandmarkQuadtree::Choose(const SurfaceCell& cell,
                                                     const Partition& quarters) const {
  const PointMoments& moments = cell.moments;
  if (moments.weight < kMinPoints) return Split(quarters);
  const LineFit fit = FitLine(moments);
  if (fit.EigenvalueRatio() > kMaxEigenvalueRatio) return Split(quarters);
  const Partition whole{fit.smaller_eigenvalue * moments.weight, moments.weight, 1, true};
  return SplitPays(whole, quarters) ? Split(quarters) : whole;
}

LandmarkQuadtree::Partition LandmarkQuadtree::Split(Partition quarters) {
  quarters.whole = false;
  return quarters;
}

// Whether several lines explain the returns better than one: beyond what the additional
// parameters explain of mere noise (F test), and by enough to matter. Where poses are still
// wrong, dense returns make any wave significant.
bool LandmarkQuadtree::SplitPays(const Partition& whole, const Partition& quarters) const {
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

LineLandmark LandmarkQuadtree::MakeLandmark(const SurfaceCells& cells, std::size_t i,
                                            const SurfaceGrid& grid) {
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

}  // namespace plumbline
