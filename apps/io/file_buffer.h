#ifndef PLUMBLINE_APPS_IO_FILE_BUFFER_H_
#define PLUMBLINE_APPS_IO_FILE_BUFFER_H_

#include <streambuf>
#include <string>
#include <vector>

namespace plumbline {

/// Where an std::ostream writes to when somebody wants to know why that failed: unlike
/// std::filebuf, it remembers what the system said of the first failure.
class FileBuffer : public std::streambuf {
 public:
  FileBuffer() = default;
  ~FileBuffer() override;
  FileBuffer(const FileBuffer&) = delete;
  FileBuffer& operator=(const FileBuffer&) = delete;

  /// Makes the file, or empties the one that is there. False if the system refuses, see error().
  bool Open(const std::string& path);

  /// Writes what is left, waits until the disk has it, and closes the file. False if this or
  /// anything before has failed, see error().
  bool Close();

  /// errno of the first failure; 0 if there was none.
  int error() const { return error_; }

 protected:
  int_type overflow(int_type character) override;
  int sync() override;

 private:
  bool Flush();
  bool Fail();  // keeps errno, unless there is an older one; false

  int descriptor_ = -1;
  int error_ = 0;
  std::vector<char> buffer_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_FILE_BUFFER_H_
