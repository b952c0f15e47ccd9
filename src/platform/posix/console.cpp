// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/console.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace morula::platform {
namespace {

int number_of(Stream stream) {
  if (stream == Stream::input) return STDIN_FILENO;
  return stream == Stream::output ? STDOUT_FILENO : STDERR_FILENO;
}

}  // namespace

bool open_standard_streams() {
  bool has_output = true;
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    has_output = has_output && stream != STDOUT_FILENO;
    // The lowest number that is free is this one.
    const int opened = open("/dev/null", stream == STDIN_FILENO ? O_RDONLY : O_WRONLY);
    static_cast<void>(opened);
  }
  return has_output;
}

void restore_console() noexcept {}

bool is_terminal(Stream stream) {
  return isatty(number_of(stream)) != 0;
}

bool is_stream_of(Stream stream, const std::filesystem::path& file) {
  struct stat own {
  }, standard{};
  return stat(file.c_str(), &own) == 0 && fstat(number_of(stream), &standard) == 0 && standard.st_dev == own.st_dev &&
         standard.st_ino == own.st_ino;
}

}  // namespace morula::platform
