// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Families of meshes that have what random smooth bodies lack: alignment, ties, and facets of no area.
#pragma once

#include <dice.hpp>
#include <morula/geometry/mesh.hpp>
#include <span>
#include <string>
#include <string_view>

namespace morula::properties {

using oracle::Dice;

std::span<const std::string_view> families();

struct Shape {
  std::string name;  ///< family, size, and what was done to it
  Mesh mesh;
};

/// One of the families, with at most about so many facets, and up to three changes for the worse: facets subdivided,
/// doubled, of no area; vertices apart, collapsed, on a lattice; far away, tiny, huge, turned.
Shape random_shape(Dice& dice, std::size_t most_facets);

/// A member of one family as it is.
Mesh member(std::string_view family, Dice& dice, std::size_t most_facets);

/// Vertices that some facet uses: the others may hold anything.
std::vector<bool> used_vertices(const Mesh& mesh);

}  // namespace morula::properties
