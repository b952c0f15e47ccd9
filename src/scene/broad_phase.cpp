// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <morula/scene/broad_phase.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "scene/box_tree.hpp"

namespace morula {
using namespace detail;
namespace {

// The enlargement of boxes: this share of the longest side on all sides, and this multiple of the last move ahead.
constexpr double slack_share = 0.05, moves_ahead = 4;

enum Flag : std::uint8_t { moved = 1, newly_placed = 2, removed = 4 };

bool is_usable_box(const Box& box) {
  const Vec3 all = box.lower + box.upper + box.extent();
  return !box.is_empty() && std::isfinite(all.x) && std::isfinite(all.y) && std::isfinite(all.z);
}

bool overlap(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.lower[axis] > b.upper[axis] || b.lower[axis] > a.upper[axis]) return false;
  return true;
}

OuterBox enlarged(const Box& box, const Vec3& move) {
  const Vec3 e = box.extent();
  const double slack = slack_share * std::max({e.x, e.y, e.z});
  Box larger = box;
  for (int axis = 0; axis < 3; ++axis) {
    larger.lower[axis] -= slack + moves_ahead * std::max(0.0, -move[axis]);
    larger.upper[axis] += slack + moves_ahead * std::max(0.0, move[axis]);
  }
  return float_box(larger);
}

double longest_side(const OuterBox& b) {
  double longest = 0;
  for (int axis = 0; axis < 3; ++axis)
    longest = std::max(longest, static_cast<double>(b.upper[axis]) - static_cast<double>(b.lower[axis]));
  return longest;
}

}  // namespace

struct BroadPhase::State {
  struct Entry {
    Box box;
    std::uint32_t leaf = BoxTree::none;  // the leaf of a box; none: there is no such box
    bool is_static = false;
  };
  struct Candidate {
    std::uint64_t key;
    bool overlaps;
  };

  std::vector<Entry> entries;
  std::vector<std::uint8_t> flags;     // flags per entry, set since the last update
  std::vector<std::uint32_t> changed;  // entries with flags
  std::vector<std::uint32_t> free;     // free entries, a heap with the lowest first
  BoxTree tree;
  std::vector<Candidate> candidates, merged;
  std::vector<std::uint64_t> found;
  std::vector<BoxPair> pairs, next_pairs;
  std::size_t size = 0;

  bool has(std::uint32_t number) const { return number < entries.size() && entries[number].leaf != BoxTree::none; }

  /// Reserves memory for one more box: adding, moving and removing it then allocate nothing.
  void reserve() {
    if (entries.size() == entries.capacity()) entries.reserve(2 * entries.size() + 1);
    tree.reserve();
    reserve_as_entries();
  }
  void reserve_as_entries() {
    flags.reserve(entries.capacity());
    changed.reserve(entries.capacity());
    free.reserve(entries.capacity());
  }

  void flag(std::uint32_t number, std::uint8_t what) {
    if (flags[number] == 0) changed.push_back(number);
    flags[number] |= what;
  }

  void look_around(std::uint32_t number) {
    const Entry& entry = entries[number];
    const OuterBox larger = tree.box(entry.leaf);
    tree.visit([&](const OuterBox& box) { return box.overlaps(larger); },
               [&](std::uint32_t other) {
                 if (other == number || (entry.is_static && entries[other].is_static)) return;
                 // If both entries of a pair search, the lower one lists the pair.
                 if ((flags[other] & newly_placed) != 0 && other < number) return;
                 found.push_back(std::uint64_t{std::min(number, other)} << 32 | std::max(number, other));
               });
  }

  void compare(Candidate& candidate) const {
    candidate.overlaps =
        overlap(entries[candidate.key >> 32].box, entries[static_cast<std::uint32_t>(candidate.key)].box);
  }

  // The number of an entry is the item of its leaf.
  template <class Reaches>
  void list(const Reaches& reaches, std::vector<std::uint32_t>& numbers) const {
    numbers.clear();
    tree.visit(reaches, [&](std::uint32_t number) { numbers.push_back(number); });
    std::sort(numbers.begin(), numbers.end());
  }
};

BroadPhase::BroadPhase() : state_(std::make_unique<State>()) {}
BroadPhase::~BroadPhase() = default;
BroadPhase::BroadPhase(BroadPhase&&) noexcept = default;
BroadPhase& BroadPhase::operator=(BroadPhase&&) noexcept = default;

