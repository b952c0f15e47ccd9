// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The spheres of all frames of a motion in one NumPy archive, and those of a single tree.
//
//   const morula::CoveredTree model = morula::build(mesh);
//   morula::SphereFramesWriter writer("spheres.npz", model.tree, 1);  // of one frame
//   writer.write(model.tree.spheres);
//   writer.finish();
//   const morula::SphereTree first = morula::SphereFrames("spheres.npz").frame(0);
#pragma once

#include <memory>
#include <morula/io/mesh_file.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <string>

namespace morula {

namespace detail {
class StoredZip;
}

/// Writes a .npz: arrays `spheres` (frames, nodes, 4), float64, x y z r in mesh units, and the tree, int32:
/// `level_begin` (levels + 1), `parent`, `first_child`, `child_count` (nodes); -1 for the parent of the root and the
/// first child of a leaf. numpy.load(path) reads it. Uncompressed; the same spheres give the same bytes.
class SphereFramesWriter {
 public:
  /// Throws FileError when the folder is missing or the file would be larger than the 4 GiB of a plain archive or than
  /// what is left of the disk, and std::invalid_argument for a path that does not end in .npz. Keeps one frame in
  /// memory.
  SphereFramesWriter(const std::filesystem::path& path, const SphereTree& tree, std::size_t frame_count);
  ~SphereFramesWriter();
  SphereFramesWriter(const SphereFramesWriter&) = delete;
  SphereFramesWriter& operator=(const SphereFramesWriter&) = delete;

  /// spheres: one per node. The file says that the tree is nested where `tree` did and every frame is.
  void write(std::span<const Sphere> spheres);
  /// After the last frame; the file appears whole now. Throws FileError if frames are missing.
  void finish();

 private:
  std::filesystem::path path_;
  SphereTree tree_;
  std::size_t frame_count_;
  std::size_t written_ = 0;
  std::unique_ptr<detail::StoredZip> archive_;
  std::string chunk_;
};

/// Reads what SphereFramesWriter and write_tree wrote, or any archive of stored arrays that says the same: `spheres` of
/// shape (frames, nodes, 4) or (nodes, 4), float32 or float64, the tree's four arrays, integers of 32 or 64 bits, and
/// `branching` (1,), without which it is the largest number of children. Frames are read one at a time.
class SphereFrames {
 public:
  /// Throws FileError for anything else, sizes that disagree, and arrays that are no tree.
  explicit SphereFrames(const std::filesystem::path& path);
  ~SphereFrames();
  SphereFrames(SphereFrames&&) noexcept;
  SphereFrames& operator=(SphereFrames&&) noexcept;

  std::size_t frame_count() const;
  std::size_t node_count() const;
  /// `spheres` has an axis of frames, be it of one.
  bool is_motion() const;
  /// A valid tree, the same in all frames but for its spheres. Throws FileError for spheres that are not finite or have
  /// a negative radius.
  SphereTree frame(std::size_t i) const;

 private:
  struct Arrays;
  std::unique_ptr<const Arrays> arrays_;
};

/// Is this an .npz with an array `spheres`? False for all other files, missing and broken ones included.
bool holds_spheres(const std::filesystem::path& path);

}  // namespace morula
