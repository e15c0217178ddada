#ifndef PLUMBLINE_SOLVERS_FRONT_END_SCAN_SURFACES_H_
#define PLUMBLINE_SOLVERS_FRONT_END_SCAN_SURFACES_H_

#include <memory>
#include <utility>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

/// Surface points of the scans of a drive, each in the frame of its robot and thinned to
/// kPointSpacingM, and the free space before them. Points of keyframes, which are read again and
/// again, are kept; those of other scans, which would be the largest array of a long drive, are
/// made on demand.
///
/// Scans go by their ids among all. Of a graph with peers it knows the scans of the graph and those
/// that With has fetched; its construction is collective then. Copies cost little, and share the
/// kept points.
class ScanSurfaces {
 public:
  /// Refers to both. kept: per scan, empty for those that are not kept; without, keeps none yet.
  ScanSurfaces(const SlamGraph& graph, const MeasuredSurface& measured,
               std::vector<PackedSurface> kept = {})
      : ScanSurfaces(&graph, &measured, std::move(kept)) {}
  /// Refers to the graph. all: one per scan; there are no others.
  ScanSurfaces(const SlamGraph& graph, std::vector<PackedSurface> all)
      : ScanSurfaces(&graph, nullptr, std::move(all)) {}

  const SlamGraph& graph() const { return *graph_; }
  /// The scan of each pose that is matched: its first one that shows a surface, or -1. The others
  /// are left to the joint estimation.
  const std::vector<int>& scan_of_pose() const { return *scan_of_pose_; }

  /// Points of a scan that is kept.
  const PackedSurface& Kept(int scan) const { return (*kept_)[scan]; }
  /// Points of any scan that is known.
  SurfacePoints Of(int scan) const;
  /// Free space of any scan that is known.
  FreeSpaceScan FreeSpaceOf(int scan) const;

  /// A copy that also knows these scans. Collective if the graph has peers, which may each ask for
  /// others.
  ScanSurfaces With(const std::vector<int>& scans) const;

  /// A copy that also knows these scans, and keeps them.
  ScanSurfaces WithKept(const std::vector<int>& scans, ThreadPool* pool) const;

  /// Not while others read the scan.
  void Keep(int scan, PackedSurface points) { (*kept_)[scan] = std::move(points); }
  /// The ones that are kept, per scan; empty for the others.
  const std::vector<PackedSurface>& kept() const { return *kept_; }
  std::vector<PackedSurface> TakeKept() && { return std::move(*kept_); }

 private:
  // Scans of other processes.
  struct Guests;
  // A graph, and the id that the scan has there.
  struct Place {
    const SlamGraph* graph;
    const MeasuredSurface* measured;
    int scan;
  };

  ScanSurfaces(const SlamGraph* graph, const MeasuredSurface* measured,
               std::vector<PackedSurface> kept);
  bool IsEmpty(int own_scan) const;
  bool IsKnown(int scan) const;
  Place Find(int scan) const;

  const SlamGraph* graph_;
  const MeasuredSurface* measured_;  // null: all are kept
  std::shared_ptr<std::vector<PackedSurface>> kept_;
  std::shared_ptr<const std::vector<int>> scan_of_pose_;
  std::vector<std::shared_ptr<const Guests>> guests_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_SCAN_SURFACES_H_
