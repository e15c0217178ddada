#include "plumbline/apps/bags/sqlite_bag.h"

#include <sqlite3.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <system_error>
#include <utility>

#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

// No scan, odometry or set of transforms is longer. Bounds what a damaged database asks for.
constexpr int kMaxValueBytes = 1 << 28;

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct FinishQuery {
  void operator()(sqlite3_stmt* query) const { sqlite3_finalize(query); }
};
using Query = std::unique_ptr<sqlite3_stmt, FinishQuery>;

// Whether an interrupted recording has left a part of itself in a file beside it.
bool HasJournal(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path + "-wal", ignored) ||
         std::filesystem::exists(path + "-journal", ignored);
}

// The file's name for SQLite, with what has a meaning there in hexadecimal digits. It is read as it
// is, also in a folder that cannot be written to, unless a journal has to be taken in.
std::string UriOf(const std::string& path) {
  constexpr char kHexDigits[] = "0123456789abcdef";
  std::string uri = path.front() == '/' ? "file://" : "file:";
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#') {
      uri += {'%', kHexDigits[c / 16], kHexDigits[c % 16]};
    } else {
      uri += c;
    }
  }
  return uri + (HasJournal(path) ? "" : "?immutable=1");
}

// The size of a database by its first bytes (SQLite: Database File Format, section 1.3); 0 if they
// do not tell. At least that of these bytes.
std::uint64_t StatedSize(std::string_view start) {
  constexpr std::size_t kHeaderBytes = 100;
  if (start.size() < kHeaderBytes) return kHeaderBytes;
  const auto number = [start](std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (const char c : start.substr(at, size)) value = value << 8 | static_cast<std::uint8_t>(c);
    return value;
  };
  const bool is_valid = number(24, 4) == number(92, 4);
  const std::uint64_t page_size = number(16, 2) == 1 ? 65536 : number(16, 2);
  return is_valid ? page_size * number(28, 4) : 0;
}

class SqliteBag : public BagContainer {
 public:
  SqliteBag(std::string path, std::optional<std::string> expanded)
      : path_(std::move(path)), expanded_(std::move(expanded)) {}

  Status ReadMessages(const IsWanted& is_wanted, const TakeMessage& take) override {
    if (database_ == nullptr) PLUMBLINE_RETURN_IF_ERROR(Open());
    PLUMBLINE_RETURN_IF_ERROR(CheckTables());
    std::map<std::int64_t, BagTopic> topics;
    PLUMBLINE_RETURN_IF_ERROR(ReadTopics(is_wanted, &topics));
    return topics.empty() ? Status::Ok() : ReadMessagesOf(topics, take);
  }

 private:
  Status Error(const std::string& place) const {
    const std::string message = path_ + ": cannot be read as a bag of ROS 2: " + place + ": " +
                                sqlite3_errmsg(database_.get());
    return sqlite3_errcode(database_.get()) == SQLITE_ERROR ? Status::InvalidArgument(message)
                                                            : Status::DataLoss(message);
  }

