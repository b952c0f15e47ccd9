// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/collide/primitives.hpp>
#include <morula/geometry/connectivity.hpp>
#include <morula/surface/haptic_probe.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "surface/haptic/half_spaces.hpp"
#include "surface/haptic/proxy_contacts.hpp"
#include "surface/haptic/proxy_start.hpp"
#include "surface/haptic/surface_follower.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t reserved_probe_moves = 256;  // moves whose places are reserved before the first step

void require_haptic_number(double value, const char* name) {
  if (!(value >= 0) || !std::isfinite(value))
    throw std::invalid_argument(std::string("HapticOptions::") + name + " must be finite and at least 0, not " +
                                std::to_string(value));
}

const HapticOptions& usable(const HapticOptions& options) {
  require_haptic_number(options.radius, "radius");
  require_haptic_number(options.stiffness, "stiffness");
  require_haptic_number(options.friction, "friction");
  if (options.skin) {
    require_haptic_number(*options.skin, "skin");
    if (*options.skin == 0) throw std::invalid_argument("HapticOptions::skin must be more than 0");
  }
  if (options.max_moves == 0) throw std::invalid_argument("HapticOptions::max_moves must be 1 or more");
  return options;
}

/// Facets around vertices, for their normals.
class VertexNormals {
 public:
  void start(const Collider& body) {
    const Connectivity surface = connectivity(body.surface());
    begin_ = surface.fan_begin, facets_ = surface.fan_facets;
  }
  /// The unit normal at a point of a facet on the side of `side`; `side` itself where the two have no acute angle.
  Vec3 at(const Collider& body, const ProxyContact& contact) const {
    const Facet& f = body.mesh_facets()[contact.facet];
    Vec3 sum;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 around;
      for (std::uint32_t i = begin_[f[k]]; i < begin_[f[k] + 1]; ++i) around += area_vector(body.triangle(facets_[i]));
      sum += contact.barycentric[k] * normalized(around, Vec3{});
    }
    const Vec3 normal = normalized(sum, Vec3{});
    if (dot(area_vector(body.triangle(contact.facet)), contact.normal) < 0)
      return dot(normal, contact.normal) < 0 ? -normal : contact.normal;
    return dot(normal, contact.normal) > 0 ? normal : contact.normal;
  }

 private:
  std::vector<std::uint32_t> begin_, facets_;
};

}  // namespace

struct HapticProbe::State {
  explicit State(const HapticOptions& given) : options(usable(given)) {}

  HapticStep step(const Collider& placed, const Vec3& device);
  Status start(const Collider& body, const Vec3& goal, const Status& usable_so_far);
  void follow(const Collider& body, HapticStep& result);
  void approach(const Collider& body, const Vec3& goal, HapticStep& result);
  bool leave_surface(const Collider& body, HapticStep& result);
  NearestKept nearest_with_most_room(const Vec3& goal);
  NearestKept wanted(const Vec3& goal);
  Vec3 free_end(const Vec3& move, double share) const;
  double move_freely(const Collider& body, const Vec3& move, HapticStep& result);
  template <class Shape>
  bool gather(const Collider& body, const Shape& shape, HapticStep& result);
  Vec3 force_on_device(const Collider& body, const Vec3& goal, const NearestKept& held) const;

  HapticOptions options;
  std::optional<Collider> resting;  // the body of the present step, without its transform
  bool is_started = false;
  bool is_off_surface = false;  // false: the start has found no place beside the surface; the next step starts again
  Vec3 center;                  // in the body's coordinates
  double skin = 0;
  SurfaceFollower surface;
  VertexNormals normals;
  TouchQuery touch;
  std::vector<NearFacet> near;
  std::vector<ProxyContact> contacts;
  std::vector<KeptSide> sides;
  double room = 0;  // distance that the wanted point keeps: rest, or less where that is impossible
  std::vector<Vec3> path;
  NearestKept last_wanted;  // the planes that hold the proxy at the end of the step

  KeptDistances kept() const { return {options.radius, skin}; }
};

// Everything that may throw precedes the change of is_started.
Status HapticProbe::State::start(const Collider& body, const Vec3& goal, const Status& usable_so_far) {
  using Code = Status::Code;
  if (!usable_so_far) return usable_so_far;
  const bool is_same =
      is_started && surface.vertex_count() == body.vertex_count() && surface.facet_count() == body.mesh_facets().size();
  if (is_started && !is_same) return {Code::other_bodies};
  const Sphere root = body.sphere_state().sphere(0);
  const double size = max_norm(root.center) + root.radius;
  const double wanted_skin = is_started ? skin : options.skin.value_or(std::max(0x1p-20 * root.radius, 0x1p-22 * size));
  // The normal of a contact has an error of about 2^-53 of the size over the skin. With a skin of 2^-27 of the size, a
  // move along a facet has passed through it; from 2^-26 on, none has.
  if (!(wanted_skin > 0x1p-24 * size)) return {Code::bad_option};
  if (is_started) {
    if (!is_off_surface) center = goal;
    return {};
  }
  surface.start(body);
  if (options.smooth_normals) normals.start(body);
  path.reserve(std::min(options.max_moves, reserved_probe_moves) + 3);
  skin = wanted_skin, center = goal, is_started = true, is_off_surface = false;
  return {};
}

