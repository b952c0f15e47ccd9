// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "contacts.hpp"

#include <limits>
#include <morula/collide/contacts.hpp>
#include <morula/collide/distance.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <set>

namespace morula::properties {
namespace {

using oracle::LatticePoint;
using oracle::LatticeTriangle;
using oracle::Point;
using oracle::Real;
using oracle::Triangle;

Point point(const Vec3& v) {
  return {v.x, v.y, v.z};
}

std::vector<Triangle> world_facets(const Collider& c) {
  const RigidTransform& t = c.transform();
  std::vector<Triangle> facets;
  for (const Facet& f : c.mesh_facets()) {
    Triangle world;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point p = point(c.positions()[f[k]]);
      world[k] =
          Point{dot(point(t.rows[0]), p), dot(point(t.rows[1]), p), dot(point(t.rows[2]), p)} + point(t.translation);
    }
    facets.push_back(world);
  }
  return facets;
}

// Which facets a node has a part of, from the cover.
std::vector<std::vector<bool>> owned_facets(const Collider& c) {
  const Cover& cover = c.cover();
  std::vector<std::vector<bool>> owned(cover.region_begin.size(), std::vector<bool>(cover.facet_count));
  for (std::size_t node = 0; node < owned.size(); ++node)
    for (std::uint32_t p = cover.region_begin[node]; p < cover.region_end[node]; ++p)
      owned[node][cover.patch_facet[p]] = true;
  return owned;
}

// a - b without rounding?
bool is_exact_difference(Real a, Real b) {
  const Real difference = a - b, gone = difference - a;  // the error of a sum
  return (a - (difference - gone)) - (b + gone) == 0;
}

// As whole numbers, when all coordinates are multiples of one power of two and few enough of it.
bool on_lattice(const std::vector<Triangle>& from, const Point& origin, Real step, std::vector<LatticeTriangle>& to) {
  to.clear();
  for (const Triangle& t : from) {
    LatticeTriangle whole;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_exact_difference(t[k].x, origin.x) || !is_exact_difference(t[k].y, origin.y) ||
          !is_exact_difference(t[k].z, origin.z))
        return false;
      const Point p = (1 / step) * (t[k] - origin);
      whole[k] = {static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y), static_cast<std::int64_t>(p.z)};
      if (static_cast<Real>(whole[k].x) != p.x || static_cast<Real>(whole[k].y) != p.y ||
          static_cast<Real>(whole[k].z) != p.z)
        return false;
    }
    to.push_back(whole);
  }
  return true;
}

struct Extent {
  Point lower, upper;
  explicit Extent(std::span<const Point> points) : lower(points[0]), upper(points[0]) {
    for (const Point& p : points) {
      lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
      upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
    }
  }
  bool meets(const Extent& e) const {
    return lower.x <= e.upper.x && e.lower.x <= upper.x && lower.y <= e.upper.y && e.lower.y <= upper.y &&
           lower.z <= e.upper.z && e.lower.z <= upper.z;
  }
};

std::string pair_text(std::uint32_t a, std::uint32_t b) {
  return "facets " + std::to_string(a) + " and " + std::to_string(b);
}

}  // namespace

