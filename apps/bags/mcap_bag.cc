#include "plumbline/apps/bags/mcap_bag.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <istream>
#include <map>
#include <utility>

#include "plumbline/apps/bags/bag_stream.h"
#include "plumbline/apps/io/byte_reader.h"
#include "plumbline/apps/io/compressed_frames.h"

namespace plumbline {
namespace {

enum Opcode : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kDataEnd = 15,
};

constexpr std::uint64_t kRecordStartBytes = 1 + 8;           // opcode, length of the content
constexpr std::uint64_t kMessageStartBytes = 2 + 4 + 8 + 8;  // channel, sequence number, two times
constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{1} << 30;
// Of any other record that is looked into: no scan or definition is longer.
constexpr std::uint64_t kMaxRecordBytes = std::uint64_t{1} << 28;
constexpr std::size_t kSkippedBlockBytes = std::size_t{1} << 18;

std::uint32_t Crc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

// Goes through the records of a file once.
class McapWalk {
 public:
  McapWalk(const std::string& path, std::istream* file, std::uint64_t size,
           const BagContainer::IsWanted& is_wanted, const BagContainer::TakeMessage& take)
      : path_(path), file_(file), size_(size), is_wanted_(is_wanted), take_(take) {}

  Status Run() {
    std::string magic;
    if (size_ < kMcapMagic.size() || !Read(kMcapMagic.size(), &magic) || magic != kMcapMagic) {
      return Damaged("it does not begin as files of version 0 do");
    }
    for (bool is_first = true; !at_end_; is_first = false) {
      record_at_ = at_;
      data_crc_ = crc_;
      std::string start;
      if (size_ - at_ < kRecordStartBytes || !Read(kRecordStartBytes, &start)) {
        return DamagedRecord("the file is cut off there");
      }
      ByteReader reader(start);
      const auto opcode = reader.Number<std::uint8_t>();
      const auto length = reader.Number<std::uint64_t>();
      if (length > size_ - at_) return DamagedRecord("it is longer than the file");
      if (is_first && opcode != kHeader) return DamagedRecord("it is no header");
      PLUMBLINE_RETURN_IF_ERROR(ReadRecord(opcode, length));
    }
    return Status::Ok();
  }

 private:
  struct Channel {
    BagTopic topic;
    bool is_wanted = false;
  };

  Status Damaged(const std::string& problem) const {
    return Status::DataLoss(path_ + ": cannot be read as an MCAP file: " + problem +
                            " (mcap recover can save what was recorded before)");
  }
  Status DamagedRecord(const std::string& problem) const {
    const std::string in_chunk =
        chunk_size_ == 0 ? ""
                         : "in the chunk there, the record at byte " +
                               std::to_string(chunk_size_ - chunk_.rest().size()) + ": ";
    return Damaged("the record at byte " + std::to_string(record_at_) + ": " + in_chunk + problem);
  }

  // Up to what is left of the file.
  bool Read(std::uint64_t size, std::string* bytes) {
    bytes->resize(static_cast<std::size_t>(size));
    file_->read(bytes->data(), static_cast<std::streamsize>(size));
    at_ += size;
    crc_ = Crc(*bytes, crc_);
    return file_->good();
  }
  bool Skip(std::uint64_t size) {
    for (std::uint64_t left = size; left > 0;) {
      const std::uint64_t block = std::min<std::uint64_t>(left, kSkippedBlockBytes);
      if (!Read(block, &content_)) return false;
      left -= block;
    }
    return true;
  }

  Status ReadRecord(std::uint8_t opcode, std::uint64_t length) {
    if (opcode == kMessage) return ReadMessage(length);
    const bool is_read =
        opcode == kFooter || (opcode >= kSchema && opcode <= kChunk) || opcode == kDataEnd;
    if (!is_read) return Skip(length) ? Status::Ok() : DamagedRecord("it cannot be read");
    if (length > (opcode == kChunk ? kMaxChunkBytes : kMaxRecordBytes)) {
      return DamagedRecord("it is longer than such records are");
    }
    if (opcode == kFooter) return ReadFooter(length);
    if (!Read(length, &content_)) return DamagedRecord("it cannot be read");
    if (opcode == kChunk) return ReadChunk();
    if (opcode == kDataEnd) return ReadDataEnd();
    return ReadDefinition(opcode, content_);
  }

