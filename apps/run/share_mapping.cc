#include "plumbline/apps/run/share_mapping.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/heap.h"
#include "plumbline/apps/run/packed_seed.h"
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

// Who has not read the log has none.
void ShareRangeNoise(const Peers* peers, MappingReport* report) {
  report->range_noise_m = MaxOverPeers(peers, report->range_noise_m);
}

// A SessionOfMap without its report, and the map that it is a part of.
struct PlainSession {
  int map, session, first_pose, num_poses, first_scan, num_scans;
};

std::vector<PlainSession> PlainSessions(const std::vector<SessionMap>& maps) {
  std::vector<PlainSession> plain;
  for (std::size_t map = 0; map < maps.size(); ++map) {
    for (const SessionOfMap& session : maps[map].sessions) {
      plain.push_back({static_cast<int>(map), session.session, session.first_pose,
                       session.num_poses, session.first_scan, session.num_scans});
    }
  }
  return plain;
}

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

// Of the whole log, of which each process now has a part.
void SaveMemoryOfLog(const Peers& peers, const SlamGraph& part) {
  const std::size_t num_returns = part.num_returns_of_all();
  SaveMemory(peers, num_returns);
  GiveFreedMemoryBack(num_returns);
}

}  // namespace

void SaveMemory(const Peers& peers, std::size_t num_returns) {
  if (peers.size() > 1 && num_returns >= kManyReturns) GiveLargeArraysBack();
}

bool CanShareSeeding(const Peers& peers, bool says_it_can) {
  if (peers.size() == 1) return false;
  const bool can = peers.rank() == 0 && says_it_can;
  return MaxOverPeers(&peers, can ? 1.0 : 0.0) > 0.0 && ComputeAlike(peers);
}

Status ShareLog(const Peers* peers, LogMapping* mapping) {
  mapping->surface = MeasuredSurface();
  ShareRangeNoise(peers, &mapping->report);
  std::vector<int> rank_of_pose;
  if (SpeaksForAll(peers)) {
    rank_of_pose = PartitionByTime(mapping->graph.num_poses(), peers->size());
  }
  PLUMBLINE_RETURN_IF_ERROR(ShareGraph(peers, std::move(rank_of_pose), &mapping->graph));
  SaveMemoryOfLog(*peers, mapping->graph);
  mapping->state = {mapping->graph.initial_poses(), {}};
  return Status::Ok();
}

Status ShareMapping(const Peers* peers, const MapLogOptions& options, ThreadPool* pool,
                    LogMapping* mapping) {
  mapping->as_swept.reset();
  mapping->surface = MeasuredSurface();
  mapping->state = MapState();
  ShareRangeNoise(peers, &mapping->report);
  ShareSeed(peers, mapping);
  PLUMBLINE_RETURN_IF_ERROR(ShareGraphByPlace(peers, mapping->start_poses, &mapping->graph));
  SaveMemoryOfLog(*peers, mapping->graph);
  MeasureSurfaceOf(options, pool, mapping);
  mapping->state.poses = mapping->start_poses;
  return Status::Ok();
}

Status ShareSessions(const Peers* peers, const MapLogOptions& options, ThreadPool* pool,
                     SessionsMapping* mapping) {
  std::vector<PlainSession> sessions;
  if (SpeaksForAll(peers)) sessions = PlainSessions(mapping->maps);
  sessions = JoinOverPeers(peers, std::move(sessions));
  if (!SpeaksForAll(peers)) {
    *mapping = SessionsMapping();
    for (const PlainSession& plain : sessions) {
      mapping->maps.resize(plain.map + 1);
      SessionOfMap& session = mapping->maps.back().sessions.emplace_back();
      session.session = plain.session;
      session.first_pose = plain.first_pose;
      session.num_poses = plain.num_poses;
      session.first_scan = plain.first_scan;
      session.num_scans = plain.num_scans;
    }
  }
  for (SessionMap& map : mapping->maps) {
    PLUMBLINE_RETURN_IF_ERROR(ShareMapping(peers, options, pool, &map.mapping));
  }
  return Status::Ok();
}

void ShareLimits(const Peers* peers, RunOutputOptions* outputs) {
  std::vector<double> limits;
  if (SpeaksForAll(peers)) limits = {1.0 * outputs->picture_side_px, outputs->map_max_cells};
  limits = JoinOverPeers(peers, std::move(limits));
  outputs->picture_side_px = static_cast<int>(limits[0]);
  outputs->map_max_cells = limits[1];
}

}  // namespace plumbline
