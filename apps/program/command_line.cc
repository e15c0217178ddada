#include "plumbline/apps/program/command_line.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <new>
#include <sstream>
#include <string_view>
#include <utility>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/heap.h"
#include "plumbline/apps/program/project_version.h"
#include "plumbline/apps/program/stop_signal.h"

DECLARE_bool(help);
DECLARE_bool(helpshort);
DECLARE_bool(version);
DECLARE_string(flagfile);

// Where gflags goes on finding a fault. It is there to be set, but no header of gflags has it.
namespace GFLAGS_NAMESPACE {
extern GFLAGS_DLL_DECL void (*gflags_exitfunc)(int);
}

namespace plumbline {
namespace {

// Whether all that was printed has gone where it should.
Status FlushStandardOutput() {
  errno = 0;
  std::cout.flush();
  return std::cout ? Status::Ok() : WriteError("write to", "standard output", errno);
}

// The next file to be opened would take the place of a standard stream that is closed, and get what
// is printed. This one takes it, and refuses to be written.
void FillClosedStreams() {
  int descriptor = 0;
  while (descriptor >= 0 && descriptor <= STDERR_FILENO) {
    descriptor = open("/dev/null", O_RDONLY);
  }
  if (descriptor >= 0) close(descriptor);
}

// A stack that runs out ends a program without a word.
Status CheckStackLimit() {
  // What reads fonts and draws pictures was seen to take 192 kB, and libraries differ.
  constexpr rlim_t kNeededKb = 1024, kBytesPerKb = 1024;
  rlimit limit{};
  if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ||
      limit.rlim_cur >= kNeededKb * kBytesPerKb) {
    return Status::Ok();
  }
  const std::string needed = std::to_string(kNeededKb);
  return Status::InvalidArgument(
      "the stack limit of " + std::to_string(limit.rlim_cur / kBytesPerKb) +
      " kB is too small: " + needed + " kB are needed (ulimit -s " + needed + ")");
}

bool EndsWith(std::string_view text, std::string_view ending) {
  return text.size() >= ending.size() && text.substr(text.size() - ending.size()) == ending;
}

// The default as one would type it: gflags prints 17 digits of a number.
std::string ReadableDefault(const gflags::CommandLineFlagInfo& flag) {
  if (flag.type != "double") return flag.default_value;
  std::ostringstream text;
  text << std::stod(flag.default_value);
  return text.str();
}

// The message of a check, with the number in front that it comes from: that of the first flag
// without which the check says something else. Messages have the names of options, which are close
// to those of flags, but not the same.
std::string WithFlag(const std::string& message, const std::function<Status()>& check_flags) {
  if (message.find("--") != std::string::npos) return message;
  for (const gflags::CommandLineFlagInfo& flag : ProgramFlags()) {
    if (flag.is_default || flag.type == "string" || flag.type == "bool") continue;
    gflags::SetCommandLineOption(flag.name.c_str(), flag.default_value.c_str());
    const Status without = check_flags();
    gflags::SetCommandLineOption(flag.name.c_str(), flag.current_value.c_str());
    if (without.message() != message) {
      return "--" + flag.name + "=" + flag.current_value + ": " + message;
    }
  }
  return message;
}

// The end that a failure means, bad input or wrong usage unless an output is to blame.
ProgramEnd EndOf(const Status& status, ExitCode code) {
  const bool bad_output = status.code() == StatusCode::kUnavailable;
  return {bad_output ? kExitCannotWrite : code, status.message()};
}

std::string VersionText() {
  return std::string(gflags::ProgramInvocationShortName()) + " " + kProjectVersion + "\n";
}

ProgramEnd RunUnstopped(const std::vector<FileFlag>& files,
                        const std::function<Status()>& check_flags,
                        const std::function<Status()>& run) {
  KeepOneHeap();
  const Status stack = CheckStackLimit();
  if (!stack.ok()) return {kExitWrongUsage, stack.message()};
  try {
    const Status usage = check_flags();
    if (!usage.ok()) return {kExitWrongUsage, WithFlag(usage.message(), check_flags)};
    std::vector<FileFlag> all_files = {{"flagfile", &FLAGS_flagfile, FileUse::kInput}};
    all_files.insert(all_files.end(), files.begin(), files.end());
    const Status named = CheckFileFlags(all_files);
    if (!named.ok()) return EndOf(named, kExitWrongUsage);
    Status status = run();
    if (status.ok()) status = FlushStandardOutput();
    return status.ok() ? ProgramEnd() : EndOf(status, kExitBadInput);
  } catch (const std::bad_alloc&) {
    return {kExitBadInput, "the input needs more memory than there is"};
  } catch (const std::exception& error) {
    return {kExitBadInput, error.what()};
  }
}

}  // namespace

