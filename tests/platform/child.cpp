// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The program that tests of child processes start.
//   words WORDS...   prints each word in hexadecimal digits, one a line
//   echo             copies its input to its output, and "end" to its errors
//   exit CODE        ends with this code
//   crash            ends by an access to no memory
//   hold FILE        writes half a file and half a folder beside it, prints "ready", and waits to be ended
//   deaf             reads nothing and waits to be ended
//   signals          becomes a worker, and gets the signals that are for the program that started it; not on Windows
//   press KEY ID     presses Ctrl-C (c) or Ctrl-Break (break) in the console of a process; Windows only
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <morula/io/whole_output.hpp>
#include <string>
#include <thread>

#include "platform/apart.hpp"
#include "platform/interrupt.hpp"
#ifdef _WIN32
#include "windows/press.hpp"
#endif

namespace {

void end(int signal) {
  morula::abandon_unfinished();
  std::_Exit(128 + signal);
}

int hold(const std::filesystem::path& path) {
  morula::platform::watch_end_requests(end);
  morula::platform::leave_with_input(end);
  morula::WholeFile file(path);
  file.write("half");
  const morula::WholeFolder folder(path.parent_path() / "folder");
  morula::WholeFile inside(folder.path() / "inside");
  inside.write("half");
  std::cout << "ready\n" << std::flush;
  std::this_thread::sleep_for(std::chrono::minutes(10));
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string order = argc > 1 ? argv[1] : "";
  if (order == "words") {
    for (int k = 2; k < argc; ++k) {
      for (const char* c = argv[k]; *c != '\0'; ++c) std::printf("%02x", static_cast<unsigned char>(*c));
      std::printf("\n");
    }
    return 0;
  }
  if (order == "echo") {
    for (std::string line; std::getline(std::cin, line);) std::cout << line << '\n' << std::flush;
    std::cerr << "end\n";
    return 0;
  }
  if (order == "exit" && argc > 2) return std::atoi(argv[2]);
  if (order == "crash") {
    morula::platform::become_worker();  // no window about it
    volatile int* const nowhere = nullptr;
    *nowhere = 1;
  }
  if (order == "hold" && argc > 2) return hold(argv[2]);
  if (order == "deaf") std::this_thread::sleep_for(std::chrono::minutes(10));
#ifdef _WIN32
  if (order == "press" && argc > 3) return morula::test::press(argv[2], std::stoul(argv[3]));
#else
  if (order == "signals") {
    morula::platform::become_worker();
    for (const int signal : {SIGINT, SIGHUP, SIGPIPE}) std::raise(signal);
    return 0;
  }
#endif
  return 99;
}
