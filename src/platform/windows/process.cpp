// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/process.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <system_error>

#include "platform/files.hpp"
#include "platform/windows/launch.hpp"

namespace morula::platform {
namespace {

/// The program that a name means, a file of type .exe. A name without a folder means one of PATH, but none of the
/// current folder, which may be another person's.
std::wstring find_program(const std::string& name) {
  std::wstring plain = wide(name);
  if (!has_type(plain, L".exe") && !is_script(plain)) plain += L".exe";
  if (plain.find_first_of(L"/\\:") != plain.npos) return plain;
  std::wstring folders(GetEnvironmentVariableW(L"PATH", nullptr, 0), L'\0');
  folders.resize(GetEnvironmentVariableW(L"PATH", folders.data(), static_cast<DWORD>(folders.size())));
  for (std::size_t begin = 0; begin < folders.size();) {
    const std::size_t end = std::min(folders.find(L';', begin), folders.size());
    std::wstring folder = folders.substr(begin, end - begin);
    std::erase(folder, L'"');
    begin = end + 1;
    if (!std::filesystem::path(folder).is_absolute()) continue;
    const std::filesystem::path found = std::filesystem::path(folder) / plain;
    if (kind_of(found) == NodeKind::file) return found.native();
  }
  throw std::system_error(ENOENT, std::generic_category(), "no process can be started");
}

// Bytes that wait in a pipe; none at its end.
std::optional<DWORD> waiting_in(const Handle& pipe) {
  DWORD count = 0;
  if (!pipe || PeekNamedPipe(pipe.get(), nullptr, 0, nullptr, &count, nullptr) == 0) return std::nullopt;
  return count;
}

bool read_part(Handle& pipe, std::string& text) {
  constexpr DWORD most = 1 << 16;
  const std::optional<DWORD> waiting = waiting_in(pipe);
  if (!waiting) {
    pipe.close();
    return false;
  }
  if (*waiting == 0) return true;
  const std::size_t before = text.size();
  text.resize(before + std::min(*waiting, most));
  DWORD count = 0;
  const bool is_read =
      ReadFile(pipe.get(), text.data() + before, static_cast<DWORD>(text.size() - before), &count, nullptr) != 0;
  text.resize(before + count);
  return is_read;
}

}  // namespace

struct ChildProgram::State {
  Launched launched;
  std::optional<ProcessStatus> ended;
  std::atomic<bool> is_killed = false;
  std::mutex mutex;  // of the next four
  Handle in;
  Handle writer;  // the thread that writes to it
  bool is_writing = false, is_ending = false;
  Handle out, err;

