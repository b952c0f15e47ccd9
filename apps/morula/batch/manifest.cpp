// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/manifest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <morula/io/file_reference.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/version.hpp>
#include <sstream>
#include <system_error>

#include "shared/command.hpp"
#include "shared/files.hpp"

namespace morula::cli {
namespace {
namespace fs = std::filesystem;

bool is_mesh(const fs::path& path) {
  const std::string kind = extension(path);
  const auto kinds = mesh_file_kinds();
  return std::any_of(kinds.begin(), kinds.end(), [&](const MeshFileKind& known) { return known.extension == kind; });
}

std::vector<ManifestRow> meshes_below(const fs::path& folder) {
  std::vector<ManifestRow> rows;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && is_mesh(entry.path()))
      rows.push_back({entry.path().lexically_relative(folder).generic_string(), entry.path()});
  std::sort(rows.begin(), rows.end(), [](const ManifestRow& a, const ManifestRow& b) { return a.name < b.name; });
  return rows;
}

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
    rows.push_back(
        {name < columns && !cells[name].empty() ? cells[name] : cells[mesh], referenced_file(cells[mesh], folder)});
  }
  return rows;
}

std::vector<ManifestRow> rows_of_text(std::istream& in, const fs::path& folder) {
  std::vector<ManifestRow> rows;
  for (std::string line; std::getline(in, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
    line.erase(0, line.find_first_not_of(" \t"));
    if (!line.empty() && line[0] != '#') rows.push_back({line, referenced_file(line, folder)});
  }
  return rows;
}

}  // namespace

std::vector<ManifestRow> read_manifest(const fs::path& path) {
  std::vector<ManifestRow> rows;
  if (fs::is_directory(path)) {
    rows = meshes_below(path);
    if (rows.empty())
      throw UsageError(path.string() + ": there is no mesh in this folder: " + readable_mesh_extensions());
    return rows;
  }
  if (is_mesh(path))
    throw UsageError(path.string() + ": this is a mesh; a manifest is a folder of meshes, a .csv, or a list of paths");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw UsageError(fmt::format("{}: {}", path.string(), std::generic_category().message(errno)));
  try {
    rows = extension(path) == ".csv" ? rows_of_csv(in, path.parent_path()) : rows_of_text(in, path.parent_path());
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", path.string(), error.what()));
  }
  if (rows.empty()) throw UsageError(path.string() + ": no line names a mesh");
  return rows;
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

std::string content_key(const fs::path& mesh, std::string_view options) {
  // FNV-1a from two beginnings: what collides from one does not from the other.
  std::array<std::uint64_t, 2> hash{0xcbf29ce484222325u, 0x84222325cbf29ce4u};
  const auto take = [&](const char* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      for (std::uint64_t& h : hash) h = (h ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3u;
  };
  const std::string words = fmt::format("morula {} {}\n", version, options);
  take(words.data(), words.size());
  std::ifstream in(mesh, std::ios::binary);
  if (!in || fs::is_directory(mesh))
    throw FileError(
        fmt::format("{}: {}", mesh.string(), fs::exists(mesh) ? "cannot be read" : "there is no such file"));
  std::array<char, 1 << 16> part;
  while (in.read(part.data(), part.size()), in.gcount() > 0) take(part.data(), static_cast<std::size_t>(in.gcount()));
  return fmt::format("{:016x}{:016x}", hash[0], hash[1]);
}

}  // namespace morula::cli
