#include "plumbline/apps/program/disk_arrays.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

// The folder, or the nearest one above that is there.
std::filesystem::path ExistingFolder(const std::string& folder) {
  std::error_code ignored;
  std::filesystem::path path = std::filesystem::absolute(folder, ignored);
  while (!std::filesystem::is_directory(path, ignored) && path.has_relative_path()) {
    path = path.parent_path();
  }
  return path;
}

// Whether the file has so many bytes now that nobody can take away; sets errno if not.
bool Allocate(int file, std::size_t num_bytes) {
  do {
    errno = posix_fallocate(file, 0, static_cast<off_t>(num_bytes));
  } while (errno == EINTR);
  return errno == 0;
}

// A file without a name; negative, with errno set, if there is none to be had.
int UnnamedFile(int folder) {
  constexpr int kOnlyOwner = 0600;
  return openat(folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, kOnlyOwner);
}

bool IsMemory(int folder) {
  struct statfs system {};
  return fstatfs(folder, &system) == 0 &&
         (system.f_type == TMPFS_MAGIC || system.f_type == RAMFS_MAGIC);
}

}  // namespace

DiskArrays::~DiskArrays() {
  for (const auto& [array, num_bytes] : arrays_) munmap(array, num_bytes);
  if (folder_ >= 0) close(folder_);
}

Status DiskArrays::Open(const std::string& folder) {
  const std::string path = ExistingFolder(folder).string();
  folder_ = open(path.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (folder_ >= 0 && IsMemory(folder_)) {
    return Status::Unavailable("cannot keep arrays in '" + path + "': it is no disk, but memory");
  }
  if (folder_ >= 0 && Remove(Add(1))) return Status::Ok();
  return WriteError("keep arrays in", path, errno);
}

void* DiskArrays::Add(std::size_t num_bytes) {
  const int file = UnnamedFile(folder_);
  if (file < 0) return nullptr;
  // To find a full disk while an array is filled would be the end of the process.
  // Without a look, the attempt would take all that is left from others.
  errno = ENOSPC;
  const bool fits = static_cast<double>(num_bytes) <= BytesFree() && Allocate(file, num_bytes);
  void* array =
      fits ? mmap(nullptr, num_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0) : MAP_FAILED;
  close(file);
  if (array == MAP_FAILED) return nullptr;
  const std::lock_guard<std::mutex> lock(mutex_);
  arrays_.emplace(array, num_bytes);
  return array;
}

bool DiskArrays::Remove(void* array) {
  // Freed behind the lock: it is memory, which may be what called this.
  std::map<void*, std::size_t>::node_type entry;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    entry = arrays_.extract(array);
    if (entry.empty()) return false;
  }
  munmap(array, entry.mapped());
  return true;
}

void DiskArrays::MakeRoom() {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [array, num_bytes] : arrays_) madvise(array, num_bytes, MADV_DONTNEED);
}

double DiskArrays::BytesFree() const {
  struct statvfs system {};
  if (folder_ < 0 || fstatvfs(folder_, &system) != 0) return 0.0;
  return static_cast<double>(system.f_bavail) * static_cast<double>(system.f_frsize);
}

}  // namespace plumbline
