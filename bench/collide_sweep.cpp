// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide_sweep.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>

namespace morula::bench {
namespace {

struct Small {
  Small(std::string_view name, int resolution, int branching, int depth)
      : mesh(sample_body(name, resolution)),
        model(build(mesh, {.method = Method::octree, .branching = branching, .depth = depth})) {}
  Mesh mesh;
  CoveredTree model;
};

// A body on its way through frames.
struct Actor {
  explicit Actor(const Small& small)
      : mesh(small.mesh), body(small.mesh, small.model), collider(small.mesh, body), positions(small.mesh.positions) {}
  void deform(Random& random, double amplitude) {
    const double size = bounding_box(mesh).diagonal();
    Vec3 stretch;
    for (int axis = 0; axis < 3; ++axis) stretch[axis] = 1 + random.uniform(-4, 4) * amplitude;
    for (std::size_t i = 0; i < positions.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        positions[i][axis] = stretch[axis] * mesh.positions[i][axis] + random.uniform(-1, 1) * 0.1 * amplitude * size;
    follow();
  }
  void shake(Random& random, double amplitude) {
    for (Vec3& p : positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] += random.uniform(-amplitude, amplitude);
    follow();
  }
  void follow() {
    require(body.update(positions));
    collider.set_positions(positions);
  }
  const Mesh& mesh;
  Body body;
  Collider collider;
  std::vector<Vec3> positions;
};

bool has(const Collider& c, std::uint32_t node, std::uint32_t facet) {
  const auto list = c.facets(node);
  return std::find(list.begin(), list.end(), facet) != list.end();
}

// Ends of crossings that no contact accounts for.
std::size_t missed(const std::vector<Crossing>& crossings, const Collider& a, const Collider& b,
                   const std::vector<Contact>& contacts) {
  std::size_t count = 0;
  for (const Crossing& x : crossings)
    for (const Vec3& end : {x.segment.from, x.segment.to})
      count += std::none_of(contacts.begin(), contacts.end(), [&](const Contact& c) {
        return squared_distance(end, c.point) <= (1 + 1e-9) * c.error_bound * c.error_bound &&
               has(a, c.node_a, x.facet_a) && has(b, c.node_b, x.facet_b);
      });
  return count;
}

RigidTransform anywhere(Random& random, double reach) {
  const auto any = [&] { return random.uniform(-1, 1); };
  const Vec3 shift{reach * any(), reach * any(), reach * any()};
  return RigidTransform::from_quaternion(any(), any(), any(), any(), shift);
}

struct Tally {
  std::atomic<std::size_t> crossings{0}, poses_crossing{0}, answers{0}, missed{0}, rejected{0}, other_end{0},
      other_pairs{0};
};

void try_pose(Actor& a, Actor& b, CrossingQuery& exact, std::uint64_t seed, Tally& tally) {
  Random random(seed);
  const double amplitude = random.uniform(0, 0.12);
  a.deform(random, amplitude);
  b.deform(random, amplitude);
  a.collider.set_transform(anywhere(random, 1.2));
  b.collider.set_transform(anywhere(random, 1.2));

  const Priority priority = std::array{Priority::level, Priority::overlap, Priority::importance}[seed % 3];
  std::vector<Crossing> crossings;
  std::size_t all_tests = 0, all_contacts = 0;
  const auto judge = [&](const Contacts& contacts) {
    ++tally.answers;
    tally.missed += missed(crossings, a.collider, b.collider, contacts.contacts);
  };
  const auto see = [&] {
    crossings = brute_force::crossings(a.collider, b.collider);
    tally.rejected += !exact.run(a.collider, b.collider);
    tally.other_pairs += !std::equal(crossings.begin(), crossings.end(), exact.pairs().begin(), exact.pairs().end());
    tally.crossings += crossings.size();
    tally.poses_crossing += !crossings.empty();
    const Contacts contacts = collide(a.collider, b.collider);
    all_tests = contacts.pair_tests, all_contacts = contacts.contacts.size();
    judge(contacts);
    tally.missed += !crossings.empty() && !overlap(a.collider, b.collider);
  };
  ContactQuery query;
  query.add(a.collider, b.collider);
  const auto interrupt = [&] { query.set_options({.budget = random.next() % (all_tests + 1), .priority = priority}); };
  const auto done = [&](const ContactStatus& status) {
    tally.rejected += !status;
    judge(query.contacts());
  };
  const auto to_the_end = [&] {
    query.set_options({.priority = priority});
    done(query.resume());
    tally.other_end += query.contacts().contacts.size() != all_contacts || !query.contacts().finished;
  };

  see();
  interrupt();
  done(query.start());
  interrupt();
  done(query.resume());
  if (random.next() % 2 == 0) to_the_end();
  // A small or a large step to the next frame, by deformation, transform or both.
  const double step = random.next() % 2 == 0 ? 0.002 : 0.1;
  if (random.next() % 3 != 0) a.shake(random, step);
  if (random.next() % 3 != 0) {
    RigidTransform place = b.collider.transform();
    place.translation += step * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    b.collider.set_transform(place);
  }
  see();
  interrupt();
  done(query.carry());
  to_the_end();
}

}  // namespace

Result sweep_poses(std::size_t poses, const Settings& settings) {
  Result result{.scenario = "collide", .item = "no crossing is missed", .mesh = "small bodies"};
  const std::vector<Small> bodies{{"limb", 8, 8, 3}, {"torus", 7, 4, 4}, {"bar", 5, 8, 2}, {"blob", 7, 16, 2}};
  Tally tally;
  result.seconds.push_back(seconds_of([&] {
    parallel_for(*settings.workers, poses, 64, [&](std::size_t begin, std::size_t end) {
      std::vector<std::unique_ptr<Actor>> left, right;
      CrossingQuery exact;
      for (const Small& small : bodies) {
        left.push_back(std::make_unique<Actor>(small));
        right.push_back(std::make_unique<Actor>(small));
      }
      for (std::size_t pose = begin; pose < end; ++pose)
        try_pose(*left[pose % bodies.size()], *right[pose / bodies.size() % bodies.size()], exact, pose + 1, tally);
    });
  }));
  result.expect(tally.missed == 0, std::to_string(tally.missed) + " crossings missed");
  result.expect(tally.other_pairs == 0, "other facet pairs than by brute force");
  result.expect(tally.rejected == 0, "a query was rejected");
  result.expect(tally.other_end == 0, "an interrupted query ended elsewhere");
  result.expect(tally.crossings > poses, "hardly anything crossed");
  result.figures = {{"poses", static_cast<double>(2 * poses)},
                    {"of them crossing", static_cast<double>(tally.poses_crossing)},
                    {"crossings", static_cast<double>(tally.crossings)},
                    {"answers", static_cast<double>(tally.answers)},
                    {"missed", static_cast<double>(tally.missed)}};
  return result;
}

}  // namespace morula::bench
