// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "peers.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace morula::characters {

JointBoxes::JointBoxes(const Mesh& mesh, const Skin& skin) : rest_(skin.bone_count) {
  std::vector<bool> is_used(mesh.vertex_count());
  for (const Facet& facet : mesh.facets)
    for (const std::uint32_t v : facet) is_used[v] = true;
  for (std::uint32_t v = 0; v < is_used.size(); ++v) {
    if (!is_used[v]) continue;
    used_.push_back(v);
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k)
      if (skin.weights[k] > 0) rest_[skin.bones[k]].add(mesh.positions[v]);
  }
}

Box JointBoxes::box(std::span<const AffineTransform> transforms) const {
  Box all;
  for (std::size_t b = 0; b < rest_.size(); ++b) {
    const Box& rest = rest_[b];
    if (rest.is_empty()) continue;
    const AffineTransform& t = transforms[b];
    const Vec3 center = t(rest.center()), half = rest.extent() * 0.5;
    Vec3 reach{};
    for (int axis = 0; axis < 3; ++axis)
      reach[axis] = std::abs(t.columns[0][axis]) * half.x + std::abs(t.columns[1][axis]) * half.y +
                    std::abs(t.columns[2][axis]) * half.z;
    all.add(center - reach);
    all.add(center + reach);
  }
  return all;
}

void write_peer_file(const std::filesystem::path& path, const Mesh& mesh, const Skin& skin,
                     std::span<const BoneFrames> animations) {
  static_assert(std::endian::native == std::endian::little);
  std::ofstream file(path, std::ios::binary);
  const auto put = [&](auto value) { file.write(reinterpret_cast<const char*>(&value), sizeof value); };
  const auto put_float = [&](double value) { put(static_cast<float>(value)); };
  std::size_t frames = 0;
  for (const BoneFrames& animation : animations) frames += animation.frame_count();
  for (const std::size_t count : {mesh.vertex_count(), mesh.facets.size(), skin.bone_count, frames})
    put(static_cast<std::uint32_t>(count));
  for (const Vec3& p : mesh.positions) put_float(p.x), put_float(p.y), put_float(p.z);
  for (const Facet& facet : mesh.facets)
    for (const std::uint32_t v : facet) put(v);
  std::vector<std::array<std::pair<double, std::uint16_t>, 4>> rows;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    std::vector<std::pair<double, std::uint16_t>> row;
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k)
      row.emplace_back(skin.weights[k], static_cast<std::uint16_t>(skin.bones[k]));
    std::sort(row.rbegin(), row.rend());
    row.resize(4);
    double sum = 0;
    for (const auto& [weight, bone] : row) sum += weight;
    auto& four = rows.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) four[k] = {sum > 0 ? row[k].first / sum : 0, row[k].second};
  }
  for (const auto& row : rows)
    for (const auto& [weight, bone] : row) put(bone);
  for (const auto& row : rows)
    for (const auto& [weight, bone] : row) put_float(weight);
  for (const BoneFrames& animation : animations)
    for (const AffineTransform& t : animation.transforms)
      for (int axis = 0; axis < 3; ++axis) {
        for (const Vec3& column : t.columns) put_float(column[axis]);
        put_float(t.translation[axis]);
      }
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace morula::characters
