#include "plumbline/solvers/loop_closure/suspect_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/front_end/local_map.h"

namespace plumbline {
namespace {

// Keyframes on either side that are compared with those of the other one.
constexpr int kKeysPerSide = 3;
// A point of one side is seen by the other if a surface is this near: more than matching leaves,
// less than a jump that matters.
constexpr double kSeenM = 0.15;
// Where neighbouring scans have less than this in common, something is wrong. Tuned on the floors
// of the seeding study (apps/benchmark), as what follows.
constexpr double kExpectedOverlap = 0.6;
// From here on the evidence counts. Sound simulated drives stay below 0.05 everywhere, real ones
// with people, glass and fast turns are above it in one edge of fifty.
constexpr double kSuspectEvidence = 0.15;
// That is for drives on which three quarters of the edges have no more evidence than this. Where
// scans are a metre apart, or people and bushes stand everywhere, neighbouring scans have less in
// common and conflict more, and it takes more in proportion to be out of the ordinary.
constexpr double kUsualEvidence = 0.05;

// A scan and where it was taken from.
struct PlacedScan {
  const PackedSurface* surface;
  Pose2 world_from_robot;
  const FreeSpaceScan* free_space;
};
using Side = std::vector<PlacedScan>;  // the nearest one first

// Share of the first scan's points on surfaces that the other side shows.
double Overlap(const Side& side, const Side& others) {
  std::vector<const PackedSurface*> points;
  std::vector<Pose2> poses;
  for (const PlacedScan& other : others) {
    points.push_back(other.surface);
    poses.push_back(other.world_from_robot);
  }
  LocalMap map;
  map.Rebuild(points, poses);
  const SurfacePoints surface = side.front().surface->Unpacked();
  const auto num_seen = std::count_if(surface.begin(), surface.end(), [&](const SurfacePoint& p) {
    return map.Nearest(side.front().world_from_robot * p, kSeenM) != nullptr;
  });
  return static_cast<double>(num_seen) / static_cast<double>(surface.size());
}

// How badly two sides agree, from 0 (they do) to 1.6.
double Disagreement(const Side& before, const Side& after) {
  FreeSpaceConflict conflict;
  for (const PlacedScan& a : before) {
    for (const PlacedScan& b : after) {
      conflict += CompareBothWays(*a.free_space, *b.free_space,
                                  Between(a.world_from_robot, b.world_from_robot));
    }
  }
  const double overlap = std::min(Overlap(before, after), Overlap(after, before));
  return std::min(1.0, conflict.Penalty()) + std::max(0.0, kExpectedOverlap - overlap);
}

class EdgeEvidence {
 public:
  // Knows the edges from keyframe `first` to keyframe `last`.
  EdgeEvidence(const ScanSurfaces& surfaces, const std::vector<Pose2>& world_from_robot,
               const KeyframeGraph& keyframe_graph, int first, int last)
      : surfaces_(surfaces),
        poses_(world_from_robot),
        keys_(keyframe_graph),
        first_known_(std::max(0, first + 1 - kKeysPerSide)) {
    const int end = std::min(keyframe_graph.size(), last + kKeysPerSide);
    of_key_.reserve(std::max(0, end - first_known_));
    for (int k = first_known_; k < end; ++k) {
      of_key_.push_back(surfaces.FreeSpaceOf(keyframe_graph.keyframes[k].scan));
    }
  }

  // Of an edge, its sides reaching to the next suspect edge at most. None between sessions.
  double Evidence(int edge) const {
    if (keys_.sequential[edge].between_sessions) return 0.0;
    Side before, after;
    for (int k = edge; k >= 0 && static_cast<int>(before.size()) < kKeysPerSide; --k) {
      before.push_back(PlacedKey(k));
      if (k > 0 && EndsSide(keys_.sequential[k - 1])) break;
    }
    for (int k = edge + 1; k < keys_.size() && static_cast<int>(after.size()) < kKeysPerSide; ++k) {
      after.push_back(PlacedKey(k));
      if (k + 1 < keys_.size() && EndsSide(keys_.sequential[k])) break;
    }
    return Disagreement(before, after);
  }

  // The pose on the edge that agrees worst with the pose before it.
  int FirstPoseAfter(int edge) const {
    int worst_pose = keys_.keyframes[edge + 1].pose;
    double worst = 0.0;
    Side before{PlacedKey(edge)};
    FreeSpaceScan free_space_before = of_key_[edge - first_known_];
    PackedSurface surface_before;
    before.front().free_space = &free_space_before;
    for (int pose = keys_.keyframes[edge].pose + 1; pose <= keys_.keyframes[edge + 1].pose;
         ++pose) {
      const int scan = surfaces_.scan_of_pose()[pose];
      if (scan < 0) continue;
      FreeSpaceScan free_space = surfaces_.FreeSpaceOf(scan);
      PackedSurface surface(surfaces_.Of(scan));
      Side after{{&surface, poses_[pose], &free_space}};
      const double disagreement = Disagreement(before, after);
      free_space_before = std::move(free_space);
      surface_before = std::move(surface);
      before = {{&surface_before, poses_[pose], &free_space_before}};
      if (disagreement <= worst) continue;
      worst = disagreement;
      worst_pose = pose;
    }
    return worst_pose;
  }

