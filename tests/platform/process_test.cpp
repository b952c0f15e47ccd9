// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Programs that are started, judged by what a program of the tests says of itself.
#include "platform/process.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <morula/io/whole_output.hpp>
#include <string>
#include <support/scratch_folder.hpp>
#include <system_error>
#include <thread>

#include "platform/interrupt.hpp"

namespace morula::test {
namespace {

using platform::ChildProgram;

std::vector<std::string> call(std::vector<std::string> words) {
  words.insert(words.begin(), MORULA_CHILD);
  return words;
}

/// Reads to the end of the output; without line ends of Windows.
std::string all_output(ChildProgram& program) {
  const std::array<const ChildProgram*, 1> waited{&program};
  std::string text;
  while (program.read_output(text)) ChildProgram::wait_for_any(waited, 100);
  std::erase(text, '\r');
  return text;
}

std::string in_digits(const std::string& word) {
  std::string digits;
  for (const char c : word) {
    const auto byte = static_cast<unsigned char>(c);
    digits += "0123456789abcdef"[byte / 16];
    digits += "0123456789abcdef"[byte % 16];
  }
  return digits;
}

TEST(PlatformProcess, words_arrive_unchanged) {
  const std::vector<std::string> odd{"plain",
                                     "",
                                     " ",
                                     "two words",
                                     "tab\there",
                                     "\"",
                                     "\"quoted\"",
                                     "a\"b c",
                                     "\\",
                                     "\\\\",
                                     "ends in \\",
                                     "ends in two \\\\",
                                     "\\\"",
                                     "a\\\\\"b",
                                     "C:\\Program Files\\x\\",
                                     "%PATH%",
                                     "$HOME",
                                     "a&b|c>d<e^f",
                                     "*.cpp",
                                     "?",
                                     "'single'",
                                     "--name=value with blank",
                                     "K\xc3\xbcgel \xe4\xb8\xad \xf0\x9f\x8c\xb3"};
  std::vector<std::string> words{"words"};
  words.insert(words.end(), odd.begin(), odd.end());
  ChildProgram program(call(words), {});
  std::string expected;
  for (const std::string& word : odd) expected += in_digits(word) + "\n";
  EXPECT_EQ(all_output(program), expected);
  const platform::ProcessStatus status = program.wait();
  EXPECT_EQ(status.code, 0);
  EXPECT_FALSE(status.by_signal);
}

TEST(PlatformProcess, streams_lead_to_and_fro) {
  ChildProgram program(call({"echo"}), {.writes_input = true, .reads_errors = true});
  const std::string line(5000, 'x');
  const std::array<const ChildProgram*, 1> waited{&program};
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(program.write(line + "\n"));
    std::string back;
    while (back.find('\n') == std::string::npos) {
      ASSERT_TRUE(program.read_output(back));
      ChildProgram::wait_for_any(waited, 100);
    }
    EXPECT_EQ(back.substr(0, line.size()), line);
  }
  EXPECT_FALSE(program.status().has_value());
  program.request_end();
  program.wait();
}

TEST(PlatformProcess, exit_codes_and_crashes_are_told_apart) {
  for (const int code : {0, 1, 2, 77, 130, 255}) {
    ChildProgram program(call({"exit", std::to_string(code)}), {});
    const platform::ProcessStatus status = program.wait();
    EXPECT_EQ(status.code, code);
    EXPECT_FALSE(status.by_signal);
  }
  {
    ChildProgram program(call({"crash"}), {.reads_errors = true});
    const platform::ProcessStatus status = program.wait();
    EXPECT_TRUE(status.by_signal);
    EXPECT_EQ(status.code, 11);
    EXPECT_EQ(platform::signal_text(status.code), "Segmentation fault");
  }
}

TEST(PlatformProcess, a_missing_program_is_an_error) {
  for (const char* missing : {"morula-no-such-program", "./morula-no-such-program"}) {
    try {
      ChildProgram program({missing, "word"}, {});
      ADD_FAILURE() << missing << " is started";
    } catch (const std::system_error& error) {
      EXPECT_EQ(error.code().value(), ENOENT) << missing;
    }
  }
}

#ifdef _WIN32
// A shell that reads them would take the second word as a command of its own.
TEST(PlatformProcess, scripts_of_the_shell_are_not_started) {
  const ScratchFolder folder;
  const std::string made = (folder.path() / "made").string();
  for (const char* name : {"a.bat", "B.Cmd"}) {
    const std::string script = folder.file(name, "@echo %1\r\n").string();
    for (const char* end : {"", ".", " ", ". ."}) {
      for (const bool is_path : {false, true}) {
        const std::vector<std::string> words{script + end, "\" & echo made >" + made};
        try {
          if (is_path)
            ChildProgram(script + end, words, {}).wait();
          else
            ChildProgram(words, {}).wait();
          ADD_FAILURE() << script << end << " is started";
        } catch (const std::system_error& error) {
          EXPECT_EQ(error.code().value(), ENOEXEC) << script << end;
        }
      }
    }
  }
  EXPECT_FALSE(std::filesystem::exists(made));
}

TEST(PlatformProcess, the_type_of_a_program_need_not_be_given) {
  std::string name = MORULA_CHILD;
  ASSERT_TRUE(name.ends_with(".exe"));
  std::vector<std::string> names{name, name.substr(0, name.size() - 4), name.substr(0, name.size() - 4) + ".EXE"};
  const std::filesystem::path folder = std::filesystem::absolute(name).parent_path();
  names.push_back(std::filesystem::path(name).stem().string());
  const std::string path = "PATH=;\"" + folder.string() + "\";" + std::getenv("PATH");
  ASSERT_EQ(_putenv(path.c_str()), 0);
  for (const std::string& program : names)
    EXPECT_EQ(ChildProgram({program, "exit", "7"}, {}).wait().code, 7) << program;
}
#else
// Those of a terminal reach all its programs. A worker that they ended would take its build with it, and leave a file.
TEST(PlatformProcess, a_worker_leaves_signals_of_the_terminal_to_the_program_that_started_it) {
  ChildProgram program(call({"signals"}), {});
  const platform::ProcessStatus status = program.wait();
  EXPECT_FALSE(status.by_signal);
  EXPECT_EQ(status.code, 0);
}

// A host program may ignore the ends of its children; their statuses are then lost, but their ends are seen.
TEST(PlatformProcess, ends_are_seen_where_sigchld_is_ignored) {
  struct Ignored {
    void (*before)(int) = std::signal(SIGCHLD, SIG_IGN);
    ~Ignored() { std::signal(SIGCHLD, before); }
  } const ignored;
  ChildProgram program(call({"exit", "0"}), {});
  EXPECT_TRUE(all_output(program).empty());
  for (int tries = 0; tries < 1000 && !program.status(); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(program.status().has_value());
}
#endif

TEST(PlatformProcess, a_request_to_end_calls_back_a_thread_that_writes_to_a_program_that_does_not_read) {
#ifndef _WIN32
  struct Ignored {
    void (*before)(int) = std::signal(SIGPIPE, SIG_IGN);
    ~Ignored() { std::signal(SIGPIPE, before); }
  } const ignored;
#endif
  ChildProgram program(call({"deaf"}), {.writes_input = true});
  const std::string much(std::size_t{1} << 22, 'x');  // more than any pipe holds
  bool is_written = true;
  {
    const std::jthread writer([&] { is_written = program.write(much); });
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    program.request_end();
  }
  EXPECT_FALSE(is_written);
  EXPECT_FALSE(program.write("more"));
}

TEST(PlatformProcess, a_program_ends_with_its_object) {
  const auto begun = std::chrono::steady_clock::now();
  {
    const ScratchFolder folder;
    ChildProgram program(call({"hold", (folder.path() / "a").string()}), {.writes_input = true});
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::minutes(5));
}

TEST(PlatformProcess, a_request_to_end_leaves_nothing_unfinished) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "a";
  write_whole(path, "old");
  ChildProgram program(call({"hold", path.string()}), {.writes_input = true});
  const std::array<const ChildProgram*, 1> waited{&program};
  std::string text;
  while (text.find("ready") == std::string::npos) {
    ASSERT_TRUE(program.read_output(text));
    ChildProgram::wait_for_any(waited, 100);
  }
  EXPECT_EQ(folder.names().size(), 3u);
  program.request_end();
  const platform::ProcessStatus status = program.wait();
  EXPECT_FALSE(status.by_signal);
  EXPECT_EQ(status.code, 128 + platform::end_signal);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a"});
  EXPECT_EQ(bytes_of(path), "old");
}

}  // namespace
}  // namespace morula::test
