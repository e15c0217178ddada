#include "plumbline/apps/io/file_buffer.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

namespace plumbline {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 16;

}  // namespace

FileBuffer::~FileBuffer() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool FileBuffer::OpenNew(const std::string& path, mode_t permissions) {
  error_ = 0;  // a name that was taken may be followed by another one
  return Take(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, permissions));
}

bool FileBuffer::OpenExisting(const std::string& path) {
  return Take(open(path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC));
}

bool FileBuffer::OpenCopy(int descriptor) { return Take(fcntl(descriptor, F_DUPFD_CLOEXEC, 0)); }

bool FileBuffer::Take(int descriptor) {
  if (descriptor < 0) return Fail();
  descriptor_ = descriptor;
  buffer_.resize(kBufferSize);
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  return true;
}

bool FileBuffer::SeekTo(std::size_t position) {
  if (!Flush()) return false;
  return lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) >= 0 || Fail();
}

bool FileBuffer::Send() {
  if (!Flush()) return false;
#ifdef SYNC_FILE_RANGE_WRITE  // of Linux; where it is not, Close() waits longer
  sync_file_range(descriptor_, 0, 0, SYNC_FILE_RANGE_WRITE);
#endif
  return true;
}

bool FileBuffer::Close() {
  Flush();
  // What has no disk behind it (a pipe, a device) cannot be waited for.
  if (fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP) Fail();
  if (close(descriptor_) != 0) Fail();
  descriptor_ = -1;
  setp(nullptr, nullptr);
  return error_ == 0;
}

FileBuffer::int_type FileBuffer::overflow(int_type character) {
  if (!Flush()) return traits_type::eof();
  if (!traits_type::eq_int_type(character, traits_type::eof())) {
    *pptr() = traits_type::to_char_type(character);
    pbump(1);
  }
  return traits_type::not_eof(character);
}

int FileBuffer::sync() { return Flush() ? 0 : -1; }

bool FileBuffer::Flush() {
  if (descriptor_ < 0 || error_ != 0) return false;
  const char* begin = pbase();
  while (begin < pptr()) {
    const ssize_t size = write(descriptor_, begin, static_cast<std::size_t>(pptr() - begin));
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return Fail();
    begin += size;
  }
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  return true;
}

bool FileBuffer::Fail() {
  if (error_ == 0) error_ = errno;
  return false;
}

}  // namespace plumbline
