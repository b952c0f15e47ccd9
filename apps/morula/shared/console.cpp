// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/console.hpp"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>
#include <vector>

namespace morula::cli {
namespace {

struct Written {
  std::mutex mutex;
  std::vector<std::string> names;
};
// Never destroyed: a signal may come after main.
Written& written() {
  static Written& all = *new Written;
  return all;
}

}  // namespace

void say_text(const std::string& text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

bool open_standard_streams() {
  bool has_stdout = true;
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    has_stdout = has_stdout && stream != STDOUT_FILENO;
    // The lowest number that is free is this one.
    const int opened = open("/dev/null", stream == STDIN_FILENO ? O_RDONLY : O_WRONLY);
    static_cast<void>(opened);
  }
  return has_stdout;
}

void note_written(const std::filesystem::path& path) {
  const std::lock_guard lock(written().mutex);
  written().names.push_back(path.string());
}

std::string written_so_far() {
  const std::lock_guard lock(written().mutex);
  const std::vector<std::string>& names = written().names;
  if (names.empty()) return {};
  return fmt::format("; {} {} written", fmt::join(names, " and "), names.size() > 1 ? "are" : "is");
}

}  // namespace morula::cli
