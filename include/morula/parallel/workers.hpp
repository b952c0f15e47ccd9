// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Workers: the threads that run the loops of a call. They are the caller's thread alone, a pool of the library, or the
// executor of the host program. Results have the same bits with each of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <type_traits>

namespace morula {

/// A reference to a callable void(std::size_t chunk). It allocates nothing, and is valid as long as the callable: for
/// an executor, until it returns.
class ChunkFunction {
 public:
  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, ChunkFunction>) ChunkFunction(const F& f)
      : object_(&f), call_([](const void* o, std::size_t i) { (*static_cast<const F*>(o))(i); }) {}
  void operator()(std::size_t chunk) const { call_(object_, chunk); }

 private:
  const void* object_;
  void (*call_)(const void*, std::size_t);
};

/// Runs loops on threads. Functions that take workers divide their loops into chunks and call run().
class Workers {
 public:
  /// Runs all chunks on the thread that calls run().
  Workers();
  /// A pool of thread_count threads, one of which is the thread that calls run(); 0 means one per processor. It has
  /// fewer threads if the system cannot start them, and only the caller's in a build without MORULA_THREADS:
  /// thread_count() returns the number. If each thread has a processor, threads stay awake for 50 us after a loop,
  /// because waking a thread takes about as long.
  explicit Workers(unsigned thread_count);
  /// A function of the host program that runs a loop: it must call chunk(i) once for every i < count, in any order and
  /// on any threads, and return when all calls have returned.
  using Executor = std::function<void(std::size_t count, ChunkFunction chunk)>;
  /// Runs loops with the host's executor. thread_count: the number of threads that it uses; 0 counts as 1. Throws
  /// std::invalid_argument if run is empty.
  Workers(Executor run, unsigned thread_count);
  ~Workers();
  Workers(Workers&&) noexcept;
  Workers& operator=(Workers&&) noexcept;

  /// Number of threads that run loops, at least 1.
  unsigned thread_count() const;
  /// True if an executor of the host runs the loops.
  bool is_of_host() const { return static_cast<bool>(executor_); }
  /// Calls chunk(i) once for every i < count, and returns when all calls have returned. If a chunk throws, others may
  /// be skipped, and run() rethrows the exception of the lowest i. The library allocates nothing. Workers with a pool
  /// or an executor may run one loop at a time; a call from inside a chunk runs its whole loop on the calling thread.
  void run(std::size_t count, ChunkFunction chunk);

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;
  Executor executor_;
  unsigned thread_count_ = 1;
};

/// The default of functions that take workers: runs loops on the caller's thread. Several threads may use it at once.
Workers& serial_workers();

/// The workers of one call of a long function: the given ones; by default, a pool with one thread per processor that
/// exists only during the call. By default, a call from inside a chunk of a loop runs on its own thread alone.
class WorkersOrAll {
 public:
  WorkersOrAll() = default;
  WorkersOrAll(Workers& given) : used_(&given) {}
  WorkersOrAll(const WorkersOrAll&) = delete;
  WorkersOrAll& operator=(const WorkersOrAll&) = delete;
  operator Workers&();

 private:
  std::unique_ptr<Workers> own_{};
  Workers* used_ = nullptr;
};

/// Divides [0, count) into chunks of `grain` numbers, the last one possibly shorter, and calls f(begin, end) for each,
/// on the threads of the workers. grain: at least 1. Chunks depend on count and grain alone, so partial results that
/// are joined in the order of chunks have the same bits for any number of workers.
template <class F>
void parallel_for(Workers& workers, std::size_t count, std::size_t grain, const F& f) {
  if (count == 0) return;
  const std::size_t chunks = (count + grain - 1) / grain;
  workers.run(chunks, [&](std::size_t i) { f(i * grain, std::min(count, (i + 1) * grain)); });
}

}  // namespace morula
