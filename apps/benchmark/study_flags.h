#ifndef PLUMBLINE_APPS_BENCHMARK_STUDY_FLAGS_H_
#define PLUMBLINE_APPS_BENCHMARK_STUDY_FLAGS_H_

#include <gflags/gflags_declare.h>

// Flags of the studies, in a file whose flags --help lists (ProgramFlags).
DECLARE_string(csv);
DECLARE_int32(buildings);
DECLARE_uint64(study_first_seed);
DECLARE_string(study_scanner);
DECLARE_int32(seeds);
DECLARE_string(variations);
DECLARE_int32(variation_seeds);
DECLARE_string(scans);
DECLARE_string(solvers);
DECLARE_int32(repeats);
DECLARE_double(time_limit_s);

#endif  // PLUMBLINE_APPS_BENCHMARK_STUDY_FLAGS_H_
