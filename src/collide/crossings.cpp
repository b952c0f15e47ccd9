// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <morula/collide/collider.hpp>
#include <morula/collide/crossings.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "collide/facets/box_kernels.hpp"
#include "collide/facets/corner_reader.hpp"
#include "collide/pairs/descent.hpp"
#include "collide/require.hpp"
#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "query/triangle_pairs.hpp"
#include "simd/float4.hpp"

namespace morula {
using namespace detail;
namespace {

/// A set of pairs of indices that is filled, searched and emptied; its memory stays.
class PairSet {
 public:
  /// Returns true when the key was not in the set. The key is not 2^64 - 1.
  bool insert(std::uint64_t key) {
    if (2 * size_ >= slots_.size()) grow();
    if (!put(key)) return false;
    ++size_;
    return true;
  }
  std::size_t size() const { return size_; }
  void clear() {
    std::fill(slots_.begin(), slots_.end(), nothing);
    size_ = 0;
  }

 private:
  static constexpr std::uint64_t nothing = ~std::uint64_t{0};

  bool put(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    const int shift = 64 - std::countr_zero(slots_.size());
    for (std::size_t i = (key * 0x9e3779b97f4a7c15u) >> shift;; i = (i + 1) & mask) {
      if (slots_[i] == key) return false;
      if (slots_[i] != nothing) continue;
      slots_[i] = key;
      return true;
    }
  }
  void grow() {
    std::vector<std::uint64_t> before(std::max<std::size_t>(1024, 4 * slots_.size()), nothing);
    before.swap(slots_);
    for (const std::uint64_t key : before)
      if (key != nothing) put(key);
  }

  std::vector<std::uint64_t> slots_;  // the number of slots is a power of two
  std::size_t size_ = 0;
};

/// The facets of the nodes that one query visits, those of each node read once: boxes, and corners in the world.
class NodeFacets {
 public:
  /// Forgets all facets and keeps the memory. origin: the origin of the boxes' coordinates.
  void start(const Collider& collider, const Vec3& origin);

  struct Range {
    std::uint32_t begin = 0, size = 0;  ///< range of slots; size: number without filling
    FloatBox box;                       ///< box of all facets of the node
  };
  /// The facets of a node; reads them on first use. The reference is valid until the next call.
  const Range& read(std::uint32_t node);

  /// Boxes of a range, filled up. They are valid until the next read.
  BoxList boxes(const Range& range) const {
    BoxList list;
    for (std::size_t k = 0; k < 6; ++k) list.column[k] = bounds_[k].data() + range.begin;
    list.count = filled(range.size);
    return list;
  }
  std::uint32_t facet(std::uint32_t slot) const { return facet_[slot]; }
  /// Corners in the world: few are needed, so they are transformed on first use. The reference is valid until the next
  /// call.
  const Triangle& triangle(std::uint32_t slot) {
    std::uint32_t& place = triangle_of_[slot];
    if (place == unread) {
      place = static_cast<std::uint32_t>(triangles_.size());
      triangles_.push_back(collider_->triangle(facet_[slot]));
    }
    return triangles_[place];
  }
  std::size_t facets_read() const { return facets_read_; }

  static std::size_t filled(std::size_t count) { return (count + box_list_step - 1) / box_list_step * box_list_step; }

 private:
  const Collider* collider_ = nullptr;
  Vec3 origin_;
  // By node: the number of the query that read it last, and the range that was read.
  std::vector<std::uint32_t> stamp_;
  std::vector<Range> range_;
  std::uint32_t now_ = 0;
  // By slot.
  std::vector<float> bounds_[6];
  std::vector<std::uint32_t> facet_;
  static constexpr std::uint32_t unread = 0xffffffffu;
  std::vector<std::uint32_t> triangle_of_;  // place in triangles_
  std::vector<Triangle> triangles_;
  std::size_t used_ = 0, facets_read_ = 0;
};

/// x and y in one register, z twice in another.
struct Registers {
  Double2 xy, z;
};
Registers registers(const Vec3& p) {
  return {Double2{p.x, p.y}, Double2(p.z)};
}

/// A transform by the operations of RigidTransform in their order, hence with the same bits, two coordinates at a time.
class Transform {
 public:
  explicit Transform(const RigidTransform& t)
      : columns_{registers({t.rows[0].x, t.rows[1].x, t.rows[2].x}), registers({t.rows[0].y, t.rows[1].y, t.rows[2].y}),
                 registers({t.rows[0].z, t.rows[1].z, t.rows[2].z})},
        translation_(registers(t.translation)) {}
  Registers operator()(const Vec3& p) const {
    const Double2 x = Double2(p.x), y = Double2(p.y), z = Double2(p.z);
    return {columns_[0].xy * x + columns_[1].xy * y + columns_[2].xy * z + translation_.xy,
            columns_[0].z * x + columns_[1].z * y + columns_[2].z * z + translation_.z};
  }

