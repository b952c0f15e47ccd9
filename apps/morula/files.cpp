// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <morula/io/mesh_file.hpp>
#include <system_error>

#include "command.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;

const std::set<std::string> tree_extensions{".morula", ".sph", ".json"};
const std::set<std::string> written_mesh_extensions{".obj", ".off", ".ply"};

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// frame2 before frame10: runs of digits compare as numbers, everything else by character.
bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    std::size_t a_end = i;
    std::size_t b_end = j;
    while (a_end < a.size() && is_digit(a[a_end])) ++a_end;
    while (b_end < b.size() && is_digit(b[b_end])) ++b_end;
    if (a_end - i != b_end - j) return a_end - i < b_end - j;
    const int order = a.compare(i, a_end - i, b, j, b_end - j);
    if (order != 0) return order < 0;
    i = a_end;
    j = b_end;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // 01 and 1: equal as numbers
}

/// Without a trailing separator, which would make the file name empty.
fs::path without_slash(fs::path path) {
  path = path.lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

/// A new, empty folder inside `parent`.
fs::path make_stage(const fs::path& parent, const std::string& name) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    fs::path stage = parent / fmt::format(".{}.partial{}", name, attempt);
    std::error_code error;
    if (fs::create_directory(stage, error)) return stage;
    if (error) throw FileError(fmt::format("cannot make a folder in {}: {}", parent.string(), error.message()));
  }
  throw FileError(fmt::format("{} is full of unfinished folders (.{}.partial*): delete them", parent.string(), name));
}

}  // namespace

std::string extension(const fs::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return text;
}

FileKind file_kind(const fs::path& path) {
  if (fs::is_directory(path)) return FileKind::folder;
  const std::string ending = extension(path);
  if (tree_extensions.count(ending) != 0) return FileKind::tree;
  if (ending == ".npy") return FileKind::motion;
  if (written_mesh_extensions.count(ending) != 0 || ending == ".stl") return FileKind::mesh;
  return FileKind::unknown;
}

void require_output_place(const fs::path& path) {
  if (fs::is_directory(path)) throw UsageError(fmt::format("{}: is a folder; name a file in it", path.string()));
  const fs::path folder = path.parent_path();
  if (!folder.empty() && !fs::is_directory(folder)) {
    throw UsageError(fmt::format("{}: there is no folder {}; make it first", path.string(), folder.string()));
  }
}

void require_tree_output(const fs::path& path) {
  if (tree_extensions.count(extension(path)) == 0) {
    throw UsageError(fmt::format("{}: trees are written as .morula (with their cover), .sph or .json", path.string()));
  }
  require_output_place(path);
}

void require_mesh_output(const fs::path& path) {
  if (written_mesh_extensions.count(extension(path)) == 0) {
    throw UsageError(fmt::format("{}: meshes are written as .obj, .off or .ply", path.string()));
  }
  require_output_place(path);
}

std::vector<fs::path> trees_in(const fs::path& folder) {
  std::vector<fs::path> trees;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && tree_extensions.count(extension(entry.path())) != 0) trees.push_back(entry.path());
  }
  if (trees.empty()) throw UsageError(fmt::format("{}: no tree files (.sph, .json, .morula) in it", folder.string()));
  std::sort(trees.begin(), trees.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  for (const fs::path& tree : trees) {
    if (extension(tree) != extension(trees.front())) {
      throw UsageError(
          fmt::format("{}: holds both {} and {}: which are the frames? Put them into a folder of their own",
                      folder.string(), trees.front().filename().string(), tree.filename().string()));
    }
  }
  return trees;
}

std::string frame_file_name(std::size_t frame, std::string_view extension) {
  return fmt::format("{:04}{}", frame, extension);
}

void write_text_file(const fs::path& path, std::string_view text) {
  fs::path partial = path;
  partial += ".partial";
  std::ofstream file(partial, std::ios::binary | std::ios::trunc);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  std::error_code error;
  if (file) fs::rename(partial, path, error);
  if (!file || error) {
    std::error_code ignored;
    fs::remove(partial, ignored);
    throw FileError(fmt::format("cannot write {}: {}", path.string(),
                                error ? error.message() : "no such folder, no permission, or the disk is full"));
  }
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

StagedFolder::StagedFolder(fs::path target) : target_(without_slash(std::move(target))) {
  std::error_code error;
  if (fs::exists(target_, error) && !fs::is_directory(target_, error)) {
    throw UsageError(fmt::format("{}: is a file; name a folder", target_.string()));
  }
  merges_ = fs::is_directory(target_, error);
  const fs::path parent = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  if (!merges_ && !fs::is_directory(parent, error)) {
    throw UsageError(fmt::format("{}: there is no folder {}; make it first", target_.string(), parent.string()));
  }
  // Inside the target when there is one: a rename must stay on one file system, and the target may be a mount point.
  stage_ = make_stage(merges_ ? target_ : parent, target_.filename().string());
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  if (!stage_.empty()) fs::remove_all(stage_, ignored);
}

void StagedFolder::commit() {
  std::error_code error;
  if (merges_) {
    for (const fs::directory_entry& entry : fs::directory_iterator(stage_)) {
      fs::rename(entry.path(), target_ / entry.path().filename(), error);
      if (error) break;
    }
    if (!error) fs::remove(stage_, error);
  } else {
    fs::rename(stage_, target_, error);
  }
  if (error)
    throw FileError(fmt::format("cannot move the finished files into {}: {}", target_.string(), error.message()));
  stage_.clear();
}

void require_no_strangers(const fs::path& folder, std::size_t frame_count, std::string_view written_extension,
                          const std::set<std::string>& extensions) {
  if (!fs::is_directory(folder)) return;
  std::set<std::string> written;
  for (std::size_t i = 0; i < frame_count; ++i) written.insert(frame_file_name(i, written_extension));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_regular_file() || extensions.count(extension(name)) == 0 || written.count(name) != 0) continue;
    throw UsageError(
        fmt::format("{}: holds {}, which would be read as one of the frames: delete it or name another folder",
                    folder.string(), name));
  }
}

}  // namespace morula::cli
