// How a solve went, and what it found of the sensors.

#include <string>

#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/apps/python/progress.h"
#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/incremental_solver.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {
namespace py = pybind11;
namespace {

void BindIteration(py::module_* module) {
  py::enum_<TerminationType>(*module, "TerminationType", "How a solve ended.")
      .value("FAILURE", TerminationType::kFailure, "raised as an exception")
      .value("NO_IMPROVEMENT", TerminationType::kNoImprovement, "the state is as it was")
      .value("USER_STOPPED", TerminationType::kUserStopped, "the state is the best so far")
      .value("MAX_ITERATIONS", TerminationType::kMaxIterations, "better, could still improve")
      .value("CONVERGED", TerminationType::kConverged, "better, more would hardly help");
  Fields<ShownIteration>(module, "IterationSummary", "One iteration of any solver.")
      .Field("iteration", &ShownIteration::iteration, "counts through all rounds")
      .Field("round", &ShownIteration::round, "of associations, from 1")
      .Field("phase", &ShownIteration::phase, "what moved: map, poses, joint or sensors")
      .Field("cost", &ShownIteration::cost, "after it")
      .Field("cost_change", &ShownIteration::cost_change, "positive: the cost fell")
      .Field("gradient_max_norm", &ShownIteration::gradient_max_norm, "before it")
      .Field("step_norm", &ShownIteration::step_norm, "in all parameters [m and rad]")
      .Field("evaluations", &ShownIteration::evaluations,
             "of the cost, or iterations of the linear solver")
      .Field("iteration_time_s", &ShownIteration::iteration_time_s, "of this iteration [s]")
      .Field("total_time_s", &ShownIteration::total_time_s, "since the solver was called [s]")
      .FieldBy(
          "poses",
          [](const ShownIteration& iteration) -> py::object {
            if (iteration.shown_poses.empty()) return py::none();
            return ArrayOf(iteration.shown_poses, 3);
          },
          "(N, 3): the poses after it, for a progress callback; None elsewhere");
}

void BindRounds(py::module_* module) {
  Fields<RoundSummary>(module, "RoundSummary", "One round of associations.")
      .Field("radius_m", &RoundSummary::radius_m, "smallest neighbourhood [m]")
      .Field("gate_sigmas", &RoundSummary::gate_sigmas, "robust gate of the map terms")
      .Field("num_lines", &RoundSummary::num_lines, "returns with a tangent line")
      .Field("num_shape_pairs", &RoundSummary::num_shape_pairs, "terms of the shape potential")
      .Field("initial_cost", &RoundSummary::initial_cost, "of the joint energy")
      .Field("final_cost", &RoundSummary::final_cost, "of the same associations")
      .Field("marginal_energy", &RoundSummary::marginal_energy, "comparable between rounds")
      .Field("kept", &RoundSummary::kept, "false: undone, as it did not help")
      .Field("iterations", &RoundSummary::iterations, "of the inner solve")
      .Field("stop_reason", &RoundSummary::stop_reason, "of the inner solve");
  Fields<LandmarkRoundSummary>(module, "LandmarkRoundSummary", "One round of the reduced solver.")
      .Field("gate_sigmas", &LandmarkRoundSummary::gate_sigmas, "robust gate")
      .Field("num_landmarks", &LandmarkRoundSummary::num_landmarks, "pieces of surface")
      .Field("num_observations", &LandmarkRoundSummary::num_observations,
             "pairs of a pose and a landmark that it saw")
      .Field("initial_cost", &LandmarkRoundSummary::initial_cost, "of poses and lines")
      .Field("final_cost", &LandmarkRoundSummary::final_cost, "the same, at the end")
      .Field("moved_sigmas", &LandmarkRoundSummary::moved_sigmas,
             "root mean square of how far returns moved across their surfaces");
  Fields<RoundEnergy>(module, "RoundEnergy",
                      "How well the poses explain the scans at one moment of a solve.")
      .Field("round", &RoundEnergy::round, "that has just ended; 0: the state given")
      .Field("iteration", &RoundEnergy::iteration, "the last one of the round")
      .Field("total_time_s", &RoundEnergy::total_time_s, "since the solver was called [s]")
      .Field("marginal_energy", &RoundEnergy::marginal_energy,
             "comparable between rounds and solvers");
  Fields<TermSummary>(module, "TermSummary", "Sizes, costs and residuals of one term.")
      .Field("name", &TermSummary::name, "motion, range beam, ...")
      .Field("count", &TermSummary::count, "residual blocks")
      .Field("initial_cost", &TermSummary::initial_cost, "half of the squared residuals, robust")
      .Field("final_cost", &TermSummary::final_cost, "the same at the end")
      .Field("residuals_per_block", &TermSummary::residuals_per_block, "scalars")
      .Field("sigma", &TermSummary::sigma, "of one residual, in `unit`; 0: several units")
      .Field("unit", &TermSummary::unit, "of sigma")
      .Method("whitened_rms", &TermSummary::WhitenedRms,
              "Root mean square of the whitened residuals at the end.");
}

void BindAcceptance(py::module_* module) {
  Fields<AcceptanceTest>(module, "AcceptanceTest",
                         "Whether a state is better than the one given, by energy and by the "
                         "returns that were held out.")
      .Field("seed_energy", &AcceptanceTest::seed_energy, "of the state given")
      .Field("final_energy", &AcceptanceTest::final_energy, "of the result")
      .Field("num_held_out", &AcceptanceTest::num_held_out, "held-out returns that count")
      .Field("seed_held_out_error", &AcceptanceTest::seed_held_out_error, "[sigmas^2]")
      .Field("final_held_out_error", &AcceptanceTest::final_held_out_error, "[sigmas^2]")
      .Field("held_out_noise", &AcceptanceTest::held_out_noise,
             "standard deviation of the difference of these two, by chance")
      .Field("num_worse_stretches", &AcceptanceTest::num_worse_stretches,
             "parts of the drive that fit clearly worse")
      .Method("is_better", &AcceptanceTest::IsBetter, "By both yardsticks, and everywhere.")
      .Method("text", &AcceptanceTest::Text, "The figures, for people.");
  Fields<WorseStretch>(module, "WorseStretch", "Poses that came out clearly worse; put back.")
      .Field("first", &WorseStretch::first, "pose id")
      .Field("last", &WorseStretch::last, "pose id")
      .Field("seed_error", &WorseStretch::seed_error, "held-out error [sigmas^2]")
      .Field("state_error", &WorseStretch::state_error, "held-out error [sigmas^2]");
  Fields<IgnoredEdge>(module, "IgnoredEdge", "A relative pose that its scans contradict.")
      .Field("edge", &IgnoredEdge::edge, "index into SlamGraph.relative_poses")
      .Field("from_pose", &IgnoredEdge::from, "pose id")
      .Field("to_pose", &IgnoredEdge::to, "pose id")
      .Field("off_m", &IgnoredEdge::off_m, "how far the result is off it [m]")
      .Field("off_rad", &IgnoredEdge::off_rad, "likewise [rad]")
      .Field("sigmas", &IgnoredEdge::sigmas, "the same in its own standard deviations");
  Fields<PointDisplacements>(module, "PointDisplacements",
                             "How far points were moved from the measured ends of their beams.")
      .Field("mean_m", &PointDisplacements::mean_m, "over all points [m]")
      .Field("max_m", &PointDisplacements::max_m, "the largest [m]")
      .Field("max_beam_sigmas", &PointDisplacements::max_beam_sigmas,
             "the largest, in standard deviations of its beam");
}

void BindSummary(py::module_* module) {
  Fields<SolverSummary>(module, "SolverSummary", "What a solve did, and what came of it.")
      .Field("termination", &SolverSummary::termination, "how it ended")
      .Field("message", &SolverSummary::message, "why, with the numbers")
      .Field("solver", &SolverSummary::solver, "its name")
      .Field("num_poses", &SolverSummary::num_poses, "of the graph")
      .Field("num_points", &SolverSummary::num_points, "of the graph")
      .Field("rounds", &SolverSummary::rounds, "in order")
      .Field("landmark_rounds", &SolverSummary::landmark_rounds,
             "reduced solver: instead of rounds")
      .FieldBy(
          "iterations",
          [](const SolverSummary& summary) {
            py::list iterations;
            for (const IterationSummary& i : summary.iterations)
              iterations.append(ShownIteration(i));
            return py::tuple(iterations);
          },
          "of all rounds")
      .Field("terms", &SolverSummary::terms, "of the last associations")
      .Field("final_marginal_energy", &SolverSummary::final_marginal_energy,
             "comparable between solvers")
      .Field("round_energies", &SolverSummary::round_energies,
             "with SolverOptions.measure_rounds: of the state given and after every round")
      .Field("num_relative_poses", &SolverSummary::num_relative_poses,
             "solvers of poses only: how many they went by")
      .Field("seed_chi2", &SolverSummary::seed_chi2, "likewise: squared errors of the poses given")
      .Field("final_chi2", &SolverSummary::final_chi2, "likewise: of the result")
      .Field("started_from_constraints", &SolverSummary::started_from_constraints,
             "the state given contradicted odometry and relative poses")
      .Field("acceptance", &SolverSummary::acceptance, "what decides whether it is better")
      .Field("put_back", &SolverSummary::put_back, "stretches that had become worse")
      .Field("downweighted_steps", &SolverSummary::downweighted_steps,
             "of the odometry, that had torn poses from the map")
      .Field("ignored_edges", &SolverSummary::ignored_edges, "relative poses that did not count")
      .Field("displacements", &SolverSummary::displacements, "of the points")
      .Field("association_time_s", &SolverSummary::association_time_s, "[s]")
      .Field("setup_time_s", &SolverSummary::setup_time_s, "[s]")
      .Field("solve_time_s", &SolverSummary::solve_time_s, "[s]")
      .Field("total_time_s", &SolverSummary::total_time_s, "[s]")
      .Method("brief_report", &SolverSummary::BriefReport, "One line.")
      .Method("full_report", &SolverSummary::FullReport, "Terms, rounds, times, why it stopped.");
}

void BindIncrementalSummary(py::module_* module) {
  Fields<IncrementalSummary>(module, "IncrementalSummary", "What an update did.")
      .Field("num_free_poses", &IncrementalSummary::num_free_poses, "that could move")
      .Field("num_placed_poses", &IncrementalSummary::num_placed_poses,
             "whose returns were associated, for the first time or anew")
      .Field("num_rounds", &IncrementalSummary::num_rounds, "cuts of the surfaces")
      .Field("num_steps", &IncrementalSummary::num_steps, "of Gauss-Newton")
      .Field("initial_cost", &IncrementalSummary::initial_cost,
             "of what could move, before the last step")
      .Field("final_cost", &IncrementalSummary::final_cost, "the same after it")
      .Field("ignored_edges", &IncrementalSummary::ignored_edges,
             "relative poses that did not count: all so far")
      .Field("contradicted_closures", &IncrementalSummary::contradicted_closures,
             "loop closures that count and that the result is off: false, or the map is wrong")
      .Field("alarms", &IncrementalSummary::alarms,
             "at most one, if more closures contradict the map than are usually false")
      .Field("association_time_s", &IncrementalSummary::association_time_s, "[s]")
      .Field("minimization_time_s", &IncrementalSummary::minimization_time_s, "[s]")
      .Field("total_time_s", &IncrementalSummary::total_time_s, "[s]");
}

void BindCalibration(py::module_* module) {
  Fields<CalibratedParameter>(module, "CalibratedParameter",
                              "One parameter of the sensors: in m or rad, factors without unit.")
      .Field("name", &CalibratedParameter::name, "ends with the unit; factors have none")
      .Field("given", &CalibratedParameter::given, "before")
      .Field("value", &CalibratedParameter::value, "after")
      .Field("sigma", &CalibratedParameter::sigma, "standard deviation of value")
      .Field("prior_sigma", &CalibratedParameter::prior_sigma, "before the data")
      .Method("is_determined", &CalibratedParameter::IsDetermined,
              "Whether the data say clearly more than the prior.");
  Fields<Calibration>(module, "Calibration", "What was found of the sensors.")
      .Field("parameters", &Calibration::parameters, "those that were asked for")
      .Field("steps", &Calibration::steps, "of Gauss-Newton")
      .Field("settled", &Calibration::settled, "whether the last step was small")
      .Field("time_s", &Calibration::time_s, "[s], without the solve")
      .Field("corrections", &Calibration::corrections, "for SlamGraph.corrected");
}

}  // namespace

void BindSummaries(py::module_* module) {
  BindIteration(module);
  BindRounds(module);
  BindAcceptance(module);
  BindSummary(module);
  BindIncrementalSummary(module);
  BindCalibration(module);
}

}  // namespace plumbline