PairJudge::PairJudge(const Collider& a, const Collider& b, Dice& dice)
    : a_(a),
      b_(b),
      facets_a_(world_facets(a)),
      facets_b_(world_facets(b)),
      owned_a_(owned_facets(a)),
      owned_b_(owned_facets(b)) {
  std::vector<Point> all;
  Real largest = 0;
  for (const auto* facets : {&facets_a_, &facets_b_})
    for (const Triangle& t : *facets) all.insert(all.end(), t.begin(), t.end());
  for (const Point& p : all) largest = std::max(largest, largest_coordinate(p));
  for (const Collider* c : {&a, &b}) {
    largest = std::max(largest, largest_coordinate(point(c->transform().translation)));
    for (const Facet& f : c->mesh_facets())
      for (const std::uint32_t v : f) largest = std::max(largest, largest_coordinate(point(c->positions()[v])));
  }
  const Extent whole(all);
  const Real size = oracle::distance(whole.lower, whole.upper);
  const bool unplaced = a.transform() == RigidTransform{} && b.transform() == RigidTransform{};
  // Three products, three sums: each rounded to double by the library where a body is placed.
  error_ = unplaced ? 16 * oracle::epsilon * largest : 0x1p-49L * largest;
  const Real margin = 4 * std::sqrt(error_ * size) + 8 * error_;

  // A lattice of at most 2^20 steps on each side, if there is one. Placed vertices are rounded by the library, so they
  // have to be doubles here, too.
  std::vector<LatticeTriangle> lattice_a, lattice_b;
  if (size > 0) {
    const Real step = std::exp2(std::floor(std::log2(size)) - 18);
    const auto is_double = [](const Point& p) {
      return static_cast<Real>(static_cast<double>(p.x)) == p.x && static_cast<Real>(static_cast<double>(p.y)) == p.y &&
             static_cast<Real>(static_cast<double>(p.z)) == p.z;
    };
    exact_ = std::all_of(all.begin(), all.end(), is_double) && on_lattice(facets_a_, whole.lower, step, lattice_a) &&
             on_lattice(facets_b_, whole.lower, step, lattice_b);
    // A turn that is not one of the lattice's makes sums whose rounding we do not follow.
    for (const Collider* c : {&a, &b})
      for (const Vec3& row : c->transform().rows)
        for (const double x : {row.x, row.y, row.z}) exact_ = exact_ && (x == 0 || x == 1 || x == -1);
  }

  std::vector<Extent> extents_b;
  for (const Triangle& t : facets_b_) extents_b.emplace_back(t);
  for (std::uint32_t i = 0; i < facets_a_.size(); ++i) {
    const Extent extent(facets_a_[i]);
    for (std::uint32_t j = 0; j < facets_b_.size(); ++j) {
      if (!extent.meets(extents_b[j])) continue;
      auto at = oracle::clearly_crossing(facets_a_[i], facets_b_[j], margin);
      if (exact_ ? oracle::meet_exactly(lattice_a[i], lattice_b[j]) : at.has_value()) meetings_.push_back({i, j, at});
    }
  }
  // Pairs of points, one of each body, for margins: corners and points of facets.
  for (int n = 0; n < 60; ++n) {
    const std::size_t i = dice.below(facets_a_.size()), j = dice.below(facets_b_.size());
    const auto any = [&](const Triangle& t) {
      if (dice.chance(0.5)) return t[dice.below(3)];
      Real v = dice.uniform(), w = dice.uniform();
      if (v + w > 1) v = 1 - v, w = 1 - w;
      return t[0] + v * (t[1] - t[0]) + w * (t[2] - t[0]);
    };
    const Point p = any(facets_a_[i]), q = any(facets_b_[j]);
    near_.push_back(
        {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), Real(0.5) * (p + q), oracle::distance(p, q)});
  }
}

void PairJudge::judge_facets(Record& record) const {
  ++record.counts.poses_of_pairs;
  // Where both are, for what fails: relative to the first one's own place.
  record.place.second = {{}, {b_.mesh_facets().begin(), b_.mesh_facets().end()}};
  for (std::uint32_t v = 0; v < b_.vertex_count(); ++v) {
    const Vec3 p = b_.vertex(v) - a_.transform().translation;
    record.place.second.positions.push_back(a_.transform().inverse_rotate(p));
  }
  record.counts.exact_poses += exact_;
  record.counts.crossings += meetings_.size();
  if (!meetings_.empty())
    record.expect(overlap(a_, b_), "missed-overlap",
                  "overlap() says no, " + pair_text(meetings_[0].facet_a, meetings_[0].facet_b) + " meet");
  Real nearest = meetings_.empty() ? std::numeric_limits<Real>::infinity() : 0;
  for (const NearPair& n : near_) nearest = std::min(nearest, n.distance);
  const DistanceBounds bounds = distance(a_, b_, {.budget = 200});
  record.expect(static_cast<Real>(bounds.lower) <= nearest + 8 * error_, "missed-distance",
                "the lower bound is " + std::to_string(bounds.lower) + ", two points are " +
                    std::to_string(static_cast<double>(nearest)) + " apart");
  CrossingQuery found;
  const Status asked = found.run(a_, b_);
  record.expect(static_cast<bool>(asked), "refused-crossings", message(asked));
  judge_list(found.pairs(), record, "missed-crossing");
  judge_surfaces(record);
}

