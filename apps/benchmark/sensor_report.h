#ifndef PLUMBLINE_APPS_BENCHMARK_SENSOR_REPORT_H_
#define PLUMBLINE_APPS_BENCHMARK_SENSOR_REPORT_H_

#include <string>
#include <vector>

#include "plumbline/apps/benchmark/sensor_matrix.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A table for people: per case the medians over its seeds, the worst mean pose error, and how many
/// of its runs warned or failed; below, the runs that failed, and why.
std::string SensorTable(const std::vector<SensorCase>& cases,
                        const std::vector<SensorOutcome>& outcomes);

/// One line per case and seed. NotFound or Unavailable if the file cannot be written; so does the
/// other.
Status WriteSensorCsv(const std::string& path, const std::vector<SensorCase>& cases,
                      const std::vector<SensorOutcome>& outcomes);

/// The cases, what they simulate in numbers, and their runs.
Status WriteSensorJson(const std::string& path, const std::vector<SensorCase>& cases,
                       const std::vector<SensorOutcome>& outcomes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SENSOR_REPORT_H_
