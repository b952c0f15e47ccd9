// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Paths: what a name promises to be, text files and folders that appear whole or not at all.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace morula::cli {

enum class FileKind { mesh, tree, motion, folder, unknown };
/// By extension, folders by looking.
FileKind file_kind(const std::filesystem::path& path);
/// Lower case, with the dot.
std::string extension(const std::filesystem::path& path);

/// Throws UsageError unless the extension is one of those written and the file can be made there: long work must not
/// end in a typing mistake.
void require_tree_output(const std::filesystem::path& path);
void require_mesh_output(const std::filesystem::path& path);
void require_output_place(const std::filesystem::path& path);

/// The .sph, .json and .morula files of a folder, digits in names compared as numbers. Throws UsageError when there are
/// none or several kinds.
std::vector<std::filesystem::path> trees_in(const std::filesystem::path& folder);

/// "0000.sph": how frames are named, in the order of their numbers.
std::string frame_file_name(std::size_t frame, std::string_view extension);

/// Written beside and renamed: readers see the old file or the new one, never a part. Throws FileError.
void write_text_file(const std::filesystem::path& path, std::string_view text);

/// A cell of a CSV file, quoted when it must be.
std::string csv_cell(std::string_view text);

/// A folder filled aside and moved into place at the end, so that a failure half way leaves nothing behind.
class StagedFolder {
 public:
  explicit StagedFolder(std::filesystem::path target);
  /// Removes what was not committed.
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  /// Where to write until then.
  const std::filesystem::path& path() const { return stage_; }
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path stage_;
  bool merges_;  // the target was there before
};

/// Throws UsageError when the folder already holds files with one of these extensions that will not be overwritten:
/// they would be read as frames of what is written now.
void require_no_strangers(const std::filesystem::path& folder, std::size_t frame_count,
                          std::string_view written_extension, const std::set<std::string>& extensions);

}  // namespace morula::cli
