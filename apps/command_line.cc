#include "plumbline/apps/command_line.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>

DECLARE_bool(help);
DECLARE_bool(helpshort);

namespace plumbline {
namespace {

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

}  // namespace

std::vector<gflags::CommandLineFlagInfo> ProgramFlags() {
  std::vector<gflags::CommandLineFlagInfo> all, of_main, shared;
  gflags::GetAllFlags(&all);
  for (gflags::CommandLineFlagInfo& flag : all) {
    const std::string stem = std::filesystem::path(flag.filename).stem().string();
    if (EndsWith(stem, "_main")) {
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
  return text;
}

void ParseCommandLine(const std::string& usage, int argc, char** argv) {
  gflags::SetUsageMessage(usage);
  gflags::ParseCommandLineNonHelpFlags(&argc, &argv, /*remove_flags=*/true);
  if (FLAGS_help || FLAGS_helpshort) {
    std::cout << HelpText(usage);
    std::exit(0);
  }
  gflags::HandleCommandLineHelpFlags();
  if (argc > 1) {
    std::cerr << gflags::ProgramInvocationShortName() << ": unexpected argument '" << argv[1]
              << "'; see --help\n";
    std::exit(1);
  }
}

}  // namespace plumbline
