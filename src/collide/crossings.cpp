// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/collide/crossings.hpp>
#include <stdexcept>
#include <string>

#include "collide/facets/node_facets.hpp"
#include "collide/pairs/descent.hpp"
#include "collide/pairs/pair_set.hpp"
#include "collide/require.hpp"
#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "query/triangle_pairs.hpp"

namespace morula {
using namespace detail;
namespace {

/// Some boxes of a node, copied next to each other.
class Selection {
 public:
  /// Those of the range that meet `box`.
  void select(const NodeFacets& facets, const NodeFacets::Range& range, const FloatBox& box) {
    const BoxList all = facets.boxes(range);
    slots_.resize(std::max(slots_.size(), all.count));
    size_ = box_kernels().select(all, box, slots_.data());
    const std::size_t filled = NodeFacets::filled(size_);
    for (std::size_t k = 0; k < 6; ++k) {
      std::vector<float>& column = bounds_[k];
      column.resize(std::max(column.size(), all.count));
      for (std::size_t i = 0; i < size_; ++i) column[i] = all.column[k][slots_[i]];
      std::fill(column.begin() + static_cast<std::ptrdiff_t>(size_),
                column.begin() + static_cast<std::ptrdiff_t>(filled), FloatBox{}.bound[k]);
    }
    for (std::size_t i = 0; i < size_; ++i) slots_[i] += range.begin;
  }
  std::size_t size() const { return size_; }
  std::uint32_t slot(std::size_t i) const { return slots_[i]; }
  FloatBox box(std::size_t i) const {
    FloatBox b;
    for (std::size_t k = 0; k < 6; ++k) b.bound[k] = bounds_[k][i];
    return b;
  }
  BoxList boxes() const {
    BoxList list;
    for (std::size_t k = 0; k < 6; ++k) list.column[k] = bounds_[k].data();
    list.count = NodeFacets::filled(size_);
    return list;
  }

 private:
  std::vector<std::uint32_t> slots_;
  std::vector<float> bounds_[6];
  std::size_t size_ = 0;
};

bool have_nodes(const Collider& a, const Collider& b, std::span<const NodePair> nodes) {
  return std::all_of(nodes.begin(), nodes.end(), [&](const NodePair& pair) {
    return pair.a < a.tree().node_count() && pair.b < b.tree().node_count();
  });
}

}  // namespace

struct CrossingQuery::State {
  CallState call;
  std::vector<Crossing> found;
  std::size_t leaf_pairs = 0, facets_read = 0, pairs_tested = 0;

  // Memory for the next query.
  std::vector<NodePair> leaves;
  NodeFacets facets_a, facets_b;
  Selection near_a, near_b;
  PairSet tested;
  std::vector<std::uint32_t> partners;
  struct Candidate {
    std::uint32_t slot_a, slot_b;
    std::uint64_t key;
  };
  std::vector<Candidate> candidates;
  std::vector<std::uint64_t> keys;

