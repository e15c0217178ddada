#include "plumbline/solvers/loop_closure/map_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/odometry_headings.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/closure_clusters.h"
#include "plumbline/solvers/loop_closure/closure_memory.h"
#include "plumbline/solvers/loop_closure/closure_revisions.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/loop_closure/map_judge.h"
#include "plumbline/solvers/loop_closure/part_joins.h"
#include "plumbline/solvers/loop_closure/rematch_at_breaks.h"
#include "plumbline/solvers/loop_closure/rematch_at_leaps.h"
#include "plumbline/solvers/loop_closure/steps_in_question.h"
#include "plumbline/solvers/loop_closure/strained_stretches.h"
#include "plumbline/solvers/loop_closure/suspect_clusters.h"
#include "plumbline/solvers/loop_closure/suspect_edges.h"
#include "plumbline/solvers/loop_closure/tied_places.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {
namespace {

// Limits bound the work. What has to do with carried robots was tuned on the floors of the seeding
// study (apps/benchmark), kSoundOdometry on mit-killian, infinite-corridor, acapulco and fr-clinic.

// At most so often a cluster is found wrong, or such a match right.
constexpr int kMaxRevisions = 6;
// Clusters that are weighed at a time.
constexpr std::size_t kClustersAtATime = 4;
// One of them that brings this share of what is enough is followed up before others are weighed.
constexpr double kPromisingGain = 0.5;
// At most so often the closures of a session with others at one place are found wrong.
constexpr int kMostBentPlaces = 12;
// At most so many steps are taken as wrong without a closure that says so, one at a time.
constexpr int kMaxForcedBreaks = 3;
// At most so many steps are looked at as ones over which the robot may have been carried anywhere.
constexpr int kMostCarried = 3;
// Places, the best by their maps, that are tried with closures where a robot may have been carried.
constexpr std::size_t kMostJoins = 4;
// Places where a robot may have been carried to differ in likelihood by what conflicts, and by how
// far it would have been: a metre counts as much as this many conflicting returns.
constexpr double kReturnsPerM = 50.0;
// Another such place is as good if this share of what is explicable, at most, comes with it.
constexpr double kNoContradiction = 1.0 / 3.0;
// The odometry is worth a search of its own if its map has no more than this times the conflicts
// that can be explained.
constexpr double kSoundOdometry = 2.0;

class HypothesisSearch {
 public:
  HypothesisSearch(const MotionOptions& motion, const ScanSurfaces& surfaces,
                   const SeedingProgress& progress, ThreadPool* pool,
                   const SequentialTrajectory& matched, const KeyframeGraph* ties,
                   std::vector<WeighedHypothesis>* weighed)
      : motion_(motion),
        graph_(surfaces.graph()),
        surfaces_(surfaces),
        progress_(progress),
        pool_(pool),
        matched_(matched),
        ties_(ties),
        weighed_(*weighed),
        meter_(surfaces.graph(), matched.world_from_robot, pool),
        judge_(/*of_one_session=*/ties == nullptr) {}

  Status Run(MapHypothesis* best) {
    suspected_ = ties_ != nullptr ? *ties_ : MakeKeyframeGraph(matched_, motion_);
    MarkSuspectEdges(surfaces_, matched_.world_from_robot, pool_, &suspected_);
    PLUMBLINE_RETURN_IF_ERROR(Begin(HypothesisKind::kMatching, matched_, suspected_, best));
    PLUMBLINE_RETURN_IF_ERROR(TryOdometry(best));
    PLUMBLINE_RETURN_IF_ERROR(ReviseClosures(best));
    PLUMBLINE_RETURN_IF_ERROR(DropBentPlaces(best));
    PLUMBLINE_RETURN_IF_ERROR(TryBreaks(best));
    PLUMBLINE_RETURN_IF_ERROR(TryJoins(best));
    TakeBestWeighed(best);
    PLUMBLINE_RETURN_IF_ERROR(TryOdometryHeadings(best));
    for (SuspectStep& suspect : best->loops.suspect_steps) {
      const auto found = num_alternatives_.find(suspect.first_pose_after);
      if (found != num_alternatives_.end()) suspect.num_alternatives = found->second;
    }
    for (const std::size_t record : best->records) weighed_[record].adopted = true;
    return Status::Ok();
  }

