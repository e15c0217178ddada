#include "plumbline/apps/bags/open_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "plumbline/apps/bags/bag_reader.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/mcap_writer.h"
#include "plumbline/test/apps/bags/sqlite_writer.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class OpenBagTest : public testing::Test {
 protected:
  void WriteMetadata(const std::string& files, const std::string& more = "") const {
    WriteFile(folder_ + "metadata.yaml",
              "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n"
              "  relative_file_paths:\n" +
                  files + more);
  }
  // The first four messages in one file, the others in a second.
  static TestBag Part(int part) {
    const TestBag bag = SmallBag();
    return part == 0 ? TestBag(bag.begin(), bag.begin() + 4) : TestBag(bag.begin() + 4, bag.end());
  }
  Status Read(const std::string& path) { return ReadBag(path, BagReadOptions(), &recording_); }
  void ExpectWholeBag(const std::string& path) {
    recording_ = RosRecording();
    const Status status = Read(path);
    ASSERT_TRUE(status.ok()) << status.message();
    ASSERT_EQ(recording_.scans.size(), 2u);
    EXPECT_EQ(recording_.scans[0].stamp_s, 1500000000.0);
    EXPECT_EQ(recording_.scans[1].stamp_s, 1500000000.25);
    EXPECT_EQ(recording_.odometry.size(), 2u);
  }
  void ExpectRefused(const std::string& path, const std::string& problem) {
    const Status status = Read(path);
    EXPECT_FALSE(status.ok());
    EXPECT_THAT(status.message(), HasSubstr(problem));
  }

  const std::string folder_ = TempFolder();
  RosRecording recording_;
};

TEST_F(OpenBagTest, TheFilesOfAFolderComeInTheOrderOfItsDescription) {
  WriteSqliteBag(folder_ + "b.db3", Part(0));
  WriteFile(folder_ + "a.mcap", McapBytes(Part(1)));
  WriteMetadata("    - b.db3\n    - a.mcap\n");
  ExpectWholeBag(folder_);
  ExpectWholeBag(folder_.substr(0, folder_.size() - 1));
  ExpectWholeBag(folder_ + "metadata.yaml");
}

TEST_F(OpenBagTest, ADescriptionMayHaveLineEndsOfWindows) {
  WriteSqliteBag(folder_ + "b.db3", SmallBag());
  WriteMetadata("    - b.db3\n");
  std::string windows;
  for (const char c : ReadFile(folder_ + "metadata.yaml"))
    windows += c == '\n' ? "\r\n" : std::string(1, c);
  WriteFile(folder_ + "metadata.yaml", windows);
  ExpectWholeBag(folder_);
}

TEST_F(OpenBagTest, AFileOfASplitRecordingIsReadAlone) {
  WriteSqliteBag(folder_ + "b.db3", Part(0));
  WriteSqliteBag(folder_ + "a.db3", Part(1));
  WriteMetadata("    - b.db3\n    - a.db3\n");
  ASSERT_TRUE(Read(folder_ + "b.db3").ok());
  EXPECT_EQ(recording_.scans.size(), 1u);
}

TEST_F(OpenBagTest, FaultsCountMessagesOverAllFiles) {
  TestBag second = Part(1);
  second.front().bytes.resize(30);
  WriteSqliteBag(folder_ + "a.db3", Part(0));
  WriteSqliteBag(folder_ + "b.db3", second);
  WriteMetadata("    - a.db3\n    - b.db3\n");
  ASSERT_TRUE(Read(folder_).ok());
  EXPECT_THAT(recording_.bad_odometry.examples(),
              testing::ElementsAre(HasSubstr("/odom message 1 (1500000000.250000 s): field '")));
}

TEST_F(OpenBagTest, DamageNamesTheFileOfTheFolder) {
  const std::string mcap = McapBytes(Part(0));
  WriteFile(folder_ + "a.mcap", mcap.substr(0, mcap.size() - 1));
  WriteMetadata("    - a.mcap\n");
  ExpectRefused(folder_, folder_ + "a.mcap: cannot be read as an MCAP file");
}

