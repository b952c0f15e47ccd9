// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files and folders as the operating system has them, for writers that replace them in one step.
//
// posix/ and windows/ implement the same functions. Errors are values of errno; 0: none. Files under construction are
// numbers of open files, as of the C library; -1: none. On Windows, paths of any length are taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace morula::platform {

using Path = std::filesystem::path;

/// The path by which functions of the standard library find the file or folder, however long it is. Windows: absolute,
/// with the mark that lifts the limit of 260 characters, if it is long or would be with `more` characters behind it.
Path openable(const Path& path, std::size_t more = 0);

/// The kind of node to which a path leads, through links.
enum class NodeKind { missing, file, folder, pipe, socket, device, other };
NodeKind kind_of(const Path& path);
/// The same; error: why it is missing, ENOENT in general; 0 if it is not.
NodeKind kind_of(const Path& path, int& error);

/// Text of an error for messages: "Permission denied".
std::string reason(int error);

/// True if both paths exist and lead to the same file or folder, also through links and hard links.
bool is_same_file(const Path& a, const Path& b);

/// Creates a file for writing; EEXIST if there is one. is_private: for this user alone, where the system has such
/// permissions for each file. The file can be removed while it is open.
int create_file(const Path& path, bool is_private, int& error);
/// Creates a folder; EEXIST if the name is taken.
int create_folder(const Path& path, bool is_private);
/// Appends all bytes.
int append(int file, std::string_view bytes);
/// Replaces bytes from an offset on.
int overwrite(int file, std::uint64_t offset, std::string_view bytes);
/// Writes to the disk what the system still holds of a file. Success if its file system cannot do that.
int sync_file(int file);
int sync_file(const Path& path);
/// The same for the names in a folder; does nothing where the system has no such call.
void sync_folder(const Path& folder);
int close_file(int file);
int remove_file(const Path& path);
int remove_folder(const Path& path);
/// Removes a file or folder, also files in it that this process has open; for the end of a program. Windows: the names
/// of open files vanish with the program at the latest.
void remove_unfinished(const Path& path);

/// Copies owner and permissions of an existing file or folder, as far as this user may set them. Windows: does nothing;
/// a new file has the permissions that its folder gives.
void copy_permissions(const Path& from, int to_file);
void copy_folder_permissions(const Path& from, const Path& to);

/// Renames a file or folder in one step. A file takes the place of an existing file. Windows: fails with EACCES for an
/// existing file that is read-only, and with EBUSY for one that another program has open, after half a second of tries.
int rename_over(const Path& from, const Path& to);
/// Exchanges the names of two folders in one step; false if the system or the file system cannot.
bool exchange(const Path& a, const Path& b);
/// False if the system has no such call, for any file system.
bool has_exchange();
/// Gives a file a second name.
int link_file(const Path& file, const Path& name);
/// True for a folder that cannot be renamed: the root of a file system.
bool is_mount_point(const Path& folder);

/// Reads a file in parts; waits for no other program. Returns an error, or 0 at the end. is_file: false if the path
/// leads to something else, of which nothing is read.
int read_file(const Path& path, const std::function<void(std::string_view)>& take, bool& is_file);

/// The user's home folder: HOME, on Windows USERPROFILE; empty if there is none.
Path home_folder();
/// Folders that a variable of the environment lists between colons, on Windows between semicolons. Empty names count
/// for nothing.
std::vector<Path> listed_folders(const char* variable);

/// The number of this process.
std::uint64_t process_number();

}  // namespace morula::platform
