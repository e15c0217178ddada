#include "plumbline/core/thread_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

TEST(ThreadPool, KnowsItsNumberOfThreads) {
  for (const int threads : {1, 2, 8}) EXPECT_EQ(ThreadPool(threads).num_threads(), threads);
}

TEST(ThreadPool, NumChunksRoundsUp) {
  EXPECT_EQ(ThreadPool::NumChunks(0, 4), 0u);
  EXPECT_EQ(ThreadPool::NumChunks(1, 4), 1u);
  EXPECT_EQ(ThreadPool::NumChunks(4, 4), 1u);
  EXPECT_EQ(ThreadPool::NumChunks(5, 4), 2u);
}

TEST(ThreadPool, VisitsEveryIndexOnce) {
  for (int threads = 1; threads <= 8; ++threads) {
    ThreadPool pool(threads);
    for (const std::size_t size : {1u, 7u, 64u, 65u, 1000u}) {
      for (const std::size_t chunk_size : {1u, 7u, 64u, 5000u}) {
        std::vector<std::atomic<int>> visits(size);
        pool.ForEachChunk(size, chunk_size, [&](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        for (std::size_t i = 0; i < size; ++i) {
          ASSERT_EQ(visits[i], 1) << threads << " threads, index " << i << " of " << size;
        }
      }
    }
  }
}

TEST(ThreadPool, ChunkBoundsDoNotDependOnTheThreads) {
  for (int threads = 1; threads <= 8; ++threads) {
    ThreadPool pool(threads);
    std::vector<std::pair<std::size_t, std::size_t>> bounds(4);
    pool.ForEachChunk(10, 3, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      bounds[chunk] = {begin, end};
    });
    const std::vector<std::pair<std::size_t, std::size_t>> expected = {
        {0, 3}, {3, 6}, {6, 9}, {9, 10}};
    EXPECT_EQ(bounds, expected);
  }
}

TEST(ThreadPool, PartialSumsPerChunkGiveTheSameBits) {
  std::set<double> sums;
  for (int threads = 1; threads <= 8; ++threads) {
    ThreadPool pool(threads);
    const std::size_t size = 20000, chunk_size = 100;
    std::vector<double> partial(ThreadPool::NumChunks(size, chunk_size), 0.0);
    pool.ForEachChunk(size, chunk_size, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) partial[chunk] += 1.0 / (i + 1.0);
    });
    double sum = 0.0;
    for (const double p : partial) sum += p;
    sums.insert(sum);
  }
  ASSERT_EQ(sums.size(), 1u);
  // Harmonic number: ln n + Euler's constant + 1 / 2n - 1 / 12n^2.
  EXPECT_NEAR(*sums.begin(), std::log(20000.0) + 0.57721566490153286 + 1.0 / 40000.0, 1e-9);
}

TEST(ThreadPool, AnEmptyLoopCallsNothing) {
  ThreadPool pool(3);
  pool.ForEachChunk(0, 10, [](std::size_t, std::size_t, std::size_t) { FAIL(); });
}

TEST(ThreadPool, EachLoopEndsBeforeTheNextBegins) {
  ThreadPool pool(4);
  std::vector<int> values(64, 0);
  constexpr int kLoops = 2000;
  for (int loop = 0; loop < kLoops; ++loop) {
    // Every value is read by another chunk than the one that wrote it in the loop before.
    std::vector<int> next(values.size());
    pool.ForEachChunk(values.size(), 4, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) next[i] = values[values.size() - 1 - i] + 1;
    });
    values.swap(next);
  }
  EXPECT_EQ(values, std::vector<int>(64, kLoops));
}

TEST(ThreadPool, TheFirstChunkThatThrowsTellsTheCaller) {
  for (int threads = 1; threads <= 8; ++threads) {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::string message;
      try {
        pool.ForEachChunk(200, 1, [](std::size_t chunk, std::size_t, std::size_t) {
          if (chunk % 10 == 7) throw std::runtime_error("chunk " + std::to_string(chunk));
        });
      } catch (const std::runtime_error& error) {
        message = error.what();
      }
      ASSERT_EQ(message, "chunk 7") << threads << " threads";
      // And the pool goes on.
      std::atomic<int> num_indices{0};
      pool.ForEachChunk(100, 3, [&](std::size_t, std::size_t begin, std::size_t end) {
        num_indices += static_cast<int>(end - begin);
      });
      ASSERT_EQ(num_indices, 100);
    }
  }
}

TEST(ThreadPool, OneThreadBeginsNoChunkAfterAThrow) {
  ThreadPool pool(1);
  int num_begun = 0;
  EXPECT_THROW(pool.ForEachChunk(100, 1,
                                 [&](std::size_t chunk, std::size_t, std::size_t) {
                                   ++num_begun;
                                   if (chunk == 4) throw 7;
                                 }),
               int);
  EXPECT_EQ(num_begun, 5);
}

}  // namespace
}  // namespace plumbline