 private:
  Status TryOdometry(MapHypothesis* best) {
    if (LacksOdometry(graph_) || ties_ != nullptr) return Status::Ok();
    SequentialTrajectory odometry = matched_;
    odometry.world_from_robot = PosesOf(graph_.initial_poses());
    MapHypothesis given;
    given.kind = HypothesisKind::kOdometryAlone;
    given.start = odometry;
    given.keys = MakeKeyframeGraph(odometry, motion_);
    given.world_from_robot = odometry.world_from_robot;
    given.consistency = meter_.Measure(given.world_from_robot, pool_);
    Weigh(&given);
    if (IsWorthASearch(given.consistency, *best)) {
      MapHypothesis closed;
      PLUMBLINE_RETURN_IF_ERROR(Begin(HypothesisKind::kOdometry, odometry,
                                      MakeKeyframeGraph(odometry, motion_), &closed));
      if (judge_.Score(closed.consistency) <= judge_.Score(given.consistency))
        given = std::move(closed);
    }
    if (IsComparable(given.consistency, best->consistency) &&
        judge_.IsBetter(given.consistency, best->consistency)) {
      *best = std::move(given);
    }
    return Status::Ok();
  }

  // A matching whose heading drifts leads to where nothing was seen before, and nothing conflicts.
  // That more passes meet speaks for the odometry's headings, unless they conflict. The odometry is
  // the one as given: its errors were told from this matching, and would be its drift.
  Status TryOdometryHeadings(MapHypothesis* best) {
    if (LacksOdometry(graph_) || ties_ != nullptr || best->kind != HypothesisKind::kMatching ||
        !judge_.IsSuspicious(best->consistency)) {
      return Status::Ok();
    }
    const SequentialTrajectory start =
        WithOdometryHeadings(matched_, PosesOf(graph_.initial_poses()), motion_);
    KeyframeGraph keys = MakeKeyframeGraph(start, motion_);
    MarkSuspectEdges(surfaces_, start.world_from_robot, pool_, &keys);
    MapHypothesis turned;
    PLUMBLINE_RETURN_IF_ERROR(
        Begin(HypothesisKind::kOdometryHeadings, start, std::move(keys), &turned));
    PLUMBLINE_RETURN_IF_ERROR(ReviseClosures(&turned));
    const double met = static_cast<double>(best->consistency.between_passes.num_compared);
    const bool meets_more = turned.keys.closures.size() > best->keys.closures.size() &&
                            turned.consistency.between_passes.num_compared >
                                (1.0 + LoopAcceptance::kMinMeetingGain) * met;
    // What is compared on top must conflict no more than a part that is right may, and no place
    // more than one did before.
    FreeSpaceConflict newly_met = turned.consistency.between_passes;
    newly_met -= best->consistency.between_passes;
    const double ratio = MapConsistency::RatioOf(newly_met, judge_.explicable_share());
    const bool conflicts_more =
        ratio > MapConsistency::kMaxRatio || turned.consistency.Ratio() > best->consistency.Ratio();
    if (meets_more && !conflicts_more) *best = std::move(turned);
    return Status::Ok();
  }

  // Closures between sessions that bend them, the worst place first. The graph has spoken against
  // them: free space, which does not see shifts of decimetres, need only not speak for them.
  Status DropBentPlaces(MapHypothesis* best) {
    if (ties_ == nullptr) return Status::Ok();
    for (int i = 0; i < kMostBentPlaces; ++i) {
      PLUMBLINE_RETURN_IF_ERROR(CheckStop());
      const TiedPlace worst = MostBentPlace(best->keys, pool_);
      if (!worst.is_bent()) break;
      MapHypothesis other;
      other.kind = best->kind;
      other.start = best->start;
      other.keys = Without(worst.closures, best->keys);
      PLUMBLINE_RETURN_IF_ERROR(Close(&other));
      other.records = best->records;
      other.records.push_back(weighed_.size());
      RecordRevision(HypothesisKind::kWithoutCluster, worst.closures, best->keys,
                     other.consistency);
      if (judge_.IsBetter(best->consistency, other.consistency)) break;
      *best = std::move(other);
    }
    return Status::Ok();
  }

