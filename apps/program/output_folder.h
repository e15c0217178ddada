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
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Makes it, with the folders above it, if it is not there, takes it for this run alone, and
  /// makes sure that files can be written to it. It is free again when this object or the program
  /// ends, however that happens. Unavailable or NotFound if the system refuses, Unavailable if
  /// another run has it; a file system without locks cannot tell.
  Status Make();

  /// Removes what an earlier run has left, see ResultsIn, so that no mix of two runs is taken for a
  /// result. Unavailable if the system refuses.
  Status RemoveOldResults() const;

  const std::string& path() const { return path_; }
  /// The folders that were not there before Make(), the innermost first.
  const std::vector<std::string>& made_folders() const { return made_folders_; }
  /// Path of a file in it.
  std::string File(const std::string& name) const;
  /// Path of a folder in it, for one map of several, numbered from 1.
  std::string MapFolder(int number) const;

 private:
  Status Lock();

  std::string path_;
  std::vector<std::string> made_folders_;
  int descriptor_ = -1;  // of the folder, locked; negative while it is not
};

/// The files that a run over logs or a pose graph writes in a folder or removes from it: first
/// summary.json, whose presence says that the others belong together, then the rest of its results,
/// whether or not they are there; those of sessions and in folders of maps that are there, and
/// those that a killed run has left half-written. All that has other names is not touched.
std::vector<std::string> ResultsIn(const std::string& folder);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_OUTPUT_FOLDER_H_
