#ifndef PLUMBLINE_APPS_COMMAND_LINE_H_
#define PLUMBLINE_APPS_COMMAND_LINE_H_

#include <gflags/gflags.h>

#include <string>
#include <vector>

namespace plumbline {

/// The flags that this program defines, those of its main file first: not the libraries' own.
std::vector<gflags::CommandLineFlagInfo> ProgramFlags();

/// `usage` and the program's flags with their defaults, as --help prints them.
std::string HelpText(const std::string& usage);

/// Sets the flags from the command line. Ends the program where it asks for help (exit code 0) or
/// holds what is no flag (exit code 1, the culprit on standard error).
void ParseCommandLine(const std::string& usage, int argc, char** argv);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_COMMAND_LINE_H_
