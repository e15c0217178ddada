#include "plumbline/core/share_graph.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "plumbline/core/copy_factor.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/partition.h"

namespace plumbline {
namespace {

// Range, bearing, beam and normal.
constexpr std::size_t kMostBytesPerReturn = 12;
// Sent at a time to each process: little beside a graph that is worth sharing.
constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

struct TimedGuess {
  Pose2 world_from_robot;
  double timestamp_s;
};

// Of a RelativePoseConstraint.
struct PlainEdge {
  int from, to;
  Pose2 from_from_to;
  double covariance[9];
};

// All of a graph but its returns, as arrays of plain values.
struct Outline {
  std::vector<char> refusal;  // message of SlamGraph::status; empty: no failure
  std::vector<LaserModel> lasers;
  std::vector<TimedGuess> poses;
  std::vector<FixedPose> fixed_poses;
  std::vector<OdometryConstraint> odometry;
  std::vector<PlainEdge> edges;
  std::vector<ScanEntry> scans;
  std::vector<int> rank_of_pose;
};

std::vector<LaserModel> LasersOf(const SlamGraph& graph) {
  std::vector<LaserModel> lasers;
  lasers.reserve(graph.num_lasers());
  for (int laser = 0; laser < graph.num_lasers(); ++laser) lasers.push_back(graph.laser(laser));
  return lasers;
}

Outline OutlineOf(const SlamGraph& graph) {
  Outline outline;
  outline.refusal.assign(graph.status().message().begin(), graph.status().message().end());
  outline.lasers = LasersOf(graph);
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    outline.poses.push_back({graph.InitialPose(pose), graph.timestamp_s(pose)});
  }
  if (graph.has_named_fixed_poses()) outline.fixed_poses = graph.fixed_poses();
  outline.odometry = graph.odometry();
  for (const RelativePoseConstraint& edge : graph.relative_poses()) {
    PlainEdge& plain = outline.edges.emplace_back();
    plain.from = edge.from;
    plain.to = edge.to;
    plain.from_from_to = edge.from_from_to;
    Eigen::Map<Eigen::Matrix3d>(plain.covariance) = edge.covariance;
  }
  outline.scans = graph.all_scans();
  return outline;
}

Status AddLasers(const std::vector<LaserModel>& lasers, SlamGraph* graph) {
  for (std::size_t laser = 0; laser < lasers.size(); ++laser) {
    const int id = graph->AddLaser(lasers[laser]);
    if (id == static_cast<int>(laser)) continue;
    return Status::InvalidArgument("lasers " + std::to_string(id) + " and " +
                                   std::to_string(laser) + " are equal");
  }
  return Status::Ok();
}

void AddPosesAndConstraints(const Outline& outline, SlamGraph* graph) {
  for (const TimedGuess& pose : outline.poses) {
    graph->AddPose(pose.world_from_robot, pose.timestamp_s);
  }
  for (const FixedPose& fixed : outline.fixed_poses) {
    graph->FixPose(fixed.pose, fixed.world_from_robot);
  }
  for (const OdometryConstraint& step : outline.odometry) graph->AddOdometry(step);
  for (const PlainEdge& plain : outline.edges) {
    RelativePoseConstraint edge{plain.from, plain.to, plain.from_from_to};
    edge.covariance = Eigen::Map<const Eigen::Matrix3d>(plain.covariance);
    graph->AddRelativePose(edge);
  }
}

std::size_t NumOwnReturns(const SlamGraph& part) {
  std::size_t num_returns = 0;
  for (const ScanEntry& scan : part.all_scans()) {
    if (part.HasScansOf(scan.pose)) num_returns += scan.num_returns;
  }
  return num_returns;
}

// The scans of a graph on their way to another one, with what they saw if that goes along.
struct Source {
  const SlamGraph& graph;
  const MeasuredSurface* surface;  // may be null

