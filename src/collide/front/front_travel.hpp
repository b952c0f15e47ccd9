// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Travel of a front: how far the spheres of two bodies have come since its pairs were tested.
#pragma once

#include <morula/collide/front.hpp>
#include <vector>

#include "collide/pairs/placed_pair.hpp"

namespace morula::detail {

/// Stamps of the present frame; with_spheres: also what follow_travel() compares the next one with.
void begin_travel(Front::Pair& bodies, const Collider& a, const Collider& b, const PlacedPair& placed,
                  bool with_spheres);

/// Adds to `path_length` what the bodies have moved since, against each other, and takes over the present frame. Nodes
/// that kept every bit, in a frame that did, travel nothing. Travel is measured in a's coordinates without its
/// transform, so bodies that are placed elsewhere together have not moved. Cost: linear in nodes.
void follow_travel(Front::Pair& bodies, const Collider& a, const Collider& b, const PlacedPair& placed,
                   std::vector<double>& scratch);

}  // namespace morula::detail
