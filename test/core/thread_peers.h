#ifndef PLUMBLINE_TEST_CORE_THREAD_PEERS_H_
#define PLUMBLINE_TEST_CORE_THREAD_PEERS_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "plumbline/core/peers.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Threads that stand for the processes of Peers.
class ThreadPeers final : public Peers {
 public:
  /// What the threads have in common.
  struct Table {
    explicit Table(int size) : bytes(size), numbers(size) {}

    void Meet() {
      std::unique_lock<std::mutex> lock(mutex);
      const int meeting = num_meetings;
      if (++num_here == static_cast<int>(bytes.size())) {
        num_here = 0;
        ++num_meetings;
        all_here.notify_all();
      }
      all_here.wait(lock, [&] { return num_meetings != meeting; });
    }

    std::mutex mutex;
    std::condition_variable all_here;
    int num_here = 0, num_meetings = 0;
    std::vector<const std::vector<std::vector<char>>*> bytes;      // sent, by rank
    std::vector<const std::vector<std::vector<double>>*> numbers;  // likewise
  };

  ThreadPeers(Table* table, int rank) : table_(*table), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(table_.bytes.size()); }

  void Sum(double* values, std::size_t count) const override {
    std::vector<std::vector<double>> all;
    Swap(std::vector<std::vector<double>>(size(), {values, values + count}), &all);
    std::fill(values, values + count, 0.0);
    for (const std::vector<double>& of_rank : all) {
      for (std::size_t i = 0; i < count; ++i) values[i] += of_rank[i];
    }
  }

  std::vector<std::vector<char>> Exchange(
      const std::vector<std::vector<char>>& to_rank) const override {
    return Trade(to_rank, &table_.bytes);
  }

  void Swap(const std::vector<std::vector<double>>& to_rank,
            std::vector<std::vector<double>>* from_rank) const override {
    *from_rank = Trade(to_rank, &table_.numbers);
  }

  void WaitForAll() const override { table_.Meet(); }

 private:
  template <typename T>
  std::vector<std::vector<T>> Trade(const std::vector<std::vector<T>>& to_rank,
                                    std::vector<const std::vector<std::vector<T>>*>* sent) const {
    (*sent)[rank_] = &to_rank;
    table_.Meet();
    std::vector<std::vector<T>> from_rank;
    for (const auto* of_rank : *sent) from_rank.push_back((*of_rank)[rank_]);
    table_.Meet();
    return from_rank;
  }

  Table& table_;
  int rank_;
};

/// Calls body(peers) on so many threads at once.
inline void RunOnPeers(int size, const std::function<void(const Peers&)>& body) {
  ThreadPeers::Table table(size);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < size; ++rank) {
    threads.emplace_back([&table, &body, rank] { body(ThreadPeers(&table, rank)); });
  }
  for (std::thread& thread : threads) thread.join();
}

/// The same with the part of a graph that each of them has, divided at its initial poses.
inline void RunOnParts(const SlamGraph& whole, int size,
                       const std::function<void(const SlamGraph& part)>& body) {
  RunOnPeers(size, [&](const Peers& peers) {
    SlamGraph part;
    if (peers.rank() == 0) part = whole;
    ASSERT_TRUE(ShareGraphByPlace(&peers, whole.initial_poses(), &part).ok());
    body(part);
  });
}

/// Of a state of the whole graph, the poses and the points of a part.
inline MapState PartOf(const SlamGraph& part, const MapState& whole) {
  MapState state;
  state.poses = whole.poses;
  for (std::size_t r = 0; r < part.num_returns(); ++r) {
    const std::size_t among_all = part.ReturnIdAmongAll(r);
    state.points.push_back(whole.points[2 * among_all]);
    state.points.push_back(whole.points[2 * among_all + 1]);
  }
  return state;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_CORE_THREAD_PEERS_H_
