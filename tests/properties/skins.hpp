// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skins and transforms of bones, plausible and not.
#pragma once

#include <dice.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/update/skin.hpp>
#include <vector>

namespace morula::properties {

using oracle::Dice;

/// Weights that vary with position or at random; zero, negative, of one bone alone, not quite adding up to 1.
Skin random_skin(const Mesh& mesh, Dice& dice);

/// One transform per bone: rotations, mirrored, singular, zero, stretched, far away, small, equal ones, the identity.
std::vector<AffineTransform> random_transforms(const Mesh& mesh, std::size_t bones, Dice& dice);

/// At least the largest |component| of any used vertex moved by any of the transforms alone, term by term.
double largest_term(const Mesh& mesh, const std::vector<AffineTransform>& transforms);

}  // namespace morula::properties
