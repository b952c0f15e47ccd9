// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/windows/launch.hpp"

#include <algorithm>
#include <cerrno>
#include <memory>
#include <string>
#include <system_error>

namespace morula::platform {
namespace {

[[noreturn]] void fail(DWORD error, const char* text) {
  const int number = errno_of(error);
  if (number != EIO) throw std::system_error(number, std::generic_category(), text);
  throw std::system_error(number, std::generic_category(),
                          std::string(text) + ", error " + std::to_string(error) + " of Windows");
}

/// The list of handles that a program inherits, and nothing else.
class Inheritance {
 public:
  explicit Inheritance(std::vector<HANDLE> handles) : handles_(std::move(handles)) {
    std::erase(handles_, nullptr);
    std::sort(handles_.begin(), handles_.end());
    handles_.erase(std::unique(handles_.begin(), handles_.end()), handles_.end());
    SIZE_T size = 0;
    InitializeProcThreadAttributeList(nullptr, 1, 0, &size);
    memory_.resize(size);
    if (InitializeProcThreadAttributeList(list(), 1, 0, &size) == 0 ||
        UpdateProcThreadAttribute(list(), 0, PROC_THREAD_ATTRIBUTE_HANDLE_LIST, handles_.data(),
                                  handles_.size() * sizeof(HANDLE), nullptr, nullptr) == 0)
      fail(GetLastError(), "no process can be started");
  }
  Inheritance(const Inheritance&) = delete;
  Inheritance& operator=(const Inheritance&) = delete;
  ~Inheritance() { DeleteProcThreadAttributeList(list()); }
  LPPROC_THREAD_ATTRIBUTE_LIST list() { return reinterpret_cast<LPPROC_THREAD_ATTRIBUTE_LIST>(memory_.data()); }

