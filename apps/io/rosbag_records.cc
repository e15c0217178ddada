#include "plumbline/apps/io/rosbag_records.h"

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <string_view>

#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";

// Of a header; the longest have a definition of a message type in them.
constexpr std::uint64_t kMaxHeaderBytes = 1 << 20;
constexpr std::string_view kConnection = "op=\x07";  // whose data are a header as well

// Little-endian on any machine.
std::uint64_t LengthOf(std::string_view bytes) {
  std::uint64_t length = 0;
  for (int i = 3; i >= 0; --i) length = length << 8 | static_cast<unsigned char>(bytes[i]);
  return length;
}

// Whether a header is made of fields, each after its length and with a '='.
bool IsHeader(std::string_view header, bool* is_connection) {
  while (!header.empty()) {
    if (header.size() < 4) return false;
    const std::uint64_t length = LengthOf(header);
    header.remove_prefix(4);
    if (length > header.size()) return false;
    const std::string_view field = header.substr(0, length);
    if (field.find('=') == field.npos) return false;
    if (field == kConnection) *is_connection = true;
    header.remove_prefix(length);
  }
  return true;
}

// Goes through the parts of a file, each after its length.
class PartReader {
 public:
  PartReader(std::istream* file, std::uint64_t begin, std::uint64_t end)
      : file_(file), at_(begin), end_(end) {}

  bool at_end() const { return at_ == end_; }
  std::uint64_t at() const { return at_; }

  // False if the part is longer than what is left or, if its content is wanted, than a header.
  bool Next(std::string* content) {
    std::string length(4, '\0');
    file_->seekg(static_cast<std::streamoff>(at_));
    if (end_ - at_ < length.size() || !file_->read(length.data(), length.size())) return false;
    const std::uint64_t size = LengthOf(length);
    if (size > end_ - at_ - length.size()) return false;
    if (content != nullptr) {
      if (size > kMaxHeaderBytes) return false;
      content->resize(size);
      if (!file_->read(content->data(), static_cast<std::streamsize>(size))) return false;
    }
    at_ += length.size() + size;
    return true;
  }

 private:
  std::istream* const file_;
  std::uint64_t at_;
  const std::uint64_t end_;
};

bool CheckRecord(PartReader* parts) {
  std::string header, data;
  bool is_connection = false, ignored = false;
  if (!parts->Next(&header) || !IsHeader(header, &is_connection)) return false;
  return is_connection ? parts->Next(&data) && IsHeader(data, &ignored) : parts->Next(nullptr);
}

}  // namespace

Status CheckRosbagRecords(const std::string& path) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  errno = 0;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return ReadError("open", path, errno);
  const std::uint64_t size = file.tellg();
  std::string start(kMagic.size(), '\0');
  file.seekg(0);
  if (!file.read(start.data(), start.size()) || start != kMagic) return Status::Ok();
  PartReader parts(&file, kMagic.size(), size);
  while (!parts.at_end()) {
    const std::uint64_t at = parts.at();
    if (CheckRecord(&parts)) continue;
    return Status::DataLoss(path + ": cannot be read as a ROS bag: the record at byte " +
                            std::to_string(at) + " is damaged, or longer than the file (rosbag " +
                            "reindex can repair a recording that was cut off)");
  }
  return Status::Ok();
}

}  // namespace plumbline
