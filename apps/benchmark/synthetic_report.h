#ifndef PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_REPORT_H_
#define PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_REPORT_H_

#include <string>
#include <vector>

#include "plumbline/apps/benchmark/synthetic_experiment.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A table for people: per noise and mapper medians over the seeds, with the quartiles of the mean
/// errors, the number of failures, and the figures of the paper's synthetic experiment.
std::string SyntheticTable(const std::vector<SyntheticNoise>& noises,
                           const std::vector<SyntheticOutcome>& outcomes);

/// One line per seed, noise and mapper. Unavailable if the file cannot be written; so
/// do the others.
Status WriteSyntheticCsv(const std::string& path, const std::vector<SyntheticNoise>& noises,
                         const std::vector<SyntheticOutcome>& outcomes);

/// The figures of the table, with all quartiles, and the noise in physical units.
Status WriteSyntheticJson(const std::string& path, const std::vector<SyntheticNoise>& noises,
                          const std::vector<SyntheticOutcome>& outcomes);

/// Charts of one noise: errors of poses over their index, and of map points over theirs, as medians
/// and quartiles over the seeds. Mean errors over the stretches of SyntheticOutcome.
Status WritePoseErrorChart(const std::string& path, const SyntheticNoise& noise, int noise_index,
                           const std::vector<SyntheticOutcome>& outcomes);
Status WriteMapErrorChart(const std::string& path, const SyntheticNoise& noise, int noise_index,
                          const std::vector<SyntheticOutcome>& outcomes);

/// The truth and the maps of one drive side by side, with the two places magnified where walls of
/// SG and of Plumbline differ most.
Status WriteSyntheticMaps(const std::string& path, std::uint64_t seed, const SyntheticNoise& noise,
                          const MapLogOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_REPORT_H_