std::vector<gflags::CommandLineFlagInfo> ProgramFlags() {
  std::vector<gflags::CommandLineFlagInfo> all, of_main, shared;
  gflags::GetAllFlags(&all);
  for (gflags::CommandLineFlagInfo& flag : all) {
    const std::string stem = std::filesystem::path(flag.filename).stem().string();
    if (EndsWith(stem, "_main") || EndsWith(stem, "_program")) {
      of_main.push_back(std::move(flag));
    } else if (stem == "flags" || EndsWith(stem, "_flags")) {
      shared.push_back(std::move(flag));
    }
  }
  std::move(shared.begin(), shared.end(), std::back_inserter(of_main));
  return of_main;
}

std::string HelpText(const std::string& usage) {
  std::string text = usage + "\n\nFlags, with their defaults:\n";
  for (const gflags::CommandLineFlagInfo& flag : ProgramFlags()) {
    text += "  --" + flag.name + "=" + ReadableDefault(flag) + "\n      " + flag.description + "\n";
  }
  return text +
         "\nExit code: 0 done, 1 bad input, 2 wrong flags, 3 an output cannot be written, 129, 130 "
         "and 143 stopped by SIGHUP, SIGINT and SIGTERM.\n";
}

// std::exit is for programs without other threads, as at this moment all are.
// NOLINTBEGIN(concurrency-mt-unsafe)
void StartProgram(const std::string& usage, int argc, char** argv) {
  CatchSignals(argv[0]);
  FillClosedStreams();
  gflags::SetUsageMessage(usage);
  GFLAGS_NAMESPACE::gflags_exitfunc = [](int) { std::exit(kExitWrongUsage); };
  gflags::ParseCommandLineNonHelpFlags(&argc, &argv, /*remove_flags=*/true);
  if (FLAGS_help || FLAGS_helpshort || FLAGS_version) {
    std::cout << (FLAGS_version ? VersionText() : HelpText(usage));
    const Status printed = FlushStandardOutput();
    if (!printed.ok()) PrintFailure(printed.message());
    std::exit(printed.ok() ? kExitDone : kExitCannotWrite);
  }
  GFLAGS_NAMESPACE::gflags_exitfunc = [](int) { std::exit(kExitDone); };
  gflags::HandleCommandLineHelpFlags();  // the other kinds of help
  if (argc > 1) {
    PrintFailure("unexpected argument '" + std::string(argv[1]) + "'; see --help");
    std::exit(kExitWrongUsage);
  }
}
// NOLINTEND(concurrency-mt-unsafe)

int RunProgram(const std::vector<FileFlag>& files, const std::function<Status()>& check_flags,
               const std::function<Status()>& run) {
  const ProgramEnd end = RunQuietly(files, check_flags, run);
  if (!end.message.empty()) PrintFailure(end.message);
  return end.exit_code;
}

ProgramEnd RunQuietly(const std::vector<FileFlag>& files,
                      const std::function<Status()>& check_flags,
                      const std::function<Status()>& run) {
  ProgramEnd end = RunUnstopped(files, check_flags, run);
  end.exit_code = ExitCodeAfterStop(end.exit_code);
  return end;
}

void PrintWarnings(const std::vector<Warning>& warnings) {
  for (const Warning& warning : warnings) std::cerr << WarningLine(warning) << '\n';
}

void PrintFailure(const std::string& message) {
  std::cerr << gflags::ProgramInvocationShortName() << ": " << Legible(message) << '\n';
}

}  // namespace plumbline
