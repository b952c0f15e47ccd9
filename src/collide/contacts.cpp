// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/collide/contacts.hpp>
#include <stdexcept>
#include <string>

#include "collide/facets/contact_geometry.hpp"
#include "collide/front/front_walk.hpp"
#include "collide/pairs/descent.hpp"
#include "collide/require.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
struct ContactScratch::State {
  FrontWalk walk;
};

ContactScratch::ContactScratch() = default;
ContactScratch::ContactScratch(const ContactScratch&) {}
ContactScratch::ContactScratch(ContactScratch&&) noexcept = default;
ContactScratch& ContactScratch::operator=(const ContactScratch&) {
  return *this;
}
ContactScratch& ContactScratch::operator=(ContactScratch&&) noexcept = default;
ContactScratch::~ContactScratch() = default;

ContactScratch::State& ContactScratch::state() {
  if (!state_) state_ = std::make_unique<State>();
  return *state_;
}

void collide(const Collider& a, const Collider& b, const CollideOptions& options, Contacts& reused) {
  const StandardFloats standard;
  require_usable(options);
  const bool looks_at_facets = options.surfaces || options.exact || options.containment;
  require_bodies(a, b, {.all_spheres = !options.reach, .positions = looks_at_facets});
  if (!has_level(a, b, options.level))
    throw std::invalid_argument("contacts are asked for at level " + std::to_string(*options.level) +
                                ", which neither tree has");

  FrontWalk& walk = reused.scratch.state().walk;
  walk.pairs.assign(1, {&a, &b, 1.0});
  walk.extras.forget();
  if (!options.budget.is_unlimited() || options.reach) {
    walk.start(options, false, serial_workers(), reused);
    return;
  }

  const TreePair trees(a, b, options.margin, options.level.value_or(leaf_level));
  reused.contacts.clear();
  reused.pair_tests = each_overlapping(trees, [&](std::uint32_t node_a, std::uint32_t node_b) {
    Contact& contact = reused.contacts.emplace_back();
    describe(trees.placed(), trees.sphere_a(node_a), trees.sphere_b(node_b), contact);
    contact.node_a = node_a;
    contact.node_b = node_b;
    contact.finished = true;
  });
  reused.finished_count = reused.contacts.size();
  reused.finished = true;
  reused.achieved_level.assign(1, trees.depth());
  walk.extras.add(walk.pairs, options, nullptr, reused);
}

Contacts collide(const Collider& a, const Collider& b, const CollideOptions& options) {
  const StandardFloats standard;
  Contacts contacts;
  collide(a, b, options, contacts);
  return contacts;
}

}  // namespace morula
