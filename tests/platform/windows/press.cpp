// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "press.hpp"

#include "platform/windows/errors.hpp"

namespace morula::test {

int press(const std::string& key, unsigned long process) {
  FreeConsole();
  if (AttachConsole(process) == 0) return static_cast<int>(GetLastError());
  // Not this program: the key is for the others of the console.
  SetConsoleCtrlHandler([](DWORD) -> BOOL { return TRUE; }, TRUE);
  if (GenerateConsoleCtrlEvent(key == "c" ? CTRL_C_EVENT : CTRL_BREAK_EVENT, 0) == 0)
    return static_cast<int>(GetLastError());
  Sleep(50);  // the system passes it on meanwhile
  return 0;
}

}  // namespace morula::test
