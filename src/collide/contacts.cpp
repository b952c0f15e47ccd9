// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/collide/contacts.hpp>
#include <stdexcept>
#include <string>

#include "collide/contact_geometry.hpp"
#include "collide/front_walk.hpp"
#include "collide/require.hpp"

namespace morula {
namespace {

// Without a budget there is no queue to keep: depth-first, and nothing to remember.
class Descent {
 public:
  Descent(const TreePair& trees, std::vector<Contact>& contacts) : trees_(trees), contacts_(contacts) {}

  void run() {
    std::uint64_t mask;
    trees_.test({0, 1}, {0, 1}, &mask);
    ++pair_tests_;
    if (mask != 0) enter(0, 0, 0);
  }
  std::size_t pair_tests() const { return pair_tests_; }

 private:
  void enter(std::uint32_t a, std::uint32_t b, std::uint32_t depth) {
    if (trees_.is_final(a, b, depth)) {
      Contact& contact = contacts_.emplace_back();
      describe(trees_.placed(), trees_.sphere_a(a), trees_.sphere_b(b), contact);
      contact.node_a = a;
      contact.node_b = b;
      contact.finished = true;
      return;
    }
    const NodeRange below_a = trees_.below_a(a, depth), below_b = trees_.below_b(b, depth);
    std::uint64_t masks[max_branching];
    trees_.test(below_a, below_b, masks);
    pair_tests_ += std::size_t{below_a.count} * below_b.count;
    any_overlapping(below_a, below_b, masks, [&](std::uint32_t child_a, std::uint32_t child_b) {
      enter(child_a, child_b, depth + 1);
      return false;
    });
  }

  const TreePair& trees_;
  std::vector<Contact>& contacts_;
  std::size_t pair_tests_ = 0;
};

}  // namespace

struct ContactScratch::State {
  FrontWalk walk;
  SurfaceScratch surface;
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
  require_usable(options);
  require_current(a, "the first body");
  require_current(b, "the second body");
  if (options.facets) {
    require_positions(a, "the first body");
    require_positions(b, "the second body");
  }
  if (!has_level(a, b, options.level))
    throw std::invalid_argument("contacts are asked for at level " + std::to_string(*options.level) +
                                ", which neither tree has");

  ContactScratch::State& scratch = reused.scratch.state();
  if (!options.budget.is_unlimited() || options.reach) {
    scratch.walk.pairs.assign(1, {&a, &b, 1.0});
    scratch.walk.start(options, false, serial_workers(), reused);
    return;
  }

  const TreePair trees(a, b, options.margin, options.level.value_or(leaf_level));
  reused.contacts.clear();
  Descent descent(trees, reused.contacts);
  descent.run();
  reused.finished_count = reused.contacts.size();
  reused.finished = true;
  reused.pair_tests = descent.pair_tests();
  reused.achieved_level.assign(1, trees.depth());
  reused.facets.clear();
  if (!options.facets) return;
  for (const Contact& c : reused.contacts)
    reused.facets.push_back(
        {nearest_facet(a, c.node_a, c.point, scratch.surface), nearest_facet(b, c.node_b, c.point, scratch.surface)});
}

Contacts collide(const Collider& a, const Collider& b, const CollideOptions& options) {
  Contacts contacts;
  collide(a, b, options, contacts);
  return contacts;
}

}  // namespace morula
