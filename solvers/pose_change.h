#ifndef PLUMBLINE_SOLVERS_POSE_CHANGE_H_
#define PLUMBLINE_SOLVERS_POSE_CHANGE_H_

namespace plumbline {

/// What the held-out returns of one pose say of two states: sums over their sightings, under the
/// patches of both, of rho(d^2 / s^2); see Verdict.
struct PoseChange {
  int num_sightings = 0;
  double seed_error = 0.0;   ///< [sigmas^2]
  double state_error = 0.0;  ///< [sigmas^2]
  /// Sum over the returns of the square of by how much the error of each changed [sigmas^4].
  double squares = 0.0;

  PoseChange& operator+=(const PoseChange& other) {
    num_sightings += other.num_sightings;
    seed_error += other.seed_error;
    state_error += other.state_error;
    squares += other.squares;
    return *this;
  }
};

/// Consecutive poses that a state places clearly worse than the seed does, by ids.
struct WorseStretch {
  int first = 0;
  int last = 0;              ///< the last one in it
  double seed_error = 0.0;   ///< mean held-out error at the seed [sigmas^2]
  double state_error = 0.0;  ///< mean held-out error of the state [sigmas^2]
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_CHANGE_H_
