#ifndef PLUMBLINE_APPS_OUTPUT_FOLDER_H_
#define PLUMBLINE_APPS_OUTPUT_FOLDER_H_

#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// The folder that a run leaves its results in.
class OutputFolder {
 public:
  explicit OutputFolder(std::string path);

  /// Makes it, with the folders above it, if it is not there. Unavailable if the system refuses.
  Status Make() const;

  const std::string& path() const { return path_; }
  /// Path of a file in it.
  std::string File(const std::string& name) const;

 private:
  std::string path_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_OUTPUT_FOLDER_H_
