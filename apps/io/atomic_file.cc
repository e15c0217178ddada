#include "plumbline/apps/io/atomic_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/temporary_files.h"

namespace plumbline {
namespace {

constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kEnding = ".tmp";

// Cuts the digits off the end of a text, and `before` before them; false if they are not there.
bool CutNumber(char before, std::string_view* text) {
  const std::size_t end = text->find_last_not_of(kDigits);
  if (end == std::string_view::npos || end + 1 == text->size() || (*text)[end] != before) {
    return false;
  }
  *text = text->substr(0, end);
  return true;
}

bool IsSameFile(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// Standard output or standard error, if the file is one of them; negative otherwise.
int StandardDescriptor(const struct stat& file) {
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    struct stat standard {};
    if (fstat(descriptor, &standard) == 0 && IsSameFile(file, standard)) return descriptor;
  }
  return -1;
}

// Whom the system does not let give a file away keeps it.
void CopyOwnerAndPermissions(const struct stat& file, int descriptor) {
  constexpr mode_t kPermissions = 0777;  // not to act as the owner: these are data
  [[maybe_unused]] const int refused = fchown(descriptor, file.st_uid, file.st_gid);
  fchmod(descriptor, file.st_mode & kPermissions);
}

}  // namespace

AtomicFile::~AtomicFile() {
  if (temporary_path_.empty()) return;
  TemporaryFiles files;
  std::remove(temporary_path_.c_str());
  files.Remove(temporary_path_);
}

Status AtomicFile::Open(const std::string& path) {
  path_ = path;
  struct stat present {};
  if (stat(path.c_str(), &present) != 0) {
    return errno == ENOENT ? OpenTemporary(nullptr) : WriteError("write", path, errno);
  }
  if (S_ISDIR(present.st_mode)) return WriteError("write", path, EISDIR);
  const int standard = StandardDescriptor(present);
  if (standard < 0 && S_ISREG(present.st_mode)) return OpenTemporary(&present);
  std::cout.flush();  // comes before what is written here, where both go the same way
  const bool is_open = standard < 0 ? buffer_.OpenExisting(path) : buffer_.OpenCopy(standard);
  return is_open ? Status::Ok() : WriteError("write", path, buffer_.error());
}

Status AtomicFile::OpenTemporary(const struct stat* present) {
  constexpr mode_t kReadAndWriteForAll = 0666, kReadAndWriteForMe = 0600;
  static std::atomic<int> counter{0};
  target_path_ = FollowLinks(path_);
  std::string candidate;
  do {  // another run may have had this process' number
    candidate = target_path_ + "." + std::to_string(getpid()) + "-" + std::to_string(counter++) +
                std::string(kEnding);
    TemporaryFiles files;
    if (buffer_.OpenNew(candidate, present == nullptr ? kReadAndWriteForAll : kReadAndWriteForMe)) {
      files.Add(candidate);
    }
  } while (buffer_.error() == EEXIST);
  if (!buffer_.is_open()) return WriteError("write", path_, buffer_.error());
  temporary_path_ = candidate;
  if (present != nullptr) CopyOwnerAndPermissions(*present, buffer_.descriptor());
  return Status::Ok();
}

Status AtomicFile::Commit() {
  if (!buffer_.is_open()) return Status::Unavailable("no file is open for writing");
  if (!buffer_.Close() || !stream_) return WriteError("write", path_, buffer_.error());
  if (temporary_path_.empty()) return Status::Ok();
  TemporaryFiles files;
  if (std::rename(temporary_path_.c_str(), target_path_.c_str()) != 0) {
    return WriteError("replace", path_, errno);
  }
  files.Remove(temporary_path_);
  temporary_path_.clear();
  return Status::Ok();
}

Status CheckWritable(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_other(std::filesystem::status(path, ignored))) return Status::Ok();
  return AtomicFile().Open(path);
}

std::string FollowLinks(const std::string& path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  std::filesystem::path file = path;
  std::error_code no_link;
  for (int i = 0; i < kMostLinks; ++i) {
    const std::filesystem::path target = std::filesystem::read_symlink(file, no_link);
    if (no_link) break;
    file = file.parent_path() / target;
  }
  return file.string();
}

std::string_view TargetOfTemporary(std::string_view name) {
  if (name.size() < kEnding.size() || name.substr(name.size() - kEnding.size()) != kEnding) {
    return {};
  }
  name.remove_suffix(kEnding.size());
  return CutNumber('-', &name) && CutNumber('.', &name) ? name : std::string_view();
}

}  // namespace plumbline
