#include "plumbline/apps/bags/ros1_bag.h"

#include <algorithm>
#include <cstdint>
#include <istream>
#include <map>
#include <utility>

#include "plumbline/apps/bags/bag_stream.h"
#include "plumbline/apps/io/byte_reader.h"
#include "plumbline/apps/io/compressed_frames.h"
#include "plumbline/apps/io/field_reader.h"

namespace plumbline {
namespace {

constexpr std::string_view kRos1FirstLine = "#ROSBAG V2.0\n";

// Kind of a record: the field "op" of its header.
enum Op : std::uint8_t {
  kNoOp = 0,
  kMessageData = 2,
  kBagHeader = 3,
  kChunkData = 5,
  kConnection = 7,
};

constexpr std::uint64_t kLengthBytes = 4;
constexpr std::uint64_t kMaxHeaderBytes = std::uint64_t{1} << 20;
constexpr std::uint64_t kMaxRos1ChunkBytes = std::uint64_t{1} << 30;
// Maximum length of any other record that is looked into. No scan or definition is longer.
constexpr std::uint64_t kMaxRos1RecordBytes = std::uint64_t{1} << 28;

// Fields of a record's header or of a connection: each a length, a name, '=' and a value.
class Ros1Fields {
 public:
  // False if the bytes are no fields. They have to outlive this.
  bool Parse(std::string_view bytes) {
    fields_.clear();
    ByteReader reader(bytes);
    while (!reader.rest().empty()) {
      const std::string_view field = reader.Text();
      const std::size_t name_length = field.find('=');
      if (!reader.ok() || name_length == field.npos) return false;
      fields_[field.substr(0, name_length)] = field.substr(name_length + 1);
    }
    return true;
  }

  // Empty if there is no such field.
  std::string_view Text(std::string_view name) const {
    const auto field = fields_.find(name);
    return field == fields_.end() ? std::string_view() : field->second;
  }

  // False if there is no such field of this size.
  template <typename T>
  bool Number(std::string_view name, T* number) const {
    const std::string_view value = Text(name);
    if (value.size() != sizeof(T)) return false;
    *number = ByteReader(value).Number<T>();
    return true;
  }

  Op Kind() const {
    std::uint8_t op = kNoOp;
    Number("op", &op);
    return static_cast<Op>(op);
  }

 private:
  std::map<std::string_view, std::string_view> fields_;
};

// Goes through the records of a file once.
class Ros1Walk {
 public:
  Ros1Walk(const std::string& path, std::istream* file, std::uint64_t size,
           const BagContainer::IsWanted& is_wanted, const BagContainer::TakeMessage& take)
      : path_(path), file_(file), size_(size), end_(size), is_wanted_(is_wanted), take_(take) {}

  Status Run() {
    PLUMBLINE_RETURN_IF_ERROR(ReadStart());
    const std::uint64_t chunks_at = at_;
    PLUMBLINE_RETURN_IF_ERROR(ReadIndex());
    if (has_index_ && wants_nothing_ && !connections_.empty()) return Status::Ok();
    Seek(chunks_at);
    if (has_index_) end_ = index_at_;
    for (is_over_ = false; at_ < end_ && !is_over_;) PLUMBLINE_RETURN_IF_ERROR(ReadRecord());
    return Status::Ok();
  }

  // See BagContainer.
  std::string Omission() const {
    if (has_index_) return "";
    std::string text = "the recording was not closed or is cut off, its index is missing";
    if (at_ >= size_) return text;
    return text + ", and the last " + std::to_string(size_ - at_) + " of its " +
           std::to_string(size_) + " bytes, which are no whole records, are not read";
  }

 private:
  struct Connection {
    BagTopic topic;
    bool is_wanted = false;
  };

  Status Damaged(const std::string& problem) const {
    return Status::DataLoss(path_ + ": cannot be read as a ROS bag: " + problem);
  }
  Status DamagedRecord(const std::string& problem) const {
    const std::string in_chunk =
        chunk_size_ == 0 ? ""
                         : "in the chunk there, the record at byte " +
                               std::to_string(chunk_size_ - chunk_.rest().size()) + ": ";
    return Damaged("the record at byte " + std::to_string(record_at_) + ": " + in_chunk + problem);
  }

  void Seek(std::uint64_t at) {
    at_ = at;
    file_->clear();
    file_->seekg(static_cast<std::streamoff>(at));
  }
  // Reads `size` bytes, at most those left of the file. False if the file cannot be read.
  bool Read(std::uint64_t size, std::string* bytes) {
    bytes->resize(static_cast<std::size_t>(size));
    file_->read(bytes->data(), static_cast<std::streamsize>(size));
    at_ += size;
    return file_->good();
  }

  // The length of a header or of data. False if the bytes that it announces are not there.
  bool ReadLength(std::uint64_t* length) {
    std::string bytes;
    if (end_ - at_ < kLengthBytes || !Read(kLengthBytes, &bytes)) return false;
    *length = ByteReader(bytes).Number<std::uint32_t>();
    return *length <= end_ - at_;
  }

