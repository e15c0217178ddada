#ifndef PLUMBLINE_TEST_APPS_RUNNING_PROGRAM_H_
#define PLUMBLINE_TEST_APPS_RUNNING_PROGRAM_H_

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {

/// A program that runs beside the test, to be sent signals. Its standard output and standard error
/// go to a file. Ends with the test.
class RunningProgram {
 public:
  RunningProgram(const std::vector<std::string>& command, std::string output)
      : output_(std::move(output)) {
    WriteFile(output_, "");
    std::vector<char*> arguments;
    for (const std::string& argument : command) {
      arguments.push_back(const_cast<char*>(argument.c_str()));
    }
    arguments.push_back(nullptr);
    process_ = fork();
    if (process_ != 0) return;
    const int descriptor = open(output_.c_str(), O_WRONLY | O_APPEND);
    dup2(descriptor, STDOUT_FILENO);
    dup2(descriptor, STDERR_FILENO);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  ~RunningProgram() {
    if (process_ <= 0) return;
    Send(SIGKILL);
    Wait();
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Whether the program prints a text before it ends, or a minute passes.
  bool Prints(const std::string& text) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (std::chrono::steady_clock::now() < end) {
      const bool has_ended = HasEnded();
      if (ReadFile(output_).find(text) != std::string::npos) return true;
      if (has_ended) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  /// Whether the program ends before a time passes [s].
  bool EndsWithin(double time_s) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_s);
    while (std::chrono::steady_clock::now() < end) {
      if (HasEnded()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  /// Whether the program comes to handle a signal before it ends, or a minute passes. Linux only.
  bool Catches(int signal_number) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (std::chrono::steady_clock::now() < end) {
      std::ifstream status("/proc/" + std::to_string(process_) + "/status");
      for (std::string line; std::getline(status, line);) {
        if (line.rfind("State:\tZ", 0) == 0) return false;
        if (line.rfind("SigCgt:", 0) != 0) continue;
        if (std::stoull(line.substr(7), nullptr, 16) >> (signal_number - 1) & 1) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  int process() const { return process_; }
  void Send(int signal_number) const { kill(process_, signal_number); }

  /// Exit code; 1000 and the number of the signal that ended it.
  int Wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

 private:
  bool HasEnded() const {
    siginfo_t info{};
    waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT);
    return info.si_pid == process_;
  }

  std::string output_;
  pid_t process_ = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_RUNNING_PROGRAM_H_
