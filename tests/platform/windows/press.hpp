// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace morula::test {

/// Presses Ctrl-C ("c") or Ctrl-Break ("break") in the console of a process. Returns 0, or the system's error.
int press(const std::string& key, unsigned long process);

}  // namespace morula::test
