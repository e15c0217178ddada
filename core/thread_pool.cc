#include "plumbline/core/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "plumbline/core/float_environment.h"

namespace plumbline {

using ChunkBody = std::function<void(std::size_t, std::size_t, std::size_t)>;

struct ThreadPool::Impl {
  // One loop at a time: `generation` counts loops, so that a sleeping worker joins each one once.
  std::mutex mutex;
  std::condition_variable work_ready;
  std::condition_variable work_done;
  std::size_t generation = 0;
  int workers_busy = 0;
  bool stopping = false;

  const ChunkBody* body = nullptr;
  std::size_t size = 0;
  std::size_t chunk_size = 1;
  std::atomic<std::size_t> next_chunk{0};
  std::exception_ptr error;  // of the first chunk that threw: chunks begin in order
  std::size_t error_chunk = 0;

  std::vector<std::thread> workers;

  // The same arithmetic on every thread, whatever those that made them or call them have set.
  void RunChunks() {
    const DefaultFloatEnvironment float_environment;
    const std::size_t num_chunks = NumChunks(size, chunk_size);
    for (;;) {
      const std::size_t chunk = next_chunk.fetch_add(1);
      if (chunk >= num_chunks) return;
      const std::size_t begin = chunk * chunk_size;
      try {
        (*body)(chunk, begin, std::min(size, begin + chunk_size));
      } catch (...) {
        KeepError(chunk);
        next_chunk = num_chunks;
      }
    }
  }

  void KeepError(std::size_t chunk) {
    std::lock_guard<std::mutex> lock(mutex);
    if (error && error_chunk < chunk) return;
    error = std::current_exception();
    error_chunk = chunk;
  }

  void RethrowError() {
    if (error) std::rethrow_exception(std::exchange(error, nullptr));
  }

  void WorkerLoop() {
    std::size_t seen = 0;
    for (;;) {
      {
        std::unique_lock<std::mutex> lock(mutex);
        work_ready.wait(lock, [&] { return stopping || generation != seen; });
        if (stopping) return;
        seen = generation;
      }
      RunChunks();
      std::lock_guard<std::mutex> lock(mutex);
      if (--workers_busy == 0) work_done.notify_one();
    }
  }
};

ThreadPool::ThreadPool(int num_threads) : impl_(new Impl) {
  try {
    for (int i = 1; i < num_threads; ++i) {
      impl_->workers.emplace_back([this] { impl_->WorkerLoop(); });
    }
  } catch (const std::exception&) {
    // The system gives no more threads, or no memory for them. Those that run do the same work.
  }
}

ThreadPool::~ThreadPool() {
  {
    std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->stopping = true;
  }
  impl_->work_ready.notify_all();
  for (std::thread& worker : impl_->workers) worker.join();
}

int ThreadPool::num_threads() const { return static_cast<int>(impl_->workers.size()) + 1; }

void ThreadPool::ForEachChunk(std::size_t size, std::size_t chunk_size, const ChunkBody& body) {
  if (size == 0) return;
  impl_->body = &body;
  impl_->size = size;
  impl_->chunk_size = chunk_size;
  impl_->next_chunk = 0;
  // A loop of one chunk is not worth waking anyone for.
  if (impl_->workers.empty() || NumChunks(size, chunk_size) == 1) {
    impl_->RunChunks();
    impl_->RethrowError();
    return;
  }
  {
    std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->workers_busy = static_cast<int>(impl_->workers.size());
    ++impl_->generation;
  }
  impl_->work_ready.notify_all();
  impl_->RunChunks();
  {
    std::unique_lock<std::mutex> lock(impl_->mutex);
    impl_->work_done.wait(lock, [&] { return impl_->workers_busy == 0; });
  }
  impl_->RethrowError();
}

}  // namespace plumbline
