#ifndef PLUMBLINE_APPS_MPI_REFUSED_FLAGS_H_
#define PLUMBLINE_APPS_MPI_REFUSED_FLAGS_H_

#include "plumbline/apps/run/log_run.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// InvalidArgument names the flag if these options ask for what several processes cannot do
/// together.
Status CheckGoesWithPeers(const LogRunOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_MPI_REFUSED_FLAGS_H_