  void forget() noexcept {
    CallState kept = call;
    *this = State();
    call = kept;
  }
  void find(const Collider& a, const Collider& b, std::span<const NodePair> nodes);
  void look_at(const NodePair& pair);
};

void CrossingQuery::State::look_at(const NodePair& pair) {
  ask_to_go_on();
  const NodeFacets::Range &range_a = facets_a.read(pair.a), &range_b = facets_b.read(pair.b);
  // What both sides' facets have in common shrinks as each side looks at what the other has there.
  FloatBox common = range_a.box.meet(range_b.box);
  if (common.is_empty()) return;
  const BoxKernels& kernels = box_kernels();
  common = common.meet(kernels.box_of_meeting(facets_a.boxes(range_a), common));
  if (common.is_empty()) return;
  common = common.meet(kernels.box_of_meeting(facets_b.boxes(range_b), common));
  if (common.is_empty()) return;
  near_a.select(facets_a, range_a, common);
  near_b.select(facets_b, range_b, common);
  // The few against the many, so that registers are full.
  const bool few_a = near_a.size() < near_b.size();
  const Selection &few = few_a ? near_a : near_b, &many = few_a ? near_b : near_a;
  partners.resize(std::max(partners.size(), NodeFacets::filled(many.size())));
  for (std::size_t i = 0; i < few.size(); ++i) {
    const std::size_t count = kernels.select(many.boxes(), few.box(i), partners.data());
    for (std::size_t j = 0; j < count; ++j) {
      const std::uint32_t slot_a = few_a ? few.slot(i) : many.slot(partners[j]);
      const std::uint32_t slot_b = few_a ? many.slot(partners[j]) : few.slot(i);
      const std::uint64_t key = std::uint64_t{facets_a.facet(slot_a)} << 32 | facets_b.facet(slot_b);
      if (tested.insert(key)) candidates.push_back({slot_a, slot_b, key});
    }
  }
  find_meeting(
      candidates.size(),
      [&](std::size_t i, const auto& put) {
        put(facets_a.triangle(candidates[i].slot_a), facets_b.triangle(candidates[i].slot_b));
      },
      [&](std::size_t i) { keys.push_back(candidates[i].key); });
  candidates.clear();
}

void CrossingQuery::State::find(const Collider& a, const Collider& b, std::span<const NodePair> nodes) {
  const Vec3 origin = a.transform()(a.sphere_state().origin);
  facets_a.start(a, origin);
  facets_b.start(b, origin);
  tested.clear();
  keys.clear();
  for (const NodePair& pair : nodes) look_at(pair);
  std::sort(keys.begin(), keys.end());
  found.clear();
  for (const std::uint64_t key : keys) {
    const auto facet_a = static_cast<std::uint32_t>(key >> 32), facet_b = static_cast<std::uint32_t>(key);
    found.push_back({facet_a, facet_b, *intersection(a.triangle(facet_a), b.triangle(facet_b))});
  }
  leaf_pairs = nodes.size();
  facets_read = facets_a.facets_read() + facets_b.facets_read();
  pairs_tested = tested.size();
}

CrossingQuery::CrossingQuery() : state_(std::make_unique<State>()) {}
CrossingQuery::~CrossingQuery() = default;
CrossingQuery::CrossingQuery(CrossingQuery&&) noexcept = default;
CrossingQuery& CrossingQuery::operator=(CrossingQuery&&) noexcept = default;

std::span<const Crossing> CrossingQuery::pairs() const {
  return state_->found;
}
std::size_t CrossingQuery::leaf_pairs() const {
  return state_->leaf_pairs;
}
std::size_t CrossingQuery::facets_read() const {
  return state_->facets_read;
}
std::size_t CrossingQuery::pairs_tested() const {
  return state_->pairs_tested;
}

Status CrossingQuery::run(const Collider& a, const Collider& b, std::span<const NodePair> nodes) {
  const StandardFloats standard;
  if (const Status status = status_of_pair(a, b, {.all_spheres = false, .positions = true}); !status) return status;
  if (!have_nodes(a, b, nodes)) return {Status::Code::bad_option};
  ObjectCall own(*state_, CallKind::begins);
  if (!own.status()) return own.status();
  const PairAsRead read(a, b);
  state_->find(a, b, nodes);
  own.finish(read.status());
  return state_->call.ended;
}

Status CrossingQuery::run(const Collider& a, const Collider& b) {
  const StandardFloats standard;
  if (const Status status = status_of_pair(a, b, {.positions = true}); !status) return status;
  ObjectCall own(*state_, CallKind::begins);
  if (!own.status()) return own.status();
  const PairAsRead read(a, b);
  state_->leaves.clear();
  each_overlapping(TreePair(a, b, 0, leaf_level), [&](std::uint32_t node_a, std::uint32_t node_b) {
    state_->leaves.push_back({node_a, node_b});
  });
  state_->find(a, b, state_->leaves);
  own.finish(read.status());
  return state_->call.ended;
}

std::vector<Crossing> crossings(const Collider& a, const Collider& b) {
  CrossingQuery query;
  require_good(query.run(a, b));
  return {query.pairs().begin(), query.pairs().end()};
}

std::vector<Crossing> brute_force::crossings(const Collider& a, const Collider& b) {
  require_bodies(a, b, {.all_spheres = false, .positions = true});
  struct Boxed {
    Triangle triangle;
    Box box;
  };
  const auto boxed = [](const Collider& collider) {
    std::vector<Boxed> all(collider.mesh_facets().size());
    for (std::uint32_t facet = 0; facet < all.size(); ++facet) {
      all[facet].triangle = collider.triangle(facet);
      for (const Vec3& p : all[facet].triangle) all[facet].box.add(p);
    }
    return all;
  };
  const auto apart = [](const Box& s, const Box& t) {
    return s.lower.x > t.upper.x || t.lower.x > s.upper.x || s.lower.y > t.upper.y || t.lower.y > s.upper.y ||
           s.lower.z > t.upper.z || t.lower.z > s.upper.z;
  };
  const PairAsRead read(a, b);
  const std::vector<Boxed> all_a = boxed(a), all_b = boxed(b);
  std::vector<Crossing> found;
  for (std::uint32_t i = 0; i < all_a.size(); ++i) {
    ask_to_go_on();
    for (std::uint32_t j = 0; j < all_b.size(); ++j) {
      if (apart(all_a[i].box, all_b[j].box)) continue;
      if (const auto common = intersection(all_a[i].triangle, all_b[j].triangle)) found.push_back({i, j, *common});
    }
  }
  require_good(read.status());
  return found;
}

}  // namespace morula
