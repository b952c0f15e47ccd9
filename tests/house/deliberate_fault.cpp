// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Does what sanitizers are there to stop, as its argument says. Where it ends well, no test of that build can fail by
// them.
#include <cstdio>
#include <limits>
#include <string_view>
#include <thread>
#include <vector>

int main(int argc, char** argv) {
  const std::string_view fault = argc == 2 ? argv[1] : "";
  int result = argc;
  if (fault == "overflow") result += std::numeric_limits<int>::max();
  if (fault == "cast") result = static_cast<int>(std::numeric_limits<double>::quiet_NaN() * argc);
  if (fault == "memory") {
    const std::vector<int> numbers(static_cast<std::size_t>(argc));
    result = numbers.data()[argc];
  }
  if (fault == "race") {
    std::thread other([&] { ++result; });
    ++result;
    other.join();
  }
  std::printf("%d\n", result);
  return 0;
}
