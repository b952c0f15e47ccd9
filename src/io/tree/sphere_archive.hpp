// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Archives of spheres, taken apart: the arrays of a tree, and its spheres frame by frame. docs/reference/formats.md
// describes them.
#pragma once

#include <filesystem>
#include <morula/tree/sphere_tree.hpp>

#include "io/array/npy.hpp"
#include "io/array/stored_zip.hpp"

namespace morula::detail {

class SphereArchive {
 public:
  /// Throws FileError for arrays that are missing or inconsistent, or make no tree. Checks the checksums of all arrays
  /// except the spheres of a motion, which are read one frame at a time.
  explicit SphereArchive(ByteSource source);

  std::size_t frame_count() const { return is_motion() ? spheres_.shape[0] : 1; }
  std::size_t node_count() const { return structure_.node_count(); }
  bool is_motion() const { return spheres_.shape.size() == 3; }
  SphereTree frame(std::size_t i) const;

 private:
  ByteSource source_;
  ByteSource sphere_source_;
  NpyArray spheres_;
  SphereTree structure_;  // tree with spheres of radius 0
};

/// The one tree of an archive. Throws FileError when there are several frames.
SphereTree read_npz_tree(const ByteSource& source);

/// Adds level_begin, parent, first_child and child_count; nested, if the tree is.
void add_structure(StoredZip& archive, const SphereTree& tree);
/// The tree must be valid. Throws FileError when the archive would be larger than 4 GiB.
void write_tree_archive(const std::filesystem::path& path, const SphereTree& tree);

/// A tree from child counts and levels, which determine it. Throws FileError, for which path is needed, when they make
/// no tree.
SphereTree tree_of_counts(const std::filesystem::path& path, std::span<const Sphere> spheres,
                          std::span<const std::uint32_t> child_count, std::span<const std::uint32_t> level_begin,
                          std::uint32_t branching);

}  // namespace morula::detail
