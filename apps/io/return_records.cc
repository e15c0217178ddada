#include "plumbline/apps/io/return_records.h"

#include <ostream>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/file_buffer.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/little_endian.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

// What process 0 opens for all, which is known by `path`.
Status OpenForAll(const std::string& path, const Peers* peers, AtomicFile* file,
                  std::string* temporary_path) {
  Status opened;
  std::vector<char> name;
  if (SpeaksForAll(peers)) {
    opened = file->Open(path);
    if (opened.ok() && file->temporary_path().empty()) {
      opened = Status::Unavailable("several processes cannot write '" + path +
                                   "': a pipe or a device, not a file");
    }
    name.assign(file->temporary_path().begin(), file->temporary_path().end());
  }
  PLUMBLINE_RETURN_IF_ERROR(FirstFailure(peers, opened));
  name = JoinOverPeers(peers, name);
  temporary_path->assign(name.begin(), name.end());
  return Status::Ok();
}

// To their places in the file of all.
Status WriteOwnRecords(const std::string& path, const std::string& temporary_path,
                       std::size_t header_size, const SlamGraph& graph,
                       std::size_t bytes_per_record, const StoreReturn& store) {
  FileBuffer buffer;
  if (!buffer.OpenExisting(temporary_path)) return WriteError("write", path, buffer.error());
  std::ostream stream(&buffer);
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    const std::size_t first_among_all = graph.all_scans()[graph.IdAmongAll(scan)].first_return;
    const bool follows = scan > 0 && graph.IdAmongAll(scan) == graph.IdAmongAll(scan - 1) + 1;
    if (!follows) buffer.SeekTo(header_size + bytes_per_record * first_among_all);
    const ScanEntry& entry = graph.scan(scan);
    WriteRecords(
        entry.num_returns, bytes_per_record,
        [&](std::size_t i, unsigned char* out) { return store(entry.first_return + i, out); },
        &stream);
  }
  return buffer.Close() && stream ? Status::Ok() : WriteError("write", path, buffer.error());
}

}  // namespace

Status WriteReturnRecords(const std::string& path, const std::string& header,
                          const SlamGraph& graph, std::size_t bytes_per_record,
                          const StoreReturn& store) {
  AtomicFile file;
  const Peers* peers = graph.peers();
  if (peers == nullptr) {
    PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
    file.stream() << header;
    WriteRecords(graph.num_returns(), bytes_per_record, store, &file.stream());
    return file.Commit();
  }
  std::string temporary_path;
  PLUMBLINE_RETURN_IF_ERROR(OpenForAll(path, peers, &file, &temporary_path));
  if (SpeaksForAll(peers)) file.stream() << header;
  PLUMBLINE_RETURN_IF_ERROR(FirstFailure(
      peers, WriteOwnRecords(path, temporary_path, header.size(), graph, bytes_per_record, store)));
  return SpeaksForAll(peers) ? file.Commit() : Status::Ok();
}

}  // namespace plumbline
