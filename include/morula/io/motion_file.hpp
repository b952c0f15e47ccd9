// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motions on disk: vertex positions per frame, for a mesh with fixed topology.
#pragma once

#include <memory>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>
#include <vector>

namespace morula {

/// Options for files that contain an animation instead of frames.
struct MotionOptions {
  /// Sampling rate: frame i is at i / frames_per_second seconds; the last frame is not after the end.
  double frames_per_second = 30;
  std::size_t animation = 0;  ///< index of the animation, if the file has several
  /// The weld of a mesh that read_mesh() welded; the motion copies it. Its files have the vertices and facets of the
  /// unwelded mesh, and frame() returns positions of the welded one. A frame in which merged vertices are apart is
  /// rejected. Null: the files have the vertices of the mesh.
  const MeshWeld* weld = nullptr;
};

namespace detail {
class FrameSource;
}

/// A motion reads its frames one at a time, so a motion of any length fits in memory.
class Motion {
 public:
  /// path: a folder of meshes or a glob such as "out/frame*.obj" (frames in name order, digits compared as numbers);
  /// one mesh file (a single frame; for glTF its animation, posed by nodes, skins and morph targets); a NumPy .npy
  /// array of float32 or float64, shape (frames, vertices, 3), C order; or a .npz with such an array, which is the only
  /// one or is named `positions`. Throws FileError if no file matches, if a numbered frame is missing in between
  /// (files.hpp), if the array has another shape or type, or if an option is out of range for the animation;
  /// std::invalid_argument for a weld of another mesh.
  Motion(const std::filesystem::path& path, const MeshView& mesh, const MotionOptions& options = {});

  std::size_t frame_count() const { return frame_count_; }
  /// Positions of one frame. Throws FileError naming the file if its vertex count or facets differ from the mesh's, or
  /// if a coordinate is not finite.
  std::vector<Vec3> frame(std::size_t i) const;
  /// The name of the frame for messages: a file name, or "motion.npy frame 3".
  std::string frame_name(std::size_t i) const;

 private:
  std::vector<Vec3> unwelded_frame(std::size_t i) const;
  // Throws FileError unless count and facets are those of the mesh.
  void require_frames_of(const std::filesystem::path& file, std::size_t vertex_count,
                         std::span<const Facet> facets) const;

  std::vector<std::filesystem::path> files_;           // one per frame, or the one with all frames
  std::shared_ptr<const detail::FrameSource> source_;  // source of a file with an animation or an array
  std::size_t frame_count_ = 0;
  std::size_t vertex_count_ = 0;  // of the files
  std::vector<Facet> facets_;
  std::optional<MeshWeld> weld_;
};

/// Writes frames one at a time: into a folder (0000.obj, 0001.obj, …) or, if the path ends in .npy, into one float64
/// array. Keeps one frame in memory.
class MotionWriter {
 public:
  /// path: a folder (created if missing; other files in it stay) or a .npy file. extension: of the meshes in a folder:
  /// ".obj", ".off" or ".ply". Throws FileError if the disk clearly has no room for so many frames.
  MotionWriter(const std::filesystem::path& path, const MeshView& mesh, std::size_t frame_count,
               const std::string& extension = ".obj");
  void write(std::span<const Vec3> positions);
  /// Ends the motion after the last frame: the folder or the .npy appears at once and replaces an existing one. Throws
  /// FileError if frames are missing.
  void finish();

 private:
  std::filesystem::path path_;
  std::string extension_;
  Mesh mesh_;
  std::size_t frame_count_;
  std::size_t written_ = 0;
  std::optional<WholeFile> npy_;  // either this or the folder
  std::optional<WholeFolder> folder_;
  std::string chunk_;
};

}  // namespace morula
