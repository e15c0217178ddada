#include "plumbline/apps/program/log_list.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/apps/readers/log_reader.h"

namespace plumbline {
namespace {

bool IsThere(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

bool IsListFile(const std::string& value) { return value.front() == '@' && !IsThere(value); }

// A log, and what to call its place.
struct NamedLog {
  std::string path;
  std::string place;
};

Status ReadListFile(const std::string& path, std::vector<NamedLog>* logs) {
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(path));
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (std::string_view line; reader.NextLine(&line);) {
    constexpr std::string_view kBlanks = " \t";
    const std::size_t first = line.find_first_not_of(kBlanks);
    if (first == std::string_view::npos || line[first] == '#') continue;
    line = line.substr(first, line.find_last_not_of(kBlanks) + 1 - first);
    logs->push_back({(folder / std::string(line)).string(),
                     path + ", line " + std::to_string(reader.line_number())});
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.CheckWhole());
  return logs->empty() ? Status::InvalidArgument(path + ": the list names no log") : Status::Ok();
}

Status Split(const std::string& value, std::vector<NamedLog>* logs) {
  for (std::size_t begin = 0; begin <= value.size();) {
    const std::size_t end = std::min(value.find(',', begin), value.size());
    if (end == begin) return Status::InvalidArgument("a name between commas is missing");
    logs->push_back({value.substr(begin, end - begin), ""});
    begin = end + 1;
  }
  return Status::Ok();
}

Status CheckEachIsNamedOnce(const std::vector<NamedLog>& logs) {
  for (std::size_t i = 0; i < logs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code not_both;
      if (logs[i].path != logs[j].path &&
          !std::filesystem::equivalent(logs[i].path, logs[j].path, not_both)) {
        continue;
      }
      return Status::InvalidArgument((logs[i].place.empty() ? "" : logs[i].place + ": ") +
                                     Quote(logs[i].path) + " is named twice");
    }
  }
  return Status::Ok();
}

}  // namespace

Status ParseLogList(const std::string& value, std::vector<std::string>* logs) {
  if (value.empty()) return Status::InvalidArgument("no log is named");
  std::vector<NamedLog> named;
  if (IsListFile(value)) {
    PLUMBLINE_RETURN_IF_ERROR(ReadListFile(value.substr(1), &named));
  } else if (IsThere(value)) {
    named.push_back({value, ""});
  } else {
    PLUMBLINE_RETURN_IF_ERROR(Split(value, &named));
  }
  PLUMBLINE_RETURN_IF_ERROR(CheckEachIsNamedOnce(named));
  logs->clear();
  for (NamedLog& log : named) logs->push_back(std::move(log.path));
  return Status::Ok();
}

std::vector<std::string> FilesOfLogList(const std::string& value) {
  std::vector<std::string> logs, files;
  if (!ParseLogList(value, &logs).ok()) logs = {value};
  for (const std::string& log : logs) {
    for (std::string& file : LogFiles(log)) files.push_back(std::move(file));
  }
  if (IsListFile(value)) files.push_back(value.substr(1));
  return files;
}

}  // namespace plumbline