TEST_F(OpenBagTest, FilesThatAreCompressedAsAWholeAreRead) {
  WriteSqliteBag(folder_ + "whole", SmallBag());
  WriteFile(folder_ + "a.db3.zstd", ZstdBytes(ReadFile(folder_ + "whole")));
  ExpectWholeBag(folder_ + "a.db3.zstd");
  WriteFile(folder_ + "a.mcap.zstd", ZstdBytes(McapBytes(SmallBag())));
  ExpectWholeBag(folder_ + "a.mcap.zstd");
  WriteMetadata("    - a.db3.zstd\n", "  compression_format: zstd\n  compression_mode: FILE\n");
  ExpectWholeBag(folder_);
}

// What rosbag2's resilient preset leaves, compressed.
TEST_F(OpenBagTest, ACompressedDatabaseMayAskForALogToWriteAhead) {
  std::vector<std::string> statements = BagStatements(SmallBag());
  statements.insert(statements.begin(), "PRAGMA journal_mode = WAL");
  WriteDatabase(folder_ + "whole", statements);
  WriteFile(folder_ + "a.db3.zstd", ZstdBytes(ReadFile(folder_ + "whole")));
  ExpectWholeBag(folder_ + "a.db3.zstd");
}

TEST_F(OpenBagTest, MessagesThatAreCompressedOneByOneAreReadInAFolder) {
  TestBag bag = SmallBag();
  for (TestMessage& message : bag) message.bytes = ZstdBytes(message.bytes);
  WriteSqliteBag(folder_ + "a.db3", bag);
  WriteMetadata("    - a.db3\n", "  compression_format: zstd\n  compression_mode: MESSAGE\n");
  ExpectWholeBag(folder_);
}

TEST_F(OpenBagTest, CompressedFilesThatAreDamagedAreNamed) {
  const std::string path = folder_ + "a.db3.zstd", frame = ZstdBytes(McapBytes(SmallBag()));
  for (std::size_t size = 4; size < frame.size(); size += 100) {
    WriteFile(path, frame.substr(0, size));
    const Status status = Read(path);
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(),
                AllOf(HasSubstr(path + ": the compressed data are"), HasSubstr("zstd -d")));
  }
  WriteFile(path, ZstdBytes("FLASER 1 2 0 0 0 0 0 0 1 h 1\n"));
  ExpectRefused(path, path + ": what zstd has compressed there is neither a bag of ROS 1, nor");
}

TEST_F(OpenBagTest, EarlyDescriptionsHaveTheFolderInTheirPaths) {
  WriteSqliteBag(folder_ + "a.db3", SmallBag());
  WriteMetadata("    - my_bag/a.db3\n");
  ExpectWholeBag(folder_);
}

TEST_F(OpenBagTest, AFolderWithoutABagSaysWhatIsThere) {
  ExpectRefused(folder_, folder_ + ": a folder, but no bag of ROS 2: there is no metadata.yaml");
  ExpectRefused(folder_, "but nothing");
  WriteSqliteBag(folder_ + "a.db3", SmallBag());
  WriteFile(folder_ + "b\x1b.txt", "");
  ExpectRefused(folder_, "but a.db3, b\\x1b.txt");
}

TEST_F(OpenBagTest, DescriptionsThatAreNoneAreNamed) {
  const std::string path = folder_ + "metadata.yaml";
  WriteFile(path, "rosbag2_bagfile_information: [");
  ExpectRefused(folder_, path + ": cannot be read as YAML: ");
  for (const std::string text :
       {"", "just text", "- a\n- list\n", "rosbag2_bagfile_information: 3", "other: 3\n"}) {
    WriteFile(path, text);
    ExpectRefused(folder_, path + ": field 'rosbag2_bagfile_information': is missing");
  }
  for (const std::string files : {"", "    []\n", "    a.db3\n", "    a: b.db3\n"}) {
    WriteMetadata(files);
    ExpectRefused(folder_, path + ": field 'relative_file_paths': it lists no files");
  }
  WriteMetadata("    - [a.db3]\n");
  ExpectRefused(folder_, path + ": field 'relative_file_paths': an entry is no name of a file");
  WriteMetadata("    - a.db3\n", "  compression_format: brotli\n");
  ExpectRefused(folder_, path + ": field 'compression_format': 'brotli' is none that can be read");
}

