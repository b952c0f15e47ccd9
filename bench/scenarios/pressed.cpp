// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario pressed: contacts for a solver, from contact patches, contacts of spheres with surfaces, and Bullet. A box
// and a ball are pressed into a plate, a capsule into a groove, the mesh into a copy that lies across it. Depths and
// normals are compared with known ones; for the mesh with the area vector of the loop of crossings, and the translation
// along it at which the crossings end.
#include <algorithm>
#include <cmath>
#include <functional>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/geometry/box.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <numbers>

#include "peers.hpp"
#include "resources.hpp"
#include "scenario.hpp"

namespace morula::bench {
namespace {

/// A known contact: the normal from b to a, and the least translation of a along it.
struct Wall {
  Vec3 normal;
  double depth;
};
struct Pressed {
  RigidTransform place;  // of a
  std::vector<Wall> walls;
};
struct Case {
  std::string name;
  Mesh a, b;
  bool is_convex;  // a
  std::vector<Pressed> poses{};
  std::vector<RigidTransform> slide{};
};

Mesh box(const Vec3& lower, const Vec3& upper) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 8; ++i)
    mesh.positions.push_back({i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z});
  mesh.facets = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {1, 3, 7}, {1, 7, 5}, {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6}};
  return mesh;
}

Mesh ball(std::uint32_t around, std::uint32_t rings) {
  Mesh mesh{{{0, 0, -1}}, {}};
  for (std::uint32_t r = 1; r < rings; ++r)
    for (std::uint32_t k = 0; k < around; ++k) {
      const double polar = std::numbers::pi * r / rings, angle = 2 * std::numbers::pi * k / around;
      mesh.positions.push_back(
          {std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), -std::cos(polar)});
    }
  mesh.positions.push_back({0, 0, 1});
  const auto top = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t k = 0; k < around; ++k) {
    const std::uint32_t n = (k + 1) % around;
    mesh.facets.push_back({0, 1 + n, 1 + k});
    mesh.facets.push_back({top, top - around + k, top - around + n});
    for (std::uint32_t r = 0; r + 2 < rings; ++r) {
      const std::uint32_t low = 1 + r * around, high = low + around;
      mesh.facets.push_back({low + k, low + n, high + n});
      mesh.facets.push_back({low + k, high + n, high + k});
    }
  }
  return mesh;
}

/// A prism along x with a groove of a right angle, its lowest line at z = 0.
Mesh groove() {
  Mesh mesh;
  for (const double x : {-3.0, 3.0})
    for (const Vec3& p :
         {Vec3{0, -2, -1}, Vec3{0, 2, -1}, Vec3{0, 2, 1}, Vec3{0, 1, 1}, Vec3{}, Vec3{0, -1, 1}, Vec3{0, -2, 1}})
      mesh.positions.push_back(p + Vec3{x, 0, 0});
  for (std::uint32_t i = 0; i < 7; ++i) {
    const std::uint32_t j = (i + 1) % 7;
    mesh.facets.push_back({i, j, i + 7});
    mesh.facets.push_back({j, j + 7, i + 7});
  }
  for (const Facet& f : {Facet{0, 1, 4}, Facet{1, 2, 3}, Facet{1, 3, 4}, Facet{0, 4, 5}, Facet{0, 5, 6}}) {
    mesh.facets.push_back({f[2], f[1], f[0]});
    mesh.facets.push_back({f[0] + 7, f[1] + 7, f[2] + 7});
  }
  return mesh;
}

constexpr double pressings[] = {1e-3, 1e-2, 0.05};
constexpr int slide_steps = 400;

Case box_on_plate() {
  Case c{"box on plate", box({-0.5, -0.5, 0}, {0.5, 0.5, 1}), box({-2, -2, -0.2}, {2, 2, 0}), true};
  for (const double depth : pressings)
    for (int i = 0; i < 20; ++i)
      c.poses.push_back({{.translation = {0.003 * i, 0.001 * i, -depth}}, {{{0, 0, 1}, depth}}});
  for (int i = 0; i < slide_steps; ++i) c.slide.push_back({.translation = {0.0002 * i, 0.0001 * i, -0.01}});
  return c;
}

