#ifndef PLUMBLINE_SOLVERS_POINT_RECOVERY_H_
#define PLUMBLINE_SOLVERS_POINT_RECOVERY_H_

#include <array>
#include <cstddef>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/factors/manifold_factor.h"

namespace plumbline {

/// How far points were moved from the measured ends of their beams.
struct PointDisplacements {
  double mean_m = 0.0;  ///< over all points, those without a line included
  double max_m = 0.0;
  /// Largest length in standard deviations of the point's own beam, sqrt(u^T C^-1 u).
  double max_beam_sigmas = 0.0;

  /// Points per bin of that length, each kSigmasPerBin wide; the last one has no upper end.
  static constexpr double kSigmasPerBin = 0.25;
  static constexpr int kNumSigmaBins = 17;
  std::array<std::size_t, kNumSigmaBins> sigma_counts{};

  /// Points per bin of distance: below kFirstOctaveM, then up to twice that and so on, so that the
  /// bins suit any sensor; the last one has no upper end.
  static constexpr double kFirstOctaveM = 0.25e-3;
  static constexpr int kNumOctaves = 12;
  std::array<std::size_t, kNumOctaves> octave_counts{};
};

/// The points of the graph, x, y each, at the minimum of its beam and manifold term for fixed poses
/// and lines:  m = h - C n d / s^2,  s^2 = sigma_M^2 / w + n^T C n,  with h the measured end of the
/// beam, C its covariance, d = n . h - offset, and w the robust weight at the minimum, found by
/// iteration. A point without a line, or whose line would cost more than leaving it where it is,
/// stays at h: so none moves by more than the robust gate, counted in sigmas of its beam. lines:
/// per return, as LinesFromRadius gives them. Shape terms are left out.
std::vector<double> RecoverPoints(const SlamGraph& graph, const std::vector<double>& poses,
                                  const MeasuredSurface& surface,
                                  const std::vector<TangentLine>& lines,
                                  const FactorOptions& factors, ThreadPool* pool);

/// How far the points of a state are from where its poses and the measurements put them.
PointDisplacements MeasureDisplacements(const SlamGraph& graph, const MapState& state,
                                        const MeasuredSurface& surface,
                                        const FactorOptions& factors, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POINT_RECOVERY_H_
