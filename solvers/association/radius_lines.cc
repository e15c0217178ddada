// Tangent lines from all points within a radius, by way of a table of moments.
//
// The plane is cut into square cells of half the radius, and each cell by the octant that its
// points' normals fall into, so that the two faces of a wall and the two sides of a corner never
// mix. A cell's line is fitted to the moments of the disc of cells around it (5 x 5 without the
// corners) and of its own and the two neighbouring octants; all points of the cell share it. Where
// the disc holds too few points, or one scan only, the same is tried with twice the radius, and
// twice again.

#include <cmath>
#include <complex>
#include <cstdint>

#include "plumbline/core/line_fit.h"
#include "plumbline/solvers/association/associations.h"

namespace plumbline {
namespace {

constexpr int kNumLevels = 3;
constexpr int kNoEntry = -1;
// Keys hold 28 bits per cell coordinate and 3 of the octant: 13,000 km at cells of 0.1 m.
constexpr std::int64_t kCoordinateMask = (std::int64_t{1} << 28) - 1;

struct CellKey {
  std::int64_t x = 0, y = 0;
  int octant = 0;

  std::uint64_t Packed() const {
    return static_cast<std::uint64_t>((x & kCoordinateMask) << 31 | (y & kCoordinateMask) << 3 |
                                      octant);
  }
};

struct Entry {
  CellKey key;
  PointMoments moments;  // about the centre of the cell
  int scan = 0;          // one of the scans seen
  bool several_scans = false;
  int parent = kNoEntry;  // in the table of twice the radius
};

// Moments of the same points about an origin moved by (dx, dy).
PointMoments Shifted(const PointMoments& m, double dx, double dy) {
  PointMoments shifted = m;
  shifted.x += dx * m.weight;
  shifted.y += dy * m.weight;
  shifted.xx += 2.0 * dx * m.x + dx * dx * m.weight;
  shifted.xy += dx * m.y + dy * m.x + dx * dy * m.weight;
  shifted.yy += 2.0 * dy * m.y + dy * dy * m.weight;
  return shifted;
}

// Entries by key in an open-addressing hash table; entries are numbered in order of insertion,
// which makes every result independent of the hashing.
class MomentTable {
 public:
  explicit MomentTable(double cell_m) : cell_m_(cell_m), slots_(1024, kNoEntry) {}

  double cell_m() const { return cell_m_; }
  std::vector<Entry>& entries() { return entries_; }
  const std::vector<Entry>& entries() const { return entries_; }

  CellKey KeyOf(double x, double y, int octant) const {
    return {static_cast<std::int64_t>(std::floor(x / cell_m_)),
            static_cast<std::int64_t>(std::floor(y / cell_m_)), octant};
  }
  Eigen::Vector2d Center(const CellKey& key) const {
    return {(static_cast<double>(key.x) + 0.5) * cell_m_,
            (static_cast<double>(key.y) + 0.5) * cell_m_};
  }

  int Find(const CellKey& key) const { return slots_[SlotOf(key)]; }

  int FindOrInsert(const CellKey& key, int scan) {
    std::size_t slot = SlotOf(key);
    if (slots_[slot] == kNoEntry) {
      if (2 * (entries_.size() + 1) > slots_.size()) {
        Grow();
        slot = SlotOf(key);
      }
      slots_[slot] = static_cast<int>(entries_.size());
      entries_.emplace_back();
      entries_.back().key = key;
      entries_.back().scan = scan;
    }
    return slots_[slot];
  }

 private:
  std::size_t SlotOf(const CellKey& key) const {
    const std::uint64_t packed = key.Packed();
    std::uint64_t hash = packed * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 29;
    std::size_t slot = hash & (slots_.size() - 1);
    while (slots_[slot] != kNoEntry && entries_[slots_[slot]].key.Packed() != packed) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    return slot;
  }

  void Grow() {
    slots_.assign(4 * slots_.size(), kNoEntry);
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      slots_[SlotOf(entries_[i].key)] = static_cast<int>(i);
    }
  }

