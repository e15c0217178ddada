#include "plumbline/apps/run/packed_seed.h"

#include <Eigen/Core>
#include <utility>

#include "plumbline/apps/io/binary_archive.h"

namespace plumbline {

// What the structs are made of. Structured bindings do not compile if a field is missing here.

template <typename Archive>
void Visit(Archive& archive, Pose2* pose) {
  auto& [x, y, yaw] = *pose;
  archive(x, y, yaw);
}

template <typename Archive>
void Visit(Archive& archive, OdometrySignReport* report) {
  auto& [num_backward_steps, num_decided, num_contradicting, sign_lost] = *report;
  archive(num_backward_steps, num_decided, num_contradicting, sign_lost);
}

template <typename Archive>
void Visit(Archive& archive, SequentialSeedingReport* report) {
  auto& [odometry_sign, num_keyframes, num_reversed_steps, num_recovered, num_unmatched] = *report;
  archive(odometry_sign, num_keyframes, num_reversed_steps, num_recovered, num_unmatched);
}

template <typename Archive>
void Visit(Archive& archive, ClockOffset* offset) {
  auto& [value_s, sigma_s] = *offset;
  archive(value_s, sigma_s);
}

template <typename Archive>
void Visit(Archive& archive, SystematicError* error) {
  auto& [value, sigma] = *error;
  archive(value, sigma);
}

template <typename Archive>
void Visit(Archive& archive, RandomError* error) {
  auto& [estimated, num_spans, sigma_per_sqrt_m, sigma_per_sqrt_rad] = *error;
  archive(estimated, num_spans, sigma_per_sqrt_m, sigma_per_sqrt_rad);
}

template <typename Archive>
void Visit(Archive& archive, MotionOptions* motion) {
  auto& [alpha_1, alpha_2, alpha_3, alpha_4, translation_floor, rotation_floor] = *motion;
  archive(alpha_1, alpha_2, alpha_3, alpha_4, translation_floor, rotation_floor);
}

template <typename Archive>
void Visit(Archive& archive, OdometryNoiseReport* report) {
  auto& [gross_scale, clock_offset, translation_scale, rotation_scale, drift, translation, rotation,
         leaps, still_steps, motion, is_prediction, given_poses] = *report;
  archive(gross_scale, clock_offset, translation_scale, rotation_scale, drift, translation,
          rotation, leaps, still_steps, motion, is_prediction, given_poses.position_m,
          given_poses.yaw_rad);
}

template <typename Archive>
void Visit(Archive& archive, LoopClosureRecord* record) {
  auto& [from_pose, to_pose, from_from_to, outcome] = *record;
  archive(from_pose, to_pose, from_from_to, outcome);
}

template <typename Archive>
void Visit(Archive& archive, SuspectStep* step) {
  auto& [first_pose_after, evidence, broken, unmatched, turned_rad, num_closures_across,
         num_alternatives] = *step;
  archive(first_pose_after, evidence, broken, unmatched, turned_rad, num_closures_across,
          num_alternatives);
}

template <typename Archive>
void Visit(Archive& archive, LoopClosingReport* report) {
  auto& [num_candidates, num_closures, num_contradicted, matches, suspect_steps] = *report;
  archive(num_candidates, num_closures, num_contradicted, matches, suspect_steps);
}

template <typename Archive>
void Visit(Archive& archive, FreeSpaceConflict* conflict) {
  auto& [num_compared, num_conflicting] = *conflict;
  archive(num_compared, num_conflicting);
}

template <typename Archive>
void Visit(Archive& archive, ConflictPeak* peak) {
  auto& [conflict, pose, usual_ratio] = *peak;
  archive(conflict, pose, usual_ratio);
}

template <typename Archive>
void Visit(Archive& archive, SpaceConflict* place) {
  auto& [viewer_scan, scan, world_point] = *place;
  archive(viewer_scan, scan, world_point.x(), world_point.y());
}

template <typename Archive>
void Visit(Archive& archive, ViewpointConflict* viewpoint) {
  auto& [pose, within, between] = *viewpoint;
  archive(pose, within, between);
}

template <typename Archive>
void Visit(Archive& archive, MapConsistency* map) {
  auto& [within, between, pairs_within, pairs_between, worst_within, worst_between,
         contradicted_share, usual_ratio_at_rest, viewpoints, places] = *map;
  archive(within, between, pairs_within, pairs_between, worst_within, worst_between,
          contradicted_share, usual_ratio_at_rest, viewpoints, places);
}

template <typename Archive>
void Visit(Archive& archive, WeighedHypothesis* hypothesis) {
  auto& [kind, first_later, last_later, first_earlier, last_earlier, num_closures, carried_to,
         first_pose_after, conflict, score, adopted, world_from_robot] = *hypothesis;
  archive(kind, first_later, last_later, first_earlier, last_earlier, num_closures, carried_to,
          first_pose_after, conflict, score, adopted, world_from_robot);
}

template <typename Archive>
void Visit(Archive& archive, RelativePoseConstraint* edge) {
  auto& [from, to, from_from_to, covariance] = *edge;
  archive(from, to, from_from_to);
  for (Eigen::Index i = 0; i < covariance.size(); ++i) archive(covariance.data()[i]);
}

template <typename Archive>
void Visit(Archive& archive, MeasurementCorrections* corrections) {
  auto& [odometry, robot_from_laser, range_m, bearing_rad, moving_returns] = *corrections;
  archive(odometry, robot_from_laser, range_m, bearing_rad, moving_returns);
}

template <typename Archive>
void Visit(Archive& archive, SeedingReport* report) {
  auto& [start, sequential, moving_share, odometry_noise, loops, consistency, hypotheses,
         pose_graph, corrections, poses, alarm] = *report;
  archive(start, sequential, moving_share, odometry_noise, loops, consistency, hypotheses,
          pose_graph, corrections, poses, alarm);
}

namespace {

struct Seed {
  std::vector<double> poses;  // as MapState::poses
  SeedingReport report;
};

template <typename Archive>
void Visit(Archive& archive, Seed* seed) {
  auto& [poses, report] = *seed;
  archive(poses, report);
}

}  // namespace

std::string PackSeed(const std::vector<double>& poses, const SeedingReport& report) {
  Seed seed{poses, report};
  BinaryWriter writer;
  writer(seed);
  return writer.bytes();
}

void UnpackSeed(const std::string& bytes, std::vector<double>* poses, SeedingReport* report) {
  Seed seed;
  BinaryReader reader(bytes);
  reader(seed);
  *poses = std::move(seed.poses);
  *report = std::move(seed.report);
}

}  // namespace plumbline
