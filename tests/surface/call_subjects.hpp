// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Every object that calls callbacks or asks interrupts, behind one interface, for tests of calls that end in the
// middle.
#pragma once

#include <functional>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/surface/obstacles.hpp>
#include <morula/surface/surface_tree.hpp>
#include <ostream>
#include <span>
#include <vector>

namespace morula::test {

struct Thrown {};
using Numbers = std::vector<double>;

/// What all callbacks of an object call. None: nothing.
using Hook = std::function<void()>;

/// Two bodies that cross, at rest, and surfaces of the same.
struct World {
  Mesh mesh_a = sample_body("blob", 6), mesh_b = moved(mesh_a, {0.6, 0.1, 0});
  CoveredTree built_a = build(mesh_a, {.method = Method::octree, .depth = 2});
  CoveredTree built_b = build(mesh_b, {.method = Method::octree, .depth = 2});
  Body body_a{mesh_a, built_a}, body_b{mesh_b, built_b};
  Collider a{mesh_a, body_a}, b{mesh_b, body_b};
  SurfaceTree surface_a{mesh_a}, surface_b{mesh_b};
  std::vector<Vec3> later = moved(mesh_a, {0.2, 0, 0}).positions;
  Obstacle ball = Sphere{{0.7, 0, 0}, 0.4};

  static Mesh moved(Mesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.positions) p += by;
    return mesh;
  }
  World();
  /// As it was made, whatever was updated and placed since.
  void restore();
};
/// The world that all subjects read. A test that leaves it with other bodies makes a new one.
std::unique_ptr<World>& only_world();
World& world();

/// An object under test.
struct Subject {
  virtual ~Subject() = default;
  /// For the calls that follow. With `short_budget` they do some of the work only.
  virtual void set(const Hook& hook, bool short_budget) = 0;
  virtual Status run(Workers& workers) = 0;
  /// Another way to begin or to go on; by number, until there is none.
  virtual std::size_t ways_to_go_on() const { return 0; }
  virtual Status go_on(std::size_t, Workers&) { return {}; }
  /// Does it read surfaces, or else colliders?
  virtual bool reads_surfaces() const { return false; }
  /// Does it read the second body or surface?
  virtual bool reads_b() const { return true; }
  virtual bool has_callbacks() const { return true; }
  virtual bool asks_interrupts() const { return true; }
  /// All that it tells of what was found.
  virtual Numbers results() const = 0;
  /// Calls every function of itself that changes it; each is to be refused. Returns how many were not.
  virtual int call_itself() = 0;
};
struct Kind {
  const char* name;
  std::function<std::unique_ptr<Subject>()> make;
  friend std::ostream& operator<<(std::ostream& out, const Kind& kind) { return out << kind.name; }
};
/// One of each way to call each kind of object.
std::span<const Kind> all_kinds();

/// After the k-th callback ended a call of the subject: the subject is empty, tells why, and answers as a new one does.
void expect_empty_and_as_new(const Kind& kind, Subject& subject, const Numbers& truth, Status::Code why, long k);

}  // namespace morula::test
