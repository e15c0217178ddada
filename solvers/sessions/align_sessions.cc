#include "plumbline/solvers/sessions/align_sessions.h"

#include <algorithm>
#include <utility>

#include "plumbline/solvers/sessions/session_alignment.h"

namespace plumbline {
namespace {

std::vector<int> Ascending(std::vector<int> sessions) {
  std::sort(sessions.begin(), sessions.end());
  return sessions;
}

// Where the seed of the group's first session puts its own frame.
Pose2 GroupFromSession(const SessionSet& set, const SessionGroup& group, int session) {
  const auto found = std::find(group.sessions.begin(), group.sessions.end(), session);
  const int key = group.first_key[found - group.sessions.begin()];
  return group.keys.world_from_key[key] * set.keys[session].world_from_key.front().Inverse();
}

// The groups at hand, and what every two of them have in common.
class Agglomeration {
 public:
  Agglomeration(const SessionSet& set, const SeedingProgress& progress, ThreadPool* pool)
      : set_(set),
        views_(set),
        places_(set, pool),
        progress_([this, &progress](SeedingPhase, int, int) { return Report(progress); }),
        pool_(pool) {}
  Agglomeration(const Agglomeration&) = delete;
  Agglomeration& operator=(const Agglomeration&) = delete;

  Status Run(std::vector<SessionGroup>* groups, std::vector<SessionTie>* ties) {
    for (int session = 0; session < set_.size(); ++session) {
      PLUMBLINE_RETURN_IF_ERROR(Add(GroupOfOne(set_, session)));
    }
    while (Pair* best = BestPair()) {
      ties->push_back(std::move(best->tie));
      const int first = best->first, second = best->second;
      SessionGroup tied = std::move(best->group);
      tied.parts = {Take(first), Take(second)};
      PLUMBLINE_RETURN_IF_ERROR(Add(std::move(tied)));
    }
    for (Pair& pair : pairs_) ties->push_back(std::move(pair.tie));
    for (Numbered& group : groups_) groups->push_back(std::move(group.group));
    std::sort(groups->begin(), groups->end(), [](const SessionGroup& a, const SessionGroup& b) {
      return a.sessions.front() < b.sessions.front();
    });
    return Status::Ok();
  }

 private:
  struct Numbered {
    int number;
    SessionGroup group;
  };
  struct Pair {
    int first, second;  // numbers of groups
    SessionTie tie;
    double score = 0.0;
    SessionGroup group;  // of both, if they are to be tied
  };

  // What closes loops does not know what they are for.
  bool Report(const SeedingProgress& progress) const {
    if (!progress) return true;
    const int most_pairs = (set_.size() - 1) * (set_.size() - 1);
    return progress(SeedingPhase::kTyingSessions, num_compared_, most_pairs);
  }

  Status Add(SessionGroup group) {
    for (const Numbered& other : groups_) {
      Pair pair{other.number, next_number_, {}, 0.0, {}};
      const bool is_first = group.sessions.front() < other.group.sessions.front();
      PLUMBLINE_RETURN_IF_ERROR(
          Compare(is_first ? group : other.group, is_first ? other.group : group, &pair));
      pairs_.push_back(std::move(pair));
      ++num_compared_;
    }
    groups_.push_back({next_number_++, std::move(group)});
    return Status::Ok();
  }

  Status Compare(const SessionGroup& a, const SessionGroup& b, Pair* pair) {
    pair->tie.first = Ascending(a.sessions);
    pair->tie.second = Ascending(b.sessions);
    if (a.keys.size() == 0 || b.keys.size() == 0) return Status::Ok();
    std::vector<SessionAlignment> alignments;
    PLUMBLINE_RETURN_IF_ERROR(
        FindAlignments(set_, views_, &places_, a, b, progress_, pool_, &alignments));
    pair->tie.outcome = Judge(alignments);
    if (alignments.empty()) return Status::Ok();
    SessionAlignment& best = alignments.front();
    pair->tie.first_from_second = Between(GroupFromSession(set_, best.group, a.sessions.front()),
                                          GroupFromSession(set_, best.group, b.sessions.front()));
    pair->tie.num_closures = best.num_closures;
    pair->tie.num_witnesses = best.num_witnesses;
    pair->tie.num_places = best.num_places;
    pair->tie.num_bent_places = best.num_bent_places;
    pair->tie.conflict = best.conflict;
    pair->score = best.score;
    if (pair->tie.outcome == TieOutcome::kTied) pair->group = std::move(best.group);
    return Status::Ok();
  }

  Pair* BestPair() {
    Pair* best = nullptr;
    for (Pair& pair : pairs_) {
      if (pair.tie.outcome != TieOutcome::kTied) continue;
      if (best == nullptr || pair.score < best->score) best = &pair;
    }
    return best;
  }

  // Out of the groups at hand.
  SessionGroup Take(int number) {
    pairs_.erase(std::remove_if(pairs_.begin(), pairs_.end(),
                                [number](const Pair& pair) {
                                  return pair.first == number || pair.second == number;
                                }),
                 pairs_.end());
    const auto taken =
        std::find_if(groups_.begin(), groups_.end(),
                     [number](const Numbered& group) { return group.number == number; });
    SessionGroup group = std::move(taken->group);
    groups_.erase(taken);
    return group;
  }

  const SessionSet& set_;
  const SessionViews views_;
  SessionPlaces places_;
  const SeedingProgress progress_;
  ThreadPool* pool_;
  int num_compared_ = 0;
  int next_number_ = 0;
  std::vector<Numbered> groups_;
  std::vector<Pair> pairs_;  // of all groups that there are
};

}  // namespace

Status AlignSessions(const SessionSet& set, const SeedingProgress& progress, ThreadPool* pool,
                     std::vector<SessionGroup>* groups, std::vector<SessionTie>* ties) {
  groups->clear();
  ties->clear();
  return Agglomeration(set, progress, pool).Run(groups, ties);
}

}  // namespace plumbline
