// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "running_command.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX has more in it
#include <spawn.h>
#include <sys/wait.h>

extern char** environ;

namespace morula::test {

struct RunningCommand::State {
  pid_t id = -1;
  bool has_ended = false;
};

std::vector<std::pair<int, int>> requests_to_end() {
  return {{SIGINT, 130}, {SIGTERM, 143}, {SIGHUP, 129}};
}

bool RunningCommand::can_send() {
  return true;
}

RunningCommand::RunningCommand(const Workbench& bench, const std::vector<std::string>& arguments,
                               const std::filesystem::path& errors)
    : state_(std::make_unique<State>()) {
  const std::string program = command_path().string();
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), program);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addchdir_np(&files, bench.folder().c_str());
  posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, 2, errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  // A test run in the background has SIGINT ignored, which children would inherit.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  for (const auto& [signal, code] : requests_to_end()) sigaddset(&defaults, signal);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  EXPECT_EQ(posix_spawn(&state_->id, program.c_str(), &files, &attributes, argv.data(), environ), 0);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
}

RunningCommand::~RunningCommand() {
  if (state_->has_ended || state_->id < 0) return;
  ::kill(state_->id, SIGKILL);
  waitpid(state_->id, nullptr, 0);
}

void RunningCommand::send(int signal) const {
  EXPECT_EQ(::kill(state_->id, signal), 0);
}

bool RunningCommand::is_running() const {
  siginfo_t ended{};
  return waitid(P_PID, static_cast<id_t>(state_->id), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0;
}

int RunningCommand::wait() {
  int status = 0;
  EXPECT_EQ(waitpid(state_->id, &status, 0), state_->id);
  state_->has_ended = true;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void RunningCommand::kill() {
  EXPECT_EQ(::kill(state_->id, SIGKILL), 0);
}

}  // namespace morula::test
