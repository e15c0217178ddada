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

Status ReadBagStream(const std::string& path, const std::optional<std::string>& expanded,
                     const std::function<Status(std::istream* stream, std::uint64_t size)>& read) {
  if (expanded) {
    MemoryBuffer buffer(*expanded);
    std::istream stream(&buffer);
    return read(&stream, expanded->size());
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return ReadError("open", path, errno);
  const auto size = static_cast<std::uint64_t>(file.tellg());
  file.seekg(0);
  return read(&file, size);
}

}  // namespace plumbline
