#include "plumbline/solvers/incremental/active_problem.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "plumbline/core/sort_unique.h"
#include "plumbline/solvers/landmarks/return_residual.h"
#include "plumbline/solvers/landmarks/world_moments.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"
#include "plumbline/solvers/terms/terms.h"

namespace plumbline {
namespace {

constexpr int kOutside = -1;
constexpr std::size_t kSummedUp = static_cast<std::size_t>(-1);  // of observations that are held

}  // namespace

ActiveProblem::ActiveProblem(const std::vector<int>& active, const SlamGraph& graph,
                             const EdgesByPose& edges, const LandmarkStore& store,
                             const std::vector<double>& all_poses, ThreadPool* pool)
    : num_active_(active.size()), part_of_pose_(graph.num_poses(), kOutside) {
  pose_ids.push_back(kOutside);
  // Near the others: moments about a far-away origin would lose digits.
  poses = {all_poses[3 * active.front()], all_poses[3 * active.front() + 1], 0.0};
  terms.is_constant.push_back(true);
  for (const int id : active) terms.is_constant[PoseInPart(id, all_poses)] = false;
  for (const FixedPose& fixed : graph.fixed_poses()) {
    const int part = part_of_pose_[fixed.pose];
    if (part != kOutside) terms.is_constant[part] = true;
  }
  AddEdges(edges, all_poses);
  AddObservations(store, all_poses, pool);
}

// New ones are constant.
int ActiveProblem::PoseInPart(int id, const std::vector<double>& all_poses) {
  int& part = part_of_pose_[id];
  if (part == kOutside) {
    part = static_cast<int>(pose_ids.size());
    pose_ids.push_back(id);
    poses.insert(poses.end(), &all_poses[3 * id], &all_poses[3 * id] + 3);
    terms.is_constant.push_back(true);
  }
  return part;
}

void ActiveProblem::AddEdges(const EdgesByPose& edges, const std::vector<double>& all_poses) {
  std::vector<std::size_t> motions, relative_poses, factors;
  for (std::size_t part = 1; part <= num_active_; ++part) {
    const auto append = [](const std::vector<std::size_t>& of_pose, std::vector<std::size_t>* all) {
      all->insert(all->end(), of_pose.begin(), of_pose.end());
    };
    append(edges.MotionsOf(pose_ids[part]), &motions);
    append(edges.RelativePosesOf(pose_ids[part]), &relative_poses);
    append(edges.FactorsOf(pose_ids[part]), &factors);
  }
  const auto in_part = [&](const std::vector<PoseEdge>& all, std::vector<std::size_t>* indices) {
    SortUnique(indices);
    std::vector<PoseEdge> chosen;
    chosen.reserve(indices->size());
    for (const std::size_t i : *indices) {
      chosen.push_back(all[i]);
      chosen.back().from = PoseInPart(all[i].from, all_poses);
      chosen.back().to = PoseInPart(all[i].to, all_poses);
    }
    return chosen;
  };
  terms.terms = {MakeMotionTerm(in_part(edges.motions(), &motions)),
                 MakeRelativePoseTerm(in_part(edges.relative_poses(), &relative_poses))};
  SortUnique(&factors);
  std::vector<CustomFactor> factors_in_part;
  for (const std::size_t i : factors) {
    factors_in_part.push_back(edges.factors()[i]);
    for (int& id : factors_in_part.back().poses) id = PoseInPart(id, all_poses);
  }
  for (const auto& term : MakeFactorTerms(factors_in_part)) terms.terms.push_back(term);
}

void ActiveProblem::AddObservations(const LandmarkStore& store,
                                    const std::vector<double>& all_poses, ThreadPool* pool) {
  for (std::size_t part = 1; part <= num_active_; ++part) {
    const std::vector<int>& seen = store.LandmarksOfPose(pose_ids[part]);
    landmark_ids.insert(landmark_ids.end(), seen.begin(), seen.end());
  }
  SortUnique(&landmark_ids);

  observations.first_of_pose.assign(pose_ids.size() + 1, 0);
  // The sum of the held ones comes first, if there are any.
  constexpr std::size_t kLandmarksPerChunk = 64;
  const auto for_each_landmark = [&](const auto& body) {
    pool->ForEachChunk(landmark_ids.size(), kLandmarksPerChunk,
                       [&](std::size_t, std::size_t begin, std::size_t end) {
                         for (std::size_t p = begin; p < end; ++p) {
                           body(store.landmarks()[landmark_ids[p]], p);
                         }
                       });
  };
  observations.first_of_landmark.assign(landmark_ids.size() + 1, 0);
  for_each_landmark([&](const StoredLandmark& landmark, std::size_t p) {
    const std::size_t num_active =
        std::count_if(landmark.observations.begin(), landmark.observations.end(),
                      [this](const StoredObservation& o) { return IsActive(o.moments.pose); });
    const bool has_held = num_active < landmark.observations.size();
    observations.first_of_landmark[p + 1] = num_active + (has_held ? 1 : 0);
  });
  std::partial_sum(observations.first_of_landmark.begin(), observations.first_of_landmark.end(),
                   observations.first_of_landmark.begin());
  landmarks.resize(landmark_ids.size());
  observations.observations.resize(observations.first_of_landmark.back());
  in_store_.resize(observations.first_of_landmark.back());
  for_each_landmark(
      [&](const StoredLandmark& landmark, std::size_t p) { ReadLandmark(landmark, p, all_poses); });
}

bool ActiveProblem::IsActive(int id) const {
  const int part = part_of_pose_[id];
  return part != kOutside && static_cast<std::size_t>(part) <= num_active_;
}

void ActiveProblem::ReadLandmark(const StoredLandmark& landmark, std::size_t p,
                                 const std::vector<double>& all_poses) {
  landmarks[p] = landmark.line;
  std::size_t next = observations.first_of_landmark[p];
  const auto add = [&](LineObservation observation, int part, std::size_t in_store) {
    observation.pose = part;
    observation.landmark = static_cast<int>(p);
    in_store_[next] = in_store;
    observations.observations[next++] = observation;
  };
  PointMoments held;
  std::size_t num_held = 0;
  for (const StoredObservation& stored : landmark.observations) {
    if (IsActive(stored.moments.pose)) continue;
    ++num_held;
    AddWorldMoments(stored.moments, PoseFrame(&all_poses[3 * stored.moments.pose]),
                    {poses[0], poses[1]}, &held);
  }
  if (num_held > 0) {
    LineObservation of_others;
    SetMoments(held, &of_others);
    add(of_others, 0, kSummedUp);
  }
  for (std::size_t i = 0; i < landmark.observations.size(); ++i) {
    const LineObservation& observation = landmark.observations[i].moments;
    if (IsActive(observation.pose)) add(observation, part_of_pose_[observation.pose], i);
  }
}

void ActiveProblem::ReadObservations(const LandmarkStore& store, ThreadPool* pool) {
  constexpr std::size_t kObservationsPerChunk = 4096;
  pool->ForEachChunk(in_store_.size(), kObservationsPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t i = begin; i < end; ++i) {
                         if (in_store_[i] == kSummedUp) continue;
                         LineObservation& observation = observations.observations[i];
                         LineObservation read = Stored(store, i).moments;
                         read.pose = observation.pose;
                         read.landmark = observation.landmark;
                         observation = read;
                       }
                     });
}

