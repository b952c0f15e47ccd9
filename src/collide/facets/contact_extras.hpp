// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Extras of contacts, added when asked for: surfaces, facet pairs, containment.
#pragma once

#include <morula/collide/contacts.hpp>
#include <optional>

#include "collide/facets/contact_surface.hpp"
#include "collide/pairs/meter.hpp"

namespace morula::detail {

struct ColliderPair {
  const Collider *a, *b;
  double weight;
};

/// Memory for them. Tests of inside are made when first asked for, and kept for the same pairs.
class ContactExtras {
 public:
  /// Other colliders come, or an exception: what was made before is of no use.
  void forget() noexcept {
    inside_.clear();
    surfaces_.clear();
    nodes_.clear();
  }
  /// Fills what the options ask for, and clears what they do not. The pairs have current positions then. What is asked
  /// for and not all there leaves the result unfinished. Surfaces that are there are those of the first contacts: the
  /// search goes on behind them.
  /// meter: ends surfaces when its time is over; none: no budget.
  void add(std::span<const ColliderPair> pairs, const CollideOptions& options, Meter* meter, Contacts& result);
  /// The surface of one contact, finished or not.
  ContactSurface surface_of(std::span<const ColliderPair> pairs, const Contact& contact);

 private:
  struct Inside {
    std::optional<InsideQuery> a, b;  // none: an open surface
    std::vector<std::uint32_t> components_a, components_b;
  };
  void add_surfaces(std::span<const ColliderPair> pairs, const CollideOptions& options, Meter* meter, Contacts& result);
  void add_crossings(std::span<const ColliderPair> pairs, Contacts& result);
  void add_containment(std::span<const ColliderPair> pairs, Contacts& result);

  std::vector<SurfaceScratch> surfaces_;  // one per pair
  std::vector<NodePair> nodes_;
  CrossingQuery crossings_;
  std::vector<Inside> inside_;
};

}  // namespace morula::detail
