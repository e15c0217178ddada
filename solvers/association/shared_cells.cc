#include "plumbline/solvers/association/shared_cells.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <unordered_set>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/pose_frame.h"

namespace plumbline {
namespace {

// A cell, as the process of this rank sees it.
struct Contribution {
  SurfaceCell cell;
  int rank = 0;
  int own_id = SurfaceCells::kNone;  // kNone: of a peer

  CellBlock block() const { return CellBlock::Of(cell.key.x, cell.key.y); }
};

// Blocks lie together, so that coarser tables number their cells alike, too.
bool ComesBefore(const Contribution& a, const Contribution& b) {
  const CellBlock block_a = a.block(), block_b = b.block();
  if (!(block_a == block_b)) return block_a < block_b;
  return std::tie(a.cell.key.x, a.cell.key.y, a.cell.key.octant, a.rank) <
         std::tie(b.cell.key.x, b.cell.key.y, b.cell.key.octant, b.rank);
}

struct CellBlockHash {
  std::size_t operator()(const CellBlock& block) const {
    const auto x = static_cast<std::uint64_t>(block.x), y = static_cast<std::uint64_t>(block.y);
    std::uint64_t hash = (x * 0x9e3779b97f4a7c15ULL) ^ (y * 0xc2b2ae3d27d4eb4fULL);
    hash = (hash ^ hash >> 29) * 0xbf58476d1ce4e5b9ULL;
    return hash >> 16;
  }
};

using CellBlockSet = std::unordered_set<CellBlock, CellBlockHash>;

// Where the returns end that are in no cell, for want of a normal.
void AddBlocksOfBareReturns(const SlamGraph& graph, const std::vector<double>& poses,
                            const MeasuredSurface& surface, const SurfaceGrid& grid,
                            const SurfaceCells& cells, CellBlockSet* blocks) {
  const double grid_pose[3] = {0.0, 0.0, grid.cell_yaw_rad};
  const PoseFrame grid_axes(grid_pose);
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& scan = graph.scan(s);
    const PoseFrame frame(&poses[3 * scan.pose]);
    const ScanReturns returns = graph.ReturnsOfScan(s);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (!surface.normals[r].IsNone() || graph.Moves(r)) continue;
      const Eigen::Vector2d in_grid = grid_axes.RotateBack(frame * returns.PointInRobot(r));
      const SurfaceCellKey key = cells.KeyOf(in_grid.x(), in_grid.y(), 0);
      blocks->insert(CellBlock::Of(key.x, key.y));
    }
  }
}

CellBlockSet WantedBlocks(const SlamGraph& graph, const std::vector<double>& poses,
                          const MeasuredSurface& surface, const SurfaceGrid& grid, CellReach reach,
                          const SurfaceCells& cells) {
  CellBlockSet wanted;
  for (std::size_t id = 0; id < cells.size(); ++id) {
    wanted.insert(CellBlock::Of(cells[id].key.x, cells[id].key.y));
  }
  if (reach == CellReach::kReturns) {
    AddBlocksOfBareReturns(graph, poses, surface, grid, cells, &wanted);
    return wanted;
  }
  const std::vector<CellBlock> own(wanted.begin(), wanted.end());
  for (const CellBlock& block : own) {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) wanted.insert({block.x + dx, block.y + dy});
    }
  }
  return wanted;
}

// Each block has one process that knows who wants it.
int RegistrarOf(const CellBlock& block, int num_ranks) {
  return static_cast<int>(CellBlockHash()(block) % static_cast<std::size_t>(num_ranks));
}

// That a process wants a block.
struct Wish {
  CellBlock block;
  int rank = 0;
};

SharedBlocks FindSharedBlocks(const Peers& peers, const CellBlockSet& wanted) {
  const int num_ranks = peers.size();
  std::vector<std::vector<CellBlock>> asked(num_ranks);
  for (const CellBlock& block : wanted) asked[RegistrarOf(block, num_ranks)].push_back(block);
  const std::vector<std::vector<CellBlock>> asked_here = ExchangeValues(peers, asked);
  std::map<CellBlock, std::vector<int>> ranks_of_block;
  for (int rank = 0; rank < num_ranks; ++rank) {
    for (const CellBlock& block : asked_here[rank]) ranks_of_block[block].push_back(rank);
  }
  std::vector<std::vector<Wish>> answers(num_ranks);
  for (const auto& [block, ranks] : ranks_of_block) {
    if (ranks.size() < 2) continue;
    for (const int to : ranks) {
      for (const int rank : ranks) answers[to].push_back({block, rank});
    }
  }
  SharedBlocks shared;
  for (const std::vector<Wish>& answer : ExchangeValues(peers, answers)) {
    for (const Wish& wish : answer) shared[wish.block].push_back(wish.rank);
  }
  return shared;
}

// new_id: becomes the new number of each of the cells.
void MergeCells(const Peers& peers, const SharedBlocks& shared, SurfaceCells* cells,
                std::vector<int>* new_id) {
  std::vector<Contribution> contributions;
  contributions.reserve(cells->size());
  std::vector<std::vector<SurfaceCell>> to_rank(peers.size());
  for (std::size_t id = 0; id < cells->size(); ++id) {
    contributions.push_back({(*cells)[id], peers.rank(), static_cast<int>(id)});
    const auto block = shared.find(contributions.back().block());
    if (block == shared.end()) continue;
    for (const int rank : block->second) {
      if (rank != peers.rank()) to_rank[rank].push_back((*cells)[id]);
    }
  }
  new_id->assign(cells->size(), SurfaceCells::kNone);
  *cells = SurfaceCells(cells->cell_m());  // its memory need not lie beside what arrives
  const std::vector<std::vector<SurfaceCell>> from_rank = ExchangeValues(peers, to_rank);
  for (int rank = 0; rank < peers.size(); ++rank) {
    for (const SurfaceCell& cell : from_rank[rank]) contributions.push_back({cell, rank});
  }
  std::sort(contributions.begin(), contributions.end(), ComesBefore);
  for (const Contribution& from : contributions) {
    const int id = cells->FindOrInsert(from.cell.key);
    (*cells)[id].Merge(from.cell);
    if (from.own_id != SurfaceCells::kNone) (*new_id)[from.own_id] = id;
  }
}

}  // namespace

SharedBlocks AddCellsOfPeers(const SlamGraph& graph, const std::vector<double>& poses,
                             const MeasuredSurface& surface, const SurfaceGrid& grid,
                             CellReach reach, SurfaceCells* cells,
                             std::vector<int>* cell_of_return) {
  if (graph.peers() == nullptr) return {};
  SharedBlocks shared =
      FindSharedBlocks(*graph.peers(), WantedBlocks(graph, poses, surface, grid, reach, *cells));
  std::vector<int> new_id;
  MergeCells(*graph.peers(), shared, cells, &new_id);
  for (int& cell : *cell_of_return) {
    if (cell != SurfaceCells::kNone) cell = new_id[cell];
  }
  return shared;
}

}  // namespace plumbline
