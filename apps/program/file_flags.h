#ifndef PLUMBLINE_APPS_PROGRAM_FILE_FLAGS_H_
#define PLUMBLINE_APPS_PROGRAM_FILE_FLAGS_H_

#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// What a program does with the files that a flag means.
enum class FileUse {
  kInput,         ///< reads them
  kOutput,        ///< writes them
  kOutputFolder,  ///< makes the folder, and writes files in it
};

/// A flag that means files. Every program declares all of its own, see RunProgram.
struct FileFlag {
  const char* name;          ///< without "--"
  const std::string* value;  ///< empty: no file
  FileUse use;
  /// The files that a value stands for; null: it is the path of a file. Of a folder: what the
  /// program may write in it, or remove from it.
  std::vector<std::string> (*files)(const std::string& value) = nullptr;
};

/// Before anything is read or written: InvalidArgument names two flags (or one, twice) and a file
/// if an output is an input or another output, by any path to it: through symbolic and hard links,
/// relative, or in a folder that is not there yet. Character devices, as /dev/null, may be named
/// several times. Then fails like CheckWritable for the outputs, but for those in output folders.
Status CheckFileFlags(const std::vector<FileFlag>& flags);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_FILE_FLAGS_H_
