#ifndef PLUMBLINE_CORE_PEERS_H_
#define PLUMBLINE_CORE_PEERS_H_

#include <cstddef>
#include <vector>

namespace plumbline {

/// The processes that work on one graph, each with some of its scans (SlamGraph::ShareWith), and
/// how they talk. All functions but rank() and size() are collective: every process calls the same
/// ones in the same order, from one thread. They throw std::runtime_error where that fails.
class Peers {
 public:
  virtual ~Peers() = default;

  /// Which one this process is, from 0.
  virtual int rank() const = 0;
  /// How many there are, this one included.
  virtual int size() const = 0;

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
