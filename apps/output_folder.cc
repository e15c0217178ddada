#include "plumbline/apps/output_folder.h"

#include <filesystem>
#include <system_error>
#include <utility>

namespace plumbline {

OutputFolder::OutputFolder(std::string path) : path_(std::move(path)) {}

Status OutputFolder::Make() const {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (!error) return Status::Ok();
  return Status::Unavailable("cannot make the folder '" + path_ + "': " + error.message());
}

std::string OutputFolder::File(const std::string& name) const {
  return (std::filesystem::path(path_) / name).string();
}

}  // namespace plumbline
