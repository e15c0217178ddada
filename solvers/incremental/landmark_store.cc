#include "plumbline/solvers/incremental/landmark_store.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/line_fit.h"
#include "plumbline/core/sort_unique.h"
#include "plumbline/solvers/landmarks/return_residual.h"

namespace plumbline {
namespace {

constexpr int kCellsPerSide = 1 << (LandmarkQuadtree::kNumLevels - 1);  // of a square
constexpr int kNumOctants = 8;

// A square is cut again when this share of its returns has come or gone since the last cut.
constexpr double kChangedShare = 0.5;

// A return without a normal joins a line at most this far off it.
constexpr double kMaxSigmas = 3.0;

// A pose in the axes of a grid, where directions of surfaces count from other axes than places.
struct GridFrame {
  PoseFrame in_cells;
  double turned_to_octants;  // a share of a full turn, at least 0

  GridFrame(const PoseFrame& frame, const SurfaceGrid& grid)
      : in_cells(TurnedBack(frame, grid.cell_yaw_rad)) {
    const PoseFrame in_octants = TurnedBack(frame, grid.octant_yaw_rad);
    turned_to_octants = std::atan2(in_octants.s, in_octants.c) / (2.0 * kPi) + 1.0;
  }

  Eigen::Vector2d Place(const Eigen::Vector2d& point) const { return in_cells * point; }
  // 0 for a return without a normal.
  int Octant(const ReturnNormal& normal) const {
    return normal.IsNone() ? 0 : OctantOf(normal.Turns() + turned_to_octants);
  }

 private:
  static PoseFrame TurnedBack(const PoseFrame& frame, double yaw_rad) {
    const PoseFrame axes(Pose2(0.0, 0.0, yaw_rad));
    const Eigen::Vector2d translation = axes.RotateBack(frame.translation());
    const Eigen::Vector2d heading = axes.RotateBack({frame.c, frame.s});
    PoseFrame turned;
    turned.x = translation.x();
    turned.y = translation.y();
    turned.c = heading.x();
    turned.s = heading.y();
    return turned;
  }
};

std::uint64_t Packed(std::int64_t x, std::int64_t y) {
  return static_cast<std::uint64_t>(x) << 32 | (static_cast<std::uint64_t>(y) & 0xffffffffu);
}

// The name of a cell of some level within its square; those of its octants follow each other.
int CellWithin(const SurfaceCellKey& key, int level) {
  const int mask = (kCellsPerSide >> level) - 1;
  const int x = static_cast<int>(key.x & mask), y = static_cast<int>(key.y & mask);
  return ((level * kCellsPerSide + x) * kCellsPerSide + y) * kNumOctants + key.octant;
}

SurfaceCellKey AtLevel(const SurfaceCellKey& finest, int level) {
  return {finest.x >> level, finest.y >> level, finest.octant};
}

bool ComesBefore(const StoredObservation& observation, int pose) {
  return observation.moments.pose < pose;
}

StoredObservation* ObservationBy(int pose, std::vector<StoredObservation>* observations) {
  return &*std::lower_bound(observations->begin(), observations->end(), pose, ComesBefore);
}

// The returns that one pose saw of one landmark, as they are summed up.
struct Sighting {
  int landmark;
  LineInRobot line;
  PointMoments moments;

