#include "plumbline/apps/bags/sqlite_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/apps/bags/bag_reader.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/sqlite_writer.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SqliteBagTest : public testing::Test {
 protected:
  Status Read() { return ReadBag(path_, BagReadOptions(), &recording_); }
  // Of the small bag, changed by more statements.
  Status ReadAfter(const std::vector<std::string>& changes) {
    std::vector<std::string> statements = BagStatements(SmallBag());
    statements.insert(statements.end(), changes.begin(), changes.end());
    WriteDatabase(path_, statements);
    return Read();
  }
  void ExpectFailure(const Status& status, StatusCode code, const std::string& problem) const {
    EXPECT_EQ(status.code(), code);
    EXPECT_THAT(status.message(), AllOf(HasSubstr(path_ + ": "), HasSubstr(problem)));
  }

  const std::string folder_ = TempFolder();
  const std::string path_ = folder_ + "a.db3";
  RosRecording recording_;
};

TEST_F(SqliteBagTest, DatabasesOfOtherProgramsAreNamed) {
  WriteDatabase(path_, {"CREATE TABLE people(name)", "CREATE TABLE messages(text)"});
  ExpectFailure(Read(), StatusCode::kInvalidArgument,
                "a database of SQLite, but no bag of ROS 2: it has no tables 'topics' and "
                "'messages', but messages, people");
  WriteDatabase(path_, {"CREATE TABLE topics(a)", "CREATE TABLE messages(b)"});
  ExpectFailure(Read(), StatusCode::kInvalidArgument, "no such column: ");
}

// A view may compute for ever.
TEST_F(SqliteBagTest, ViewsAreNoTables) {
  ExpectFailure(ReadAfter({"DROP TABLE messages",
                           "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL "
                           "SELECT i + 1 FROM n) SELECT i AS id, 4 AS topic_id, 0 AS timestamp, "
                           "zeroblob(1000) AS data FROM n"}),
                StatusCode::kInvalidArgument, "no bag of ROS 2");
}

TEST_F(SqliteBagTest, ValuesOfOtherTypesAreNamed) {
  ExpectFailure(ReadAfter({"UPDATE topics SET type = x'00' WHERE id = 2"}), StatusCode::kDataLoss,
                "table topics, row with id 2: column 'type' is of another type");
  ExpectFailure(ReadAfter({"UPDATE messages SET data = 'text' WHERE id = 4"}),
                StatusCode::kDataLoss,
                "table messages, row with id 4: column 'data' is of another type");
  ExpectFailure(ReadAfter({"UPDATE messages SET timestamp = 'noon' WHERE id = 5"}),
                StatusCode::kDataLoss,
                "table messages, row with id 5: column 'timestamp' is of another type");
  ASSERT_TRUE(ReadAfter({"UPDATE messages SET data = x'' WHERE id = 4"}).ok());
  EXPECT_THAT(recording_.scans[0].fault, HasSubstr("field 'encapsulation'"));
}

TEST_F(SqliteBagTest, ValuesOfOtherTopicsDoNotMatter) {
  EXPECT_TRUE(ReadAfter({"UPDATE messages SET data = 'text', timestamp = 'noon' WHERE id = 3",
                         "INSERT INTO messages VALUES(100, 77, 0, x'00')"})
                  .ok());
  EXPECT_EQ(recording_.scans.size(), 2u);
}

TEST_F(SqliteBagTest, ARowThatComputesTooMuchIsNamed) {
  EXPECT_FALSE(ReadAfter({"ALTER TABLE messages RENAME TO old",
                          "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, "
                          "timestamp INTEGER, data BLOB AS (zeroblob(900000000)))",
                          "INSERT INTO messages(topic_id, timestamp) VALUES(4, 0)"})
                   .ok());
}

TEST_F(SqliteBagTest, EveryCutIsNamed) {
  WriteSqliteBag(path_, SmallBag());
  const std::string whole = ReadFile(path_);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::string content;
    const Status status = ReadAll(MakeSqliteBag(path_, whole.substr(0, size)).get(), &content);
    ASSERT_EQ(status.code(), StatusCode::kDataLoss) << size;
    ASSERT_THAT(status.message(), HasSubstr(path_)) << size;
  }
}

TEST_F(SqliteBagTest, AFileThatIsCutOffSaysWhere) {
  WriteSqliteBag(path_, SmallBag());
  const std::string whole = ReadFile(path_);
  WriteFile(path_, whole.substr(0, whole.size() - 1));
  ExpectFailure(Read(), StatusCode::kDataLoss,
                "the file is cut off at byte " + std::to_string(whole.size() - 1) + " of " +
                    std::to_string(whole.size()));
}

TEST_F(SqliteBagTest, EveryFlippedByteIsReadOrNamed) {
  WriteSqliteBag(path_, SmallBag());
  const std::string whole = ReadFile(path_);
  for (const int change : {0x01, 0x80, 0xff}) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      std::string flipped = whole, content;
      flipped[i] = static_cast<char>(flipped[i] ^ change);
      const Status status = ReadAll(MakeSqliteBag(path_, flipped).get(), &content);
      EXPECT_EQ(status.ok(), status.message().find(path_) == std::string::npos) << "byte " << i;
    }
  }
}

TEST_F(SqliteBagTest, AnyPathIsFine) {
  const std::string path = folder_ + "what? 100%41 #1.db3";
  WriteSqliteBag(path, SmallBag());
  EXPECT_TRUE(ReadBag(path, BagReadOptions(), &recording_).ok());
  EXPECT_EQ(recording_.scans.size(), 2u);
}

TEST_F(SqliteBagTest, ADatabaseOfRtabMapIsNamed) {
  WriteDatabase(path_, {"CREATE TABLE Node(id INTEGER)", "CREATE TABLE Link(from_id INTEGER)"});
  EXPECT_THAT(Read().message(), HasSubstr(path_ + ": a database of RTAB-Map, which is not read"));
}

// As rosbag2's resilient preset leaves it when it is killed.
TEST_F(SqliteBagTest, AnInterruptedRecordingIsReadWithWhatIsBesideIt) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
  Execute(database, "PRAGMA journal_mode = WAL");
  for (const std::string& statement : BagStatements(SmallBag())) Execute(database, statement);
  // Copied while it is open: the rows are in the file beside it.
  for (const std::string end : {"", "-wal"}) {
    std::filesystem::copy_file(path_ + end, folder_ + "b.db3" + end);
  }
  sqlite3_close(database);
  ASSERT_TRUE(ReadBag(folder_ + "b.db3", BagReadOptions(), &recording_).ok());
  EXPECT_EQ(recording_.scans.size(), 2u);
  // Closed, the file is whole, but still says that it is written that way.
  ASSERT_FALSE(std::filesystem::exists(path_ + "-wal"));
  recording_ = RosRecording();
  ASSERT_TRUE(Read().ok());
  EXPECT_EQ(recording_.scans.size(), 2u);
  EXPECT_FALSE(std::filesystem::exists(path_ + "-wal"));
  EXPECT_FALSE(std::filesystem::exists(path_ + "-shm"));
}

}  // namespace
}  // namespace plumbline
