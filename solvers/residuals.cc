#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/landmarks/landmark_energy.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/solvers/solver_input.h"
#include "plumbline/solvers/terms/terms.h"

namespace plumbline {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kScansPerChunk = 16;

// The lines that a solver of this kind would draw the points to.
TangentLines LinesOf(const SolverOptions& options, const SlamGraph& graph, const MapState& state,
                     ThreadPool* pool) {
  const FactorOptions& factors = options.factors;
  const MeasuredSurface surface = MeasureSurface(graph, NormalOptionsFor(factors.beam), pool);
  TangentLines lines =
      LinesFromRadius(graph, state.poses, surface, options.association, FineRadius(options), pool);
  if (!options.IsOverLandmarks()) return lines;
  LineLandmarks cut = CutIntoLandmarks(graph, state.poses, surface,
                                       LandmarkOptionsFor(factors, options.association), pool);
  ReturnCompressor compressor(graph, NoiseOf(factors), pool);
  LineObservations observations = compressor.LayOut(cut.landmarks.size(), cut.landmark_of_return);
  SettleLines(compressor, FramesOf(state.poses), factors.manifold.robust_gate_sigmas, pool,
              &observations, &cut.landmarks);
  AddLandmarkLines(cut, pool, &lines);
  return lines;
}

// The residuals of a term; NaN where there is none.
std::vector<double> ResidualsOf(const Term& term, const SlamGraph& graph, const MapState& state,
                                ThreadPool* pool) {
  std::vector<double> residuals(term.num_measurements() * term.residuals_per_block(), kUndefined);
  const StateView at{state.poses.data(), state.points.data()};
  if (!term.GoesByScan()) {
    term.Evaluate(Term::kNoScan, at, residuals.data());
    return residuals;
  }
  pool->ForEachChunk(graph.num_scans(), kScansPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t s = begin; s < end; ++s) {
                         term.Evaluate(static_cast<int>(s), at, residuals.data());
                       }
                     });
  return residuals;
}

template <int N>
std::vector<Eigen::Matrix<double, N, 1>> AsVectors(const std::vector<double>& values) {
  std::vector<Eigen::Matrix<double, N, 1>> vectors;
  vectors.reserve(values.size() / N);
  for (std::size_t i = 0; i < values.size(); i += N) vectors.emplace_back(&values[i]);
  return vectors;
}

Status EvaluateChecked(const SolverOptions& options, const SlamGraph& graph, const MapState& state,
                       Residuals* residuals) {
  PLUMBLINE_RETURN_IF_ERROR(CheckSolverInput(options, graph, state));
  ThreadPool pool(options.num_threads);
  Associations associations;
  associations.lines = LinesOf(options, graph, state, &pool);
  Residuals result;
  for (const auto& term : MakeTerms(graph, associations, options.factors)) {
    std::vector<double> residuals = ResidualsOf(*term, graph, state, &pool);
    const std::string name = term->name();
    if (name == kMotionTerm) {
      result.odometry = AsVectors<3>(residuals);
    } else if (name == kRelativePoseTerm) {
      result.relative_poses = AsVectors<3>(residuals);
    } else if (name == kRangeBeamTerm) {
      result.beams = AsVectors<2>(residuals);
    } else if (name == kManifoldTerm) {
      result.surfaces = std::move(residuals);
    } else if (!residuals.empty()) {
      result.others.push_back({name, term->residuals_per_block(), std::move(residuals)});
    }
  }
  const auto bad = std::find_if(result.beams.begin(), result.beams.end(),
                                [](const Eigen::Vector2d& beam) { return beam.hasNaN(); });
  if (bad != result.beams.end()) {
    return Status::InvalidArgument("point " + std::to_string(bad - result.beams.begin()) +
                                   " of the state lies on its laser: it has no bearing");
  }
  *residuals = std::move(result);
  return Status::Ok();
}

}  // namespace

Status EvaluateResiduals(const SolverOptions& options, const SlamGraph& graph,
                         const MapState& state, Residuals* residuals) {
  const DefaultFloatEnvironment float_environment;
  return CatchExceptions([&] { return EvaluateChecked(options, graph, state, residuals); });
}

}  // namespace plumbline
