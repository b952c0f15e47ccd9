// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/worker.hpp"

#include <fcntl.h>
#include <fmt/format.h>
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
#include <cstring>
#include <fstream>
#include <memory>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <new>
#include <string_view>
#include <system_error>

#include "batch/serve.hpp"
#include "command_line.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/interrupt.hpp"

namespace morula::cli {
namespace {
namespace fs = std::filesystem;
using How = ProcessEnd::How;

constexpr const char* measure_word = "--measure";

struct WorkerProgram {
  std::string path = "/proc/self/exe";
  std::vector<std::string> words{"morula"};
};
WorkerProgram& worker_program() {
  static WorkerProgram program;
  return program;
}

double seconds_since_start() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

bool make_pipe(int (&ends)[2]) {
  if (pipe(ends) != 0) return false;
  for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
  return true;
}

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

// Address space of this process, in bytes; 0 where the system does not say.
rlim_t own_address_space() {
  std::ifstream in("/proc/self/statm");
  rlim_t pages = 0;
  in >> pages;
  return in ? pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) : 0;
}

// A file without a name, which takes a stream of one build after the other.
class StreamFile {
 public:
  StreamFile() : file_(std::tmpfile()) {
    if (file_ == nullptr) throw std::system_error(errno, std::generic_category(), "no temporary file can be made");
    fcntl(number(), F_SETFD, FD_CLOEXEC);
  }
  ~StreamFile() { std::fclose(file_); }
  StreamFile(const StreamFile&) = delete;
  StreamFile& operator=(const StreamFile&) = delete;

  int number() const { return fileno(file_); }
  void clear() const {
    if (ftruncate(number(), 0) != 0 || lseek(number(), 0, SEEK_SET) != 0)
      throw std::system_error(errno, std::generic_category(), "a temporary file cannot be emptied");
  }
  std::string text() const {
    constexpr off_t most = 1 << 24;  // bytes; more is no report
    std::string text(static_cast<std::size_t>(std::clamp<off_t>(lseek(number(), 0, SEEK_END), 0, most)), '\0');
    const ssize_t count = pread(number(), text.data(), text.size(), 0);
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return text;
  }

