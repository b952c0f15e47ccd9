// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere trees on disk: .morula, the native format, holds the tree and its cover; .sph, .json and .npz hold the spheres
// alone. docs/reference/formats.md describes the formats.
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
  std::optional<Cover> cover;      ///< cover of a native file; no value for other formats
  BuildReport report;              ///< report of a native file; default values for other formats
  std::vector<KnownPose> poses{};  ///< known poses of a native file; empty for other formats
};

struct ReadTreeOptions {
  /// Vector that is added to every center read from a .sph, mesh units; finite. Other formats ignore it. Bradshaw's
  /// toolkit [bradshaw2004] writes centers relative to the center of the mesh's bounding box; that center is then the
  /// vector (command: --sph-origin bbox-center).
  Vec3 sph_origin{0, 0, 0};
};

/// Reads a tree from .morula, .sph, .json, .npz or .ply; the extension determines the format. A .ply holds balls
/// without a tree; tree_from_spheres() makes their tree.
///
/// The reader checks sizes, ranges and finiteness, and the checksums of .morula and .npz. In a .sph, a radius of 0 or
/// less marks an unused slot: the reader skips it and all slots below it, and ignores text after the last slot. Throws
/// FileError for a file that is missing, fails a check, or is an .npz of several frames, which SphereFrames reads;
/// std::invalid_argument if sph_origin is not finite.
TreeFile read_tree(const std::filesystem::path& path, const ReadTreeOptions& options = {});

/// Reads a tree, and returns it with a cover of this mesh. A native file has its own cover, which must belong to
/// exactly this mesh: the same positions and facets in the same order. A tree of another format gets its cover from
/// cover(mesh, tree), which enlarges spheres that do not contain their part of the surface; report.growth counts them.
///
/// workers: by default one thread per processor. Throws FileError for a file that read_tree() rejects, a native file of
/// another mesh or with a cover that validate() rejects, and a tree that cover() rejects. Throws std::invalid_argument
/// for a mesh that require_usable() rejects and, if the file has no cover, for one that require_usable_scale() rejects.
CoveredTree read_covered_tree(const std::filesystem::path& path, const MeshView& mesh,
                              const ReadTreeOptions& options = {}, WorkersOrAll workers = {});

/// Writes a model to .morula: read_tree() returns the same bits of tree, cover and known poses, and the report without
/// the properties of the run. Writes only the tree's spheres to .sph, .json and .npz, like write_tree(path, tree).
///
/// The write is atomic: the path has the old file until the new one is complete. Throws std::invalid_argument if tree,
/// cover or a known pose fails validate(), and FileError like write_tree(path, tree).
void write_tree(const std::filesystem::path& path, const CoveredTree& model);
/// Writes the spheres of a tree to .sph, .json or .npz, atomically. A .sph gets centers in mesh coordinates. Throws
/// std::invalid_argument if the tree fails validate() or has more than max_depth + 1 levels. Throws FileError for
/// another extension, a file that cannot be written and, for .sph, a radius of 0 or a full tree of more than ten
/// million slots.
void write_tree(const std::filesystem::path& path, const SphereTree& tree);

}  // namespace morula
