// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere trees on disk: native .morula with its cover, .sph, .json and .npz with spheres alone. Formats:
// docs/reference/formats.md.
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/tree/cover.hpp>
#include <optional>

namespace morula {

/// What a tree file held.
struct TreeFile {
  SphereTree tree;
  std::optional<Cover> cover;      ///< native files only
  BuildReport report;              ///< native files only
  std::vector<KnownPose> poses{};  ///< native files only
};

struct ReadTreeOptions {
  /// Added to every center of a .sph. The published toolkit writes centers relative to the mesh's box center: pass that
  /// (CLI: --sph-origin bbox-center).
  Vec3 sph_origin{0, 0, 0};
};

/// Reads .morula, .sph, .json or .npz by extension, and balls without a tree, .ply, under a tree made of them
/// (tree_from_spheres). Sizes, ranges, finiteness and (native, .npz) checksums are checked. An .npz of several frames
/// is refused: SphereFrames reads those. In a .sph, radius ≤ 0 marks an unused slot, nodes below an unused one are
/// ignored, and text after the last node is accepted. Throws FileError.
TreeFile read_tree(const std::filesystem::path& path, const ReadTreeOptions& options = {});

/// A tree with a cover for this mesh: a native file's own when it was built for exactly this mesh (else FileError), or
/// cover(mesh, tree) for a bare tree, with report.growth filled in.
CoveredTree read_covered_tree(const std::filesystem::path& path, const MeshView& mesh,
                              const ReadTreeOptions& options = {}, WorkersOrAll workers = {});

/// Writes .morula (bits round-trip, known poses included), .sph (spheres in mesh coordinates; refused above ten million
/// slots), .json or .npz. Written whole or not at all.
void write_tree(const std::filesystem::path& path, const CoveredTree& model);
/// Spheres alone: .sph, .json or .npz.
void write_tree(const std::filesystem::path& path, const SphereTree& tree);

}  // namespace morula
