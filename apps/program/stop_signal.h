#ifndef PLUMBLINE_APPS_PROGRAM_STOP_SIGNAL_H_
#define PLUMBLINE_APPS_PROGRAM_STOP_SIGNAL_H_

#include <functional>
#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// Lets a program come to an end in order when it is told to stop, by Ctrl-C (SIGINT), SIGTERM, or
/// the end of its terminal (SIGHUP). As long as there is nothing to write, which is so at first,
/// such a signal ends the program: it says "NAME: stopped by SIGINT while starting: nothing is
/// written" on standard error and exits with 128 and the number of the signal. Later, see
/// KeepStopSignal, the first signal is kept for the program to ask about, and the second one ends
/// it. A program that a signal ends deletes its temporary files. A signal that the caller has
/// switched off, as nohup does, stays off. To be called first of all, with argv[0].
///
/// A file that grows beyond the limit that the system sets becomes an error of its writer, instead
/// of a signal (SIGXFSZ) that ends the program.
void CatchSignals(const std::string& program);

/// For one process of several that a launcher ends together, and says so: a stop signal ends it
/// without a word, also where it would be kept, and deletes its temporary files. To be called again
/// after a library has handled signals.
void EndOnEveryStopSignal();

/// For a child of a program that catches signals: one that stops it just ends it.
void LeaveStopSignalsToParent();

/// Names what the program does from now on, "reading a.clf", with nothing to write yet: a stop
/// signal, also one that was kept before, ends the program as above. It removes those of the
/// folders that are empty, in their order.
void EndIfStoppedWhile(const std::string& activity, const std::vector<std::string>& folders = {});

/// The same for a program that writes its files now, one by one: those that are complete stay, and
/// the line on standard error says "while writing: no file is half-written".
void EndIfStoppedWhileWriting(const std::vector<std::string>& folders = {});

/// From now on there is something to write: the first stop signal says on standard error that it
/// was heard, and is kept.
void KeepStopSignal();

/// Number of the signal that told the program to stop; 0 if none did.
int StopSignal();

/// "SIGINT", "SIGTERM" or "SIGHUP"; empty if nothing told the program to stop.
std::string StopSignalName();

/// A line for people: a signal of this name has ended the estimation early. Empty without a name.
std::string StopText(const std::string& signal_name);

/// Calls `write`, which writes the last results, with StopSignalName(), and once more if a signal
/// came meanwhile. After that signals no longer change what the program returns: a first one is
/// ignored.
Status WriteWithStopSignal(const std::function<Status(const std::string& signal_name)>& write);

/// What shells expect of a program that a signal has stopped, 128 and its number; `exit_code` if
/// none did.
int ExitCodeAfterStop(int exit_code);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_STOP_SIGNAL_H_
