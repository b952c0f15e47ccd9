// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Animation of a glTF document: its nodes at a time, and its vertices with them.
#pragma once

#include <span>

#include "io/gltf/document.hpp"

namespace morula::gltf {

/// Nodes at one moment.
struct Moment {
  std::vector<AffineTransform> of_node;      ///< from a node's space to the scene's
  std::vector<std::vector<double>> weights;  ///< of a node's morph targets
};
/// As the nodes stand in the file.
Moment at_rest(const Document& document);
/// channels: an animation's. Before its first and after its last time a channel stands still. Same bits on every
/// machine. What overflows becomes infinite or no number.
Moment at_time(const Document& document, std::span<const Channel> channels, double seconds);
/// The largest time of a key; 0 without channels.
double duration(std::span<const Channel> channels);

/// All meshes of the scene in one: for each node that is drawn, in order, the vertex sets of its mesh.
struct Joined {
  std::size_t vertex_count = 0;
  std::vector<Facet> facets;
};
/// Throws FileError when there are more vertices than indices.
Joined joined(const Document& document);
/// Where they are in the scene: displaced by morph targets, then moved by skin or node.
std::vector<Vec3> posed(const Document& document, const Moment& moment);
/// As they are bound: displaced by the morph targets of the moment, then moved by their node, unless a skin moves them.
std::vector<Vec3> bound(const Document& document, const Moment& moment);

/// How all of them follow bones: the joints of each node with a skin, and each node without. Bones are in the order of
/// nodes drawn.
Skin joined_skin(const Document& document);
/// Transforms of these bones relative to bound(document, at_rest(document)). Throws FileError for a node that is drawn
/// without a skin and flattens its mesh at rest.
std::vector<AffineTransform> bone_transforms(const Document& document, const Moment& rest, const Moment& moment);

}  // namespace morula::gltf
