#ifndef PLUMBLINE_APPS_LIVE_LIVE_SESSION_H_
#define PLUMBLINE_APPS_LIVE_LIVE_SESSION_H_

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "plumbline/apps/live/diagnostic.h"
#include "plumbline/apps/live/live_map.h"
#include "plumbline/apps/live/live_node.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How a live session maps.
struct LiveSessionOptions {
  LiveOptions node;
  double map_update_interval_s = 5.0;  ///< from one map to the next [s]
  std::string map_file;                ///< a saved map to begin in; empty: a new one
  bool localize = false;  ///< in map_file, which stays as it is; otherwise the drive continues it

  bool Check(std::string* error) const;
};

/// A command to a live session.
struct LiveCommand {
  std::string name;   ///< of LiveServices
  std::string text;   ///< of save_map: the folder; of localize: the file
  bool flag = false;  ///< of pause
};

/// Receivers of the results of a live session. All but `news` are called from its threads.
struct LiveOutputs {
  std::function<void(const LiveUpdate&)> update;
  std::function<void(const LiveMap&)> map;  ///< whenever it has changed
  std::function<void(const Diagnostic&)> diagnostic;
  std::function<void(const std::string&)> news;  ///< lines for people
};

/// A LiveNode with the threads that map, build maps and execute commands. Knows no transport.
class LiveSession {
 public:
  /// Takes the answer of a command: its message for people is the error's if it has failed.
  using Reply = std::function<void(const Status&, const std::string& message)>;

  LiveSession(const LiveSessionOptions& options, LiveOutputs outputs);
  /// Stops.
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  /// Takes messages and reports. Call Wake after messages have been added.
  LiveNode& node() { return node_; }
  /// The clock for LiveNode::AddScan [s].
  static double NowS();
  /// Lets the session look at new messages at once. Otherwise it looks after 0.02 s.
  void Wake();

  /// Reads the saved map of the options, if there is one. Fails like ReadSavedMap.
  Status UseSavedMap();
  /// Starts the threads. Without effect if they run.
  void Start();
  /// Ends the threads. The command that is being executed is completed; others are refused. The map
  /// stays.
  void Stop();

  /// Queues a command, whose reply comes from a thread of the session. Replies at once with
  /// Unavailable if 16 commands are waiting or the threads do not run.
  void Execute(LiveCommand command, Reply reply);

  /// Gives a diagnostic and the news to the outputs; to be called once per second, by one thread at
  /// a time.
  void Report();

 private:
  struct Request {
    LiveCommand command;
    Reply reply;
  };

  template <typename Condition>
  bool Sleep(double time_s, const Condition& wakes);
  void RunWorker();
  void RunMapper();
  void RunCommander();
  Status Execute(const LiveCommand& command, std::string* message);
  Status SaveMap(const std::string& folder, std::string* message);
  void AddAlarms(Diagnostic* diagnostic);

  const LiveSessionOptions options_;
  const LiveOutputs outputs_;
  LiveNode node_;
  std::size_t num_reported_faults_ = 0;  // of Report
  std::set<std::string> told_alarms_;    // of Report
  std::vector<std::thread> threads_;

  std::mutex mutex_;
  std::condition_variable wake_up_;
  bool is_running_ = false;
  bool has_work_ = false;  // the worker has not looked since messages came
  std::deque<Request> requests_;
  LiveMap last_map_;  // the map that was given to the outputs last
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_LIVE_SESSION_H_
