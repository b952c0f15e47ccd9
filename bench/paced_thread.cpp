// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "paced_thread.hpp"

#include <chrono>
#include <utility>

#ifdef __linux__
#include <pthread.h>

#include <ctime>
#endif

namespace morula::bench {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void PacedThread::run(std::function<void()> job) {
  if (thread_.joinable()) thread_.join();
  over_ = false;
  started_ = wall_seconds();
  thread_ = std::jthread([this, job = std::move(job)] {
    job();
    over_ = true;
  });
}

double PacedThread::processor_seconds() const {
#ifdef __linux__
  clockid_t clock;
  timespec used;
  if (pthread_getcpuclockid(thread_.native_handle(), &clock) == 0 && clock_gettime(clock, &used) == 0)
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
#endif
  return wall_seconds() - started_;
}

void PacedThread::wait_for(double seconds) const {
  while (!over_ && processor_seconds() < seconds) std::this_thread::sleep_for(std::chrono::microseconds(200));
}

}  // namespace morula::bench