// Lists the facets that touch the shape. False for a shape that the query rejects.
template <class Shape>
bool HapticProbe::State::gather(const Collider& body, const Shape& shape, HapticStep& result) {
  const Touch& found = touch.run(body, shape, {.collect_all = true});
  result.sphere_tests += found.sphere_tests, result.facet_tests += found.facet_tests;
  near.clear();
  for (const TouchingFacet& facet : found.facets) near.push_back({facet.point.facet, body.triangle(facet.point.facet)});
  return bool(found.status);
}

void HapticProbe::State::follow(const Collider& body, HapticStep& result) {
  const auto followed = surface.follow(body, touch, center, kept());
  result.sphere_tests += surface.sphere_tests(), result.facet_tests += surface.facet_tests();
  if (!followed.moved) return;
  if (is_off_surface) center = followed.center, result.jammed = followed.jammed;
  surface.accept(body);
}

// Moves a center that starts on the surface, or hardly off it, to a place that has room. False if there is none.
bool HapticProbe::State::leave_surface(const Collider& body, HapticStep& result) {
  is_off_surface = std::none_of(contacts.begin(), contacts.end(),
                                [&](const ProxyContact& contact) { return contact.distance < skin / 64; });
  if (is_off_surface) return true;
  const std::optional<Vec3> place = place_beside(body, touch, contacts, center, kept());
  result.jammed = !place;
  if (!place) return false;
  center = *place, is_off_surface = true;
  path.push_back(center), ++result.moves;
  if (!gather(body, Sphere{center, kept().touching}, result)) return false;
  find_contacts(near, center, kept(), contacts);
  return true;
}

// The nearest point that keeps as much distance from all contacts as is possible, by bisection between the distance of
// the nearest one, at which the center is, and `rest`.
NearestKept HapticProbe::State::nearest_with_most_room(const Vec3& goal) {
  double least = kept().rest;
  for (const ProxyContact& contact : contacts) least = std::min(least, contact.distance);
  const double tolerance = std::min(skin, least) / 64;
  const auto at = [&](double share, const Vec3& toward) {
    room = least + share * (kept().rest - least);
    for (std::size_t k = 0; k < contacts.size(); ++k) sides[k].offset = room - contacts[k].distance;
    return nearest_kept(toward, sides, tolerance);
  };
  double possible = 0, impossible = 1;
  for (int k = 0; k < 10; ++k) {
    const double share = 0.5 * (possible + impossible);
    (at(share, {}).exists ? possible : impossible) = share;
  }
  return at(possible, goal);
}

// The point to which the proxy is to go: nearest to the goal beyond the planes of contact. With friction it stays as
// long as the goal is in the friction cone, and else stops where the cone reaches it [ruspini1997].
//
// The rounding of a goal far away may exceed the skin. It is replaced by a nearer one in its direction; a center is at
// rest for both or for neither.
NearestKept HapticProbe::State::wanted(const Vec3& goal) {
  const double tolerance = skin / 64, farthest = 0x1p38 * skin, distance_to_goal = length(goal - center);
  // mutant haptic-far-goal: `distance_to_goal > farthest` -> `false`
  const double scale = distance_to_goal > farthest ? farthest / distance_to_goal : 1;
  const Vec3 toward = scale * (goal - center);
  room = kept().rest;
  sides.clear();
  for (const ProxyContact& contact : contacts) sides.push_back({contact.normal, room - contact.distance});
  const bool is_too_near = std::any_of(contacts.begin(), contacts.end(),
                                       [&](const ProxyContact& contact) { return contact.distance < room - skin / 4; });
  NearestKept nearest = nearest_kept(is_too_near ? Vec3{} : toward, sides, tolerance);
  if (nearest.exists && is_too_near) return nearest;
  // mutant haptic-no-room: `!nearest.exists` -> `false`
  if (!nearest.exists) nearest = nearest_with_most_room(toward);
  if (!nearest.exists) nearest.point = Vec3{};
  if (!nearest.exists) return nearest;
  if (options.friction > 0 && nearest.active_count > 0) {
    const double pressure = length(nearest.point - toward);
    const NearestKept here = nearest_kept(Vec3{}, sides, tolerance);
    const Vec3 slide = nearest.point - here.point;
    const double way = length(slide), held = options.friction * pressure;
    nearest.point = here.exists && way > held ? here.point + slide * ((way - held) / way) : here.point;
  }
  if (nearest.active_count == 0) nearest.point = goal - center;
  for (double& weight : nearest.weight) weight /= scale;
  return nearest;
}

// The end of the free share of a move, whose facets are in `near`. The share is computed with rounding, the test of the
// segment is exact: while it meets a facet it is halved.
Vec3 HapticProbe::State::free_end(const Vec3& move, double share) const {
  for (int halvings = 0; halvings < 8; ++halvings, share /= 2) {
    const Vec3 end = share < 1 ? center + share * move : center + move;
    if (!meets_a_facet(near, center, end)) return end;
  }
  return center;
}