  // Of a message outside of chunks, other topics' data pass by.
  Status ReadMessage(std::uint64_t length) {
    std::string start;
    if (length < kMessageStartBytes || !Read(kMessageStartBytes, &start)) {
      return DamagedRecord("it is too short for a message");
    }
    const std::uint64_t left = length - kMessageStartBytes;
    const Channel* channel = nullptr;
    PLUMBLINE_RETURN_IF_ERROR(FindChannel(start, &channel));
    if (channel->is_wanted && left > kMaxRecordBytes) {
      return DamagedRecord("it is longer than such records are");
    }
    if (!(channel->is_wanted ? Read(left, &content_) : Skip(left))) {
      return DamagedRecord("it cannot be read");
    }
    return channel->is_wanted ? Take(*channel, start, content_) : Status::Ok();
  }

  Status FindChannel(std::string_view message, const Channel** channel) const {
    const auto id = ByteReader(message).Number<std::uint16_t>();
    const auto found = channels_.find(id);
    if (found == channels_.end()) {
      return DamagedRecord("a message of channel " + std::to_string(id) +
                           ", which has not been defined");
    }
    *channel = &found->second;
    return Status::Ok();
  }

  Status Take(const Channel& channel, std::string_view start, std::string_view data) const {
    ByteReader reader(start);
    reader.Number<std::uint16_t>();
    reader.Number<std::uint32_t>();
    return take_(channel.topic, 1e-9 * static_cast<double>(reader.Number<std::uint64_t>()), data);
  }

  Status ReadDefinition(std::uint8_t opcode, std::string_view content) {
    ByteReader reader(content);
    const auto id = reader.Number<std::uint16_t>();
    if (opcode == kSchema) {
      const std::string_view name = reader.Text();
      if (!reader.ok()) return DamagedRecord("a schema that ends before its name");
      if (id != 0) types_.emplace(id, name);
      return Status::Ok();
    }
    const auto schema = reader.Number<std::uint16_t>();
    const std::string_view topic = reader.Text(), encoding = reader.Text();
    if (!reader.ok()) return DamagedRecord("a channel that ends before its encoding");
    const auto type = types_.find(schema);
    if (schema != 0 && type == types_.end()) {
      return DamagedRecord("a channel of schema " + std::to_string(schema) +
                           ", which has not been defined");
    }
    Channel channel{{std::string(topic), schema == 0 ? "" : type->second, std::string(encoding)}};
    channel.is_wanted = is_wanted_(channel.topic);
    // A channel may be defined several times, always alike.
    const auto [known, is_new] = channels_.emplace(id, channel);
    if (!is_new && (known->second.topic < channel.topic || channel.topic < known->second.topic)) {
      return DamagedRecord("channel " + std::to_string(id) + " was another one before");
    }
    return Status::Ok();
  }

  // The chunk is content_.
  Status ReadChunk() {
    ByteReader reader(content_);
    reader.Bytes(2 * sizeof(std::uint64_t));  // its first and last time
    const auto size = reader.Number<std::uint64_t>();
    const auto crc = reader.Number<std::uint32_t>();
    const std::string_view compression = reader.Text();
    std::string_view records = reader.Bytes(reader.Number<std::uint64_t>());
    if (!reader.ok()) return DamagedRecord("a chunk whose records are longer than itself");
    if (size > kMaxChunkBytes) {
      return DamagedRecord("a chunk of " + std::to_string(size) + " bytes; 1 GiB is the limit");
    }
    if (!compression.empty()) {
      if (compression != "lz4" && compression != "zstd") {
        return DamagedRecord("its compression is neither lz4 nor zstd");
      }
      const FrameFormat format = compression == "lz4" ? FrameFormat::kLz4 : FrameFormat::kZstd;
      const Status status = ExpandFrames(format, records, size, &expanded_);
      if (!status.ok()) return DamagedRecord(status.message());
      records = expanded_;
    }
    if (records.size() != size) {
      return DamagedRecord("a chunk of " + std::to_string(records.size()) + " bytes that says " +
                           "to have " + std::to_string(size));
    }
    if (crc != 0 && Crc(records) != crc) return DamagedRecord("a chunk with a wrong checksum");
    return ReadRecordsOfChunk(records);
  }