Case ball_on_plate() {
  Case c{"ball on plate", ball(32, 16), box({-4, -4, -0.2}, {4, 4, 0}), true};
  const auto lowest = [&](const RigidTransform& turn) {
    double z = 0;
    for (const Vec3& p : c.a.positions) z = std::min(z, turn.rotate(p).z);
    return z;
  };
  for (const double depth : pressings)
    for (int i = 0; i < 20; ++i) {
      RigidTransform place = RigidTransform::from_axis({1, 0.3, 0.1}, 0.3 + 0.11 * i, {0.01 * i, 0.02, 0});
      place.translation.z = -lowest(place) - depth;
      c.poses.push_back({place, {{{0, 0, 1}, depth}}});
    }
  // It rolls.
  for (int i = 0; i < slide_steps; ++i)
    c.slide.push_back(RigidTransform::from_axis({0, 1, 0}, 0.3 + 0.002 * i, {0.002 * i, 0.02, 0.96}));
  return c;
}

Case capsule_in_groove() {
  Case c{"capsule in groove", sample_body("capsule", 24), groove(), true};
  const double across = std::sqrt(0.5);
  for (const double depth : pressings)
    for (int i = 0; i < 20; ++i)
      c.poses.push_back({{.translation = {0.01 + 0.003 * i, 0, (0.5 - depth) / across}},
                         {{{0, across, across}, depth}, {{0, -across, across}, depth}}});
  for (int i = 0; i < slide_steps; ++i)
    c.slide.push_back(RigidTransform::from_axis({1, 0, 0}, 0.001 * i, {0.0005 * i, 0, 0.48 / across}));
  return c;
}

/// The mesh across its copy, pressed in by a hundredth of its size.
Case on_copy(const Input& input, Collider& a, Collider& b) {
  Case c{"mesh on its copy", input.mesh, input.mesh, false};
  const Box box = bounding_box(input.mesh);
  const double size = box.diagonal();
  CrossingQuery crossings;
  const auto crosses = [&](const RigidTransform& place) {
    a.set_transform(place);
    require(crossings.run(a, b));
    return !crossings.pairs().empty();
  };
  const auto placed = [&](double angle, double height) {
    const RigidTransform turn = RigidTransform::from_axis({0, 0, 1}, angle);
    return RigidTransform{turn.rows, box.center() - turn.rotate(box.center()) + Vec3{0, 0, height}};
  };
  const auto resting = [&](double angle) {
    double height = 1.5 * box.extent().z;
    for (const double step : {0.02 * size, 0.001 * size, 0.00005 * size}) {
      while (height > 0 && !crosses(placed(angle, height))) height -= step;
      height += step;
    }
    return height;
  };
  for (int i = 0; i < 6; ++i) {
    const double angle = 1.6 + 0.02 * i;
    const RigidTransform place = placed(angle, resting(angle) - 0.01 * size);
    if (!crosses(place)) continue;
    // The loop's area vector is that of the region of b which it bounds; segments run along the product of normals.
    Vec3 area;
    for (const Crossing& crossing : crossings.pairs()) {
      const Segment& s = crossing.segment;
      const Vec3 along = cross(area_vector(a.triangle(crossing.facet_a)), area_vector(b.triangle(crossing.facet_b)));
      area +=
          cross(s.from - place.translation, s.to - place.translation) * (dot(along, s.to - s.from) > 0 ? -0.5 : 0.5);
    }
    const Vec3 normal = normalized(area);
    double low = 0, high = 0.1 * size;
    for (int step = 0; step < 40; ++step) {
      const double middle = (low + high) / 2;
      (crosses({place.rows, place.translation + normal * middle}) ? low : high) = middle;
    }
    c.poses.push_back({place, {{normal, high}}});
  }
  const double height = resting(1.6) - 0.01 * size;
  for (int i = 0; i < slide_steps; ++i) {
    RigidTransform place = placed(1.6, height);
    place.translation += Vec3{0.00005, 0.00003, 0} * (i * size);
    c.slide.push_back(place);
  }
  return c;
}

/// Contacts of a pose, and the force on a.
struct Found {
  std::vector<PeerContact> contacts;
  std::size_t points = 0;
  Vec3 force;
};
struct ContactMethod {
  std::string name;
  std::function<void(const RigidTransform&, Found&)> find;
};

