// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <morula/parallel/workers.hpp>
#include <mutex>
#include <stdexcept>
#include <utility>
#ifdef MORULA_THREADS
#include <atomic>
#include <condition_variable>
#include <system_error>
#include <thread>
#include <vector>
#endif

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

// True on a thread that is inside a chunk: nested loops then run where they are.
thread_local bool inside_chunk = false;

// Runs every chunk even when one throws, and keeps the exception of the lowest index, so that what the caller sees does
// not depend on timing.
void run_serially(std::size_t count, ChunkFunction chunk) {
  std::exception_ptr first;
  for (std::size_t i = 0; i < count; ++i) {
    try {
      chunk(i);
    } catch (...) {
      if (!first) first = std::current_exception();
    }
  }
  if (first) std::rethrow_exception(first);
}

// The host's threads get neither our exceptions nor nested loops, and our chunks none of the host's roundings.
void run_on_host(const Workers::Executor& executor, std::size_t count, ChunkFunction chunk) {
  std::mutex mutex;
  std::size_t failed_index = count;
  std::exception_ptr failure;
  const auto guarded = [&](std::size_t i) {
    const StandardFloats standard;
    const bool was_inside = std::exchange(inside_chunk, true);
    try {
      chunk(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (i < failed_index) failed_index = i, failure = std::current_exception();
    }
    inside_chunk = was_inside;
  };
  executor(count, guarded);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

#ifdef MORULA_THREADS

struct Workers::Pool {
  explicit Pool(unsigned helpers) {
    threads_.reserve(helpers);
    try {
      for (unsigned i = 0; i < helpers; ++i) threads_.emplace_back([this] { serve(); });
    } catch (const std::system_error&) {
      // The system has no more threads: those that are there do the work.
    } catch (...) {
      stop();
      throw;
    }
  }
  std::size_t helpers() const { return threads_.size(); }
  ~Pool() { stop(); }

  void run(std::size_t count, ChunkFunction f) {
    {
      const std::lock_guard lock(mutex_);
      chunk_ = &f;
      chunk_count_ = count;
      next_.store(0, std::memory_order_relaxed);
      busy_ = static_cast<unsigned>(threads_.size());
      failed_index_ = count;
      failure_ = nullptr;
      ++generation_;
    }
    wake_.notify_all();
    take_chunks();
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [this] { return busy_ == 0; });
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  void serve() {
    const StandardFloats standard;  // threads inherit what their maker had set
    std::uint64_t seen = 0;
    for (;;) {
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [&] { return stopping_ || generation_ != seen; });
        if (stopping_) return;
        seen = generation_;
      }
      take_chunks();
      const std::lock_guard lock(mutex_);
      if (--busy_ == 0) idle_.notify_one();
    }
  }

  void take_chunks() {
    inside_chunk = true;
    for (;;) {
      const std::size_t i = next_.fetch_add(1, std::memory_order_relaxed);
      if (i >= chunk_count_) break;
      try {
        (*chunk_)(i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (i < failed_index_) failed_index_ = i, failure_ = std::current_exception();
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
  std::mutex mutex_;
  std::condition_variable wake_, idle_;
  const ChunkFunction* chunk_ = nullptr;
  std::size_t chunk_count_ = 0;
  std::atomic<std::size_t> next_{0};
  unsigned busy_ = 0;
  std::uint64_t generation_ = 0;
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

}  // namespace morula
