#ifndef PLUMBLINE_CORE_OVER_PEERS_H_
#define PLUMBLINE_CORE_OVER_PEERS_H_

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "plumbline/core/peers.h"
#include "plumbline/core/status.h"

namespace plumbline {

// What is true of all processes that work on one graph. All of it but SpeaksForAll and OwnShare is
// collective, as Peers has it, and says of a graph without peers what it says of itself.

/// Whether this process does what one of them has to do for all.
inline bool SpeaksForAll(const Peers* peers) { return peers == nullptr || peers->rank() == 0; }

/// Replaces numbers, below 2^53 if they are integers, by their sums over all processes.
template <typename T>
void SumOverPeers(const Peers* peers, std::vector<T>* values) {
  if (peers == nullptr) return;
  constexpr std::size_t kPiece = 1 << 20;
  std::vector<double> sums;
  for (std::size_t begin = 0; begin < values->size(); begin += kPiece) {
    const auto first = values->begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = first + static_cast<std::ptrdiff_t>(std::min(kPiece, values->size() - begin));
    sums.assign(first, last);
    peers->Sum(sums.data(), sums.size());
    std::transform(sums.begin(), sums.end(), first, [](double sum) { return static_cast<T>(sum); });
  }
}

/// The sum of a number over all processes.
inline double SumOverPeers(const Peers* peers, double value) {
  if (peers != nullptr) peers->Sum(&value, 1);
  return value;
}

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

/// Peers::Exchange for values that are sent byte by byte: numbers, and structs of numbers, of other
/// such structs and of Eigen matrices of fixed size. (These have copy constructors of their own,
/// but hold nothing except their coefficients.)
template <typename T>
std::vector<std::vector<T>> ExchangeValues(const Peers& peers,
                                           const std::vector<std::vector<T>>& to_rank) {
  static_assert(std::is_trivially_destructible_v<T>);
  std::vector<std::vector<char>> bytes(to_rank.size());
  for (std::size_t rank = 0; rank < bytes.size(); ++rank) {
    bytes[rank].resize(sizeof(T) * to_rank[rank].size());
    if (!bytes[rank].empty()) {
      const void* values = to_rank[rank].data();
      std::memcpy(bytes[rank].data(), values, bytes[rank].size());
    }
  }
  bytes = peers.Exchange(bytes);
  std::vector<std::vector<T>> from_rank(bytes.size());
  for (std::size_t rank = 0; rank < bytes.size(); ++rank) {
    from_rank[rank].resize(bytes[rank].size() / sizeof(T));
    if (!bytes[rank].empty()) {
      void* values = from_rank[rank].data();
      std::memcpy(values, bytes[rank].data(), bytes[rank].size());
    }
    bytes[rank] = std::vector<char>();
  }
  return from_rank;
}

/// What all processes have, by rank, one after the other: values as ExchangeValues takes them.
template <typename T>
std::vector<T> JoinOverPeers(const Peers* peers, std::vector<T> own) {
  if (peers == nullptr) return own;
  std::vector<T> joined;
  for (const std::vector<T>& part :
       ExchangeValues(*peers, std::vector<std::vector<T>>(peers->size(), own))) {
    joined.insert(joined.end(), part.begin(), part.end());
  }
  return joined;
}

/// Which ones of `count` tasks this process does where all do as many: every so many-th.
std::vector<std::size_t> OwnShare(const Peers* peers, std::size_t count);

/// The failure of the first process that fails, in all of them; Ok if none does. All processes come
/// here with what they have found out; those that are early sleep.
Status FirstFailure(const Peers* peers, const Status& own);

/// What the speaker does for all gives its Status in all of them.
template <typename Task>
Status BySpeaker(const Peers* peers, const Task& task) {
  return FirstFailure(peers, SpeaksForAll(peers) ? task() : Status::Ok());
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_OVER_PEERS_H_
