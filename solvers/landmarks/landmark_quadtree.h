#ifndef PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_QUADTREE_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_QUADTREE_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/solvers/association/surface_cells.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"

namespace plumbline {

/// Cuts the cells of a grid into landmarks. Per octant of the normals, cells of four sizes form
/// quadtrees: 0.1 m to 0.8 m by default, since shorter stretches of surface have no direction
/// beside a laser's noise. The trees do not see each other: what becomes of a cell of the largest
/// size depends on the returns in that cell alone.
class LandmarkQuadtree {
 public:
  static constexpr int kNumLevels = 4;
  /// Side of the smallest cells if that of the largest ones is this [m].
  static double FinestCell(double largest_m) { return largest_m / (1 << (kNumLevels - 1)); }

  /// Where a landmark comes from.
  struct CellOfLandmark {
    int level = 0;  ///< 0 for the smallest cells
    SurfaceCellKey key;
  };

  /// finest: of FinestCell(options.largest_m). Keeps a reference to the options.
  LandmarkQuadtree(const SurfaceCells& finest, const LineLandmarkOptions& options);

  /// Chooses for every cell between one line and the lines of its quarters; see CutIntoLandmarks.
  std::vector<LineLandmark> Cut(const SurfaceGrid& grid);

  /// After Cut: per landmark.
  const std::vector<CellOfLandmark>& cells_of_landmarks() const { return cells_of_landmarks_; }
  /// After Cut: the landmark of one of the smallest cells, LineLandmarks::kNone if it has none.
  int LandmarkOfCell(int finest) const { return landmark_of_cell_.front()[finest]; }

  /// The landmark that a return may lie on: its line faces the laser, and the return is at most
  /// max_sigmas off it. Of the smallest cell around the return that has any such landmark, the one
  /// that it is fewest sigmas off. in_grid: the end of the beam in the grid's axes.
  int LandmarkAt(const Eigen::Vector2d& in_grid, const PlacedBeam& beam, double max_sigmas,
                 const std::vector<LineLandmark>& landmarks) const;

 private:
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

  void ChooseFromBelow();
  Partition Choose(const SurfaceCell& cell, const Partition& quarters) const;
  static Partition Split(Partition quarters);
  bool SplitPays(const Partition& whole, const Partition& quarters) const;
  static LineLandmark MakeLandmark(const SurfaceCells& cells, std::size_t i,
                                   const SurfaceGrid& grid);

  const LineLandmarkOptions& options_;
  std::vector<SurfaceCells> levels_;                // from the finest
  std::vector<std::vector<Partition>> partitions_;  // of each cell of each level
  std::vector<std::vector<int>> landmark_of_cell_;  // the same
  std::vector<CellOfLandmark> cells_of_landmarks_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_QUADTREE_H_
