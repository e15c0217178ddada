#ifndef PLUMBLINE_TEST_APPS_WHOLE_FILES_H_
#define PLUMBLINE_TEST_APPS_WHOLE_FILES_H_

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {

inline bool StartsWith(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}
inline bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The number behind a word of a header; 0 if it is not there.
inline std::size_t NumberBehind(const std::string& text, const std::string& word) {
  const std::size_t place = text.find(word);
  return place == std::string::npos ? 0 : std::stoul(text.substr(place + word.size()));
}

/// Whether all lines end, and have as many fields as their first word, or any, asks for.
inline bool LinesAreWhole(const std::string& text, const std::string& first_word,
                          std::size_t num_fields) {
  if (!EndsWith(text, "\n")) return false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!StartsWith(line, first_word)) continue;
    std::istringstream fields(line);
    std::size_t count = 0;
    for (std::string field; fields >> field;) ++count;
    if (count != num_fields) return false;
  }
  return true;
}

/// Whether all rows end, and have as many commas.
inline bool RowsAreWhole(const std::string& text) {
  const auto num_commas = [](const std::string& row) {
    return std::count(row.begin(), row.end(), ',');
  };
  std::istringstream rows(text);
  std::string first;
  std::getline(rows, first);
  for (std::string row; std::getline(rows, row);) {
    if (num_commas(row) != num_commas(first)) return false;
  }
  return EndsWith(text, "\n");
}

/// Whether binary data of the announced size follows a header that ends with `header_end`.
inline bool DataFollows(const std::string& bytes, const std::string& header_end,
                        std::size_t num_bytes) {
  const std::size_t end = bytes.find(header_end);
  return end != std::string::npos && bytes.size() == end + header_end.size() + num_bytes;
}

inline bool IsWholePgm(const std::string& bytes) {
  std::istringstream header(bytes);
  std::string magic;
  std::size_t width = 0, height = 0;
  header >> magic >> width >> height;
  return magic == "P5" && width > 0 && DataFollows(bytes, "\n255\n", width * height);
}

/// Whether a result of a program, by its name, is a complete file of its format.
inline bool IsWhole(const std::filesystem::path& file) {
  const std::string bytes = ReadFile(file.string());
  const std::string extension = file.extension().string();
  if (extension == ".png") {
    return StartsWith(bytes, "\x89PNG") && EndsWith(bytes, "IEND\xae\x42\x60\x82");
  }
  if (extension == ".json") return nlohmann::json::accept(bytes);
  if (extension == ".csv") return RowsAreWhole(bytes);
  if (extension == ".html") return EndsWith(bytes, "</html>\n");
  if (extension == ".tum") return LinesAreWhole(bytes, "", 8);
  if (extension == ".g2o") {
    return LinesAreWhole(bytes, "VERTEX_SE2", 5) && LinesAreWhole(bytes, "EDGE_SE2", 12);
  }
  if (extension == ".pgm") return IsWholePgm(bytes);
  if (extension == ".yaml") return EndsWith(bytes, "free_thresh: 0.196\n");
  if (extension == ".ply") {
    return DataFollows(bytes, "end_header\n", 28 * NumberBehind(bytes, "element vertex "));
  }
  if (extension == ".pcd") {
    return DataFollows(bytes, "DATA binary\n", 16 * NumberBehind(bytes, "POINTS "));
  }
  return false;  // no such result
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_WHOLE_FILES_H_
