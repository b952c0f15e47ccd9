// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/crossings.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "collide/patches/patch_points.hpp"
#include "collide/patches/self_regions.hpp"
#include "collide/require.hpp"
#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

/// A patch of the last run, by which the next run recognizes it: its centroid in the coordinates of both bodies, and
/// the axis of a's coordinates from which its sectors are counted.
struct KnownPatch {
  std::uint32_t id;
  std::array<Vec3, 2> centroid;
  double size;  // square root of its area
  int axis;
};

/// All that patches() refers to.
struct PatchResult {
  std::vector<ContactPatch> patches;
  std::array<SideResult, 2> sides;
  std::vector<PatchPoint> points;
  std::vector<std::size_t> points_begin;
  double volume = 0;
  bool certified = false;

  void clear() {
    patches.clear();
    points.clear();
    points_begin.clear();
    for (SideResult& side : sides) {
      side.facets.clear(), side.gradients.clear();
      side.facets_begin.clear(), side.gradients_begin.clear();
    }
    volume = 0;
    certified = false;
  }
  /// Makes the spans of all patches, when the vectors are complete.
  void link() {
    for (SideResult& side : sides) {
      side.facets_begin.push_back(side.facets.size());
      side.gradients_begin.push_back(side.gradients.size());
    }
    points_begin.push_back(points.size());
    const auto range = [](const auto& values, const std::vector<std::size_t>& begin, std::size_t i) {
      return std::span(values).subspan(begin[i], begin[i + 1] - begin[i]);
    };
    for (std::size_t i = 0; i < patches.size(); ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        PatchSide& side = k == 0 ? patches[i].a : patches[i].b;
        side.facets = range(sides[k].facets, sides[k].facets_begin, i);
        side.gradients = range(sides[k].gradients, sides[k].gradients_begin, i);
      }
      patches[i].points = range(points, points_begin, i);
    }
  }
};

/// The axis of the body's coordinates that is most nearly across the normal.
int axis_across(const RigidTransform& transform, const Vec3& normal) {
  const Vec3 local = transform.inverse_rotate(normal);
  const double x = std::abs(local.x), y = std::abs(local.y), z = std::abs(local.z);
  return x <= y && x <= z ? 0 : y <= z ? 1 : 2;
}

PatchFrame frame_of(const RigidTransform& transform, int axis, const Vec3& normal, const Vec3& center) {
  Vec3 unit;
  unit[axis] = 1;
  const Vec3 along = transform.rotate(unit);
  const Vec3 first = normalized(along - normal * dot(along, normal));
  return {first, cross(normal, first), normal, center};
}

}  // namespace

struct ContactPatchQuery::State {
  State(const Collider& a, const Collider& b) : body{&a, &b} {
    surface.reserve(2);
    surface.emplace_back(a, "first");
    surface.emplace_back(b, "second");
  }

  explicit State(const Collider& one) : body{&one, &one}, self(one) {}

  CallState call;
  std::array<const Collider*, 2> body;
  std::vector<ClosedSurface> surface;  // of two bodies
  std::optional<SelfSurface> self;     // of one body
  CrossingQuery crossings;
  ContactLoops loops;
  SelfLoops self_loops;
  SelfRegions regions;
  PatchIntegrator integrator;
  ProjectedRegion projected[2];
  PatchDepth depth;
  PatchPoints points;
  PatchResult result, next;
  std::vector<KnownPatch> known, known_next;
  std::vector<double> sizes;
  std::uint32_t next_id = 0;

  void forget() noexcept {
    result.clear();
    known.clear();
  }
  Status find(const ContactPatchOptions& options);
  Status find_regions();
  Status measure(std::uint32_t patch);
  void recognize();
  void complete(std::uint32_t patch, const ContactPatchOptions& options);
};

Status ContactPatchQuery::State::find_regions() {
  const Collider &a = *body[0], &b = *body[1];
  if (self) {
    self_loops.find(a, self->closed, self->tree);
    regions.find(a, *self, self_loops, {result.sides[0].facets, result.sides[1].facets});
    return {};
  }
  if (const Status status = crossings.run(a, b); !status) return status;
  const auto pairs = crossings.pairs();
  const Vec3 origin = pairs.empty() ? b.vertex(b.mesh_facets()[0][0]) : pairs[0].segment.from;
  loops.find(a, surface[0], b, surface[1], pairs, origin);
  return regions.PatchRegions::find(a, surface[0], b, surface[1], loops, origin);
}

Status ContactPatchQuery::State::find(const ContactPatchOptions& options) {
  if (const Status status = find_regions(); !status) return status;
  next.clear();
  sizes.clear();
  for (std::uint32_t patch = 0; patch < regions.patch_count; ++patch)
    if (const Status status = measure(patch); !status) return status;
  recognize();
  for (std::uint32_t patch = 0; patch < regions.patch_count; ++patch) complete(patch, options);
  next.volume = std::max(0.0, next.volume);
  next.link();
  next.certified = self || (body[0]->sphere_state().covers && body[1]->sphere_state().covers);
  return {};
}