  void Add(const ScanReturns& returns, std::size_t return_id, const SurfaceNoise& noise,
           const GemanMcClure& loss) {
    const ReturnResidual residual(returns, return_id, line, noise);
    moments.Add(residual.x, residual.y,
                loss.Term(residual.distance, residual.variance).information);
  }
  void Take(StoredObservation* observation) const {
    SetMoments(moments, &observation->moments);
    observation->weighed_distance_m =
        line.normal.dot(observation->moments.centroid()) + line.offset;
  }
};

}  // namespace

void LandmarkStore::Extend(const SlamGraph& graph) {
  const std::size_t num_poses = graph.num_poses();
  scans_of_pose_.resize(num_poses);
  squares_of_pose_.resize(num_poses);
  landmarks_of_pose_.resize(num_poses);
  is_placed_.resize(num_poses, false);
  placed_at_.resize(num_poses);
  reach_m_.resize(num_poses, 0.0);
  landmark_of_return_.resize(graph.num_returns(), LineLandmarks::kNone);
  for (; num_scans_ < graph.num_scans(); ++num_scans_) {
    const ScanEntry& scan = graph.scan(num_scans_);
    if (is_placed_[scan.pose]) TakeOut({scan.pose}, graph);
    scans_of_pose_[scan.pose].push_back(num_scans_);
    const auto first = graph.returns().range_m.begin() + scan.first_return;
    const double laser_m = graph.LaserOfScan(num_scans_).robot_from_laser.translation().norm();
    for (auto range_m = first; range_m != first + scan.num_returns; ++range_m) {
      reach_m_[scan.pose] = std::max(reach_m_[scan.pose], *range_m + laser_m);
    }
  }
}

void LandmarkStore::Reset(double dominant_direction_rad) {
  grid_ = LandmarkGrid(dominant_direction_rad, options_.largest_m);
  landmarks_.clear();
  free_landmarks_.clear();
  squares_.clear();
  square_at_.clear();
  changed_squares_.clear();
  std::fill(landmark_of_return_.begin(), landmark_of_return_.end(), int{LineLandmarks::kNone});
  std::fill(is_placed_.begin(), is_placed_.end(), false);
  for (std::size_t pose = 0; pose < scans_of_pose_.size(); ++pose) {
    squares_of_pose_[pose].clear();
    landmarks_of_pose_[pose].clear();
  }
}

int LandmarkStore::SquareAt(const SurfaceCellKey& finest) {
  constexpr int kShift = LandmarkQuadtree::kNumLevels - 1;
  const auto [entry, is_new] = square_at_.emplace(Packed(finest.x >> kShift, finest.y >> kShift),
                                                  static_cast<int>(squares_.size()));
  if (is_new) squares_.emplace_back();
  return entry->second;
}

LandmarkStore::Square* LandmarkStore::Change(int square) {
  if (!std::exchange(squares_[square].is_listed, true)) changed_squares_.push_back(square);
  return &squares_[square];
}

// The first entry of this cell, or of one after it.
std::vector<LandmarkStore::CellEntry>::const_iterator LandmarkStore::FirstFrom(
    const std::vector<CellEntry>& cells, int cell) {
  return std::lower_bound(cells.begin(), cells.end(), cell,
                          [](const CellEntry& e, int sought) { return e.cell < sought; });
}

int LandmarkStore::LandmarkOfCell(const Square& square, const SurfaceCellKey& finest) const {
  for (int level = 0; level < LandmarkQuadtree::kNumLevels; ++level) {
    const int cell = CellWithin(AtLevel(finest, level), level);
    const auto entry = FirstFrom(square.cells, cell);
    if (entry != square.cells.end() && entry->cell == cell) return entry->landmark;
  }
  return LineLandmarks::kNone;
}

// As LandmarkQuadtree::LandmarkAt, for squares that are not being cut.
int LandmarkStore::LandmarkNear(const Square& square, const SurfaceCellKey& finest,
                                const PlacedBeam& beam) const {
  int best = LineLandmarks::kNone;
  double least_squared = kMaxSigmas * kMaxSigmas;
  for (int level = 0; level < LandmarkQuadtree::kNumLevels; ++level) {
    if (best != LineLandmarks::kNone) break;
    const int first = CellWithin({finest.x >> level, finest.y >> level, 0}, level);
    auto entry = FirstFrom(square.cells, first);
    for (; entry != square.cells.end() && entry->cell < first + kNumOctants; ++entry) {
      const double squared = options_.SquaredSigmasOff(landmarks_[entry->landmark].line, beam);
      if (squared >= least_squared) continue;
      best = entry->landmark;
      least_squared = squared;
    }
  }
  return best;
}

void LandmarkStore::Place(const std::vector<int>& poses, const SlamGraph& graph,
                          const MeasuredSurface& surface, const std::vector<PoseFrame>& frames,
                          const GemanMcClure& loss, ThreadPool* pool) {
  TakeOut(poses, graph);
  for (const int pose : poses) {
    placed_at_[pose] = frames[pose];
    is_placed_[pose] = true;
    PutIn(pose, graph, surface);
  }
  const std::vector<int> squares = SquaresToCut();
  Drop(squares);
  CutAll(squares, graph, surface, frames, pool);
  Observe(squares, graph, frames, loss);
  for (const int pose : poses) ListObservations(pose, graph);
}

void LandmarkStore::Forget(int landmark, int pose) {
  std::vector<StoredObservation>& observations = landmarks_[landmark].observations;
  observations.erase(observations.begin() +
                     (ObservationBy(pose, &observations) - observations.data()));
}

void LandmarkStore::TakeOut(const std::vector<int>& poses, const SlamGraph& graph) {
  std::vector<int> squares;
  std::vector<char> is_taken(scans_of_pose_.size(), false);
  for (const int pose : poses) {
    squares.insert(squares.end(), squares_of_pose_[pose].begin(), squares_of_pose_[pose].end());
    squares_of_pose_[pose].clear();
    for (const int landmark : landmarks_of_pose_[pose]) Forget(landmark, pose);
    landmarks_of_pose_[pose].clear();
    is_taken[pose] = true;
    is_placed_[pose] = false;
  }
  SortUnique(&squares);
  // A square is gone through once, however many of the poses it has returns of.
  for (const int id : squares) {
    Square& square = *Change(id);
    const auto kept = std::remove_if(
        square.returns.begin(), square.returns.end(),
        [&](std::uint32_t r) { return is_taken[graph.scan(graph.ScanOfReturn(r)).pose]; });
    square.num_changes += square.returns.end() - kept;
    square.returns.erase(kept, square.returns.end());
  }
}

void LandmarkStore::PutIn(int pose, const SlamGraph& graph, const MeasuredSurface& surface) {
  const GridFrame frame(placed_at_[pose], grid_);
  const SurfaceCells keys(grid_.cell_m);
  SurfaceCellKey last_key;
  int square = -1, landmark = LineLandmarks::kNone;
  std::vector<int>& squares = squares_of_pose_[pose];
  for (const int s : scans_of_pose_[pose]) {
    const ScanEntry& scan = graph.scan(s);
    const ScanReturns returns = graph.ReturnsOfScan(s);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (graph.Moves(r)) {
        landmark_of_return_[r] = LineLandmarks::kNone;
        continue;
      }
      const ReturnNormal normal = surface.normals[r];
      const Eigen::Vector2d point = returns.PointInRobot(r);
      const Eigen::Vector2d in_grid = frame.Place(point);
      const SurfaceCellKey key = keys.KeyOf(in_grid.x(), in_grid.y(), frame.Octant(normal));
      // Neighbouring beams mostly end in the same cell, which saves looking it up.
      if (square < 0 || !(key == last_key)) {
        square = SquareAt(key);
        landmark = LandmarkOfCell(squares_[square], key);
        last_key = key;
        squares.push_back(square);
        Change(square);
      }
      squares_[square].returns.push_back(static_cast<std::uint32_t>(r));
      ++squares_[square].num_changes;
      landmark_of_return_[r] =
          normal.IsNone()
              ? LandmarkNear(squares_[square], key, PlacedBeam(returns, r, placed_at_[pose]))
              : landmark;
    }
  }
  SortUnique(&squares);
}

