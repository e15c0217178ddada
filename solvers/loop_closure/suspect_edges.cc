#include "plumbline/solvers/loop_closure/suspect_edges.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/front_end/local_map.h"

namespace plumbline {
namespace {

// Keyframes on either side that are compared with those of the other one.
constexpr int kKeysPerSide = 3;
// Distance [m] within which the other side sees a point: more than the matching leaves, less than a
// jump that matters.
constexpr double kSeenM = 0.15;
// Overlap of neighbouring scans below which something is wrong. Tuned, as kSuspectEvidence, on the
// floors of the seeding study (apps/benchmark).
constexpr double kExpectedOverlap = 0.6;
// Evidence from which on an edge is suspect. Sound simulated drives stay below 0.05 everywhere;
// real ones with people, glass and fast turns are above it in one edge of fifty.
constexpr double kSuspectEvidence = 0.15;
// Evidence that three quarters of the edges stay below on such drives. Where scans are a metre
// apart, or people and bushes stand everywhere, an edge is suspect from more evidence in
// proportion.
constexpr double kUsualEvidence = 0.05;

// A scan and where it was taken from.
struct PlacedScan {
  PackedSurface surface;
  Pose2 world_from_robot;
  FreeSpaceScan free_space;
};
using Side = std::vector<const PlacedScan*>;  // the nearest one first

// Share of the first scan's points on surfaces that the other side shows.
double Overlap(const Side& side, const Side& others) {
  std::vector<const PackedSurface*> points;
  std::vector<Pose2> poses;
  for (const PlacedScan* other : others) {
    points.push_back(&other->surface);
    poses.push_back(other->world_from_robot);
  }
  LocalMap map;
  map.Rebuild(points, poses);
  const SurfacePoints surface = side.front()->surface.Unpacked();
  const auto num_seen = std::count_if(surface.begin(), surface.end(), [&](const SurfacePoint& p) {
    return map.Nearest(side.front()->world_from_robot * p, kSeenM) != nullptr;
  });
  return static_cast<double>(num_seen) / static_cast<double>(surface.size());
}

// How badly two sides agree, from 0 (they do) to 1.6.
double Disagreement(const Side& before, const Side& after) {
  FreeSpaceConflict conflict;
  for (const PlacedScan* a : before) {
    for (const PlacedScan* b : after) {
      conflict += CompareBothWays(a->free_space, b->free_space,
                                  Between(a->world_from_robot, b->world_from_robot));
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
    for (int k = first_known_; k < end; ++k) {
      of_key_.push_back(Place(keys_.keyframes[k].pose, keys_.keyframes[k].scan));
    }
  }

  // Evidence of an edge, its sides reaching to the next suspect edge at most. 0 between sessions.
  double Evidence(int edge) const {
    if (keys_.sequential[edge].between_sessions) return 0.0;
    Side before, after;
    for (int k = edge; k >= 0 && static_cast<int>(before.size()) < kKeysPerSide; --k) {
      before.push_back(&OfKey(k));
      if (k > 0 && EndsSide(keys_.sequential[k - 1])) break;
    }
    for (int k = edge + 1; k < keys_.size() && static_cast<int>(after.size()) < kKeysPerSide; ++k) {
      after.push_back(&OfKey(k));
      if (k + 1 < keys_.size() && EndsSide(keys_.sequential[k])) break;
    }
    return Disagreement(before, after);
  }

  // The pose on the edge that agrees worst with the pose before it.
  int FirstPoseAfter(int edge) const {
    int worst_pose = keys_.keyframes[edge + 1].pose;
    double worst = 0.0;
    PlacedScan before = OfKey(edge);
    for (int pose = keys_.keyframes[edge].pose + 1; pose <= keys_.keyframes[edge + 1].pose;
         ++pose) {
      const int scan = surfaces_.scan_of_pose()[pose];
      if (scan < 0) continue;
      PlacedScan after = Place(pose, scan);
      const double disagreement = Disagreement({&before}, {&after});
      before = std::move(after);
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

  PlacedScan Place(int pose, int scan) const {
    return {PackedSurface(surfaces_.Of(scan)), poses_[pose], surfaces_.FreeSpaceOf(scan)};
  }

  const PlacedScan& OfKey(int key) const { return of_key_[key - first_known_]; }

  const ScanSurfaces& surfaces_;
  const std::vector<Pose2>& poses_;
  const KeyframeGraph& keys_;
  int first_known_;
  std::vector<PlacedScan> of_key_;  // from that keyframe on
};

// Sets first_pose_after of edges. Processes that share the drive share the work.
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
  std::vector<double> of_edge(edges.size());
  // Free space takes more memory than the scan has. It is made for some edges at a time.
  constexpr std::size_t kEdgesPerChunk = 64;
  const Peers* peers = surfaces.graph().peers();
  const std::vector<std::size_t> own_chunks =
      OwnShare(peers, ThreadPool::NumChunks(edges.size(), kEdgesPerChunk));
  pool->ForEach(own_chunks.size(), 1, [&](std::size_t i) {
    const std::size_t begin = own_chunks[i] * kEdgesPerChunk;
    const int first = static_cast<int>(begin);
    const int last = static_cast<int>(std::min(begin + kEdgesPerChunk, edges.size()));
    const EdgeEvidence evidence(surfaces, world_from_robot, *keyframe_graph, first, last);
    for (int e = first; e < last; ++e) of_edge[e] = evidence.Evidence(e);
  });
  SumOverPeers(peers, &of_edge);
  // The worst first: it spoils what is seen across its neighbours, which are then judged again.
  std::vector<int> order(edges.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return of_edge[a] > of_edge[b]; });
  double in_proportion = 1.0;
  if (!order.empty()) {
    in_proportion = std::max(1.0, of_edge[order[order.size() / 4]] / kUsualEvidence);
  }
  std::vector<int> marked;
  for (const int edge : order) {
    if (of_edge[edge] / in_proportion < kSuspectEvidence) break;
    const EdgeEvidence again(surfaces, world_from_robot, *keyframe_graph, edge, edge + 1);
    const double evidence = again.Evidence(edge) / in_proportion;
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
