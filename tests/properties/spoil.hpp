// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Faults that a mesh can have and still be a mesh.
#pragma once

#include <dice.hpp>
#include <morula/geometry/mesh.hpp>
#include <string_view>

namespace morula::properties {

/// Changes the mesh for the worse in some way, and says in which.
std::string_view spoil(Mesh& mesh, oracle::Dice& dice, std::size_t most_facets);

}  // namespace morula::properties
