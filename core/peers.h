#ifndef PLUMBLINE_CORE_PEERS_H_
#define PLUMBLINE_CORE_PEERS_H_

#include <cstddef>
#include <vector>

namespace plumbline {

/// What a process has sent to its peers so far.
struct PeersTraffic {
  std::size_t num_sums = 0;      ///< calls of Sum
  std::size_t sum_bytes = 0;     ///< that went into them
  std::size_t num_messages = 0;  ///< of Exchange and Swap to other processes
  std::size_t message_bytes = 0;
  double time_s = 0.0;  ///< in these calls, waiting for others included

  PeersTraffic operator-(const PeersTraffic& before) const {
    return {num_sums - before.num_sums, sum_bytes - before.sum_bytes,
            num_messages - before.num_messages, message_bytes - before.message_bytes,
            time_s - before.time_s};
  }
};

/// The processes that work on one graph, each with some of its scans (SlamGraph::ShareWith), and
/// how they talk. All functions but rank(), size() and traffic() are collective: every process
/// calls the same ones in the same order, from one thread. They throw std::runtime_error where that
/// fails.
class Peers {
 public:
  virtual ~Peers() = default;

  /// Which one this process is, from 0.
  virtual int rank() const = 0;
  /// How many there are, this one included.
  virtual int size() const = 0;
  /// Of this process. Nothing where nobody counts it.
  virtual PeersTraffic traffic() const { return {}; }

  /// Replaces `count` values by their sums over all processes, the same bits everywhere and for
  /// every run with as many processes.
  virtual void Sum(double* values, std::size_t count) const = 0;

  /// Sends to_rank[r] to process r, and gives what the processes sent here, by rank. Both have
  /// size() elements; what a process sends to itself comes back.
  virtual std::vector<std::vector<char>> Exchange(
      const std::vector<std::vector<char>>& to_rank) const = 0;

  /// The same for numbers where each pair of processes sends each other as many: (*from_rank)[r]
  /// gets the size of to_rank[r]. What a process sends to itself does not matter.
  virtual void Swap(const std::vector<std::vector<double>>& to_rank,
                    std::vector<std::vector<double>>* from_rank) const = 0;

  /// Returns once all processes have called it. Unlike the others it takes no processor time where
  /// that may be long.
  virtual void WaitForAll() const = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_PEERS_H_