  double cell_m_;
  std::vector<Entry> entries_;
  std::vector<int> slots_;
};

// Octant of a direction; octant 0 is centred on the x axis.
int OctantOf(double x, double y) {
  constexpr double kTan22 = 0.41421356237309503;
  const double ax = std::abs(x), ay = std::abs(y);
  if (ay <= kTan22 * ax) return x >= 0.0 ? 0 : 4;
  if (ax <= kTan22 * ay) return y >= 0.0 ? 2 : 6;
  if (y >= 0.0) return x >= 0.0 ? 1 : 3;
  return x >= 0.0 ? 7 : 5;
}

// Calls body(return_id, world normal) for every return of scans [begin, end) that has a normal.
template <typename Body>
void ForEachNormal(const SlamGraph& graph, const std::vector<Eigen::Vector2f>& normals,
                   std::size_t begin, std::size_t end, const Body& body) {
  for (std::size_t s = begin; s < end; ++s) {
    const ScanEntry& scan = graph.scan(static_cast<int>(s));
    const double yaw = graph.WorldFromRobot(scan.pose).yaw;
    const double c = std::cos(yaw), sn = std::sin(yaw);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (normals[r].isZero()) continue;
      const double nx = normals[r].x(), ny = normals[r].y();
      body(r, Eigen::Vector2d(c * nx - sn * ny, sn * nx + c * ny));
    }
  }
}

constexpr std::size_t kScansPerChunk = 64;

// Direction [rad] that most walls are parallel or orthogonal to. Octants are centred on it: an
// edge between two octants that lay on the walls would tear each wall in two.
double DominantDirection(const SlamGraph& graph, const std::vector<Eigen::Vector2f>& normals,
                         ThreadPool* pool) {
  std::vector<std::complex<double>> sums(ThreadPool::NumChunks(graph.num_scans(), kScansPerChunk));
  pool->ForEachChunk(graph.num_scans(), kScansPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       std::complex<double> sum = 0.0;
                       ForEachNormal(graph, normals, begin, end,
                                     [&](std::size_t, const Eigen::Vector2d& n) {
                                       const std::complex<double> z(n.x(), n.y());
                                       sum += (z * z) * (z * z);
                                     });
                       sums[chunk] = sum;
                     });
  std::complex<double> total = 0.0;
  for (const std::complex<double>& sum : sums) total += sum;
  return std::abs(total) > 0.0 ? 0.25 * std::arg(total) : 0.0;
}

// Sorts all points into a table; entry_of_return: kNoEntry for a return without normal.
MomentTable FillTable(const SlamGraph& graph, const std::vector<Eigen::Vector2f>& normals,
                      double cell_m, double dominant_rad, ThreadPool* pool,
                      std::vector<int>* entry_of_return) {
  constexpr signed char kNone = -1;
  std::vector<signed char> octants(graph.num_returns(), kNone);
  const double c = std::cos(dominant_rad), s = std::sin(dominant_rad);
  pool->ForEachChunk(
      graph.num_scans(), kScansPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        ForEachNormal(graph, normals, begin, end, [&](std::size_t r, const Eigen::Vector2d& n) {
          octants[r] =
              static_cast<signed char>(OctantOf(c * n.x() + s * n.y(), -s * n.x() + c * n.y()));
        });
      });
  MomentTable table(cell_m);
  const std::vector<double>& points = graph.points();
  entry_of_return->assign(graph.num_returns(), kNoEntry);
  for (std::size_t r = 0; r < graph.num_returns(); ++r) {
    if (octants[r] == kNone) continue;
    const CellKey key = table.KeyOf(points[2 * r], points[2 * r + 1], octants[r]);
    const int scan = graph.returns().scan[r];
    const int id = table.FindOrInsert(key, scan);
    Entry& entry = table.entries()[id];
    const Eigen::Vector2d center = table.Center(key);
    entry.moments.Add(points[2 * r] - center.x(), points[2 * r + 1] - center.y());
    entry.several_scans = entry.several_scans || entry.scan != scan;
    (*entry_of_return)[r] = id;
  }
  return table;
}

