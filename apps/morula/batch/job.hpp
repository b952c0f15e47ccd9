// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Job: one run of this program in a process of its own, which may crash, hang or take all memory without harm.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace morula::cli {

struct JobLimits {
  std::optional<double> seconds;         ///< of wall time
  std::optional<std::size_t> megabytes;  ///< of address space
};

/// What came of one.
struct JobResult {
  enum class End { exited, signalled, out_of_time };
  End end = End::exited;
  int code = 0;  ///< exit code, or the signal
  std::string out, err;
  double seconds = 0, cpu_seconds = 0, peak_megabytes = 0;
};

class Job {
 public:
  /// Starts "morula ARGUMENTS". Its streams go to files under `scratch`, which must be nobody else's names.
  /// Throws std::system_error where no process can be made.
  Job(const std::vector<std::string>& arguments, const std::filesystem::path& scratch, const JobLimits& limits);
  /// Ends it, if it runs.
  ~Job();
  Job(Job&& other) noexcept;
  Job& operator=(Job&&) = delete;

  /// Has it ended? One that is beyond its time is killed. Never waits.
  std::optional<JobResult> poll();

 private:
  void remove_files() noexcept;

  pid_t process_ = -1;
  std::filesystem::path out_, err_;
  JobLimits limits_;
  double begun_ = 0;
  bool killed_ = false;
};

}  // namespace morula::cli
