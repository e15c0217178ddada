#include "plumbline/solvers/sessions/session_alignment.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/point_index.h"
#include "plumbline/solvers/hypotheses/tied_places.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/closure_clusters.h"
#include "plumbline/solvers/loop_closure/closure_memory.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/loop_closure/loop_closure.h"

namespace plumbline {
namespace {

// From view to view of a session [m].
constexpr double kViewSpacingM = 1.0;
// Views this near to each other are compared [m], with so many of the other side at most.
constexpr double kViewReachM = 4.0;
constexpr std::size_t kMaxPartners = 6;
// Of what is compared, this share conflicts in a map that is right: sessions are hours or weeks
// apart, and furniture moves.
constexpr double kExplicableShare = 0.1;
// Two places say the same of how the sessions lie to each other if one puts the other's keyframe to
// within this [m], [rad] of where that was found, and farther apart by this share of the way
// between them, by which sessions may be bent.
constexpr double kSameM = 1.0;
constexpr double kSameRad = 0.15;
constexpr double kBentShare = 0.02;
// Sessions lie as an alignment says if no more than this share of what is compared conflicts, as
// much as doors and furniture bring about, and so many places match at least, ... On simulated
// floors with a third of the furniture moved, ties that are right have 0.05 at most, and others
// 0.066 at least.
constexpr double kMaxConflict = 0.06;
constexpr int kMinWitnesses = 3;
// ... unless another one explains this share of what the best one does, or as many places match and
// it conflicts as little, but for this share: then sessions have less in common there, and nothing
// says that they have more.
constexpr double kRivalShare = 0.5;
constexpr double kSameConflict = 0.01;
// Furniture that was moved bends sessions at some of the places where they are tied. A building
// that is merely much like this one bends them at nearly all: they have other dimensions.
constexpr double kMaxBentShare = 0.5;
// A place counts as bent if its relief (TiedPlace) is more than this: the 95 % point of
// chi-squared, three degrees of freedom. Closures along corridors give way, and show little of a
// bend.
constexpr double kBentRelief = 7.8;
// Fewer places count only from LoopAcceptance::kMaxRelief on, or chance would refuse a tie.
constexpr std::size_t kEnoughPlaces = 3;
// Ways that are tried with closures of their own.
constexpr std::size_t kMaxAlignments = 4;

// A keyframe of one side that was found on the other.
struct Place {
  TestedCandidate match;
  Pose2 a_from_b;
  double weight = 0.0;
};

class AlignmentSearch {
 public:
  AlignmentSearch(const SessionSet& set, const SessionViews& views, SessionPlaces* places,
                  const SessionGroup& a, const SessionGroup& b, const SeedingProgress& progress,
                  ThreadPool* pool)
      : set_(set),
        views_(views),
        known_places_(places),
        a_(a),
        b_(b),
        progress_(progress),
        pool_(pool),
        apart_(Concatenated(a, b, Pose2())) {}

  Status Run(std::vector<SessionAlignment>* alignments) {
    PLUMBLINE_RETURN_IF_ERROR(FindAllPlaces());
    PLUMBLINE_RETURN_IF_ERROR(CheckStop());
    for (const Way& way : DistinctWays()) {
      SessionAlignment alignment;
      PLUMBLINE_RETURN_IF_ERROR(Align(way, &alignment));
      if (alignment.num_closures > 0 && !IsKnown(alignment, *alignments)) {
        alignments->push_back(std::move(alignment));
      }
    }
    std::stable_sort(
        alignments->begin(), alignments->end(),
        [](const SessionAlignment& a, const SessionAlignment& b) { return a.score < b.score; });
    if (Judge(*alignments) == TieOutcome::kTied) CountBentPlaces(&alignments->front());
    return Status::Ok();
  }

 private:
  int first_of_b() const { return a_.keys.size(); }

  Status CheckStop() const {
    if (!progress_ || progress_(SeedingPhase::kClosingLoops, 0, 0)) return Status::Ok();
    return Status::Unavailable("the alignment of sessions was stopped by its caller");
  }

  Status FindAllPlaces() {
    std::vector<TestedCandidate> found;
    PLUMBLINE_RETURN_IF_ERROR(known_places_->Find(a_, b_, progress_, &found));
    for (TestedCandidate& match : found) {
      Place place;
      place.a_from_b = apart_.keys.world_from_key[match.edge.from] * match.edge.from_from_to *
                       apart_.keys.world_from_key[match.edge.to].Inverse();
      place.weight = std::max(0.0, match.inlier_ratio - 3.0 * match.conflict);
      place.match = std::move(match);
      places_.push_back(std::move(place));
    }
    return Status::Ok();
  }

