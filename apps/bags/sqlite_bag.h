#ifndef PLUMBLINE_APPS_BAGS_SQLITE_BAG_H_
#define PLUMBLINE_APPS_BAGS_SQLITE_BAG_H_

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "plumbline/apps/bags/bag_container.h"

namespace plumbline {

/// How files of SQLite begin.
constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);

/// A bag of ROS 2 in a database of SQLite (.db3), as rosbag2_storage_sqlite3 writes it: the tables
/// `topics` and `messages`. Without `expanded` the file is read, and is not changed; otherwise it
/// is compressed and this is what it holds. ReadMessages fails with InvalidArgument if the database
/// has no such tables, with DataLoss where SQLite finds it damaged or a value is of another type.
std::unique_ptr<BagContainer> MakeSqliteBag(std::string path, std::optional<std::string> expanded);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_SQLITE_BAG_H_
