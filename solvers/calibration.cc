#include "plumbline/solvers/calibration.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/fixed_poses.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/solvers/acceptance/constraint_start.h"
#include "plumbline/solvers/acceptance/mirrored_scans.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/landmarks/landmark_energy.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/calibrated_graph.h"
#include "plumbline/solvers/reduced/calibration_system.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/reduced/unanchored_components.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/solver_input.h"
#include "plumbline/solvers/terms/align_to_factors.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Cutting the surfaces anew moves a parameter by some tenths of its standard deviation: smaller
// steps say nothing.
constexpr double kSettledSigmas = 0.5;

std::vector<int> ActiveParameters(const CalibrationOptions& options) {
  std::vector<int> active;
  if (options.laser_mounting) active = {kMountingX, kMountingY, kMountingYaw};
  if (options.range_bias) active.push_back(kRangeBias);
  if (options.range_scale) active.push_back(kLogRangeScale);
  if (options.odometry_scale) active.push_back(kLogOdometryScale);
  return active;
}

// Standard deviations of the priors: x and y [m] and yaw [rad] of the mounting, range bias [m], and
// the logarithms of the factors on ranges and odometry. Wide on purpose: what the data determine
// comes out 25 to 300 times as sharp on simulated buildings.
CalibrationVector PriorSigmas() {
  CalibrationVector sigmas;
  sigmas << 0.1, 0.1, 0.1, 0.05, 0.01, 0.05;
  return sigmas;
}

// To a multiple of 0.1 um, 0.1 urad or 1e-7, far below what a log can tell. Readings of a coarse
// laser are in ties, of distances and of which surface they are on: the digits beyond, which sums
// in another order change, would decide these otherwise.
CalibrationVector Rounded(const CalibrationVector& theta) {
  constexpr double kUnit = 1e-7;
  return kUnit * (theta / kUnit).array().round();
}

// Gauss-Newton steps on poses and parameters together, at most; each cuts the surfaces anew.
constexpr int kMaxSteps = 20;

Status CheckMountings(const SlamGraph& graph) {
  const Pose2& first = graph.laser(0).robot_from_laser;
  for (int i = 1; i < graph.num_lasers(); ++i) {
    const Pose2& other = graph.laser(i).robot_from_laser;
    if (other.x == first.x && other.y == first.y && other.yaw == first.yaw) continue;
    return Status::InvalidArgument("laser " + std::to_string(i) +
                                   " is mounted differently from laser 0: laser_mounting and "
                                   "range_scale can be calibrated for one mounting only");
  }
  return Status::Ok();
}

// A calibrated graph on given landmarks: everything that its energy and its linear system consist
// of.
class LandmarkedState {
 public:
  LandmarkedState(const CalibratedGraph& graph, const LineLandmarks& cut,
                  const FactorOptions& factors, double gate_sigmas, ThreadPool* pool)
      : graph_(graph),
        pool_(pool),
        loss_(GemanMcClure::FromGate(gate_sigmas)),
        compressor_(graph.graph(), graph.Noise(factors), pool),
        observations_(compressor_.LayOut(cut.landmarks.size(), cut.landmark_of_return, cut.shared)),
        landmarks_(cut.landmarks),
        frames_(FramesOf(graph.poses())),
        edges_(graph.Edges(factors)),
        terms_(graph.Terms(factors)) {
    SettleLines(compressor_, frames_, gate_sigmas, pool, &observations_, &landmarks_);
    const double cost = compressor_.Weigh(landmarks_, frames_, loss_, &observations_);
    energy_ = SumOverPeers(graph.graph().peers(), cost) + terms_.Cost(graph.poses());
  }
  LandmarkedState(const LandmarkedState&) = delete;
  LandmarkedState& operator=(const LandmarkedState&) = delete;

  double energy() const { return energy_; }

  Status FindStep(const std::vector<int>& active, const CalibrationVector& prior_sigmas,
                  const PoseSystemSolver* linear_solver, CalibrationStep* step) {
    const std::vector<int> components = FindUnanchoredComponents(observations_, terms_);
    if (!components.empty()) {
      return Status::InvalidArgument("nothing ties pose " + std::to_string(components.front()) +
                                     " to a fixed pose: there is no calibrating with it");
    }
    // The lines that are best for the weights at hand have no gradient.
    FitLandmarkLines(observations_, frames_, pool_, &landmarks_);
    PoseSystem poses;
    poses.Linearize(observations_, landmarks_, terms_, graph_.poses(), frames_, pool_);
    const CalibrationSystem system(
        graph_, edges_, observations_,
        compressor_.RangeSlopes(landmarks_, frames_, loss_, observations_), landmarks_, frames_,
        poses);
    return SolveCalibrationStep(system, poses, observations_, frames_, active, prior_sigmas,
                                graph_.theta(), linear_solver, pool_, step);
  }

  CalibrationMatrix Covariance(const CalibrationStep& step) const {
    return ObservedCovariance(graph_, edges_, step);
  }