  // Whether the two say the same of how b lies to a.
  bool Agree(const Place& one, const Place& other) const {
    const Pose2& key = apart_.keys.world_from_key[other.match.edge.to];
    const Pose2 apart = Between(other.a_from_b * key, one.a_from_b * key);
    const Pose2 way = Between(apart_.keys.world_from_key[one.match.edge.to], key);
    const double bent_m = kBentShare * way.translation().norm();
    return apart.translation().norm() <= kSameM + bent_m &&
           std::abs(NormalizeAngle(apart.yaw)) <= kSameRad;
  }

  // A way in which b may lie to a, and the keyframes of b at the places that say so.
  struct Way {
    const Place* place = nullptr;
    double votes = 0.0;
    std::vector<int> keys;  // ascending
  };

  // Of each keyframe that agrees the best place counts.
  Way WayOf(const Place& place) const {
    std::vector<std::pair<int, double>> of_key;
    for (const Place& other : places_) {
      if (Agree(place, other)) of_key.emplace_back(other.match.edge.to, other.weight);
    }
    std::sort(of_key.begin(), of_key.end());
    Way way;
    way.place = &place;
    for (std::size_t i = 0; i < of_key.size(); ++i) {
      if (i + 1 < of_key.size() && of_key[i + 1].first == of_key[i].first) continue;
      way.votes += of_key[i].second;
      way.keys.push_back(of_key[i].first);
    }
    return way;
  }

  // Those with the most votes that say different things.
  std::vector<Way> DistinctWays() const {
    std::vector<Way> all(places_.size());
    pool_->ForEachChunk(places_.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
      all[i] = WayOf(places_[i]);
    });
    std::stable_sort(all.begin(), all.end(),
                     [](const Way& a, const Way& b) { return a.votes > b.votes; });
    std::vector<Way> distinct;
    for (Way& way : all) {
      if (distinct.size() == kMaxAlignments) break;
      const bool is_known = std::any_of(distinct.begin(), distinct.end(), [&](const Way& other) {
        return Agree(*other.place, *way.place) || Agree(*way.place, *other.place);
      });
      if (!is_known) distinct.push_back(std::move(way));
    }
    return distinct;
  }

  Status Align(const Way& way, SessionAlignment* alignment) {
    alignment->group = Concatenated(a_, b_, way.place->a_from_b);
    KeyframeGraph& keys = alignment->group.keys;
    bool has_closure = false;
    for (const Place& place : places_) {
      if (place.match.outcome == ClosureOutcome::kAccepted && Agree(*way.place, place)) {
        keys.closures.push_back(place.match.edge);
        has_closure = true;
      }
    }
    if (!has_closure) keys.closures.push_back(way.place->match.edge);
    LoopClosingReport report;
    PLUMBLINE_RETURN_IF_ERROR(
        CloseLoops(set_.surfaces, progress_, pool_, &memory_, &keys, &report));
    std::vector<RelativePoseConstraint> across;
    for (const RelativePoseConstraint& closure : keys.closures) {
      if (closure.from < first_of_b() && closure.to >= first_of_b()) across.push_back(closure);
    }
    alignment->votes = way.votes;
    alignment->num_closures = static_cast<int>(across.size());
    alignment->num_witnesses = static_cast<int>(FindClosureClusters(across, keys).size());
    alignment->conflict = views_.Compare(alignment->group, first_of_b(), pool_);
    alignment->score =
        alignment->conflict.num_conflicting - kExplicableShare * alignment->conflict.num_compared;
    return Status::Ok();
  }

  void CountBentPlaces(SessionAlignment* alignment) const {
    const KeyframeGraph& keys = alignment->group.keys;
    const std::vector<TiedPlace> places =
        TestTiedPlaces(keys, first_of_b(), keys.size(), kBentRelief, pool_);
    const double limit = places.size() < kEnoughPlaces ? LoopAcceptance::kMaxRelief : kBentRelief;
    alignment->num_places = static_cast<int>(places.size());
    alignment->num_bent_places =
        static_cast<int>(std::count_if(places.begin(), places.end(), [&](const TiedPlace& place) {
          return place.relief > limit;
        }));
  }

  // Whether loops were closed to the same result from another way: most of b lies where it does
  // there. The rest may be bent.
  bool IsKnown(const SessionAlignment& alignment,
               const std::vector<SessionAlignment>& others) const {
    const KeyframeGraph& keys = alignment.group.keys;
    return std::any_of(others.begin(), others.end(), [&](const SessionAlignment& other) {
      int num_same = 0;
      for (int k = first_of_b(); k < keys.size(); ++k) {
        const Pose2 apart = Between(keys.world_from_key[k], other.group.keys.world_from_key[k]);
        if (apart.translation().norm() <= kSameM &&
            std::abs(NormalizeAngle(apart.yaw)) <= kSameRad) {
          ++num_same;
        }
      }
      return 2 * num_same > keys.size() - first_of_b();
    });
  }