  // Steps of the sequential matching as wrong as closures say, or as it takes.
  Status TryBreaks(MapHypothesis* best) {
    if (best->kind != HypothesisKind::kMatching) return Status::Ok();
    if (judge_.PassesDisagree(best->consistency)) MarkStepAt(best->consistency.worst_within.pose);
    const std::vector<int> suspects = MostSuspectSteps(suspected_);
    KeyframeGraph in_question = suspected_;
    in_question.refused = best->keys.refused;
    for (const int step : suspects) in_question.sequential[step].in_question = true;
    if (!suspects.empty() && (judge_.IsSuspicious(best->consistency) ||
                              best->loops.IsUnresolved() || GivesWay(suspects, best->keys))) {
      PLUMBLINE_RETURN_IF_ERROR(TryBreak(in_question, best));
      for (int i = 0; i < kMaxForcedBreaks && i < static_cast<int>(suspects.size()); ++i) {
        if (!judge_.IsSuspicious(best->consistency)) break;
        KeyframeGraph forced = in_question;
        forced.sequential[suspects[i]].broken = true;
        PLUMBLINE_RETURN_IF_ERROR(TryBreak(forced, best));
      }
    }
    return TrySharedOut(in_question, best);
  }

  // Marks the step near a pose whose sides agree worst, however little evidence that is: a robot
  // that was carried from one of many like places to another sees little that conflicts.
  void MarkStepAt(int pose) {
    constexpr int kNearKeys = 8;
    const auto key =
        std::find_if(suspected_.keyframes.begin(), suspected_.keyframes.end(),
                     [pose](const Keyframe& keyframe) { return keyframe.pose >= pose; });
    const int at = static_cast<int>(key - suspected_.keyframes.begin());
    const int first = std::max(0, at - kNearKeys);
    const int end = std::min(at + kNearKeys, suspected_.size() - 1);
    if (first >= end) return;
    KeyframeGraph marked = suspected_;
    const int step = MarkWorstEdge(surfaces_, matched_.world_from_robot, first, end, &marked);
    SequentialEdge& edge = suspected_.sequential[step];
    if (edge.evidence > 0.0) return;
    edge = marked.sequential[step];
    // Not in proportion to what is usual on the drive, so no reason to trust nothing across it.
    edge.evidence = std::min(edge.evidence, 0.9 * SuspectStep::kUntrustedEvidence);
  }

  // A step that is held as firmly as its neighbours shares its error out among all that lie between
  // two closures: no edge is far off then, and the map contradicts itself a little, everywhere.
  Status TrySharedOut(const KeyframeGraph& in_question, MapHypothesis* best) {
    KeyframeGraph marked = in_question;
    std::vector<int> steps =
        MostStrainedSteps(surfaces_, matched_.world_from_robot, best->keys, &marked);
    std::stable_sort(steps.begin(), steps.end(), [&](int a, int b) {
      return marked.sequential[a].evidence > marked.sequential[b].evidence;
    });
    if (steps.size() > kMaxStepsInQuestion) steps.resize(kMaxStepsInQuestion);
    int num_tried = 0;
    for (const int step : steps) {
      if (!LeadsElsewhere(step, best->keys)) continue;
      if (++num_tried > kMaxForcedBreaks) break;
      KeyframeGraph forced = WithContradicted(best->keys);
      forced.sequential[step] = marked.sequential[step];
      forced.sequential[step].in_question = forced.sequential[step].broken = true;
      // Other steps were in question when it was filled.
      memories_.erase(HypothesisKind::kBrokenSteps);
      MapHypothesis broken;
      PLUMBLINE_RETURN_IF_ERROR(MakeBroken(forced, &broken));
      // The graph has spoken against the step: the map need not do it again.
      if (judge_.Score(broken.consistency) < judge_.Score(best->consistency))
        *best = std::move(broken);
    }
    return Status::Ok();
  }

