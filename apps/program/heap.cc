#include "plumbline/apps/program/heap.h"

#include <cstdlib>  // says whether this is glibc

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace plumbline {

void KeepOneHeap() {
#ifdef __GLIBC__
  // NOLINTBEGIN(concurrency-mt-unsafe)
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
  // NOLINTEND(concurrency-mt-unsafe)
#endif
}

void GiveLargeArraysBack() {
#ifdef __GLIBC__
  // NOLINTBEGIN(concurrency-mt-unsafe)
  mallopt(M_MMAP_MAX, 1 << 16);
  mallopt(M_MMAP_THRESHOLD, 1 << 23);
  // NOLINTEND(concurrency-mt-unsafe)
#endif
}

void GiveFreedMemoryBack() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace plumbline
