// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres on disk: the spheres of all frames of a motion, or of a single tree, in a NumPy archive; balls without a
// tree; scenes for other programs.
//
//   const morula::CoveredTree model = morula::build(mesh);
//   morula::SphereFramesWriter writer("spheres.npz", model.tree, 1);  // one frame
//   writer.write(model.tree.spheres);
//   writer.finish();
//   const morula::SphereTree first = morula::SphereFrames("spheres.npz").frame(0);
#pragma once

#include <filesystem>
#include <memory>
#include <morula/geometry/sphere.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula {

namespace detail {
class StoredZip;
}

/// Writes a .npz: arrays `spheres` (frames, nodes, 4), float64, x y z r in mesh units, and the tree, int32:
/// `level_begin` (levels + 1), `parent`, `first_child`, `child_count` (nodes); -1 for the parent of the root and the
/// first child of a leaf. numpy.load(path) reads it. Uncompressed; the same spheres give the same bytes.
class SphereFramesWriter {
 public:
  /// Throws FileError if the folder is missing, or if the file would exceed the 4 GiB of a plain archive or the free
  /// space of the disk; throws std::invalid_argument for a path that does not end in .npz. Keeps one frame in memory.
  SphereFramesWriter(const std::filesystem::path& path, const SphereTree& tree, std::size_t frame_count);
  ~SphereFramesWriter();
  SphereFramesWriter(const SphereFramesWriter&) = delete;
  SphereFramesWriter& operator=(const SphereFramesWriter&) = delete;

  /// Writes a frame. spheres: one per node. The file marks the tree as nested if `tree` is and every frame is.
  void write(std::span<const Sphere> spheres);
  /// Ends the file after the last frame; it appears at once. Throws FileError if frames are missing.
  void finish();

 private:
  std::filesystem::path path_;
  SphereTree tree_;
  std::size_t frame_count_;
  std::size_t written_ = 0;
  std::unique_ptr<detail::StoredZip> archive_;
  std::string chunk_;
};

/// Reads archives of SphereFramesWriter and write_tree, and all archives of stored arrays with the same content:
/// `spheres` of shape (frames, nodes, 4) or (nodes, 4), float32 or float64; the tree's four arrays, integers of 32 or
/// 64 bits; and `branching` (1,), which defaults to the largest number of children. Frames are read one at a time.
class SphereFrames {
 public:
  /// Throws FileError for other files, for sizes that disagree, and for arrays that are not a tree.
  explicit SphereFrames(const std::filesystem::path& path);
  ~SphereFrames();
  SphereFrames(SphereFrames&&) noexcept;
  SphereFrames& operator=(SphereFrames&&) noexcept;

  std::size_t frame_count() const;
  std::size_t node_count() const;
  /// True if `spheres` has an axis of frames, even with one frame.
  bool is_motion() const;
  /// A valid tree, the same in all frames except for its spheres. Throws FileError for spheres that are not finite or
  /// have a negative radius.
  SphereTree frame(std::size_t i) const;

 private:
  struct Arrays;
  std::unique_ptr<const Arrays> arrays_;
};

/// True for an .npz with an array `spheres`. False for all other files, including missing and broken ones.
bool holds_spheres(const std::filesystem::path& path);

/// Writes spheres in the format of SOFA's SphereLoader. Its .sph is not the format of the toolkit: it has `sph 1.0`,
/// `nums N` and a line `sphe index x y z r` for each sphere, with the fewest digits that read back as the same bits.
/// Throws std::invalid_argument for numbers that are not finite.
void write_sofa_spheres(const std::filesystem::path& path, std::span<const Sphere> spheres);

/// Writes moving spheres as a glTF scene (.glb) for Blender and other viewers, as a picture without proof: a ball of
/// 320 facets with its corners on the unit sphere; a node per sphere, which moves and scales the ball; and with several
/// frames an animation of all nodes, linear between frames. Numbers are floats; axes stay unchanged (glTF defines y as
/// up). Needs no tinygltf. frames: at least one, all with the same number of spheres, at least one. Throws
/// std::invalid_argument, and FileError for scenes above 2 GiB.
void write_gltf_spheres(const std::filesystem::path& path, std::span<const std::vector<Sphere>> frames,
                        double frames_per_second = 30);

/// Writes balls without a tree, for viewers and scripts, as PLY (binary, doubles): one vertex per ball, with the
/// properties x, y, z and radius. The write is atomic. Throws FileError for another extension and for files that cannot
/// be written, std::invalid_argument for balls that are not finite.
void write_balls(const std::filesystem::path& path, std::span<const Sphere> balls);

/// Reads balls of a PLY of any kind (ascii, little or big endian; other properties and elements are skipped): vertices
/// with a property `radius`, without faces. Throws FileError, also for radii that are negative or not finite.
std::vector<Sphere> read_balls(const std::filesystem::path& path);

/// True if the header of this .ply describes balls instead of a mesh. False for all other files, including missing and
/// broken ones.
bool is_ball_file(const std::filesystem::path& path);

}  // namespace morula
