// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/apart.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <system_error>
#include <thread>

#include "platform/interrupt.hpp"
#include "platform/windows/launch.hpp"

namespace morula::platform {
namespace {

HANDLE handle_of(std::uint64_t number) {
  return reinterpret_cast<HANDLE>(static_cast<std::uintptr_t>(number));
}

[[noreturn]] void fail(const char* text) {
  throw std::system_error(errno_of(GetLastError()), std::generic_category(), text);
}

bool write_all(HANDLE file, std::string_view bytes) {
  while (!bytes.empty()) {
    DWORD count = 0;
    const auto part = static_cast<DWORD>(std::min<std::size_t>(bytes.size(), 1 << 16));
    if (WriteFile(file, bytes.data(), part, &count, nullptr) == 0 || count == 0) return false;
    bytes.remove_prefix(count);
  }
  return true;
}

// True when no answer is needed: the input is closed.
bool should_leave() {
  DWORD waiting = 0;
  return PeekNamedPipe(GetStdHandle(STD_INPUT_HANDLE), nullptr, 0, nullptr, &waiting, nullptr) == 0 &&
         GetLastError() == ERROR_BROKEN_PIPE;
}

double seconds_of(const FILETIME& time) {
  // In units of 100 ns.
  return 1e-7 * static_cast<double>(static_cast<std::uint64_t>(time.dwHighDateTime) << 32 | time.dwLowDateTime);
}

// Memory that this process has been promised, in bytes.
std::size_t own_memory() {
  PROCESS_MEMORY_COUNTERS memory{};
  memory.cb = sizeof memory;
  return K32GetProcessMemoryInfo(GetCurrentProcess(), &memory, sizeof memory) != 0 ? memory.PagefileUsage : 0;
}

void take_cost(HANDLE process, ApartEnd& end) {
  FILETIME begun{}, ended{}, kernel{}, user{};
  if (GetProcessTimes(process, &begun, &ended, &kernel, &user) != 0)
    end.cpu_seconds = seconds_of(kernel) + seconds_of(user);
  PROCESS_MEMORY_COUNTERS memory{};
  memory.cb = sizeof memory;
  if (K32GetProcessMemoryInfo(process, &memory, sizeof memory) != 0)
    end.peak_megabytes = static_cast<double>(memory.PeakWorkingSetSize) / (1 << 20);
}

// A process whose input ends removes its unfinished files and ends.
void end_softly(HANDLE process, Handle& input) {
  input.close();
  if (WaitForSingleObject(process, 1000) == WAIT_OBJECT_0) return;
  TerminateProcess(process, 1);
  WaitForSingleObject(process, INFINITE);
}

}  // namespace

void become_worker() {
  // Children inherit both: no handler of Ctrl-C, and no window about a crash.
  SetConsoleCtrlHandler(nullptr, TRUE);
  SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOGPFAULTERRORBOX);
}

bool read_input(std::string& text) {
  std::array<char, 1 << 12> part;
  DWORD count = 0;
  const HANDLE input = GetStdHandle(STD_INPUT_HANDLE);
  if (ReadFile(input, part.data(), static_cast<DWORD>(part.size()), &count, nullptr) == 0 || count == 0) return false;
  text.append(part.data(), count);
  return true;
}

bool write_output(std::string_view bytes) {
  return write_all(GetStdHandle(STD_OUTPUT_HANDLE), bytes);
}

struct ScratchFile::State {
  Handle file;
};

ScratchFile::ScratchFile() : state_(std::make_unique<State>()) {
  std::array<wchar_t, MAX_PATH + 1> folder{};
  std::array<wchar_t, MAX_PATH + 1> name{};
  if (GetTempPathW(MAX_PATH, folder.data()) == 0 || GetTempFileNameW(folder.data(), L"tmp", 0, name.data()) == 0)
    fail("no temporary file can be made");
  SECURITY_ATTRIBUTES inheritable{sizeof(SECURITY_ATTRIBUTES), nullptr, TRUE};
  state_->file =
      Handle(CreateFileW(name.data(), GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, &inheritable,
                         CREATE_ALWAYS, FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, nullptr));
  if (!state_->file) fail("no temporary file can be made");
}

ScratchFile::~ScratchFile() = default;

void ScratchFile::clear() const {
  const LARGE_INTEGER start{};
  if (SetFilePointerEx(state_->file.get(), start, nullptr, FILE_BEGIN) == 0 || SetEndOfFile(state_->file.get()) == 0)
    fail("a temporary file cannot be emptied");
}

std::string ScratchFile::text(std::size_t most) const {
  LARGE_INTEGER size{};
  const LARGE_INTEGER start{};
  if (GetFileSizeEx(state_->file.get(), &size) == 0 ||
      SetFilePointerEx(state_->file.get(), start, nullptr, FILE_BEGIN) == 0)
    return {};
  std::string text(std::min(static_cast<std::size_t>(size.QuadPart), most), '\0');
  DWORD count = 0;
  if (ReadFile(state_->file.get(), text.data(), static_cast<DWORD>(text.size()), &count, nullptr) == 0) count = 0;
  text.resize(count);
  return text;
}

std::uint64_t ScratchFile::number() const {
  return reinterpret_cast<std::uintptr_t>(state_->file.get());
}

bool write_scratch(std::uint64_t number, std::string_view bytes) {
  return write_all(handle_of(number), bytes);
}

ApartEnd run_apart(const ApartWork& work, const ApartFiles& files, const ApartLimits& limits) {
  using Clock = std::chrono::steady_clock;
  constexpr DWORD look = 50;  // ms
  JOBOBJECT_EXTENDED_LIMIT_INFORMATION job{};
  if (limits.megabytes) {
    job.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_PROCESS_MEMORY;
    job.ProcessMemoryLimit = own_memory() + (*limits.megabytes << 20);
  }
  LaunchPipe input = pipe_to_program();
  const auto begun = Clock::now();
  const Launched launched =
      launch(wide(work.program), work.words,
             {input.theirs.get(), handle_of(files.out.number()), handle_of(files.errors.number())},
             handle_of(files.extra.number()), job);
  input.theirs.close();
  write_all(input.ours.get(), work.input);
  const HANDLE process = launched.process.get();
  ApartEnd end;
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begun).count(); };
  for (;;) {
    const double rest = limits.seconds ? std::min(*limits.seconds - elapsed(), 1.0) : 1;
    if (rest < 0) {
      end.how = ApartEnd::How::out_of_time;
      end_softly(process, input.ours);
      break;
    }
    if (WaitForSingleObject(process, std::min(look, static_cast<DWORD>(1000 * rest) + 1)) == WAIT_OBJECT_0) break;
    if (!should_leave()) continue;
    end.how = ApartEnd::How::abandoned;
    end_softly(process, input.ours);
    break;
  }
  end.seconds = elapsed();
  end.status = status_of(process);
  take_cost(process, end);
  return end;
}

void leave_with_input(void (*end)(int signal)) {
  std::thread([end] {
    std::string ignored;
    while (read_input(ignored)) ignored.clear();
    end(end_signal);
  }).detach();
}

}  // namespace morula::platform
