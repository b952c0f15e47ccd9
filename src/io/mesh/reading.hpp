// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The state of a mesh file that is read: its polygons, and the notes on it.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/io/mesh_file.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/polygon.hpp"

namespace morula::detail {

/// The input of a reader besides the bytes, and its notes on them.
struct MeshReading {
  /// Facets that polygons become if their corners agree, whatever their shape: the facets of the mesh at rest, for a
  /// frame of its motion, whose polygons may have become concave.
  std::span<const Facet> cut_like = {};
  /// If the mesh at rest was welded: the number that each vertex of the file has in `cut_like`; empty: its own.
  std::span<const std::uint32_t> cut_like_vertex = {};
  MeshInfo info = {};
  /// Whether the reader sets `labels`: a number per vertex, for weld_vertices(). They stay empty in formats whose
  /// vertices have no more than a position.
  bool wants_labels = false;
  std::vector<std::uint32_t> labels = {};
};

/// "1 face" or "3 faces".
std::string counted(std::size_t count, std::string_view one);

/// Things of one kind that were left out: their number, and the place of the first.
struct LeftOut {
  std::size_t count = 0, line = 0;
  std::string first{};  ///< name of the first of them
  void add(std::size_t at, std::string_view name);
};

/// Cuts the polygons of one file and counts them.
class PolygonReader {
 public:
  struct Place {
    std::size_t face;  ///< number of the face, from 0
    std::size_t line;  ///< line of the face; 0: unknown
  };

  explicit PolygonReader(MeshReading& reading) : reading_(reading) {}
  /// Cuts a polygon of four corners or more, which are indices of points: replaces its corners.size() - 2 facets from
  /// `first` on. facets: the facets of the whole mesh.
  void cut(std::span<const Vec3> points, std::span<const std::uint32_t> corners, std::span<Facet> facets,
           std::size_t first, Place place);
  /// Adds the notes; `kind` is "face" or "cell".
  void finish(std::string_view kind);

 private:
  bool cut_as_given(std::span<const std::uint32_t> corners, std::span<Facet> own, std::size_t first);

  MeshReading& reading_;
  PolygonCutter cutter_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides_;
  std::vector<std::uint32_t> in_rest_;  // the corners of a polygon as vertices of the mesh at rest
  Place first_crossing_{}, first_bent_{};
};

/// Faces of a file that come corner by corner, their vertices before or after them.
class FaceReader {
 public:
  FaceReader(Mesh& mesh, MeshReading& reading) : mesh_(mesh), polygons_(reading) {}

  void begin() { corners_.clear(); }
  void add(std::uint32_t vertex) { corners_.push_back(vertex); }
  std::size_t corners() const { return corners_.size(); }
  /// Ends the face that begin() began; it has three corners or more. line: 0 for files without lines.
  void end(std::size_t line);
  /// Cuts the waiting polygons. All vertices have been read, and all corners are among them.
  void finish();

 private:
  // Facets about the first corner hold all corners, so that a polygon that waits for its vertices needs no more.
  struct Waiting {
    std::size_t first, corners;
    PolygonReader::Place place;
  };

  Mesh& mesh_;
  PolygonReader polygons_;
  std::vector<std::uint32_t> corners_;
  std::vector<Waiting> waiting_;
  std::size_t faces_ = 0;
};

/// The corners of a polygon that is stored as facets about its first corner.
void corners_of_fan(std::span<const Facet> fan, std::vector<std::uint32_t>& corners);

}  // namespace morula::detail
