#include "plumbline/solvers/sessions/session_places.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/peers.h"
#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/loop_closure/loop_candidates.h"

namespace plumbline {
namespace {

// Places per keyframe and square.
constexpr int kMaxPlaces = 4;
// Squares that each process searches at a time, where there are several.
constexpr std::size_t kSquaresPerProcess = 8;

}  // namespace

Status SessionPlaces::Find(const SessionGroup& a, const SessionGroup& b,
                           const SeedingProgress& progress, std::vector<TestedCandidate>* places) {
  places->clear();
  for (std::size_t i = 0; i < a.sessions.size(); ++i) {
    for (std::size_t j = 0; j < b.sessions.size(); ++j) {
      const int first = std::min(a.sessions[i], b.sessions[j]);
      const int second = std::max(a.sessions[i], b.sessions[j]);
      const std::vector<TestedCandidate>* between = nullptr;
      PLUMBLINE_RETURN_IF_ERROR(FindBetween(first, second, progress, &between));
      for (TestedCandidate place : *between) {
        if (first != a.sessions[i]) place.edge = Reversed(place.edge);
        place.edge.from += a.first_key[i];
        place.edge.to += a.keys.size() + b.first_key[j];
        places->push_back(std::move(place));
      }
    }
  }
  return Status::Ok();
}

Status SessionPlaces::FindBetween(int session, int later_session, const SeedingProgress& progress,
                                  const std::vector<TestedCandidate>** places) {
  const std::pair<int, int> both(session, later_session);
  auto found = known_.find(both);
  if (found == known_.end()) {
    std::vector<TestedCandidate> between;
    PLUMBLINE_RETURN_IF_ERROR(
        Search(GroupOfOne(set_, session), GroupOfOne(set_, later_session), progress, &between));
    found = known_.emplace(both, std::move(between)).first;
  }
  *places = &found->second;
  return Status::Ok();
}

Status SessionPlaces::Search(const SessionGroup& a, const SessionGroup& b,
                             const SeedingProgress& progress,
                             std::vector<TestedCandidate>* places) const {
  const KeyframeGraph apart = Concatenated(a, b, Pose2()).keys;
  const std::vector<LoopCandidate> wanted = FindSessionJoins(apart, a.keys.size());
  const Peers* peers = set_.graph.peers();
  const std::size_t squares_at_a_time =
      peers == nullptr ? 1 : kSquaresPerProcess * static_cast<std::size_t>(peers->size());
  auto end = wanted.begin();
  for (auto begin = wanted.begin(); begin != wanted.end(); begin = end) {
    if (progress && !progress(SeedingPhase::kTyingSessions, 0, 0)) {
      return Status::Unavailable("the alignment of sessions was stopped by its caller");
    }
    for (std::size_t square = 0; square < squares_at_a_time && end != wanted.end(); ++square) {
      const int middle = end->first;
      end = std::find_if(end, wanted.end(), [middle](const LoopCandidate& candidate) {
        return candidate.first != middle;
      });
    }
    for (TestedCandidate& place :
         FindPlaces(set_.surfaces, apart, {begin, end}, kMaxPlaces, pool_)) {
      place.edge.to -= a.keys.size();
      places->push_back(std::move(place));
    }
  }
  return Status::Ok();
}

RelativePoseConstraint Reversed(const RelativePoseConstraint& edge) {
  RelativePoseConstraint reversed{edge.to, edge.from, edge.from_from_to.Inverse()};
  // Of x, y and yaw of the inverse by those of the motion.
  const double c = std::cos(edge.from_from_to.yaw), s = std::sin(edge.from_from_to.yaw);
  Eigen::Matrix3d jacobian;
  jacobian << -c, -s, reversed.from_from_to.y,  //
      s, -c, -reversed.from_from_to.x,          //
      0.0, 0.0, -1.0;
  const Eigen::Matrix3d covariance = jacobian * edge.covariance * jacobian.transpose();
  reversed.covariance = 0.5 * (covariance + covariance.transpose());
  return reversed;
}

}  // namespace plumbline
