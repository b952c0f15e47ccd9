// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files around bounds of skinned meshes: clusters of facets, the bones and primitives of a glTF file as an engine knows
// them, and a field of extras in such a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <morula/io/files.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// Reads the cluster number of each facet. path: a .npy of integers of 32 or 64 bits, shape (facets,), or a text of
/// integers from 0 on, separated by blanks or line breaks. Throws FileError for another count, or for a number that is
/// negative, or not below the number of facets.
std::vector<std::uint32_t> read_clusters(const std::filesystem::path& path, std::size_t facet_count);

/// A bone of read_skin() on a glTF file.
struct GltfBone {
  std::uint32_t node;  ///< index of the node that moves it
  std::string name{};  ///< name of this node; may be empty
  /// Index of the skin, and of the joint in it; none: the node has a mesh and no skin, and moves the mesh alone.
  std::optional<std::uint32_t> skin{}, joint{};
  std::optional<std::uint32_t> mesh_node{};  ///< index of the node that has mesh and skin; none without a skin
};
/// A primitive of triangles as a node shows it.
struct GltfPrimitive {
  std::uint32_t node, mesh, primitive;  ///< indices of the node, of its mesh, and of the primitive in the mesh
  std::size_t facet_count;
};
/// A morph target of a node with a mesh.
struct GltfTarget {
  std::uint32_t node, mesh, target;  ///< indices of the node, of its mesh, and of the target in the mesh
  double rest_weight;  ///< its weight in the mesh as read; the number of the target is its weight less this
};
struct GltfParts {
  std::vector<GltfBone> bones;            ///< in the order of read_skin()
  std::vector<GltfPrimitive> primitives;  ///< facets of read_mesh() are those of these primitives, in order
  std::vector<GltfTarget> targets;        ///< in the order of read_modes()
};
/// Reads the parts of a .gltf or .glb. Throws FileError.
GltfParts read_gltf_parts(const std::filesystem::path& path);

/// Writes a copy of a .gltf or .glb whose top-level `extras` hold a member of this name: it replaces an older one, or
/// comes after the other members. All other bytes of the JSON, and all chunks of a .glb, stay as they are. The write is
/// atomic.
///
/// to: has the extension of `from`; in the same folder if the file refers to other files. name: has no characters
/// that JSON escapes. json: a JSON value. Throws FileError if `from` is not glTF, has `extras` that are no object, or
/// if `to` cannot be written; std::invalid_argument for another name or value.
void write_gltf_extra(const std::filesystem::path& from, const std::filesystem::path& to, std::string_view name,
                      std::string_view json);

}  // namespace morula