Status ContactPatchQuery::State::measure(std::uint32_t patch) {
  const PatchIntegrals sums = integrator.integrate(regions, patch, next.sides);
  for (std::uint8_t k = 0; k < 2 && !self; ++k)
    if (sums.wound_area[k] < -sums.rounding[k]) return {Status::Code::inside_out, static_cast<std::uint8_t>(1 - k)};
  ContactPatch made;
  made.volume = std::max(0.0, sums.volume);
  // Of a volume that rounds to 0 the reference point is the centroid, up to rounding.
  const Vec3 arm = sums.volume > 0 ? sums.first_moment / sums.volume : Vec3{};
  made.centroid = regions.origin() + sums.reference + arm;
  for (std::size_t k = 0; k < 2; ++k) {
    PatchSide& side = k == 0 ? made.a : made.b;
    side.area_vector = sums.area_vector[k];
    side.moment = sums.moment[k] - cross(arm, sums.area_vector[k]);
    side.area = sums.area[k];
  }
  // The area vector of a closed region is 0, up to rounding.
  const double across = length(made.a.area_vector);
  // mutant patches-closed-normal: `0x1p-40` -> `0`
  if (across > 0x1p-40 * (made.a.area + made.b.area)) {
    made.normal = -made.a.area_vector / across;
    made.mean_depth = made.volume / across;
  }
  made.crossing_count = regions.crossing_counts[patch];
  next.volume += sums.volume;
  sizes.push_back(std::sqrt(std::max(made.a.area, made.b.area)));
  next.patches.push_back(made);
  return {};
}

// Pairs of a known and a new patch in the order of their distance; each is taken once.
void ContactPatchQuery::State::recognize() {
  struct Candidate {
    double distance;
    std::uint32_t known, patch;
  };
  std::vector<Candidate> candidates;
  known_next.clear();
  for (std::uint32_t p = 0; p < next.patches.size(); ++p) {
    const ContactPatch& patch = next.patches[p];
    known_next.push_back({0xffffffffu, {}, sizes[p], axis_across(body[0]->transform(), patch.normal)});
    for (std::size_t k = 0; k < 2; ++k) {
      const RigidTransform& transform = body[k]->transform();
      known_next[p].centroid[k] = transform.inverse_rotate(patch.centroid - transform.translation);
    }
    for (std::uint32_t q = 0; q < known.size(); ++q) {
      const double gap = std::min(distance(known[q].centroid[0], known_next[p].centroid[0]),
                                  distance(known[q].centroid[1], known_next[p].centroid[1]));
      if (gap <= std::max(sizes[p], known[q].size)) candidates.push_back({gap, q, p});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& c, const Candidate& d) {
    return std::tie(c.distance, c.known, c.patch) < std::tie(d.distance, d.known, d.patch);
  });
  std::vector<bool> taken(known.size(), false);
  for (const Candidate& c : candidates) {
    KnownPatch& patch = known_next[c.patch];
    if (taken[c.known] || patch.id != 0xffffffffu) continue;
    taken[c.known] = true;
    patch.id = known[c.known].id;
    // The axis stays until it is too near the normal.
    const RigidTransform& transform = body[0]->transform();
    if (std::abs(transform.inverse_rotate(next.patches[c.patch].normal)[known[c.known].axis]) < 0.9)
      patch.axis = known[c.known].axis;
  }
}

void ContactPatchQuery::State::complete(std::uint32_t patch, const ContactPatchOptions& options) {
  ContactPatch& made = next.patches[patch];
  next.points_begin.push_back(next.points.size());
  if (made.normal == Vec3{} || (!options.depths && options.max_points == 0)) return;
  // The point on the axis of the wrench that is nearest to the centroid.
  const Vec3 arm = cross(made.a.area_vector, made.a.moment) / squared_length(made.a.area_vector);
  const Vec3 center = made.centroid - regions.origin() + arm;
  const PatchFrame frame = frame_of(body[0]->transform(), known_next[patch].axis, made.normal, center);
  for (std::size_t k = 0; k < 2; ++k) projected[k].read(regions, k, patch, frame);
  if (options.depths) made.depth = depth.of(projected[0], projected[1]);
  if (options.max_points > 0)
    points.add(projected[0], projected[1], frame, options.max_points,
               {-made.a.area_vector, cross(arm, made.a.area_vector) - made.a.moment}, {body[0], body[1]},
               regions.origin(), next.points);
}

ContactPatchQuery::ContactPatchQuery(const Collider& a, const Collider& b) {
  const StandardFloats standard;
  state_ = std::make_unique<State>(a, b);
}
ContactPatchQuery::ContactPatchQuery(const Collider& body) {
  const StandardFloats standard;
  state_ = std::make_unique<State>(body);
}
ContactPatchQuery::~ContactPatchQuery() = default;
ContactPatchQuery::ContactPatchQuery(ContactPatchQuery&&) noexcept = default;
ContactPatchQuery& ContactPatchQuery::operator=(ContactPatchQuery&&) noexcept = default;

Status ContactPatchQuery::run(const ContactPatchOptions& options) {
  const StandardFloats standard;
  State& s = *state_;
  if (const Status status = status_of_pair(*s.body[0], *s.body[1], {.positions = true}); !status) return status;
  if (options.max_points > 16) return {Status::Code::bad_option};
  ObjectCall own(s, CallKind::begins);
  if (!own.status()) return own.status();
  const PairAsRead read(*s.body[0], *s.body[1]);
  const Status found = s.find(options);
  const Status status = found ? read.status() : found;
  if (status) {
    for (KnownPatch& patch : s.known_next)
      if (patch.id == 0xffffffffu) patch.id = s.next_id++;
    for (std::size_t i = 0; i < s.next.patches.size(); ++i) s.next.patches[i].id = s.known_next[i].id;
    std::swap(s.result, s.next);
    std::swap(s.known, s.known_next);
  }
  own.finish(status);
  return status;
}

std::span<const ContactPatch> ContactPatchQuery::patches() const {
  return state_->result.patches;
}
double ContactPatchQuery::volume() const {
  return state_->result.volume;
}
bool ContactPatchQuery::certified() const {
  return state_->result.certified;
}

}  // namespace morula
