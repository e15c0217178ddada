#ifndef PLUMBLINE_SOLVERS_REDUCED_CALIBRATION_SYSTEM_H_
#define PLUMBLINE_SOLVERS_REDUCED_CALIBRATION_SYSTEM_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/calibrated_graph.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/reduced/pose_system_solver.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

/// The border that a calibration adds to the Gauss-Newton system of the poses, lines eliminated
/// there, too:
///   [ S         border      ] [ dx     ]     [ pose gradient ]
///   [ border^T  information ] [ dtheta ] = - [ gradient      ]
/// with poses that CalibratedGraph carries along. If the graph is shared, all of this is
/// collective; each process has its own rows of the border, and all have the rest.
struct CalibrationSystem {
  CalibrationMatrix information = CalibrationMatrix::Zero();
  CalibrationVector gradient = CalibrationVector::Zero();
  Eigen::Matrix<double, Eigen::Dynamic, kNumCalibrationParameters> border;  ///< 3 per row

  /// At the graph's state and the lines that fit it best, to which `poses` belongs. slopes: of the
  /// observations.
  CalibrationSystem(const CalibratedGraph& graph, const PoseEdges& edges,
                    const LineObservations& observations, const std::vector<RangeSlope>& slopes,
                    const std::vector<LineLandmark>& landmarks,
                    const std::vector<PoseFrame>& frames, const PoseSystem& poses);

 private:
  void AddPoseEdges(const CalibratedGraph& graph, const PoseEdges& edges, const PoseSystem& poses);
  void AddFactors(const CalibratedGraph& graph, const PoseSystem& poses);
  void AddRangeBias(double range_scale, const LineObservations& observations,
                    const std::vector<RangeSlope>& slopes,
                    const std::vector<LineLandmark>& landmarks,
                    const std::vector<PoseFrame>& frames, const PoseSystem& poses);
};

struct CalibrationStep {
  CalibrationVector theta = CalibrationVector::Zero();
  Eigen::VectorXd poses;  ///< 3 each, all of the graph, on top of being carried
  CalibrationMatrix covariance = CalibrationMatrix::Zero();  ///< of theta, if all sigmas are right
  /// How the poses follow theta, beyond being carried along; 3 rows per pose.
  Eigen::Matrix<double, Eigen::Dynamic, kNumCalibrationParameters> response;
};

/// Solves the bordered system for the poses and the `active` parameters, ascending; of the others
/// the step is zero and the covariance, too. prior_sigmas: of the active ones, about theta = 0.
/// linear_solver: null for SolvePoseSystem. Unavailable if conjugate gradients do not get there.
Status SolveCalibrationStep(const CalibrationSystem& system, const PoseSystem& poses,
                            const LineObservations& observations,
                            const std::vector<PoseFrame>& frames, const std::vector<int>& active,
                            const CalibrationVector& prior_sigmas, const CalibrationVector& theta,
                            const PoseSystemSolver* linear_solver, ThreadPool* pool,
                            CalibrationStep* step);

/// The covariance of theta if the odometry errs as its residuals show and not as its sigmas say:
/// the sum of squares of what each motion contributes to the gradient of theta takes the place of
/// what the sigmas expect of it. Motions count as independent.
CalibrationMatrix ObservedCovariance(const CalibratedGraph& graph, const PoseEdges& edges,
                                     const CalibrationStep& step);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_CALIBRATION_SYSTEM_H_
