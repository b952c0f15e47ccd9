// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <morula/surface/surface_tree.hpp>
#include <stdexcept>

#include "geometry/hash.hpp"
#include "geometry/index_table.hpp"
#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "surface/boxes/lazy_boxes.hpp"
#include "surface/boxes/tree_state.hpp"
#include "surface/boxes/vertex_reader.hpp"

namespace morula {
using namespace detail;
namespace {

/// The lowest vertex whose position is rejected, if there is one.
std::optional<std::uint32_t> lowest_bad(const SurfaceTreeState& s, const PositionView& positions) {
  for (std::uint32_t v = 0; v < positions.size(); ++v)
    if (s.blocks.slot_of_vertex[v] != SurfaceTreeState::no_slot && !is_near(positions[v] - s.origin)) return v;
  return std::nullopt;
}

BlocksOfLeaves blocks_of_leaves(const SurfaceTreeState& s, const Collider& body) {
  if (!std::equal(body.mesh_facets().begin(), body.mesh_facets().end(), s.mesh.facets.begin(), s.mesh.facets.end()))
    throw std::invalid_argument("the body is of another mesh: its facets are not those of the surface");
  std::vector<std::uint32_t> block_of_facet(s.mesh.facets.size());
  for (std::uint32_t i = 0; i < s.blocks.order.size(); ++i) block_of_facet[s.blocks.order[i]] = i / 8;
  BlocksOfLeaves found;
  const SphereTree& tree = body.tree();
  found.cover_id = body.sphere_state().cover_id;
  found.begin.push_back(0);
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    const auto first = static_cast<std::ptrdiff_t>(found.blocks.size());
    if (tree.is_leaf(node))
      for (const std::uint32_t facet : body.facets(node)) found.blocks.push_back(block_of_facet[facet]);
    std::sort(found.blocks.begin() + first, found.blocks.end());
    found.blocks.erase(std::unique(found.blocks.begin() + first, found.blocks.end()), found.blocks.end());
    found.begin.push_back(static_cast<std::uint32_t>(found.blocks.size()));
  }
  return found;
}

}  // namespace

double SurfaceTreeState::farthest_of_spheres(const Collider& body) const {
  const Sphere root = body.sphere_state().sphere(0);
  const double coordinates =
      max_norm(body.sphere_state().origin) + max_norm(body.transform().translation) + max_norm(origin);
  // A transform is rigid up to 2^-28 of a length; rounding changes the three coordinates by less than 2^-40 of them.
  return (max_norm(body.transform()(root.center) - origin) + max_norm(origin) + root.radius) * (1 + 0x1p-20) +
         0x1p-40 * coordinates;
}

Status SurfaceTreeState::askable(std::uint8_t body) const {
  if (!call.ended) return {call.ended.code, body};
  if (call.is_running) return {Status::Code::in_use, body};
  if (pose.followed && !pose.followed->is_current()) return {Status::Code::surface_not_current, body};
  return {};
}

Status SurfaceTreeState::move(Workers& workers) {
  std::atomic<bool> is_bad = false;
  const MakeVertexBoxes make_boxes = make_vertex_boxes();
  const auto make = [&](std::size_t begin, std::size_t end, const auto& read_from, const auto& read_to, bool is_step) {
    // One more element of each: the kernel reads one number beyond the last.
    std::array<Vec3, vertices_together + 1> lower, upper;
    unsigned far = 0;
    for (; begin < end; begin += vertices_together) {
      const std::size_t count = std::min(vertices_together, end - begin);
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t v = blocks.vertex_of_slot[begin + i];
        const Vec3 p = read_from(v) - origin;
        far += is_near(p) ? 0 : 1;
        lower[i] = p;
        if (!is_step) continue;
        const Vec3 q = read_to(v) - origin;
        far += is_near(q) ? 0 : 1;
        lower[i] = min(p, q), upper[i] = max(p, q);
      }
      // No value is cast that float does not hold.
      if (far != 0) break;
      make_boxes(lower.data(), is_step ? upper.data() : lower.data(), count, &next_vertex_boxes[begin]);
    }
    if (far != 0) is_bad = true;
  };
  parallel_for(workers, blocks.vertex_of_slot.size(), vertices_at_once, [&](std::size_t begin, std::size_t end) {
    with_reader(pose.from, mesh.rest, [&](const auto& read_from) {
      if (!pose.to) {
        make(begin, end, read_from, read_from, false);
      } else {
        with_reader(pose.to, mesh.rest, [&](const auto& read_to) { make(begin, end, read_from, read_to, true); });
      }
    });
  });
  if (is_bad) return {Status::Code::non_finite_position};
  std::swap(boxes.vertices, next_vertex_boxes);
  const std::size_t count = block_count();
  parallel_for(workers, boxes.levels[0].size(), groups_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = 8 * begin; block < std::min(count, 8 * end); ++block) boxes.join_block(*this, block);
  });
  for (std::size_t level = 1; level < boxes.levels.size(); ++level)
    parallel_for(workers, boxes.levels[level].size(), groups_at_once, [&](std::size_t begin, std::size_t end) {
      for (std::size_t g = begin; g < end; ++g) boxes.join_group(level, g);
    });
  boxes.measure();
  ++frame;
  return {};
}

const SurfaceTreeState& detail::state_of(const SurfaceTree& surface) {
  return *surface.state_;
}