// Surface trees that follow the bodies: what is crossed is judged, what is near is compared with trees that were
// updated.
void PairJudge::judge_surfaces(Record& record) const {
  std::array<std::vector<Vec3>, 2> world;
  std::vector<SurfaceTree> following, updated;
  for (const Collider* c : {&a_, &b_}) {
    const MeshView now = c->surface();
    std::vector<Vec3>& vertices = world[following.size()];
    for (std::uint32_t v = 0; v < c->vertex_count(); ++v) vertices.push_back(c->vertex(v));
    // What is too small, large or far to make a tree of is no question here.
    try {
      following.emplace_back(now);
      updated.emplace_back(now);
    } catch (const std::invalid_argument&) {
      return;
    }
    if (!following.back().follow(*c) || !updated.back().update(vertices)) return;
  }
  ++record.counts.followed_pairs;
  SurfaceCrossingQuery crossings;
  const SurfaceQueryStatus status = crossings.run(following[0], following[1]);
  record.expect(status && status.finished, "refused-surfaces", message(status));
  std::vector<Crossing> listed;
  for (const FeaturePair& pair : crossings.pairs())
    listed.push_back({.facet_a = pair.a, .facet_b = pair.b, .segment = {}});
  judge_list(listed, record, "missed-surface-crossing");

  Real distance = std::numeric_limits<Real>::infinity();
  for (const NearPair& n : near_) distance = std::min(distance, n.distance);
  ProximityQuery near({.distance = static_cast<double>(distance)}),
      expected({.distance = static_cast<double>(distance)});
  record.expect(near.run(following[0], following[1]) && expected.run(updated[0], updated[1]), "refused-surfaces",
                "pairs of features within " + std::to_string(static_cast<double>(distance)));
  record.expect(std::equal(near.pairs().begin(), near.pairs().end(), expected.pairs().begin(), expected.pairs().end(),
                           [](const FeaturePair& p, const FeaturePair& q) { return p == q; }),
                "missed-surface-pair",
                std::to_string(near.pairs().size()) + " pairs of features within " +
                    std::to_string(static_cast<double>(distance)) + ", " + std::to_string(expected.pairs().size()) +
                    " of updated surfaces");
}

void PairJudge::judge_list(std::span<const Crossing> found, Record& record, const std::string& kind) const {
  std::set<std::pair<std::uint32_t, std::uint32_t>> listed, met;
  for (const Crossing& c : found) listed.insert({c.facet_a, c.facet_b});
  for (const Meeting& m : meetings_) {
    met.insert({m.facet_a, m.facet_b});
    record.expect(listed.contains({m.facet_a, m.facet_b}), kind,
                  pair_text(m.facet_a, m.facet_b) + " meet and are not listed");
  }
  for (const auto& [i, j] : listed) {
    const bool apart = exact_ ? !met.contains({i, j}) : oracle::clearly_apart(facets_a_[i], facets_b_[j], 8 * error_);
    record.expect(!apart, "false-crossing", pair_text(i, j) + " are listed and do not meet");
  }
}

