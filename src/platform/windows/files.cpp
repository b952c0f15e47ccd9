// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/files.hpp"

#include <fcntl.h>
#include <io.h>

#include <algorithm>
#include <cerrno>
#include <sstream>
#include <system_error>
#include <vector>

#include "platform/windows/errors.hpp"

namespace morula::platform {
namespace {

constexpr DWORD shared_by_all = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
constexpr std::size_t largest_write = std::size_t{1} << 24;  // bytes

// A file or folder, opened to find its kind.
Handle open_to_look(const Path& path) {
  return Handle(CreateFileW(system_name(path).c_str(), 0, shared_by_all, nullptr, OPEN_EXISTING,
                            FILE_FLAG_BACKUP_SEMANTICS, nullptr));
}

// Whether another program has a file open and prevents its removal.
bool is_open(const std::wstring& name) {
  const Handle opened(
      CreateFileW(name.c_str(), DELETE, shared_by_all, nullptr, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr));
  return !opened && GetLastError() == ERROR_SHARING_VIOLATION;
}

// The value of a variable of the environment; empty if there is none.
std::wstring value_of(const wchar_t* variable) {
  std::wstring value(GetEnvironmentVariableW(variable, nullptr, 0), L'\0');
  value.resize(GetEnvironmentVariableW(variable, value.data(), static_cast<DWORD>(value.size())));
  return value;
}

HANDLE handle_of(int file) {
  return reinterpret_cast<HANDLE>(_get_osfhandle(file));
}

}  // namespace

Path openable(const Path& path, std::size_t more) {
  return system_name(path, more);
}

NodeKind kind_of(const Path& path, int& error) {
  const Handle opened = open_to_look(path);
  error = opened ? 0 : errno_of(GetLastError(), path);
  if (!opened) return NodeKind::missing;
  const DWORD type = GetFileType(opened.get());
  if (type == FILE_TYPE_CHAR) return NodeKind::device;
  if (type == FILE_TYPE_PIPE) return NodeKind::pipe;
  BY_HANDLE_FILE_INFORMATION found{};
  if (GetFileInformationByHandle(opened.get(), &found) == 0) return NodeKind::other;
  return (found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0 ? NodeKind::folder : NodeKind::file;
}

NodeKind kind_of(const Path& path) {
  int ignored = 0;
  return kind_of(path, ignored);
}

std::string reason(int error) {
  if (error == EBUSY) return "another program has it open";
  if (error == ENOEXEC) return "it is no program; .bat and .cmd are not started, name an .exe";
  return std::generic_category().message(error);
}

bool is_same_file(const Path& a, const Path& b) {
  const Handle of_a = open_to_look(a), of_b = open_to_look(b);
  BY_HANDLE_FILE_INFORMATION in_a{}, in_b{};
  return of_a && of_b && GetFileInformationByHandle(of_a.get(), &in_a) != 0 &&
         GetFileInformationByHandle(of_b.get(), &in_b) != 0 && in_a.dwVolumeSerialNumber == in_b.dwVolumeSerialNumber &&
         in_a.nFileIndexHigh == in_b.nFileIndexHigh && in_a.nFileIndexLow == in_b.nFileIndexLow;
}

int create_file(const Path& path, bool, int& error) {
  Handle opened(CreateFileW(system_name(path).c_str(), GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_DELETE, nullptr,
                            CREATE_NEW, FILE_ATTRIBUTE_NORMAL, nullptr));
  error = opened ? 0 : errno_of(GetLastError(), path);
  if (!opened) return -1;
  const int file = _open_osfhandle(reinterpret_cast<intptr_t>(opened.get()), _O_BINARY | _O_WRONLY | _O_NOINHERIT);
  if (file < 0) {
    error = errno;
    opened.close();
    DeleteFileW(system_name(path).c_str());
    return -1;
  }
  opened.release();
  return file;
}

int create_folder(const Path& path, bool) {
  return CreateDirectoryW(system_name(path).c_str(), nullptr) != 0 ? 0 : errno_of(GetLastError(), path);
}

int append(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    DWORD count = 0;
    const auto part = static_cast<DWORD>(std::min(bytes.size(), largest_write));
    if (WriteFile(handle_of(file), bytes.data(), part, &count, nullptr) == 0) return errno_of(GetLastError());
    bytes.remove_prefix(count);
  }
  return 0;
}

int overwrite(int file, std::uint64_t offset, std::string_view bytes) {
  // A write at an offset moves the place of the next write, which is the end.
  LARGE_INTEGER place{};
  place.QuadPart = static_cast<LONGLONG>(offset);
  if (SetFilePointerEx(handle_of(file), place, nullptr, FILE_BEGIN) == 0) return errno_of(GetLastError());
  if (const int error = append(file, bytes); error != 0) return error;
  place.QuadPart = 0;
  return outcome(SetFilePointerEx(handle_of(file), place, nullptr, FILE_END));
}

int sync_file(int file) {
  const int error = outcome(FlushFileBuffers(handle_of(file)));
  return error == ENOTSUP ? 0 : error;
}

int sync_file(const Path& path) {
  const Handle opened(
      CreateFileW(system_name(path).c_str(), GENERIC_WRITE, shared_by_all, nullptr, OPEN_EXISTING, 0, nullptr));
  return opened ? outcome(FlushFileBuffers(opened.get())) : 0;
}

// Renames write the name to the disk before they return.
void sync_folder(const Path&) {}

int close_file(int file) {
  return _close(file) == 0 ? 0 : errno;
}

int remove_file(const Path& path) {
  return outcome(DeleteFileW(system_name(path).c_str()));
}

int remove_folder(const Path& path) {
  return outcome(RemoveDirectoryW(system_name(path).c_str()));
}

void remove_unfinished(const Path& path) {
  // A file that is open keeps its name, and so its folder, until it is closed: it leaves the folder first.
  std::error_code error;
  std::size_t count = 0;
  using Walk = std::filesystem::recursive_directory_iterator;
  if (kind_of(path) == NodeKind::folder) {
    std::vector<Path> files;
    for (Walk entry(path, error); !error && entry != Walk(); entry.increment(error))
      if (kind_of(entry->path()) == NodeKind::file) files.push_back(entry->path());
    for (const Path& file : files) {
      Path outside = path;
      outside += "." + std::to_string(count++);
      const bool is_moved = MoveFileExW(system_name(file).c_str(), system_name(outside).c_str(), 0) != 0;
      remove_file(is_moved ? outside : file);
    }
  }
  if (remove_file(path) != 0) std::filesystem::remove_all(path, error);
}

void copy_permissions(const Path&, int) {}
void copy_folder_permissions(const Path&, const Path&) {}

int rename_over(const Path& from, const Path& to) {
  const std::wstring old_name = system_name(from), new_name = system_name(to);
  // Programs that index files or look for viruses open new ones for a moment.
  for (DWORD pause = 1;; pause *= 2) {
    if (MoveFileExW(old_name.c_str(), new_name.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0)
      return 0;
    const DWORD error = GetLastError();
    const DWORD attributes = GetFileAttributesW(new_name.c_str());
    const bool is_protected = attributes != INVALID_FILE_ATTRIBUTES &&
                              (attributes & (FILE_ATTRIBUTE_READONLY | FILE_ATTRIBUTE_DIRECTORY)) != 0;
    const bool may_pass = error == ERROR_SHARING_VIOLATION || (error == ERROR_ACCESS_DENIED && !is_protected);
    if (!may_pass || pause > 256)
      return may_pass && (is_open(old_name) || is_open(new_name)) ? EBUSY : errno_of(error, to);
    Sleep(pause);
  }
}

// Windows has no such call.
bool exchange(const Path&, const Path&) {
  return false;
}

bool has_exchange() {
  return false;
}

int link_file(const Path& file, const Path& name) {
  return outcome(CreateHardLinkW(system_name(name).c_str(), system_name(file).c_str(), nullptr));
}

bool is_mount_point(const Path& folder) {
  std::error_code error;
  const Path whole = std::filesystem::absolute(folder, error).lexically_normal();
  if (error || !whole.has_relative_path()) return true;
  const DWORD attributes = GetFileAttributesW(system_name(folder).c_str());
  return attributes == INVALID_FILE_ATTRIBUTES || (attributes & FILE_ATTRIBUTE_REPARSE_POINT) != 0;
}

int read_file(const Path& path, const std::function<void(std::string_view)>& take, bool& is_file) {
  is_file = true;
  int error = 0;
  const NodeKind kind = kind_of(path, error);
  if (kind == NodeKind::missing) return error;
  is_file = kind == NodeKind::file;
  if (!is_file) return 0;
  const Handle opened(CreateFileW(system_name(path).c_str(), GENERIC_READ, shared_by_all, nullptr, OPEN_EXISTING,
                                  FILE_ATTRIBUTE_NORMAL, nullptr));
  if (!opened) return errno_of(GetLastError());
  std::vector<char> part(1 << 16);
  for (;;) {
    DWORD count = 0;
    if (ReadFile(opened.get(), part.data(), static_cast<DWORD>(part.size()), &count, nullptr) == 0)
      return errno_of(GetLastError());
    if (count == 0) return 0;
    take({part.data(), count});
  }
}

Path home_folder() {
  return value_of(L"USERPROFILE");
}

std::vector<Path> listed_folders(const char* variable) {
  std::vector<Path> folders;
  std::wistringstream names(value_of(wide(variable).c_str()));
  for (std::wstring name; std::getline(names, name, L';');) {
    std::erase(name, L'"');
    if (!name.empty()) folders.emplace_back(name);
  }
  return folders;
}

std::uint64_t process_number() {
  return GetCurrentProcessId();
}

}  // namespace morula::platform
