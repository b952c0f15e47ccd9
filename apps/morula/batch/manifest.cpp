// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/manifest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <morula/io/file_reference.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/version.hpp>
#include <sstream>
#include <system_error>

#include "batch/bytes.hpp"
#include "shared/command.hpp"
#include "shared/files.hpp"
#include "shared/name_text.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {
namespace fs = std::filesystem;

bool is_mesh(const fs::path& path) {
  const std::string kind = extension(path);
  const auto kinds = mesh_file_kinds();
  return std::any_of(kinds.begin(), kinds.end(), [&](const MeshFileKind& known) { return known.extension == kind; });
}

// Lists a folder and those below it. Links to folders are not followed: they may lead in circles and out of the folder.
class FolderListing {
 public:
  explicit FolderListing(const fs::path& folder) : folder_(folder) {
    std::error_code error;
    list(folder, error);
    if (error) throw UsageError(fmt::format("{}: cannot be listed: {}", folder.string(), error.message()));
    while (!waiting_.empty()) {
      const fs::path next = std::move(waiting_.back());
      waiting_.pop_back();
      list(next, error);
      if (error) add(next, "cannot be listed: " + error.message());
    }
    std::sort(rows_.begin(), rows_.end(), [](const ManifestRow& a, const ManifestRow& b) { return a.name < b.name; });
  }
  std::vector<ManifestRow> take_rows() { return std::move(rows_); }

 private:
  void list(const fs::path& folder, std::error_code& error) {
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
      add_entry(entry->path());
  }
  void add_entry(const fs::path& path) {
    std::error_code none;
    const bool is_link = fs::is_symlink(path, none), is_folder = fs::is_directory(path, none);
    if (is_folder && !is_link) waiting_.push_back(path);
    if (is_folder && is_link)
      add(path, "is a link to a folder, which is not followed; put the folder here, or list its meshes");
    else if (is_mesh(path) || (is_link && !fs::exists(path, none)))
      add(path, why_no_file(path).value_or(""));
  }
  void add(const fs::path& path, const std::string& reason) {
    const std::string name = path.lexically_relative(folder_).generic_string();
    rows_.push_back({name, name, path, reason.empty() ? "" : fmt::format("{}: {}", mesh_mark, reason)});
  }

  fs::path folder_;
  std::vector<fs::path> waiting_;
  std::vector<ManifestRow> rows_;
};

// One record of a CSV file, which may go over several lines; false at the end.
bool read_record(std::istream& in, std::vector<std::string>& cells, std::size_t& line) {
  cells.clear();
  if (in.peek() == std::char_traits<char>::eof()) return false;
  std::string cell;
  bool quoted = false;
  ++line;
  for (int c = in.get(); c != std::char_traits<char>::eof(); c = in.get()) {
    if (quoted) {
      if (c == '"' && in.peek() == '"')
        cell += static_cast<char>(in.get());
      else if (c == '"')
        quoted = false;
      else
        line += c == '\n', cell += static_cast<char>(c);
    } else if (c == '"' && cell.empty()) {
      quoted = true;
    } else if (c == ',') {
      cells.push_back(std::move(cell));
      cell.clear();
    } else if (c == '\n') {
      break;
    } else if (c != '\r') {
      cell += static_cast<char>(c);
    }
  }
  if (quoted) throw UsageError(fmt::format("line {}: a quotation mark is not closed", line));
  cells.push_back(std::move(cell));
  return true;
}

std::vector<ManifestRow> rows_of_csv(std::istream& in, const fs::path& folder) {
  std::vector<std::string> cells;
  std::size_t line = 0;
  if (!read_record(in, cells, line)) return {};
  const auto column = [&](std::initializer_list<std::string_view> names) {
    const auto at = std::find_if(cells.begin(), cells.end(), [&](const std::string& cell) {
      return std::find(names.begin(), names.end(), cell) != names.end();
    });
    return static_cast<std::size_t>(at - cells.begin());
  };
  const std::size_t mesh = column({"mesh", "path", "file"}), name = column({"name"}), columns = cells.size();
  if (mesh == columns) throw UsageError("line 1: no column is called mesh, path or file");
  std::vector<ManifestRow> rows;
  while (read_record(in, cells, line)) {
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (cells.size() != columns)
      throw UsageError(fmt::format("line {}: {} cells, but {} columns", line, cells.size(), columns));
    if (cells[mesh].empty()) throw UsageError(fmt::format("line {}: the cell of the mesh is empty", line));
    const std::string& called = name < columns && !cells[name].empty() ? cells[name] : cells[mesh];
    rows.push_back({called, cells[mesh], referenced_file(cells[mesh], folder)});
  }
  return rows;
}