  // An incomplete record is damage in a bag with an index, else the end of an interrupted
  // recording.
  Status EndOrDamage(const std::string& problem) {
    if (has_index_) return DamagedRecord(problem);
    is_over_ = true;
    Seek(record_at_);
    return Status::Ok();
  }

  // The first line and the record behind it.
  Status ReadStart() {
    std::string start;
    if (size_ < kRos1FirstLine.size() || !Read(kRos1FirstLine.size(), &start) ||
        start != kRos1FirstLine) {
      return Damaged("it does not begin with the line '#ROSBAG V2.0', as files of version 2.0 do");
    }
    record_at_ = at_;
    std::uint64_t length = 0;
    if (!ReadLength(&length)) return DamagedRecord("it is cut off");
    if (length > kMaxHeaderBytes || !Read(length, &header_) || !fields_.Parse(header_) ||
        fields_.Kind() != kBagHeader || !fields_.Number("index_pos", &index_at_)) {
      return DamagedRecord("it is no header of a bag");
    }
    const std::string_view encryptor = fields_.Text("encryptor");
    if (!encryptor.empty() && encryptor != "rosbag/NoEncryptor") {
      return Status::InvalidArgument(path_ + ": the bag is encrypted by " + Quote(encryptor) +
                                     "; rosbag decrypt makes one that can be read");
    }
    if (!ReadLength(&length)) return DamagedRecord("it is cut off");
    Seek(at_ + length);
    return Status::Ok();
  }

  // All connections stand behind the chunks once more.
  Status ReadIndex() {
    if (index_at_ < at_ || index_at_ >= size_) return Status::Ok();
    Seek(index_at_);
    while (at_ < end_ && !is_over_) {
      std::uint64_t length = 0;
      PLUMBLINE_RETURN_IF_ERROR(ReadHeader(&length));
      if (is_over_) return Status::Ok();
      if (fields_.Kind() == kConnection) {
        PLUMBLINE_RETURN_IF_ERROR(ReadConnection(length));
      } else {
        Seek(at_ + length);
      }
    }
    has_index_ = true;
    return Status::Ok();
  }

  // Of the next record, up to its data, which have `length` bytes.
  Status ReadHeader(std::uint64_t* length) {
    constexpr char kTooLong[] = "it is longer than what is left of the file";
    record_at_ = at_;
    std::uint64_t header_length = 0;
    if (!ReadLength(&header_length)) return EndOrDamage(kTooLong);
    if (header_length > kMaxHeaderBytes) return EndOrDamage("its header is too long for one");
    if (!Read(header_length, &header_)) return DamagedRecord("it cannot be read");
    if (!fields_.Parse(header_) || fields_.Kind() == kNoOp) {
      return EndOrDamage("its header has no fields, or no 'op' among them");
    }
    return ReadLength(length) ? Status::Ok() : EndOrDamage(kTooLong);
  }

  Status ReadRecord() {
    std::uint64_t length = 0;
    PLUMBLINE_RETURN_IF_ERROR(ReadHeader(&length));
    if (is_over_) return Status::Ok();
    switch (fields_.Kind()) {
      case kChunkData:
        return ReadChunk(length);
      case kConnection:
        return ReadConnection(length);
      case kMessageData:
        return ReadMessage(length);
      default:
        Seek(at_ + length);
        return Status::Ok();
    }
  }

  Status ReadConnection(std::uint64_t length) {
    if (length > kMaxRos1RecordBytes) return DamagedRecord("it is longer than such records are");
    return Read(length, &content_) ? Define(content_) : DamagedRecord("it cannot be read");
  }

  // Of a chunk that was being written when the recording was interrupted.
  Status ReadMessage(std::uint64_t length) {
    const Connection* connection = nullptr;
    PLUMBLINE_RETURN_IF_ERROR(FindConnection(&connection));
    if (!connection->is_wanted) {
      Seek(at_ + length);
      return Status::Ok();
    }
    if (length > kMaxRos1RecordBytes) return DamagedRecord("it is longer than such records are");
    return Read(length, &content_) ? Take(*connection, content_)
                                   : DamagedRecord("it cannot be read");
  }

  Status Define(std::string_view data) {
    std::uint32_t id = 0;
    Ros1Fields fields;
    if (!fields_.Number("conn", &id)) return DamagedRecord("a connection without field 'conn'");
    if (!fields.Parse(data)) return DamagedRecord("a connection whose data have no fields");
    if (connections_.count(id) != 0) return Status::Ok();
    Connection connection;
    connection.topic = {std::string(fields_.Text("topic")), std::string(fields.Text("type")),
                        "ros1"};
    connection.is_wanted = is_wanted_(connection.topic);
    wants_nothing_ = wants_nothing_ && !connection.is_wanted;
    connections_.emplace(id, std::move(connection));
    return Status::Ok();
  }

