#ifndef PLUMBLINE_APPS_IO_TEMPORARY_FILES_H_
#define PLUMBLINE_APPS_IO_TEMPORARY_FILES_H_

#include <signal.h>

#include <string>

namespace plumbline {

/// The list of the temporary files of this process, for a signal that ends it to delete them. Who
/// makes, renames or deletes one does so while an object of this class exists, so that the list is
/// right whenever somebody else sees it: other threads wait, and signals of this thread are put
/// off.
class TemporaryFiles {
 public:
  TemporaryFiles();
  ~TemporaryFiles();
  TemporaryFiles(const TemporaryFiles&) = delete;
  TemporaryFiles& operator=(const TemporaryFiles&) = delete;

  void Add(const std::string& path);
  void Remove(const std::string& path);

  /// Deletes the files of the list, for a program that ends: no thread makes, renames or deletes
  /// one after that. Signal handlers may call it, again and again.
  static void DeleteForGood();

 private:
  sigset_t signals_;  // that this thread had blocked before
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_TEMPORARY_FILES_H_
