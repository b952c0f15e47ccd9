// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX has more in it
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __APPLE__
#include <crt_externs.h>
#include <mach-o/dyld.h>
#endif

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "platform/posix/pipe.hpp"

#ifndef __APPLE__
extern char** environ;
#endif

namespace morula::platform {
namespace {

char** environment() {
#ifdef __APPLE__
  return *_NSGetEnviron();
#else
  return environ;
#endif
}

ProcessStatus status_of(int status) {
  if (WIFSIGNALED(status)) return {WTERMSIG(status), true};
  return {WEXITSTATUS(status), false};
}

/// Parameters of posix_spawn(), which free themselves.
struct SpawnPlan {
  SpawnPlan() {
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};
};

/// Appends what a pipe holds. False at its end.
bool read_part(Pipe& pipe, std::string& text) {
  if (pipe.ends[0] < 0) return false;
  std::array<char, 1 << 16> part;
  for (;;) {
    const ssize_t count = read(pipe.ends[0], part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return true;
    if (count > 0) {
      text.append(part.data(), static_cast<std::size_t>(count));
      return true;
    }
    pipe.close(0);
    return false;
  }
}

}  // namespace

struct ChildProgram::State {
  pid_t id = -1;
  std::optional<ProcessStatus> ended;
  std::optional<Pipe> in, out, err;

  void start(const std::string& path, const std::vector<std::string>& words, const ProgramStreams& streams,
             bool is_searched) {
    if (streams.writes_input) in.emplace();
    out.emplace();
    if (streams.reads_errors) err.emplace();
    SpawnPlan plan;
    if (in)
      posix_spawn_file_actions_adddup2(&plan.files, in->ends[0], STDIN_FILENO);
    else
      posix_spawn_file_actions_addopen(&plan.files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&plan.files, out->ends[1], STDOUT_FILENO);
    if (err) posix_spawn_file_actions_adddup2(&plan.files, err->ends[1], STDERR_FILENO);
    sigset_t none, ends;
    sigemptyset(&none);
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    posix_spawnattr_setsigmask(&plan.attributes, &none);
    posix_spawnattr_setsigdefault(&plan.attributes, &ends);
    posix_spawnattr_setflags(&plan.attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    std::vector<std::string> copies = words;
    std::vector<char*> pointers;
    for (std::string& word : copies) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const auto spawn = is_searched ? posix_spawnp : posix_spawn;
    const int error = spawn(&id, path.c_str(), &plan.files, &plan.attributes, pointers.data(), environment());
    if (error != 0) throw std::system_error(error, std::generic_category(), "no process can be started");
    if (in) in->close(0);
    out->close(1);
    if (err) err->close(1);
    for (const std::optional<Pipe>* pipe : {&out, &err})
      if (*pipe) fcntl((*pipe)->ends[0], F_SETFL, fcntl((*pipe)->ends[0], F_GETFL) | O_NONBLOCK);
  }
};

ChildProgram::ChildProgram(const std::vector<std::string>& words, const ProgramStreams& streams)
    : state_(std::make_unique<State>()) {
  state_->start(words.at(0), words, streams, true);
}

ChildProgram::ChildProgram(const std::string& path, const std::vector<std::string>& words,
                           const ProgramStreams& streams)
    : state_(std::make_unique<State>()) {
  state_->start(path, words, streams, false);
}

ChildProgram::~ChildProgram() {
  if (state_->ended) return;
  kill();
  wait();
}

bool ChildProgram::write(std::string_view bytes) {
  return state_->in && state_->in->ends[1] >= 0 && write_all(state_->in->ends[1], bytes);
}

void ChildProgram::close_streams() {
  for (std::optional<Pipe>* pipe : {&state_->in, &state_->out, &state_->err}) pipe->reset();
}

bool ChildProgram::read_output(std::string& text) {
  return state_->out && read_part(*state_->out, text);
}

bool ChildProgram::read_errors(std::string& text) {
  return state_->err && read_part(*state_->err, text);
}

void ChildProgram::wait_for_any(std::span<const ChildProgram* const> programs, int milliseconds) {
  std::vector<pollfd> waits;
  for (const ChildProgram* program : programs)
    for (const std::optional<Pipe>* pipe : {&program->state_->out, &program->state_->err})
      if (*pipe && (*pipe)->ends[0] >= 0) waits.push_back({(*pipe)->ends[0], POLLIN, 0});
  poll(waits.data(), static_cast<nfds_t>(waits.size()), milliseconds);
}

std::optional<ProcessStatus> ChildProgram::status() {
  int status = 0;
  if (state_->ended) return state_->ended;
  const pid_t id = waitpid(state_->id, &status, WNOHANG);
  // A program that ignores SIGCHLD has no child to wait for once it ended; its number may be another process then.
  if (id == state_->id || (id < 0 && errno == ECHILD)) state_->ended = status_of(status);
  return state_->ended;
}

ProcessStatus ChildProgram::wait() {
  int status = 0;
  if (!state_->ended) {
    while (waitpid(state_->id, &status, 0) < 0 && errno == EINTR) {
    }
    state_->ended = status_of(status);
  }
  return *state_->ended;
}

void ChildProgram::request_end() {
  if (!state_->ended) ::kill(state_->id, SIGTERM);
}

void ChildProgram::kill() noexcept {
  if (!state_->ended) ::kill(state_->id, SIGKILL);
}

std::string own_program() {
#ifdef __APPLE__
  std::string path(4096, '\0');
  auto size = static_cast<std::uint32_t>(path.size());
  if (_NSGetExecutablePath(path.data(), &size) != 0) return {};
  return path.c_str();
#else
  return "/proc/self/exe";
#endif
}

}  // namespace morula::platform
