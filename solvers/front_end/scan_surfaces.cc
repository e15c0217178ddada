#include "plumbline/solvers/front_end/scan_surfaces.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/sort_unique.h"

namespace plumbline {

struct ScanSurfaces::Guests {
  SlamGraph graph;
  MeasuredSurface measured;
  std::unordered_map<int, int> scan_of_id;
};

ScanSurfaces::ScanSurfaces(const SlamGraph* graph, const MeasuredSurface* measured,
                           std::vector<PackedSurface> kept)
    : graph_(graph),
      measured_(measured),
      kept_(std::make_shared<std::vector<PackedSurface>>(std::move(kept))) {
  kept_->resize(graph->all_scans().size());
  std::vector<int> scan_of_pose(graph->num_poses(), -1);
  for (int scan = graph->num_scans() - 1; scan >= 0; --scan) {
    if (!IsEmpty(scan)) scan_of_pose[graph->scan(scan).pose] = graph->IdAmongAll(scan);
  }
  if (graph->peers() != nullptr) {
    // Others have -1 for the poses of this process.
    for (int& scan : scan_of_pose) ++scan;
    SumOverPeers(graph->peers(), &scan_of_pose);
    for (int& scan : scan_of_pose) --scan;
  }
  scan_of_pose_ = std::make_shared<const std::vector<int>>(std::move(scan_of_pose));
}

SurfacePoints ScanSurfaces::Of(int scan) const {
  if (measured_ == nullptr || !Kept(scan).empty()) return Kept(scan).Unpacked();
  const Place place = Find(scan);
  return ThinnedSurfaceOf(*place.graph, place.scan, *place.measured, kPointSpacingM);
}

FreeSpaceScan ScanSurfaces::FreeSpaceOf(int scan) const {
  const Place place = Find(scan);
  return {*place.graph, place.scan};
}

ScanSurfaces ScanSurfaces::With(const std::vector<int>& scans) const {
  ScanSurfaces with = *this;
  if (graph_->peers() == nullptr) return with;
  std::vector<int> unknown;
  for (const int scan : scans) {
    if (!IsKnown(scan)) unknown.push_back(scan);
  }
  SortUnique(&unknown);
  auto guests = std::make_shared<Guests>();
  guests->graph = measured_ == nullptr
                      ? FetchScans(*graph_, unknown)
                      : FetchScans(*graph_, *measured_, unknown, &guests->measured);
  for (std::size_t i = 0; i < unknown.size(); ++i) {
    guests->scan_of_id.emplace(unknown[i], static_cast<int>(i));
  }
  with.guests_.push_back(std::move(guests));
  return with;
}

ScanSurfaces ScanSurfaces::WithKept(const std::vector<int>& scans, ThreadPool* pool) const {
  constexpr std::size_t kScansPerChunk = 64;
  ScanSurfaces with = With(scans);
  pool->ForEach(scans.size(), kScansPerChunk, [&](std::size_t i) {
    if (with.Kept(scans[i]).empty()) with.Keep(scans[i], PackedSurface(with.Of(scans[i])));
  });
  return with;
}

bool ScanSurfaces::IsEmpty(int own_scan) const {
  if (measured_ == nullptr) return Kept(graph_->IdAmongAll(own_scan)).empty();
  const ScanEntry& entry = graph_->scan(own_scan);
  const auto first = measured_->normals.begin() + static_cast<std::ptrdiff_t>(entry.first_return);
  return std::all_of(first, first + static_cast<std::ptrdiff_t>(entry.num_returns),
                     [](const ReturnNormal& normal) { return normal.IsNone(); });
}

bool ScanSurfaces::IsKnown(int scan) const {
  return OwnScan(*graph_, scan) >= 0 ||
         std::any_of(guests_.begin(), guests_.end(),
                     [scan](const auto& guests) { return guests->scan_of_id.count(scan) != 0; });
}

ScanSurfaces::Place ScanSurfaces::Find(int scan) const {
  if (graph_->peers() == nullptr) return {graph_, measured_, scan};
  const int own_scan = OwnScan(*graph_, scan);
  if (own_scan >= 0) return {graph_, measured_, own_scan};
  for (const auto& guests : guests_) {
    const auto found = guests->scan_of_id.find(scan);
    if (found != guests->scan_of_id.end()) {
      return {&guests->graph, &guests->measured, found->second};
    }
  }
  throw std::logic_error("scan " + std::to_string(scan) + " is of another process");
}

}  // namespace plumbline
