#include "plumbline/apps/io/whole_file.h"

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "plumbline/apps/io/file_status.h"

namespace plumbline {

Status ReadWholeFile(const std::string& path, std::string* bytes) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return ReadError("read", path, EISDIR);
  errno = 0;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return ReadError("open", path, errno);
  bytes->resize(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  file.read(bytes->data(), static_cast<std::streamsize>(bytes->size()));
  return file ? Status::Ok() : ReadError("read", path, errno);
}

}  // namespace plumbline
