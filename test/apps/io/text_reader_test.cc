#include "plumbline/apps/io/text_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> Lines(TextReader* reader) {
  std::vector<std::string> lines;
  std::string_view line;
  while (reader->NextLine(&line)) lines.emplace_back(line);
  return lines;
}

/// Lines of random digits, which compress badly: cutting the file cuts many of them.
std::vector<std::string> RandomLines(int count) {
  std::mt19937 random(7);
  std::vector<std::string> lines;
  for (int i = 0; i < count; ++i) lines.push_back(std::to_string(random()));
  return lines;
}

std::string Gzip(const std::string& path, const std::vector<std::string>& lines) {
  gzFile file = gzopen(path.c_str(), "wb");
  for (const std::string& line : lines) {
    gzwrite(file, line.data(), static_cast<unsigned>(line.size()));
    gzputc(file, '\n');
  }
  gzclose(file);
  return ReadFile(path);
}

TEST(TextReaderTest, SplitsLinesAndCountsThem) {
  const std::string path = TempFolder() + "a.txt";
  WriteFile(path, "first\r\n\nthird\nlast without line end");
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  EXPECT_THAT(Lines(&reader), ElementsAre("first", "", "third", "last without line end"));
  EXPECT_EQ(reader.line_number(), 4u);
  EXPECT_TRUE(reader.status().ok());
  EXPECT_FALSE(reader.truncated());
}

TEST(TextReaderTest, EmptyFileHasNoLines) {
  const std::string path = TempFolder() + "a.txt";
  WriteFile(path, "");
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  EXPECT_THAT(Lines(&reader), ElementsAre());
  EXPECT_TRUE(reader.status().ok());
}

TEST(TextReaderTest, LinesLongerThanTheBufferSurvive) {
  const std::string path = TempFolder() + "a.txt";
  const std::string longest(1000003, 'x');
  WriteFile(path, "a\n" + longest + "\nb\n");
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  EXPECT_THAT(Lines(&reader), ElementsAre("a", longest, "b"));
}

TEST(TextReaderTest, RefusesGzipThatExpandsToTooMuch) {
  const std::string path = TempFolder() + "a.gz";
  const std::vector<std::string> lines(70, std::string(1000000, '\n'));
  Gzip(path, lines);
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  std::string_view line;
  while (reader.NextLine(&line)) {
  }
  EXPECT_EQ(reader.status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(reader.status().message(),
            path + ": the compressed file expands to more than 200 times its size");
}

TEST(TextReaderTest, ReadsAnyAmountThatIsNotCompressed) {
  const std::string path = TempFolder() + "a.txt";
  WriteFile(path, std::string(70000000, '\n'));  // NOLINT(bugprone-string-constructor)
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  std::string_view line;
  while (reader.NextLine(&line)) {
  }
  EXPECT_TRUE(reader.status().ok());
  EXPECT_EQ(reader.line_number(), 70000000u);
}

TEST(TextReaderTest, ReadsGzip) {
  const std::string path = TempFolder() + "a.gz";
  const std::vector<std::string> lines = RandomLines(100000);
  Gzip(path, lines);
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  EXPECT_EQ(Lines(&reader), lines);
  EXPECT_TRUE(reader.status().ok());
  EXPECT_FALSE(reader.truncated());
}

TEST(TextReaderTest, TruncatedGzipYieldsItsWholeLines) {
  const std::string path = TempFolder() + "a.gz";
  const std::vector<std::string> lines = RandomLines(100000);
  const std::string content = Gzip(path, lines);
  WriteFile(path, content.substr(0, content.size() / 2));
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  const std::vector<std::string> read = Lines(&reader);
  EXPECT_GT(read.size(), 40000u);
  ASSERT_LT(read.size(), 60000u);
  EXPECT_EQ(read, std::vector<std::string>(lines.begin(), lines.begin() + read.size()));
  EXPECT_TRUE(reader.status().ok());
  EXPECT_TRUE(reader.truncated());
  EXPECT_EQ(reader.CheckWhole().code(), StatusCode::kDataLoss);
  EXPECT_THAT(reader.CheckWhole().message(),
              HasSubstr(path + ": the compressed file is truncated after line " +
                        std::to_string(read.size())));
}

TEST(TextReaderTest, CorruptGzipIsDataLoss) {
  const std::string path = TempFolder() + "a.gz";
  std::string content = Gzip(path, RandomLines(1000));
  content[content.size() - 6] ^= 1;  // In the checksum.
  WriteFile(path, content);
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  Lines(&reader);
  EXPECT_EQ(reader.status().code(), StatusCode::kDataLoss);
  EXPECT_THAT(reader.status().message(), HasSubstr(path + ": the compressed file is damaged"));
}

TEST(TextReaderTest, SkipsAByteOrderMarkAtTheStartOnly) {
  const std::string path = TempFolder() + "a.txt";
  WriteFile(path,
            "\xEF\xBB\xBF"
            "first\n\xEF\xBB\xBFsecond");
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  EXPECT_THAT(Lines(&reader), ElementsAre("first", "\xEF\xBB\xBFsecond"));
}

TEST(TextReaderTest, RefusesALineOfMoreThan16MiB) {
  const std::string path = TempFolder() + "a.gz";
  const std::string long_enough(std::size_t{1} << 24, 'x');
  Gzip(path, {"first", long_enough, long_enough + long_enough, "last"});
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  EXPECT_EQ(Lines(&reader).size(), 2u);
  EXPECT_EQ(reader.status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(reader.status().message(), path + ":3: the line is longer than 16 MiB");
  EXPECT_EQ(reader.CheckWhole().message(), reader.status().message());
}

TEST(TextReaderTest, OpensNoPipe) {
  const std::string path = TempFolder() + "pipe";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  TextReader reader;
  const Status status = reader.Open(path);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(), "cannot read '" + path + "': a pipe or a device, not a file");
}

TEST(TextReaderTest, NamesAMissingFile) {
  const std::string path = TempFolder() + "none.txt";
  TextReader reader;
  const Status status = reader.Open(path);
  EXPECT_EQ(status.code(), StatusCode::kNotFound);
  EXPECT_THAT(status.message(), HasSubstr("'" + path + "'"));
}

TEST(TextReaderTest, AFolderCannotBeRead) {
  const std::string path = TempFolder();
  TextReader reader;
  ASSERT_TRUE(reader.Open(path).ok());  // The system opens it and refuses to read.
  EXPECT_THAT(Lines(&reader), ElementsAre());
  EXPECT_EQ(reader.status().code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(reader.status().message(), HasSubstr(path));
}

}  // namespace
}  // namespace plumbline
