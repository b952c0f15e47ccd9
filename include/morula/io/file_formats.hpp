// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The table of files that the library reads and writes.
#pragma once

#include <string>
#include <vector>

namespace morula {

struct FileFormat {
  std::string extension;  ///< lower case, with the dot
  std::string program;    ///< whose format it is
  bool is_read, is_written;
  std::string purpose;  ///< what is in such a file: "meshes"
};
/// One row for every extension and purpose; those of meshes are the ones that read_mesh and write_mesh take. Formats of
/// robots and clumps have tables of their own (robot::output_formats, clump_formats).
std::vector<FileFormat> file_formats();

}  // namespace morula
