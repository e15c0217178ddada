#ifndef PLUMBLINE_SOLVERS_LANDMARKS_SHARED_LANDMARKS_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_SHARED_LANDMARKS_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/peers.h"

namespace plumbline {

/// The landmarks that other processes know as well, of a graph whose scans lie in several: each
/// sees what its own poses observed of them. Empty for a graph that is not shared.
class SharedLandmarks {
 public:
  static constexpr int kNotShared = -1;

  SharedLandmarks() = default;
  /// of_rank: per peer, the landmarks that it shares with this process, ascending; both have them
  /// in the same order.
  SharedLandmarks(const Peers* peers, std::size_t num_landmarks,
                  std::vector<std::vector<int>> of_rank);

  /// Null if no graph is shared.
  const Peers* peers() const { return peers_; }
  /// The shared ones, ascending.
  const std::vector<int>& landmarks() const { return landmarks_; }
  /// Those that a peer shares with this process, ascending; the peer has them in the same order.
  const std::vector<int>& SharedWith(int rank) const { return of_rank_[rank]; }
  /// Index into landmarks(), kNotShared for others.
  int SlotOf(std::size_t landmark) const {
    return slot_of_landmark_.empty() ? kNotShared : slot_of_landmark_[landmark];
  }
  /// The lowest rank of those who share it: it answers for what is to be counted once.
  int RankInCharge(int slot) const { return rank_in_charge_[slot]; }
  /// Whether this process answers for a landmark.
  bool IsCountedHere(std::size_t landmark) const {
    const int slot = SlotOf(landmark);
    return slot == kNotShared || rank_in_charge_[slot] == peers_->rank();
  }
  /// How many of the landmarks this process answers for.
  std::size_t NumCountedHere(std::size_t num_landmarks) const;

  /// The sums over all who share a landmark of what own(landmark) gives, per slot: the same bits
  /// for all of them. Collective, unless no graph is shared.
  template <int kSize, typename Own>
  std::vector<Eigen::Matrix<double, kSize, 1>> Sum(const Own& own) const {
    using Value = Eigen::Matrix<double, kSize, 1>;
    if (peers_ == nullptr) return {};
    std::vector<Value> own_values(landmarks_.size()), sums(landmarks_.size(), Value::Zero());
    for (std::size_t slot = 0; slot < landmarks_.size(); ++slot) {
      own_values[slot] = own(static_cast<std::size_t>(landmarks_[slot]));
    }
    std::vector<std::vector<double>> to_rank(of_rank_.size()), from_rank;
    for (std::size_t rank = 0; rank < of_rank_.size(); ++rank) {
      to_rank[rank].reserve(kSize * of_rank_[rank].size());
      for (const int landmark : of_rank_[rank]) {
        const Value& value = own_values[SlotOf(landmark)];
        to_rank[rank].insert(to_rank[rank].end(), value.data(), value.data() + kSize);
      }
    }
    peers_->Swap(to_rank, &from_rank);
    for (int rank = 0; rank < peers_->size(); ++rank) {
      if (rank == peers_->rank()) {
        for (std::size_t slot = 0; slot < sums.size(); ++slot) sums[slot] += own_values[slot];
        continue;
      }
      for (std::size_t i = 0; i < of_rank_[rank].size(); ++i) {
        sums[SlotOf(of_rank_[rank][i])] += Eigen::Map<const Value>(&from_rank[rank][kSize * i]);
      }
    }
    return sums;
  }

 private:
  const Peers* peers_ = nullptr;
  std::vector<std::vector<int>> of_rank_;
  std::vector<int> landmarks_;
  std::vector<int> slot_of_landmark_;
  std::vector<int> rank_in_charge_;  // per slot
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_SHARED_LANDMARKS_H_
