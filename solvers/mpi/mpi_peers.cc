#include "plumbline/solvers/mpi/mpi_peers.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include "plumbline/core/seconds_since.h"

namespace plumbline {
namespace {

// MPI counts in int.
constexpr std::size_t kMaxCount = std::size_t{1} << 30;

void Check(int code, const char* what) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw std::runtime_error(std::string("MPI, ") + what + ": " + std::string(text, length));
}

// Adds the time until the end of a block.
class CallTimer {
 public:
  explicit CallTimer(PeersTraffic* traffic) : traffic_(*traffic) {}
  ~CallTimer() { traffic_.time_s += SecondsSince(start_); }
  CallTimer(const CallTimer&) = delete;
  CallTimer& operator=(const CallTimer&) = delete;

 private:
  PeersTraffic& traffic_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Sends and receives of one exchange, waited for together.
class Transfers {
 public:
  Transfers(MPI_Comm communicator, PeersTraffic* traffic)
      : communicator_(communicator), traffic_(*traffic) {}

  void Receive(char* bytes, std::size_t size, int rank) {
    ForEachPiece(size, [&](std::size_t begin, int count) {
      Check(MPI_Irecv(bytes + begin, count, MPI_BYTE, rank, 0, communicator_, Add()), "receiving");
    });
  }
  void Send(const char* bytes, std::size_t size, int rank) {
    traffic_.num_messages += size > 0 ? 1 : 0;
    traffic_.message_bytes += size;
    ForEachPiece(size, [&](std::size_t begin, int count) {
      Check(MPI_Isend(bytes + begin, count, MPI_BYTE, rank, 0, communicator_, Add()), "sending");
    });
  }
  void Wait() {
    Check(MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE),
          "waiting");
  }

 private:
  template <typename Body>
  static void ForEachPiece(std::size_t size, const Body& body) {
    for (std::size_t begin = 0; begin < size; begin += kMaxCount) {
      body(begin, static_cast<int>(std::min(kMaxCount, size - begin)));
    }
  }
  MPI_Request* Add() { return &requests_.emplace_back(MPI_REQUEST_NULL); }

  MPI_Comm communicator_;
  PeersTraffic& traffic_;
  std::vector<MPI_Request> requests_;
};

}  // namespace

MpiPeers::MpiPeers(MPI_Comm communicator) {
  Check(MPI_Comm_dup(communicator, &communicator_), "copying the communicator");
  Check(MPI_Comm_set_errhandler(communicator_, MPI_ERRORS_RETURN), "setting up");
  Check(MPI_Comm_rank(communicator_, &rank_), "setting up");
  Check(MPI_Comm_size(communicator_, &size_), "setting up");
}

MpiPeers::~MpiPeers() { MPI_Comm_free(&communicator_); }

void MpiPeers::Sum(double* values, std::size_t count) const {
  const CallTimer timer(&traffic_);
  ++traffic_.num_sums;
  traffic_.sum_bytes += sizeof(double) * count;
  for (std::size_t begin = 0; begin < count; begin += kMaxCount) {
    const int piece = static_cast<int>(std::min(kMaxCount, count - begin));
    Check(MPI_Allreduce(MPI_IN_PLACE, values + begin, piece, MPI_DOUBLE, MPI_SUM, communicator_),
          "adding up");
  }
}

std::vector<std::vector<char>> MpiPeers::Exchange(
    const std::vector<std::vector<char>>& to_rank) const {
  const CallTimer timer(&traffic_);
  std::vector<unsigned long long> sizes(size_), from_sizes(size_);
  for (int rank = 0; rank < size_; ++rank) sizes[rank] = to_rank[rank].size();
  Check(MPI_Alltoall(sizes.data(), 1, MPI_UNSIGNED_LONG_LONG, from_sizes.data(), 1,
                     MPI_UNSIGNED_LONG_LONG, communicator_),
        "exchanging sizes");
  std::vector<std::vector<char>> from_rank(size_);
  Transfers transfers(communicator_, &traffic_);
  for (int rank = 0; rank < size_; ++rank) {
    if (rank == rank_) continue;
    from_rank[rank].resize(from_sizes[rank]);
    transfers.Receive(from_rank[rank].data(), from_rank[rank].size(), rank);
  }
  for (int rank = 0; rank < size_; ++rank) {
    if (rank != rank_) transfers.Send(to_rank[rank].data(), to_rank[rank].size(), rank);
  }
  from_rank[rank_] = to_rank[rank_];
  transfers.Wait();
  return from_rank;
}

void MpiPeers::Swap(const std::vector<std::vector<double>>& to_rank,
                    std::vector<std::vector<double>>* from_rank) const {
  from_rank->resize(size_);
  const CallTimer timer(&traffic_);
  Transfers transfers(communicator_, &traffic_);
  for (int rank = 0; rank < size_; ++rank) {
    (*from_rank)[rank].resize(to_rank[rank].size());
    if (rank == rank_) continue;
    transfers.Receive(reinterpret_cast<char*>((*from_rank)[rank].data()),
                      sizeof(double) * to_rank[rank].size(), rank);
  }
  for (int rank = 0; rank < size_; ++rank) {
    if (rank == rank_) continue;
    transfers.Send(reinterpret_cast<const char*>(to_rank[rank].data()),
                   sizeof(double) * to_rank[rank].size(), rank);
  }
  transfers.Wait();
}

// A wait of MPI keeps a processor busy.
void MpiPeers::WaitForAll() const {
  constexpr std::chrono::milliseconds kLongestSleep{20};
  std::chrono::milliseconds sleep{0};
  MPI_Request request = MPI_REQUEST_NULL;
  Check(MPI_Ibarrier(communicator_, &request), "waiting");
  for (int all_are_here = 0;;) {
    Check(MPI_Test(&request, &all_are_here, MPI_STATUS_IGNORE), "waiting");
    if (all_are_here != 0) return;
    std::this_thread::sleep_for(sleep);
    sleep = std::min(kLongestSleep, sleep + std::chrono::milliseconds(1));
  }
}

}  // namespace plumbline
