#include "plumbline/apps/bags/mcap_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/apps/bags/bag_reader.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/mcap_writer.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class McapBagTest : public testing::Test {
 protected:
  Status Read(const std::string& content) {
    WriteFile(path_, content);
    return ReadBag(path_, BagReadOptions(), &recording_);
  }
  void ExpectDamaged(const std::string& content, const std::string& problem) {
    const Status status = Read(content);
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(),
                AllOf(HasSubstr(path_ + ": cannot be read as an MCAP file: "), HasSubstr(problem)));
  }
  static std::string At(const std::string& before) {
    return "the record at byte " + std::to_string(before.size()) + ": ";
  }
  // A file of these records.
  static std::string File(const std::string& records) {
    const std::string data = McapStart() + records;
    return data + McapEnd(data, "");
  }

  const std::string path_ = TempFolder() + "a.mcap";
  RosRecording recording_;
};

const std::vector<McapLayout> kLayouts = {
    {0, "", true, true}, {3, "", true, true}, {3, "lz4", true, true}, {3, "zstd", true, true}};

TEST_F(McapBagTest, EveryCutIsDataLossThatNamesTheFile) {
  for (const McapLayout& layout : kLayouts) {
    const std::string whole = McapBytes(SmallBag(), layout);
    std::string content;
    ASSERT_TRUE(ReadAll(MakeMcapBag(path_, whole).get(), &content).ok());
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Status status = ReadAll(MakeMcapBag(path_, whole.substr(0, size)).get(), &content);
      ASSERT_EQ(status.code(), StatusCode::kDataLoss) << size;
      ASSERT_THAT(status.message(), HasSubstr(path_ + ": cannot be read as an MCAP file: "));
    }
  }
}

// The checksums find it, or it was of no consequence.
TEST_F(McapBagTest, NoFlippedByteChangesWhatIsRead) {
  for (const McapLayout& layout : kLayouts) {
    const std::string whole = McapBytes(SmallBag(), layout);
    std::string expected;
    ASSERT_TRUE(ReadAll(MakeMcapBag(path_, whole).get(), &expected).ok());
    std::size_t num_found = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      std::string flipped = whole, content;
      flipped[i] = static_cast<char>(flipped[i] ^ (i % 2 == 0 ? 0xff : 0x01));
      const Status status = ReadAll(MakeMcapBag(path_, flipped).get(), &content);
      if (status.ok()) {
        EXPECT_EQ(content, expected) << "byte " << i;
      } else {
        EXPECT_THAT(status.message(), HasSubstr(path_)) << "byte " << i;
        ++num_found;
      }
    }
    EXPECT_GT(num_found, whole.size() - 20);
  }
}

TEST_F(McapBagTest, FlippedBytesWithoutChecksumsAreReadOrNamed) {
  for (McapLayout layout : kLayouts) {
    layout.has_checksums = false;
    const std::string whole = McapBytes(SmallBag(), layout);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (const int change : {0x01, 0x80, 0xff}) {
        std::string flipped = whole, content;
        flipped[i] = static_cast<char>(flipped[i] ^ change);
        const Status status = ReadAll(MakeMcapBag(path_, flipped).get(), &content);
        EXPECT_EQ(status.ok(), status.message().find(path_) == std::string::npos) << "byte " << i;
      }
    }
  }
}

