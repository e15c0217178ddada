#include "plumbline/apps/run/write_tasks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class WriteTasksTest : public testing::Test {
 protected:
  WriteTask Fine() {
    return ByOne([this] {
      ++num_done_;
      return Status::Ok();
    });
  }
  static WriteTask Failing(const char* message) {
    return ByOne([message] { return Status::NotFound(message); });
  }

  std::atomic<int> num_done_{0};
};

TEST_F(WriteTasksTest, AnErrorOfOneTaskLetsTheOthersEnd) {
  ThreadPool pool(2);
  const Status status =
      RunAll({Fine(), Failing("first"), Fine(), Failing("second"), Fine()}, &pool);
  EXPECT_EQ(status.message(), "first");
  EXPECT_EQ(num_done_, 3);
}

TEST_F(WriteTasksTest, WhatATaskThrowsIsAnError) {
  const OwnTask no_memory = []() -> Status { throw std::bad_alloc(); };
  for (const WriteTask& throwing : {ByOne(no_memory), Together(no_memory)}) {
    for (const int num_threads : {1, 3}) {
      num_done_ = 0;
      ThreadPool pool(num_threads);
      const Status status = RunAll({Fine(), throwing, Fine(), Fine()}, &pool);
      EXPECT_EQ(status.code(), StatusCode::kUnavailable);
      EXPECT_THAT(status.message(), HasSubstr("out of memory"));
      EXPECT_EQ(num_done_, 3);
    }
  }
}

TEST_F(WriteTasksTest, WhatWasNotGatheredIsNotWritten) {
  const WriteTask task = [this](int, OwnTask* rest) {
    *rest = [this] {
      ++num_done_;
      return Status::Ok();
    };
    return Status::DataLoss("nothing there");
  };
  ThreadPool pool(1);
  EXPECT_EQ(RunAll({task}, &pool).code(), StatusCode::kDataLoss);
  RunOnPeers(2, [&](const Peers& peers) {
    ThreadPool one(1);
    EXPECT_EQ(RunAll({task}, &one, &peers).code(), StatusCode::kDataLoss);
  });
  EXPECT_EQ(num_done_, 0);
}

TEST_F(WriteTasksTest, ProcessesTakeTurnsInWritingAndGatherTogether) {
  std::mutex mutex;
  std::vector<std::pair<std::string, int>> written;   // file, process
  std::vector<std::pair<std::string, int>> gathered;  // file, process that it was gathered for
  RunOnPeers(2, [&](const Peers& peers) {
    const auto note = [&](std::vector<std::pair<std::string, int>>* notes, const std::string& file,
                          int process) {
      const std::lock_guard<std::mutex> lock(mutex);
      notes->emplace_back(file, process);
      return Status::Ok();
    };
    const auto picture = [&](const std::string& file) -> WriteTask {
      return [&, file](int writer, OwnTask* rest) {
        if (peers.rank() == 0) {
          EXPECT_TRUE(note(&gathered, file, writer).ok());
        }
        *rest = [&, file] { return note(&written, file, peers.rank()); };
        return Status::Ok();
      };
    };
    const WriteTask points = Together([&] { return note(&written, "points", peers.rank()); });
    ThreadPool pool(1);
    EXPECT_TRUE(RunAll({picture("a"), points, picture("b"), picture("c")}, &pool, &peers).ok());
  });
  EXPECT_THAT(gathered, ElementsAre(std::pair("a", 0), std::pair("b", 1), std::pair("c", 0)));
  EXPECT_THAT(written, UnorderedElementsAre(std::pair("a", 0), std::pair("b", 1), std::pair("c", 0),
                                            std::pair("points", 0), std::pair("points", 1)));
}

TEST_F(WriteTasksTest, AllProcessesLearnOfTheErrorOfOne) {
  RunOnPeers(3, [&](const Peers& peers) {
    ThreadPool pool(1);
    EXPECT_THAT(RunAll({Fine(), Failing("of process 1"), Fine()}, &pool, &peers).message(),
                HasSubstr("of process 1"));
  });
  EXPECT_EQ(num_done_, 2);
}

}  // namespace
}  // namespace plumbline
