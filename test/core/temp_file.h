#ifndef PLUMBLINE_TEST_CORE_TEMP_FILE_H_
#define PLUMBLINE_TEST_CORE_TEMP_FILE_H_

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <system_error>

namespace plumbline {

/// The folder of this process for temporary files, so that two runs of the suite may overlap. Goes
/// with the process.
class TempRoot {
 public:
  TempRoot()
      : path_(std::filesystem::path(testing::TempDir()) /
              ("plumbline_test-" + std::to_string(getpid()))) {}
  ~TempRoot() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  const std::filesystem::path path_;
};

/// An empty folder of the running test's own.
inline std::string TempFolder() {
  static const TempRoot root;
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder = root.path() / test->test_suite_name() / test->name();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder.string() + "/";
}

inline void WriteFile(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

inline std::string ReadFile(const std::string& path) {
  // The library copies block by block: iterators over characters take a second for 25 MB at -O0.
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
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

#endif  // PLUMBLINE_TEST_CORE_TEMP_FILE_H_
