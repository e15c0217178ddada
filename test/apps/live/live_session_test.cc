#include "plumbline/apps/live/live_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "plumbline/test/apps/live/simulated_robot.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const SimulatedRobot& SessionRobot() {
  static const SimulatedRobot robot;
  return robot;
}

// A session and its outputs.
class LiveSessionTest : public testing::Test {
 protected:
  static LiveSessionOptions Options() {
    LiveSessionOptions options;
    options.node.wait_for_background = true;
    options.map_update_interval_s = 0.05;
    return options;
  }

  LiveOutputs Outputs() {
    LiveOutputs outputs;
    outputs.update = [this](const LiveUpdate&) { Note([this] { ++num_updates_; }); };
    outputs.map = [this](const LiveMap& map) {
      Note([&] { map_stamps_s_.push_back(map.stamp_s); });
    };
    outputs.diagnostic = [this](const Diagnostic& diagnostic) { diagnostic_ = diagnostic; };
    outputs.news = [this](const std::string& line) { news_.push_back(line); };
    return outputs;
  }

  template <typename Change>
  void Note(const Change& change) {
    const std::lock_guard<std::mutex> lock(mutex_);
    change();
    changed_.notify_all();
  }
  // Waits up to a minute.
  template <typename Condition>
  bool WaitFor(const Condition& condition) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(1), condition);
  }

  void Execute(const LiveCommand& command) {
    session_.Execute(command, [this](const Status& status, const std::string& message) {
      Note([&] {
        replies_.push_back(message);
        num_failures_ += status.ok() ? 0 : 1;
      });
    });
  }
  void Send(int i) {
    session_.node().AddTransforms(SessionRobot().OdometryTransform(i));
    session_.node().AddScan(SessionRobot().Scan(i), LiveSession::NowS());
    session_.Wake();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  int num_updates_ = 0, num_failures_ = 0;
  std::vector<double> map_stamps_s_;
  std::vector<std::string> replies_, news_;
  Diagnostic diagnostic_;
  LiveSession session_{Options(), Outputs()};
};

TEST_F(LiveSessionTest, GivesUpdatesAndChangedMaps) {
  session_.node().AddTransforms(SessionRobot().StaticTransforms());
  session_.Start();
  for (int i = 0; i < 3; ++i) {
    Send(i);
    ASSERT_TRUE(WaitFor([&] { return num_updates_ == i + 1; }));
  }
  ASSERT_TRUE(WaitFor(
      [&] { return !map_stamps_s_.empty() && map_stamps_s_.back() == SessionRobot().StampS(2); }));
  // A session builds a map whenever it starts: once the final one, then the same again.
  session_.Stop();
  session_.Start();
  session_.Stop();
  const std::size_t num_maps = map_stamps_s_.size();
  session_.Start();
  session_.Stop();
  EXPECT_THAT(map_stamps_s_, SizeIs(num_maps));
}

TEST_F(LiveSessionTest, RefusesCommandsWhileItIsStopped) {
  Execute({"clear", "", false});
  EXPECT_THAT(replies_, ElementsAre("mapping has not been started"));
  session_.Start();
  Execute({"pause", "", true});
  ASSERT_TRUE(WaitFor([&] { return replies_.size() == 2; }));
  EXPECT_EQ(replies_.back(), "paused");
  EXPECT_EQ(session_.node().Report().state, "paused");
  session_.Stop();
  Execute({"pause", "", false});
  EXPECT_EQ(session_.node().Report().state, "paused");
  EXPECT_EQ(num_failures_, 2);
}

TEST_F(LiveSessionTest, AnswersEveryCommandWhenItStops) {
  session_.Start();
  constexpr int kNumCommands = 40;
  for (int i = 0; i < kNumCommands; ++i) Execute({"localize", "/nowhere/map.g2o", false});
  session_.Stop();
  EXPECT_THAT(replies_, SizeIs(kNumCommands));
  EXPECT_EQ(num_failures_, kNumCommands);
}

TEST_F(LiveSessionTest, ReportsFaultsOnce) {
  session_.node().AddFault("scans without a frame", "the first one");
  session_.Report();
  EXPECT_EQ(diagnostic_.level, DiagnosticLevel::kWarn);
  EXPECT_EQ(diagnostic_.message, "waiting for scans");
  session_.Report();
  EXPECT_EQ(diagnostic_.level, DiagnosticLevel::kOk);
  EXPECT_THAT(news_, ElementsAre("scans without a frame: the first one"));
}

TEST(LiveSessionOptionsTest, ChecksTheInterval) {
  LiveSessionOptions options;
  std::string error;
  EXPECT_TRUE(options.Check(&error));
  options.map_update_interval_s = 0.0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_THAT(error, HasSubstr("map_update_interval_s"));
}

}  // namespace
}  // namespace plumbline
