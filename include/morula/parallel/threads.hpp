// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Stop requests and mutexes: those of the standard library, or replacements where it has none. libc++ before version 20
// has no std::stop_token; a standard library without threads (WebAssembly's) has no std::mutex, either.
//
//   StopSource source;                              // another thread may call source.request_stop()
//   build(mesh, {.stop = source.get_token()});      // then throws BuildStopped
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>
#include <version>
#ifdef __cpp_lib_jthread
#include <stop_token>
#endif

// 1 if the standard library has threads. MORULA_THREADS says whether Morula starts any.
#if defined(_LIBCPP_HAS_NO_THREADS) || (defined(__GLIBCXX__) && !defined(_GLIBCXX_HAS_GTHREADS))
#define MORULA_STANDARD_THREADS 0
#elif defined(_LIBCPP_HAS_THREADS)
#define MORULA_STANDARD_THREADS _LIBCPP_HAS_THREADS
#else
#define MORULA_STANDARD_THREADS 1
#endif

namespace morula {

#ifdef __cpp_lib_jthread
using StopToken = std::stop_token;
using StopSource = std::stop_source;
#else
class StopSource;

/// Tells whether a stop was requested. Copies share the state of their source; one without a source never stops.
class StopToken {
 public:
  StopToken() = default;
  bool stop_requested() const noexcept { return stopped_ && stopped_->load(std::memory_order_acquire); }

 private:
  friend class StopSource;
  explicit StopToken(std::shared_ptr<const std::atomic<bool> > stopped) : stopped_(std::move(stopped)) {}
  std::shared_ptr<const std::atomic<bool> > stopped_{};
};

/// Requests stops. Copies share their state. Any thread may call it.
class StopSource {
 public:
  StopSource() = default;
  // No moves: a source that was moved from still has a state.
  StopSource(const StopSource&) = default;
  StopSource& operator=(const StopSource&) = default;
  ~StopSource() = default;
  StopToken get_token() const { return StopToken(stopped_); }
  bool stop_requested() const noexcept { return stopped_->load(std::memory_order_acquire); }
  /// Returns whether this is the first request.
  bool request_stop() const noexcept { return !stopped_->exchange(true, std::memory_order_acq_rel); }

 private:
  std::shared_ptr<std::atomic<bool> > stopped_ = std::make_shared<std::atomic<bool> >(false);
};
#endif

namespace detail {

#if MORULA_STANDARD_THREADS
using Mutex = std::mutex;
#else
/// Locks nothing: the program has one thread.
struct Mutex {
  void lock() {}
  void unlock() {}
};
#endif

}  // namespace detail
}  // namespace morula
