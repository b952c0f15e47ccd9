// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <morula/surface/surface_tree.hpp>

#include "geometry/hash.hpp"
#include "parallel/float_environment.hpp"
#include "surface/tree_state.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double farthest = 0x1p102;
constexpr std::size_t vertices_at_once = 8192, groups_at_once = 256;
/// Vertices that are read before their boxes are made.
constexpr std::size_t few = 128;

inline bool is_near(const Vec3& p) {
  return std::abs(p.x) <= farthest && std::abs(p.y) <= farthest && std::abs(p.z) <= farthest;
}

inline void put(BoxGroup& group, std::size_t place, const MinBox& box) {
  for (std::size_t k = 0; k < 3; ++k) {
    group.bound[k][place] = box.bound[k];
    group.bound[k + 3][place] = -box.bound[k + 4];
  }
}

MinBox box_of(const SurfaceTreeState& s, std::size_t block) {
  MinBox box;
  for (std::uint32_t slot = s.own_vertices[block]; slot < s.own_vertices[block + 1]; ++slot)
    box.add(s.vertex_boxes[slot]);
  for (std::uint32_t i = s.guests_begin[block]; i < s.guests_begin[block + 1]; ++i)
    box.add(s.vertex_boxes[s.guests[i]]);
  return box;
}

MinBox box_of(const BoxGroup& group) {
  MinBox box;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t place = 0; place < 8; ++place) {
      box.bound[k] = std::min(box.bound[k], group.bound[k][place]);
      box.bound[k + 4] = std::min(box.bound[k + 4], -group.bound[k + 3][place]);
    }
  return box;
}

/// The lowest vertex that cannot be taken; none.
std::optional<std::uint32_t> lowest_bad(const SurfaceTreeState& s, const PositionView& positions) {
  for (std::uint32_t v = 0; v < positions.size(); ++v)
    if (s.slot_of_vertex[v] != SurfaceTreeState::no_slot && !is_near(positions[v] - s.origin)) return v;
  return std::nullopt;
}

}  // namespace

namespace {

/// Reads vertices of a view of this kind.
template <class Scalar>
struct Reader {
  const PositionView& view;
  Vec3 operator()(std::uint32_t v) const {
    Scalar xyz[3];
    std::memcpy(xyz, view.address(v), sizeof xyz);
    return {xyz[0], xyz[1], xyz[2]};
  }
};

/// f(reader) with the reader of a view, or of positions at rest where there is none.
template <class F>
void with_reader(const std::optional<PositionView>& view, const std::vector<Vec3>& rest, const F& f) {
  if (!view) {
    f([&](std::uint32_t v) { return rest[v]; });
  } else if (view->is_double()) {
    f(Reader<double>{*view});
  } else {
    f(Reader<float>{*view});
  }
}

}  // namespace

