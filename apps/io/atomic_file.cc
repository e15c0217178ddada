#include "plumbline/apps/io/atomic_file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>

#include "plumbline/apps/io/file_status.h"

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

}  // namespace

AtomicFile::~AtomicFile() {
  if (!temporary_path_.empty()) std::remove(temporary_path_.c_str());
}

Status AtomicFile::Open(const std::string& path) {
  static std::atomic<int> counter{0};
  path_ = path;
  const std::string candidate = path + "." + std::to_string(getpid()) + "-" +
                                std::to_string(counter++) + std::string(kEnding);
  if (!buffer_.Open(candidate)) return WriteError("write", path, buffer_.error());
  temporary_path_ = candidate;
  return Status::Ok();
}

Status AtomicFile::Commit() {
  if (temporary_path_.empty()) return Status::Unavailable("no file is open for writing");
  if (!buffer_.Close() || !stream_) return WriteError("write", path_, buffer_.error());
  if (std::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
    return WriteError("replace", path_, errno);
  }
  temporary_path_.clear();
  return Status::Ok();
}

std::string_view TargetOfTemporary(std::string_view name) {
  if (name.size() < kEnding.size() || name.substr(name.size() - kEnding.size()) != kEnding) {
    return {};
  }
  name.remove_suffix(kEnding.size());
  return CutNumber('-', &name) && CutNumber('.', &name) ? name : std::string_view();
}

}  // namespace plumbline