  void Pack(int scan, std::vector<char>* bytes) const {
    graph.PackScan(scan, bytes);
    if (surface == nullptr) return;
    const ScanEntry& entry = graph.scan(scan);
    const char* normals =
        reinterpret_cast<const char*>(surface->normals.data() + entry.first_return);
    bytes->insert(bytes->end(), normals, normals + sizeof(ReturnNormal) * entry.num_returns);
  }
};

// Gives the place behind the bytes of the scan. surface: null if what it saw is not among them.
const char* Unpack(const char* bytes, SlamGraph* graph, MeasuredSurface* surface) {
  bytes = graph->AddPackedScan(bytes);
  if (surface == nullptr) return bytes;
  const std::size_t num_before = surface->normals.size();
  surface->normals.resize(graph->num_returns());
  const std::size_t num_bytes = sizeof(ReturnNormal) * (graph->num_returns() - num_before);
  if (num_bytes > 0) std::memcpy(surface->normals.data() + num_before, bytes, num_bytes);
  return bytes + num_bytes;
}

// Gives a part its scans. source: where this process has some of them, or null. rank_of_source: of
// each pose; empty if process 0 has all of them. surface: may be null.
void MoveScans(const Source* source, const std::vector<int>& rank_of_source, SlamGraph* part,
               MeasuredSurface* surface) {
  const std::size_t num_own = NumOwnReturns(*part);
  part->ReserveReturns(num_own);
  if (surface != nullptr) surface->normals.reserve(num_own);
  const Peers& peers = *part->peers();
  const std::vector<ScanEntry>& all = part->all_scans();
  const auto source_of = [&](const ScanEntry& scan) {
    return rank_of_source.empty() ? 0 : rank_of_source[scan.pose];
  };
  for (std::size_t first = 0; first < all.size();) {
    std::vector<std::vector<char>> pieces(peers.size());
    std::vector<std::size_t> num_bytes(peers.size());
    // Every process counts along, so that all know when there is no more.
    std::size_t end = first;
    for (std::size_t fullest = 0; end < all.size() && fullest < kPieceBytes; ++end) {
      const ScanEntry& scan = all[end];
      const int rank = part->rank_of_pose()[scan.pose];
      num_bytes[rank] += sizeof(scan) + kMostBytesPerReturn * scan.num_returns;
      fullest = std::max(fullest, num_bytes[rank]);
      if (source_of(scan) != peers.rank()) continue;
      source->Pack(OwnScan(source->graph, static_cast<int>(end)), &pieces[rank]);
    }
    const std::vector<std::vector<char>> received = peers.Exchange(pieces);
    std::vector<const char*> next;
    next.reserve(received.size());
    for (const std::vector<char>& scans : received) next.push_back(scans.data());
    for (; first < end; ++first) {
      if (!part->HasScansOf(all[first].pose)) continue;
      const char*& scan = next[source_of(all[first])];
      scan = Unpack(scan, part, surface);
    }
  }
}

// What process 0 has.
template <typename T>
void Broadcast(const Peers* peers, std::vector<T>* values) {
  if (!SpeaksForAll(peers)) values->clear();
  *values = JoinOverPeers(peers, std::move(*values));
}

// All of a part but its returns.
Status MakePart(const Peers* peers, Outline outline, SlamGraph* part) {
  if (!outline.refusal.empty()) {
    return Status::InvalidArgument({outline.refusal.begin(), outline.refusal.end()});
  }
  PLUMBLINE_RETURN_IF_ERROR(AddLasers(outline.lasers, part));
  AddPosesAndConstraints(outline, part);
  part->ShareWith(peers, std::move(outline.rank_of_pose), std::move(outline.scans));
  return part->status();
}

// surface: of the fetched scans, or null.
SlamGraph Fetch(const Source& source, const std::vector<int>& ids_among_all,
                MeasuredSurface* surface) {
  const SlamGraph& graph = source.graph;
  const Peers& peers = *graph.peers();
  const auto rank_of = [&graph](int id) {
    return graph.rank_of_pose()[graph.all_scans()[id].pose];
  };
  std::vector<std::vector<int>> requests(peers.size());
  std::size_t num_returns = 0;
  for (const int id : ids_among_all) {
    requests[rank_of(id)].push_back(id);
    num_returns += graph.all_scans()[id].num_returns;
  }
  std::vector<std::vector<char>> replies;
  for (const std::vector<int>& request : ExchangeValues(peers, requests)) {
    std::vector<char>& reply = replies.emplace_back();
    for (const int id : request) source.Pack(OwnScan(graph, id), &reply);
  }
  const std::vector<std::vector<char>> received = peers.Exchange(replies);
  replies.clear();
  std::vector<const char*> next;
  next.reserve(received.size());
  for (const std::vector<char>& scans : received) next.push_back(scans.data());
  SlamGraph fetched;
  const Status added = AddLasers(LasersOf(graph), &fetched);
  if (!added.ok()) throw std::logic_error(added.message());  // they were added before
  fetched.ReserveReturns(num_returns);
  if (surface != nullptr) surface->normals.reserve(num_returns);
  for (const int id : ids_among_all) {
    const char*& scan = next[rank_of(id)];
    scan = Unpack(scan, &fetched, surface);
  }
  return fetched;
}

}  // namespace

