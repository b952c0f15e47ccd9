// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/console.hpp"

#include <fcntl.h>
#include <io.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "platform/windows/errors.hpp"

namespace morula::platform {
namespace {

struct Console {
  UINT code_page = 0;         // 0: unchanged
  DWORD mode = 0;             // of errors
  bool has_new_mode = false;  // of errors
};
Console console;

std::FILE* file_of(Stream stream) {
  if (stream == Stream::input) return stdin;
  return stream == Stream::output ? stdout : stderr;
}

HANDLE handle_of(Stream stream) {
  if (stream == Stream::input) return GetStdHandle(STD_INPUT_HANDLE);
  return GetStdHandle(stream == Stream::output ? STD_OUTPUT_HANDLE : STD_ERROR_HANDLE);
}

}  // namespace

bool open_standard_streams() {
  bool has_output = true;
  for (const Stream stream : {Stream::input, Stream::output, Stream::errors}) {
    std::FILE* const file = file_of(stream);
    if (_fileno(file) < 0 || _get_osfhandle(_fileno(file)) == -1) {
      has_output = has_output && stream != Stream::output;
      std::FILE* const opened = std::freopen("NUL", stream == Stream::input ? "r" : "w", file);
      static_cast<void>(opened);
    } else if (stream != Stream::input) {
      _setmode(_fileno(file), _O_BINARY);
    }
  }
  const HANDLE errors = handle_of(Stream::errors);
  if (GetConsoleMode(errors, &console.mode) != 0)
    console.has_new_mode = SetConsoleMode(errors, console.mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
  console.code_page = GetConsoleOutputCP();
  if (console.code_page == CP_UTF8 || SetConsoleOutputCP(CP_UTF8) == 0) console.code_page = 0;
  std::atexit([] { restore_console(); });
  return has_output;
}

void restore_console() noexcept {
  if (console.has_new_mode) SetConsoleMode(handle_of(Stream::errors), console.mode);
  if (console.code_page != 0) SetConsoleOutputCP(console.code_page);
}

bool is_terminal(Stream stream) {
  DWORD mode = 0;
  return GetConsoleMode(handle_of(stream), &mode) != 0;
}

bool is_stream_of(Stream stream, const std::filesystem::path& file) {
  const Handle opened(CreateFileW(system_name(file).c_str(), 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                  nullptr, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr));
  BY_HANDLE_FILE_INFORMATION own{}, standard{};
  return opened && GetFileType(handle_of(stream)) == FILE_TYPE_DISK &&
         GetFileInformationByHandle(opened.get(), &own) != 0 &&
         GetFileInformationByHandle(handle_of(stream), &standard) != 0 &&
         own.dwVolumeSerialNumber == standard.dwVolumeSerialNumber && own.nFileIndexHigh == standard.nFileIndexHigh &&
         own.nFileIndexLow == standard.nFileIndexLow;
}

}  // namespace morula::platform
