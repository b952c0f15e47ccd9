// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Animation of a glTF document: its nodes and vertices at a time.
#pragma once

#include <morula/update/modes.hpp>
#include <span>

#include "io/gltf/document.hpp"

namespace morula::gltf {

/// Nodes at one moment.
struct Moment {
  std::vector<AffineTransform> of_node;      ///< transforms from a node's space to the scene's, by node
  std::vector<std::vector<double>> weights;  ///< weights of a node's morph targets, by node
};
/// The nodes as stored in the file.
Moment at_rest(const Document& document);
/// The nodes at a time. channels: the channels of an animation. A channel is constant before its first and after its
/// last time. The result has the same bits on every machine. Values that overflow become infinite or NaN.
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
/// Their positions in the scene: displaced by morph targets, then moved by skin or node.
std::vector<Vec3> posed(const Document& document, const Moment& moment);
/// Their bound positions: displaced by the morph targets of the moment, then moved by their node, unless a skin moves
/// them.
std::vector<Vec3> bound(const Document& document, const Moment& moment);

/// The morph targets as displacements of bound(document, at_rest(document)): one mode per target of each node drawn, in
/// order, which moves the vertices of that node. Throws FileError for more displacements than the file can mean.
Modes joined_targets(const Document& document);
/// The coordinates of these modes: weights less those at rest.
std::vector<double> target_coordinates(const Document& document, const Moment& rest, const Moment& moment);

/// A number per vertex, of vertices that move alike from one rest position: the same node, the same joints and weights
/// in order, the same displacement in every morph target.
std::vector<std::uint32_t> vertex_labels(const Document& document);

/// The skin of all vertices. Its bones are the joints of each node with a skin, and each node without one, in the order
/// of the nodes drawn.
Skin joined_skin(const Document& document);
/// Transforms of these bones relative to bound(document, at_rest(document)). Throws FileError for a drawn node without
/// a skin that flattens its mesh at rest.
std::vector<AffineTransform> bone_transforms(const Document& document, const Moment& rest, const Moment& moment);

}  // namespace morula::gltf