  // What lies beyond a wrong step may be anywhere. One step after the other, the worst first.
  Status TryJoins(MapHypothesis* best) {
    if (best->kind != HypothesisKind::kMatching && best->kind != HypothesisKind::kBrokenSteps) {
      return Status::Ok();
    }
    int num_tried = 0;
    for (const int step : MostSuspectSteps(suspected_)) {
      const bool is_suspect =
          suspected_.sequential[step].evidence >= SuspectStep::kUntrustedEvidence &&
          judge_.IsSuspicious(best->consistency);
      if (!is_suspect && !IsOpen(step, *best)) continue;
      if (++num_tried > kMostCarried) break;
      PLUMBLINE_RETURN_IF_ERROR(TryJoinsAt(step, best));
    }
    return Status::Ok();
  }

  Status TryJoinsAt(int step, MapHypothesis* best) {
    std::vector<KeyframeGraph> joins;
    PLUMBLINE_RETURN_IF_ERROR(FindJoinsByMap(step, *best, &joins));
    // If closures tie it to where it is, that is one of the places.
    const bool is_tied =
        SuspectAt(step, best->loops).num_closures_across >= LoopAcceptance::kMinClosuresAcross;
    std::vector<MapHypothesis> places;
    if (is_tied) places.push_back(*best);
    // Other steps were in question when it was filled.
    memories_.erase(HypothesisKind::kJoinedParts);
    for (KeyframeGraph& keys : joins) {
      PLUMBLINE_RETURN_IF_ERROR(CheckStop());
      MapHypothesis joined;
      joined.kind = HypothesisKind::kJoinedParts;
      joined.start = best->start;
      joined.keys = std::move(keys);
      PLUMBLINE_RETURN_IF_ERROR(Close(&joined));
      const bool is_known = std::any_of(
          places.begin(), places.end(),
          [&](const MapHypothesis& other) { return IsSameJoin(step, joined.keys, other.keys); });
      if (is_known) continue;
      WeighJoin(step, *best, &joined);
      if (is_tied || judge_.IsBetter(joined.consistency, best->consistency)) {
        places.push_back(std::move(joined));
      }
    }
    if (!places.empty()) TakeLikeliest(step, &places, best);
    return Status::Ok();
  }

