// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Start of a program on Windows: its command line and the handles that it inherits.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "platform/process.hpp"
#include "platform/windows/errors.hpp"

namespace morula::platform {

/// A word of a command line that the C library of a program reads back unchanged.
std::wstring quoted_word(const std::string& word);

/// Whether a path ends in this type, ".exe" for instance. The system ignores case, and blanks and dots at the end.
bool has_type(std::wstring_view path, std::wstring_view type);
/// A script of the system's shell (.bat, .cmd), which would read quotation marks of words in its own way, and could run
/// parts of them as commands.
bool is_script(std::wstring_view path);

/// A program that runs. It ends with this process, and with `job`.
struct Launched {
  Handle process, job;
};

/// Starts a program. path: in full. streams: standard input, output and errors, inheritable. extra: another handle that
/// it inherits, or null. Throws std::system_error, ENOEXEC for a script.
Launched launch(const std::wstring& path, const std::vector<std::string>& words, const std::array<HANDLE, 3>& streams,
                HANDLE extra, const JOBOBJECT_EXTENDED_LIMIT_INFORMATION& limits);

/// A pipe; the end for the program is inheritable.
struct LaunchPipe {
  Handle ours, theirs;
};
LaunchPipe pipe_to_program();
LaunchPipe pipe_from_program();
/// The null device, or a copy of a standard handle of this process, as a program inherits it.
Handle null_device(DWORD access);
Handle inherited_stream(DWORD standard_handle);

/// Status of a process that has ended.
ProcessStatus status_of(HANDLE process);

}  // namespace morula::platform
