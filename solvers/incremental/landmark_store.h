#ifndef PLUMBLINE_SOLVERS_INCREMENTAL_LANDMARK_STORE_H_
#define PLUMBLINE_SOLVERS_INCREMENTAL_LANDMARK_STORE_H_

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/solvers/association/surface_cells.h"
#include "plumbline/solvers/landmarks/landmark_quadtree.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"

namespace plumbline {

/// What one pose saw of a landmark.
struct StoredObservation {
  LineObservation moments;
  /// Of the centroid from the line [m], when the returns were weighed.
  double weighed_distance_m = 0.0;
};

/// A line landmark with all that the poses saw of it.
struct StoredLandmark {
  LineLandmark line;
  std::vector<StoredObservation> observations;  ///< ascending by pose
};

/// The line landmarks of a map that grows, as CutIntoLandmarks would cut them, give or take. They
/// are kept from call to call: work is done where scans came or poses moved, and nowhere else.
///
/// The plane is divided into squares of the size of the largest landmark. A square is cut into
/// landmarks anew when half as many returns came or went as it had at the last cut, so that the
/// work per return does not grow with the map. Until then, new returns join the landmark of their
/// cell. A pose that moves takes its observations along, and the lines follow; its returns keep
/// their squares until Place puts them anew.
///
/// Arguments of the same name are the same everywhere: surface, of the graph; frames, per pose of
/// the graph, where it is now.
class LandmarkStore {
 public:
  /// options: hold_out does not matter, all returns count.
  explicit LandmarkStore(const LineLandmarkOptions& options) : options_(options) {}

  /// Takes in the scans that the graph has gained, without placing them. Poses with new scans have
  /// to be placed.
  void Extend(const SlamGraph& graph);

  /// Forgets all landmarks, and lays the squares along this direction, see DominantDirection.
  void Reset(double dominant_direction_rad);

  /// Whether the returns of a pose are in their squares, and where the pose was when they were put
  /// there.
  bool IsPlaced(int pose) const { return is_placed_[pose] != 0; }
  const PoseFrame& PlacedAt(int pose) const { return placed_at_[pose]; }
  /// The longest range of the pose's returns [m].
  double Reach(int pose) const { return reach_m_[pose]; }

  /// Puts the returns of poses into their squares, for the first time or anew, and cuts squares
  /// that have changed by half. Returns in these are weighed with `loss`; those of the poses placed
  /// are not, Weigh has to follow.
  void Place(const std::vector<int>& poses, const SlamGraph& graph, const MeasuredSurface& surface,
             const std::vector<PoseFrame>& frames, const GemanMcClure& loss, ThreadPool* pool);

  /// Sums up the returns of poses into their observations, see ReturnCompressor::Weigh.
  void Weigh(const std::vector<int>& poses, const SlamGraph& graph,
             const std::vector<PoseFrame>& frames, const GemanMcClure& loss, ThreadPool* pool);

  /// By id. Ids of landmarks that are no more have no observations.
  const std::vector<StoredLandmark>& landmarks() const { return landmarks_; }
  /// A fit does not know which side of its line was seen: the normal keeps the side that it has.
  void SetLine(int landmark, LineLandmark line) {
    if (line.normal.dot(landmarks_[landmark].line.normal) < 0.0) {
      line.normal = -line.normal;
      line.offset_m = -line.offset_m;
    }
    landmarks_[landmark].line = line;
  }
  /// The landmarks that a pose saw, ascending.
  const std::vector<int>& LandmarksOfPose(int pose) const { return landmarks_of_pose_[pose]; }
  /// Per return; LineLandmarks::kNone for those without.
  const std::vector<int>& landmark_of_return() const { return landmark_of_return_; }

 private:
  // A landmark and its cell, named within the square.
  struct CellEntry {
    int cell = 0;
    int landmark = 0;
  };
  struct Square {
    std::vector<std::uint32_t> returns;  // those of a pose side by side
    std::size_t num_at_cut = 0;          // of the returns
    std::size_t num_changes = 0;         // returns that came or went since
    bool is_listed = false;              // in changed_squares_
    std::vector<CellEntry> cells;        // ascending by cell
  };

  // The landmarks of some squares.
  struct CutPart {
    std::vector<LineLandmark> lines;
    std::vector<LandmarkQuadtree::CellOfLandmark> cells;
  };

  int SquareAt(const SurfaceCellKey& finest);
  Square* Change(int square);
  static std::vector<CellEntry>::const_iterator FirstFrom(const std::vector<CellEntry>& cells,
                                                          int cell);
  int LandmarkOfCell(const Square& square, const SurfaceCellKey& finest) const;
  int LandmarkNear(const Square& square, const SurfaceCellKey& finest,
                   const PlacedBeam& beam) const;
  void TakeOut(const std::vector<int>& poses, const SlamGraph& graph);
  void PutIn(int pose, const SlamGraph& graph, const MeasuredSurface& surface);
  std::vector<int> SquaresToCut();
  void Drop(const std::vector<int>& squares);
  CutPart Cut(const int* first_square, const int* end_square, const SlamGraph& graph,
              const MeasuredSurface& surface, const std::vector<PoseFrame>& frames);
  void CutAll(const std::vector<int>& squares, const SlamGraph& graph,
              const MeasuredSurface& surface, const std::vector<PoseFrame>& frames,
              ThreadPool* pool);
  void Observe(const std::vector<int>& squares, const SlamGraph& graph,
               const std::vector<PoseFrame>& frames, const GemanMcClure& loss);
  void ListObservations(int pose, const SlamGraph& graph);
  int NewLandmark(const LineLandmark& line);
  void Forget(int landmark, int pose);

  LineLandmarkOptions options_;
  SurfaceGrid grid_;
  std::vector<StoredLandmark> landmarks_;
  std::vector<int> free_landmarks_;  // ids to be used again
  std::vector<Square> squares_;
  std::unordered_map<std::uint64_t, int> square_at_;
  std::vector<int> changed_squares_;
  std::vector<int> landmark_of_return_;
  // Per pose.
  std::vector<std::vector<int>> scans_of_pose_, squares_of_pose_, landmarks_of_pose_;
  std::vector<char> is_placed_;
  std::vector<PoseFrame> placed_at_;
  std::vector<double> reach_m_;
  int num_scans_ = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INCREMENTAL_LANDMARK_STORE_H_