TEST_F(McapBagTest, RecordsThatAreLongerThanTheFileAreNamed) {
  const std::string start = McapStart();
  for (const std::uint64_t length :
       {std::uint64_t{100}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    for (const char opcode : {'\3', '\5', '\6', '\x7f'}) {
      ExpectDamaged(start + opcode + LittleEndian(length) + "content",
                    At(start) + "it is longer than the file");
    }
  }
}

TEST_F(McapBagTest, LengthsInsideOfRecordsAreChecked) {
  const std::string start = McapStart();
  ExpectDamaged(File(McapRecord(3, LittleEndian(std::uint16_t{1}) + LittleEndian(0xffffffffu))),
                At(start) + "a schema that ends before its name");
  ExpectDamaged(File(McapRecord(4, LittleEndian(std::uint32_t{1}) + LittleEndian(0xffffffffu))),
                At(start) + "a channel that ends before its encoding");
  ExpectDamaged(File(McapRecord(5, "short")), At(start) + "it is too short for a message");
  ExpectDamaged(File(McapRecord(6, "short")),
                At(start) + "a chunk whose records are longer than itself");
  const std::string in_chunk = McapRecord(3, LittleEndian(std::uint16_t{1}) + McapText("a"));
  ExpectDamaged(File(McapChunk(in_chunk + std::string(1, '\5') + LittleEndian(~std::uint64_t{0}),
                               "", in_chunk.size() + 9, 0)),
                At(start) + "in the chunk there, " + At(in_chunk) + "it is longer than the chunk");
}

TEST_F(McapBagTest, ChunksHaveTheSizeThatTheySay) {
  const std::string start = McapStart(), records(1000, '\0');
  for (const std::string compression : {"", "lz4", "zstd"}) {
    for (const std::uint64_t size : {std::uint64_t{999}, std::uint64_t{1001}}) {
      ExpectDamaged(File(McapChunk(records, compression, size, 0)), At(start));
    }
    ExpectDamaged(File(McapChunk(records, compression, std::uint64_t{1} << 50, 0)),
                  At(start) + "a chunk of 1125899906842624 bytes; 1 GiB is the limit");
  }
  ExpectDamaged(File(McapChunk(records, "lz4", 999, 0)), "expand to more than 999 bytes");
}

TEST_F(McapBagTest, WrongChecksumsAreNamed) {
  const std::string records = McapSchema(1, "a");
  const std::string start = McapStart();
  ExpectDamaged(File(McapChunk(records, "zstd", records.size(), 1)),
                At(start) + "a chunk with a wrong checksum");
  ExpectDamaged(start + McapEnd(start + "x", ""),
                At(start) + "the file does not have the checksum that stands there");
  std::string whole = McapBytes(SmallBag());
  whole[whole.size() - 9] = static_cast<char>(whole[whole.size() - 9] ^ 1);
  ExpectDamaged(whole, "the summary does not have the checksum that stands there");
}

TEST_F(McapBagTest, OtherCompressionsAreNamed) {
  ExpectDamaged(File(McapChunk("records", "bz2", 7, 0)),
                At(McapStart()) + "its compression is neither lz4 nor zstd");
}

TEST_F(McapBagTest, DefinitionsComeFirstAndStayAsTheyAre) {
  const std::string start = McapStart();
  ExpectDamaged(File(McapMessage(3, 0, "")), At(start) + "a message of channel 3, which has not");
  ExpectDamaged(File(McapChannel(1, 2, "/a", "cdr")), At(start) + "a channel of schema 2, which");
  const std::string channel = McapSchema(2, "a/msg/B") + McapChannel(1, 2, "/a", "cdr");
  EXPECT_EQ(Read(File(channel + channel)).code(), StatusCode::kInvalidArgument);  // no scans
  ExpectDamaged(File(channel + McapChannel(1, 2, "/b", "cdr")),
                At(start + channel) + "channel 1 was another one before");
}

TEST_F(McapBagTest, FilesBeginAndEndAsTheyShould) {
  ExpectDamaged("\x89MCAP1\r\n" + McapBytes(SmallBag()).substr(8),
                "it does not begin as files of version 0 do");
  ExpectDamaged(kTestMcapMagic + McapSchema(1, "a"), At(kTestMcapMagic) + "it is no header");
  ExpectDamaged(McapBytes(SmallBag()) + "more", "the file does not end after it as such files do");
}

TEST_F(McapBagTest, RecordsOfOtherKindsAreSkipped) {
  TestBag bag = SmallBag();
  const std::string whole = McapBytes(bag, {0, "", false, false});
  const std::string extension = McapRecord(0x80, std::string(1000000, 'x'));
  std::string extended = whole;
  extended.insert(McapStart().size(), extension);
  ASSERT_TRUE(Read(extended).ok());
  EXPECT_EQ(recording_.scans.size(), 2u);
}

TEST_F(McapBagTest, ATopicMayHaveSeveralChannels) {
  const TestBag bag = SmallBag();
  std::string records;
  for (std::size_t i = 0; i < bag.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    records += McapSchema(id, bag[i].type) + McapChannel(id, id, bag[i].topic, bag[i].encoding) +
               McapMessage(id, bag[i].time_ns, bag[i].bytes);
  }
  ASSERT_TRUE(Read(File(records)).ok());
  EXPECT_EQ(recording_.scans.size(), 2u);
  EXPECT_EQ(recording_.odometry.size(), 2u);
}

}  // namespace
}  // namespace plumbline
