// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/mujoco_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <morula/io/mesh_file.hpp>

#include "io/byte_reader.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula::robot {

bool is_mujoco_mesh(const std::filesystem::path& path) {
  std::string ending = platform::text_of(path.extension());
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  if (ending != ".msh") return false;
  // Counts of vertices may also contain the byte of a dollar: counts that spell the first letters of a word after it
  // would exceed a billion.
  std::array<char, 4> start{};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  return !(start[0] == '$' && std::all_of(start.begin() + 1, start.end(), is_letter));
}

Mesh read_mujoco_mesh(const std::filesystem::path& path) {
  const std::string bytes = detail::read_whole(path);
  const auto reject = [&](const std::string& text) {
    return FileError(fmt::format("{}: {}; save the mesh as OBJ or STL", platform::text_of(path), text));
  };
  constexpr std::size_t head = 16;
  if (bytes.size() < head) throw reject("is too short for a mesh of MuJoCo");
  std::array<std::uint64_t, 4> counts{};  // vertices, normals, places in a texture, facets
  for (std::size_t i = 0; i < 4; ++i) {
    const auto count = detail::load<std::int32_t>(bytes.data() + 4 * i);
    if (count < 0) throw reject("has a number of vertices or facets below 0, so it is no mesh of MuJoCo");
    counts[i] = static_cast<std::uint64_t>(count);
  }
  const std::uint64_t facets_at = head + 12 * counts[0] + 12 * counts[1] + 8 * counts[2];
  if (facets_at + 12 * counts[3] != bytes.size()) {
    throw reject(fmt::format("has {} bytes where its numbers of vertices and facets require {}", bytes.size(),
                             facets_at + 12 * counts[3]));
  }
  if (counts[3] == 0) throw reject("has no facets, and the hull of its vertices, which is meant, is not computed");
  Mesh mesh;
  detail::InterruptPoller poll_interrupt(1u << 14);
  for (std::uint64_t v = 0; v < counts[0]; ++v) {
    poll_interrupt();
    const char* at = bytes.data() + head + 12 * v;
    const Vec3 p{detail::load<float>(at), detail::load<float>(at + 4), detail::load<float>(at + 8)};
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw reject(fmt::format("has a coordinate that is no number in vertex {}", v));
    }
    mesh.positions.push_back(p);
  }
  for (std::uint64_t f = 0; f < counts[3]; ++f) {
    poll_interrupt();
    Facet facet{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = detail::load<std::int32_t>(bytes.data() + facets_at + 12 * f + 4 * k);
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= counts[0]) {
        throw reject(fmt::format("facet {} names vertex {} of {}", f, vertex, counts[0]));
      }
      facet[k] = static_cast<std::uint32_t>(vertex);
    }
    mesh.facets.push_back(facet);
  }
  return mesh;
}

}  // namespace morula::robot