std::uint32_t BroadPhase::add(const Box& box, bool is_static) {
  const StandardFloats standard;
  if (!is_usable_box(box)) throw std::invalid_argument("a box of the broad phase is empty or not finite");
  State& s = *state_;
  // Memory is allocated first: if that fails, nothing has changed.
  // mutant broad-memory-later: `  s.reserve();` -> `;`
  s.reserve();
  std::uint32_t number;
  if (s.free.empty()) {
    number = static_cast<std::uint32_t>(s.entries.size());
    s.entries.emplace_back();
    s.flags.push_back(0);
  } else {
    std::pop_heap(s.free.begin(), s.free.end(), std::greater<>());
    number = s.free.back();
    s.free.pop_back();
  }
  s.entries[number] = {box, s.tree.insert(is_static ? float_box(box) : enlarged(box, {}), number), is_static};
  s.flag(number, moved | newly_placed);
  ++s.size;
  return number;
}

void BroadPhase::remove(std::uint32_t number) {
  State& s = *state_;
  if (!s.has(number))
    throw std::invalid_argument("there is no box " + std::to_string(number) + ": was it removed before?");
  s.tree.remove(s.entries[number].leaf);
  s.entries[number].leaf = BoxTree::none;
  s.flag(number, removed);
  --s.size;
}

Status BroadPhase::move(std::uint32_t number, const Box& box) {
  const StandardFloats standard;
  State& s = *state_;
  if (!s.has(number) || !is_usable_box(box)) return {.code = Status::Code::bad_option, .index = number};
  State::Entry& entry = s.entries[number];
  const Vec3 way = box.center() - entry.box.center();
  entry.box = box;
  s.flag(number, moved);
  const OuterBox& larger = s.tree.box(entry.leaf);
  const Vec3 e = box.extent();
  const double longest = std::max({e.x, e.y, e.z});
  // A box that has shrunk is inserted again.
  if (larger.contains(float_box(box)) && longest_side(larger) <= 2 * longest + 2 * moves_ahead * max_norm(way))
    return {};
  s.tree.remove(entry.leaf);
  entry.leaf = s.tree.insert(enlarged(box, way), number);
  s.flag(number, newly_placed);
  return {};
}

void BroadPhase::reserve(std::size_t boxes, std::size_t pairs) {
  require_reservable({boxes, pairs});
  State& s = *state_;
  s.entries.reserve(boxes);
  s.reserve_as_entries();
  s.tree.reserve(boxes);
  s.candidates.reserve(pairs), s.merged.reserve(pairs), s.found.reserve(pairs);
  s.pairs.reserve(pairs), s.next_pairs.reserve(pairs);
}

bool BroadPhase::has(std::uint32_t number) const {
  return state_->has(number);
}

const Box& BroadPhase::box(std::uint32_t number) const {
  return state_->entries[number].box;
}

std::size_t BroadPhase::size() const {
  return state_->size;
}

void BroadPhase::update() {
  const StandardFloats standard;
  State& s = *state_;
  if (s.changed.empty()) return;
  s.found.clear();
  for (const std::uint32_t number : s.changed)
    if ((s.flags[number] & newly_placed) != 0 && s.has(number)) s.look_around(number);
  std::sort(s.found.begin(), s.found.end());

  s.merged.clear();
  s.next_pairs.clear();
  const auto take = [&](const State::Candidate& candidate) {
    s.merged.push_back(candidate);
    if (candidate.overlaps)
      s.next_pairs.push_back(
          {static_cast<std::uint32_t>(candidate.key >> 32), static_cast<std::uint32_t>(candidate.key)});
  };
  auto next = s.found.begin();
  const auto take_found = [&](std::uint64_t below) {
    for (; next != s.found.end() && *next < below; ++next) {
      State::Candidate candidate{*next, false};
      s.compare(candidate);
      take(candidate);
    }
  };
  for (State::Candidate& candidate : s.candidates) {
    const std::uint8_t flags = s.flags[candidate.key >> 32] | s.flags[static_cast<std::uint32_t>(candidate.key)];
    // Entries that search find all of their pairs again.
    if ((flags & (newly_placed | removed)) != 0) continue;
    take_found(candidate.key);
    if (flags != 0) s.compare(candidate);
    take(candidate);
  }
  take_found(~std::uint64_t{0});
  // All memory is allocated: nothing below throws.
  s.candidates.swap(s.merged);
  s.pairs.swap(s.next_pairs);

  for (const std::uint32_t number : s.changed) {
    if ((s.flags[number] & removed) != 0) {
      s.free.push_back(number);
      std::push_heap(s.free.begin(), s.free.end(), std::greater<>());
    }
    s.flags[number] = 0;
  }
  s.changed.clear();
}

