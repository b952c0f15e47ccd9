// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere trees on disk: native .morula with its cover; .sph, .json and .npz with spheres alone. Formats:
// docs/reference/formats.md.
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/tree/cover.hpp>
#include <optional>

namespace morula {

/// The content of a tree file.
struct TreeFile {
  SphereTree tree;
  std::optional<Cover> cover;      ///< native files only
  BuildReport report;              ///< native files only
  std::vector<KnownPose> poses{};  ///< native files only
};

struct ReadTreeOptions {
  /// Offset of every center of a .sph, mesh units. The published toolkit writes centers relative to the mesh's box
  /// center, which is then the offset (CLI: --sph-origin bbox-center).
  Vec3 sph_origin{0, 0, 0};
};

/// Reads .morula, .sph, .json or .npz by extension, and balls without a tree, .ply, with a tree made of them
/// (tree_from_spheres). Sizes, ranges, finiteness and (native, .npz) checksums are checked. An .npz of several frames
/// is rejected; SphereFrames reads it. In a .sph, radius ≤ 0 marks an unused slot, nodes below an unused slot are
/// ignored, and text after the last node is accepted. Throws FileError.
TreeFile read_tree(const std::filesystem::path& path, const ReadTreeOptions& options = {});

/// A tree with a cover for this mesh: a native file's own cover if it was built for exactly this mesh (otherwise throws
/// FileError), or cover(mesh, tree) for a tree without a cover, with report.growth filled in.
CoveredTree read_covered_tree(const std::filesystem::path& path, const MeshView& mesh,
                              const ReadTreeOptions& options = {}, WorkersOrAll workers = {});

/// Writes .morula (bits round-trip, including known poses), .sph (spheres in mesh coordinates; rejected above ten
/// million slots), .json or .npz. The write is atomic.
void write_tree(const std::filesystem::path& path, const CoveredTree& model);
/// Writes spheres alone: .sph, .json or .npz.
void write_tree(const std::filesystem::path& path, const SphereTree& tree);

}  // namespace morula
