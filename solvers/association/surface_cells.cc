#include "plumbline/solvers/association/surface_cells.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/association/held_out_returns.h"

namespace plumbline {
namespace {

// The returns of a chunk of scans, in a table of their own.
class ChunkSorter {
 public:
  ChunkSorter(const SlamGraph& graph, const std::vector<double>& poses,
              const MeasuredSurface& surface, const SurfaceGrid& grid, bool hold_out,
              std::vector<int>* cell_of_return)
      : graph_(graph),
        poses_(poses),
        surface_(surface),
        grid_(grid),
        hold_out_(hold_out),
        cells_(grid.cell_m),
        cell_of_return_(*cell_of_return) {}

  void Sort(int scan_id) {
    const ScanEntry& scan = graph_.scan(scan_id);
    const Pose2 grid_from_robot =
        Pose2(0.0, 0.0, -grid_.cell_yaw_rad) * Pose2(&poses_[3 * scan.pose]);
    const double c = std::cos(grid_from_robot.yaw), s = std::sin(grid_from_robot.yaw);
    const double turns_to_octants =
        (poses_[3 * scan.pose + 2] - grid_.octant_yaw_rad) / (2.0 * kPi);
    const double turned = turns_to_octants - std::floor(turns_to_octants);
    const ScanReturns returns = graph_.ReturnsOfScan(scan_id);
    // Neighbouring beams mostly end in the same cell: it is looked up, and added to, once.
    SurfaceCellKey last_key;
    int last = SurfaceCells::kNone;
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    PointMoments moments;
    const auto add_to_last = [&] {
      if (last != SurfaceCells::kNone) cells_[last].Merge({moments, scan.pose, false});
    };
    const std::size_t first_held_out = HeldOutReturns::FirstOf(graph_, scan_id);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const bool counts =
          !hold_out_ || !HeldOutReturns::Contain(r - scan.first_return, first_held_out);
      const ReturnNormal normal = surface_.normals[r];
      if (normal.IsNone()) {
        cell_of_return_[r] = SurfaceCells::kNone;
        continue;
      }
      const Eigen::Vector2d z = returns.PointInRobot(r);
      const double x = c * z.x() - s * z.y() + grid_from_robot.x;
      const double y = s * z.x() + c * z.y() + grid_from_robot.y;
      const SurfaceCellKey key = cells_.KeyOf(x, y, OctantOf(normal.Turns() + turned));
      if (last == SurfaceCells::kNone || !(key == last_key)) {
        add_to_last();
        last = cells_.FindOrInsert(key);
        last_key = key;
        center = cells_.Center(key);
        moments = PointMoments();
      }
      cell_of_return_[r] = last;
      if (counts) moments.Add(x - center.x(), y - center.y());
    }
    add_to_last();
  }

  std::vector<SurfaceCell> TakeCells() { return std::move(cells_).Take(); }

 private:
  const SlamGraph& graph_;
  const std::vector<double>& poses_;
  const MeasuredSurface& surface_;
  const SurfaceGrid& grid_;
  const bool hold_out_;
  SurfaceCells cells_;
  std::vector<int>& cell_of_return_;
};

// So many are sorted before their tables become one: all tables of a long drive are many times that
// one.
constexpr std::size_t kScansAtOnce = 8192;

// In a table of their own: enough to be worth it, and few enough that all threads have their share.
std::size_t ScansPerBatch(std::size_t num_scans) {
  constexpr std::size_t kFewest = 32, kMost = 256, kBatches = 16;
  return std::clamp(num_scans / kBatches, kFewest, kMost);
}

// Gives each cell of a part its number among all cells.
std::vector<int> MergeInto(const std::vector<SurfaceCell>& part, SurfaceCells* cells) {
  std::vector<int> renamed;
  renamed.reserve(part.size());
  for (const SurfaceCell& cell : part) {
    const int id = cells->FindOrInsert(cell.key);
    (*cells)[id].Merge(cell);
    renamed.push_back(id);
  }
  return renamed;
}

}  // namespace

int SurfaceCells::FindOrInsert(const SurfaceCellKey& key) {
  const std::uint64_t square = PackedSquare(key.x, key.y);
  std::size_t slot = SlotOf(square);
  if (!slots_[slot].taken) {
    if (2 * (num_squares_ + 1) > slots_.size()) {
      Grow();
      slot = SlotOf(square);
    }
    slots_[slot].square = square;
    slots_[slot].taken = true;
    ++num_squares_;
  }
  int& cell = slots_[slot].cell_of_octant[key.octant];
  if (cell == kNone) {
    cell = static_cast<int>(cells_.size());
    cells_.emplace_back();
    cells_.back().key = key;
  }
  return cell;
}

