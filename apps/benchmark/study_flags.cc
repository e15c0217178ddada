#include "plumbline/apps/benchmark/study_flags.h"

#include <gflags/gflags.h>

#include "plumbline/apps/benchmark/compared_solvers.h"
#include "plumbline/apps/benchmark/solver_comparison.h"

DEFINE_string(
    csv, "",
    "seeding_study, sessions_study, variations, scaling, scan_solver, adversarial: table to "
    "write, one line per run or computation (empty: none)");
DEFINE_int32(buildings, 0,
             "seeding_study, sessions_study: simulated buildings, one run each (0: 180 and 24)");
DEFINE_uint64(study_first_seed, 1,
              "seeding_study, sessions_study, variations: seeds of buildings, noise, faults and "
              "variations count from this one; seeding_study has two buildings of each");
DEFINE_string(
    study_scanner, "fine",
    "seeding_study: fine (0.5 deg, 80 m, a scan every 0.18 m), short (1 deg, 8 m), thinned "
    "(1 deg, a scan every 0.8 m), fast (1 deg, 1 m/s, a scan every 0.45 m) or people (as fine, "
    "among four people and doors that move)");
DEFINE_int32(seeds, 30,
             "synthetic, ablation, adversarial: seeds of buildings and noise, 1 to this");
DEFINE_string(
    variations, "all",
    "variations: which ones, separated by commas: same, late, early, gaps, thin2, thin5, "
    "backwards, mirror, turned, fov120, range8, beams2, beams4, noise2cm, odo2, odoscale, "
    "shift, scale03, reversed, xy_constant, no_odometry, or all");
DEFINE_int32(variation_seeds, 3, "variations: seeds of each random variation");
DEFINE_string(scans, "1000,3000,10000,30000,100000", "scaling: numbers of scans, one run each");
DEFINE_string(
    solvers, plumbline::kDefaultSolvers,
    "solver_comparison: solvers to compare, separated by commas, each SOLVER[:WORD[:WORD...]]. "
    "SOLVER: a name of --solver. Words of ceres: the names that --ceres takes for values, e.g. "
    "ceres:iterative_schur:schur_jacobi, ceres:subspace_dogleg, ceres:lbfgs or "
    "ceres:polak_ribiere:armijo, and reduced (see --reduced) or points. A line search direction, "
    "nonlinear conjugate gradient or line search implies line_search, the others trust_region. "
    "And reduced:fixed_lines. A word overrides its flag, and flags "
    "count for all that no word says. In the comparison a line search of ceres has up to 300 "
    "iterations per round, alternating_cg up to 100 sweeps, unless --ceres=max_num_iterations=N "
    "or --cg_max_sweeps is given");
DEFINE_int32(repeats, plumbline::ComparisonOptions().repeats,
             "solver_comparison: runs of each solver");
DEFINE_double(time_limit_s, plumbline::ComparisonOptions().time_limit_s,
              "solver_comparison: a solver is asked to stop after this time [s]");
