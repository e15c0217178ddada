#ifndef PLUMBLINE_APPS_IO_RETURN_RECORDS_H_
#define PLUMBLINE_APPS_IO_RETURN_RECORDS_H_

#include <cstddef>
#include <functional>
#include <string>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/file_buffer.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Stores the record of a return, of which the graph has this one, at `out` and gives the place
/// behind it.
using StoreReturn = std::function<unsigned char*(std::size_t return_id, unsigned char* out)>;

/// A file of a header and one record for each return, in their order, whole or not there. If the
/// graph has peers, each process writes the records of its own returns (both steps are collective);
/// between the steps it can do other work while the disk takes in what was written.
class ReturnRecords {
 public:
  /// Writes the records, of bytes_per_record each. Fails like AtomicFile::Open. Call once.
  Status Write(const std::string& path, const std::string& header, const SlamGraph& graph,
               std::size_t bytes_per_record, const StoreReturn& store);

  /// Puts the file in its place once the disk has all of it. Fails like AtomicFile::Commit.
  Status Commit();

 private:
  Status WriteOwn(const std::string& temporary_path, std::size_t header_size,
                  const SlamGraph& graph, std::size_t bytes_per_record, const StoreReturn& store);

  std::string path_;
  const Peers* peers_ = nullptr;
  AtomicFile file_;  // of the process that speaks for all
  FileBuffer own_;   // where this one of several processes writes to the same file
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_RETURN_RECORDS_H_
