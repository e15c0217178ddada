#include "plumbline/apps/run/array_storage.h"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <thread>

#include "plumbline/apps/program/disk_arrays.h"
#include "plumbline/apps/program/heap.h"

namespace plumbline {
namespace {

constexpr std::size_t kLargeBytes = 1 << 20;
// Shares of the limit. Arrays stay in memory as long as the process has less than the first; pages
// of the others are let go where it has more than the second: it goes on while that happens.
constexpr double kShareOfMemory = 1.0 / 3.0, kShareAtMost = 0.75;
// A process that holds too much all the same is to get on nevertheless.
constexpr double kShareOfPages = 0.125;

struct Resident {
  double total;     // [bytes]
  double unshared;  // of that, what is in no file [bytes]
};

// What the process holds, as the system says in /proc.
class ResidentMemory {
 public:
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
  ResidentMemory() : file_(open("/proc/self/statm", O_RDONLY | O_CLOEXEC)) {}

  Resident Read() const {
    std::array<char, 128> text{};
    if (pread(file_, text.data(), text.size() - 1, 0) <= 0) return {0.0, 0.0};
    char* end = text.data();
    std::strtoull(end, &end, 10);  // of its addresses
    const auto resident = static_cast<double>(std::strtoull(end, &end, 10));
    const auto in_files = static_cast<double>(std::strtoull(end, &end, 10));
    return {page_bytes_ * resident, page_bytes_ * (resident - in_files)};
  }

 private:
  int file_;
  double page_bytes_ = static_cast<double>(sysconf(_SC_PAGESIZE));
};

// Lives as long as the process: arrays are freed until its end.
class ArrayStorage {
 public:
  explicit ArrayStorage(double max_memory) : max_memory_(max_memory) {}

  Status Open(const std::string& folder) { return disk_.Open(folder); }
  double BytesOfDisk() const { return disk_.BytesFree(); }

  bool HasRoomInMemory(std::size_t num_bytes) const {
    return resident_.Read().unshared + static_cast<double>(num_bytes) <=
           kShareOfMemory * max_memory_;
  }

  void* Add(std::size_t num_bytes) { return disk_.Add(num_bytes); }
  bool Remove(void* array) { return disk_.Remove(array); }

  [[noreturn]] void Watch() {
    double most = kShareAtMost * max_memory_;
    for (;;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (resident_.Read().total <= most) continue;
      disk_.MakeRoom();
      most = std::max(kShareAtMost * max_memory_,
                      resident_.Read().total + kShareOfPages * max_memory_);
    }
  }

 private:
  const double max_memory_;
  const ResidentMemory resident_;
  DiskArrays disk_;
};

std::atomic<ArrayStorage*> storage{nullptr};

// A thread that takes no signals, which are for the program's own.
void StartWatching(ArrayStorage* watched) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread([watched] { watched->Watch(); }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void* Allocate(std::size_t num_bytes) {
  if (num_bytes >= kLargeBytes) {
    ArrayStorage* const large = storage;
    if (large != nullptr && !large->HasRoomInMemory(num_bytes)) return large->Add(num_bytes);
  }
  return std::malloc(std::max<std::size_t>(num_bytes, 1));
}

void Free(void* memory) {
  constexpr std::uintptr_t kSmallestPage = 4096;  // where arrays on disk begin
  ArrayStorage* const large = storage;
  const bool may_be_on_disk =
      large != nullptr && reinterpret_cast<std::uintptr_t>(memory) % kSmallestPage == 0;
  if (!may_be_on_disk || !large->Remove(memory)) std::free(memory);
}

}  // namespace

void KeepArraysWithin(const std::string& folder, MemoryBudget* budget) {
  if (budget->memory == 0.0) return;
  auto opened = std::make_unique<ArrayStorage>(budget->memory);
  const Status status = opened->Open(folder);
  budget->no_disk = status.message();
  if (!status.ok()) return;
  budget->disk = opened->BytesOfDisk();
  GiveLargeArraysBack();
  StartWatching(opened.get());
  storage = opened.release();
}

}  // namespace plumbline

// The other forms of new are defined by this one; so are those of delete.
void* operator new(std::size_t num_bytes) {
  void* const memory = plumbline::Allocate(num_bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void operator delete(void* memory) noexcept { plumbline::Free(memory); }
void operator delete(void* memory, std::size_t) noexcept { plumbline::Free(memory); }