  const SessionSet& set_;
  const SessionViews& views_;
  SessionPlaces* known_places_;
  const SessionGroup &a_, &b_;
  const SeedingProgress& progress_;
  ThreadPool* pool_;
  const SessionGroup apart_;
  std::vector<Place> places_;
  ClosureMemory memory_;
};

// Whether another alignment may be right as well as the best one.
bool IsRival(const SessionAlignment& other, const SessionAlignment& best) {
  return other.score <= kRivalShare * best.score ||
         (other.num_witnesses >= kMinWitnesses &&
          other.conflict.Share() <= best.conflict.Share() + kSameConflict);
}

}  // namespace

TieOutcome Judge(const std::vector<SessionAlignment>& alignments) {
  if (alignments.empty()) return TieOutcome::kNoMatch;
  const SessionAlignment& best = alignments.front();
  if (best.conflict.Share() > kMaxConflict) return TieOutcome::kContradicted;
  if (best.num_witnesses < kMinWitnesses) return TieOutcome::kFewPlaces;
  const bool has_rival =
      std::any_of(alignments.begin() + 1, alignments.end(),
                  [&](const SessionAlignment& other) { return IsRival(other, best); });
  if (has_rival) return TieOutcome::kAmbiguous;
  if (best.num_bent_places > kMaxBentShare * best.num_places) return TieOutcome::kBent;
  return TieOutcome::kTied;
}

SessionViews::SessionViews(const SessionSet& set) : peers_(set.graph.peers()), views_(set.size()) {
  for (int session = 0; session < set.size(); ++session) {
    const KeyframeGraph& keys = set.keys[session];
    double next_m = 0.0;
    for (int k = 0; k < keys.size(); ++k) {
      if (k > 0 && keys.keyframes[k].path_m < next_m) continue;
      next_m = keys.keyframes[k].path_m + kViewSpacingM;
      views_[session].push_back({k, set.surfaces.FreeSpaceOf(keys.keyframes[k].scan)});
    }
  }
}

FreeSpaceConflict SessionViews::Compare(const SessionGroup& group, int first_of_second,
                                        ThreadPool* pool) const {
  struct Placed {
    const FreeSpaceScan* scan;
    Pose2 world_from_robot;
  };
  std::vector<Placed> first, second;
  std::vector<double> places;
  for (std::size_t i = 0; i < group.sessions.size(); ++i) {
    for (const View& view : views_[group.sessions[i]]) {
      const int key = group.first_key[i] + view.key;
      const Pose2& pose = group.keys.world_from_key[key];
      (key < first_of_second ? first : second).push_back({&view.scan, pose});
      if (key < first_of_second) places.insert(places.end(), {pose.x, pose.y});
    }
  }
  const PointIndex index(std::move(places));
  std::vector<FreeSpaceConflict> of_view(second.size());
  const std::vector<std::size_t> own = OwnShare(peers_, second.size());
  pool->ForEachChunk(own.size(), 1, [&](std::size_t task, std::size_t, std::size_t) {
    const std::size_t i = own[task];
    std::vector<PointIndex::Neighbor> near;
    index.FindWithin(second[i].world_from_robot.translation(), kViewReachM, &near);
    const std::size_t count = std::min(near.size(), kMaxPartners);
    for (std::size_t n = 0; n < count; ++n) {
      const Placed& partner = first[near[(2 * n + 1) * near.size() / (2 * count)].point];
      of_view[i] += CompareBothWays(*partner.scan, *second[i].scan,
                                    Between(partner.world_from_robot, second[i].world_from_robot));
    }
  });
  FreeSpaceConflict all;
  for (const FreeSpaceConflict& conflict : of_view) all += conflict;
  std::vector<int> counts = {all.num_compared, all.num_conflicting};
  SumOverPeers(peers_, &counts);
  return {counts[0], counts[1]};
}

Status FindAlignments(const SessionSet& set, const SessionViews& views, SessionPlaces* places,
                      const SessionGroup& a, const SessionGroup& b, const SeedingProgress& progress,
                      ThreadPool* pool, std::vector<SessionAlignment>* alignments) {
  alignments->clear();
  return AlignmentSearch(set, views, places, a, b, progress, pool).Run(alignments);
}

}  // namespace plumbline
