#ifndef PLUMBLINE_TEST_APPS_BAGS_MCAP_WRITER_H_
#define PLUMBLINE_TEST_APPS_BAGS_MCAP_WRITER_H_

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>

#include "plumbline/test/apps/bags/bag_testing.h"

namespace plumbline {

template <typename T>
std::string LittleEndian(T value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}
inline std::string McapText(const std::string& text) {
  return LittleEndian(static_cast<std::uint32_t>(text.size())) + text;
}
inline std::string McapRecord(int opcode, const std::string& content) {
  return static_cast<char>(opcode) + LittleEndian<std::uint64_t>(content.size()) + content;
}
inline std::uint32_t CrcOf(const std::string& bytes) {
  return static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const unsigned char*>(bytes.data()),
                                          static_cast<unsigned>(bytes.size())));
}

struct McapLayout {
  std::size_t messages_per_chunk = 3;  // 0: no chunks
  std::string compression;             // of the chunks: "", "lz4" or "zstd"
  bool has_summary = true;
  bool has_checksums = true;
};

inline std::string McapChunk(const std::string& records, const std::string& compression,
                             std::uint64_t stated_size, std::uint32_t crc) {
  const std::string stored = compression == "lz4"    ? Lz4Bytes(records)
                             : compression == "zstd" ? ZstdBytes(records)
                                                     : records;
  return McapRecord(6, LittleEndian(std::uint64_t{0}) + LittleEndian(std::uint64_t{0}) +
                           LittleEndian(stated_size) + LittleEndian(crc) + McapText(compression) +
                           LittleEndian<std::uint64_t>(stored.size()) + stored);
}
inline std::string McapSchema(int id, const std::string& type) {
  return McapRecord(3, LittleEndian(static_cast<std::uint16_t>(id)) + McapText(type) +
                           McapText("ros2msg") + McapText("# as if"));
}
inline std::string McapChannel(int id, int schema, const std::string& topic,
                               const std::string& encoding) {
  return McapRecord(4, LittleEndian(static_cast<std::uint16_t>(id)) +
                           LittleEndian(static_cast<std::uint16_t>(schema)) + McapText(topic) +
                           McapText(encoding) + McapText(""));
}
inline std::string McapMessage(int channel, std::int64_t time_ns, const std::string& bytes) {
  return McapRecord(5, LittleEndian(static_cast<std::uint16_t>(channel)) +
                           LittleEndian(std::uint32_t{0}) +
                           LittleEndian(static_cast<std::uint64_t>(time_ns)) +
                           LittleEndian(static_cast<std::uint64_t>(time_ns)) + bytes);
}

const std::string kTestMcapMagic("\x89MCAP0\r\n", 8);
inline std::string McapStart() {
  return kTestMcapMagic + McapRecord(1, McapText("ros2") + McapText("test"));
}

/// The end of a file behind its data: the end of the data section, a summary, the footer.
inline std::string McapEnd(const std::string& data, const std::string& summary,
                           bool has_checksums = true) {
  const std::string data_end = McapRecord(15, LittleEndian(has_checksums ? CrcOf(data) : 0u));
  const std::uint64_t summary_at = data.size() + data_end.size();
  const std::string footer = static_cast<char>(2) + LittleEndian<std::uint64_t>(20) +
                             LittleEndian<std::uint64_t>(summary.empty() ? 0 : summary_at) +
                             LittleEndian<std::uint64_t>(0);
  return data_end + summary + footer + LittleEndian(has_checksums ? CrcOf(summary + footer) : 0u) +
         kTestMcapMagic;
}

inline std::string McapBytes(const TestBag& bag, const McapLayout& layout = McapLayout()) {
  std::string file = McapStart(), records, definitions;
  std::map<std::string, int> ids;
  std::size_t num_messages = 0;
  const auto flush = [&] {
    if (layout.messages_per_chunk == 0) {
      file += records;
    } else if (!records.empty()) {
      file += McapChunk(records, layout.compression, records.size(),
                        layout.has_checksums ? CrcOf(records) : 0);
      file += McapRecord(7, "an index that nobody reads");
    }
    records.clear();
  };
  for (const TestMessage& message : bag) {
    const auto [id, is_new] = ids.emplace(message.topic, static_cast<int>(ids.size()) + 1);
    if (is_new) {
      const std::string definition =
          McapSchema(id->second, message.type) +
          McapChannel(id->second, id->second, message.topic, message.encoding);
      definitions += definition;
      records += definition;
    }
    records += McapMessage(id->second, message.time_ns, message.bytes);
    if (++num_messages % std::max<std::size_t>(layout.messages_per_chunk, 1) == 0) flush();
  }
  flush();
  file += McapRecord(9, "an attachment");
  return file + McapEnd(file, layout.has_summary ? definitions : "", layout.has_checksums);
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_BAGS_MCAP_WRITER_H_