 private:
  std::FILE* file_;
};

struct Streams {
  StreamFile out, figures, errors;
};

// Figures of the fit, per level, of the tree that the build has written: those of `morula measure`.
Json figures_of(const BatchTask& task) {
  const Mesh mesh = read_mesh(task.mesh);
  MeasureOptions options;
  options.open_by_winding = true;
  const std::vector<LevelMeasure> levels = measure(mesh, read_tree(task.tree).tree, options, serial_workers());
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  Json figures{{"closed", inspect(mesh).closed}};
  for (const char* name : {"looseness", "uncovered_area", "uncovered_distance", "protrusion"})
    figures[name] = Json::array();
  for (const LevelMeasure& level : levels) {
    figures["looseness"].push_back(number(level.looseness.looseness));
    figures["uncovered_area"].push_back(level.coverage.uncovered_area);
    figures["uncovered_distance"].push_back(level.coverage.uncovered_distance);
    figures["protrusion"].push_back(number(level.protrusion ? std::optional(level.protrusion->worst) : std::nullopt));
  }
  return figures;
}

int measure_built(const BatchTask& task, const Streams& streams) {
  try {
    return write_all(streams.figures.number(), json_text(figures_of(task), -1)) ? exit_done : exit_check_failed;
  } catch (const std::bad_alloc&) {
    return complain_text(exit_internal_error, "not enough memory");
  } catch (const std::exception& error) {
    return complain_text(exit_check_failed, error.what());
  }
}

// `morula build`, then figures if they are requested. Returns the exit code.
int build_and_measure(const BatchTask& task, const Streams& streams) {
  std::vector<std::string> words{"morula", "build", task.mesh.native(), "-o", task.tree.native(), "--threads",
                                 "1",      "--json"};
  bool measures = false;
  for (const std::string& word : task.words) {
    if (word == measure_word)
      measures = true;
    else
      words.push_back(word);
  }
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int code = command_line(static_cast<int>(words.size()), pointers.data());
  return code == exit_done && measures ? measure_built(task, streams) : code;
}

void limit_memory(const BatchTask& task) {
  if (task.megabytes) {
    const rlim_t bytes = own_address_space() + (static_cast<rlim_t>(*task.megabytes) << 20);
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
}

// The process of one build. Nothing leaves it but its exit: what it throws must not go on as a second worker.
[[noreturn]] void run_build(const BatchTask& task, const Streams& streams, pid_t worker) noexcept {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a worker that is killed leaves nothing running
  if (getppid() != worker) _exit(127);
#else
  (void)worker;
#endif
  const int null = open("/dev/null", O_RDONLY);
  if (null < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(streams.out.number(), STDOUT_FILENO) < 0 ||
      dup2(streams.errors.number(), STDERR_FILENO) < 0)
    _exit(127);
  signal(SIGTERM, SIG_DFL);
  int code = exit_internal_error;
  try {
    write_messages_as_json(true);
    limit_memory(task);
    watch_signals();
    code = build_and_measure(task, streams);
  } catch (const std::bad_alloc&) {
    code = complain_text(exit_internal_error, "not enough memory");
  }
  std::fflush(nullptr);
  _exit(code);
}

volatile std::sig_atomic_t end_requested = 0;

extern "C" {
static void note_request_to_end(int) {
  end_requested = 1;
}
}

// True when no answer is needed: the input is closed, or the end of the worker was requested.
bool should_leave() {
  if (end_requested != 0) return true;
  pollfd input{STDIN_FILENO, 0, 0};
  return poll(&input, 1, 0) > 0 && (input.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

// Ends the build and this worker. A build whose end is requested removes its unfinished files.
[[noreturn]] void leave_with(pid_t build) {
  kill(build, SIGTERM);
  for (int tries = 0; tries < 50 && waitpid(build, nullptr, WNOHANG) == 0; ++tries) usleep(10'000);
  kill(build, SIGKILL);
  _exit(exit_done);
}

// Waits until the build ends or its time is over. When the batch is gone the worker ends, and the build with it.
ProcessEnd wait_for(pid_t build, int end_of_build, const BatchTask& task) {
  constexpr double grace = 1;  // seconds, between the request to end and the end
  ProcessEnd end;
  const double begun = seconds_since_start();
  int status = 0;
  rusage usage{};
  std::array<pollfd, 2> waits{{{STDIN_FILENO, 0, 0}, {end_of_build, POLLIN, 0}}};
  while (wait4(build, &status, WNOHANG, &usage) == 0) {
    if (should_leave()) leave_with(build);
    double rest = 1;  // seconds until the time is over, or until the next look
    if (task.time_limit) rest = std::min(rest, *task.time_limit - (seconds_since_start() - begun));
    if (rest < 0) {
      kill(build, rest > -grace ? SIGTERM : SIGKILL);
      end.how = How::out_of_time;
      usleep(2'000);
      continue;
    }
    poll(waits.data(), waits.size(), static_cast<int>(rest * 1000) + 1);
    // Its end is seen a moment before it can be waited for.
    if (waits[1].revents != 0) usleep(100);
  }
  end.seconds = seconds_since_start() - begun;
  if (end.how != How::out_of_time && WIFSIGNALED(status)) end.how = How::signaled;
  end.code = WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
  end.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  end.peak_megabytes = static_cast<double>(usage.ru_maxrss) / 1024;
  return end;
}

ProcessEnd build_apart(const BatchTask& task, const Streams& streams) {
  for (const StreamFile* stream : {&streams.out, &streams.figures, &streams.errors}) stream->clear();
  int ends[2];
  if (!make_pipe(ends)) throw std::system_error(errno, std::generic_category(), "no pipe can be made");
  const pid_t self = getpid(), build = fork();
  if (build == 0) {
    close(ends[0]);
    run_build(task, streams, self);
  }
  close(ends[1]);
  if (build < 0) {
    close(ends[0]);
    throw std::system_error(errno, std::generic_category(), "no process can be started");
  }
  ProcessEnd end = wait_for(build, ends[0], task);
  close(ends[0]);
  end.out = streams.out.text();
  end.figures = streams.figures.text();
  end.errors = streams.errors.text();
  return end;
}

Json keep(const Json& result, const BatchTask& task) {
  std::error_code ignored;
  if (task.no_trees || result.at("status") != "ok") fs::remove(task.tree, ignored);
  if (!task.result.empty()) write_whole(task.result, result_text(result));
  return result;
}

// A write to a link goes to its target, which may be the kept result of another mesh.
void remove_link(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_symlink(fs::symlink_status(path, ignored))) fs::remove(path, ignored);
}

// Nothing that happens to one mesh ends the worker; a result that cannot be kept is one that failed, and is tried again
// the next time.
Json result_of_task(const BatchTask& task, const Streams& streams) {
  try {
    fs::create_directories(task.tree.parent_path());
    if (!task.result.empty()) fs::create_directories(task.result.parent_path());
    for (const fs::path* path : {&task.tree, &task.result}) remove_link(*path);
    bool is_kept = true;
    const Json result = result_of(build_apart(task, streams), task, is_kept);
    return is_kept ? keep(result, task) : result;
  } catch (const std::exception& error) {
    return result_without_build(task.key, "failed", fmt::format("cannot be kept: {}", error.what()));
  }
}

bool read_line(std::string& waiting, std::string& line) {
  for (;;) {
    if (const std::size_t end = waiting.find('\n'); end != std::string::npos) {
      line = waiting.substr(0, end);
      waiting.erase(0, end + 1);
      return true;
    }
    std::array<char, 1 << 12> part;
    const ssize_t count = read(STDIN_FILENO, part.data(), part.size());
    if (count < 0 && errno == EINTR && end_requested == 0) continue;
    if (count <= 0) return false;
    waiting.append(part.data(), static_cast<std::size_t>(count));
  }
}

// Only what may be called between fork and exec.
[[noreturn]] void become_worker(const char* path, char* const* words, int in, int out) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  signal(SIGTERM, SIG_DFL);
  if (dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0) _exit(127);
  execv(path, words);
  _exit(127);
}

}  // namespace

bool is_worker(int argc, char** argv) {
  return argc == 2 && std::strcmp(argv[1], worker_word) == 0;
}

int serve_batch() {
  // Ctrl-C is for the batch, which ends its workers itself.
  signal(SIGINT, SIG_IGN);
  signal(SIGPIPE, SIG_IGN);
  struct sigaction end {};
  end.sa_handler = note_request_to_end;
  sigaction(SIGTERM, &end, nullptr);
  try {
    const Streams streams;
    std::string waiting, line;
    while (read_line(waiting, line)) {
      const Json result = result_of_task(task_of_line(line), streams);
      if (!write_all(STDOUT_FILENO, json_text(result, -1) + "\n")) break;
    }
  } catch (const std::exception& error) {
    return complain_text(exit_internal_error, error.what());
  }
  return exit_done;
}

void start_workers_as(const std::string& program, const std::vector<std::string>& words) {
  worker_program() = {program, words};
}

BatchWorker::BatchWorker() {
  std::vector<std::string> words = worker_program().words;
  words.emplace_back(worker_word);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  int in[2], out[2];
  if (!make_pipe(in)) throw std::system_error(errno, std::generic_category(), "no pipe can be made");
  if (!make_pipe(out)) {
    const int error = errno;
    for (const int end : in) close(end);
    throw std::system_error(error, std::generic_category(), "no pipe can be made");
  }
  process_ = fork();
  if (process_ == 0) become_worker(worker_program().path.c_str(), pointers.data(), in[0], out[1]);
  const int error = errno;
  close(in[0]);
  close(out[1]);
  to_ = in[1];
  from_ = out[0];
  if (process_ < 0) {
    close(to_);
    close(from_);
    throw std::system_error(error, std::generic_category(), "no process can be started");
  }
  fcntl(from_, F_SETFL, fcntl(from_, F_GETFL) | O_NONBLOCK);
}

BatchWorker::~BatchWorker() {
  close(to_);  // the end of its input ends it
  close(from_);
  int status = 0;
  for (int tries = 0; waitpid(process_, &status, WNOHANG) == 0; ++tries) {
    if (tries == 200) kill(process_, SIGKILL);
    usleep(tries < 20 ? 500 : 10'000);
  }
}

void BatchWorker::give(const BatchTask& task) {
  if (!write_all(to_, task_line(task) + "\n")) is_gone_ = true;
}

std::optional<std::string> BatchWorker::answer() {
  std::array<char, 1 << 12> part;
  for (;;) {
    if (const std::size_t end = read_.find('\n'); end != std::string::npos) {
      std::string line = read_.substr(0, end);
      read_.erase(0, end + 1);
      return line;
    }
    const ssize_t count = read(from_, part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return std::nullopt;
    if (count <= 0) {
      is_gone_ = true;
      return std::nullopt;
    }
    read_.append(part.data(), static_cast<std::size_t>(count));
  }
}

void BatchWorker::request_end() const {
  kill(process_, SIGTERM);
}

bool BatchSeat::has_worker() {
  const std::lock_guard lock(mutex_);
  if (is_stopped_) return false;
  if (!worker_ || worker_->is_gone()) worker_ = std::make_unique<BatchWorker>();
  return true;
}

void BatchSeat::stop() {
  const std::lock_guard lock(mutex_);
  is_stopped_ = true;
  if (worker_) worker_->request_end();
}

std::optional<Json> BatchSeat::build(const BatchTask& task) {
  for (int tries = 0; tries < 2; ++tries) {
    if (!has_worker()) return std::nullopt;
    worker_->give(task);
    while (!worker_->is_gone()) {
      pollfd wait{worker_->answers(), POLLIN, 0};
      poll(&wait, 1, -1);
      const std::optional<std::string> answer = worker_->answer();
      if (!answer) continue;
      if (std::optional<Json> result = whole_result(*answer, task.key)) return result;
      break;
    }
  }
  const std::lock_guard lock(mutex_);
  worker_.reset();
  if (is_stopped_) return std::nullopt;
  return lost_result(task);
}

}  // namespace morula::cli