// The share of a move that is free, 0 to 1, with the facets near it in `near`.
//
// All facets are in the root's sphere, so of a long move only the part that can meet it is tested. Points of a move
// from far away, and their distances, are off by less than `pad`: such a move keeps that much more distance, and the
// next one starts nearby. For a center near the body the pad is below 2^-44 of its size, which is less than 2^-8 of the
// skin.
double HapticProbe::State::move_freely(const Collider& body, const Vec3& move, HapticStep& result) {
  const Sphere root = body.sphere_state().sphere(0);
  const double reach = 2 * (distance(center, root.center) + root.radius + kept().touching), way = length(move);
  const double tested = way > reach ? reach / way : 1;
  const double pad = 0x1p-48 * (max_norm(center) + reach);
  // mutant haptic-far-pad: `(pad > skin / 64 ? pad : 0)` -> `0.0 * pad`
  const double lost = kept().rest - room;
  const KeptDistances distances(std::max(0.0, options.radius - lost) + (pad > skin / 64 ? pad : 0),
                                std::min(skin, room));
  const Vec3 part = tested * move;
  // mutant haptic-thin-capsule: `distances.touching` -> `0.0`
  if (!gather(body, Capsule{center, center + part, distances.touching + lost}, result)) return 0;
  const double share = free_share(near, center, part, distances);
  return share < 1 ? share * tested : 1;
}

void HapticProbe::State::approach(const Collider& body, const Vec3& goal, HapticStep& result) {
  const double least_move = skin / 64;
  contacts.clear(), last_wanted = {};
  if (!gather(body, Sphere{center, kept().touching}, result)) return;
  find_contacts(near, center, kept(), contacts);
  if (!is_off_surface && !leave_surface(body, result)) return;
  for (;; ++result.moves) {
    last_wanted = wanted(goal);
    const Vec3 move = last_wanted.point;
    result.settled = last_wanted.exists && length(move) <= least_move;
    if (result.settled || !last_wanted.exists || result.moves >= options.max_moves) return;
    const Vec3 end = free_end(move, move_freely(body, move, result));
    if (end == center) return;
    center = end;
    path.push_back(center);
    find_contacts(near, center, kept(), contacts);
  }
}

// In a settled contact without friction, proxy − goal is the sum of weight × normal over the planes that hold the
// proxy.
Vec3 HapticProbe::State::force_on_device(const Collider& body, const Vec3& goal, const NearestKept& held) const {
  Vec3 reach = center - goal;
  if (options.smooth_normals && held.exists)
    for (std::size_t k = 0; k < held.active_count; ++k) {
      const ProxyContact& contact = contacts[held.active[k]];
      reach += held.weight[k] * (normals.at(body, contact) - contact.normal);
    }
  return options.stiffness * reach;
}

HapticStep HapticProbe::State::step(const Collider& placed, const Vec3& device) {
  HapticStep result;
  result.status = askable(placed);
  if (result.status && !(is_finite(device) && max_norm(device) < 0x1p200)) result.status = {Status::Code::bad_shape};
  if (!result.status) return result;
  // In its own coordinates a body that moves rigidly rests, and the device point moves instead.
  if (resting) {
    *resting = placed;
  } else {
    resting.emplace(placed);
  }
  Collider& body = *resting;
  body.set_transform({});
  const RigidTransform& transform = placed.transform();
  const Vec3 goal = transform.inverse_rotate(device - transform.translation);
  result.status = start(body, goal, result.status);
  if (!result.status) return result;
  result.certified = body.sphere_state().covers;
  path.clear();
  path.push_back(center);
  follow(body, result);
  path.push_back(center);
  approach(body, goal, result);
  const auto nearest = std::min_element(contacts.begin(), contacts.end(),
                                        [](const auto& a, const auto& b) { return a.distance < b.distance; });
  if (nearest != contacts.end()) {
    result.touches = true;
    result.contact = SurfacePoint{nearest->facet, nearest->barycentric, transform(nearest->point)};
    result.normal = transform.rotate(nearest->normal);
  }
  result.proxy = transform(center);
  result.force = transform.rotate(force_on_device(body, goal, last_wanted));
  return result;
}

HapticProbe::HapticProbe(HapticOptions options) : state_(std::make_unique<State>(options)) {}
HapticProbe::~HapticProbe() = default;
HapticProbe::HapticProbe(HapticProbe&&) noexcept = default;
HapticProbe& HapticProbe::operator=(HapticProbe&&) noexcept = default;

const HapticOptions& HapticProbe::options() const {
  return state_->options;
}

HapticStep HapticProbe::step(const Collider& body, const Vec3& device) {
  const StandardFloats standard;
  return state_->step(body, device);
}

void HapticProbe::reset() {
  state_->is_started = false;
  state_->resting.reset();
  state_->path.clear();
}

std::span<const Vec3> HapticProbe::path() const {
  return state_->path;
}

}  // namespace morula
