#ifndef PLUMBLINE_TEST_APPS_BAGS_SQLITE_WRITER_H_
#define PLUMBLINE_TEST_APPS_BAGS_SQLITE_WRITER_H_

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "plumbline/test/apps/bags/bag_testing.h"

namespace plumbline {

inline void Execute(sqlite3* database, const std::string& text) {
  ASSERT_EQ(sqlite3_exec(database, text.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << text << ": " << sqlite3_errmsg(database);
}

/// Makes a database by the statements.
inline void WriteDatabase(const std::string& path, const std::vector<std::string>& statements) {
  std::remove(path.c_str());
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  for (const std::string& statement : statements) Execute(database, statement);
  sqlite3_close(database);
}

inline std::string HexBlob(const std::string& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text = "x'";
  for (const unsigned char byte : bytes) text += {kDigits[byte / 16], kDigits[byte % 16]};
  return text + "'";
}

inline std::vector<std::string> BagStatements(const TestBag& bag) {
  std::vector<std::string> statements = {
      "PRAGMA page_size = 512",
      R"(CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
         serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL))",
      R"(CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,
         timestamp INTEGER NOT NULL, data BLOB NOT NULL))",
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC)", "BEGIN"};
  std::map<std::string, int> ids;
  for (const TestMessage& message : bag) {
    const auto [id, is_new] = ids.emplace(message.topic, static_cast<int>(ids.size()) + 1);
    if (is_new) {
      statements.push_back("INSERT INTO topics VALUES(" + std::to_string(id->second) + ", '" +
                           message.topic + "', '" + message.type + "', '" + message.encoding +
                           "', '')");
    }
    statements.push_back("INSERT INTO messages(topic_id, timestamp, data) VALUES(" +
                         std::to_string(id->second) + ", " + std::to_string(message.time_ns) +
                         ", " + HexBlob(message.bytes) + ")");
  }
  statements.push_back("COMMIT");
  return statements;
}

inline void WriteSqliteBag(const std::string& path, const TestBag& bag) {
  WriteDatabase(path, BagStatements(bag));
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_BAGS_SQLITE_WRITER_H_