Status SurfaceTreeState::move(Workers& workers) {
  std::atomic<bool> is_bad = false;
  const MakeVertexBoxes make_boxes = make_vertex_boxes();
  const auto boxes = [&](std::size_t begin, std::size_t end, const auto& read_from, const auto& read_to, bool is_step) {
    // One more of each: the kernel reads one number beyond the last.
    std::array<Vec3, few + 1> lower, upper;
    bool good = true;
    for (; begin < end; begin += few) {
      const std::size_t count = std::min(few, end - begin);
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t v = vertex_of_slot[begin + i];
        const Vec3 p = read_from(v) - origin;
        good = good && is_near(p);
        lower[i] = p;
        if (!is_step) continue;
        const Vec3 q = read_to(v) - origin;
        good = good && is_near(q);
        lower[i] = min(p, q), upper[i] = max(p, q);
      }
      // Nothing is cast that float does not hold.
      if (!good) break;
      make_boxes(lower.data(), is_step ? upper.data() : lower.data(), count, &next_vertex_boxes[begin]);
    }
    if (!good) is_bad = true;
  };
  parallel_for(workers, vertex_of_slot.size(), vertices_at_once, [&](std::size_t begin, std::size_t end) {
    with_reader(from, rest, [&](const auto& read_from) {
      if (!to) {
        boxes(begin, end, read_from, read_from, false);
      } else {
        with_reader(to, rest, [&](const auto& read_to) { boxes(begin, end, read_from, read_to, true); });
      }
    });
  });
  if (is_bad) return {Status::Code::non_finite_position};
  std::swap(vertex_boxes, next_vertex_boxes);
  const std::size_t blocks = block_count();
  parallel_for(workers, levels[0].size(), groups_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g)
      for (std::size_t block = 8 * g; block < std::min(blocks, 8 * g + 8); ++block)
        put(levels[0][g], block - 8 * g, box_of(*this, block));
  });
  for (std::size_t level = 1; level < levels.size(); ++level) {
    const std::vector<BoxGroup>& below = levels[level - 1];
    std::vector<BoxGroup>& groups = levels[level];
    parallel_for(workers, groups.size(), groups_at_once, [&](std::size_t begin, std::size_t end) {
      for (std::size_t g = begin; g < end; ++g)
        for (std::size_t i = 8 * g; i < std::min(below.size(), 8 * g + 8); ++i)
          put(groups[g], i - 8 * g, box_of(below[i]));
    });
  }
  const MinBox all = box_of(levels.back()[0]);
  extent = 0;
  for (const float bound : all.bound)
    if (std::isfinite(bound)) extent = std::max(extent, std::abs(static_cast<double>(bound)));
  ++frame;
  return {};
}

SurfaceTree::SurfaceTree(const MeshView& rest) {
  const StandardFloats standard;
  state_ = std::make_unique<SurfaceTreeState>(make_surface_tree(rest));
  state_->move(serial_workers());
}
SurfaceTree::~SurfaceTree() = default;
SurfaceTree::SurfaceTree(SurfaceTree&&) noexcept = default;
SurfaceTree& SurfaceTree::operator=(SurfaceTree&&) noexcept = default;

Status SurfaceTree::update(const PositionView& positions, Workers& workers) {
  return update(positions, positions, workers);
}

Status SurfaceTree::update(const PositionView& from, const PositionView& to, Workers& workers) {
  const StandardFloats standard;
  SurfaceTreeState& s = *state_;
  for (const PositionView* view : {&from, &to})
    if (view->size() != s.rest.size()) return {.code = Status::Code::wrong_vertex_count};
  const auto before_from = s.from, before_to = s.to;
  s.from = from;
  if (&from == &to) {
    s.to.reset();
  } else {
    s.to = to;
  }
  Status status = s.move(workers);
  if (status) return status;
  s.from = before_from, s.to = before_to;
  const std::optional<std::uint32_t> bad_from = lowest_bad(s, from), bad_to = lowest_bad(s, to);
  status.index = std::min(bad_from.value_or(SurfaceTreeState::no_slot), bad_to.value_or(SurfaceTreeState::no_slot));
  return status;
}

bool SurfaceTree::is_step() const {
  return state_->to.has_value();
}
std::size_t SurfaceTree::vertex_count() const {
  return state_->rest.size();
}
std::span<const Facet> SurfaceTree::facets() const {
  return state_->facets;
}
std::span<const std::array<std::uint32_t, 2>> SurfaceTree::edges() const {
  return state_->edges;
}
Vec3 SurfaceTree::from(std::uint32_t vertex) const {
  return state_->from_of(vertex);
}
Vec3 SurfaceTree::to(std::uint32_t vertex) const {
  return state_->to_of(vertex);
}
Vec3 SurfaceTree::rest(std::uint32_t vertex) const {
  return state_->rest[vertex];
}

std::uint64_t SurfaceTree::hash() const {
  Hasher hasher;
  for (const std::vector<BoxGroup>& level : state_->levels)
    for (const BoxGroup& group : level)
      for (const auto& column : group.bound)
        for (const float bound : column) hasher.add(bound);
  return hasher.value();
}

}  // namespace morula