double degrees_between(const Vec3& u, const Vec3& v) {
  return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

Result judged(const Case& c, const ContactMethod& method, const std::string& mesh, const Settings& settings) {
  Result result{.scenario = "pressed", .item = c.name + ", " + method.name, .mesh = mesh};
  double depth_error = 0, normal_error = 0, contacts = 0, jump = 0;
  Found found;
  const auto find = [&](const RigidTransform& place) {
    found.contacts.clear();
    found.points = 0;
    found.force = {};
    method.find(place, found);
  };
  for (const Pressed& pose : c.poses) {
    find(pose.place);
    contacts += static_cast<double>(found.points) / static_cast<double>(c.poses.size());
    for (const Wall& wall : pose.walls) {
      double deepest = 0;
      Vec3 sum;
      for (const PeerContact& contact : found.contacts) {
        const auto nearer = [&](const Wall& other) {
          return dot(contact.normal, other.normal) > dot(contact.normal, wall.normal);
        };
        if (std::any_of(pose.walls.begin(), pose.walls.end(), nearer)) continue;
        deepest = std::max(deepest, contact.depth);
        sum += contact.normal * std::max(0.0, contact.depth);
      }
      depth_error = std::max(depth_error, std::abs(deepest / wall.depth - 1));
      normal_error = std::max(normal_error, sum == Vec3{} ? 180 : degrees_between(sum, wall.normal));
    }
  }
  Vec3 last;
  double mean = 0;
  for (std::size_t i = 0; i < c.slide.size(); ++i) {
    find(c.slide[i]);
    if (i > 0) jump = std::max(jump, distance(found.force, last));
    mean += length(found.force) / static_cast<double>(c.slide.size());
    last = found.force;
  }
  timed(settings, [&] {
    for (const Pressed& pose : c.poses) result.seconds.push_back(processor_seconds_of([&] { find(pose.place); }));
  });
  result.figures = {{"depth off by, %", 100 * depth_error},
                    {"normal off by, degrees", normal_error},
                    {"contacts", contacts},
                    {"largest jump, %", mean > 0 ? 100 * jump / mean : 100}};
  if (method.name == "patches") {
    result.expect(depth_error <= 0.02, "a depth that is not the least translation");
    result.expect(normal_error <= 0.5, "a normal that is not the known one");
  }
  return result;
}

void add_cases(const Case& c, Collider& a, const Collider& b, const std::string& mesh, const Settings& settings,
               std::vector<Result>& results) {
  ContactPatchQuery query(a, b);
  const auto add_depths = [](Found& found) {
    found.points = found.contacts.size();
    for (const PeerContact& contact : found.contacts) found.force += contact.normal * std::max(0.0, contact.depth);
  };
  std::vector<ContactMethod> methods{{"patches",
                                      [&](const RigidTransform& place, Found& found) {
                                        a.set_transform(place);
                                        require(query.run());
                                        for (const ContactPatch& patch : query.patches()) {
                                          found.contacts.push_back({patch.normal, patch.depth});
                                          found.points += patch.points.size();
                                          found.force -= patch.a.area_vector * patch.volume;
                                        }
                                      }},
                                     {"spheres with surfaces", [&](const RigidTransform& place, Found& found) {
                                        a.set_transform(place);
                                        for (const ContactSurface& s : collide(a, b, {.surfaces = true}).surfaces)
                                          found.contacts.push_back({s.normal, s.depth});
                                        std::erase_if(found.contacts,
                                                      [](const PeerContact& contact) { return !(contact.depth > 0); });
                                        add_depths(found);
                                      }}};
  const std::unique_ptr<ContactPeer> facets = make_bullet_contacts(c.a, c.b, false),
                                     hull = c.is_convex ? make_bullet_contacts(c.a, c.b, true) : nullptr;
  const auto add_peer = [&](const char* name, ContactPeer* peer) {
    methods.push_back({name, [=](const RigidTransform& place, Found& found) {
                         peer->find(place, {}, found.contacts);
                         add_depths(found);
                       }});
  };
  if (facets) add_peer("Bullet, GImpact", facets.get());
  if (hull) add_peer("Bullet, hull", hull.get());
  for (const ContactMethod& method : methods) results.push_back(judged(c, method, mesh, settings));
}

/// A mesh with all that a collider borrows.
struct Model {
  Mesh mesh;
  CoveredTree tree;
  Body body;
  Collider collider;
  Model(const Mesh& m, const Settings& settings)
      : mesh(m), tree(build(mesh, tree_options(settings), *settings.workers)), body(mesh, tree), collider(mesh, body) {}
};

}  // namespace

std::vector<Result> run_pressed(const Input& input, const Settings& settings) {
  std::vector<Result> results;
  Model a(input.mesh, settings), b(input.mesh, settings);
  std::vector<Case> cases{box_on_plate(), ball_on_plate(), capsule_in_groove()};
  for (const Case& c : cases) {
    Model of_a(c.a, settings), of_b(c.b, settings);
    add_cases(c, of_a.collider, of_b.collider, input.name, settings, results);
  }
  if (inspect(input.mesh).closed)
    add_cases(on_copy(input, a.collider, b.collider), a.collider, b.collider, input.name, settings, results);
  return results;
}

}  // namespace morula::bench
