// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/collide/contact_query.hpp>
#include <stdexcept>

#include "collide/pairs/tree_pair.hpp"
#include "collide/require.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

bool any_leaves(const TreePair& trees, std::uint32_t a, std::uint32_t b, std::uint32_t depth) {
  if (trees.is_final(a, b, depth)) return true;
  const NodeRange below_a = trees.below_a(a, depth), below_b = trees.below_b(b, depth);
  std::uint64_t masks[max_branching];
  trees.test(below_a, below_b, masks);
  return any_overlapping(below_a, below_b, masks, [&](std::uint32_t child_a, std::uint32_t child_b) {
    return any_leaves(trees, child_a, child_b, depth + 1);
  });
}

}  // namespace

Contacts collide(const Collider& a, const Collider& b, const CollideOptions& options) {
  const StandardFloats standard;
  ContactQuery query(options);
  query.add(a, b);
  if (const ContactStatus status = query.run(); !status) {
    Status of_two = status;  // there is only one pair
    of_two.pair.reset();
    throw std::invalid_argument(message(of_two));
  }
  return query.take_contacts();
}

bool overlap(const Collider& a, const Collider& b) {
  const StandardFloats standard;
  require_bodies(a, b, {});
  const TreePair trees(a, b, 0, leaf_level);
  return trees.overlaps(0, 0) && any_leaves(trees, 0, 0, 0);
}

}  // namespace morula