Status ShareGraph(const Peers* peers, std::vector<int> rank_of_pose, SlamGraph* graph) {
  Outline outline;
  if (SpeaksForAll(peers)) outline = OutlineOf(*graph);
  if (outline.refusal.empty() && !graph->factors().empty()) {
    const std::string text = "custom factors cannot be sent: each process adds them to its part";
    outline.refusal.assign(text.begin(), text.end());
  }
  outline.rank_of_pose = std::move(rank_of_pose);
  auto& [refusal, lasers, guesses, fixed_poses, odometry, edges, scans, ranks] = outline;
  Broadcast(peers, &refusal);
  Broadcast(peers, &lasers);
  Broadcast(peers, &guesses);
  Broadcast(peers, &fixed_poses);
  Broadcast(peers, &odometry);
  Broadcast(peers, &edges);
  Broadcast(peers, &scans);
  Broadcast(peers, &ranks);
  SlamGraph part;
  PLUMBLINE_RETURN_IF_ERROR(MakePart(peers, std::move(outline), &part));
  const Source source{*graph, nullptr};
  MoveScans(SpeaksForAll(peers) ? &source : nullptr, {}, &part, nullptr);
  *graph = std::move(part);
  return Status::Ok();
}

Status ShareGraphByPlace(const Peers* peers, const std::vector<double>& poses, SlamGraph* graph) {
  std::vector<int> rank_of_pose;
  if (SpeaksForAll(peers)) {
    rank_of_pose = PartitionByPlace(poses, ReturnsPerPose(*graph), peers->size());
  }
  return ShareGraph(peers, std::move(rank_of_pose), graph);
}

void ShareAnew(std::vector<int> rank_of_pose, SlamGraph* part, MeasuredSurface* surface) {
  Outline outline = OutlineOf(*part);
  outline.rank_of_pose = std::move(rank_of_pose);
  SlamGraph other;
  const Status made = MakePart(part->peers(), std::move(outline), &other);
  if (!made.ok()) throw std::logic_error(made.message());  // so it was made before
  for (const CustomFactor& factor : part->factors()) {
    if (!factor.points.empty()) throw std::logic_error("factors see points of a shared graph");
    const auto same = [](int pose) { return pose; };
    CopyFactor(*part, factor, same, same, &other);
  }
  const Source source{*part, surface};
  MeasuredSurface other_surface;
  MoveScans(&source, part->rank_of_pose(), &other, &other_surface);
  *part = std::move(other);
  *surface = std::move(other_surface);
}

void ShareAnewByPlace(const std::vector<double>& poses, SlamGraph* part, MeasuredSurface* surface) {
  ShareAnew(PartitionByPlace(poses, ReturnsPerPose(*part), part->peers()->size()), part, surface);
}

int FirstOwnScanFrom(const SlamGraph& part, int id_among_all) {
  int begin = 0, end = part.num_scans();
  while (begin < end) {
    const int middle = begin + (end - begin) / 2;
    (part.IdAmongAll(middle) < id_among_all ? begin : end) =
        part.IdAmongAll(middle) < id_among_all ? middle + 1 : middle;
  }
  return begin;
}

int OwnScan(const SlamGraph& part, int id_among_all) {
  const int scan = FirstOwnScanFrom(part, id_among_all);
  return scan < part.num_scans() && part.IdAmongAll(scan) == id_among_all ? scan : -1;
}

SlamGraph FetchScans(const SlamGraph& graph, const std::vector<int>& ids_among_all) {
  return Fetch({graph, nullptr}, ids_among_all, nullptr);
}

SlamGraph FetchScans(const SlamGraph& graph, const MeasuredSurface& surface,
                     const std::vector<int>& ids_among_all, MeasuredSurface* fetched_surface) {
  return Fetch({graph, &surface}, ids_among_all, fetched_surface);
}

}  // namespace plumbline
