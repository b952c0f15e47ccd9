// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A glTF 2.0 file, checked and decoded: plain numbers, with every index in range. Data other than shape and motion
// (materials, textures, cameras, lights) are left out.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <morula/geometry/mesh.hpp>
#include <morula/update/skin.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace morula::gltf {

inline constexpr std::uint32_t none = 0xffffffff;

/// Vertices of one primitive or of several that share them.
struct VertexSet {
  std::vector<Vec3> positions;
  std::vector<std::vector<Vec3>> targets;  ///< displacements, per morph target
  std::vector<std::uint32_t> begin;        ///< vertex i has the influences [begin[i], begin[i + 1]); empty: no weights
  std::vector<std::uint32_t> joints;       ///< joints of a skin
  std::vector<double> weights;             ///< weights above 0; the weights of a vertex add up to 1
};
struct Primitive {
  std::size_t index;          ///< its index in the file's mesh, which also counts points and lines
  std::size_t vertices;       ///< index of its VertexSet in the mesh
  std::vector<Facet> facets;  ///< facets of these vertices
};
struct MeshData {
  std::vector<VertexSet> vertices;
  std::vector<Primitive> primitives;
  std::vector<double> weights;  ///< weights of morph targets, the largest number that one of its vertex sets has
};
struct SkinData {
  std::vector<std::uint32_t> joints;          ///< node of each joint
  std::vector<AffineTransform> inverse_bind;  ///< one per joint
};
struct Pose {
  Vec3 translation{};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< x, y, z, w
  Vec3 scale{1, 1, 1};
};
struct Node {
  std::uint32_t parent = none, mesh = none, skin = none;
  bool has_matrix = false;  ///< true if the node has a matrix; then no channel animates it
  AffineTransform matrix{};
  Pose pose{};
  std::vector<double> weights{};  ///< weights of morph targets; empty: the weights of its mesh
  std::string name{};             ///< may be empty
};
struct Channel {
  enum class Path { translation, rotation, scale, weights };
  enum class Interpolation { step, linear, cubic };
  std::uint32_t node;
  Path path;
  Interpolation interpolation;
  std::vector<double> times;   ///< times, none below the one before; of equal ones, the last key holds from then on
  std::vector<double> values;  ///< `width` numbers per time; cubic: three times as many, tangents before and after
  std::size_t width;
};
struct Document {
  std::string name;  ///< name of the file, for messages
  std::vector<MeshData> meshes;
  std::vector<SkinData> skins;
  std::vector<Node> nodes;
  std::vector<std::uint32_t> parents_first;  ///< all nodes, each after its parent
  std::vector<std::uint32_t> drawn;          ///< nodes of the scene with a mesh, in the scene's order
  std::vector<std::vector<Channel>> animations;
  std::vector<std::string> notes;  ///< parts of the file that the document does not have, or has otherwise
  std::size_t bytes = 0;           ///< number of bytes of the text and of all buffers

  [[noreturn]] void fail(const std::string& problem) const;
};

/// bytes: of a .gltf or a .glb, distinguished by their first bytes. Buffers are read from data URIs, the .glb's own
/// chunk and files in the folder of `path` or below it, by relative names without "..". Throws FileError.
Document read_document(const std::filesystem::path& path, std::string_view bytes);

}  // namespace morula::gltf
