// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Programs that this one starts, and what they write.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula::platform {

/// The way in which a process ended.
struct ProcessStatus {
  int code = 0;  // exit code, or number of the signal; for a crash on Windows, of the signal that means the same
  bool by_signal = false;  // it crashed, or another process ended it
};

/// Destinations of the streams of a program.
struct ProgramStreams {
  bool writes_input = false;  // write() goes to its standard input; otherwise that is empty
  bool reads_errors = false;  // read_errors() returns its standard error; otherwise that is the one of this program
};

/// A program that was started. It is ended, and waited for, at the latest with this object.
class ChildProgram {
 public:
  /// words: the first one is the program, a path or a name that is searched as a shell does. Words arrive unchanged,
  /// blanks, quotation marks and backslashes included. Windows: the program is an .exe, which the name need not say,
  /// and a name without a folder is one of PATH. Throws std::system_error if it cannot be started; a .bat or .cmd never
  /// is, because the system's shell would read its words.
  ChildProgram(const std::vector<std::string>& words, const ProgramStreams& streams);
  /// The same for a program by its path, with words that need not begin with its name.
  ChildProgram(const std::string& path, const std::vector<std::string>& words, const ProgramStreams& streams);
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  /// Writes all of it to the program's input. False if the program does not read any more.
  bool write(std::string_view bytes);
  /// Closes all streams: a program that reads its input ends.
  void close_streams();
  /// Appends what is there, without waiting, at most 64 KiB. False at the end of the stream.
  bool read_output(std::string& text);
  bool read_errors(std::string& text);
  /// Returns once one of these programs has output or errors to read, a stream of it ends, or the time is over.
  static void wait_for_any(std::span<const ChildProgram* const> programs, int milliseconds);

  /// The status if it has ended.
  std::optional<ProcessStatus> status();
  /// Waits for its end.
  ProcessStatus wait();
  /// Requests its end; any thread may call it, also while another one waits in write(), which then returns false.
  /// POSIX: SIGTERM. Windows: its input ends.
  void request_end();
  /// Ends it at once.
  void kill() noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The path by which this program can start itself again.
std::string own_program();

}  // namespace morula::platform
