// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pipes between processes.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <string_view>
#include <system_error>

namespace morula::platform {

/// A pipe whose ends other programs do not inherit, and which closes itself. ends[0] is read, ends[1] is written.
struct Pipe {
  Pipe() {
#ifdef __linux__
    // In one step: another thread may start a program between two.
    const bool is_made = pipe2(ends.data(), O_CLOEXEC) == 0;
#else
    const bool is_made = pipe(ends.data()) == 0;
#endif
    if (!is_made) throw std::system_error(errno, std::generic_category(), "no pipe can be made");
    for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close(0);
    close(1);
  }
  void close(std::size_t end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
  std::array<int, 2> ends{-1, -1};
};

inline bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace morula::platform
