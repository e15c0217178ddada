#include "plumbline/apps/run/array_storage.h"

#include <pthread.h>

#include <algorithm>
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
#include "plumbline/apps/program/resident_memory.h"

namespace plumbline {
namespace {

constexpr std::size_t kLargeBytes = 1 << 20;
// Shares of the limit. Arrays stay in memory as long as the process has less than the first; pages
// of the others are let go where it has more than the second.
constexpr double kShareOfMemory = 1.0 / 3.0, kShareAtMost = 0.75;
// A process that holds more all the same gets on with so many pages at a time.
constexpr double kShareOfPages = 0.125;

// Lives as long as the process: arrays are freed until its end.
class ArrayStorage {
 public:
  explicit ArrayStorage(double max_memory) : max_memory_(max_memory) {}

  Status Open(const std::string& folder) {
    if (resident_.Read().total > 0.0) return disk_.Open(folder);
    return Status::Unavailable("the system does not say in /proc how much memory is taken");
  }
  double BytesOfDisk() const { return disk_.BytesFree(); }

  void Decide(bool on_disk) { use_ = on_disk ? Use::kDisk : Use::kMemory; }

  // Null if the array is to be in memory. Once that is known to be too small, a full disk is the
  // end.
  void* Add(std::size_t num_bytes) {
    const Use use = use_;
    if (use == Use::kMemory || HasRoomInMemory(num_bytes)) return nullptr;
    void* const array = disk_.Add(num_bytes);
    if (array == nullptr && use == Use::kDisk) throw std::bad_alloc();
    return array;
  }
  bool Remove(void* array) { return disk_.Remove(array); }

  [[noreturn]] void Watch() {
    for (;;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const Resident now = resident_.Read();
      const double most =
          std::max(kShareAtMost * max_memory_, now.unshared + kShareOfPages * max_memory_);
      if (now.total > most) disk_.MakeRoom();
    }
  }

 private:
  // Where large arrays go for which there is no room.
  enum class Use { kDiskIfItHasRoom, kDisk, kMemory };

  bool HasRoomInMemory(std::size_t num_bytes) const {
    return resident_.Read().unshared + static_cast<double>(num_bytes) <=
           kShareOfMemory * max_memory_;
  }

  const double max_memory_;
  std::atomic<Use> use_{Use::kDiskIfItHasRoom};
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
  ArrayStorage* const large = num_bytes >= kLargeBytes ? storage.load() : nullptr;
  void* memory = large != nullptr ? large->Add(num_bytes) : nullptr;
  if (memory == nullptr) memory = std::malloc(std::max<std::size_t>(num_bytes, 1));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void* AllocateOrNull(std::size_t num_bytes) noexcept {
  try {
    return Allocate(num_bytes);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

void Free(void* memory) noexcept {
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
  budget->decide = [watched = opened.get()](bool on_disk) { watched->Decide(on_disk); };
  GiveLargeArraysBack();
  StartWatching(opened.get());
  storage = opened.release();
}

}  // namespace plumbline

// All forms but those of unusual alignment, which is for no large array.
void* operator new(std::size_t size) { return plumbline::Allocate(size); }
void* operator new[](std::size_t size) { return plumbline::Allocate(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return plumbline::AllocateOrNull(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return plumbline::AllocateOrNull(size);
}
void operator delete(void* memory) noexcept { plumbline::Free(memory); }
void operator delete[](void* memory) noexcept { plumbline::Free(memory); }
void operator delete(void* memory, std::size_t) noexcept { plumbline::Free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { plumbline::Free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { plumbline::Free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { plumbline::Free(memory); }