  void start(const std::wstring& path, const std::vector<std::string>& words, const ProgramStreams& streams) {
    LaunchPipe to, from = pipe_from_program(), errors;
    if (streams.writes_input)
      to = pipe_to_program();
    else
      to.theirs = null_device(GENERIC_READ);
    if (streams.reads_errors)
      errors = pipe_from_program();
    else
      errors.theirs = inherited_stream(STD_ERROR_HANDLE);
    launched = launch(path, words, {to.theirs.get(), from.theirs.get(), errors.theirs.get()}, nullptr, {});
    in = std::move(to.ours);
    out = std::move(from.ours);
    err = std::move(errors.ours);
  }
  // Without the mutex, a thread writes and waits as long as the program does not read.
  bool begin_writing() {
    const std::lock_guard lock(mutex);
    if (!in || is_ending) return false;
    HANDLE thread = nullptr;
    const HANDLE self = GetCurrentProcess();
    if (DuplicateHandle(self, GetCurrentThread(), self, &thread, 0, FALSE, DUPLICATE_SAME_ACCESS) == 0) return false;
    writer = Handle(thread);
    return is_writing = true;
  }
  void end_writing() {
    const std::lock_guard lock(mutex);
    is_writing = false;
    writer.close();
    if (is_ending) in.close();
  }
  /// Closes the input. A thread that waits in a call of the system is called back, if need be by the program's end.
  void end_input() {
    std::unique_lock lock(mutex);
    is_ending = true;
    if (!is_writing) in.close();
    for (int tries = 0; is_writing; ++tries) {
      constexpr int most_tries = 1000;
      if (tries < most_tries)
        CancelSynchronousIo(writer.get());  // none, if the thread is between two calls
      else
        is_killed = TerminateProcess(launched.process.get(), 1) != 0;
      lock.unlock();
      Sleep(1);
      lock.lock();
    }
  }
  ProcessStatus take_status() {
    ended = is_killed ? ProcessStatus{9, true} : status_of(launched.process.get());
    return *ended;
  }
};

ChildProgram::ChildProgram(const std::vector<std::string>& words, const ProgramStreams& streams)
    : state_(std::make_unique<State>()) {
  state_->start(find_program(words.at(0)), words, streams);
}

ChildProgram::ChildProgram(const std::string& path, const std::vector<std::string>& words,
                           const ProgramStreams& streams)
    : state_(std::make_unique<State>()) {
  state_->start(wide(path), words, streams);
}

ChildProgram::~ChildProgram() {
  if (state_->ended) return;
  kill();
  wait();
}

bool ChildProgram::write(std::string_view bytes) {
  if (!state_->begin_writing()) return false;
  bool is_written = true;
  while (is_written && !bytes.empty()) {
    DWORD count = 0;
    const auto part = static_cast<DWORD>(std::min<std::size_t>(bytes.size(), 1 << 12));
    is_written = WriteFile(state_->in.get(), bytes.data(), part, &count, nullptr) != 0;
    bytes.remove_prefix(count);
    const std::lock_guard lock(state_->mutex);
    is_written = is_written && !state_->is_ending;
  }
  state_->end_writing();
  return is_written;
}

void ChildProgram::close_streams() {
  request_end();
  state_->out.close();
  state_->err.close();
}

bool ChildProgram::read_output(std::string& text) {
  return read_part(state_->out, text);
}

bool ChildProgram::read_errors(std::string& text) {
  return read_part(state_->err, text);
}

// Pipes cannot be waited for; each is read in turn.
void ChildProgram::wait_for_any(std::span<const ChildProgram* const> programs, int milliseconds) {
  const ULONGLONG end = GetTickCount64() + static_cast<ULONGLONG>(std::max(milliseconds, 0));
  for (DWORD pause = 1;; pause = std::min<DWORD>(pause + 1, 10)) {
    for (const ChildProgram* program : programs) {
      for (const Handle* pipe : {&program->state_->out, &program->state_->err}) {
        if (!*pipe) continue;
        const std::optional<DWORD> waiting = waiting_in(*pipe);
        if (!waiting || *waiting > 0) return;
      }
    }
    if (GetTickCount64() >= end) return;
    Sleep(pause);
  }
}

std::optional<ProcessStatus> ChildProgram::status() {
  if (!state_->ended && WaitForSingleObject(state_->launched.process.get(), 0) == WAIT_OBJECT_0) state_->take_status();
  return state_->ended;
}

ProcessStatus ChildProgram::wait() {
  if (!state_->ended) {
    WaitForSingleObject(state_->launched.process.get(), INFINITE);
    state_->take_status();
  }
  return *state_->ended;
}

void ChildProgram::request_end() {
  state_->end_input();
}

void ChildProgram::kill() noexcept {
  if (state_->ended) return;
  state_->is_killed = TerminateProcess(state_->launched.process.get(), 1) != 0;
}

std::string own_program() {
  std::wstring path(32768, L'\0');
  path.resize(GetModuleFileNameW(nullptr, path.data(), static_cast<DWORD>(path.size())));
  std::string text(4 * path.size(), '\0');
  text.resize(
      static_cast<std::size_t>(WideCharToMultiByte(CP_UTF8, 0, path.data(), static_cast<int>(path.size()), text.data(),
                                                   static_cast<int>(text.size()), nullptr, nullptr)));
  return text;
}

}  // namespace morula::platform
