// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/pair_search.hpp"

#include <algorithm>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

/// The number of node pairs that one thread makes before workers descend from each of them by itself.
constexpr std::size_t pairs_for_workers = 512;

BoxGroup alone(const BoxGroup& of, std::size_t place) {
  BoxGroup group;
  group.clear();
  for (std::size_t k = 0; k < 6; ++k) group.bound[k][0] = of.bound[k][place];
  return group;
}

/// A group that holds only the box of a whole group.
BoxGroup together(const BoxGroup& of) {
  BoxGroup group;
  group.clear();
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t place = 0; place < 8; ++place) {
      group.bound[k][0] = std::min(group.bound[k][0], of.bound[k][place]);
      group.bound[k + 3][0] = std::max(group.bound[k + 3][0], of.bound[k + 3][place]);
    }
  return group;
}

/// A group that holds only the box of a node; above the last level, the box of the whole surface.
BoxGroup box_of(const SurfaceBoxes& boxes, const BoxNode& node) {
  if (node.height == boxes.levels.size()) return together(boxes.levels.back()[0]);
  return alone(boxes.levels[node.height][node.number / 8], node.number % 8);
}

/// The lengths added to the bounds of a, so that boxes no farther apart than `reach` overlap. shift: from a's origin to
/// b's. extents: the sum of the extents of both surfaces' boxes.
///
/// Two points at most `reach` apart along an axis have coordinates about the two origins that are also at most that far
/// apart, once the shift is added, except for rounding: differences from the origins and the shift are off by 2^-53 of
/// themselves, and the length added to bounds by 2^-24 when it becomes a float. All of it is below 2^-22 of the largest
/// number that occurs. Bounds are rounded outwards; the sum of a bound and the added length, rounded to nearest, is on
/// the same side of any float as the sum itself.
BoxReach box_reach(double reach, const Vec3& shift, double extents) {
  if (!(reach > 0 || shift != Vec3{})) return {};
  // No two boxes are as far apart as that, and it stays finite in float: an empty box, which is infinite, meets nothing
  // only as long as the added length is finite.
  constexpr double farthest_apart = 0x1p110;
  // mutant surface-beyond-float: `min(reach, farthest_apart)` -> `max(reach, 0 * farthest_apart)`
  const double near = std::min(reach, farthest_apart);
  const double largest = extents + max_norm(shift) + near;
  // mutant surface-pad: `0x1p-22` -> `0`
  const double pad = near + 0x1p-22 * largest;
  BoxReach added{};
  for (int k = 0; k < 3; ++k) {
    added.up[k] = static_cast<float>(shift[k] + pad);
    added.down[k] = static_cast<float>(shift[k] - pad);
  }
  return added;
}

}  // namespace

SurfaceMeter::SurfaceMeter(const Budget& budget, const Clock& clock, std::size_t tests)
    : budget_(budget), clock_(&clock), tests_(tests) {
  if (budget_.is_time()) start_ = now(clock);
}

bool SurfaceMeter::try_spend(std::size_t groups) {
  check_interrupt();
  if (is_over_) return false;
  // The first unit of work is done at any cost, so that repeated resume() calls always finish.
  const bool is_first = calls_ == 0;
  if (budget_.is_tests())
    is_over_ = is_first ? budget_.tests() <= 0
                        : budget_.tests() < static_cast<std::int64_t>(tests_ * (groups_tested + groups));
  // Reading a clock takes about as long as a test.
  if (budget_.is_time() && calls_ % 8 == 0)
    is_over_ = is_first ? budget_.time().count() <= 0 : now(*clock_) - start_ >= budget_.time();
  ++calls_;
  if (!is_over_) groups_tested += groups;
  return !is_over_;
}

std::size_t PairSearch::cost(const BlockPair& pair) const {
  if (features_ == Features::facets) return 1;
  const FeatureBoxes& in_b = boxes_b();
  const std::size_t vertices =
      a_.boxes.vertex_groups(pair.a) + (is_with_itself() && pair.a == pair.b ? 0 : in_b.vertex_groups(pair.b));
  return vertices + std::size_t{a_.boxes.edge_groups(pair.a)} * in_b.edge_groups(pair.b);
}

void PairSearch::Side::start(const SurfaceTreeState& s) {
  surface = &s;
  kept = s.weak_from_this().lock();
  frame = s.frame;
}

void PairSearch::start(const SurfaceTreeState& a, const SurfaceTreeState& b, double reach, Features features,
                       bool by_spheres, Workers& workers) {
  a_.start(a);
  b_.start(b);
  features_ = features;
  // mutant height-field-reach: `&& !(reach > 0)` -> ``
  finds_crossings_ = features == Features::facets && !(reach > 0);
  boxes_.start(a, b, reach, by_spheres, workers);
  are_near_ = {meet_groups(), box_reach(reach, b.origin - a.origin, boxes_.a().extent + boxes_.b().extent)};
  a_.boxes.start(a, boxes_.a(), features);
  if (!is_with_itself())
    b_.boxes.start(b, boxes_.b(), features);
  else if (finds_crossings_)
    fields_.start(a, boxes_.a());
  open_.assign(1, {BoxNode::root(a), BoxNode::root(b)});
}