std::vector<int> LandmarkStore::SquaresToCut() {
  std::vector<int> to_cut;
  for (const int id : std::exchange(changed_squares_, {})) {
    Square& square = squares_[id];
    square.is_listed = false;
    const double limit = kChangedShare * static_cast<double>(square.num_at_cut);
    if (static_cast<double>(square.num_changes) >= limit) to_cut.push_back(id);
  }
  return to_cut;
}

void LandmarkStore::Drop(const std::vector<int>& squares) {
  std::vector<int> poses;
  std::vector<char> is_dropped(landmarks_.size(), false);
  for (const int id : squares) {
    for (const CellEntry& entry : squares_[id].cells) {
      std::vector<StoredObservation>& observations = landmarks_[entry.landmark].observations;
      for (const StoredObservation& o : observations) poses.push_back(o.moments.pose);
      observations.clear();
      is_dropped[entry.landmark] = true;
      free_landmarks_.push_back(entry.landmark);
    }
    squares_[id].cells.clear();
  }
  SortUnique(&poses);
  for (const int pose : poses) {
    std::vector<int>& seen = landmarks_of_pose_[pose];
    seen.erase(std::remove_if(seen.begin(), seen.end(), [&](int id) { return is_dropped[id]; }),
               seen.end());
  }
}

int LandmarkStore::NewLandmark(const LineLandmark& line) {
  if (free_landmarks_.empty()) {
    free_landmarks_.push_back(static_cast<int>(landmarks_.size()));
    landmarks_.emplace_back();
  }
  const int id = free_landmarks_.back();
  free_landmarks_.pop_back();
  landmarks_[id].line = line;
  return id;
}

