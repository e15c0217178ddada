#ifndef PLUMBLINE_APPS_BENCHMARK_PUBLISHED_FIGURES_H_
#define PLUMBLINE_APPS_BENCHMARK_PUBLISHED_FIGURES_H_

#include <optional>
#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

struct MeanAndStd {
  double mean = 0.0, std = 0.0;
};

/// What others have published of a system under the relations metric.
struct PublishedFigure {
  std::string system, source;
  MeanAndStd translation_m;
  std::optional<MeanAndStd> rotation_deg;  ///< none if only the translation was published
};

/// Figures published for a file of relations; none if there are none. The file is known by its
/// content (CRC-32 of the uncompressed lines), not by its name: figures belong to the relations
/// that they were measured with. Fails if the file cannot be read.
Status FindPublishedFigures(const std::string& relations_path,
                            std::vector<PublishedFigure>* figures);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_PUBLISHED_FIGURES_H_