  // Ways to put the parts together, the best by their maps first.
  Status FindJoinsByMap(int step, const MapHypothesis& hypothesis,
                        std::vector<KeyframeGraph>* joins) const {
    PLUMBLINE_RETURN_IF_ERROR(CheckStop());
    std::vector<KeyframeGraph> all = JoinParts(surfaces_, hypothesis.keys, step, pool_);
    PLUMBLINE_RETURN_IF_ERROR(CheckStop());
    const std::vector<MapConsistency> maps = MeasureAll(all, hypothesis.start);
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return judge_.Score(maps[a]) < judge_.Score(maps[b]);
    });
    if (order.size() > kMostJoins) order.resize(kMostJoins);
    for (const std::size_t i : order) joins->push_back(std::move(all[i]));
    return Status::Ok();
  }

  void WeighJoin(int step, const MapHypothesis& before, MapHypothesis* joined) {
    Weigh(joined);
    weighed_.back().first_pose_after = suspected_.sequential[step].first_pose_after;
    weighed_.back().carried_to = StepAt(step, joined->keys);
    // What was found before about closures and other steps is still in force.
    for (const std::size_t record : before.records) {
      const HypothesisKind kind = weighed_[record].kind;
      if (kind != HypothesisKind::kMatching && kind != HypothesisKind::kBrokenSteps) {
        joined->records.push_back(record);
      }
    }
  }

  // Between places where loop closing asks by itself.
  Status CheckStop() const {
    if (!progress_ || progress_(SeedingPhase::kClosingLoops, 0, 0)) return Status::Ok();
    return Status::Unavailable("loop closing was stopped by its caller");
  }

  // Of the places where what lies beyond a step may be.
  void TakeLikeliest(int step, std::vector<MapHypothesis>* places, MapHypothesis* best) {
    const auto share_within = [](const MapHypothesis& place) {
      return place.consistency.within_pass.Share();
    };
    double usual_share = share_within(places->front());
    for (const MapHypothesis& place : *places) {
      usual_share = std::min(usual_share, share_within(place));
    }
    const auto excess = [&](const MapHypothesis& place) {
      const FreeSpaceConflict all = place.consistency.AllConflicts();
      return all.num_conflicting - usual_share * all.num_compared;
    };
    const SequentialEdge& edge = suspected_.sequential[step];
    const auto cost = [&](const MapHypothesis& place) {
      const Pose2 carried = Between(edge.constraint.from_from_to, StepAt(step, place.keys));
      return excess(place) + kReturnsPerM * std::hypot(carried.x, carried.y);
    };
    const auto likeliest = std::min_element(
        places->begin(), places->end(),
        [&](const MapHypothesis& a, const MapHypothesis& b) { return cost(a) < cost(b); });
    const auto compared_of_part = [&](const MapHypothesis& place) {
      return ComparedOfLesserPart(place.consistency, edge.first_pose_after);
    };
    // Where nothing shows that the step was wrong, it stays.
    if (!IsOpen(step, *best) && IsSameJoin(step, likeliest->keys, best->keys)) return;
    int& num_alternatives = num_alternatives_[edge.first_pose_after];
    for (auto place = places->begin(); place != places->end(); ++place) {
      const double explicable = judge_.explicable_share() *
                                std::max(compared_of_part(*place), compared_of_part(*likeliest));
      if (place != likeliest && cost(*place) - cost(*likeliest) <= kNoContradiction * explicable) {
        ++num_alternatives;
      }
    }
    *best = std::move(*likeliest);
  }

  // Whether the hypothesis itself says that the step leads, or may lead, to somewhere else.
  bool IsOpen(int step, const MapHypothesis& hypothesis) const {
    return hypothesis.keys.sequential[step].broken ||
           SuspectAt(step, hypothesis.loops).IsUnresolved();
  }

  // One that was not marked when the loops were closed was nothing to them.
  SuspectStep SuspectAt(int step, const LoopClosingReport& loops) const {
    const int pose = suspected_.sequential[step].first_pose_after;
    const auto found =
        std::find_if(loops.suspect_steps.begin(), loops.suspect_steps.end(),
                     [pose](const SuspectStep& d) { return d.first_pose_after == pose; });
    return found != loops.suspect_steps.end() ? *found : SuspectStep();
  }

  Status TryBreak(const KeyframeGraph& keys, MapHypothesis* best) {
    MapHypothesis broken;
    PLUMBLINE_RETURN_IF_ERROR(MakeBroken(keys, &broken));
    if (judge_.IsBetter(broken.consistency, best->consistency)) *best = std::move(broken);
    return Status::Ok();
  }

  Status MakeBroken(const KeyframeGraph& keys, MapHypothesis* broken) {
    broken->kind = HypothesisKind::kBrokenSteps;
    broken->start = matched_;
    broken->keys = keys;
    PLUMBLINE_RETURN_IF_ERROR(Close(broken));
    Weigh(broken);
    return Status::Ok();
  }

  // Whether passes are compared as much, about: where they have nothing in common, none conflicts.
  static bool IsComparable(const MapConsistency& map, const MapConsistency& other) {
    return 2.0 * map.between_passes.num_compared >= other.between_passes.num_compared;
  }

  // The steps above compare each hypothesis with the best one before it, so their order matters.
  // The score compares all. Among places that look alike it does not decide: no relocated segments
  // here.
  void KeepIfBest(const MapHypothesis& hypothesis) {
    const bool is_candidate = hypothesis.kind == HypothesisKind::kMatching ||
                              hypothesis.kind == HypothesisKind::kBrokenSteps;
    if (ties_ != nullptr || !is_candidate) return;
    if (!best_weighed_ ||
        judge_.Score(hypothesis.consistency) < judge_.Score(best_weighed_->consistency)) {
      best_weighed_ = hypothesis;
    }
  }

  void TakeBestWeighed(MapHypothesis* best) {
    const auto score = [this](const MapHypothesis& h) { return judge_.Score(h.consistency); };
    if (best_weighed_ && score(*best_weighed_) < score(*best)) *best = std::move(*best_weighed_);
  }

  void Weigh(MapHypothesis* hypothesis) {
    WeighedHypothesis weighed;
    weighed.kind = hypothesis->kind;
    weighed.num_closures = static_cast<int>(hypothesis->keys.closures.size());
    weighed.conflict = hypothesis->consistency.AllConflicts();
    weighed.score = judge_.Score(hypothesis->consistency);
    weighed.world_from_robot = hypothesis->world_from_robot;
    hypothesis->records = {weighed_.size()};
    weighed_.push_back(weighed);
    KeepIfBest(*hypothesis);
  }

  bool IsWorthASearch(const MapConsistency& odometry, const MapHypothesis& best) const {
    return odometry.between_passes.num_compared > 0 &&
           odometry.between_passes.Share() <= kSoundOdometry * judge_.explicable_share() &&
           judge_.IsSuspicious(best.consistency);
  }

  // Closes the loops of a start.
  Status Begin(HypothesisKind kind, const SequentialTrajectory& start, KeyframeGraph keys,
               MapHypothesis* best) {
    best->kind = kind;
    best->start = start;
    best->keys = std::move(keys);
    PLUMBLINE_RETURN_IF_ERROR(Close(best));
    if (kind == HypothesisKind::kMatching) judge_.TakeMeasure(best->consistency);
    Weigh(best);
    return Status::Ok();
  }

  // Drops clusters of closures that the map contradicts, and takes in matches that it lacks.
  Status ReviseClosures(MapHypothesis* best) {
    for (int i = 0; i < kMaxRevisions && judge_.IsSuspicious(best->consistency); ++i) {
      const std::vector<Revision> suspects =
          SuspectClusters(best->keys, best->consistency, judge_.explicable_share());
      bool revised = false;
      PLUMBLINE_RETURN_IF_ERROR(Revise(HypothesisKind::kWithoutCluster, suspects, best, &revised));
      if (!revised) {
        PLUMBLINE_RETURN_IF_ERROR(Revise(HypothesisKind::kWithoutCluster,
                                         WithRepetitions(suspects, best->keys), best, &revised));
      }
      if (!revised) {
        PLUMBLINE_RETURN_IF_ERROR(
            Revise(HypothesisKind::kWithMatch, TentativeMatches(best->keys), best, &revised));
      }
      if (!revised) break;
    }
    return Status::Ok();
  }

  Status Close(MapHypothesis* hypothesis) {
    PLUMBLINE_RETURN_IF_ERROR(CloseLoops(surfaces_, progress_, pool_, &memories_[hypothesis->kind],
                                         &hypothesis->keys, &hypothesis->loops));
    Place(hypothesis);
    hypothesis->consistency = meter_.Measure(hypothesis->world_from_robot, pool_);
    return Status::Ok();
  }

  void Place(MapHypothesis* hypothesis) const {
    hypothesis->world_from_robot =
        PosesFollowingKeyframes(hypothesis->keys, hypothesis->start.world_from_robot);
    RematchAtBreaks(surfaces_, hypothesis->keys, hypothesis->start.odometry, motion_,
                    &hypothesis->world_from_robot);
    RematchAtLeaps(surfaces_, hypothesis->keys, hypothesis->start.odometry, motion_, pool_,
                   &hypothesis->world_from_robot);
  }

  // The maps of graphs of the start's keyframes.
  std::vector<MapConsistency> MeasureAll(const std::vector<KeyframeGraph>& keys,
                                         const SequentialTrajectory& start) const {
    std::vector<std::vector<Pose2>> maps(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      maps[i] = PosesFollowingKeyframes(keys[i], start.world_from_robot);
    }
    return meter_.MeasureEach(maps, pool_);
  }

  // A revision of a hypothesis, before loops are closed again.
  struct Trial {
    KeyframeGraph keys;
    MapConsistency map;
    std::size_t record;
  };

  // Revises the hypothesis in the way that makes its map the best, if one of them makes it better.
  // Loops are closed again for that one alone. Clusters come in order of suspicion, and those that
  // are wrong are among the first: the others are spared if one of these brings most of what is
  // enough. Matches are all weighed; they are few, and many of them bring something.
  Status Revise(HypothesisKind kind, const std::vector<Revision>& revisions, MapHypothesis* best,
                bool* revised) {
    const bool are_clusters = kind == HypothesisKind::kWithoutCluster;
    const std::size_t at_a_time = are_clusters ? kClustersAtATime : revisions.size();
    std::vector<Trial> trials;
    for (std::size_t begin = 0; begin < revisions.size(); begin += at_a_time) {
      const std::size_t end = std::min(begin + at_a_time, revisions.size());
      WeighRevisions(kind, {revisions.begin() + begin, revisions.begin() + end}, *best, &trials);
      const auto likeliest =
          std::min_element(trials.begin(), trials.end(), [&](const Trial& a, const Trial& b) {
            return judge_.Score(a.map) < judge_.Score(b.map);
          });
      const double gain = judge_.Gain(likeliest->map, best->consistency);
      if (end < revisions.size() && gain < kPromisingGain) continue;
      // A cluster that is wrong shows as soon as it is gone. What a match brings may take the
      // closures that come into reach with it.
      if (are_clusters && gain <= 0.0) continue;
      PLUMBLINE_RETURN_IF_ERROR(FollowUp(std::move(*likeliest), best, revised));
      if (*revised) break;
      trials.erase(likeliest);
    }
    return Status::Ok();
  }

  void WeighRevisions(HypothesisKind kind, const std::vector<Revision>& revisions,
                      const MapHypothesis& best, std::vector<Trial>* trials) {
    std::vector<KeyframeGraph> keys;
    keys.reserve(revisions.size());
    for (const Revision& revision : revisions) {
      keys.push_back(kind == HypothesisKind::kWithoutCluster ? Without(revision, best.keys)
                                                             : With(revision, best.keys));
    }
    OptimizeEach(graph_.peers(), pool_, &keys);
    std::vector<MapConsistency> maps = MeasureAll(keys, best.start);
    for (std::size_t i = 0; i < revisions.size(); ++i) {
      RecordRevision(kind, revisions[i], best.keys, maps[i]);
      trials->push_back({std::move(keys[i]), std::move(maps[i]), weighed_.size() - 1});
    }
  }

  // Closes the loops of a revision, and adopts it if that makes the map better.
  Status FollowUp(Trial trial, MapHypothesis* best, bool* adopted) {
    MapHypothesis other;
    other.kind = best->kind;
    other.start = best->start;
    other.keys = std::move(trial.keys);
    PLUMBLINE_RETURN_IF_ERROR(Close(&other));
    *adopted = judge_.IsBetter(other.consistency, best->consistency);
    if (!*adopted) return Status::Ok();
    other.records = best->records;
    other.records.push_back(trial.record);
    weighed_[trial.record].conflict = other.consistency.AllConflicts();
    weighed_[trial.record].score = judge_.Score(other.consistency);
    KeepIfBest(other);
    *best = std::move(other);
    return Status::Ok();
  }

  void RecordRevision(HypothesisKind kind, const Revision& revision, const KeyframeGraph& keys,
                      const MapConsistency& map) {
    WeighedHypothesis trial = RecordOf(kind, revision, keys);
    trial.conflict = map.AllConflicts();
    trial.score = judge_.Score(map);
    weighed_.push_back(std::move(trial));
  }

  const MotionOptions& motion_;
  const SlamGraph& graph_;
  const ScanSurfaces& surfaces_;
  const SeedingProgress& progress_;
  ThreadPool* pool_;
  const SequentialTrajectory& matched_;
  const KeyframeGraph* ties_;  // of several sessions; null: the drive is one
  std::vector<WeighedHypothesis>& weighed_;
  const ConsistencyMeter meter_;
  MapJudge judge_;  // measured by the matching's map
  // Surroundings of keyframes depend on the start, and on which steps are in question.
  std::map<HypothesisKind, ClosureMemory> memories_;
  std::optional<MapHypothesis> best_weighed_;  // by the score; matching and broken steps
  std::map<int, int> num_alternatives_;        // of suspect steps, by the first pose after them
  KeyframeGraph suspected_;  // of the matching, with the evidence against its steps
};

}  // namespace

Status SearchMapHypotheses(const MotionOptions& motion, const ScanSurfaces& surfaces,
                           const SeedingProgress& progress, ThreadPool* pool,
                           const SequentialTrajectory& matched, const KeyframeGraph* ties,
                           MapHypothesis* best, std::vector<WeighedHypothesis>* weighed) {
  weighed->clear();
  HypothesisSearch search(motion, surfaces, progress, pool, matched, ties, weighed);
  return search.Run(best);
}

}  // namespace plumbline
