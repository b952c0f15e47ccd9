// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "collide/front/front_walk.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {

void ContactExtras::add(std::span<const ColliderPair> pairs, const CollideOptions& options, Meter* meter,
                        Contacts& result) {
  if (!options.surfaces) result.surfaces.clear();
  result.crossings.clear();
  result.crossings_begin.clear();
  if (!options.containment) result.containment.clear();
  if (options.surfaces) {
    add_surfaces(pairs, options, meter, result);
    // mutant contact-surfaces-cut: `if (result.surfaces.size() < result.finished_count) result.finished = false` -> ``
    if (result.surfaces.size() < result.finished_count) result.finished = false;
  }
  if (options.find_crossings) add_crossings(pairs, result);
  if (options.containment) add_containment(pairs, result);
}

// Finished contacts are first in the list. Under a budget only they get surfaces: the node of an unfinished one may own
// any number of facets, and a query that is stopped early would cost more than a whole one. Each finished contact has
// cost a pair test, and its leaves are read once.
void ContactExtras::add_surfaces(std::span<const ColliderPair> pairs, const CollideOptions& options, Meter* meter,
                                 Contacts& result) {
  if (result.contacts.empty()) return;
  if (meter != nullptr) meter->release_rest();
  // All surfaces are there, or there is no time for any.
  const bool limited = !options.budget.is_unlimited();
  const std::size_t count = limited ? result.finished_count : result.contacts.size(), before = result.surfaces.size();
  if (before >= count || (meter != nullptr && meter->by_time() && !meter->has_any_time())) return;
  if (surfaces_.size() < pairs.size()) surfaces_.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) surfaces_[i].start(*pairs[i].a, *pairs[i].b);
  for (std::size_t i = before; i < count; ++i) {
    check_interrupt();
    // The first surface is computed at any cost, so that repeated resume() calls always finish.
    if (i > before && meter != nullptr && meter->by_time() && meter->out_of_time()) return;
    const Contact& c = result.contacts[i];
    const ColliderPair& pair = pairs[c.pair];
    result.surfaces.push_back(
        contact_surface(*pair.a, c.node_a, *pair.b, c.node_b, c.point, c.normal, c.depth, surfaces_[c.pair]));
  }
}

ContactSurface ContactExtras::surface_of(std::span<const ColliderPair> pairs, const Contact& c) {
  if (surfaces_.size() < pairs.size()) surfaces_.resize(pairs.size());
  const ColliderPair& pair = pairs[c.pair];
  surfaces_[c.pair].start(*pair.a, *pair.b);
  return contact_surface(*pair.a, c.node_a, *pair.b, c.node_b, c.point, c.normal, c.depth, surfaces_[c.pair]);
}

void ContactExtras::add_crossings(std::span<const ColliderPair> pairs, Contacts& result) {
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    result.crossings_begin.push_back(result.crossings.size());
    nodes_.clear();
    for (std::size_t k = 0; k < result.finished_count; ++k)
      if (const Contact& c = result.contacts[k]; c.pair == i) nodes_.push_back({c.node_a, c.node_b});
    if (nodes_.empty()) continue;
    // The calling query has checked both bodies.
    static_cast<void>(crossings_.run(*pairs[i].a, *pairs[i].b, nodes_));
    const auto found = crossings_.pairs();
    result.crossings.insert(result.crossings.end(), found.begin(), found.end());
  }
  result.crossings_begin.push_back(result.crossings.size());
}

void ContactExtras::add_containment(std::span<const ColliderPair> pairs, Contacts& result) {
  const auto test_of = [](const Collider& body) -> std::optional<InsideQuery> {
    try {
      return InsideQuery(body);
    } catch (const std::invalid_argument&) {
      return std::nullopt;  // an open surface has no inside
    }
  };
  if (inside_.size() != pairs.size()) {
    inside_.clear();
    for (const ColliderPair& pair : pairs)
      inside_.push_back({test_of(*pair.a), test_of(*pair.b), component_vertices(pair.a->surface()),
                         component_vertices(pair.b->surface())});
  }
  result.containment.resize(pairs.size());
  const auto test = [](std::optional<InsideQuery>& outer, const Collider& inner,
                       std::span<const std::uint32_t> components, Containment& found) {
    if (outer) {
      outer->components_inside(inner, components, found);
      return;
    }
    found.status = {};
    found.inside.assign(components.size(), 0);
    found.inside_count = 0;
    found.certified = true;
  };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    test(inside_[i].b, *pairs[i].a, inside_[i].components_a, result.containment[i].a_in_b);
    test(inside_[i].a, *pairs[i].b, inside_[i].components_b, result.containment[i].b_in_a);
  }
}

}  // namespace morula::detail
