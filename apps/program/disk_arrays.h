#ifndef PLUMBLINE_APPS_PROGRAM_DISK_ARRAYS_H_
#define PLUMBLINE_APPS_PROGRAM_DISK_ARRAYS_H_

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Large arrays that lie in files without a name, each in its own, which the system removes with
/// the array or with the process, however that ends. They are mapped: reading and writing them is
/// as ever, and the pages that were touched count as memory of the process until MakeRoom. Several
/// threads may use one object.
class DiskArrays {
 public:
  DiskArrays() = default;
  ~DiskArrays();
  DiskArrays(const DiskArrays&) = delete;
  DiskArrays& operator=(const DiskArrays&) = delete;

  /// Where they go from now on: the file system of `folder`, or of the nearest folder above that is
  /// there. Unavailable if that has no such files or cannot map them (as over a network), if they
  /// would be memory, or if it lets nobody write. To be called once, before all others.
  Status Open(const std::string& folder);

  /// An array of so many bytes, all 0, whose place on the disk is taken at once. Null if the disk
  /// is full. Where a file system moves what is written again (btrfs, ZFS), or the disk fails, the
  /// process may still end by SIGBUS.
  void* Add(std::size_t num_bytes);

  /// False, with nothing done, if the array is none of these.
  bool Remove(void* array);

  /// Lets go of all pages. What they hold stays on disk, or in what the system has no other use
  /// for.
  void MakeRoom();

  /// Room for more [bytes]; 0 before Open.
  double BytesFree() const;

 private:
  int folder_ = -1;   // a descriptor
  std::mutex mutex_;  // of what follows
  std::map<void*, std::size_t> arrays_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_DISK_ARRAYS_H_
