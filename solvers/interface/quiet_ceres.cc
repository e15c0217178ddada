#include "plumbline/solvers/interface/quiet_ceres.h"

#include <ceres/iteration_callback.h>
#include <glog/logging.h>

#include <algorithm>
#include <mutex>
#include <vector>

// True after google::InitGoogleLogging. glog 0.6 and later have the first, glog 0.4 of Ubuntu 22.04
// exports the second. Weak: null if the installed glog does not have it.
namespace google {
[[gnu::weak]] bool IsGoogleLoggingInitialized();
namespace glog_internal_namespace_ {
[[gnu::weak]] bool IsGoogleLoggingInitialized();
}  // namespace glog_internal_namespace_
}  // namespace google

namespace plumbline {
namespace {

// True if the host decides where log lines go, or if this glog cannot say.
bool HostHasInitializedGlog() {
  if (google::IsGoogleLoggingInitialized != nullptr) return google::IsGoogleLoggingInitialized();
  const auto internal = google::glog_internal_namespace_::IsGoogleLoggingInitialized;
  return internal == nullptr || internal();
}

std::mutex mute_mutex;
int num_mutes = 0;   // solves that run, unless in a callback
int host_level = 0;  // FLAGS_minloglevel before the first of them

// Suppresses log lines below FATAL while it exists, unless the host has initialised glog.
//
// Ceres logs many failures whatever Solver::Options::logging_type is: failed linear solvers and
// evaluations, restarts of conjugate gradients, large BFGS problems. glog filters lines by level,
// not by file or thread, and an uninitialised glog looks at no other flag. Host lines of other
// threads are therefore lost, too. An initialised glog is left alone: a gap in the host's log would
// cost more than a few lines of Ceres in it.
class GlogMute {
 public:
  GlogMute() { Begin(); }
  ~GlogMute() { End(); }
  GlogMute(const GlogMute&) = delete;
  GlogMute& operator=(const GlogMute&) = delete;

  void Begin() {
    is_counted_ = !HostHasInitializedGlog();
    if (!is_counted_) return;
    const std::lock_guard<std::mutex> lock(mute_mutex);
    if (num_mutes++ > 0) return;
    host_level = FLAGS_minloglevel;
    FLAGS_minloglevel = std::max<int>(host_level, google::GLOG_FATAL);
  }

  void End() {
    if (!is_counted_) return;
    const std::lock_guard<std::mutex> lock(mute_mutex);
    // Another level is one that the host has set in the meantime.
    if (--num_mutes == 0 && FLAGS_minloglevel == google::GLOG_FATAL) FLAGS_minloglevel = host_level;
  }

 private:
  bool is_counted_ = false;
};

// Lets the host log in its callback.
class LoudCallback final : public ceres::IterationCallback {
 public:
  LoudCallback(ceres::IterationCallback* callback, GlogMute* mute)
      : callback_(callback), mute_(mute) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    mute_->End();
    const MuteAgain mute_again{mute_};
    return (*callback_)(iteration);
  }

 private:
  struct MuteAgain {
    ~MuteAgain() { mute->Begin(); }
    GlogMute* mute;
  };

  ceres::IterationCallback* callback_;
  GlogMute* mute_;
};

}  // namespace

void SolveQuietly(ceres::Solver::Options options, ceres::Problem* problem,
                  ceres::Solver::Summary* summary) {
  options.logging_type = ceres::SILENT;
  GlogMute mute;
  std::vector<LoudCallback> callbacks;
  callbacks.reserve(options.callbacks.size());
  for (ceres::IterationCallback*& callback : options.callbacks) {
    callbacks.emplace_back(callback, &mute);
    callback = &callbacks.back();
  }
  ceres::Solve(options, problem, summary);
}

}  // namespace plumbline