 private:
  static bool EndsSide(const SequentialEdge& edge) {
    return edge.evidence > 0.0 || edge.between_sessions;
  }

  PlacedScan PlacedKey(int key) const {
    const Keyframe& keyframe = keys_.keyframes[key];
    return {&surfaces_.Kept(keyframe.scan), poses_[keyframe.pose], &of_key_[key - first_known_]};
  }

  const ScanSurfaces& surfaces_;
  const std::vector<Pose2>& poses_;
  const KeyframeGraph& keys_;
  int first_known_;
  std::vector<FreeSpaceScan> of_key_;  // from that keyframe on
};

// What three quarters of the edges stay below. suspects: sorted, the worst first, with a minus.
double UsualEvidence(const std::vector<std::pair<double, int>>& suspects) {
  return suspects.empty() ? 0.0 : -suspects[suspects.size() / 4].first;
}

void FindFirstPosesAfter(const ScanSurfaces& surfaces, const std::vector<Pose2>& world_from_robot,
                         const std::vector<int>& edges, KeyframeGraph* keys) {
  if (edges.empty()) return;
  const Peers* peers = surfaces.graph().peers();
  const std::vector<std::size_t> own = OwnShare(peers, edges.size());
  std::vector<int> scans;
  for (const std::size_t i : own) {
    const int edge = edges[i];
    for (int pose = keys->keyframes[edge].pose + 1; pose <= keys->keyframes[edge + 1].pose;
         ++pose) {
      const int scan = surfaces.scan_of_pose()[pose];
      if (scan >= 0) scans.push_back(scan);
    }
  }
  const ScanSurfaces at_hand = surfaces.With(scans);
  std::vector<int> first_poses(edges.size());
  for (const std::size_t i : own) {
    const EdgeEvidence evidence(at_hand, world_from_robot, *keys, edges[i], edges[i] + 1);
    first_poses[i] = evidence.FirstPoseAfter(edges[i]);
  }
  SumOverPeers(peers, &first_poses);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    keys->sequential[edges[i]].first_pose_after = first_poses[i];
  }
}

}  // namespace

void MarkSuspectEdges(const ScanSurfaces& surfaces, const std::vector<Pose2>& world_from_robot,
                      ThreadPool* pool, KeyframeGraph* keyframe_graph) {
  std::vector<SequentialEdge>& edges = keyframe_graph->sequential;
  const auto evidence_between = [&](int first, int last) {
    return EdgeEvidence(surfaces, world_from_robot, *keyframe_graph, first, last);
  };
  std::vector<double> of_edge(edges.size());
  // Free space takes more memory than the scan has. It is made for some edges at a time.
  constexpr std::size_t kEdgesPerChunk = 64;
  const Peers* peers = surfaces.graph().peers();
  const std::vector<std::size_t> own_chunks =
      OwnShare(peers, ThreadPool::NumChunks(edges.size(), kEdgesPerChunk));
  pool->ForEachChunk(own_chunks.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const std::size_t begin = own_chunks[i] * kEdgesPerChunk;
    const int first = static_cast<int>(begin);
    const int last = static_cast<int>(std::min(begin + kEdgesPerChunk, edges.size()));
    const EdgeEvidence edge_evidence = evidence_between(first, last);
    for (int e = first; e < last; ++e) of_edge[e] = edge_evidence.Evidence(e);
  });
  SumOverPeers(peers, &of_edge);
  std::vector<std::pair<double, int>> suspects;
  suspects.reserve(of_edge.size());
  for (const double evidence : of_edge) {
    suspects.emplace_back(-evidence, static_cast<int>(suspects.size()));
  }
  // The worst first: it spoils what is seen across its neighbours, which are then judged again.
  std::sort(suspects.begin(), suspects.end());
  std::vector<int> marked;
  const double in_proportion = std::max(1.0, UsualEvidence(suspects) / kUsualEvidence);
  for (const auto& [negative_evidence, edge] : suspects) {
    if (-negative_evidence / in_proportion < kSuspectEvidence) break;
    const EdgeEvidence edge_evidence = evidence_between(edge, edge + 1);
    const double evidence = edge_evidence.Evidence(edge) / in_proportion;
    if (evidence < kSuspectEvidence) continue;
    edges[edge].evidence = evidence;
    marked.push_back(edge);
  }
  FindFirstPosesAfter(surfaces, world_from_robot, marked, keyframe_graph);
}

int MarkWorstEdge(const ScanSurfaces& surfaces, const std::vector<Pose2>& world_from_robot,
                  int first, int last, KeyframeGraph* keyframe_graph) {
  const EdgeEvidence edge_evidence(surfaces, world_from_robot, *keyframe_graph, first, last);
  int worst = first;
  double most = -1.0;
  for (int e = first; e < last; ++e) {
    const double evidence = edge_evidence.Evidence(e);
    if (evidence <= most) continue;
    most = evidence;
    worst = e;
  }
  SequentialEdge& edge = keyframe_graph->sequential[worst];
  edge.evidence = std::max(edge.evidence, most);
  FindFirstPosesAfter(surfaces, world_from_robot, {worst}, keyframe_graph);
  return worst;
}

}  // namespace plumbline
