// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A worker, from the side of the batch that started it.
#pragma once

#include <memory>
#include <morula/parallel/threads.hpp>
#include <mutex>
#include <optional>
#include <platform/process.hpp>
#include <string>
#include <vector>

#include "batch/task.hpp"

namespace morula::cli {

/// How a worker is started where the command runs inside another program (an interpreter): that program, and its words
/// before the worker's. Otherwise this program. To be set before the first worker.
void start_workers_as(const std::string& program, const std::vector<std::string>& words);
/// The program of a worker, and its words.
const std::string& worker_path();
std::vector<std::string> worker_words();

/// A worker that was started. It has one task at a time.
class BatchWorker {
 public:
  /// Throws std::system_error where no process can be made.
  BatchWorker();
  /// Ends it, and the build that it runs.
  ~BatchWorker();
  BatchWorker(const BatchWorker&) = delete;
  BatchWorker& operator=(const BatchWorker&) = delete;

  void give(const BatchTask& task);
  /// To wait for: output means an answer, and the end of output the end of the worker.
  const platform::ChildProgram& program() const { return program_; }
  /// Reads what is there, without waiting. The result's text, once it is whole.
  std::optional<std::string> answer();
  /// Requests its end, and the end of the build that it runs. Any thread may call it.
  void request_end();
  /// Whether it has ended without an answer.
  bool is_gone() const { return is_gone_; }

 private:
  platform::ChildProgram program_;
  std::string read_;
  bool is_gone_ = false;
};

/// A place for workers, one at a time: a worker that is lost is replaced.
class BatchSeat {
 public:
  /// Gives one task and waits for its result. A task for which two workers in turn were lost is `crashed`. None if the
  /// seat was stopped, or if a stop was requested: the worker has then ended.
  std::optional<Json> build(const BatchTask& task, const StopToken& stop = {});
  /// From another thread: ends the build that is waited for, and all later ones at once.
  void stop();

 private:
  std::mutex mutex_;  // of both members
  std::unique_ptr<BatchWorker> worker_;
  bool is_stopped_ = false;

  bool has_worker();
};

}  // namespace morula::cli