TEST_F(OpenBagTest, NestingWithoutEndIsNoCrash) {
  WriteFile(folder_ + "metadata.yaml", "rosbag2_bagfile_information: " + std::string(100000, '['));
  ExpectRefused(folder_, folder_ + "metadata.yaml: cannot be read as YAML: ");
}

TEST_F(OpenBagTest, ADescriptionOfEndlessLengthIsRefused) {
  WriteMetadata("    - a.db3\n", "#" + std::string(3000000, ' '));
  ExpectRefused(folder_, folder_ + "metadata.yaml: too long for a description of a bag");
}

TEST_F(OpenBagTest, FilesThatAreNotThereOrNoBagsAreNamed) {
  WriteMetadata("    - none.db3\n");
  EXPECT_EQ(Read(folder_).code(), StatusCode::kNotFound);
  ExpectRefused(folder_, folder_ + "none.db3");
  WriteFile(folder_ + "text.db3", "text");
  WriteMetadata("    - text.db3\n");
  ExpectRefused(folder_, folder_ + "text.db3: neither a bag of ROS 1, nor");
  // No loop: a bag is not part of a bag.
  WriteMetadata("    - metadata.yaml\n");
  ExpectRefused(folder_, folder_ + "metadata.yaml: neither a bag of ROS 1, nor");
  WriteMetadata("    - .\n");
  ExpectRefused(folder_, "neither a bag of ROS 1, nor");
}

TEST_F(OpenBagTest, PipesAreRefused) {
  WriteMetadata("    - pipe\n");
  ASSERT_EQ(mkfifo((folder_ + "pipe").c_str(), 0600), 0);
  ExpectRefused(folder_, "'" + folder_ + "pipe': a pipe or a device");
  ExpectRefused(folder_ + "pipe", "'" + folder_ + "pipe': a pipe or a device");
  std::filesystem::remove(folder_ + "metadata.yaml");
  ASSERT_EQ(mkfifo((folder_ + "metadata.yaml").c_str(), 0600), 0);
  ExpectRefused(folder_, "'" + folder_ + "metadata.yaml': a pipe or a device");
}

TEST_F(OpenBagTest, TheFilesOfALogAreThoseOfItsFolder) {
  WriteMetadata("    - a.db3\n    - b.db3\n");
  std::vector<std::string> files;
  for (const std::string& path : {folder_, folder_ + "metadata.yaml"}) {
    ASSERT_TRUE(FilesOfLog(path, &files).ok());
    EXPECT_THAT(files,
                ElementsAre(folder_ + "metadata.yaml", folder_ + "a.db3", folder_ + "b.db3"));
  }
  ASSERT_TRUE(FilesOfLog(folder_ + "a.clf", &files).ok());
  EXPECT_THAT(files, ElementsAre(folder_ + "a.clf"));
  EXPECT_FALSE(FilesOfLog(TempFolder(), &files).ok());
}

TEST_F(OpenBagTest, ABagIsToldByItsContent) {
  const auto is_bag = [this](const std::string& content) {
    WriteFile(folder_ + "a.txt", content);
    return IsBag(folder_ + "a.txt");
  };
  EXPECT_TRUE(is_bag("#ROSBAG V2.0\n"));
  EXPECT_TRUE(is_bag(std::string("SQLite format 3\0", 16)));
  EXPECT_TRUE(is_bag("\x89MCAP0\r\n"));
  EXPECT_TRUE(is_bag("# recorded today\nrosbag2_bagfile_information:\n"));
  EXPECT_TRUE(is_bag(ZstdBytes("anything")));
  EXPECT_FALSE(is_bag(""));
  EXPECT_FALSE(is_bag("FLASER 1 2 0 0 0 0 0 0 1 h 1\n"));
  EXPECT_TRUE(IsBag(folder_));
  EXPECT_FALSE(IsBag(folder_ + "none"));
}

}  // namespace
}  // namespace plumbline
