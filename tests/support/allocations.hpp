// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Counts every allocation of a program: whoever names the counter links an operator new that counts.
#pragma once

#include <atomic>
#include <cstddef>

namespace morula::test {

extern std::atomic<std::size_t> allocations;

}  // namespace morula::test