 private:
  const CalibratedGraph& graph_;
  ThreadPool* pool_;
  const GemanMcClure loss_;
  ReturnCompressor compressor_;
  LineObservations observations_;
  std::vector<LineLandmark> landmarks_;
  const std::vector<PoseFrame> frames_;
  const PoseEdges edges_;
  const PoseTerms terms_;
  double energy_ = 0.0;
};

class Calibrator {
 public:
  Calibrator(const SolverOptions& options, const CalibrationOptions& calibration,
             const SlamGraph& graph, const std::vector<double>& poses)
      : options_(options),
        active_(ActiveParameters(calibration)),
        prior_sigmas_(PriorSigmas()),
        pool_(options.num_threads),
        given_mounting_(graph.laser(0).robot_from_laser),
        given_poses_(poses),
        graph_(graph, poses) {}

  // Moves poses and parameters until these settle.
  Status Settle(Calibration* result) {
    while (result->steps < kMaxSteps && !result->settled) {
      bool moved = false;
      PLUMBLINE_RETURN_IF_ERROR(MoveOnce(result->steps == 0, &moved, result));
      if (!moved) break;
      ++result->steps;
      stopped_ = !Reported(result->steps);
      if (stopped_) break;
    }
    return Status::Ok();
  }

  // Whether the callback asked to stop.
  bool stopped() const { return stopped_; }

  // What the parameters are, and how well the final poses determine them.
  Status Report(const std::vector<double>& final_poses, Calibration* result) {
    graph_.Set(graph_.theta(), final_poses);
    graph_.WeighMotions();
    CalibrationStep step;
    const LineLandmarks cut = CutSurfaces();
    LandmarkedState state(graph_, cut, options_.factors, FinalGate(), &pool_);
    PLUMBLINE_RETURN_IF_ERROR(
        state.FindStep(active_, prior_sigmas_, options_.reduced.linear_solver.get(), &step));
    const CalibrationMatrix covariance = state.Covariance(step);
    for (const int p : active_) {
      CalibratedParameter parameter = Describe(p);
      parameter.prior_sigma = prior_sigmas_[p];
      parameter.sigma = std::sqrt(std::max(0.0, covariance(p, p)));
      result->parameters.push_back(std::move(parameter));
    }
    return Status::Ok();
  }

  // The given poses, carried along to the parameters found.
  void StartOver() {
    const CalibrationVector theta = graph_.theta();
    graph_.Set(CalibrationVector::Zero(), given_poses_);
    graph_.Set(theta, graph_.Carried(theta, given_poses_));
  }

  const CalibratedGraph& graph() const { return graph_; }

 private:
  double FinalGate() const { return options_.factors.manifold.robust_gate_sigmas; }

  LineLandmarks CutSurfaces() {
    const SlamGraph& graph = graph_.graph();
    const MeasuredSurface surface =
        MeasureSurface(graph, NormalOptionsFor(options_.factors.beam), &pool_);
    return CutIntoLandmarks(graph, graph_.poses(), surface,
                            LandmarkOptionsFor(options_.factors, options_.association), &pool_);
  }

  // False if the callback wants to stop, that of any process.
  bool Reported(int step) const {
    IterationSummary iteration;
    iteration.iteration = step;
    iteration.phase = "sensors";
    const bool stop = options_.callback && !options_.callback(iteration);
    return SumOverPeers(graph_.graph().peers(), stop ? 1.0 : 0.0) == 0.0;
  }

  double PriorEnergy() const {
    return 0.5 * graph_.theta().cwiseQuotient(prior_sigmas_).squaredNorm();
  }

  // One Gauss-Newton step, shortened until it lowers the energy under the same landmarks.
  Status MoveOnce(bool first, bool* moved, Calibration* result) {
    graph_.WeighMotions();
    const double gate = FinalGate() * (first ? kStartGateFactor : 1.0);
    const LineLandmarks cut = CutSurfaces();
    CalibrationStep step;
    double energy = 0.0;
    {
      LandmarkedState state(graph_, cut, options_.factors, gate, &pool_);
      energy = state.energy() + PriorEnergy();
      PLUMBLINE_RETURN_IF_ERROR(
          state.FindStep(active_, prior_sigmas_, options_.reduced.linear_solver.get(), &step));
    }
    const CalibrationVector theta = graph_.theta();
    const std::vector<double> poses = graph_.poses();
    constexpr int kMaxHalvings = 4;
    double length = 1.0;
    for (int attempt = 0; attempt <= kMaxHalvings && !*moved; ++attempt, length *= 0.5) {
      std::vector<double> tried = poses;
      for (std::size_t i = 0; i < tried.size(); ++i) {
        tried[i] += length * step.poses[static_cast<Eigen::Index>(i)];
      }
      const CalibrationVector to = Rounded(theta + length * step.theta);
      graph_.Set(to, graph_.Carried(to, tried));
      const LandmarkedState state(graph_, cut, options_.factors, gate, &pool_);
      *moved = state.energy() + PriorEnergy() < energy;
      if (!*moved) graph_.Set(theta, poses);
    }
    result->settled = !first && IsSmall(step);
    return Status::Ok();
  }

