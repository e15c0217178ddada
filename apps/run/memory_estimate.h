#ifndef PLUMBLINE_APPS_RUN_MEMORY_ESTIMATE_H_
#define PLUMBLINE_APPS_RUN_MEMORY_ESTIMATE_H_

#include <ostream>
#include <string>

#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// What the stages of a run are expected to take at their peak [bytes], everything included: 25 MB
/// for the program, and
///
///                       bytes per return   kB per scan
///   seeding                    24               5
///   results                    40               2      and 20 bytes per pixel of a picture,
///                                                      up to 5 per cell of the occupancy grid
///                                                      (FitGrid)
///   pose_graph, sgd            24               5
///   reduced                    40               2
///   alternating_cg            500               2
///   published                 300               2
///   ceres                    1600               2
///   ceres, reduced           1300               2      or 280 bytes with iterative_schur
///   calibration              + 50
///
/// Measured with the real logs and with simulated ones of up to 100,000 scans. Most are right to a
/// quarter, all to a factor of two; where few places are revisited, the reduced problem takes ceres
/// less than this. With Ceres' dense linear solvers the matrices come on top, by their size.
///
/// Reading takes 8 bytes per beam before that.
struct MemoryEstimate {
  double seeding = 0.0;
  double joint = 0.0;
  double results = 0.0;
  double pictures = 0.0;    ///< part of the results
  int picture_side_px = 0;  ///< longer side of the largest picture: a small map has a small one

  double Peak() const;
  /// Takes in those of another log of the same run.
  void Add(const MemoryEstimate& other);
  /// A line for people.
  std::string Text() const;
};

/// For a graph as it was read, and its initial state. calibrates: whether sensor
/// parameters are estimated too.
MemoryEstimate EstimateMemory(const SlamGraph& graph, const MapState& state,
                              const SolverOptions& solver, bool calibrates, int picture_side_px);

/// What the results take with an occupancy grid, of the seed's map: by drifting odometry it would
/// be many times too large. Limits the grid so that they stay within the limit [bytes, 0: no
/// limit], but to no less than a tenth of that. Gives a line for people if they take much more than
/// `expected`, where the grid is left out; else nothing.
std::string FitGrid(const MemoryEstimate& expected, const SlamGraph& graph, const MapState& seed,
                    double limit, RunOutputOptions* outputs);

/// Takes "4GB", "500MB" or "0", for no limit [bytes]; 1 GB is 1000 MB. InvalidArgument on anything
/// else.
Status ParseMemorySize(const std::string& text, double* bytes);

/// Makes the pictures of a run as much smaller as it takes to stay within the limit [bytes, 0: no
/// limit], and gives a line for people that says so. Empty where nothing is changed: they fit, or
/// pictures of 300 pixels would not either.
std::string FitPictures(double limit, MemoryEstimate* estimate, int* picture_side_px);

/// Makes a run fit into `limit` [bytes, 0: no limit] with smaller pictures (FitPictures). Prints
/// lines for people. InvalidArgument if it does not fit all the same, or, without a limit, if this
/// machine does not hold what a dense linear solver of Ceres needs; the message says what would
/// need less.
Status FitMemory(double limit, const SlamGraph& graph, const SolverOptions& solver,
                 MemoryEstimate* estimate, int* picture_side_px, std::ostream* out);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_MEMORY_ESTIMATE_H_
