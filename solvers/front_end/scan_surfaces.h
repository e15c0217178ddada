#ifndef PLUMBLINE_SOLVERS_FRONT_END_SCAN_SURFACES_H_
#define PLUMBLINE_SOLVERS_FRONT_END_SCAN_SURFACES_H_

#include <utility>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

/// The surface points of the scans of a drive, each in the frame of its robot, thinned to
/// kPointSpacingM. Those of all scans would be the largest array of a long drive: the ones of
/// keyframes, which are read again and again, are kept, and the others are made when somebody asks
/// for them.
class ScanSurfaces {
 public:
  ScanSurfaces() = default;
  /// Refers to both arguments. Keeps none yet.
  ScanSurfaces(const SlamGraph& graph, const MeasuredSurface& measured)
      : ScanSurfaces(graph, measured, std::vector<SurfacePoints>(graph.num_scans())) {}
  /// The same, and keeps these; kept: per scan, empty for those that are not kept.
  ScanSurfaces(const SlamGraph& graph, const MeasuredSurface& measured,
               std::vector<SurfacePoints> kept)
      : graph_(&graph), measured_(&measured), kept_(std::move(kept)) {}
  /// Keeps these, one per scan: all that there are.
  ScanSurfaces(std::vector<SurfacePoints> all)  // NOLINT(google-explicit-constructor)
      : kept_(std::move(all)) {}

  /// Of a scan that is kept.
  const SurfacePoints& Kept(int scan) const { return kept_[scan]; }
  /// Of any scan.
  SurfacePoints Of(int scan) const;
  /// Whether a scan shows no surface.
  bool IsEmpty(int scan) const;

  /// Not while others read the scan.
  void Keep(int scan, SurfacePoints points) { kept_[scan] = std::move(points); }
  /// The ones that are kept, per scan; empty for the others.
  const std::vector<SurfacePoints>& kept() const { return kept_; }
  std::vector<SurfacePoints> TakeKept() && { return std::move(kept_); }

 private:
  const SlamGraph* graph_ = nullptr;
  const MeasuredSurface* measured_ = nullptr;  // null: all are kept
  std::vector<SurfacePoints> kept_;            // per scan
};

/// MatchedScanOfPoses of all surfaces.
std::vector<int> MatchedScanOfPoses(const SlamGraph& graph, const ScanSurfaces& surfaces);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_SCAN_SURFACES_H_
