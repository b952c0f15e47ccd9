// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The place of a proxy whose device point starts on the surface.
#pragma once

#include <morula/collide/primitives.hpp>
#include <optional>
#include <span>

#include "surface/haptic/proxy_contacts.hpp"

namespace morula::detail {

/// A place near the center, which is on the surface or hardly off it: at `rest` from all facets, or as far as one of
/// the tried places is. The segment to it meets no facet, except where it begins; a center on a facet prefers the outer
/// side. No value without a place at more than 1/64 of the skin from all facets.
///
/// contacts: those of the center. Cost: a ball query for each of at most about 300 places.
std::optional<Vec3> place_beside(const Collider& body, TouchQuery& touch, std::span<const ProxyContact> contacts,
                                 const Vec3& center, const KeptDistances& kept);

}  // namespace morula::detail
