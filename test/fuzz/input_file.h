#ifndef PLUMBLINE_TEST_FUZZ_INPUT_FILE_H_
#define PLUMBLINE_TEST_FUZZ_INPUT_FILE_H_

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace plumbline {

/// A file that holds one input of a fuzzer after the other, for readers that take paths. In the
/// system's temporary folder (TMPDIR=/dev/shm keeps it in memory); goes with the process.
class InputFile {
 public:
  InputFile()
      : path_(std::filesystem::temp_directory_path() /
              ("plumbline_fuzz-" + std::to_string(getpid()))) {}
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }

  /// Its path, now that it holds these bytes.
  std::string Holding(const std::uint8_t* data, std::size_t size) const {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path_.string();
  }

 private:
  const std::filesystem::path path_;
};

/// Ends the program with a signal, as a fuzzer expects of a fault, unless `holds`.
inline void Require(bool holds) {
  if (!holds) __builtin_trap();
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_FUZZ_INPUT_FILE_H_
