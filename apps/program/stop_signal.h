#ifndef PLUMBLINE_APPS_PROGRAM_STOP_SIGNAL_H_
#define PLUMBLINE_APPS_PROGRAM_STOP_SIGNAL_H_

#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Lets a program come to an end in order when it is told to stop, by Ctrl-C (SIGINT) or SIGTERM:
/// the first such signal is kept for the program to ask about, the second one ends it at once. A
/// signal that the caller has switched off, as nohup does, stays off.
///
/// A file that grows beyond the limit that the system sets becomes an error of its writer, instead
/// of a signal (SIGXFSZ) that ends the program.
void CatchSignals();

/// Number of the signal that told the program to stop; 0 if none did.
int StopSignal();

/// "SIGINT" or "SIGTERM"; empty if nothing told the program to stop.
std::string StopSignalName();

/// A line for people: a signal of this name has ended the estimation early.
std::string StopText(const std::string& signal_name);

/// Unavailable if a signal told the program to stop during a stage, of this name, that comes before
/// there is anything to write.
Status StoppedDuring(const std::string& stage);

/// What shells expect of a program that a signal has stopped, 128 and its number; `exit_code` if
/// none did.
int ExitCodeAfterStop(int exit_code);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_STOP_SIGNAL_H_
