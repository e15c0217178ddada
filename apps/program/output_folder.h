#ifndef PLUMBLINE_APPS_PROGRAM_OUTPUT_FOLDER_H_
#define PLUMBLINE_APPS_PROGRAM_OUTPUT_FOLDER_H_

#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// The folder that a run leaves its results in.
class OutputFolder {
 public:
  explicit OutputFolder(std::string path);

  /// Makes it, with the folders above it, if it is not there, and makes sure that files can be
  /// written to it. Unavailable or NotFound if the system refuses.
  Status Make() const;

  /// Removes what an earlier run has left, so that no mix of two runs is taken for a result: first
  /// summary.json, whose presence says that the others belong together, then the rest of the files
  /// that runs write, and those that a killed run has left half-written. Files that this run reads,
  /// `inputs`, stay, and all that has other names. Unavailable if the system refuses.
  Status RemoveOldResults(const std::vector<std::string>& inputs) const;

  const std::string& path() const { return path_; }
  /// Path of a file in it.
  std::string File(const std::string& name) const;

 private:
  std::string path_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_OUTPUT_FOLDER_H_
