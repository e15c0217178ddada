#include "plumbline/apps/io/text_reader.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

constexpr std::size_t kBlockSize = std::size_t{1} << 18;
// A scan of the most beams fits in. What goes on for longer is no text, and a small compressed file
// can hold any amount of it.
constexpr std::size_t kMaxLineBytes = std::size_t{1} << 24;
// See the class.
constexpr std::uintmax_t kMaxExpansion = 200;
constexpr std::uintmax_t kAlwaysExpanded = std::uintmax_t{1} << 26;
constexpr char kByteOrderMark[] = "\xEF\xBB\xBF";

}  // namespace

TextReader::~TextReader() {
  if (file_ != nullptr) gzclose_r(file_);
}

Status TextReader::Open(const std::string& path) {
  path_ = path;
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  errno = 0;
  file_ = gzopen(path.c_str(), "rb");
  if (file_ == nullptr) return ReadError("open", path, errno);
  gzbuffer(file_, kBlockSize);
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(path, ignored);
  max_expanded_ = std::max(kAlwaysExpanded, ignored ? 0 : kMaxExpansion * size);
  return Status::Ok();
}

bool TextReader::NextLine(std::string_view* line) {
  std::size_t searched = 0;
  while (true) {
    const char* begin = buffer_.data() + begin_;
    const std::size_t size = end_ - begin_;
    const void* newline =
        size > searched ? std::memchr(begin + searched, '\n', size - searched) : nullptr;
    if (newline == nullptr && !at_end_ && size > kMaxLineBytes) {
      status_ = Status::InvalidArgument(path_ + ":" + std::to_string(line_number_ + 1) +
                                        ": the line is longer than 16 MiB");
      at_end_ = true;
    }
    if (newline == nullptr && !at_end_) {
      searched = size;
      Refill();
      continue;
    }
    if (newline == nullptr && (size == 0 || truncated_ || !status_.ok())) return false;
    const std::size_t length =
        newline == nullptr ? size
                           : static_cast<std::size_t>(static_cast<const char*>(newline) - begin);
    begin_ += std::min(length + 1, size);
    ++line_number_;
    *line = std::string_view(begin, length);
    if (!line->empty() && line->back() == '\r') line->remove_suffix(1);
    if (line_number_ == 1 && line->substr(0, 3) == kByteOrderMark) line->remove_prefix(3);
    return true;
  }
}

Status TextReader::CheckWhole() const {
  if (!truncated_) return status_;
  return Status::DataLoss(path_ + ": the compressed file is truncated after line " +
                          std::to_string(line_number_));
}

void TextReader::Refill() {
  if (begin_ > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (buffer_.size() < end_ + kBlockSize) buffer_.resize(2 * end_ + kBlockSize);
  errno = 0;
  const int num_read = gzread(file_, buffer_.data() + end_, kBlockSize);
  if (num_read > 0) {
    end_ += num_read;
    num_expanded_ += num_read;
  }
  if (num_expanded_ > max_expanded_ && gzdirect(file_) == 0) {
    status_ = Status::InvalidArgument(path_ + ": the compressed file expands to more than " +
                                      std::to_string(kMaxExpansion) + " times its size");
    at_end_ = true;
    return;
  }
  if (num_read == static_cast<int>(kBlockSize)) return;

  at_end_ = true;
  const int read_errno = errno;
  int code = Z_OK;
  const char* message = gzerror(file_, &code);
  if (code == Z_ERRNO) {
    status_ = ReadError("read", path_, read_errno);
  } else if (code == Z_BUF_ERROR) {
    truncated_ = true;
  } else if (code != Z_OK && code != Z_STREAM_END) {
    // Most of zlib's messages begin with the path as well.
    std::string problem = message;
    if (problem.compare(0, path_.size(), path_) != 0) problem = path_ + ": " + problem;
    status_ = Status::DataLoss(problem.insert(
        path_.size() + 1,
        " the compressed file is damaged after line " + std::to_string(line_number_) + ":"));
  }
}

std::string StartOfFile(const std::string& path, std::size_t size) {
  if (!RefusePipe(path).ok()) return "";
  const gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return "";
  std::string start(size, '\0');
  const int num_read = gzread(file, start.data(), static_cast<unsigned>(size));
  start.resize(std::max(num_read, 0));
  gzclose_r(file);
  return start;
}

}  // namespace plumbline
