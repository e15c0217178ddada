#ifndef PLUMBLINE_CORE_THREAD_POOL_H_
#define PLUMBLINE_CORE_THREAD_POOL_H_

#include <cstddef>
#include <functional>
#include <memory>

namespace plumbline {

/// A fixed set of threads that share loops over index ranges. Idle threads sleep, they do not spin.
///
/// Determinism: a loop is cut into chunks whose bounds depend on its size alone. A caller that
/// keeps one partial result per chunk and adds them in chunk order gets the same bits for any
/// number of threads.
class ThreadPool {
 public:
  /// num_threads >= 1, the calling thread included; fewer if the system refuses to give as many.
  explicit ThreadPool(int num_threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// The calling thread included.
  int num_threads() const;

  /// Number of chunks that ForEachChunk makes of `size` indices.
  static std::size_t NumChunks(std::size_t size, std::size_t chunk_size) {
    return (size + chunk_size - 1) / chunk_size;
  }

  /// Calls body(chunk, begin, end) once per chunk of [0, size), in any order and on any thread;
  /// returns when all are done. The body must not call the pool. If it throws, chunks that have not
  /// begun are left out, and the exception of the first chunk that threw goes on to the caller; the
  /// pool can be used again.
  void ForEachChunk(std::size_t size, std::size_t chunk_size,
                    const std::function<void(std::size_t, std::size_t, std::size_t)>& body);

  /// Calls body(i) once per index of [0, size), as ForEachChunk calls its body.
  template <typename Body>
  void ForEach(std::size_t size, std::size_t chunk_size, const Body& body) {
    ForEachChunk(size, chunk_size, [&body](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_THREAD_POOL_H_
