// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres on disk: those of all frames of a motion or of a single tree in a NumPy archive; balls without a tree; scenes
// for other programs.
//
//   const morula::CoveredTree model = morula::build(mesh);
//   morula::SphereFramesWriter writer("spheres.npz", model.tree, 1);  // of one frame
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

/// Writes spheres as SOFA's SphereLoader reads them; its .sph is another format than the toolkit's: `sph 1.0`, `nums N`
/// and a line `sphe index x y z r` for each sphere, with the fewest digits that read back as the same bits. Throws
/// std::invalid_argument for numbers that are not finite.
void write_sofa_spheres(const std::filesystem::path& path, std::span<const Sphere> spheres);

/// Writes spheres in motion as a scene of glTF (.glb), for Blender and other viewers, a picture without proof: a ball
/// of 320 facets with its corners on the unit sphere, a node for each sphere, which shows the ball moved and scaled,
/// and where there are several frames an animation of all nodes, linear between them. Floats; axes are left as they are
/// (glTF calls y up). Needs no tinygltf. frames: at least one, each with as many spheres as the first, at least one.
/// Throws std::invalid_argument, and FileError for what does not fit into 2 GiB.
void write_gltf_spheres(const std::filesystem::path& path, std::span<const std::vector<Sphere>> frames,
                        double frames_per_second = 30);

/// Writes balls without a tree, for viewers and scripts, as PLY (binary, doubles): one vertex a ball, with the
/// properties x, y, z and radius. Written whole or not at all. Throws FileError for another extension and for files
/// that cannot be written, std::invalid_argument for balls that are not finite.
void write_balls(const std::filesystem::path& path, std::span<const Sphere> balls);

/// Balls of a PLY of any kind (ascii, little or big endian; other properties and elements are skipped): vertices with a
/// property `radius`, without faces. Throws FileError, also for radii that are negative or not finite.
std::vector<Sphere> read_balls(const std::filesystem::path& path);

/// Does the header of this .ply promise balls rather than a mesh? False for all other files, missing and broken ones
/// included.
bool is_ball_file(const std::filesystem::path& path);

}  // namespace morula
