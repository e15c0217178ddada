#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_POSE_CHANGE_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_POSE_CHANGE_H_

namespace plumbline {

/// What the held-out returns of one pose say of two states: sums over their residuals, one per
/// return and landmark, under the landmarks that the seed and the state give, of rho(d^2 / s^2);
/// see AcceptanceTest.
struct PoseChange {
  int num_residuals = 0;
  double seed_error = 0.0;   ///< [sigmas^2]
  double state_error = 0.0;  ///< [sigmas^2]
  /// Sum over the returns of the square of by how much the error of each changed [sigmas^4].
  double squares = 0.0;

  PoseChange& operator+=(const PoseChange& other) {
    num_residuals += other.num_residuals;
    seed_error += other.seed_error;
    state_error += other.state_error;
    squares += other.squares;
    return *this;
  }
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_POSE_CHANGE_H_
