#ifndef PLUMBLINE_SOLVERS_MPI_MPI_PEERS_H_
#define PLUMBLINE_SOLVERS_MPI_MPI_PEERS_H_

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "plumbline/core/peers.h"

namespace plumbline {

/// The processes of an MPI communicator. MPI has to be initialised before and finalised after.
class MpiPeers final : public Peers {
 public:
  /// Talks over a copy of the communicator. Throws std::runtime_error where MPI fails, as all
  /// functions do.
  explicit MpiPeers(MPI_Comm communicator);
  ~MpiPeers() override;
  MpiPeers(const MpiPeers&) = delete;
  MpiPeers& operator=(const MpiPeers&) = delete;

  MPI_Comm communicator() const { return communicator_; }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  PeersTraffic traffic() const override { return traffic_; }
  void Sum(double* values, std::size_t count) const override;
  std::vector<std::vector<char>> Exchange(
      const std::vector<std::vector<char>>& to_rank) const override;
  void Swap(const std::vector<std::vector<double>>& to_rank,
            std::vector<std::vector<double>>* from_rank) const override;
  void WaitForAll() const override;

 private:
  MPI_Comm communicator_ = MPI_COMM_NULL;
  int rank_ = 0;
  int size_ = 1;
  mutable PeersTraffic traffic_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_MPI_MPI_PEERS_H_
