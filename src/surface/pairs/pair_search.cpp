// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/pair_search.hpp"

#include <algorithm>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

/// So many entries are made by one thread before workers go on from each of them by itself.
constexpr std::size_t entries_for_workers = 512;

BoxGroup alone(const BoxGroup& of, std::size_t place) {
  BoxGroup group;
  group.clear();
  for (std::size_t k = 0; k < 6; ++k) group.bound[k][0] = of.bound[k][place];
  return group;
}

/// The box of a whole group, by itself.
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

/// Box i of a level, by itself; above the last level is the box of all.
BoxGroup box(const SurfaceBoxes& boxes, int level, std::uint32_t i) {
  if (static_cast<std::size_t>(level) == boxes.levels.size()) return together(boxes.levels.back()[0]);
  return alone(boxes.levels[static_cast<std::size_t>(level)][i / 8], i % 8);
}

std::uint32_t boxes_in(const SurfaceTreeState& s, int level, std::uint32_t group) {
  const std::size_t boxes = level == 0 ? s.block_count() : s.boxes.levels[static_cast<std::size_t>(level - 1)].size();
  return static_cast<std::uint32_t>(std::min<std::size_t>(8, boxes - 8 * std::size_t{group}));
}

}  // namespace

SurfaceMeter::SurfaceMeter(const Budget& budget, const Clock& clock, std::size_t tests)
    : budget_(budget), clock_(&clock), tests_(tests) {
  if (budget_.is_time()) start_ = now();
}

std::chrono::nanoseconds SurfaceMeter::now() const {
  return *clock_ ? (*clock_)() : std::chrono::steady_clock::now().time_since_epoch();
}

bool SurfaceMeter::takes(std::size_t groups) {
  ask_to_go_on();
  if (is_over_) return false;
  // The first piece of work is done whatever it costs, so that whoever resumes again and again comes to the end.
  const bool is_first = calls_ == 0;
  if (budget_.is_tests())
    is_over_ = is_first ? budget_.tests() <= 0
                        : budget_.tests() < static_cast<std::int64_t>(tests_ * (groups_tested + groups));
  // Reading a clock takes about as long as a test.
  if (budget_.is_time() && calls_ % 8 == 0)
    is_over_ = is_first ? budget_.time().count() <= 0 : now() - start_ >= budget_.time();
  ++calls_;
  if (!is_over_) groups_tested += groups;
  return !is_over_;
}

std::size_t PairSearch::cost(const BlockPair& pair) const {
  if (features_ == Features::facets) return 1;
  const FeatureBoxes& in_b = boxes_b();
  const std::size_t vertices =
      boxes_a_.vertex_groups(pair.a) + (b_ == nullptr && pair.a == pair.b ? 0 : in_b.vertex_groups(pair.b));
  return vertices + std::size_t{boxes_a_.edge_groups(pair.a)} * in_b.edge_groups(pair.b);
}

void PairSearch::start(const SurfaceTreeState& a, const SurfaceTreeState* b, double reach, Features features,
                       bool by_spheres, Workers& workers) {
  a_ = &a;
  b_ = b == &a ? nullptr : b;
  kept_a_ = a.weak_from_this().lock();
  kept_b_ = b_ != nullptr ? b_->weak_from_this().lock() : nullptr;
  frame_a_ = a.frame;
  frame_b_ = b_ != nullptr ? b_->frame : 0;
  features_ = features;
  meet_ = meet_groups();
  boxes_.start(a, b_, reach, by_spheres, workers);
  reach_ = {};
  const Vec3 shift = b_ != nullptr ? b_->origin - a_->origin : Vec3{};
  if (reach > 0 || shift != Vec3{}) {
    // Two points at most `reach` apart along an axis have coordinates about the two origins that are, once the shift is
    // added, but for rounding: differences from the origins and the shift are off by 2^-53 of themselves, and what is
    // added to bounds by 2^-24 when it becomes a float. All of it is below 2^-22 of the largest number that occurs.
    // Bounds are rounded outwards; the sum of a bound and what is added to it, rounded to nearest, is on the same side
    // of any float as the sum itself.
    // No two boxes are as far apart as that, and it stays finite in float: an empty box, which is infinite, meets
    // nothing only as long as what is added is finite.
    constexpr double farthest_apart = 0x1p110;
    // mutant surface-beyond-float: `min(reach, farthest_apart)` -> `max(reach, 0 * farthest_apart)`
    const double near = std::min(reach, farthest_apart);
    const double largest = boxes_.a().extent + boxes_.b().extent + max_norm(shift) + near;
    // mutant surface-pad: `0x1p-22` -> `0`
    const double pad = near + 0x1p-22 * largest;
    for (int k = 0; k < 3; ++k) {
      reach_.up[k] = static_cast<float>(shift[k] + pad);
      reach_.down[k] = static_cast<float>(shift[k] - pad);
    }
  }
  boxes_a_.start(a, boxes_.a(), features);
  if (b_ != nullptr) boxes_b_.start(*b_, boxes_.b(), features);
  if (b_ == nullptr && features == Features::facets) fields_.start(a, boxes_.a());
  const auto root = [](const SurfaceTreeState& s) { return static_cast<std::int16_t>(s.boxes.levels.size() - 1); };
  open_.assign(1, {0, 0, root(this->a()), root(this->b())});
}