// The table of twice the cell size, by joining 2 x 2 cells; links every entry to its parent.
MomentTable Coarsened(MomentTable* fine) {
  MomentTable coarse(2.0 * fine->cell_m());
  for (Entry& entry : fine->entries()) {
    // Arithmetic shift rounds towards minus infinity, like the floor that made the keys.
    const CellKey key{entry.key.x >> 1, entry.key.y >> 1, entry.key.octant};
    entry.parent = coarse.FindOrInsert(key, entry.scan);
    Entry& parent = coarse.entries()[entry.parent];
    const Eigen::Vector2d shift = fine->Center(entry.key) - coarse.Center(key);
    parent.moments += Shifted(entry.moments, shift.x(), shift.y());
    parent.several_scans = parent.several_scans || entry.several_scans || parent.scan != entry.scan;
  }
  return coarse;
}

enum class Verdict { kLine, kNotALine, kTooSparse };

// Fits the line of one entry to the disc of cells around it.
Verdict FitEntry(const MomentTable& table, const Entry& entry, const AssociationOptions& options,
                 TangentLine* line) {
  PointMoments sum;
  int scan = entry.scan;
  bool several_scans = entry.several_scans;
  for (int dx = -2; dx <= 2; ++dx) {
    for (int dy = -2; dy <= 2; ++dy) {
      if (std::abs(dx * dy) == 4) continue;
      for (int turn = -1; turn <= 1; ++turn) {
        const int id =
            table.Find({entry.key.x + dx, entry.key.y + dy, (entry.key.octant + turn) & 7});
        if (id == kNoEntry) continue;
        const Entry& other = table.entries()[id];
        sum += Shifted(other.moments, dx * table.cell_m(), dy * table.cell_m());
        several_scans = several_scans || other.several_scans || other.scan != scan;
      }
    }
  }
  if (sum.weight < options.min_points || !several_scans) return Verdict::kTooSparse;
  const LineFit fit = FitLine(sum);
  if (fit.EigenvalueRatio() > options.max_eigenvalue_ratio) return Verdict::kNotALine;
  const Eigen::Vector2d centroid = table.Center(entry.key) + fit.centroid;
  *line = {fit.normal.x(), fit.normal.y(), fit.normal.dot(centroid)};
  return Verdict::kLine;
}

// The line of an entry of the finest table, at the first radius that is not too sparse.
TangentLine LineOfEntry(const std::vector<MomentTable>& tables, int id,
                        const AssociationOptions& options) {
  TangentLine line{0.0, 0.0, 0.0};
  for (const MomentTable& table : tables) {
    const Entry& entry = table.entries()[id];
    if (FitEntry(table, entry, options, &line) != Verdict::kTooSparse) break;
    id = entry.parent;
  }
  return line;
}

}  // namespace

std::vector<TangentLine> LinesFromRadius(const SlamGraph& graph,
                                         const std::vector<Eigen::Vector2f>& normals,
                                         const AssociationOptions& options, double radius_m,
                                         ThreadPool* pool) {
  const double dominant_rad = DominantDirection(graph, normals, pool);
  std::vector<int> entry_of_return;
  std::vector<MomentTable> tables;
  tables.push_back(FillTable(graph, normals, 0.5 * radius_m, dominant_rad, pool, &entry_of_return));
  while (static_cast<int>(tables.size()) < kNumLevels) tables.push_back(Coarsened(&tables.back()));

  std::vector<TangentLine> line_of_entry(tables.front().entries().size());
  constexpr std::size_t kEntriesPerChunk = 1024;
  pool->ForEachChunk(line_of_entry.size(), kEntriesPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t id = begin; id < end; ++id) {
                         line_of_entry[id] = LineOfEntry(tables, static_cast<int>(id), options);
                       }
                     });
  std::vector<TangentLine> lines(graph.num_returns(), TangentLine{0.0, 0.0, 0.0});
  for (std::size_t r = 0; r < lines.size(); ++r) {
    if (entry_of_return[r] != kNoEntry) lines[r] = line_of_entry[entry_of_return[r]];
  }
  return lines;
}

}  // namespace plumbline
