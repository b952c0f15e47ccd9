// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <morula/parallel/threads.hpp>
#include <morula/parallel/workers.hpp>
#include <mutex>
#include <stdexcept>
#include <utility>
#ifdef MORULA_THREADS
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <system_error>
#include <thread>
#include <vector>
#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif
#endif

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

// True on a thread that is inside a chunk: nested loops then run on that thread.
thread_local bool inside_chunk = false;

// A chunk that throws ends the loop: chunks that have not begun are skipped, and chunks that have begun run to their
// end. Chunks begin in order, so all chunks below the one that threw have begun: the exception of the lowest index is
// the same for any number of threads.
void run_serially(std::size_t count, ChunkFunction chunk) {
  for (std::size_t i = 0; i < count; ++i) {
    check_interrupt();
    chunk(i);
  }
}

// The host's threads get neither the library's exceptions nor nested loops, and chunks do not get the host's rounding
// modes.
void run_on_host(const Workers::Executor& executor, std::size_t count, ChunkFunction chunk) {
  Mutex mutex;
  std::size_t failed_index = count;
  std::exception_ptr failure;
  Interruption* const interruption = active_interruption();
  const auto guarded = [&](std::size_t i) {
    const StandardFloats standard;
    const HelpsOwner helps(interruption);
    const bool was_inside = std::exchange(inside_chunk, true);
    const auto is_of_no_account = [&] {
      const std::lock_guard lock(mutex);
      return failed_index < i;
    };
    try {
      check_interrupt();
      if (!is_of_no_account()) chunk(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (i < failed_index) failed_index = i, failure = std::current_exception();
    }
    inside_chunk = was_inside;
  };
  executor(count, guarded);
  if (failure) std::rethrow_exception(failure);
}

#ifdef MORULA_THREADS
/// Signals the processor that a thread is spinning.
inline void relax() {
#if defined(__SSE2__) || defined(_M_X64)
  _mm_pause();
#elif defined(__aarch64__) && defined(__GNUC__)
  __asm__ volatile("yield");
#endif
}
#endif

}  // namespace

#ifdef MORULA_THREADS

// Helpers join a loop if they are awake in time: the caller begins at once, and waits only for helpers that have begun
// a chunk. Between two loops in quick succession all threads stay awake, since waking a thread may take longer than the
// loop.
struct Workers::Pool {
  explicit Pool(unsigned helpers) {
    const unsigned processors = std::thread::hardware_concurrency();
    stays_awake_ = processors == 0 || helpers < processors;
    threads_.reserve(helpers);
    try {
      for (unsigned i = 0; i < helpers; ++i) threads_.emplace_back([this] { serve(); });
    } catch (const std::system_error&) {
      // The system has no more threads: the existing ones do the work.
    } catch (...) {
      stop();
      throw;
    }
  }
  std::size_t helpers() const { return threads_.size(); }
  ~Pool() { stop(); }