std::span<const BoxPair> BroadPhase::pairs() const {
  return state_->pairs;
}

void BroadPhase::find(const Box& box, std::vector<std::uint32_t>& found) const {
  const StandardFloats standard;
  const OuterBox narrow = float_box(box);
  state_->list([&](const OuterBox& b) { return b.overlaps(narrow); }, found);
  std::erase_if(found, [&](std::uint32_t number) { return !overlap(state_->entries[number].box, box); });
}

void BroadPhase::find_behind(const Vec3& direction, double distance, std::vector<std::uint32_t>& found) const {
  const StandardFloats standard;
  // A normal of usual length: products of a very short one would lose digits, and those of a long one overflow.
  Vec3 normal = direction;
  double offset = distance;
  if (const double longest = max_norm(direction); is_finite(direction) && longest > 0) {
    const int exponent = std::ilogb(longest);
    normal = {std::ldexp(direction.x, -exponent), std::ldexp(direction.y, -exponent),
              std::ldexp(direction.z, -exponent)};
    offset = std::ldexp(distance, -exponent);
  }
  // Tests the corner that is farthest behind; rounding only adds boxes.
  state_->list(
      [&](const OuterBox& b) {
        double least = 0, size = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const double corner =
              normal[axis] > 0 ? static_cast<double>(b.lower[axis]) : static_cast<double>(b.upper[axis]);
          if (normal[axis] == 0) continue;
          least += normal[axis] * corner;
          size += std::abs(normal[axis] * corner);
        }
        return !(least - 0x1p-50 * size - 0x1p-900 > offset);
      },
      found);
}

namespace {

/// A test whether a box, grown by `half` on all sides, meets origin + t direction for a t in [0, t_end].
class Slabs {
 public:
  Slabs(const Vec3& origin, const Vec3& half, const Vec3& direction, double t_end)
      : origin_(origin), half_(half), direction_(direction), t_end_(t_end) {}

  // A comparison with NaN keeps the box.
  bool operator()(const OuterBox& b) const {
    double enter = 0, leave = t_end_;
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = static_cast<double>(b.lower[axis]) - half_[axis];
      const double upper = static_cast<double>(b.upper[axis]) + half_[axis];
      // The rounding of sums and differences, as a share of the largest coordinate.
      const double size = std::abs(origin_[axis]) + std::max(std::abs(lower), std::abs(upper));
      if (direction_[axis] == 0) {
        const double pad = half_[axis] > 0 ? 0x1p-50 * size : 0;
        if (origin_[axis] < lower - pad || origin_[axis] > upper + pad) return false;
        continue;
      }
      double near = (lower - origin_[axis]) / direction_[axis], far = (upper - origin_[axis]) / direction_[axis];
      if (near > far) std::swap(near, far);
      const double pad = 0x1p-50 * size / std::abs(direction_[axis]) + 0x1p-50 * (std::abs(near) + std::abs(far));
      if (near - pad > enter) enter = near - pad;
      if (far + pad < leave) leave = far + pad;
    }
    return !(enter > leave);
  }

 private:
  Vec3 origin_, half_, direction_;
  double t_end_;
};

}  // namespace

void BroadPhase::find_along(const Vec3& origin, const Vec3& direction, double t_end,
                            std::vector<std::uint32_t>& found) const {
  const StandardFloats standard;
  state_->list(Slabs(origin, {}, direction, t_end), found);
}

void BroadPhase::find_along(const Box& box, const Vec3& motion, std::vector<std::uint32_t>& found) const {
  const StandardFloats standard;
  // mutant broad-swept-half: `box.extent() * 0.5` -> `box.extent() * 0.4`
  state_->list(Slabs(box.center(), box.extent() * 0.5, motion, 1), found);
}

}  // namespace morula
