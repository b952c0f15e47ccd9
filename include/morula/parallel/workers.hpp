// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Workers: one thread, a pool of the library, or the host's own executor. Results do not depend on the choice.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <type_traits>

namespace morula {

/// A borrowed callable void(std::size_t chunk): no allocation, valid only during the call it is passed to.
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

class Workers {
 public:
  /// One thread: the caller's.
  Workers();
  /// A pool of thread_count threads, including the caller's; 0 means one per processor. A build without MORULA_THREADS
  /// always has 1. After a loop threads stay awake for 50 us if each has a processor, because waking a thread takes as
  /// long.
  explicit Workers(unsigned thread_count);
  /// The host's own executor: run must call chunk(i) once for every i < count, in any order and on any threads, and
  /// return after the last.
  using Executor = std::function<void(std::size_t count, ChunkFunction chunk)>;
  Workers(Executor run, unsigned thread_count);
  ~Workers();
  Workers(Workers&&) noexcept;
  Workers& operator=(Workers&&) noexcept;

  unsigned thread_count() const;
  /// True if an executor of the host runs the loops.
  bool is_of_host() const { return static_cast<bool>(executor_); }
  /// Calls chunk(i) once for every i < count. If a chunk throws, some others are skipped, and the exception of the
  /// lowest i is rethrown. Allocates nothing. Only one call may run at a time; a call from inside a chunk runs on the
  /// calling thread.
  void run(std::size_t count, ChunkFunction chunk);

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;
  Executor executor_;
  unsigned thread_count_ = 1;
};

/// Shared default for functions that take workers: runs on the caller's thread.
Workers& serial_workers();

/// Workers for one call of a long function: the caller's workers if given, otherwise one thread per processor for this
/// call alone. If the caller is itself a chunk of a loop, its thread stays the only one.
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

/// Calls f(begin, end) over [0, count) in chunks of `grain`. Chunks depend on count and grain alone, so partial results
/// that are joined in chunk order have the same bits for any number of workers.
template <class F>
void parallel_for(Workers& workers, std::size_t count, std::size_t grain, const F& f) {
  if (count == 0) return;
  const std::size_t chunks = (count + grain - 1) / grain;
  workers.run(chunks, [&](std::size_t i) { f(i * grain, std::min(count, (i + 1) * grain)); });
}

}  // namespace morula
