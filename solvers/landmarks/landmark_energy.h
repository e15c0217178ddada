#ifndef PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_ENERGY_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_ENERGY_H_

#include <vector>

#include "plumbline/core/pose_frame.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"

namespace plumbline {

/// Puts every line where all its returns and then the robust weights put it, whatever poses it came
/// from. The observations are left with weights of no further use.
void SettleLines(const ReturnCompressor& compressor, const std::vector<PoseFrame>& frames,
                 double gate_sigmas, ThreadPool* pool, LineObservations* observations,
                 std::vector<LineLandmark>* landmarks);

/// Energies of several states of the poses, (x, y, yaw) each, under one and the same association of
/// returns to landmarks, as CutIntoLandmarks gives it. Every point is at its optimum, and every
/// line where all its returns and then the robust weights put it. A return on a landmark costs
/// rho(d^2 / s^2) / 2, see MarginalEnergy; others cost nothing, in no state. Pose terms are added,
/// and custom factors as in MarginalEnergy; shape terms are not. selection: the returns that count.
/// lines: if given, the landmarks of each state with these lines.
///
/// MarginalEnergy gives each state associations of its own: where returns are few, which of them
/// then count as surface changes the sum by more than the poses do.
std::vector<double> LandmarkEnergies(const SlamGraph& graph, const FactorOptions& factors,
                                     const LineLandmarks& cut, const ReturnSelection& selection,
                                     const std::vector<const std::vector<double>*>& states,
                                     ThreadPool* pool,
                                     std::vector<std::vector<LineLandmark>>* lines = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_ENERGY_H_
