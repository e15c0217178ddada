#ifndef PLUMBLINE_APPS_RUN_PACKED_SEED_H_
#define PLUMBLINE_APPS_RUN_PACKED_SEED_H_

#include <string>
#include <vector>

#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// The poses, (x, y, yaw) each, and the report of a seed as bytes, for another process of the same
/// program. Every bit of a number is kept.
std::string PackSeed(const std::vector<double>& poses, const SeedingReport& report);

/// Reads what PackSeed wrote.
void UnpackSeed(const std::string& bytes, std::vector<double>* poses, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_PACKED_SEED_H_
