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
};

std::vector<std::pair<int, int>> requests_to_end() {
  return {{platform::interrupt_signal, 130}, {platform::end_signal, 143}};
}

RunningCommand::RunningCommand(const Workbench& bench, const std::vector<std::string>& arguments,
                               const std::filesystem::path& errors)
    : state_(std::make_unique<State>()) {
  const std::filesystem::path program = command_path();
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
                           nullptr, bench.folder().c_str(), &start, &made),
            0);
  const platform::Handle thread(made.hThread);
  state_->process = platform::Handle(made.hProcess);
  state_->job = platform::Handle(CreateJobObjectW(nullptr, nullptr));
  state_->id = made.dwProcessId;
  JOBOBJECT_EXTENDED_LIMIT_INFORMATION ends_with_us{};
  ends_with_us.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE;
  EXPECT_NE(
      SetInformationJobObject(state_->job.get(), JobObjectExtendedLimitInformation, &ends_with_us, sizeof ends_with_us),
      0);
  EXPECT_NE(AssignProcessToJobObject(state_->job.get(), state_->process.get()), 0);
  ResumeThread(thread.get());
}

RunningCommand::~RunningCommand() {
  TerminateProcess(state_->process.get(), 1);
  WaitForSingleObject(state_->process.get(), INFINITE);
}

// A program can only press keys of its own console: another one does it.
void RunningCommand::send(int signal) const {
  const char* const key = signal == platform::interrupt_signal ? "c" : "break";
  platform::ChildProgram press({MORULA_CHILD, "press", key, std::to_string(state_->id)}, {});
  const int error = press.wait().code;
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