  bool IsSmall(const CalibrationStep& step) const {
    return std::all_of(active_.begin(), active_.end(), [&](int p) {
      return std::abs(step.theta[p]) <= kSettledSigmas * std::sqrt(step.covariance(p, p));
    });
  }

  CalibratedParameter Describe(int p) const {
    const double theta = graph_.theta()[p];
    switch (p) {
      case kMountingX:
        return {"mounting_x_m", given_mounting_.x, given_mounting_.x + theta};
      case kMountingY:
        return {"mounting_y_m", given_mounting_.y, given_mounting_.y + theta};
      case kMountingYaw:
        return {"mounting_yaw_rad", given_mounting_.yaw, given_mounting_.yaw + theta};
      case kRangeBias:
        return {"range_bias_m", 0.0, theta};
      case kLogRangeScale:
        return {"range_scale", 1.0, std::exp(theta)};
      default:
        return {"odometry_scale", 1.0, std::exp(theta)};
    }
  }

  const SolverOptions& options_;
  const std::vector<int> active_;
  const CalibrationVector prior_sigmas_;
  ThreadPool pool_;
  const Pose2 given_mounting_;
  const std::vector<double> given_poses_;
  CalibratedGraph graph_;
  bool stopped_ = false;
};

Status CheckInput(const SolverOptions& options, const CalibrationOptions& calibration,
                  const SlamGraph& graph, const MapState& state) {
  PLUMBLINE_RETURN_IF_ERROR(CheckSolverInput(options, graph, state, false));
  if (options.MovesPosesOnly()) {
    return Status::InvalidArgument("the solver " + std::string(SolverOf(options).name()) +
                                   " does not look at the returns, and calibration needs them");
  }
  if ((calibration.laser_mounting || calibration.range_scale) && graph.fixed_poses().size() > 1) {
    return Status::InvalidArgument(
        "laser_mounting and range_scale move the poses with the sensors: they cannot be calibrated "
        "with more than one fixed pose, and the graph has " +
        std::to_string(graph.fixed_poses().size()));
  }
  PLUMBLINE_RETURN_IF_ERROR(CheckScansAreNotMirrored(
      graph, state.poses, StartFromConstraints(graph, state.poses, options.factors.motion)));
  return calibration.laser_mounting || calibration.range_scale ? CheckMountings(graph)
                                                               : Status::Ok();
}

// Settles the parameters, solves with them and says what they are.
Status CalibrateAndSolve(const SolverOptions& options, Calibrator* calibrator, MapState* state,
                         SolverSummary* summary, Calibration* result) {
  PLUMBLINE_RETURN_IF_ERROR(calibrator->Settle(result));
  SolverOptions rest = options;
  if (calibrator->stopped()) {
    rest.callback = [](const IterationSummary&) { return false; };
  } else {
    // Not from the poses at hand: there would be next to nothing left for Solve to improve on.
    calibrator->StartOver();
  }
  const SlamGraph& graph = calibrator->graph().graph();
  MapState calibrated;
  calibrated.poses = calibrator->graph().poses();
  calibrated.points = graph.MeasuredMap(calibrated.poses);
  *summary = RefineState(rest, graph, &calibrated);
  if (!summary->IsSolutionUsable()) return Status::Ok();
  PLUMBLINE_RETURN_IF_ERROR(calibrator->Report(calibrated.poses, result));
  result->corrections = calibrator->graph().corrections();
  *state = std::move(calibrated);
  return Status::Ok();
}

SolverSummary SolveChecked(const SolverOptions& options,
                           const CalibrationOptions& calibration_options, const SlamGraph& graph,
                           MapState* state, Calibration* calibration) {
  const Status input = CheckInput(options, calibration_options, graph, *state);
  if (!input.ok()) return SolverFailure(options, input);
  MapState seed = *state;
  PutAtFixedPoses(graph, &seed);
  AlignToFactors(graph, &seed);
  Calibrator calibrator(options, calibration_options, graph, seed.poses);
  Calibration result;
  SolverSummary summary;
  const auto start = Clock::now();
  const Status status = CatchExceptions(
      [&] { return CalibrateAndSolve(options, &calibrator, state, &summary, &result); });
  if (!status.ok()) summary = SolverFailure(options, status);
  if (!summary.IsSolutionUsable()) return summary;
  result.time_s =
      std::chrono::duration<double>(Clock::now() - start).count() - summary.total_time_s;
  *calibration = std::move(result);
  return summary;
}

}  // namespace

SolverSummary SolveWithCalibration(const SolverOptions& options,
                                   const CalibrationOptions& calibration_options,
                                   const SlamGraph& graph, MapState* state,
                                   Calibration* calibration) {
  *calibration = Calibration();
  const DefaultFloatEnvironment float_environment;
  if (!calibration_options.IsOn()) return RefineState(options, graph, state);
  return CatchFailures(options, [&] {
    return SolveChecked(options, calibration_options, graph, state, calibration);
  });
}

}  // namespace plumbline