// Gives the squares' returns their landmarks, which are numbered within the part of the squares.
// Returns are in the cells where they were placed, and count there as they lie now.
LandmarkStore::CutPart LandmarkStore::Cut(const int* first_square, const int* end_square,
                                          const SlamGraph& graph, const MeasuredSurface& surface,
                                          const std::vector<PoseFrame>& frames) {
  SurfaceCells cells(grid_.cell_m);
  std::vector<int> cell_of_return;
  // Calls body(return, its point, scan, its pose where it was placed, and where it is now).
  const auto for_each_return = [&](const auto& body) {
    for (const int* id = first_square; id != end_square; ++id) {
      int pose = -1;
      GridFrame placed(PoseFrame(), grid_), now = placed;
      for (const std::uint32_t r : squares_[*id].returns) {
        const int scan = graph.ScanOfReturn(r);
        if (graph.scan(scan).pose != pose) {
          pose = graph.scan(scan).pose;
          placed = GridFrame(placed_at_[pose], grid_);
          now = GridFrame(frames[pose], grid_);
        }
        body(r, graph.ReturnsOfScan(scan).PointInRobot(r), scan, placed, now);
      }
    }
  };
  for_each_return([&](std::uint32_t r, const Eigen::Vector2d& in_robot, int scan,
                      const GridFrame& placed, const GridFrame& now) {
    const ReturnNormal normal = surface.normals[r];
    if (normal.IsNone()) {
      cell_of_return.push_back(SurfaceCells::kNone);
      return;
    }
    const Eigen::Vector2d at = placed.Place(in_robot);
    const SurfaceCellKey key = cells.KeyOf(at.x(), at.y(), placed.Octant(normal));
    const int cell = cells.FindOrInsert(key);
    const Eigen::Vector2d point = now.Place(in_robot) - cells.Center(key);
    PointMoments moments;
    moments.Add(point.x(), point.y());
    cells[cell].Merge({moments, graph.scan(scan).pose, false});
    cell_of_return.push_back(cell);
  });

  LandmarkQuadtree quadtree(cells, options_);
  CutPart part;
  part.lines = quadtree.Cut(grid_);
  part.cells = quadtree.cells_of_landmarks();
  auto cell = cell_of_return.begin();
  for_each_return([&](std::uint32_t r, const Eigen::Vector2d& in_robot, int scan,
                      const GridFrame& placed, const GridFrame&) {
    if (*cell != SurfaceCells::kNone) {
      landmark_of_return_[r] = quadtree.LandmarkOfCell(*cell);
    } else {
      const PoseFrame& frame = frames[graph.scan(scan).pose];
      landmark_of_return_[r] = quadtree.LandmarkAt(placed.Place(in_robot),
                                                   PlacedBeam(graph.ReturnsOfScan(scan), r, frame),
                                                   kMaxSigmas, part.lines);
    }
    ++cell;
  });
  return part;
}

// Squares do not see each other, so that parts of them can be cut side by side.
void LandmarkStore::CutAll(const std::vector<int>& squares, const SlamGraph& graph,
                           const MeasuredSurface& surface, const std::vector<PoseFrame>& frames,
                           ThreadPool* pool) {
  constexpr std::size_t kSquaresPerChunk = 16;
  std::vector<CutPart> parts(ThreadPool::NumChunks(squares.size(), kSquaresPerChunk));
  pool->ForEachChunk(
      squares.size(), kSquaresPerChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        parts[chunk] = Cut(squares.data() + begin, squares.data() + end, graph, surface, frames);
      });
  for (std::size_t chunk = 0; chunk < parts.size(); ++chunk) {
    const CutPart& part = parts[chunk];
    std::vector<int> ids;
    for (std::size_t i = 0; i < part.lines.size(); ++i) {
      const auto& [level, key] = part.cells[i];
      ids.push_back(NewLandmark(part.lines[i]));
      const int scale = 1 << level;  // no shift: coordinates may be negative
      Square& square = squares_[SquareAt({key.x * scale, key.y * scale, key.octant})];
      square.cells.push_back({CellWithin(key, level), ids.back()});
    }
    const std::size_t begin = chunk * kSquaresPerChunk;
    const std::size_t end = std::min(begin + kSquaresPerChunk, squares.size());
    for (std::size_t i = begin; i < end; ++i) {
      Square& square = squares_[squares[i]];
      for (const std::uint32_t r : square.returns) {
        int& landmark = landmark_of_return_[r];
        if (landmark != LineLandmarks::kNone) landmark = ids[landmark];
      }
      square.num_at_cut = square.returns.size();
      square.num_changes = 0;
      std::sort(square.cells.begin(), square.cells.end(),
                [](const CellEntry& a, const CellEntry& b) { return a.cell < b.cell; });
    }
  }
}