void PairJudge::judge_contacts(const Contacts& contacts, std::uint32_t bodies, double margin, Record& record,
                               const std::string& when) const {
  ++record.counts.interruptions;
  // The bound is about real numbers; points and middles are ours, rounded by less than this.
  const Real slack = 8 * error_;
  const auto held = [&](std::uint32_t i, std::uint32_t j, const std::optional<Point>& at) {
    for (const Contact& c : contacts.contacts) {
      if (c.pair != bodies || !owned_a_[c.node_a][i] || !owned_b_[c.node_b][j]) continue;
      if (!at || oracle::distance(point(c.point), *at) <= c.error_bound + slack) return true;
    }
    return false;
  };
  for (const Meeting& m : meetings_)
    if (!held(m.facet_a, m.facet_b, m.at)) {
      record.fail("missed-contact", pair_text(m.facet_a, m.facet_b) + " meet outside of " +
                                        std::to_string(contacts.contacts.size()) + " contacts, " + when);
      break;
    }
  for (const NearPair& n : near_) {
    if (n.distance + 8 * error_ > margin) continue;
    ++record.counts.near_pairs;
    if (!held(n.facet_a, n.facet_b, n.middle)) {
      record.fail("missed-margin", pair_text(n.facet_a, n.facet_b) + " come nearer than the margin outside of " +
                                       std::to_string(contacts.contacts.size()) + " contacts, " + when);
      break;
    }
  }
}

void PairJudge::judge_listed(const Contacts& contacts, std::uint32_t bodies, Record& record) const {
  judge_list(std::span(contacts.crossings)
                 .subspan(contacts.crossings_begin[bodies],
                          contacts.crossings_begin[bodies + 1] - contacts.crossings_begin[bodies]),
             record, "missed-listed");
}

RigidTransform touching_transform(const Collider& a, const Collider& b, Dice& dice, bool on_lattice) {
  const auto any_point = [&](const Collider& c) {
    const Facet& f = c.mesh_facets()[dice.below(c.mesh_facets().size())];
    const Vec3 p = c.positions()[f[dice.below(3)]];
    return dice.chance(0.6) ? p : (p + c.positions()[f[dice.below(3)]]) * 0.5;
  };
  // Where cover is lost first: a corner of a patch, or close to one.
  const auto any_corner = [&](const Collider& c) {
    const Cover& cover = c.cover();
    const auto corners = cover.patch(dice.below(cover.patch_count()));
    const std::size_t first = dice.below(corners.size());
    const Vec3 p = corner_position(cover, corners[first], c.positions());
    const Vec3 q = corner_position(cover, corners[(first + 1) % corners.size()], c.positions());
    const Vec3 r = corner_position(cover, corners[(first + 2) % corners.size()], c.positions());
    const double towards = dice.pick({0.0, 1e-6, 1e-3, 0.05});
    return p + ((q + r) * 0.5 - p) * towards;
  };
  RigidTransform t;
  switch (dice.below(on_lattice ? 3 : 4)) {
    case 0:
      break;
    case 1:
      t.rows = {Vec3{0, -1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
      break;
    case 2:
      t.rows = {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};
      break;
    default: {
      const double w = dice.uniform(-1, 1), x = dice.uniform(-1, 1), y = dice.uniform(-1, 1), z = dice.uniform(-1, 1);
      t = RigidTransform::from_quaternion(w, x, y, z);
    }
  }
  const Vec3 on_a = a.transform()(!on_lattice && dice.chance(0.5) ? any_corner(a) : any_point(a));
  const Vec3 on_b = any_point(b);
  t.translation = on_a - t.rotate(on_b);
  const double size = max_norm(t.translation);
  if (on_lattice && size > 0) {
    // 2^-12: fine enough for most lattices to keep what touches, coarse enough for whole numbers.
    const double step = std::exp2(std::ceil(std::log2(size)) - 12);
    for (int k = 0; k < 3; ++k) t.translation[k] = std::round(t.translation[k] / step) * step;
  }
  return t;
}

}  // namespace morula::properties
