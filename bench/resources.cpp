// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "resources.hpp"

#include <chrono>
#include <ctime>
#include <fstream>
#include <string>

#ifndef _WIN32
#include <sys/resource.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace morula::bench {
namespace {

/// A line "VmHWM:  1234 kB" of the kernel's account of this process.
std::optional<std::size_t> memory_in_use(const std::string& what) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(what + ':', 0) == 0) return 1024 * std::stoull(line.substr(what.size() + 1));
  return std::nullopt;
}

}  // namespace

double user_seconds() {
#ifdef _WIN32
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
#else
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
#endif
}

double processor_seconds() {
#ifdef CLOCK_PROCESS_CPUTIME_ID
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
#else
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
#endif
}

double thread_seconds() {
#ifdef CLOCK_THREAD_CPUTIME_ID
  timespec used;
  if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used) == 0)
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
#endif
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::optional<std::size_t> allocated_bytes() {
#ifdef __GLIBC__
  const auto heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
#else
  return std::nullopt;
#endif
}

std::optional<std::size_t> resident_bytes() {
  return memory_in_use("VmRSS");
}

PeakMemory::PeakMemory() {
#ifdef __GLIBC__
  malloc_trim(0);  // else memory that was freed but kept counts as if it were in use
#endif
  // 5: start the record anew.
  if (std::ofstream("/proc/self/clear_refs") << '5' << std::flush) before_ = memory_in_use("VmRSS");
}

std::optional<std::size_t> PeakMemory::bytes() const {
  const std::optional<std::size_t> peak = memory_in_use("VmHWM");
  if (!before_ || !peak) return std::nullopt;
  return *peak > *before_ ? *peak - *before_ : 0;
}

}  // namespace morula::bench
