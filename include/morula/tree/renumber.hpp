// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Mesh vertices in the order in which an update reads them: what a leaf looks at then lies together in memory.
#pragma once

#include <morula/tree/cover.hpp>
#include <span>
#include <vector>

namespace morula {

/// Mesh vertices, those of the first leaf first: leaf_order(…)[i] is the old number of what becomes vertex i. Vertices
/// that no leaf has come last. For whoever can number the vertices of a simulation as they like; O(corners log
/// corners).
std::vector<std::uint32_t> leaf_order(const CoveredTree& model);

/// The same with vertices renumbered: old vertex order[i] is the new vertex i. Throws std::invalid_argument unless the
/// order names every vertex once. Facets, patches and spheres keep their numbers.
Mesh renumbered(const Mesh& mesh, std::span<const std::uint32_t> order);
/// mesh: as renumbered, for its hash, which the report carries.
CoveredTree renumbered(const CoveredTree& model, const Mesh& mesh, std::span<const std::uint32_t> order);

}  // namespace morula
