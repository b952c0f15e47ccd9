// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Work in a process of its own, with limits: a crash there costs that work alone. For a worker, a process with one
// thread that takes orders on standard input and answers on standard output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "platform/process.hpp"

namespace morula::platform {

/// Makes this process a worker: Ctrl-C and the end of the terminal are for the program that started it; a closed pipe
/// is an error of the write; a request to end (SIGTERM) ends read_input().
void become_worker();
/// Appends what arrives on standard input, for which it waits. False at its end, or when the end of this process was
/// requested.
bool read_input(std::string& text);
/// Writes all bytes to standard output.
bool write_output(std::string_view bytes);

/// A file without a name, which takes what one process after another writes.
class ScratchFile {
 public:
  /// Throws std::system_error if it cannot be created.
  ScratchFile();
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /// Throws std::system_error if it cannot be emptied.
  void clear() const;
  /// Its first bytes, at most this number of them.
  std::string text(std::size_t most) const;
  /// The number by which a process that run_apart() starts writes to it.
  std::uint64_t number() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
/// Writes to a scratch file of the process that started this one.
bool write_scratch(std::uint64_t number, std::string_view bytes);

/// The work, in two forms. POSIX forks and calls `run`, which returns the exit code. Windows starts `program` with
/// `words` and writes `input` to its standard input; the program then calls `leave_with_input()`, and does the same.
struct ApartWork {
  std::function<int()> run;
  std::string program;
  std::vector<std::string> words;
  std::string input;
};
/// The files for the standard streams of the work, and a third one that it may write to.
struct ApartFiles {
  const ScratchFile &out, &errors, &extra;
};
struct ApartLimits {
  std::optional<double> seconds;         // then it is requested to end, and a second later it is ended
  std::optional<std::size_t> megabytes;  // of memory, besides what a process has at its start
};
/// The way in which the work ended, and its cost.
struct ApartEnd {
  enum class How {
    exited,       // status
    out_of_time,  // ended for its limit of time
    abandoned,    // ended since the end of this process was requested, or its answers are not awaited
  };
  How how = How::exited;
  ProcessStatus status;
  double seconds = 0, cpu_seconds = 0, peak_megabytes = 0;
};
/// Waits for the end of the work. A worker that is killed leaves nothing running. Throws std::system_error if no
/// process can be started.
ApartEnd run_apart(const ApartWork& work, const ApartFiles& files, const ApartLimits& limits);

/// Calls `end` on another thread once standard input ends, which requests the end of this process.
void leave_with_input(void (*end)(int signal));

}  // namespace morula::platform
