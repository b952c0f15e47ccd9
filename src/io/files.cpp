// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <morula/io/files.hpp>
#include <morula/io/mesh_file.hpp>
#include <optional>
#include <string>
#include <system_error>

#include "io/mesh/formats.hpp"
#include "io/whole_file.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Digits compare as numbers: frame9 comes before frame10. Names that differ in leading zeros only compare as text.
bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t a_begin = i, b_begin = j;
    while (i < a.size() && is_digit(a[i])) ++i;
    while (j < b.size() && is_digit(b[j])) ++j;
    if (i - a_begin != j - b_begin) return i - a_begin < j - b_begin;
    if (const int order = a.compare(a_begin, i - a_begin, b, b_begin, j - b_begin)) return order < 0;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

// * stands for any characters, ? for one.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0;
  std::size_t star = std::string_view::npos, resume = 0;  // place of the last star, and end of the text that it matches
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// A name around its last run of digits before the extension.
struct NumberedName {
  std::string before, digits, after;
  std::uint64_t number = 0;
};

std::optional<NumberedName> numbered(const fs::path& file) {
  const std::string name = platform::text_of(file.filename());
  const std::size_t stem = platform::text_of(file.stem()).size();
  std::size_t end = stem;
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && is_digit(name[begin - 1])) --begin;
  NumberedName result{name.substr(0, begin), name.substr(begin, end - begin), name.substr(end)};
  const char* const last = name.data() + end;
  const auto parsed = std::from_chars(name.data() + begin, last, result.number);
  if (begin == end || parsed.ec != std::errc() || parsed.ptr != last) return std::nullopt;
  return result;
}

/// Throws when numbered frames leave out a number: the rest would move up unnoticed.
void require_no_gap(const fs::path& folder, std::string_view pattern, const std::vector<fs::path>& files) {
  std::vector<NumberedName> names;
  for (const fs::path& file : files) {
    const std::optional<NumberedName> name = numbered(file);
    if (!name || name->after != numbered(files.front())->after || name->before != numbered(files.front())->before)
      return;
    names.push_back(*name);
  }
  if (names.size() < 3) return;
  std::uint64_t step = names[1].number - names[0].number;
  for (std::size_t i = 1; i < names.size(); ++i) step = std::min(step, names[i].number - names[i - 1].number);
  if (step == 0) return;
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (names[i].number - names[i - 1].number == step) continue;
    // Numbers are padded like those of the preceding name.
    std::string digits = std::to_string(names[i - 1].number + step);
    const std::size_t width = names[i - 1].digits.size();
    if (names[i - 1].digits.front() == '0' && digits.size() < width) digits.insert(0, width - digits.size(), '0');
    const std::string missing = names[i].before + digits + names[i].after;
    if (!matches(pattern, missing)) continue;  // the pattern excludes it on purpose
    throw FileError(platform::text_of(folder) + ": " + missing + " is missing between " +
                    platform::text_of(files[i - 1].filename()) + " and " + platform::text_of(files[i].filename()) +
                    "; add it, or number the frames without a gap");
  }
}

}  // namespace

SystemFileError::SystemFileError(const fs::path& file, const std::string& problem, int error)
    : FileError(platform::text_of(file) + ": " + problem),
      file_(std::make_shared<const fs::path>(file)),
      error_(error) {}

std::vector<fs::path> frame_files(const fs::path& folder, std::string_view pattern,
                                  const std::set<std::string>& extensions) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const fs::path& file = entries->path();
    std::error_code ignored;
    const std::string name = platform::text_of(file.filename());
    if (name[0] != '.' && matches(pattern, name) && extensions.count(lower_extension(file)) != 0 &&
        entries->is_regular_file(ignored))
      files.push_back(file);
  }
  if (error == std::errc::no_such_file_or_directory)
    throw SystemFileError(folder, "there is no such folder; check the name, or where you are", ENOENT);
  if (error) throw SystemFileError(folder, "the folder cannot be read (" + error.message() + ")", error.value());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(platform::text_of(a.filename()), platform::text_of(b.filename()));
  });
  if (!files.empty()) require_no_gap(folder, pattern, files);
  return files;
}

namespace {

std::string program_of(std::string_view extension) {
  constexpr std::pair<std::string_view, std::string_view> programs[] = {
      {".obj", "Wavefront"}, {".off", "Geomview"},     {".ply", "Stanford"},   {".stl", "Stereolithography"},
      {".gltf", "glTF 2.0"}, {".glb", "glTF 2.0"},     {".vtk", "VTK legacy"}, {".vtp", "VTK XML"},
      {".vtu", "VTK XML"},   {".msh", "Gmsh 2.2, 4.1"}};
  for (const auto& [known, program] : programs)
    if (known == extension) return std::string(program);
  return {};
}

}  // namespace

std::vector<FileFormat> file_formats() {
  std::vector<FileFormat> formats;
  const auto add = [&](const char* extension, const char* program, bool is_read, bool is_written, const char* purpose) {
    formats.push_back({extension, program, is_read, is_written, purpose});
  };
  for (const MeshFormat& format : mesh_formats) {
    formats.push_back(
        {std::string(format.extension), program_of(format.extension), true, format.write != nullptr, "meshes"});
  }
  for (const MeshFormat& format : mesh_formats) {
    const bool is_written = format.write != nullptr && format.keeps_vertices;
    formats.push_back({std::string(format.extension), program_of(format.extension), true, is_written,
                       format.open_frames != nullptr ? "motions" : "frames of motions"});
  }
  add(".npy", "NumPy", true, true, "motions");
  add(".npz", "NumPy", true, false, "motions");
  add(".pc2", "PointCache2", true, true, "motions");
  add(".mdd", "Motion Designer", true, true, "motions");
  add(".npy", "NumPy", true, true, "modal models");
  add(".npy", "NumPy", true, true, "skins");
  add(".gltf", "glTF 2.0", true, false, "skins");
  add(".glb", "glTF 2.0", true, false, "skins");
  add(".morula", "Morula", true, true, "trees with their covers");
  add(".sph", "the published toolkit", true, true, "spheres of a tree");
  add(".json", "Morula", true, true, "spheres of a tree");
  add(".npz", "NumPy", true, true, "spheres of a tree");
  add(".npz", "NumPy", true, true, "spheres of frames");
  add(".ply", "Stanford", true, true, "balls without a tree");
  add(".sph", "SOFA", false, true, "balls without a tree");
  add(".glb", "glTF 2.0", false, true, "spheres in motion, to look at");
  add(".vtp", "VTK XML", false, true, "spheres, contacts and surfaces with numbers");
  add(".pvd", "ParaView", false, true, "spheres, contacts and surfaces with numbers");
  return formats;
}

}  // namespace morula
