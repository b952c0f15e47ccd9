// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <morula/collide/pair_walk.hpp>
#include <stdexcept>
#include <string>

#include "collide/pairs/tree_pair.hpp"
#include "collide/require.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

struct Walk {
  const TreePair& trees;
  detail::PairVisitor visitor;
  void* visit;
  std::size_t tests = 1;

  // Returns false if the visitor has stopped the walk.
  bool enter(std::uint32_t a, std::uint32_t b, std::uint32_t depth) {
    const bool is_final = trees.is_final(a, b, depth);
    const Step step = visitor(visit, {a, b}, is_final);
    if (step == Step::stop) return false;
    if (is_final || step == Step::skip) return true;
    const NodeRange below_a = trees.below_a(a, depth), below_b = trees.below_b(b, depth);
    std::uint64_t masks[max_branching];
    trees.test(below_a, below_b, masks);
    tests += std::size_t{below_a.count} * below_b.count;
    return !any_overlapping(below_a, below_b, masks, [&](std::uint32_t child_a, std::uint32_t child_b) {
      return !enter(child_a, child_b, depth + 1);
    });
  }
};

}  // namespace

std::size_t detail::walk_pairs(const Collider& a, const Collider& b, const PairWalkOptions& options,
                               PairVisitor visitor, void* visit) {
  const StandardFloats standard;
  require_bodies(a, b, {});
  if (!(std::isfinite(options.margin) && options.margin >= 0))
    throw std::invalid_argument("margin is " + std::to_string(options.margin) + ": it must be finite and not negative");
  if (!has_level(a, b, options.level)) throw std::invalid_argument(message(Status{.code = Status::Code::bad_level}));
  const TreePair trees(a, b, options.margin, options.level.value_or(leaf_level));
  Walk walk{trees, visitor, visit};
  const PairAsRead read(a, b);
  // A visitor that ends the walk may move bodies before it returns: no other pair is read.
  // mutant walk-over-moved-bodies: `) && walk.enter(0, 0, 0)) require_good(read.status()` -> `)) walk.enter(0, 0, 0`
  if (trees.overlaps(0, 0) && walk.enter(0, 0, 0)) require_good(read.status());
  return walk.tests;
}

}  // namespace morula