  Status Open() {
    PLUMBLINE_RETURN_IF_ERROR(CheckSize());
    sqlite3* database = nullptr;
    const std::string name = expanded_ ? ":memory:" : UriOf(path_);
    const int opened =
        sqlite3_open_v2(name.c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(database);
    if (opened != SQLITE_OK) return Error("opening it");
    if (expanded_) PLUMBLINE_RETURN_IF_ERROR(OpenExpanded());
    // A database may hold code: views, and functions in its tables.
    sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_limit(database, SQLITE_LIMIT_LENGTH, kMaxValueBytes);
    return Status::Ok();
  }

  // SQLite takes what is missing of the last page for zeros, that is for a page without messages.
  Status CheckSize() const {
    if (!expanded_ && HasJournal(path_)) return Status::Ok();
    std::string start(100, '\0');
    std::uint64_t size = 0;
    if (expanded_) {
      start = expanded_->substr(0, start.size());
      size = expanded_->size();
    } else {
      errno = 0;
      std::ifstream file(path_, std::ios::binary | std::ios::ate);
      if (!file) return ReadError("open", path_, errno);
      size = static_cast<std::uint64_t>(file.tellg());
      file.seekg(0);
      file.read(start.data(), static_cast<std::streamsize>(start.size()));
      start.resize(static_cast<std::size_t>(file.gcount()));
    }
    if (size >= StatedSize(start)) return Status::Ok();
    return Status::DataLoss(path_ +
                            ": cannot be read as a bag of ROS 2: the file is cut off at byte " +
                            std::to_string(size) + " of " + std::to_string(StatedSize(start)));
  }

  Status OpenExpanded() {
    // A log to write ahead is of no use in memory, and refused there: bytes 18 and 19 ask for it.
    for (const std::size_t version_at : {18, 19}) {
      if (version_at < expanded_->size()) (*expanded_)[version_at] = 1;
    }
    auto* bytes = reinterpret_cast<unsigned char*>(expanded_->data());
    const auto size = static_cast<sqlite3_int64>(expanded_->size());
    const int result = sqlite3_deserialize(database_.get(), "main", bytes, size, size,
                                           SQLITE_DESERIALIZE_READONLY);
    return result == SQLITE_OK ? Status::Ok() : Error("opening it");
  }

  Status Prepare(const std::string& text, Query* query) const {
    sqlite3_stmt* statement = nullptr;
    const int result = sqlite3_prepare_v2(database_.get(), text.c_str(), -1, &statement, nullptr);
    query->reset(statement);
    return result == SQLITE_OK ? Status::Ok() : Error("query");
  }

  // Goes through the rows of a query.
  template <typename TakeRow>
  Status ForEachRow(const std::string& text, const std::string& table, const TakeRow& take) const {
    Query query;
    PLUMBLINE_RETURN_IF_ERROR(Prepare(text, &query));
    int result = SQLITE_ROW;
    std::size_t num_rows = 0;
    while ((result = sqlite3_step(query.get())) == SQLITE_ROW) {
      PLUMBLINE_RETURN_IF_ERROR(take(query.get()));
      ++num_rows;
    }
    if (result == SQLITE_DONE) return Status::Ok();
    return Error("table " + table + ", after " + std::to_string(num_rows) + " rows");
  }

  Status CheckTables() const {
    std::string tables;
    int num_found = 0, num_of_rtabmap = 0;
    PLUMBLINE_RETURN_IF_ERROR(
        ForEachRow("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name LIMIT 20",
                   "sqlite_master", [&](sqlite3_stmt* row) {
                     const std::string name = Text(row, 0);
                     if (name == "topics" || name == "messages") ++num_found;
                     if (name == "Node" || name == "Link") ++num_of_rtabmap;
                     tables += (tables.empty() ? "" : ", ") + name;
                     return Status::Ok();
                   }));
    if (num_found == 2) return Status::Ok();
    if (num_of_rtabmap == 2) {
      return Status::InvalidArgument(path_ +
                                     ": a database of RTAB-Map, which is not read: play it with "
                                     "data_player of RTAB-Map's ROS package, and record scans and "
                                     "odometry in a bag");
    }
    return Status::InvalidArgument(
        path_ + ": a database of SQLite, but no bag of ROS 2: it has no tables 'topics' and " +
        "'messages', but " + (tables.empty() ? "none" : tables));
  }

  Status WrongType(const std::string& table, std::int64_t id, const char* column) const {
    return Status::DataLoss(path_ + ": cannot be read as a bag of ROS 2: table " + table +
                            ", row with id " + std::to_string(id) + ": column '" + column +
                            "' is of another type");
  }

  static std::string Text(sqlite3_stmt* row, int column) {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
    return text == nullptr ? std::string() : std::string(text, sqlite3_column_bytes(row, column));
  }

  Status ReadTopics(const IsWanted& is_wanted, std::map<std::int64_t, BagTopic>* topics) const {
    return ForEachRow("SELECT id, name, type, serialization_format FROM topics ORDER BY id",
                      "topics", [&](sqlite3_stmt* row) {
                        const std::int64_t id = sqlite3_column_int64(row, 0);
                        for (int column = 1; column <= 3; ++column) {
                          if (sqlite3_column_type(row, column) == SQLITE_TEXT) continue;
                          return WrongType("topics", id, sqlite3_column_name(row, column));
                        }
                        BagTopic topic{Text(row, 1), Text(row, 2), Text(row, 3)};
                        if (is_wanted(topic)) topics->emplace(id, std::move(topic));
                        return Status::Ok();
                      });
  }

  // In the order of their ids, which is that of the recording. SQLite does not load the data of
  // other topics' messages.
  Status ReadMessagesOf(const std::map<std::int64_t, BagTopic>& topics,
                        const TakeMessage& take) const {
    std::string ids;
    for (const auto& entry : topics) {
      ids += (ids.empty() ? "" : ", ") + std::to_string(entry.first);
    }
    return ForEachRow("SELECT id, topic_id, timestamp, data FROM messages WHERE topic_id IN (" +
                          ids + ") ORDER BY id",
                      "messages", [&](sqlite3_stmt* row) {
                        const std::int64_t id = sqlite3_column_int64(row, 0);
                        const auto topic = topics.find(sqlite3_column_int64(row, 1));
                        if (topic == topics.end()) return WrongType("messages", id, "topic_id");
                        if (sqlite3_column_type(row, 2) != SQLITE_INTEGER) {
                          return WrongType("messages", id, "timestamp");
                        }
                        if (sqlite3_column_type(row, 3) != SQLITE_BLOB) {
                          return WrongType("messages", id, "data");
                        }
                        const double time_s =
                            1e-9 * static_cast<double>(sqlite3_column_int64(row, 2));
                        const auto* data = static_cast<const char*>(sqlite3_column_blob(row, 3));
                        const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, 3));
                        return take(topic->second, time_s,
                                    size == 0 ? std::string_view() : std::string_view(data, size));
                      });
  }

  const std::string path_;
  std::optional<std::string> expanded_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
};

}  // namespace

std::unique_ptr<BagContainer> MakeSqliteBag(std::string path, std::optional<std::string> expanded) {
  return std::make_unique<SqliteBag>(std::move(path), std::move(expanded));
}

}  // namespace plumbline