SurfaceTree::SurfaceTree(const MeshView& rest) {
  const StandardFloats standard;
  state_ = std::make_shared<SurfaceTreeState>(make_surface_tree(rest));
  static_cast<void>(state_->move(serial_workers()));  // ok: make_surface_tree() has checked the rest positions
}
// Queries that hold this state then see another frame.
SurfaceTree::~SurfaceTree() {
  // mutant surface-gone-unseen: `if (state_) state_->forget()` -> ``
  if (state_) state_->forget();
}
SurfaceTree::SurfaceTree(SurfaceTree&&) noexcept = default;
SurfaceTree& SurfaceTree::operator=(SurfaceTree&& other) noexcept {
  if (this == &other) return *this;
  const SurfaceTree gone(std::move(*this));
  state_ = std::move(other.state_);
  return *this;
}

Status SurfaceTree::update(const PositionView& positions, Workers& workers) {
  return update(positions, positions, workers);
}

Status SurfaceTree::update(const PositionView& from, const PositionView& to, Workers& workers) {
  const StandardFloats standard;
  const Uninterrupted whole;
  SurfaceTreeState& s = *state_;
  ObjectCall own(s, CallKind::begins);
  if (!own.status()) return own.status();
  for (const PositionView* view : {&from, &to})
    if (view->size() != s.mesh.rest.size()) return {.code = Status::Code::wrong_vertex_count};
  const SurfacePose before = s.pose;
  s.pose.followed.reset();
  s.pose.from = from;
  if (&from == &to) {
    s.pose.to.reset();
  } else {
    s.pose.to = to;
  }
  Status status = s.move(workers);
  own.finish(status);
  if (status) return status;
  s.pose = before;
  const std::optional<std::uint32_t> bad_from = lowest_bad(s, from), bad_to = lowest_bad(s, to);
  status.index = std::min(bad_from.value_or(SurfaceTreeState::no_slot), bad_to.value_or(SurfaceTreeState::no_slot));
  return status;
}

Status SurfaceTree::follow(const Collider& body) {
  const StandardFloats standard;
  if (const Status status = morula::askable(body); !status) return status;
  SurfaceTreeState& s = *state_;
  if (s.call.is_running) return {.code = Status::Code::in_use};
  if (body.vertex_count() != s.mesh.rest.size()) return {.code = Status::Code::wrong_vertex_count};
  // Spheres that cover prove that all vertices are near; otherwise each vertex is checked.
  if (!body.sphere_state().covers || !(s.farthest_of_spheres(body) < farthest_vertex))
    for (std::uint32_t v = 0; v < s.mesh.rest.size(); ++v)
      if (s.blocks.slot_of_vertex[v] != SurfaceTreeState::no_slot && !is_near(body.vertex(v) - s.origin))
        return {.code = Status::Code::non_finite_position, .index = v};
  if (s.blocks_of_leaves.begin.empty() || s.blocks_of_leaves.cover_id != body.sphere_state().cover_id)
    s.blocks_of_leaves = blocks_of_leaves(s, body);
  // An assignment allocates nothing.
  if (s.pose.followed) {
    s.pose.followed->spheres = body;
  } else {
    s.pose.followed.emplace(FollowedBody{body});
  }
  s.pose.followed->frame = body.sphere_state().frame;
  s.pose.followed->is_placed = !(body.transform() == RigidTransform{});
  s.pose.from = body.positions();
  s.pose.to.reset();
  s.call.ended = {};
  ++s.frame;
  return {};
}

bool SurfaceTree::is_following() const {
  return state_->pose.followed.has_value();
}
bool SurfaceTree::is_step() const {
  return state_->pose.to.has_value();
}
std::size_t SurfaceTree::vertex_count() const {
  return state_->mesh.rest.size();
}
std::span<const Facet> SurfaceTree::facets() const {
  return state_->mesh.facets;
}
std::span<const std::array<std::uint32_t, 2>> SurfaceTree::edges() const {
  return state_->mesh.edges;
}
std::size_t SurfaceTree::duplicate_vertices() const {
  std::atomic<std::size_t>& kept = state_->duplicates->count;
  if (const std::size_t known = kept.load(); known != DuplicateCount::unknown) return known;
  const StandardFloats standard;
  IndexTable places;
  std::size_t count = 0;
  const std::vector<Vec3>& rest = state_->mesh.rest;
  const auto hash_of = [&](std::uint32_t v) { return hash_of_numbers(rest[v].x, rest[v].y, rest[v].z); };
  for (std::uint32_t v = 0; v < rest.size(); ++v) {
    if (state_->blocks.slot_of_vertex[v] == SurfaceTreeState::no_slot) continue;
    const auto is_here = [&](std::uint32_t w) { return rest[w] == rest[v]; };
    if (places.find(hash_of(v), is_here) != IndexTable::none)
      ++count;
    else
      places.add(v, hash_of);
  }
  kept.store(count);
  return count;
}

Vec3 SurfaceTree::from(std::uint32_t vertex) const {
  return state_->from_of(vertex);
}
Vec3 SurfaceTree::to(std::uint32_t vertex) const {
  return state_->to_of(vertex);
}
Vec3 SurfaceTree::rest(std::uint32_t vertex) const {
  return state_->mesh.rest[vertex];
}

std::uint64_t SurfaceTree::hash() const {
  const StandardFloats standard;
  if (const Status status = state_->askable(0); !status) throw std::invalid_argument(message(status));
  Hasher hasher;
  QueryBoxes boxes;
  boxes.start(*state_, *state_, 0, false, serial_workers());
  for (const std::vector<BoxGroup>& level : boxes.a().levels)
    for (const BoxGroup& group : level)
      for (const auto& column : group.bound)
        for (const float bound : column) hasher.add(bound);
  return hasher.value();
}

}  // namespace morula
