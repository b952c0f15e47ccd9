// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "input.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/mesh_file.hpp>
#include <scenes/scenes.hpp>
#include <stdexcept>

namespace morula::bench {
namespace {

constexpr std::string_view sheet_name = "sheet";

bool is_sample_body(std::string_view name) {
  const auto names = sample_body_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Squares of a side of 1, resolution by resolution, in a plane.
Mesh flat_sheet(int resolution) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(resolution);
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) mesh.positions.push_back({1.0 * x, 1.0 * y, 0});
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t v = y * (n + 1) + x, w = v + n + 1;
      mesh.facets.push_back({v, v + 1, w + 1});
      mesh.facets.push_back({v, w + 1, w});
    }
  return mesh;
}

Input input(const std::string& wanted) {
  const std::size_t colon = wanted.find(':');
  const std::string name = wanted.substr(0, colon);
  if (!is_sample_body(name) && name != sheet_name) {
    const std::filesystem::path file = wanted;
    if (!file.has_extension()) {
      std::string known;
      for (const std::string_view body : sample_body_names()) known.append(" ").append(body);
      known.append(" ").append(sheet_name);
      throw std::invalid_argument("'" + wanted + "' is neither a mesh file nor a sample body; those are" + known);
    }
    return {file.stem().string(), read_mesh(file)};
  }
  int resolution = 48;
  if (colon != std::string::npos) {
    const char* end = wanted.data() + wanted.size();
    const auto [stop, error] = std::from_chars(wanted.data() + colon + 1, end, resolution);
    if (error != std::errc() || stop != end)
      throw std::invalid_argument("'" + wanted + "': expected NAME:RESOLUTION, such as limb:48");
  }
  if (name == sheet_name) {
    if (resolution < 1 || resolution > 4096)
      throw std::invalid_argument("'" + wanted + "': a sheet has a resolution from 1 to 4096");
    return {wanted, flat_sheet(resolution)};
  }
  return {wanted, sample_body(name, resolution)};
}

}  // namespace

std::vector<Input> inputs(const std::vector<std::string>& wanted) {
  std::vector<std::string> names = wanted;
  if (names.empty()) {
    names = {"limb", "blob"};
    if (const auto folder = scenes::corpus_folder())
      if (const auto bunny = *folder / "bunny00.off"; std::filesystem::exists(bunny)) names.push_back(bunny.string());
  }
  std::vector<Input> found;
  for (const std::string& name : names) {
    found.push_back(input(name));
    require_usable(found.back().mesh);
  }
  return found;
}

}  // namespace morula::bench