const StoredObservation& ActiveProblem::Stored(const LandmarkStore& store, std::size_t i) const {
  const int landmark = landmark_ids[observations.observations[i].landmark];
  return store.landmarks()[landmark].observations[in_store_[i]];
}

std::vector<int> ActiveProblem::MovedPoses(const LandmarkStore& store, double tolerance_m) const {
  struct Sums {
    double weight = 0.0, weighted_squares = 0.0;
  };
  std::vector<Sums> sums(pose_ids.size());
  const std::vector<PoseFrame> frames = FramesOf(poses);
  for (std::size_t i = 0; i < in_store_.size(); ++i) {
    if (in_store_[i] == kSummedUp) continue;
    const LineObservation& observation = observations.observations[i];
    const PoseFrame& frame = frames[observation.pose];
    const LineLandmark& line = landmarks[observation.landmark];
    const LineLandmark& stored_line = store.landmarks()[landmark_ids[observation.landmark]].line;
    const double side = line.normal.dot(stored_line.normal) < 0.0 ? -1.0 : 1.0;
    const double distance_m = side * line.Distance(frame * observation.centroid());
    const double moved_m = distance_m - Stored(store, i).weighed_distance_m;
    sums[observation.pose].weight += observation.weight;
    sums[observation.pose].weighted_squares += observation.weight * moved_m * moved_m;
  }
  std::vector<int> moved;
  for (std::size_t part = 1; part <= num_active_; ++part) {
    const Sums& sum = sums[part];
    if (sum.weighted_squares > tolerance_m * tolerance_m * sum.weight) {
      moved.push_back(pose_ids[part]);
    }
  }
  return moved;
}

}  // namespace plumbline
