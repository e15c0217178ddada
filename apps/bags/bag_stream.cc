#include "plumbline/apps/bags/bag_stream.h"

#include <cerrno>
#include <fstream>
#include <streambuf>

#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

// Lets a stream read from memory.
class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(const std::string& bytes) {
    char* const begin = const_cast<char*>(bytes.data());  // only read
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  pos_type seekpos(pos_type position, std::ios_base::openmode /*mode*/) override {
    const off_type offset = position;
    if (offset < 0 || offset > egptr() - eback()) return pos_type(off_type(-1));
    setg(eback(), eback() + offset, egptr());
    return position;
  }
};

}  // namespace

Status StreamBag::ReadMessages(const IsWanted& is_wanted, const TakeMessage& take) {
  omission_.clear();
  if (expanded_) {
    MemoryBuffer buffer(*expanded_);
    std::istream stream(&buffer);
    return walk_(path_, &stream, expanded_->size(), is_wanted, take, &omission_);
  }
  errno = 0;
  std::ifstream file(path_, std::ios::binary | std::ios::ate);
  if (!file) return ReadError("open", path_, errno);
  const auto size = static_cast<std::uint64_t>(file.tellg());
  file.seekg(0);
  return walk_(path_, &file, size, is_wanted, take, &omission_);
}

}  // namespace plumbline
