// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "running_command.hpp"

#include <gtest/gtest.h>

#include <system_error>

#include "platform/interrupt.hpp"
#include "platform/process.hpp"
#include "platform/windows/launch.hpp"

namespace morula::test {

struct RunningCommand::State {
  platform::Handle process, job;
  DWORD id = 0;

  /// Starts a program in a folder.
  State(const std::filesystem::path& program, const std::vector<std::string>& arguments,
        const std::filesystem::path& folder, const std::filesystem::path& errors);
  ~State() {
    TerminateProcess(process.get(), 1);
    WaitForSingleObject(process.get(), INFINITE);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Presses the key of a signal: 0, or the system's error.
  int press(int signal) const;
};

std::vector<std::pair<int, int>> requests_to_end() {
  // Wine 8 passes on Ctrl-C, but refuses Ctrl-Break.
  static const bool is_wine = GetProcAddress(GetModuleHandleW(L"ntdll.dll"), "wine_get_version") != nullptr;
  if (is_wine) return {{platform::interrupt_signal, 130}};
  return {{platform::interrupt_signal, 130}, {platform::end_signal, 143}};
}

RunningCommand::State::State(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                             const std::filesystem::path& folder, const std::filesystem::path& errors) {
  std::wstring line = platform::quoted_word(program.string());
  for (const std::string& word : arguments) line += L" " + platform::quoted_word(word);
  SECURITY_ATTRIBUTES inheritable{sizeof(SECURITY_ATTRIBUTES), nullptr, TRUE};
  const platform::Handle input = platform::null_device(GENERIC_READ), output = platform::null_device(GENERIC_WRITE);
  const platform::Handle file(CreateFileW(errors.c_str(), GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_DELETE,
                                          &inheritable, CREATE_ALWAYS, FILE_ATTRIBUTE_NORMAL, nullptr));
  EXPECT_TRUE(file);
  STARTUPINFOW start{};
  start.cb = sizeof start;
  start.dwFlags = STARTF_USESTDHANDLES;
  start.hStdInput = input.get();
  start.hStdOutput = output.get();
  start.hStdError = file.get();
  PROCESS_INFORMATION made{};
  // A console of its own, so that Ctrl-C reaches nobody else; children inherit whether they ignore it.
  SetConsoleCtrlHandler(nullptr, FALSE);
  EXPECT_NE(CreateProcessW(program.c_str(), line.data(), nullptr, nullptr, TRUE, CREATE_NO_WINDOW | CREATE_SUSPENDED,
                           nullptr, folder.c_str(), &start, &made),
            0);
  const platform::Handle thread(made.hThread);
  process = platform::Handle(made.hProcess);
  job = platform::Handle(CreateJobObjectW(nullptr, nullptr));
  id = made.dwProcessId;
  JOBOBJECT_EXTENDED_LIMIT_INFORMATION ends_with_us{};
  ends_with_us.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE;
  EXPECT_NE(SetInformationJobObject(job.get(), JobObjectExtendedLimitInformation, &ends_with_us, sizeof ends_with_us),
            0);
  EXPECT_NE(AssignProcessToJobObject(job.get(), process.get()), 0);
  ResumeThread(thread.get());
}

// A program can only press keys of its own console: another one does it.
int RunningCommand::State::press(int signal) const {
  const char* const key = signal == platform::interrupt_signal ? "c" : "break";
  platform::ChildProgram press({MORULA_CHILD, "press", key, std::to_string(id)}, {});
  return press.wait().code;
}

// Wine does not always make a console. A program that has just been started may not have its console yet.
bool RunningCommand::can_send() {
  static const bool can = [] {
    const Workbench bench;
    const State child(MORULA_CHILD, {"deaf"}, bench.folder(), bench / "errors");
    int error = ERROR_INVALID_HANDLE;
    for (int tries = 0; error == ERROR_INVALID_HANDLE && tries < 10; ++tries) {
      Sleep(200);
      error = child.press(platform::interrupt_signal);
    }
    return error != ERROR_INVALID_HANDLE;
  }();
  return can;
}

RunningCommand::RunningCommand(const Workbench& bench, const std::vector<std::string>& arguments,
                               const std::filesystem::path& errors)
    : state_(std::make_unique<State>(command_path(), arguments, bench.folder(), errors)) {}

RunningCommand::~RunningCommand() = default;

void RunningCommand::send(int signal) const {
  const int error = state_->press(signal);
  EXPECT_EQ(error, 0) << "error of the system: no key can be pressed in the console of the command";
  if (error != 0) TerminateProcess(state_->process.get(), 99);  // it would run for minutes
}

bool RunningCommand::is_running() const {
  return WaitForSingleObject(state_->process.get(), 0) == WAIT_TIMEOUT;
}

int RunningCommand::wait() {
  WaitForSingleObject(state_->process.get(), INFINITE);
  const platform::ProcessStatus status = platform::status_of(state_->process.get());
  constexpr int killed = 99;  // as kill() does below
  return status.by_signal || status.code == killed ? -1 : status.code;
}

void RunningCommand::kill() {
  TerminateProcess(state_->process.get(), 99);
}

}  // namespace morula::test
