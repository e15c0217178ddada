#ifndef PLUMBLINE_TEST_CORE_THREAD_PEERS_H_
#define PLUMBLINE_TEST_CORE_THREAD_PEERS_H_

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "plumbline/core/peers.h"

namespace plumbline {

/// Threads in the place of processes, so that what peers do can be tested without MPI.
class ThreadPeers final : public Peers {
 public:
  /// Calls body(peers) once per rank, each on a thread of its own, and returns when all have.
  static void Run(int num_ranks, const std::function<void(const Peers& peers)>& body) {
    Room room(num_ranks);
    std::vector<std::thread> threads;
    for (int rank = 0; rank < num_ranks; ++rank) {
      threads.emplace_back([&room, &body, rank] { body(ThreadPeers(rank, &room)); });
    }
    for (std::thread& thread : threads) thread.join();
  }

  int rank() const override { return rank_; }
  int size() const override { return room_.num_ranks; }

  void Sum(double* values, std::size_t count) const override {
    room_.values[rank_].assign(values, values + count);
    room_.Wait();
    for (std::size_t i = 0; i < count; ++i) values[i] = 0.0;
    for (const std::vector<double>& of_rank : room_.values) {
      for (std::size_t i = 0; i < count; ++i) values[i] += of_rank.at(i);
    }
    room_.Wait();
  }

  std::vector<std::vector<char>> Exchange(
      const std::vector<std::vector<char>>& to_rank) const override {
    room_.bytes[rank_] = to_rank;
    room_.Wait();
    std::vector<std::vector<char>> from_rank;
    for (const auto& of_rank : room_.bytes) from_rank.push_back(of_rank.at(rank_));
    room_.Wait();
    return from_rank;
  }

  void Swap(const std::vector<std::vector<double>>& to_rank,
            std::vector<std::vector<double>>* from_rank) const override {
    room_.numbers[rank_] = to_rank;
    room_.Wait();
    from_rank->resize(room_.num_ranks);
    bool is_mutual = true;
    for (int rank = 0; rank < room_.num_ranks; ++rank) {
      (*from_rank)[rank] = room_.numbers[rank].at(rank_);
      is_mutual = is_mutual && (*from_rank)[rank].size() == to_rank[rank].size();
    }
    room_.Wait();
    if (!is_mutual) throw std::runtime_error("processes swap different numbers of values");
  }

 private:
  struct Room {
    explicit Room(int num) : num_ranks(num), values(num), bytes(num), numbers(num) {}

    // Until all ranks are here.
    void Wait() {
      std::unique_lock<std::mutex> lock(mutex);
      const std::size_t round = num_rounds;
      if (++num_here == num_ranks) {
        num_here = 0;
        ++num_rounds;
        all_here.notify_all();
      } else {
        all_here.wait(lock, [&] { return num_rounds != round; });
      }
    }

    const int num_ranks;
    std::vector<std::vector<double>> values;
    std::vector<std::vector<std::vector<char>>> bytes;
    std::vector<std::vector<std::vector<double>>> numbers;
    std::mutex mutex;
    std::condition_variable all_here;
    int num_here = 0;
    std::size_t num_rounds = 0;
  };

  ThreadPeers(int rank, Room* room) : rank_(rank), room_(*room) {}

  const int rank_;
  Room& room_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_CORE_THREAD_PEERS_H_
