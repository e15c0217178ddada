#include "plumbline/apps/program/file_flags.h"

#include <sys/stat.h>

#include <filesystem>
#include <map>
#include <system_error>
#include <tuple>

#include "plumbline/apps/io/atomic_file.h"

namespace plumbline {
namespace {

// Device and number of a file; of one that is not there, those of the innermost folder above it
// that is, and the way on from there.
using FileIdentity = std::tuple<dev_t, ino_t, std::string>;

FileIdentity Identify(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) return {status.st_dev, status.st_ino, ""};
  std::error_code ignored;
  const std::filesystem::path target = std::filesystem::absolute(FollowLinks(path), ignored);
  std::filesystem::path present = std::filesystem::weakly_canonical(target, ignored);
  if (present.empty()) present = target.lexically_normal();
  std::string rest;
  while (stat(present.c_str(), &status) != 0 && present.has_relative_path()) {
    if (present.has_filename()) rest = '/' + present.filename().string() + rest;
    present = present.parent_path();
  }
  return {status.st_dev, status.st_ino, rest};
}

std::vector<std::string> FilesOf(const FileFlag& flag) {
  if (flag.value->empty()) return {};
  std::vector<std::string> files = {*flag.value};
  if (flag.files != nullptr) files = flag.files(*flag.value);
  if (flag.use == FileUse::kOutputFolder) files.push_back(*flag.value);
  return files;
}

bool Exclude(const FileFlag& one, const FileFlag& other) {
  return one.use != FileUse::kInput || other.use != FileUse::kInput;
}

std::string SameFileText(const FileFlag& one, const FileFlag& other, const std::string& file) {
  const std::string name = std::string("--") + one.name;
  if (&one == &other) return name + " means the file '" + file + "' twice";
  return name + " and --" + other.name + " both mean the file '" + file +
         "': an output must be neither an input nor another output";
}

}  // namespace

Status CheckFileFlags(const std::vector<FileFlag>& flags) {
  std::multimap<FileIdentity, const FileFlag*> seen;
  for (const FileFlag& flag : flags) {
    for (const std::string& file : FilesOf(flag)) {
      std::error_code ignored;
      if (std::filesystem::is_character_file(file, ignored)) continue;
      const FileIdentity identity = Identify(file);
      const auto [begin, end] = seen.equal_range(identity);
      for (auto other = begin; other != end; ++other) {
        if (!Exclude(*other->second, flag)) continue;
        return Status::InvalidArgument(SameFileText(*other->second, flag, file));
      }
      seen.emplace(identity, &flag);
    }
  }
  for (const FileFlag& flag : flags) {
    if (flag.use != FileUse::kOutput) continue;
    for (const std::string& file : FilesOf(flag)) PLUMBLINE_RETURN_IF_ERROR(CheckWritable(file));
  }
  return Status::Ok();
}

}  // namespace plumbline
