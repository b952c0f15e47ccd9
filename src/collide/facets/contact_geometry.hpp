// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The contact of a pair of spheres.
#pragma once

#include <morula/collide/contacts.hpp>

#include "collide/pairs/tree_pair.hpp"

namespace morula::detail {

/// Writes all fields except Contact::pair and `finished`. [hubbard1996; dingliana2000]
void describe(const TreePair& trees, std::uint32_t node_a, std::uint32_t node_b, Contact& contact);

/// (r_a + r_b + margin - distance) over r_a + r_b + margin: above 0 where spheres overlap, 1 where centers coincide.
float overlap_share(const PlacedPair& placed, const Spheref& a, const Spheref& b);

}  // namespace morula::detail