 private:
  Registers columns_[3], translation_;
};

void NodeFacets::start(const Collider& collider, const Vec3& origin) {
  collider_ = &collider;
  origin_ = origin;
  used_ = facets_read_ = 0;
  triangles_.clear();
  const std::size_t nodes = collider.tree().node_count();
  if (stamp_.size() < nodes) stamp_.resize(nodes, now_), range_.resize(nodes);
  if (++now_ == 0) {
    std::fill(stamp_.begin(), stamp_.end(), 0);
    now_ = 1;
  }
}

const NodeFacets::Range& NodeFacets::read(std::uint32_t node) {
  Range& range = range_[node];
  if (stamp_[node] == now_) return range;
  stamp_[node] = now_;
  const std::span<const std::uint32_t> facets = collider_->facets(node);
  range = {static_cast<std::uint32_t>(used_), static_cast<std::uint32_t>(facets.size()), {}};
  facets_read_ += facets.size();
  const std::size_t end = used_ + filled(facets.size());
  if (facet_.size() < end) {
    const std::size_t room = std::max(end, 2 * facet_.size());
    facet_.resize(room);
    triangle_of_.resize(room);
    for (std::vector<float>& bounds : bounds_) bounds.resize(room);
  }
  // Boxes are in float, yet need no pads: "minus the origin, rounded to double, rounded to float" keeps the order of
  // coordinates, at worst as equals. If two intervals of doubles have a common number, so have their images.
  const CornerReader corners(*collider_);
  const Transform transform(collider_->transform());
  const Registers origin = registers(origin_);
  for (const std::uint32_t facet : facets) {
    const Triangle t = corners(facet);
    const Registers p = transform(t[0]), q = transform(t[1]), r = transform(t[2]);
    const Double2 lower_xy = min(min(p.xy, q.xy), r.xy) - origin.xy;
    const Double2 upper_xy = max(max(p.xy, q.xy), r.xy) - origin.xy;
    const Double2 lower_z = min(min(p.z, q.z), r.z) - origin.z;
    const Double2 upper_z = max(max(p.z, q.z), r.z) - origin.z;
    const FloatBox box{{static_cast<float>(lower_xy[0]), static_cast<float>(lower_xy[1]),
                        static_cast<float>(lower_z[0]), static_cast<float>(upper_xy[0]),
                        static_cast<float>(upper_xy[1]), static_cast<float>(upper_z[0])}};
    range.box.add(box);
    facet_[used_] = facet;
    triangle_of_[used_] = unread;
    for (std::size_t k = 0; k < 6; ++k) bounds_[k][used_] = box.bound[k];
    ++used_;
  }
  constexpr FloatBox empty;
  for (; used_ < end; ++used_)
    for (std::size_t k = 0; k < 6; ++k) bounds_[k][used_] = empty.bound[k];
  return range;
}

/// Some boxes of a node, copied next to each other.
class Selection {
 public:
  /// Copies the boxes of the range that meet `box`.
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

  // The memory, kept for the next query.
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
  check_interrupt();
  const NodeFacets::Range &range_a = facets_a.read(pair.a), &range_b = facets_b.read(pair.b);
  // The common box of both sides' facets shrinks as each side takes only its boxes that meet the other's.
  FloatBox common = range_a.box.meet(range_b.box);
  if (common.is_empty()) return;
  const BoxKernels& kernels = box_kernels();
  common = common.meet(kernels.box_of_meeting(facets_a.boxes(range_a), common));
  if (common.is_empty()) return;
  common = common.meet(kernels.box_of_meeting(facets_b.boxes(range_b), common));
  if (common.is_empty()) return;
  near_a.select(facets_a, range_a, common);
  near_b.select(facets_b, range_b, common);
  // Tests the shorter list against the longer one, so that registers are full.
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
    check_interrupt();
    for (std::uint32_t j = 0; j < all_b.size(); ++j) {
      if (apart(all_a[i].box, all_b[j].box)) continue;
      if (const auto common = intersection(all_a[i].triangle, all_b[j].triangle)) found.push_back({i, j, *common});
    }
  }
  require_good(read.status());
  return found;
}

}  // namespace morula