  void run(std::size_t count, ChunkFunction f) {
    std::size_t to_wake = 0;
    {
      const std::lock_guard lock(mutex_);
      loop_ = {&f, count, active_interruption()};
      next_.store(0, std::memory_order_relaxed);
      failed_index_ = count;
      failure_ = nullptr;
      to_wake = std::min<std::size_t>(sleepers_, count - 1);
      generation_.store(generation_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    }
    for (; to_wake > 0; --to_wake) wake_.notify_one();
    take_chunks({&f, count, active_interruption()});
    {
      const std::lock_guard lock(mutex_);
      loop_ = {};  // helpers that come later are too late
    }
    if (!is_soon([this] { return helping_.load(std::memory_order_acquire) == 0; })) {
      std::unique_lock lock(mutex_);
      idle_.wait(lock, [this] { return helping_ == 0; });
    }
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  struct Loop {
    const ChunkFunction* chunk = nullptr;
    std::size_t count = 0;
    Interruption* interruption = nullptr;
  };

  void serve() {
    const StandardFloats standard;  // threads inherit the settings of their creator
    std::uint64_t seen = 0;
    for (;;) {
      const auto is_called = [&] { return generation_.load(std::memory_order_acquire) != seen; };
      is_soon(is_called);
      Loop loop;
      {
        std::unique_lock lock(mutex_);
        ++sleepers_;
        wake_.wait(lock, [&] { return stopping_ || is_called(); });
        --sleepers_;
        if (stopping_) return;
        seen = generation_.load(std::memory_order_relaxed);
        loop = loop_;
        if (loop.chunk == nullptr) continue;
        helping_.store(helping_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      }
      take_chunks(loop);
      const std::lock_guard lock(mutex_);
      const unsigned left = helping_.load(std::memory_order_relaxed) - 1;
      helping_.store(left, std::memory_order_release);
      if (left == 0) idle_.notify_one();
    }
  }

  /// Spins until a condition holds, for about as long as waking a thread takes. Returns whether it holds.
  template <class Holds>
  bool is_soon(const Holds& holds) const {
    if (!stays_awake_) return holds();
    const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(50);
    do {
      for (int i = 0; i < 16; ++i) {
        if (holds()) return true;
        relax();
      }
    } while (std::chrono::steady_clock::now() < end);
    return holds();
  }

  // An exception ends the loop: no thread takes another chunk.
  void take_chunks(const Loop& loop) {
    const HelpsOwner helps(loop.interruption);
    inside_chunk = true;
    for (;;) {
      const std::size_t i = next_.fetch_add(1, std::memory_order_relaxed);
      if (i >= loop.count) break;
      try {
        check_interrupt();
        (*loop.chunk)(i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (i < failed_index_) failed_index_ = i, failure_ = std::current_exception();
        next_.store(loop.count, std::memory_order_relaxed);
      }
    }
    inside_chunk = false;
  }

  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
    for (std::thread& t : threads_) t.join();
    threads_.clear();
  }

  std::vector<std::thread> threads_;
  bool stays_awake_ = true;
  std::mutex mutex_;  // guards all members below; atomic ones are also read without it
  std::condition_variable wake_, idle_;
  Loop loop_;  // empty: no loop that a helper may join
  std::atomic<std::size_t> next_{0};
  std::atomic<std::uint64_t> generation_{0};
  std::atomic<unsigned> helping_{0};  // number of helpers in the loop
  std::size_t sleepers_ = 0;
  bool stopping_ = false;
  std::size_t failed_index_ = 0;
  std::exception_ptr failure_;
};

Workers::Workers(unsigned thread_count) {
  thread_count_ = thread_count == 0 ? std::max(1u, std::thread::hardware_concurrency()) : thread_count;
  if (thread_count_ > 1) pool_ = std::make_unique<Pool>(thread_count_ - 1);
  if (pool_) thread_count_ = static_cast<unsigned>(pool_->helpers()) + 1;
  if (thread_count_ == 1) pool_.reset();
}

#else

struct Workers::Pool {
  void run(std::size_t count, ChunkFunction f) { run_serially(count, f); }
};

Workers::Workers(unsigned) {}

#endif

Workers::Workers() = default;
Workers::Workers(Executor run, unsigned thread_count)
    : executor_(std::move(run)), thread_count_(std::max(1u, thread_count)) {
  if (!executor_) throw std::invalid_argument("Workers: the executor is empty");
}
Workers::~Workers() = default;
Workers::Workers(Workers&&) noexcept = default;
Workers& Workers::operator=(Workers&&) noexcept = default;

unsigned Workers::thread_count() const {
  return thread_count_;
}

void Workers::run(std::size_t count, ChunkFunction chunk) {
  if (count == 0) return;
  if (inside_chunk || count == 1 || (!pool_ && !executor_)) return run_serially(count, chunk);
  if (executor_) return run_on_host(executor_, count, chunk);
  pool_->run(count, chunk);
}

Workers& serial_workers() {
  static Workers workers;
  return workers;
}

WorkersOrAll::operator Workers&() {
  if (used_ == nullptr) {
    own_ = inside_chunk ? std::make_unique<Workers>() : std::make_unique<Workers>(0u);
    used_ = own_.get();
  }
  return *used_;
}

}  // namespace morula
