#ifndef PLUMBLINE_APPS_IO_FILE_BUFFER_H_
#define PLUMBLINE_APPS_IO_FILE_BUFFER_H_

#include <sys/types.h>

#include <cstddef>
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

  /// Each of these opens something for writing, once; false if the system refuses, see error().
  /// A new file with these permissions, less what the user's mask takes away; EEXIST if the name is
  /// taken.
  bool OpenNew(const std::string& path, mode_t permissions);
  /// What is there, without emptying it: a pipe or a device.
  bool OpenExisting(const std::string& path);
  /// Another name of an open descriptor, which stays open.
  bool OpenCopy(int descriptor);

  /// What is written from now on goes there [bytes from the beginning]. False if that fails, see
  /// error().
  bool SeekTo(std::size_t position);

  /// Writes what is left and lets the disk begin with it. False if that fails, see error().
  bool Send();

  /// Writes what is left, waits until the disk has it, and closes the file. False if this or
  /// anything before has failed, see error().
  bool Close();

  bool is_open() const { return descriptor_ >= 0; }
  /// Of the system, for its calls on open files; negative if none is open.
  int descriptor() const { return descriptor_; }
  /// errno of the first failure; 0 if there was none.
  int error() const { return error_; }

 protected:
  int_type overflow(int_type character) override;
  int sync() override;

 private:
  bool Take(int descriptor);  // false if it is negative
  bool Flush();
  bool Fail();  // keeps errno, unless there is an older one; false

  int descriptor_ = -1;
  int error_ = 0;
  std::vector<char> buffer_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_FILE_BUFFER_H_
