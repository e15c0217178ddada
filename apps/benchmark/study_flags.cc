#include "plumbline/apps/benchmark/study_flags.h"

#include <gflags/gflags.h>

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
