#include "plumbline/solvers/landmarks/shared_landmarks.h"

#include <algorithm>
#include <utility>

namespace plumbline {

SharedLandmarks::SharedLandmarks(const Peers* peers, std::size_t num_landmarks,
                                 std::vector<std::vector<int>> of_rank)
    : peers_(peers),
      of_rank_(std::move(of_rank)),
      slot_of_landmark_(num_landmarks, int{kNotShared}) {
  for (const std::vector<int>& shared : of_rank_) {
    landmarks_.insert(landmarks_.end(), shared.begin(), shared.end());
  }
  std::sort(landmarks_.begin(), landmarks_.end());
  landmarks_.erase(std::unique(landmarks_.begin(), landmarks_.end()), landmarks_.end());
  for (std::size_t slot = 0; slot < landmarks_.size(); ++slot) {
    slot_of_landmark_[landmarks_[slot]] = static_cast<int>(slot);
  }
  rank_in_charge_.assign(landmarks_.size(), peers_->rank());
  for (int rank = peers_->rank(); rank-- > 0;) {
    for (const int landmark : of_rank_[rank]) rank_in_charge_[SlotOf(landmark)] = rank;
  }
}

std::size_t SharedLandmarks::NumCountedHere(std::size_t num_landmarks) const {
  std::size_t others = 0;
  for (std::size_t slot = 0; slot < landmarks_.size(); ++slot) {
    others += rank_in_charge_[slot] != peers_->rank() ? 1 : 0;
  }
  return num_landmarks - others;
}

}  // namespace plumbline
