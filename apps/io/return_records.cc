#include "plumbline/apps/io/return_records.h"

#include <ostream>
#include <vector>

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

}  // namespace

Status ReturnRecords::Write(const std::string& path, const std::string& header,
                            const SlamGraph& graph, std::size_t bytes_per_record,
                            const StoreReturn& store) {
  path_ = path;
  peers_ = graph.peers();
  if (peers_ == nullptr) {
    PLUMBLINE_RETURN_IF_ERROR(file_.Open(path));
    file_.stream() << header;
    WriteRecords(graph.num_returns(), bytes_per_record, store, &file_.stream());
    return Status::Ok();
  }
  std::string temporary_path;
  PLUMBLINE_RETURN_IF_ERROR(OpenForAll(path, peers_, &file_, &temporary_path));
  if (SpeaksForAll(peers_)) file_.stream() << header;
  return FirstFailure(peers_,
                      WriteOwn(temporary_path, header.size(), graph, bytes_per_record, store));
}

// To their places in the file of all.
Status ReturnRecords::WriteOwn(const std::string& temporary_path, std::size_t header_size,
                               const SlamGraph& graph, std::size_t bytes_per_record,
                               const StoreReturn& store) {
  if (!own_.OpenExisting(temporary_path)) return WriteError("write", path_, own_.error());
  std::ostream stream(&own_);
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    const std::size_t first_among_all = graph.all_scans()[graph.IdAmongAll(scan)].first_return;
    const bool follows = scan > 0 && graph.IdAmongAll(scan) == graph.IdAmongAll(scan - 1) + 1;
    if (!follows) own_.SeekTo(header_size + bytes_per_record * first_among_all);
    const ScanEntry& entry = graph.scan(scan);
    WriteRecords(
        entry.num_returns, bytes_per_record,
        [&](std::size_t i, unsigned char* out) { return store(entry.first_return + i, out); },
        &stream);
  }
  return own_.Send() ? Status::Ok() : WriteError("write", path_, own_.error());
}

Status ReturnRecords::Commit() {
  if (peers_ == nullptr) return file_.Commit();
  const bool has_own = own_.Close();
  PLUMBLINE_RETURN_IF_ERROR(
      FirstFailure(peers_, has_own ? Status::Ok() : WriteError("write", path_, own_.error())));
  return SpeaksForAll(peers_) ? file_.Commit() : Status::Ok();
}

}  // namespace plumbline
