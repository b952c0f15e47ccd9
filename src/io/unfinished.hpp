// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Hidden names that a process ending now would leave behind, and the lock under which they come and go.
#pragma once

#include <filesystem>
#include <mutex>

namespace morula::detail {

/// Held while a name appears, is replaced or disappears: whoever abandons the rest then sees all of it or nothing.
std::unique_lock<std::mutex> lock_unfinished();

/// All under the lock.
void note_unfinished(const std::filesystem::path& path);
void forget_unfinished(const std::filesystem::path& path) noexcept;
bool is_unfinished(const std::filesystem::path& path);

}  // namespace morula::detail