  Status FindConnection(const Connection** connection) const {
    std::uint32_t id = 0;
    if (!fields_.Number("conn", &id)) return DamagedRecord("a message without field 'conn'");
    const auto found = connections_.find(id);
    if (found == connections_.end()) {
      return DamagedRecord("a message of connection " + std::to_string(id) +
                           ", which has not been defined");
    }
    *connection = &found->second;
    return Status::Ok();
  }

  Status Take(const Connection& connection, std::string_view data) const {
    std::uint64_t time = 0;
    if (!fields_.Number("time", &time)) return DamagedRecord("a message without field 'time'");
    // Seconds and nanoseconds, each a number of four bytes.
    const double time_s =
        static_cast<double>(time & 0xffffffff) + 1e-9 * static_cast<double>(time >> 32);
    return take_(connection.topic, time_s, data);
  }

  Status ReadChunk(std::uint64_t length) {
    std::uint32_t size = 0;
    if (!fields_.Number("size", &size)) return DamagedRecord("a chunk without field 'size'");
    const std::string compression(fields_.Text("compression"));
    if (compression != "none" && compression != "bz2" && compression != "lz4") {
      return DamagedRecord("its compression is neither none nor bz2 nor lz4");
    }
    if (size > kMaxRos1ChunkBytes || length > kMaxRos1ChunkBytes) {
      return DamagedRecord("a chunk of " + std::to_string(std::max<std::uint64_t>(size, length)) +
                           " bytes; 1 GiB is the limit");
    }
    // A chunk gets its lengths when it is complete. Plain records of an incomplete one follow as if
    // there were no chunk; compressed ones have no end.
    if (length == 0 && size == 0 && !has_index_) {
      is_over_ = compression != "none";
      return Status::Ok();
    }
    if (!Read(length, &content_)) return DamagedRecord("it cannot be read");
    std::string_view records = content_;
    if (compression != "none") {
      const FrameFormat format = compression == "bz2" ? FrameFormat::kBzip2 : FrameFormat::kLz4;
      const Status status = ExpandFrames(format, records, size, &expanded_);
      if (!status.ok()) return DamagedRecord(status.message());
      records = expanded_;
    }
    if (records.size() != size) {
      return DamagedRecord("a chunk of " + std::to_string(records.size()) + " bytes that says " +
                           "to have " + std::to_string(size));
    }
    return ReadRecordsOfChunk(records);
  }

  Status ReadRecordsOfChunk(std::string_view records) {
    chunk_size_ = records.size();
    chunk_ = ByteReader(records);
    while (!chunk_.rest().empty()) {
      ByteReader reader = chunk_;
      const std::string_view header = reader.Text(), data = reader.Text();
      if (!reader.ok()) return DamagedRecord("it is longer than the chunk");
      if (!fields_.Parse(header)) return DamagedRecord("its header has no fields");
      PLUMBLINE_RETURN_IF_ERROR(ReadRecordOfChunk(data));
      chunk_ = reader;
    }
    chunk_size_ = 0;
    return Status::Ok();
  }

  Status ReadRecordOfChunk(std::string_view data) {
    if (fields_.Kind() == kConnection) return Define(data);
    if (fields_.Kind() != kMessageData) return Status::Ok();
    const Connection* connection = nullptr;
    PLUMBLINE_RETURN_IF_ERROR(FindConnection(&connection));
    return connection->is_wanted ? Take(*connection, data) : Status::Ok();
  }

  const std::string& path_;
  std::istream* const file_;
  const std::uint64_t size_;
  std::uint64_t end_;  // of the records to read
  const BagContainer::IsWanted& is_wanted_;
  const BagContainer::TakeMessage& take_;

  std::uint64_t at_ = 0, record_at_ = 0, index_at_ = 0;
  bool has_index_ = false, is_over_ = false, wants_nothing_ = true;
  std::map<std::uint32_t, Connection> connections_;
  std::string header_, content_, expanded_;
  Ros1Fields fields_;  // of header_, or of the present record of the chunk
  // The chunk that is being read, from its present record on; 0: none.
  std::size_t chunk_size_ = 0;
  ByteReader chunk_{{}};
};

}  // namespace

std::unique_ptr<BagContainer> MakeRos1Bag(std::string path, std::optional<std::string> expanded) {
  return std::make_unique<StreamBag>(
      std::move(path), std::move(expanded),
      [](const std::string& name, std::istream* file, std::uint64_t size,
         const BagContainer::IsWanted& is_wanted, const BagContainer::TakeMessage& take,
         std::string* omission) {
        Ros1Walk walk(name, file, size, is_wanted, take);
        PLUMBLINE_RETURN_IF_ERROR(walk.Run());
        *omission = walk.Omission();
        return Status::Ok();
      });
}

}  // namespace plumbline