// Sums up the returns of squares into observations of their new landmarks.
void LandmarkStore::Observe(const std::vector<int>& squares, const SlamGraph& graph,
                            const std::vector<PoseFrame>& frames, const GemanMcClure& loss) {
  std::vector<Sighting> sightings;  // of one pose
  const auto take = [&](int pose) {
    for (const Sighting& sighting : sightings) {
      StoredObservation observation;
      observation.moments.pose = pose;
      observation.moments.landmark = sighting.landmark;
      sighting.Take(&observation);
      landmarks_[sighting.landmark].observations.push_back(observation);
      std::vector<int>& seen = landmarks_of_pose_[pose];
      seen.insert(std::lower_bound(seen.begin(), seen.end(), sighting.landmark), sighting.landmark);
    }
    sightings.clear();
  };
  for (const int id : squares) {
    int pose = -1;
    for (const std::uint32_t r : squares_[id].returns) {
      const int landmark = landmark_of_return_[r];
      if (landmark == LineLandmarks::kNone) continue;
      const int scan = graph.ScanOfReturn(r);
      if (graph.scan(scan).pose != pose) {
        take(pose);
        pose = graph.scan(scan).pose;
      }
      auto sighting = std::find_if(sightings.begin(), sightings.end(),
                                   [&](const Sighting& s) { return s.landmark == landmark; });
      if (sighting == sightings.end()) {
        const LineInRobot line(landmarks_[landmark].line, frames[pose]);
        sighting = sightings.insert(sightings.end(), {landmark, line, PointMoments()});
      }
      sighting->Add(graph.ReturnsOfScan(scan), r, options_.noise, loss);
    }
    take(pose);
    for (const CellEntry& entry : squares_[id].cells) {
      std::vector<StoredObservation>& observations = landmarks_[entry.landmark].observations;
      std::sort(observations.begin(), observations.end(),
                [](const StoredObservation& a, const StoredObservation& b) {
                  return a.moments.pose < b.moments.pose;
                });
    }
  }
}

// Adds the observations that the pose's returns make of landmarks that were there before.
void LandmarkStore::ListObservations(int pose, const SlamGraph& graph) {
  std::vector<int> seen;
  for (const int s : scans_of_pose_[pose]) {
    const ScanEntry& scan = graph.scan(s);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const int landmark = landmark_of_return_[r];
      if (landmark == LineLandmarks::kNone) continue;
      if (seen.empty() || seen.back() != landmark) seen.push_back(landmark);
    }
  }
  SortUnique(&seen);
  for (const int landmark : seen) {
    std::vector<StoredObservation>& observations = landmarks_[landmark].observations;
    const auto at = std::lower_bound(observations.begin(), observations.end(), pose, ComesBefore);
    if (at != observations.end() && at->moments.pose == pose) continue;
    StoredObservation observation;
    observation.moments.pose = pose;
    observation.moments.landmark = landmark;
    observations.insert(at, observation);
  }
  landmarks_of_pose_[pose] = std::move(seen);
}

void LandmarkStore::Weigh(const std::vector<int>& poses, const SlamGraph& graph,
                          const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                          ThreadPool* pool) {
  constexpr std::size_t kPosesPerChunk = 16;
  pool->ForEachChunk(
      poses.size(), kPosesPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        std::vector<Sighting> sightings;
        for (std::size_t i = begin; i < end; ++i) {
          const int pose = poses[i];
          const std::vector<int>& seen = landmarks_of_pose_[pose];
          sightings.clear();
          for (const int landmark : seen) {
            const LineInRobot line(landmarks_[landmark].line, frames[pose]);
            sightings.push_back({landmark, line, PointMoments()});
          }
          for (const int s : scans_of_pose_[pose]) {
            const ScanEntry& scan = graph.scan(s);
            const ScanReturns returns = graph.ReturnsOfScan(s);
            int last = LineLandmarks::kNone;
            Sighting* sighting = nullptr;
            for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
              const int landmark = landmark_of_return_[r];
              if (landmark == LineLandmarks::kNone) continue;
              // Neighbouring beams mostly meet the same landmark.
              if (landmark != std::exchange(last, landmark)) {
                const auto at = std::lower_bound(seen.begin(), seen.end(), landmark);
                sighting = &sightings[at - seen.begin()];
              }
              sighting->Add(returns, r, options_.noise, loss);
            }
          }
          for (const Sighting& sighting : sightings) {
            sighting.Take(ObservationBy(pose, &landmarks_[sighting.landmark].observations));
          }
        }
      });
}

}  // namespace plumbline
