// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motions on disk: vertex positions per frame, for a mesh that stays topologically the same.
#pragma once

#include <memory>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>
#include <vector>

namespace morula {

/// Of files that hold an animation rather than frames.
struct MotionOptions {
  double frames_per_second = 30;  ///< frame i is at i / frames_per_second seconds; the last one is not after the end
  std::size_t animation = 0;      ///< which one, where a file has several
};

namespace detail {
class FrameSource;
}

/// Frames are read one at a time; a motion of any length fits in memory.
class Motion {
 public:
  /// path: a folder of meshes or a glob such as "out/frame*.obj" (frames in name order, digits compared as numbers),
  /// one mesh file (a single frame; of glTF its animation, posed by nodes, skins and morph targets), or a NumPy .npy
  /// array of float32 or float64, shape (frames, vertices, 3), C order, or a .npz with such an array, which is its only
  /// one or has the name `positions`. Throws FileError when nothing matches, a numbered frame is missing in between
  /// (files.hpp), or the array has another shape or type, or an option is out of range for the animation.
  Motion(const std::filesystem::path& path, const MeshView& mesh, const MotionOptions& options = {});

  std::size_t frame_count() const { return frame_count_; }
  /// Positions of one frame. Throws FileError naming the file when its vertex count or facets differ from the mesh's,
  /// or a coordinate is not finite.
  std::vector<Vec3> frame(std::size_t i) const;
  /// What to call the frame in messages: a file name, or "motion.npy frame 3".
  std::string frame_name(std::size_t i) const;

 private:
  // Throws FileError unless they are those of the mesh.
  void require_frames_of(const std::filesystem::path& file, std::size_t vertex_count,
                         std::span<const Facet> facets) const;

  std::vector<std::filesystem::path> files_;           // one per frame, or the one that holds all
  std::shared_ptr<const detail::FrameSource> source_;  // of a file that holds an animation or an array
  std::size_t frame_count_ = 0;
  std::size_t vertex_count_ = 0;
  std::vector<Facet> facets_;
};

/// Writes frames as they come: into a folder (0000.obj, 0001.obj, …) or, when the path ends in .npy, one float64 array.
/// Keeps one frame in memory.
class MotionWriter {
 public:
  /// path: a folder (made if missing; other files in it stay) or a .npy file. extension: of the meshes in a folder:
  /// ".obj", ".off" or ".ply". Throws FileError when the disk plainly has no room for so many frames.
  MotionWriter(const std::filesystem::path& path, const MeshView& mesh, std::size_t frame_count,
               const std::string& extension = ".obj");
  void write(std::span<const Vec3> positions);
  /// After the last frame; the folder or the .npy appears whole now, in the place of an older one. Throws FileError if
  /// frames are missing.
  void finish();

 private:
  std::filesystem::path path_;
  std::string extension_;
  Mesh mesh_;
  std::size_t frame_count_;
  std::size_t written_ = 0;
  std::optional<WholeFile> npy_;  // this, or the folder
  std::optional<WholeFolder> folder_;
  std::string chunk_;
};

}  // namespace morula
