#include "plumbline/apps/run/share_mapping.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/program/heap.h"
#include "plumbline/apps/run/checkpoint.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/partition.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/solvers/association/noise_scales.h"

namespace plumbline {
namespace {

void ShareSeed(const Peers* peers, LogMapping* mapping) {
  std::vector<char> bytes;
  if (SpeaksForAll(peers)) {
    const std::string seed = PackSeed(mapping->start_poses, mapping->report.seeding);
    bytes.assign(seed.begin(), seed.end());
  }
  bytes = JoinOverPeers(peers, std::move(bytes));
  if (SpeaksForAll(peers)) return;
  UnpackSeed(std::string(bytes.begin(), bytes.end()), &mapping->start_poses,
             &mapping->report.seeding);
}

}  // namespace

bool ComputeAlike(const Peers& peers) {
  std::vector<double> own;
  for (int i = 1; i <= 32; ++i) {
    const double x = 0.37 * i;
    own.insert(own.end(), {std::sin(x), std::cos(x), std::atan2(x, 1.7), std::exp(-x), std::log(x),
                           std::sqrt(x), std::hypot(x, 0.9), std::pow(x, 0.3)});
  }
  const std::vector<std::vector<double>> all =
      ExchangeValues(peers, std::vector<std::vector<double>>(peers.size(), own));
  return std::all_of(all.begin(), all.end(),
                     [&](const std::vector<double>& of_rank) { return of_rank == own; });
}

Status ShareLog(const Peers* peers, LogMapping* mapping) {
  mapping->surface = MeasuredSurface();
  std::vector<int> rank_of_pose;
  if (SpeaksForAll(peers)) {
    rank_of_pose = PartitionByTime(mapping->graph.num_poses(), peers->size());
  }
  PLUMBLINE_RETURN_IF_ERROR(ShareGraph(peers, std::move(rank_of_pose), &mapping->graph));
  GiveFreedMemoryBack();  // most of a log
  mapping->state = {mapping->graph.initial_poses(), {}};
  return Status::Ok();
}

Status ShareMapping(const Peers* peers, const MapLogOptions& options, ThreadPool* pool,
                    LogMapping* mapping) {
  mapping->as_swept.reset();
  mapping->surface = MeasuredSurface();
  mapping->state = MapState();
  ShareSeed(peers, mapping);
  PLUMBLINE_RETURN_IF_ERROR(ShareGraphByPlace(peers, mapping->start_poses, &mapping->graph));
  GiveFreedMemoryBack();  // most of a log
  mapping->surface =
      MeasureSurface(mapping->graph, NormalOptionsFor(options.solver.factors.beam), pool);
  mapping->state.poses = mapping->start_poses;
  return Status::Ok();
}

}  // namespace plumbline