 private:
  std::vector<HANDLE> handles_;
  std::vector<std::byte> memory_;
};

LaunchPipe make_pipe(bool is_read_by_us) {
  SECURITY_ATTRIBUTES inheritable{sizeof(SECURITY_ATTRIBUTES), nullptr, TRUE};
  HANDLE read = nullptr, write = nullptr;
  if (CreatePipe(&read, &write, &inheritable, 0) == 0) fail(GetLastError(), "no pipe can be made");
  LaunchPipe pipe{Handle(is_read_by_us ? read : write), Handle(is_read_by_us ? write : read)};
  SetHandleInformation(pipe.ours.get(), HANDLE_FLAG_INHERIT, 0);
  return pipe;
}

// Numbers of POSIX signals, which reports name.
constexpr int abort_signal = 6, number_signal = 8, kill_signal = 9, memory_signal = 11, instruction_signal = 4;

}  // namespace

std::wstring quoted_word(const std::string& word) {
  const std::wstring text = wide(word);
  if (!text.empty() && text.find_first_of(L" \t\n\v\"") == text.npos) return text;
  std::wstring quoted = L"\"";
  std::size_t backslashes = 0;
  for (const wchar_t c : text) {
    // Backslashes stand for themselves, except in front of a quotation mark: two are one there.
    if (c == L'"') quoted.append(backslashes + 1, L'\\');
    backslashes = c == L'\\' ? backslashes + 1 : 0;
    quoted += c;
  }
  quoted.append(backslashes, L'\\');
  return quoted + L'"';
}

bool has_type(std::wstring_view path, std::wstring_view type) {
  while (!path.empty() && (path.back() == L' ' || path.back() == L'.')) path.remove_suffix(1);
  if (path.size() < type.size()) return false;
  path.remove_prefix(path.size() - type.size());
  const auto is_same = [](wchar_t a, wchar_t b) { return (a >= L'A' && a <= L'Z' ? a - L'A' + L'a' : a) == b; };
  return std::equal(path.begin(), path.end(), type.begin(), is_same);
}

bool is_script(std::wstring_view path) {
  return has_type(path, L".bat") || has_type(path, L".cmd");
}

Launched launch(const std::wstring& path, const std::vector<std::string>& words, const std::array<HANDLE, 3>& streams,
                HANDLE extra, const JOBOBJECT_EXTENDED_LIMIT_INFORMATION& limits) {
  if (is_script(path)) fail(ERROR_BAD_EXE_FORMAT, "no process can be started");
  std::wstring line;
  for (const std::string& word : words) line += (line.empty() ? L"" : L" ") + quoted_word(word);
  Inheritance inheritance({streams[0], streams[1], streams[2], extra});
  STARTUPINFOEXW start{};
  start.StartupInfo.cb = sizeof start;
  start.StartupInfo.dwFlags = STARTF_USESTDHANDLES;
  start.StartupInfo.hStdInput = streams[0];
  start.StartupInfo.hStdOutput = streams[1];
  start.StartupInfo.hStdError = streams[2];
  start.lpAttributeList = inheritance.list();
  PROCESS_INFORMATION made{};
  constexpr DWORD flags = EXTENDED_STARTUPINFO_PRESENT | CREATE_SUSPENDED | CREATE_UNICODE_ENVIRONMENT;
  if (CreateProcessW(path.c_str(), line.data(), nullptr, nullptr, TRUE, flags, nullptr, nullptr, &start.StartupInfo,
                     &made) == 0)
    fail(GetLastError(), "no process can be started");
  Launched launched{Handle(made.hProcess), Handle(CreateJobObjectW(nullptr, nullptr))};
  const Handle thread(made.hThread);
  JOBOBJECT_EXTENDED_LIMIT_INFORMATION all = limits;
  all.BasicLimitInformation.LimitFlags |= JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE;
  // Without its job, the program would have no limits, and could outlive this process.
  if (!launched.job ||
      SetInformationJobObject(launched.job.get(), JobObjectExtendedLimitInformation, &all, sizeof all) == 0 ||
      AssignProcessToJobObject(launched.job.get(), launched.process.get()) == 0 ||
      ResumeThread(thread.get()) == static_cast<DWORD>(-1)) {
    const DWORD error = GetLastError();
    TerminateProcess(launched.process.get(), 1);
    fail(error, "no process can be started");
  }
  return launched;
}

LaunchPipe pipe_to_program() {
  return make_pipe(false);
}

LaunchPipe pipe_from_program() {
  return make_pipe(true);
}

Handle null_device(DWORD access) {
  SECURITY_ATTRIBUTES inheritable{sizeof(SECURITY_ATTRIBUTES), nullptr, TRUE};
  return Handle(
      CreateFileW(L"NUL", access, FILE_SHARE_READ | FILE_SHARE_WRITE, &inheritable, OPEN_EXISTING, 0, nullptr));
}

Handle inherited_stream(DWORD standard_handle) {
  HANDLE copy = nullptr;
  const HANDLE self = GetCurrentProcess();
  if (DuplicateHandle(self, GetStdHandle(standard_handle), self, &copy, 0, TRUE, DUPLICATE_SAME_ACCESS) == 0)
    return null_device(GENERIC_WRITE);
  return Handle(copy);
}

ProcessStatus status_of(HANDLE process) {
  DWORD code = 0;
  GetExitCodeProcess(process, &code);
  switch (code) {
    case STATUS_ACCESS_VIOLATION:
    case STATUS_STACK_OVERFLOW:
    case STATUS_IN_PAGE_ERROR:
      return {memory_signal, true};
    case STATUS_ILLEGAL_INSTRUCTION:
    case STATUS_PRIVILEGED_INSTRUCTION:
      return {instruction_signal, true};
    case STATUS_INTEGER_DIVIDE_BY_ZERO:
    case STATUS_FLOAT_DIVIDE_BY_ZERO:
      return {number_signal, true};
    case STATUS_CONTROL_C_EXIT:
      return {kill_signal, true};
    default:
      break;
  }
  // Other codes of this kind are errors of the system, such as a damaged heap.
  if (code >= 0xC0000000u) return {abort_signal, true};
  return {static_cast<int>(code), false};
}

}  // namespace morula::platform