void PairSearch::expand(const Entry& e, std::vector<Entry>& below) const {
  const SurfaceBoxes &a = boxes_.a(), &b = boxes_.b();
  if (is_height_field(e)) return;
  const std::size_t first = below.size();
  const auto push = [&](std::uint32_t i, int level_a, std::uint32_t j, int level_b) {
    below.push_back({i, j, static_cast<std::int16_t>(level_a), static_cast<std::int16_t>(level_b)});
  };
  if (e.level_a == e.level_b) {
    const auto level = static_cast<std::size_t>(e.level_a);
    const BoxGroup &group_a = a.levels[level][e.a], &group_b = b.levels[level][e.b];
    std::uint64_t bits = meet_(group_a, group_b, reach_);
    if (b_ == nullptr && e.a == e.b) {
      // Each pair once; and every box with itself, however small it is.
      constexpr std::uint64_t above_diagonal = 0x0080c0e0f0f8fcfe;
      bits &= above_diagonal;
      const std::uint32_t count = boxes_in(this->a(), e.level_a, e.a);
      // mutant surface-last-box: `i <` -> `i + 1 <`
      for (std::uint32_t i = 0; i < count; ++i) push(8 * e.a + i, e.level_a - 1, 8 * e.a + i, e.level_a - 1);
    }
    for (; bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
      push(8 * e.a + bit / 8, e.level_a - 1, 8 * e.b + bit % 8, e.level_b - 1);
    }
  } else if (e.level_a > e.level_b) {
    const BoxGroup single = box(b, e.level_b + 1, e.b);
    for (std::uint64_t bits = meet_(a.levels[static_cast<std::size_t>(e.level_a)][e.a], single, reach_); bits != 0;
         bits &= bits - 1)
      push(8 * e.a + static_cast<std::uint32_t>(std::countr_zero(bits)) / 8, e.level_a - 1, e.b, e.level_b);
  } else {
    const BoxGroup single = box(a, e.level_a + 1, e.a);
    for (std::uint64_t bits = meet_(single, b.levels[static_cast<std::size_t>(e.level_b)][e.b], reach_); bits != 0;
         bits &= bits - 1)
      push(e.a, e.level_a, 8 * e.b + static_cast<std::uint32_t>(std::countr_zero(bits)) % 8, e.level_b - 1);
  }
  std::reverse(below.begin() + static_cast<std::ptrdiff_t>(first), below.end());
}

void PairSearch::find_block_pairs(SurfaceMeter& meter, Workers& workers) {
  // Breadth first, by one thread, as long as there are few; then each entry by itself, to its end. What comes out is
  // the same for any number of workers.
  pairs_.clear();
  entries_.assign(open_.rbegin(), open_.rend());
  open_.clear();
  bool has_more = true;
  while (has_more && entries_.size() < entries_for_workers) {
    has_more = false;
    below_.clear();
    for (const Entry& entry : entries_) {
      if (entry.is_pair_of_blocks()) {
        below_.push_back(entry);
        continue;
      }
      expand(entry, below_);
      ++meter.groups_tested;
      has_more = true;
    }
    entries_.swap(below_);
  }
  // A few entries share the memory of one task: many small pieces of it would be slow to come by.
  constexpr std::size_t entries_at_once = 16;
  const std::size_t tasks = (entries_.size() + entries_at_once - 1) / entries_at_once;
  if (tasks_.size() < tasks) tasks_.resize(tasks);
  parallel_for(workers, entries_.size(), entries_at_once, [&](std::size_t begin, std::size_t end) {
    const StandardFloats standard;
    Task& task = tasks_[begin / entries_at_once];
    task.pairs.clear();
    task.tests = 0;
    for (std::size_t i = begin; i < end; ++i) {
      task.stack.assign(1, entries_[i]);
      while (!task.stack.empty()) {
        const Entry entry = task.stack.back();
        task.stack.pop_back();
        if (entry.is_pair_of_blocks()) {
          task.pairs.push_back({entry.a, entry.b});
        } else {
          expand(entry, task.stack);
          ++task.tests;
        }
      }
    }
  });
  for (std::size_t i = 0; i < tasks; ++i) {
    pairs_.insert(pairs_.end(), tasks_[i].pairs.begin(), tasks_[i].pairs.end());
    meter.groups_tested += tasks_[i].tests;
  }
}

void PairSearch::open(std::vector<OpenFacets>& facets) const {
  facets.clear();
  const auto range = [](const SurfaceTreeState& s, std::uint32_t number, int level) {
    const std::size_t size = std::size_t{1} << (3 * (level + 2));
    const std::size_t begin = std::min(s.order.size(), number * size), end = std::min(s.order.size(), begin + size);
    return std::span<const std::uint32_t>(s.order).subspan(begin, end - begin);
  };
  for (const Entry& entry : open_)
    // mutant surface-open-level: `entry.level_b` -> `entry.level_a`
    // mutant surface-open-level-a: `entry.level_a` -> `entry.level_b`
    facets.push_back({range(a(), entry.a, entry.level_a), range(b(), entry.b, entry.level_b)});
}

}  // namespace morula::detail
