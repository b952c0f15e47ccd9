// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Two small bodies that deform and collide: their trees are built, their spheres updated in every way, and every query
// is held against brute force.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/distance.hpp>
#include <morula/generators/build.hpp>
#include <morula/update/skin_morphs.hpp>
#include <set>
#include <stdexcept>

#include "fuzz.hpp"
#include "small_bodies.hpp"

namespace morula::fuzz {
namespace {

using Point = std::array<long double, 3>;

Point point(const Vec3& p) {
  return {p.x, p.y, p.z};
}
Point operator-(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
long double product(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point along(const Point& p, const Point& d, long double t) {
  return {p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]};
}
long double length(const Point& d) {
  return std::sqrt(product(d, d));
}

// Distances of two triangles, from above: the vertices and edges of one against points of the other that come nearer
// step by step. Any pair of points bounds the distance, so rounding costs nothing but tightness.
long double upper_bound(const Triangle& a, const Triangle& b) {
  long double least = std::numeric_limits<long double>::infinity();
  const auto point_to_segment = [](const Point& p, const Point& q, const Point& r) {
    const Point d = r - q;
    const long double squared = product(d, d);
    const long double t = squared > 0 ? std::clamp(product(p - q, d) / squared, 0.0L, 1.0L) : 0.0L;
    return along(q, d, t);
  };
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const Point q0 = point(b[j]), q1 = point(b[(j + 1) % 3]);
      Point p = point(a[i]);
      const Point p0 = p, p1 = point(a[(i + 1) % 3]);
      for (int round = 0; round < 8; ++round) {
        const Point q = point_to_segment(p, q0, q1);
        least = std::min(least, length(p - q));
        p = point_to_segment(q, p0, p1);
        least = std::min(least, length(p - q));
      }
    }
  return least;
}

struct Side {
  Mesh mesh;
  std::shared_ptr<const CoveredTree> model;
  std::unique_ptr<Body> body, twin;  // the twin is always updated in full
  std::unique_ptr<Collider> collider;
  std::vector<Vec3> positions;
  bool covers = false;
};

Modes modes_of(const Mesh& mesh) {
  Modes modes{mesh.vertex_count(), 2, {}};
  for (const Vec3& p : mesh.positions) modes.displacements.push_back({p.y, 0.25 * p.x, 0});
  for (const Vec3& p : mesh.positions) modes.displacements.push_back({0.5 * p.z * p.z, 1, -p.x});
  return modes;
}

// Two bones; the weights run along x.
Skin skin_of(const Mesh& mesh) {
  Skin skin{.bone_count = 2, .begin = {0}};
  for (const Vec3& p : mesh.positions) {
    const double share = std::clamp(0.5 + p.x, 0.0, 1.0);
    skin.bones.insert(skin.bones.end(), {0, 1});
    skin.weights.insert(skin.weights.end(), {1 - share, share});
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

bool is_covering(const UpdateOptions& options) {
  if (options.conservative) return true;
  return std::all_of(options.rules.begin(), options.rules.end(),
                     [](Rule r) { return r == Rule::exact || r == Rule::wrapped || r == Rule::modal; });
}

// Nothing for a mesh, tree or body that is refused.
std::unique_ptr<Side> side_of(Bytes& in, bool only_exact) {
  auto side = std::make_unique<Side>();
  BuildOptions build_options;
  build_options.method = std::array{Method::octree, Method::grid, Method::octree, Method::optimized}[in.below(4)];
  build_options.quality = Quality::draft;
  build_options.branching = static_cast<int>(2 + in.below(9));
  build_options.depth = static_cast<int>(in.below(4));
  UpdateOptions options;
  if (const std::size_t rules = only_exact ? 0 : in.below(4); rules > 0) {
    options.rules.clear();
    for (std::size_t i = 0; i < rules; ++i) options.rules.push_back(all_rules()[in.below(all_rules().size())]);
    options.conservative = in.flag();
  }
  side->mesh = mesh_of(in);
  if (is_extreme(side->mesh.positions)) return nullptr;
  const bool is_modal = std::count(options.rules.begin(), options.rules.end(), Rule::modal) > 0;
  const bool is_skinned = std::count(options.rules.begin(), options.rules.end(), Rule::skinned) > 0;
  try {
    side->model = std::make_shared<CoveredTree>(build(side->mesh, build_options));
    if (is_modal) options.modes = modes_of(side->mesh);
    if (is_skinned) options.skin = skin_of(side->mesh);
    if (is_skinned && in.flag()) options.modes = modes_of(side->mesh);
    side->body = std::make_unique<Body>(side->mesh, side->model, options);
  } catch (const std::invalid_argument&) {
    return nullptr;
  }
  side->twin = std::make_unique<Body>(*side->body);
  side->covers = is_covering(options);
  side->positions = side->mesh.positions;
  side->collider = std::make_unique<Collider>(side->mesh, *side->body);
  return side;
}

void require_side_covers(const Side& side) {
  std::vector<Sphere> spheres;
  side.body->copy_spheres(spheres);
  for (const Sphere& s : spheres)
    require(is_finite(s.center) && std::isfinite(s.radius) && s.radius >= 0, "a sphere is not finite");
  if (!side.covers) return;
  require(certify(side.body->cover(), side.positions, spheres).covered, "the spheres do not cover");
  require_cover(side.mesh, side.positions, side.body->rest_tree(), spheres);
}

// Moves the vertices, all or some; the result may be anything, finite or not.
VertexRange move(Bytes& in, std::vector<Vec3>& positions, const std::vector<Vec3>& rest) {
  const auto count = static_cast<std::uint32_t>(positions.size());
  const auto small = [&] { return (static_cast<double>(in.byte()) - 128) / 16; };
  VertexRange range{0, count};
  switch (in.below(7)) {
    case 0:
      positions = rest;
      break;
    case 1: {  // by a matrix, which may be flat or turn inside out
      std::array<Vec3, 3> rows;
      for (Vec3& row : rows) row = {small(), small(), small()};
      for (Vec3& p : positions) p = {dot(rows[0], p), dot(rows[1], p), dot(rows[2], p)};
      break;
    }
    case 2: {  // along one axis
      const double factor = small();
      for (Vec3& p : positions) p.x *= factor;
      break;
    }
    case 3: {  // some vertices anywhere
      range.begin = static_cast<std::uint32_t>(in.below(count + 1));
      range.end = std::min(count, range.begin + static_cast<std::uint32_t>(in.below(8)));
      for (std::uint32_t v = range.begin; v < range.end; ++v) positions[v] = {small(), small(), small()};
      break;
    }
    case 4: {  // all by one offset
      const Vec3 offset{small(), small(), small()};
      const double scale = std::ldexp(1.0, static_cast<int>(in.below(40)));
      for (Vec3& p : positions) p += scale * offset;
      break;
    }
    case 5: {  // all to one place
      const Vec3 place{small(), small(), small()};
      for (Vec3& p : positions) p = place;
      break;
    }
    default:  // one vertex to any number
      if (count == 0) break;
      range.begin = static_cast<std::uint32_t>(in.below(count));
      range.end = range.begin + 1;
      positions[range.begin] = {in.float64(), in.float64(), static_cast<double>(in.float32())};
  }
  return range;
}

void reach_all(Body& body) {
  const auto nodes = static_cast<std::uint32_t>(body.rest_tree().node_count());
  for (std::uint32_t node = 0; node < nodes; ++node)
    if (!body.rest_tree().is_leaf(node)) body.refresh_children(node);
}

void update(Bytes& in, Side& side) {
  Body& body = *side.body;
  const std::size_t way = in.below(4);
  const bool is_skinned = !body.options().skin.empty(), is_modal = !is_skinned && !body.options().modes.empty();
  const std::uint64_t before = body.hash();
  std::vector<Vec3> positions = side.positions;
  UpdateStatus status;
  if (is_modal) {
    const std::array coordinates{static_cast<double>(in.byte()) / 64 - 2, way == 3 ? in.float64() : 0.5};
    move_by_modes(body.options().modes, side.mesh.positions, coordinates, positions);
    status = way == 2 ? body.update_modal_lazily(coordinates, in.below(3)) : body.update_modal(coordinates);
    if (status && way == 2) reach_all(body);
    require(side.twin->update_modal(coordinates).code == status.code, "two ways to update end differently");
  } else if (is_skinned) {
    std::array<AffineTransform, 2> transforms;
    for (AffineTransform& t : transforms)
      for (Vec3* v : {&t.columns[0], &t.columns[1], &t.translation})
        *v = {in.byte() / 64.0 - 2, in.byte() / 64.0 - 2, way == 3 ? in.float64() : 0.5};
    std::vector<double> morphs(body.options().modes.mode_count);
    for (double& q : morphs) q = way == 2 ? 0 : way == 3 ? in.float64() : in.byte() / 64.0 - 2;
    move_by_skin(body.options().skin, body.options().modes, side.mesh.positions, transforms, morphs, positions);
    status = body.update_skinned(transforms, morphs);
    const UpdateStatus other =
        way == 2 ? side.twin->update_skinned(transforms) : side.twin->update_skinned(transforms, morphs);
    require(other.code == status.code, "two ways to update end differently");
  } else {
    const VertexRange range = move(in, positions, side.mesh.positions);
    if (way == 1) {
      status = body.update(positions, std::span(&range, 1));
    } else if (way == 2) {
      status = body.update_lazily(positions, in.below(3));
      if (status) reach_all(body);
    } else if (way == 3) {
      status = body.update(std::span<const Vec3>(positions).first(in.below(positions.size() + 1)));
      if (status.code == UpdateStatus::Code::wrong_vertex_count) {
        require(body.hash() == before, "a refused update changed the spheres");
        status = body.update(positions);
      }
    } else {
      status = body.update(positions);
    }
    require(side.twin->update(positions).code == status.code, "two ways to update end differently");
  }
  if (!status) {
    require(body.hash() == before && !body.is_current(), "a refused update changed the spheres");
    return;
  }
  side.positions = std::move(positions);
  side.collider->set_positions(side.positions);
  require(body.hash() == side.twin->hash(), "two ways to update give different spheres");
  require_side_covers(side);
}

void place(Bytes& in, Side& side) {
  const auto small = [&] { return (static_cast<double>(in.byte()) - 128) / 32; };
  const double w = small(), x = small(), y = small(), z = small();
  side.collider->set_transform(RigidTransform::from_quaternion(w, x, y, z, {small(), small(), small()}));
}

bool holds(const Collider& collider, std::uint32_t node, std::uint32_t facet) {
  const auto facets = collider.facets(node);
  return std::find(facets.begin(), facets.end(), facet) != facets.end();
}

// The crossing's facets are both in a pair of nodes that is reported.
void require_found(const Side& a, const Side& b, const std::vector<Crossing>& truth, const Contacts& contacts) {
  for (const Crossing& c : truth)
    require(std::any_of(contacts.contacts.begin(), contacts.contacts.end(),
                        [&](const Contact& contact) {
                          return holds(*a.collider, contact.node_a, c.facet_a) &&
                                 holds(*b.collider, contact.node_b, c.facet_b);
                        }),
            "a crossing is in no contact");
}

void ask(Bytes& in, const Side& a, const Side& b) {
  const std::vector<Crossing> truth = brute_force::crossings(*a.collider, *b.collider);
  const bool covers = a.covers && b.covers;
  const bool overlaps = overlap(*a.collider, *b.collider);
  CrossingQuery found_pairs;
  require(static_cast<bool>(found_pairs.run(*a.collider, *b.collider)), "a query was refused");
  CollideOptions options;
  options.find_crossings = in.flag();
  options.surfaces = in.flag();
  if (in.flag()) options.margin = static_cast<double>(in.byte()) / 64;
  if (in.flag()) options.level = 0;
  if (in.flag()) options.budget = Budget(static_cast<int>(in.byte()));
  options.priority = in.flag() ? Priority::level : Priority::overlap;
  Contacts contacts = collide(*a.collider, *b.collider, options);
  for (const Contact& c : contacts.contacts)
    require(is_finite(c.point) && std::isfinite(c.depth) && std::isfinite(c.error_bound), "a contact is not finite");
  const DistanceBounds bounds = distance(*a.collider, *b.collider);
  require(!std::isnan(bounds.lower) && !std::isnan(bounds.upper) && bounds.lower <= bounds.upper, "bounds cross");
  if (!covers) return;

  require(truth.empty() || overlaps, "bodies that cross do not overlap");
  const auto found = found_pairs.pairs();
  require(std::equal(truth.begin(), truth.end(), found.begin(), found.end()), "crossings are not those of brute force");
  require_found(a, b, truth, contacts);
  if (contacts.finished && options.find_crossings)
    require(std::equal(truth.begin(), truth.end(), contacts.crossings.begin(), contacts.crossings.end()),
            "collide finds other crossings than brute force");

  // An interrupted query, resumed to its end.
  ContactQuery query({.budget = Budget(static_cast<int>(in.byte()))});
  query.add(*a.collider, *b.collider);
  require(static_cast<bool>(query.start()), "a query was refused");
  for (int n = 0; n < 3; ++n) {
    require_found(a, b, truth, query.contacts());
    require(static_cast<bool>(query.resume()), "a query was refused");
  }
  require_found(a, b, truth, query.contacts());

  long double upper = truth.empty() ? std::numeric_limits<long double>::infinity() : 0.0L, largest = 0;
  for (std::uint32_t f = 0; f < a.mesh.facet_count(); ++f)
    for (std::uint32_t g = 0; g < b.mesh.facet_count(); ++g) {
      const Triangle s = a.collider->triangle(f), t = b.collider->triangle(g);
      for (const Triangle& triangle : {s, t})
        for (const Vec3& p : triangle)
          for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, static_cast<long double>(std::abs(p[axis])));
      upper = std::min(upper, upper_bound(s, t));
    }
  require(bounds.lower <= upper + largest * 0x1p-60L, "a lower bound of the distance is above the distance");
  if (!truth.empty()) require(bounds.lower == 0 && bounds.upper == 0, "surfaces that cross are apart");
}

}  // namespace
}  // namespace morula::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace morula::fuzz;
  Bytes in(data, size);
  const std::unique_ptr<Side> a = side_of(in, false);
  if (!a) return 0;
  require_side_covers(*a);
  const std::unique_ptr<Side> b = side_of(in, true);
  if (!b) return 0;
  require_side_covers(*b);
  for (int n = 0; n < 6; ++n) {
    switch (in.below(4)) {
      case 0:
        update(in, *a);
        break;
      case 1:
        update(in, *b);
        break;
      case 2:
        place(in, *b);
        break;
      default:
        place(in, *a);
    }
    if (in.flag() && a->body->is_current() && b->body->is_current()) ask(in, *a, *b);
    if (in.empty()) break;
  }
  return 0;
}
