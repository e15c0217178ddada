#ifndef PLUMBLINE_TEST_TEMP_FILE_H_
#define PLUMBLINE_TEST_TEMP_FILE_H_

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace plumbline {

/// An empty folder of the running test's own.
inline std::string TempFolder() {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) /
                                       "plumbline_test" / test->test_suite_name() / test->name();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder.string() + "/";
}

inline void WriteFile(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

inline std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline int NumFilesIn(const std::string& folder) {
  const std::filesystem::directory_iterator begin(folder), end;
  return static_cast<int>(std::distance(begin, end));
}

/// Folder of the real logs (environment variable PLUMBLINE_DATASETS), empty if it is not set.
inline std::string DatasetsFolder() {
  const char* folder = std::getenv("PLUMBLINE_DATASETS");
  return folder == nullptr ? "" : folder;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_TEMP_FILE_H_