void SurfaceCells::Grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  for (const Slot& slot : old) {
    if (slot.taken) slots_[SlotOf(slot.square)] = slot;
  }
}

double DominantDirection(const SlamGraph& graph, const std::vector<double>& poses,
                         const MeasuredSurface& surface, ThreadPool* pool) {
  // Some returns of each scan say as much of a direction as all of them.
  constexpr std::size_t kOneIn = 4;
  // The fourth power of a normal, as a complex number, is the same for all four directions.
  const std::size_t scans_per_batch = ScansPerBatch(graph.num_scans());
  std::vector<std::complex<double>> sums(ThreadPool::NumChunks(graph.num_scans(), scans_per_batch));
  pool->ForEachChunk(graph.num_scans(), scans_per_batch,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       std::complex<double> sum = 0.0;
                       for (std::size_t s = begin; s < end; ++s) {
                         const ScanEntry& scan = graph.scan(static_cast<int>(s));
                         double re = 0.0, im = 0.0;
                         for (std::size_t r = scan.first_return;
                              r < scan.first_return + scan.num_returns; r += kOneIn) {
                           const Eigen::Vector2d normal = surface.normals[r].Direction();
                           const double x = normal.x(), y = normal.y();
                           const double re2 = x * x - y * y, im2 = 2.0 * x * y;
                           re += re2 * re2 - im2 * im2;
                           im += 2.0 * re2 * im2;
                         }
                         const double yaw = poses[3 * scan.pose + 2];
                         sum += std::complex<double>(re, im) * std::polar(1.0, 4.0 * yaw);
                       }
                       sums[chunk] = sum;
                     });
  std::complex<double> own = 0.0;
  for (const std::complex<double>& sum : sums) own += sum;
  const std::complex<double> total(SumOverPeers(graph.peers(), own.real()),
                                   SumOverPeers(graph.peers(), own.imag()));
  return std::abs(total) > 0.0 ? 0.25 * std::arg(total) : 0.0;
}

SurfaceCells SortIntoCells(const SlamGraph& graph, const std::vector<double>& poses,
                           const MeasuredSurface& surface, const SurfaceGrid& grid,
                           ThreadPool* pool, std::vector<int>* cell_of_return, bool hold_out) {
  cell_of_return->resize(graph.num_returns());
  const std::size_t num_scans = graph.num_scans();
  const std::size_t scans_per_batch = ScansPerBatch(num_scans);
  SurfaceCells cells(grid.cell_m);
  for (std::size_t first = 0; first < num_scans; first += kScansAtOnce) {
    const std::size_t count = std::min(kScansAtOnce, num_scans - first);
    std::vector<std::vector<SurfaceCell>> parts(ThreadPool::NumChunks(count, scans_per_batch));
    pool->ForEachChunk(count, scans_per_batch,
                       [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                         ChunkSorter sorter(graph, poses, surface, grid, hold_out, cell_of_return);
                         for (std::size_t s = begin; s < end; ++s) {
                           sorter.Sort(static_cast<int>(first + s));
                         }
                         parts[chunk] = sorter.TakeCells();
                       });
    std::vector<std::vector<int>> renamed(parts.size());
    for (std::size_t chunk = 0; chunk < parts.size(); ++chunk) {
      renamed[chunk] = MergeInto(parts[chunk], &cells);
      parts[chunk] = std::vector<SurfaceCell>();
    }
    pool->ForEachChunk(
        count, scans_per_batch, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
          const ScanEntry& last_scan = graph.scan(static_cast<int>(first + end) - 1);
          const std::size_t last_return = last_scan.first_return + last_scan.num_returns;
          for (std::size_t r = graph.scan(static_cast<int>(first + begin)).first_return;
               r < last_return; ++r) {
            int& cell = (*cell_of_return)[r];
            if (cell != SurfaceCells::kNone) cell = renamed[chunk][cell];
          }
        });
  }
  return cells;
}

SurfaceCells Coarsened(SurfaceCells* fine) {
  SurfaceCells coarse(2.0 * fine->cell_m());
  for (std::size_t i = 0; i < fine->size(); ++i) {
    SurfaceCell& cell = (*fine)[i];
    // Arithmetic shift rounds towards minus infinity, like the floor that made the keys.
    const SurfaceCellKey key{cell.key.x >> 1, cell.key.y >> 1, cell.key.octant};
    cell.parent = coarse.FindOrInsert(key);
    const Eigen::Vector2d shift = fine->Center(cell.key) - coarse.Center(key);
    coarse[cell.parent].Merge(cell.Shifted(shift.x(), shift.y()));
  }
  return coarse;
}

}  // namespace plumbline
