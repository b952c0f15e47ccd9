// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/worker.hpp"

#include <array>
#include <chrono>
#include <string_view>
#include <thread>

#include "batch/serve.hpp"
#include "shared/command.hpp"

namespace morula::cli {
namespace {

struct WorkerProgram {
  std::string path = platform::own_program();
  std::vector<std::string> words{"morula"};
};
WorkerProgram& worker_program() {
  static WorkerProgram program;
  return program;
}

}  // namespace

void start_workers_as(const std::string& program, const std::vector<std::string>& words) {
  worker_program() = {program, words};
}

const std::string& worker_path() {
  return worker_program().path;
}

std::vector<std::string> worker_words() {
  std::vector<std::string> words = worker_program().words;
  words.emplace_back(worker_word);
  return words;
}

BatchWorker::BatchWorker() : program_(worker_path(), worker_words(), {.writes_input = true}) {}

BatchWorker::~BatchWorker() {
  program_.close_streams();  // the end of its input ends it
  using std::chrono::microseconds;
  for (int tries = 0; tries < 200 && !program_.status(); ++tries)
    std::this_thread::sleep_for(microseconds(tries < 20 ? 500 : 10'000));
}

void BatchWorker::give(const BatchTask& task) {
  if (!program_.write(task_line(task) + "\n")) is_gone_ = true;
}

std::optional<std::string> BatchWorker::answer() {
  for (;;) {
    if (const std::size_t end = read_.find('\n'); end != std::string::npos) {
      std::string line = read_.substr(0, end);
      read_.erase(0, end + 1);
      return line;
    }
    const std::size_t before = read_.size();
    if (!program_.read_output(read_)) is_gone_ = true;
    if (read_.size() == before) return std::nullopt;
  }
}

void BatchWorker::request_end() {
  program_.request_end();
}

bool BatchSeat::has_worker() {
  const std::lock_guard lock(mutex_);
  if (is_stopped_) return false;
  if (!worker_ || worker_->is_gone()) worker_ = std::make_unique<BatchWorker>();
  return true;
}

void BatchSeat::stop() {
  const std::lock_guard lock(mutex_);
  is_stopped_ = true;
  if (worker_) worker_->request_end();
}

std::optional<Json> BatchSeat::build(const BatchTask& task, const StopToken& stop) {
  for (int tries = 0; tries < 2 && !stop.stop_requested(); ++tries) {
    if (!has_worker()) return std::nullopt;
    worker_->give(task);
    while (!worker_->is_gone() && !stop.stop_requested()) {
      const std::array<const platform::ChildProgram*, 1> waited{&worker_->program()};
      platform::ChildProgram::wait_for_any(waited, 100);
      const std::optional<std::string> answer = worker_->answer();
      if (!answer) continue;
      if (std::optional<Json> result = whole_result(*answer, task.key)) return result;
      break;
    }
  }
  const std::lock_guard lock(mutex_);
  worker_.reset();
  if (is_stopped_ || stop.stop_requested()) return std::nullopt;
  return lost_result(task);
}

}  // namespace morula::cli
