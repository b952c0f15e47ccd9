// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The contact that a pair of spheres stands for.
#pragma once

#include <morula/collide/contacts.hpp>

#include "collide/pairs/placed_pair.hpp"

namespace morula::detail {

/// Writes all but Contact::bodies, the nodes and `finished`. [hubbard1996; dingliana2000]
void describe(const PlacedPair& placed, const Spheref& a, const Spheref& b, Contact& contact);

/// (r_a + r_b + margin - distance) over r_a + r_b + margin: above 0 where spheres overlap, 1 where centers coincide.
float overlap_share(const PlacedPair& placed, const Spheref& a, const Spheref& b);

}  // namespace morula::detail
