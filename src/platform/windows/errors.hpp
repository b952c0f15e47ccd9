// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Common parts of the Windows sources: the system's header, errors as values of errno, names of files.
#pragma once

#ifndef NOMINMAX
#define NOMINMAX
#endif
#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
// clang-format off
#include <windows.h>
#include <psapi.h>  // needs the header before it
// clang-format on

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace morula::platform {

/// The errno that says the same as an error of Windows.
int errno_of(DWORD error);
/// The same for a call that names a path: ENAMETOOLONG if a name in it is longer than file systems take, which Windows
/// reports as an invalid or a missing name.
int errno_of(DWORD error, const std::filesystem::path& path);
/// 0 if a call succeeded, otherwise the errno of its error.
int outcome(BOOL succeeded);

/// A path as the system's calls take it: if it is long, or would be with `more` characters behind it, it is absolute,
/// with the mark that lifts the limit of 260 characters.
std::wstring system_name(const std::filesystem::path& path, std::size_t more = 0);

/// Text in UTF-8 as UTF-16; wrong bytes become U+FFFD.
std::wstring wide(std::string_view text);

/// A handle that closes itself.
class Handle {
 public:
  Handle() = default;
  explicit Handle(HANDLE handle) : handle_(handle == INVALID_HANDLE_VALUE ? nullptr : handle) {}
  Handle(Handle&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Handle() { close(); }
  HANDLE get() const { return handle_; }
  explicit operator bool() const { return handle_ != nullptr; }
  HANDLE release() { return std::exchange(handle_, nullptr); }
  void close() {
    if (handle_ != nullptr) CloseHandle(handle_);
    handle_ = nullptr;
  }

 private:
  HANDLE handle_ = nullptr;
};

}  // namespace morula::platform
