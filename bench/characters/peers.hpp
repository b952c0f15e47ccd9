// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <morula/geometry/box.hpp>
#include <morula/io/skin_file.hpp>
#include <span>
#include <vector>

namespace morula::characters {

/// Bounds of the usual kind: for each bone the box, at rest, of the vertices with a positive weight of it. Moved by the
/// bones, the boxes together contain the vertices whose weights are not negative and add up to 1.
class JointBoxes {
 public:
  JointBoxes(const Mesh& mesh, const Skin& skin);
  /// The box of the moved boxes.
  Box box(std::span<const AffineTransform> transforms) const;
  /// The vertices that facets use.
  std::span<const std::uint32_t> used_vertices() const { return used_; }

 private:
  std::vector<std::uint32_t> used_;
  std::vector<Box> rest_;
};

/// Writes what scripts/characters passes to other programs, little-endian: uint32 counts of vertices, facets, bones and
/// frames; float32 positions; uint32 facets; uint16 bones and float32 weights, the four largest of each vertex, divided
/// by their sum; float32 transforms of all frames, 3 × 4 by rows. Throws std::runtime_error if the file cannot be
/// written.
void write_peer_file(const std::filesystem::path& path, const Mesh& mesh, const Skin& skin,
                     std::span<const BoneFrames> animations);

}  // namespace morula::characters
