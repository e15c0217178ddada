#include "plumbline/apps/bags/ros1_records.h"

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";

// Of a header; the longest have a definition of a message type in them.
constexpr std::uint64_t kMaxHeaderBytes = 1 << 20;
constexpr std::uint64_t kIndexEntryBytes = 12;  // a time, and an offset

// What a record is, by the field "op" of its header.
constexpr std::string_view kMessageRecord = "\x02", kFile = "\x03", kIndex = "\x04",
                           kChunkRecord = "\x05", kChunkInfo = "\x06", kConnection = "\x07";

using Fields = std::map<std::string_view, std::string_view>;

// Little-endian on any machine.
std::uint64_t ToNumber(std::string_view bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    number = number << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return number;
}

// Splits a header into its fields. False if it is not made of fields, each after its length and
// with a '='.
bool Split(std::string_view header, Fields* fields) {
  while (!header.empty()) {
    if (header.size() < 4) return false;
    const std::uint64_t length = ToNumber(header.substr(0, 4));
    header.remove_prefix(4);
    if (length > header.size()) return false;
    const std::string_view field = header.substr(0, length);
    const std::size_t name_length = field.find('=');
    if (name_length == field.npos) return false;
    (*fields)[field.substr(0, name_length)] = field.substr(name_length + 1);
    header.remove_prefix(length);
  }
  return true;
}

// Goes through the parts of a file or of a chunk, each after its length.
class PartReader {
 public:
  PartReader(std::istream* file, std::uint64_t begin, std::uint64_t end)
      : file_(file), at_(begin), end_(end) {}

  bool at_end() const { return at_ == end_; }
  std::uint64_t at() const { return at_; }

  bool NextHeader(std::string* content) { return Next(kMaxHeaderBytes, content); }
  bool NextData(std::string* content) { return Next(end_, content); }
  bool SkipData() { return Next(0, nullptr); }

 private:
  // False if the part is longer than what is left or, if its content is wanted, than it may be.
  bool Next(std::uint64_t max_size, std::string* content) {
    std::string length(4, '\0');
    file_->seekg(static_cast<std::streamoff>(at_));
    if (end_ - at_ < length.size() || !file_->read(length.data(), length.size())) return false;
    const std::uint64_t size = ToNumber(length);
    if (size > end_ - at_ - length.size()) return false;
    if (content != nullptr) {
      if (size > max_size) return false;
      content->resize(size);
      if (!file_->read(content->data(), static_cast<std::streamsize>(size))) return false;
    }
    at_ += length.size() + size;
    return true;
  }

  std::istream* const file_;
  std::uint64_t at_;
  const std::uint64_t end_;
};

// Goes through the records of a file: their lengths, and that what points elsewhere points at a
// record of the right kind.
class RecordChecker {
 public:
  explicit RecordChecker(PartReader* parts) : parts_(parts) {}

  // Of the whole file; else `damaged` is where a bad record begins.
  bool Check(std::uint64_t* damaged) {
    while (!parts_->at_end()) {
      *damaged = parts_->at();
      if (!CheckRecord()) return false;
    }
    records_.insert(parts_->at());  // of an index without records
    return PointAt(records_, to_records_, damaged) && PointAt(chunks_, to_chunks_, damaged);
  }

 private:
  // By position: where the record begins that points there.
  using Pointers = std::map<std::uint64_t, std::uint64_t>;

  static bool PointAt(const std::set<std::uint64_t>& records, const Pointers& pointers,
                      std::uint64_t* damaged) {
    for (const auto& [position, from] : pointers) {
      *damaged = from;
      if (records.count(position) == 0) return false;
    }
    return true;
  }

  bool CheckRecord() {
    const std::uint64_t at = parts_->at();
    records_.insert(at);
    std::string header;
    Fields fields;
    if (!parts_->NextHeader(&header) || !Split(header, &fields)) return false;
    const std::string_view kind = fields["op"];
    if (kind == kChunkRecord) {
      chunks_.insert(at);
      return CheckChunk(fields["compression"] == "none", ToNumber(fields["size"]));
    }
    if (kind == kIndex) return CheckIndex(ToNumber(fields["count"]));
    if (kind == kConnection) return CheckConnection(parts_);
    if (kind == kChunkInfo) to_chunks_[ToNumber(fields["chunk_pos"])] = at;
    // A recording that was cut off has none, which the library says.
    const std::uint64_t index_at = kind == kFile ? ToNumber(fields["index_pos"]) : 0;
    if (index_at != 0) to_records_[index_at] = at;
    return parts_->SkipData();
  }

  static bool CheckConnection(PartReader* parts) {
    std::string data;
    Fields ignored;
    return parts->NextData(&data) && Split(data, &ignored);
  }

  bool CheckChunk(bool is_plain, std::uint64_t size) {
    message_starts_.clear();
    chunk_size_ = size;
    chunk_is_plain_ = is_plain;
    if (!is_plain) return parts_->SkipData();
    std::string data;
    if (!parts_->NextData(&data) || data.size() != size) return false;
    std::istringstream file(data);
    PartReader parts(&file, 0, size);
    // A message may be pointed at by the connections right before it.
    std::vector<std::uint64_t> starts;
    while (!parts.at_end()) {
      starts.push_back(parts.at());
      std::string header;
      Fields fields;
      if (!parts.NextHeader(&header) || !Split(header, &fields)) return false;
      const std::string_view kind = fields["op"];
      if (!(kind == kConnection ? CheckConnection(&parts) : parts.SkipData())) return false;
      if (kind == kMessageRecord) message_starts_.insert(starts.begin(), starts.end());
      if (kind != kConnection) starts.clear();
    }
    return true;
  }

  // Of the messages of the last chunk.
  bool CheckIndex(std::uint64_t count) {
    std::string data;
    if (!parts_->NextData(&data) || data.size() != count * kIndexEntryBytes) return false;
    for (std::size_t end = kIndexEntryBytes; end <= data.size(); end += kIndexEntryBytes) {
      const std::uint64_t offset = ToNumber(std::string_view(data).substr(end - 4, 4));
      if (chunk_is_plain_ ? message_starts_.count(offset) == 0 : offset >= chunk_size_) {
        return false;
      }
    }
    return true;
  }

  PartReader* const parts_;
  std::set<std::uint64_t> records_, chunks_;  // where they begin
  Pointers to_records_, to_chunks_;
  // Of the last chunk.
  bool chunk_is_plain_ = true;
  std::uint64_t chunk_size_ = 0;
  std::set<std::uint64_t> message_starts_;
};

}  // namespace

Status CheckRos1Records(const std::string& path) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  errno = 0;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return ReadError("open", path, errno);
  const std::uint64_t size = file.tellg();
  std::string start(kMagic.size(), '\0');
  file.seekg(0);
  if (!file.read(start.data(), start.size()) || start != kMagic) {
    return Status::DataLoss(path + ": cannot be read as a ROS bag: it does not begin with the " +
                            "line '#ROSBAG V2.0'");
  }
  PartReader parts(&file, kMagic.size(), size);
  std::uint64_t damaged = 0;
  if (RecordChecker(&parts).Check(&damaged)) return Status::Ok();
  return Status::DataLoss(path + ": cannot be read as a ROS bag: the record at byte " +
                          std::to_string(damaged) +
                          " is damaged, or longer than the file (rosbag " +
                          "reindex can repair a recording that was cut off)");
}

}  // namespace plumbline
