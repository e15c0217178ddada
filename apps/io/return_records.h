#ifndef PLUMBLINE_APPS_IO_RETURN_RECORDS_H_
#define PLUMBLINE_APPS_IO_RETURN_RECORDS_H_

#include <cstddef>
#include <functional>
#include <string>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Stores the record of a return, of which the graph has this one, at `out` and gives the place
/// behind it.
using StoreReturn = std::function<unsigned char*(std::size_t return_id, unsigned char* out)>;

/// Writes a file of a header and one record of bytes_per_record for each return, in their order. If
/// the graph has peers, each process writes the records of its own returns (collective). The file
/// is whole or not there. Fails like AtomicFile.
Status WriteReturnRecords(const std::string& path, const std::string& header,
                          const SlamGraph& graph, std::size_t bytes_per_record,
                          const StoreReturn& store);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_RETURN_RECORDS_H_