  Status ReadRecordsOfChunk(std::string_view records) {
    chunk_size_ = records.size();
    chunk_ = ByteReader(records);
    while (!chunk_.rest().empty()) {
      ByteReader reader = chunk_;
      const auto opcode = reader.Number<std::uint8_t>();
      const std::string_view content = reader.Bytes(reader.Number<std::uint64_t>());
      if (!reader.ok()) return DamagedRecord("it is longer than the chunk");
      PLUMBLINE_RETURN_IF_ERROR(ReadRecordOfChunk(opcode, content));
      chunk_ = reader;
    }
    chunk_size_ = 0;
    return Status::Ok();
  }

  Status ReadRecordOfChunk(std::uint8_t opcode, std::string_view content) {
    if (opcode == kSchema || opcode == kChannel) return ReadDefinition(opcode, content);
    if (opcode != kMessage) return Status::Ok();
    if (content.size() < kMessageStartBytes) return DamagedRecord("it is too short for a message");
    const Channel* channel = nullptr;
    PLUMBLINE_RETURN_IF_ERROR(FindChannel(content, &channel));
    if (!channel->is_wanted) return Status::Ok();
    return Take(*channel, content, content.substr(kMessageStartBytes));
  }

  // Its checksum is that of all before it. That of the footer counts from behind it.
  Status ReadDataEnd() {
    const auto crc = ByteReader(content_).Number<std::uint32_t>();
    if (crc != 0 && crc != data_crc_) {
      return DamagedRecord("the file does not have the checksum that stands there");
    }
    crc_ = 0;
    has_data_end_ = true;
    return Status::Ok();
  }

  // And the end of the file.
  Status ReadFooter(std::uint64_t length) {
    constexpr std::uint64_t kPositionsBytes = 2 * sizeof(std::uint64_t);
    std::string positions, crc, magic;
    if (length != kPositionsBytes + sizeof(std::uint32_t) || !Read(kPositionsBytes, &positions)) {
      return DamagedRecord("it is no footer");
    }
    const std::uint32_t summary_crc = crc_;
    if (!Read(sizeof(std::uint32_t), &crc)) return DamagedRecord("it cannot be read");
    const auto stated = ByteReader(crc).Number<std::uint32_t>();
    if (has_data_end_ && stated != 0 && stated != summary_crc) {
      return DamagedRecord("the summary does not have the checksum that stands there");
    }
    if (size_ - at_ != kMcapMagic.size() || !Read(kMcapMagic.size(), &magic) ||
        magic != kMcapMagic) {
      return DamagedRecord("the file does not end after it as such files do");
    }
    at_end_ = true;
    return Status::Ok();
  }

  const std::string& path_;
  std::istream* const file_;
  const std::uint64_t size_;
  const BagContainer::IsWanted& is_wanted_;
  const BagContainer::TakeMessage& take_;

  std::uint64_t at_ = 0, record_at_ = 0;
  bool at_end_ = false, has_data_end_ = false;
  std::uint32_t crc_ = 0, data_crc_ = 0;  // of what was read; before the present record
  std::map<std::uint16_t, std::string> types_;
  std::map<std::uint16_t, Channel> channels_;
  std::string content_, expanded_;
  // The chunk that is being read, from its present record on; 0: none.
  std::size_t chunk_size_ = 0;
  ByteReader chunk_{{}};
};

}  // namespace

std::unique_ptr<BagContainer> MakeMcapBag(std::string path, std::optional<std::string> expanded) {
  return std::make_unique<StreamBag>(
      std::move(path), std::move(expanded),
      [](const std::string& name, std::istream* file, std::uint64_t size,
         const BagContainer::IsWanted& is_wanted, const BagContainer::TakeMessage& take,
         std::string* /*omission*/) { return McapWalk(name, file, size, is_wanted, take).Run(); });
}

}  // namespace plumbline
