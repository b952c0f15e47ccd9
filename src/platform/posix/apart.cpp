// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/apart.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX has more in it
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "platform/posix/pipe.hpp"

namespace morula::platform {
namespace {

volatile std::sig_atomic_t end_requested = 0;

extern "C" {
static void note_request_to_end(int) {
  end_requested = 1;
}
}

double seconds_since_start() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Address space of this process, in bytes; 0 where the system does not say.
rlim_t own_address_space() {
  std::ifstream in("/proc/self/statm");
  rlim_t pages = 0;
  in >> pages;
  return in ? pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) : 0;
}

void limit_memory(std::optional<std::size_t> megabytes) {
  if (megabytes) {
    const rlim_t bytes = own_address_space() + (static_cast<rlim_t>(*megabytes) << 20);
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
}

// The process of the work. Nothing leaves it but its exit: what it throws must not go on as a second worker.
[[noreturn]] void run_forked(const ApartWork& work, const ApartFiles& files, const ApartLimits& limits,
                             pid_t worker) noexcept {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a worker that is killed leaves nothing running
  if (getppid() != worker) _exit(127);
#else
  static_cast<void>(worker);
#endif
  const int null = open("/dev/null", O_RDONLY);
  if (null < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(static_cast<int>(files.out.number()), STDOUT_FILENO) < 0 ||
      dup2(static_cast<int>(files.errors.number()), STDERR_FILENO) < 0)
    _exit(127);
  signal(SIGTERM, SIG_DFL);
  limit_memory(limits.megabytes);
  const int code = work.run();
  std::fflush(nullptr);
  _exit(code);
}

// True when no answer is needed: the input is closed, or the end of the worker was requested.
bool should_leave() {
  if (end_requested != 0) return true;
  pollfd input{STDIN_FILENO, 0, 0};
  return poll(&input, 1, 0) > 0 && (input.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

// A process whose end is requested removes its unfinished files.
void end_softly(pid_t process) {
  kill(process, SIGTERM);
  for (int tries = 0; tries < 50; ++tries) {
    if (waitpid(process, nullptr, WNOHANG) != 0) return;
    usleep(10'000);
  }
  kill(process, SIGKILL);
  waitpid(process, nullptr, 0);
}

ApartEnd wait_for(pid_t process, int end_of_process, const ApartLimits& limits) {
  constexpr double grace = 1;  // seconds, between the request to end and the end
  ApartEnd end;
  const double begun = seconds_since_start();
  int status = 0;
  rusage usage{};
  std::array<pollfd, 2> waits{{{STDIN_FILENO, 0, 0}, {end_of_process, POLLIN, 0}}};
  while (wait4(process, &status, WNOHANG, &usage) == 0) {
    if (should_leave()) {
      end_softly(process);
      end.how = ApartEnd::How::abandoned;
      return end;
    }
    double rest = 1;  // seconds until the time is over, or until the next look
    if (limits.seconds) rest = std::min(rest, *limits.seconds - (seconds_since_start() - begun));
    if (rest < 0) {
      kill(process, rest > -grace ? SIGTERM : SIGKILL);
      end.how = ApartEnd::How::out_of_time;
      usleep(2'000);
      continue;
    }
    poll(waits.data(), waits.size(), static_cast<int>(rest * 1000) + 1);
    // Its end is seen a moment before it can be waited for.
    if (waits[1].revents != 0) usleep(100);
  }
#ifdef __APPLE__
  constexpr double memory_units = 1 << 20;  // ru_maxrss is in bytes
#else
  constexpr double memory_units = 1 << 10;
#endif
  end.seconds = seconds_since_start() - begun;
  end.status = WIFSIGNALED(status) ? ProcessStatus{WTERMSIG(status), true} : ProcessStatus{WEXITSTATUS(status), false};
  end.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  end.peak_megabytes = static_cast<double>(usage.ru_maxrss) / memory_units;
  return end;
}

}  // namespace

void become_worker() {
  signal(SIGINT, SIG_IGN);
  signal(SIGHUP, SIG_IGN);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGCHLD, SIG_DFL);  // the program that started it may ignore it: then no status of a child can be read
  struct sigaction end {};
  end.sa_handler = note_request_to_end;
  sigaction(SIGTERM, &end, nullptr);
}

bool read_input(std::string& text) {
  std::array<char, 1 << 12> part;
  for (;;) {
    const ssize_t count = read(STDIN_FILENO, part.data(), part.size());
    if (count < 0 && errno == EINTR && end_requested == 0) continue;
    if (count <= 0) return false;
    text.append(part.data(), static_cast<std::size_t>(count));
    return true;
  }
}

bool write_output(std::string_view bytes) {
  return write_all(STDOUT_FILENO, bytes);
}

struct ScratchFile::State {
  std::FILE* file = nullptr;
};

ScratchFile::ScratchFile() : state_(std::make_unique<State>()) {
  state_->file = std::tmpfile();
  if (state_->file == nullptr) throw std::system_error(errno, std::generic_category(), "no temporary file can be made");
  fcntl(fileno(state_->file), F_SETFD, FD_CLOEXEC);
}

ScratchFile::~ScratchFile() {
  std::fclose(state_->file);
}

void ScratchFile::clear() const {
  const int file = fileno(state_->file);
  if (ftruncate(file, 0) != 0 || lseek(file, 0, SEEK_SET) != 0)
    throw std::system_error(errno, std::generic_category(), "a temporary file cannot be emptied");
}

std::string ScratchFile::text(std::size_t most) const {
  const int file = fileno(state_->file);
  const off_t size = std::clamp<off_t>(lseek(file, 0, SEEK_END), 0, static_cast<off_t>(most));
  std::string text(static_cast<std::size_t>(size), '\0');
  const ssize_t count = pread(file, text.data(), text.size(), 0);
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return text;
}

std::uint64_t ScratchFile::number() const {
  return static_cast<std::uint64_t>(fileno(state_->file));
}

bool write_scratch(std::uint64_t number, std::string_view bytes) {
  return write_all(static_cast<int>(number), bytes);
}

ApartEnd run_apart(const ApartWork& work, const ApartFiles& files, const ApartLimits& limits) {
  Pipe ends;
  const pid_t self = getpid(), process = fork();
  if (process == 0) {
    ends.close(0);
    run_forked(work, files, limits, self);
  }
  if (process < 0) throw std::system_error(errno, std::generic_category(), "no process can be started");
  ends.close(1);
  return wait_for(process, ends.ends[0], limits);
}

// A process that was forked has no input, and gets signals.
void leave_with_input(void (*)(int)) {}

}  // namespace morula::platform
