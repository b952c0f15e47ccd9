// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Standard streams of a command.
#pragma once

#include <filesystem>

namespace morula::platform {

enum class Stream { input, output, errors };

/// Makes sure that the three standard streams are open: a file that is written must not become one of them. Windows:
/// the console shows UTF-8 until restore_console(), and line ends are written as they are. False when the output was
/// closed.
bool open_standard_streams();
/// Windows: gives the console back as it was; at the end of the program. Any thread may call it.
void restore_console() noexcept;

/// True for a stream that a person sees.
bool is_terminal(Stream stream);
/// True if the stream comes from or goes to this file.
bool is_stream_of(Stream stream, const std::filesystem::path& file);

}  // namespace morula::platform
