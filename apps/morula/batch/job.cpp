// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/job.hpp"

#include <fcntl.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX has more in it
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <cerrno>
#include <chrono>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace morula::cli {
namespace {
namespace fs = std::filesystem;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Program {
  std::string path = "/proc/self/exe";
  std::vector<std::string> words{"morula"};
};
Program& program() {
  static Program of_jobs;
  return of_jobs;
}

// Only what may be called between fork and exec.
[[noreturn]] void become(const char* path, char* const* arguments, const char* out, const char* err,
                         const JobLimits& limits, pid_t parent) {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a batch that is killed leaves nothing running
  if (getppid() != parent) _exit(127);
#else
  (void)parent;
#endif
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // Ctrl-C is for the batch, which ends its jobs itself.
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_DFL);
  if (limits.megabytes) {
    const rlim_t bytes = static_cast<rlim_t>(*limits.megabytes) << 20;
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int null = open("/dev/null", O_RDONLY), to = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0600),
            faults = open(err, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (null < 0 || to < 0 || faults < 0 || dup2(null, 0) < 0 || dup2(to, 1) < 0 || dup2(faults, 2) < 0) _exit(127);
  execv(path, arguments);
  _exit(127);
}

}  // namespace

void start_jobs_as(const std::string& path, const std::vector<std::string>& words) {
  program() = {path, words};
}

Job::Job(const std::vector<std::string>& arguments, const fs::path& scratch, const JobLimits& limits)
    : out_(scratch.string() + ".out"), err_(scratch.string() + ".err"), limits_(limits), begun_(now()) {
  std::vector<std::string> words = program().words;
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ < 0) throw std::system_error(errno, std::generic_category(), "cannot start a process");
  if (process_ == 0) become(program().path.c_str(), pointers.data(), out_.c_str(), err_.c_str(), limits_, parent);
}

Job::Job(Job&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      out_(std::exchange(other.out_, {})),
      err_(std::exchange(other.err_, {})),
      limits_(other.limits_),
      begun_(other.begun_),
      killed_(other.killed_) {}

Job::~Job() {
  if (process_ > 0) {
    kill(process_, SIGTERM);  // it removes what it has not finished
    int status = 0;
    for (int tries = 0; waitpid(process_, &status, WNOHANG) == 0; ++tries) {
      if (tries == 50) kill(process_, SIGKILL);
      usleep(20'000);
    }
  }
  remove_files();
}

void Job::remove_files() noexcept {
  std::error_code ignored;
  if (!out_.empty()) fs::remove(out_, ignored);
  if (!err_.empty()) fs::remove(err_, ignored);
}

std::optional<JobResult> Job::poll() {
  int status = 0;
  rusage usage{};
  const pid_t ended = wait4(process_, &status, WNOHANG, &usage);
  const double seconds = now() - begun_;
  if (ended == 0) {
    if (limits_.seconds && seconds > *limits_.seconds) {
      // First as asked, so that it leaves nothing behind; a second later for good.
      kill(process_, !killed_ || seconds < *limits_.seconds + 1 ? SIGTERM : SIGKILL);
      killed_ = true;
    }
    return std::nullopt;
  }
  process_ = -1;
  JobResult result;
  result.seconds = seconds;
  if (ended > 0) {
    result.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
    result.peak_megabytes = static_cast<double>(usage.ru_maxrss) / 1024;
  }
  result.end = killed_               ? JobResult::End::out_of_time
               : WIFSIGNALED(status) ? JobResult::End::signalled
                                     : JobResult::End::exited;
  result.code = WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
  result.out = text_of(out_);
  result.err = text_of(err_);
  remove_files();
  return result;
}

}  // namespace morula::cli
