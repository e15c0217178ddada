#ifndef PLUMBLINE_APPS_PROGRAM_COMMAND_LINE_H_
#define PLUMBLINE_APPS_PROGRAM_COMMAND_LINE_H_

#include <gflags/gflags.h>

#include <functional>
#include <string>
#include <vector>

#include "plumbline/apps/io/warning.h"
#include "plumbline/apps/program/file_flags.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What a program tells its caller when it ends.
enum ExitCode {
  kExitDone = 0,
  kExitBadInput = 1,     ///< a file that cannot be read or used
  kExitWrongUsage = 2,   ///< flags that are missing, unknown or make no sense
  kExitCannotWrite = 3,  ///< no folder, no permission, disk full
};

/// The flags that this program defines, those of its main file (or of what several main files run,
/// x_program.cc) first: not the libraries' own.
std::vector<gflags::CommandLineFlagInfo> ProgramFlags();

/// `usage`, the program's flags with their defaults, and the exit codes, as --help prints them.
std::string HelpText(const std::string& usage);

/// What every program begins with: catches stop signals (CatchSignals) and sets the flags from the
/// command line. Ends the program where it asks for help (kExitDone) or holds what is no flag
/// (kExitWrongUsage, the culprit on standard error). Standard streams that the caller has closed
/// stay taken, so that no file comes in their place.
void StartProgram(const std::string& usage, int argc, char** argv);

/// Runs a program whose flags are set: `check_flags` looks at nothing but them, and is called again
/// with some of them at their defaults to find out which number it refuses; then `files`, all flags
/// that mean files, are checked (CheckFileFlags); `run` does the rest. Gives the exit code, with a
/// line on standard error unless all went well. A limit on the stack below 1 MiB counts as wrong
/// usage, running out of memory as bad input. Unavailable, of `run`, is an output that cannot be
/// written; so is standard output, if it took less than was printed. A stop signal that was kept
/// (KeepStopSignal) has an exit code of its own.
int RunProgram(const std::vector<FileFlag>& files, const std::function<Status()>& check_flags,
               const std::function<Status()>& run);

/// How a program came to its end.
struct ProgramEnd {
  int exit_code = kExitDone;
  std::string message;  ///< for people, what is wrong; empty if nothing is
};

/// The same without the line on standard error, for programs of several processes.
ProgramEnd RunQuietly(const std::vector<FileFlag>& files,
                      const std::function<Status()>& check_flags,
                      const std::function<Status()>& run);

/// Prints each warning as a line on standard error.
void PrintWarnings(const std::vector<Warning>& warnings);

/// The line on standard error: the name of the program and a message.
void PrintFailure(const std::string& message);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_COMMAND_LINE_H_
