#ifndef PLUMBLINE_APPS_RUN_ARRAY_STORAGE_H_
#define PLUMBLINE_APPS_RUN_ARRAY_STORAGE_H_

#include <string>

#include "plumbline/apps/run/memory_estimate.h"

namespace plumbline {

/// Keeps a process within the memory of its budget, if that has a limit: from now on arrays of a
/// megabyte and more are on disk (DiskArrays, in `folder`) as soon as the process takes a third of
/// it, and pages of them are let go whenever it has too many. What is computed is the same, to the
/// bit; the system reads and writes what the passes over an array touch. All that is small has to
/// fit, as the keyframes of a drive do: MemoryEstimate::on_disk. Fills in disk, no_disk and decide.
///
/// Programs that call this get operators new and delete of their own. Once the arrays of a run have
/// to be on disk, one that fills up is what memory is that fills up: std::bad_alloc. To be called
/// once.
void KeepArraysWithin(const std::string& folder, MemoryBudget* budget);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_ARRAY_STORAGE_H_
