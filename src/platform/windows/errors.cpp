// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/windows/errors.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace morula::platform {
namespace {

// Names up to here, and the hidden names next to them, are within the limit of the system's calls.
constexpr std::size_t longest_plain_name = 200;
// UTF-16 units of a file's or folder's own name, in NTFS and FAT.
constexpr std::size_t longest_own_name = 255;

}  // namespace

int errno_of(DWORD error) {
  switch (error) {
    case ERROR_SUCCESS:
      return 0;
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_NETPATH:
    case ERROR_INVALID_DRIVE:
    case ERROR_BAD_PATHNAME:
      return ENOENT;
    case ERROR_ACCESS_DENIED:
    case ERROR_CURRENT_DIRECTORY:
    case ERROR_WRITE_PROTECT:
      return EACCES;
    case ERROR_SHARING_VIOLATION:
    case ERROR_LOCK_VIOLATION:
    case ERROR_USER_MAPPED_FILE:
    case ERROR_BUSY:
      return EBUSY;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      return EEXIST;
    case ERROR_DIR_NOT_EMPTY:
      return ENOTEMPTY;
    case ERROR_DIRECTORY:
      return ENOTDIR;
    case ERROR_NOT_SAME_DEVICE:
      return EXDEV;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
      return ENOSPC;
    case ERROR_FILENAME_EXCED_RANGE:
      return ENAMETOOLONG;
    case ERROR_TOO_MANY_OPEN_FILES:
      return EMFILE;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_OUTOFMEMORY:
    case ERROR_COMMITMENT_LIMIT:
      return ENOMEM;
    case ERROR_BROKEN_PIPE:
    case ERROR_NO_DATA:
      return EPIPE;
    case ERROR_CANT_RESOLVE_FILENAME:
      return ELOOP;
    case ERROR_NOT_SUPPORTED:
    case ERROR_INVALID_FUNCTION:
      return ENOTSUP;
    case ERROR_BAD_EXE_FORMAT:
      return ENOEXEC;
    default:
      return EIO;
  }
}

int errno_of(DWORD error, const std::filesystem::path& path) {
  const auto is_too_long = [](const std::filesystem::path& name) { return name.native().size() > longest_own_name; };
  return error != ERROR_SUCCESS && std::any_of(path.begin(), path.end(), is_too_long) ? ENAMETOOLONG : errno_of(error);
}

int outcome(BOOL succeeded) {
  return succeeded ? 0 : errno_of(GetLastError());
}

std::wstring system_name(const std::filesystem::path& path, std::size_t more) {
  const std::wstring& plain = path.native();
  if (plain.starts_with(L"\\\\?\\") || plain.starts_with(L"\\\\.\\")) return plain;
  if (path.empty() || (path.is_absolute() && plain.size() + more <= longest_plain_name)) return plain;
  // The limit is for the path with the current folder.
  std::error_code error;
  std::filesystem::path whole = std::filesystem::absolute(path, error).lexically_normal();
  if (error || whole.native().size() + more <= longest_plain_name) return plain;
  const std::wstring& name = whole.make_preferred().native();
  return name.starts_with(L"\\\\") ? L"\\\\?\\UNC" + name.substr(1) : L"\\\\?\\" + name;
}

std::wstring wide(std::string_view text) {
  const int count = static_cast<int>(text.size());
  std::wstring result(static_cast<std::size_t>(MultiByteToWideChar(CP_UTF8, 0, text.data(), count, nullptr, 0)), L'\0');
  MultiByteToWideChar(CP_UTF8, 0, text.data(), count, result.data(), static_cast<int>(result.size()));
  return result;
}

}  // namespace morula::platform