void PairSearch::expand(const NodePair& pair, std::vector<NodePair>& below) const {
  if (is_height_field(pair)) return;
  const BoxNode &a = pair.a, &b = pair.b;
  const std::size_t first = below.size();
  const auto push = [&](const NodePair& pair_below) {
    if (!is_excluded(pair_below)) below.push_back(pair_below);
  };
  // Bit 8 i + j: child i of a and child j of b, where a node that is not replaced counts as its own child 0.
  const auto push_near = [&](std::uint64_t bits, const auto& child_of_a, const auto& child_of_b) {
    for (; bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
      push({child_of_a(bit / 8), child_of_b(bit % 8)});
    }
  };
  const auto in_a = [&](std::uint32_t i) { return a.child(i); };
  const auto in_b = [&](std::uint32_t j) { return b.child(j); };
  if (is_node_with_itself(pair)) {
    // Each pair once; and every box with itself, however small it is.
    constexpr std::uint64_t above_diagonal = 0x0080c0e0f0f8fcfe;
    const std::uint32_t count = a.child_count(this->a());
    // mutant surface-last-box: `i <` -> `i + 1 <`
    for (std::uint32_t i = 0; i < count; ++i) push({a.child(i), a.child(i)});
    push_near(are_near_(a.boxes(boxes_.a()), b.boxes(boxes_.b())) & above_diagonal, in_a, in_b);
  } else if (a.height == b.height) {
    push_near(are_near_(a.boxes(boxes_.a()), b.boxes(boxes_.b())), in_a, in_b);
  } else if (a.height > b.height) {
    push_near(are_near_(a.boxes(boxes_.a()), box_of(boxes_.b(), b)), in_a, [&](std::uint32_t) { return b; });
  } else {
    push_near(
        are_near_(box_of(boxes_.a(), a), b.boxes(boxes_.b())), [&](std::uint32_t) { return a; }, in_b);
  }
  std::reverse(below.begin() + static_cast<std::ptrdiff_t>(first), below.end());
}

void PairSearch::find_block_pairs(SurfaceMeter& meter, Workers& workers) {
  // One thread descends breadth first as long as there are few pairs; then workers descend from each pair by itself, to
  // its end. The result is the same for any number of workers.
  std::vector<NodePair>&level = descent_.level, &below = descent_.below;
  std::vector<BlockDescent::Task>& tasks = descent_.tasks;
  std::vector<BlockPair>& pairs = descent_.pairs;
  pairs.clear();
  level.assign(open_.rbegin(), open_.rend());
  open_.clear();
  bool has_more = true;
  while (has_more && level.size() < pairs_for_workers) {
    has_more = false;
    below.clear();
    for (const NodePair& pair : level) {
      if (pair.is_pair_of_blocks()) {
        below.push_back(pair);
        continue;
      }
      expand(pair, below);
      ++meter.groups_tested;
      has_more = true;
    }
    level.swap(below);
  }
  // A few pairs share the memory of one task: many small allocations would be slow.
  constexpr std::size_t pairs_at_once = 16;
  const std::size_t task_count = (level.size() + pairs_at_once - 1) / pairs_at_once;
  if (tasks.size() < task_count) tasks.resize(task_count);
  parallel_for(workers, level.size(), pairs_at_once, [&](std::size_t begin, std::size_t end) {
    const StandardFloats standard;
    BlockDescent::Task& task = tasks[begin / pairs_at_once];
    task.pairs.clear();
    task.tests = 0;
    for (std::size_t i = begin; i < end; ++i) {
      task.stack.assign(1, level[i]);
      while (!task.stack.empty()) {
        const NodePair pair = task.stack.back();
        task.stack.pop_back();
        if (pair.is_pair_of_blocks()) {
          task.pairs.push_back({pair.a.number, pair.b.number});
        } else {
          expand(pair, task.stack);
          ++task.tests;
        }
      }
    }
  });
  for (std::size_t i = 0; i < task_count; ++i) {
    pairs.insert(pairs.end(), tasks[i].pairs.begin(), tasks[i].pairs.end());
    meter.groups_tested += tasks[i].tests;
  }
}

void PairSearch::open(std::vector<OpenFacets>& facets) const {
  facets.clear();
  for (const auto& [x, y] : open_)
    // mutant surface-open-level: `y.height` -> `x.height`
    // mutant surface-open-level-a: `x.height` -> `y.height`
    facets.push_back({facets_below(a(), x.number, x.height), facets_below(b(), y.number, y.height)});
}

}  // namespace morula::detail