std::vector<ManifestRow> rows_of_text(std::istream& in, const fs::path& folder) {
  std::vector<ManifestRow> rows;
  for (std::string line; std::getline(in, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
    line.erase(0, line.find_first_not_of(" \t"));
    if (!line.empty() && line[0] != '#') rows.push_back({line, line, referenced_file(line, folder)});
  }
  return rows;
}

// The hash of the parts of a key.
class KeyHash {
 public:
  KeyHash(const std::string& extension, const std::vector<std::string>& words) {
    hash_.take(fmt::format("morula {} batch {}\n{}\n", version, result_format, extension));
    for (const std::string& word : words) hash_.take(word + "\n");
  }
  Hash128& next_file() {
    hash_.take("\n");
    return hash_;
  }
  std::string text() const { return hash_.text(); }

 private:
  static constexpr int result_format = 2;  // counts up when results hold something else
  Hash128 hash_;
};

bool may_name_buffers(const std::string& extension) {
  return extension == ".gltf" || extension == ".glb";
}

// The first chunk of a .glb: after a header of 12 bytes its length, 4 bytes from the least one on, then "JSON" and what
// it holds [gltf2, 4.4]. Empty where there is none.
std::string_view json_of_glb(std::string_view file) {
  constexpr std::size_t head = 20;
  if (file.size() < head || file.substr(0, 4) != "glTF" || file.substr(16, 4) != "JSON") return {};
  std::size_t length = 0;
  for (std::size_t k = 4; k-- > 0;) length = length << 8 | static_cast<unsigned char>(file[12 + k]);
  return file.substr(head, length);
}

std::string key_of_readable_file(const fs::path& mesh, const std::vector<std::string>& words) {
  const std::string kind = extension(mesh);
  KeyHash key(kind, words);
  const auto take = [&](const fs::path& file) {
    if (const auto reason = hash_file(file, key.next_file())) throw FileError(*reason);
  };
  take(mesh);
  if (!may_name_buffers(kind)) return key.text();
  const FileRoots beside({mesh.parent_path()});
  for (const std::string& buffer : buffers_of(bytes_of_file(mesh).value_or(""), kind)) {
    const fs::path file = referenced_file(buffer, mesh.parent_path());
    // The build reports a buffer that cannot be read, or may not be.
    // mutant batch-key-buffers: `if (beside.hold(file) && !why_no_file(file)) take` -> `static_cast<void>`
    // mutant batch-buffers-outside: `beside.hold(file) && !` -> `!`
    if (beside.hold(file) && !why_no_file(file)) take(file);
  }
  return key.text();
}

}  // namespace

std::vector<ManifestRow> rows_of_manifest(const std::string& text, bool is_csv, const fs::path& folder) {
  std::istringstream in(text);
  std::vector<ManifestRow> rows = is_csv ? rows_of_csv(in, folder) : rows_of_text(in, folder);
  if (rows.empty()) throw UsageError("no line names a mesh");
  return rows;
}

std::vector<ManifestRow> read_manifest(const fs::path& path) {
  if (fs::is_directory(path)) {
    std::vector<ManifestRow> rows = FolderListing(path).take_rows();
    if (rows.empty())
      throw UsageError(path.string() + ": there is no mesh in this folder: " + readable_mesh_extensions());
    return rows;
  }
  if (is_mesh(path))
    throw UsageError(path.string() + ": this is a mesh; a manifest is a folder of meshes, a .csv, or a list of paths");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw UsageError(fmt::format("{}: {}", path.string(), std::generic_category().message(errno)));
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  try {
    return rows_of_manifest(text, extension(path) == ".csv", path.parent_path());
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

Shard parse_shard(const std::string& text) {
  Shard shard;
  char rest = 0;
  std::istringstream in(text);
  char slash = 0;
  const bool read = text.find_first_not_of("0123456789/") == std::string::npos &&
                    static_cast<bool>(in >> shard.number >> slash >> shard.count) && slash == '/' && !(in >> rest);
  if (!read || shard.number < 1 || shard.number > shard.count)
    throw UsageError(
        fmt::format("--shard {}: give two whole numbers, such as 2/8 for the second of eight parts", text));
  return shard;
}

RowKey key_of_file(const ManifestRow& row, const std::vector<std::string>& words, const FileRoots* roots) {
  const auto rejected = [](const std::string& reason) {
    return RowKey{{}, text_of_name(fmt::format("{}: {}", mesh_mark, reason))};
  };
  if (!row.rejection.empty()) return {{}, text_of_name(row.rejection)};
  if (const auto outside = roots != nullptr ? roots->refusal(row.mesh, "--root") : std::nullopt)
    return rejected(*outside);
  if (const auto reason = why_no_file(row.mesh)) return rejected(*reason);
  try {
    return {key_of_readable_file(row.mesh, words), {}};
  } catch (const FileError& reason) {
    return rejected(reason.what());
  }
}

std::string key_of_bytes(std::span<const std::string_view> files, const std::string& extension,
                         const std::vector<std::string>& words) {
  KeyHash key(extension, words);
  for (const std::string_view file : files) key.next_file().take(file);
  return key.text();
}

std::vector<std::string> buffers_of(std::string_view mesh, const std::string& extension) {
  std::vector<std::string> names;
  if (!may_name_buffers(extension)) return names;
  const Json scene = Json::parse(extension == ".glb" ? json_of_glb(mesh) : mesh, nullptr, false);
  if (!scene.is_object() || !scene.contains("buffers") || !scene["buffers"].is_array()) return names;
  for (const Json& buffer : scene["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
    std::string name = buffer["uri"];
    if (!name.starts_with("data:")) names.push_back(std::move(name));
  }
  return names;
}

}  // namespace morula::cli
