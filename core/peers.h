#ifndef PLUMBLINE_CORE_PEERS_H_
#define PLUMBLINE_CORE_PEERS_H_

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>
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
};

/// @{
/// Sums over all who work on a graph: SlamGraph::peers(), null where that is one process alone.
inline void SumOverPeers(const Peers* peers, std::vector<double>* values) {
  if (peers != nullptr) peers->Sum(values->data(), values->size());
}
inline double SumOverPeers(const Peers* peers, double value) {
  if (peers != nullptr) peers->Sum(&value, 1);
  return value;
}
/// @}

/// The largest value of all who work on a graph, likewise.
inline double MaxOverPeers(const Peers* peers, double value) {
  if (peers == nullptr) return value;
  const std::vector<std::vector<double>> to_rank(peers->size(), {value});
  std::vector<std::vector<double>> from_rank;
  peers->Swap(to_rank, &from_rank);
  for (int rank = 0; rank < peers->size(); ++rank) {
    if (rank != peers->rank()) value = std::max(value, from_rank[rank].front());
  }
  return value;
}

/// Peers::Exchange for values that can be copied byte by byte.
template <typename T>
std::vector<std::vector<T>> ExchangeValues(const Peers& peers,
                                           const std::vector<std::vector<T>>& to_rank) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<std::vector<char>> bytes(to_rank.size());
  for (std::size_t rank = 0; rank < bytes.size(); ++rank) {
    bytes[rank].resize(sizeof(T) * to_rank[rank].size());
    if (!bytes[rank].empty())
      std::memcpy(bytes[rank].data(), to_rank[rank].data(), bytes[rank].size());
  }
  bytes = peers.Exchange(bytes);
  std::vector<std::vector<T>> from_rank(bytes.size());
  for (std::size_t rank = 0; rank < bytes.size(); ++rank) {
    from_rank[rank].resize(bytes[rank].size() / sizeof(T));
    if (!bytes[rank].empty())
      std::memcpy(from_rank[rank].data(), bytes[rank].data(), bytes[rank].size());
    bytes[rank] = std::vector<char>();
  }
  return from_rank;
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_PEERS_H_
