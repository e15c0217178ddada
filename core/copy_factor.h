#ifndef PLUMBLINE_CORE_COPY_FACTOR_H_
#define PLUMBLINE_CORE_COPY_FACTOR_H_

#include <functional>

#include "plumbline/core/custom_factor.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Where a pose or a scan is in another graph; negative: nowhere.
using IdThere = std::function<int(int id)>;

/// Adds a factor of one graph to another that has some of its poses, and of its scans with all
/// their returns. Adds nothing if the factor sees something that is not there.
void CopyFactor(const SlamGraph& from, const CustomFactor& factor, const IdThere& pose_there,
                const IdThere& scan_there, SlamGraph* to);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_COPY_FACTOR_H_
