#include "plumbline/apps/io/heap.h"

#include <cstdlib>  // says whether this is glibc
#include <memory>

#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#endif

namespace plumbline {
namespace {

bool gives_large_arrays_back = false;

// Sanitizers have an allocator of their own, which writes down what it hands out.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// The heap grows by much at once, so that its pages can be large from the start. No memory is taken
// before it is used.
void UseLargePages() {
  constexpr std::size_t kBytes = std::size_t{1} << 30, kPage = std::size_t{1} << 21;
  void* const grown = std::malloc(kBytes);
  if (grown == nullptr) return;
  std::size_t size = kBytes;
  void* pages = grown;
  if (std::align(kPage, kPage, pages, size) != nullptr) madvise(pages, size, MADV_HUGEPAGE);
  std::free(grown);
}
#else
void UseLargePages() {}
#endif

}  // namespace

void KeepOneHeap() {
#ifdef __GLIBC__
  // NOLINTBEGIN(concurrency-mt-unsafe)
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
  // NOLINTEND(concurrency-mt-unsafe)
#endif
  UseLargePages();
}

void GiveLargeArraysBack() {
  gives_large_arrays_back = true;
#ifdef __GLIBC__
  // NOLINTBEGIN(concurrency-mt-unsafe)
  mallopt(M_MMAP_MAX, 1 << 16);
  mallopt(M_MMAP_THRESHOLD, 1 << 23);
  // NOLINTEND(concurrency-mt-unsafe)
#endif
}

void GiveFreedMemoryBack(std::size_t num_returns) {
  if (num_returns < kManyReturns && !gives_large_arrays_back) return;
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace plumbline
