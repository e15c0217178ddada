#ifndef PLUMBLINE_TEST_APPS_BAGS_ROS1_WRITER_H_
#define PLUMBLINE_TEST_APPS_BAGS_ROS1_WRITER_H_

#include <bzlib.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/test/apps/bags/bag_testing.h"

namespace plumbline {

/// Little-endian, as tests run on such machines only.
template <typename T>
std::string Ros1Number(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}
inline std::string Ros1Text(const std::string& text) {
  return Ros1Number(static_cast<std::uint32_t>(text.size())) + text;
}
inline std::string Ros1Fields(const std::vector<std::string>& fields) {
  std::string bytes;
  for (const std::string& field : fields) bytes += Ros1Text(field);
  return bytes;
}
inline std::string Ros1Op(char op) { return std::string("op=") + op; }
inline std::string Ros1Record(const std::vector<std::string>& fields, const std::string& data) {
  return Ros1Text(Ros1Fields(fields)) + Ros1Text(data);
}

inline std::string Bzip2Bytes(std::string bytes) {
  auto size = static_cast<unsigned>(bytes.size() + bytes.size() / 100 + 600);  // libbz2's bound
  std::string stream(size, '\0');
  BZ2_bzBuffToBuffCompress(stream.data(), &size, bytes.data(), static_cast<unsigned>(bytes.size()),
                           1, 0, 0);
  stream.resize(size);
  return stream;
}

/// A frame of LZ4 as ROS writes it: independent blocks, and a checksum of the content.
inline std::string Ros1Lz4Bytes(const std::string& bytes) {
  LZ4F_preferences_t preferences = {};
  preferences.frameInfo.blockSizeID = LZ4F_max4MB;
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string frame(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  frame.resize(
      LZ4F_compressFrame(frame.data(), frame.size(), bytes.data(), bytes.size(), &preferences));
  return frame;
}

const std::string kRos1Start = "#ROSBAG V2.0\n";

/// The first record, filled up to 4096 bytes; index_at = 0: there is no index.
inline std::string Ros1BagHeader(std::uint64_t index_at, std::uint32_t num_connections,
                                 std::uint32_t num_chunks) {
  const std::string header = Ros1Fields({Ros1Op(3), "index_pos=" + Ros1Number(index_at),
                                         "conn_count=" + Ros1Number(num_connections),
                                         "chunk_count=" + Ros1Number(num_chunks)});
  return Ros1Text(header) + Ros1Text(std::string(4096 - 8 - header.size(), ' '));
}
inline std::string Ros1Connection(std::uint32_t id, const std::string& topic,
                                  const std::string& type) {
  return Ros1Record(
      {Ros1Op(7), "conn=" + Ros1Number(id), "topic=" + topic},
      Ros1Fields({"topic=" + topic, "type=" + type, "md5sum=90c7ef2dc6895d81024acba2ac42f369",
                  "message_definition=float32[] as_if = here"}));
}
/// Seconds and nanoseconds.
inline std::string Ros1Time(std::int64_t time_ns) {
  return Ros1Number(static_cast<std::uint32_t>(time_ns / 1000000000)) +
         Ros1Number(static_cast<std::uint32_t>(time_ns % 1000000000));
}
inline std::string Ros1Message(std::uint32_t connection, std::int64_t time_ns,
                               const std::string& bytes) {
  return Ros1Record({Ros1Op(2), "conn=" + Ros1Number(connection), "time=" + Ros1Time(time_ns)},
                    bytes);
}
inline std::string Ros1Chunk(const std::string& records, const std::string& compression,
                             std::uint32_t stated_size) {
  return Ros1Record({Ros1Op(5), "compression=" + compression, "size=" + Ros1Number(stated_size)},
                    compression == "bz2"   ? Bzip2Bytes(records)
                    : compression == "lz4" ? Ros1Lz4Bytes(records)
                                           : records);
}

struct Ros1Layout {
  std::string compression = "none";  // of the chunks: or "bz2", "lz4"
  std::size_t messages_per_chunk = 3;
  bool is_indexed = true;  // false: cut off before the index
};

/// Writes a bag as rosbag does: a connection is defined where its first message is.
class Ros1Writer {
 public:
  explicit Ros1Writer(const Ros1Layout& layout) : layout_(layout) {}

  void Write(const TestMessage& message) {
    const auto [connection, is_new] =
        ids_.emplace(message.topic, static_cast<std::uint32_t>(ids_.size()));
    if (is_new) {
      const std::string record = Ros1Connection(connection->second, message.topic, message.type);
      connections_ += record;
      records_ += record;
    }
    index_[connection->second] +=
        Ros1Time(message.time_ns) + Ros1Number(static_cast<std::uint32_t>(records_.size()));
    ++counts_[connection->second];
    times_.insert(message.time_ns);
    records_ += Ros1Message(connection->second, message.time_ns, message.bytes);
    if (++num_messages_ % layout_.messages_per_chunk == 0) EndChunk();
  }

  std::string Finish() {
    EndChunk();
    const std::size_t chunks_at = kRos1Start.size() + 4096;
    const std::uint64_t index_at = layout_.is_indexed ? chunks_at + chunks_.size() : 0;
    const std::string start =
        kRos1Start + Ros1BagHeader(index_at, static_cast<std::uint32_t>(ids_.size()), num_chunks_);
    return start + chunks_ + (layout_.is_indexed ? connections_ + chunk_infos_ : "");
  }

 private:
  void EndChunk() {
    if (records_.empty()) return;
    std::string counts;
    for (const auto& [id, count] : counts_) counts += Ros1Number(id) + Ros1Number(count);
    chunk_infos_ += Ros1Record(
        {Ros1Op(6), "ver=" + Ros1Number(std::uint32_t{1}),
         "chunk_pos=" + Ros1Number(std::uint64_t{kRos1Start.size() + 4096 + chunks_.size()}),
         "start_time=" + Ros1Time(*times_.begin()), "end_time=" + Ros1Time(*times_.rbegin()),
         "count=" + Ros1Number(static_cast<std::uint32_t>(counts_.size()))},
        counts);
    chunks_ +=
        Ros1Chunk(records_, layout_.compression, static_cast<std::uint32_t>(records_.size()));
    for (const auto& [id, entries] : index_) {
      chunks_ += Ros1Record({Ros1Op(4), "ver=" + Ros1Number(std::uint32_t{1}),
                             "conn=" + Ros1Number(id), "count=" + Ros1Number(counts_[id])},
                            entries);
    }
    ++num_chunks_;
    records_.clear();
    index_.clear();
    counts_.clear();
    times_.clear();
  }

  const Ros1Layout layout_;
  std::map<std::string, std::uint32_t> ids_;  // of connections, by topic
  std::string chunks_, connections_, chunk_infos_;
  std::size_t num_messages_ = 0;
  std::uint32_t num_chunks_ = 0;
  // Of the present chunk; by connection: entries of its index, and their number.
  std::string records_;
  std::map<std::uint32_t, std::string> index_;
  std::map<std::uint32_t, std::uint32_t> counts_;
  std::set<std::int64_t> times_;
};

inline std::string Ros1Bytes(const TestBag& bag, const Ros1Layout& layout = Ros1Layout()) {
  Ros1Writer writer(layout);
  for (const TestMessage& message : bag) writer.Write(message);
  return writer.Finish();
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_BAGS_ROS1_WRITER_H_
