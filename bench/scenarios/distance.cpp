// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario distance: two bodies apart, near, touching and crossing; floor, probe, capsule and ray against one; inside
// tests. The first is the mesh bent by 90 degrees, the second the mesh at rest. Verified against facets found by
// another index.
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/collide/containment.hpp>
#include <morula/collide/distance.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/triangle_bvh.hpp>
#include <numbers>

#include "frames.hpp"
#include "resources.hpp"
#include "scenario.hpp"

namespace morula::bench {
namespace {

// Slow answers are checked for this many of each item's questions, or a quarter of them.
constexpr std::size_t checked_distances = 12;

Vec3 random_point(Random& random, double reach) {
  const double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

Mesh world_mesh(const Collider& body) {
  Mesh mesh{{}, {body.mesh_facets().begin(), body.mesh_facets().end()}};
  for (std::uint32_t v = 0; v < body.vertex_count(); ++v) mesh.positions.push_back(body.vertex(v));
  return mesh;
}

// Nearest points of an edge and a triangle, found by looking for the least along the edge: the distance to a convex set
// is convex.
double along_edge(const Vec3& p, const Vec3& q, const Triangle& t) {
  double lower = 0, upper = 1;
  const auto at = [&](double s) { return closest_point(t, p + (q - p) * s).squared_distance; };
  for (int i = 0; i < 60; ++i) {
    const double a = lower + (upper - lower) * 0.382, b = lower + (upper - lower) * 0.618;
    (at(a) <= at(b) ? upper : lower) = at(a) <= at(b) ? b : a;
  }
  return std::sqrt(std::min({at(0), at(1), at(0.5 * (lower + upper))}));
}

// Over all facets of a and those of b that an index finds near them.
double slow_distance(const Mesh& a, const TriangleBvh& b) {
  double best = std::numeric_limits<double>::infinity();
  for (const Vec3& p : a.positions)
    if (const auto near = b.closest_point(p, best)) best = std::min(best, std::sqrt(near->squared_distance));
  std::vector<std::uint32_t> near;
  for (std::uint32_t f = 0; f < a.facet_count(); ++f) {
    const Triangle t = a.corners(f);
    const Vec3 center = (t[0] + t[1] + t[2]) / 3.0;
    const double radius = std::max({distance(center, t[0]), distance(center, t[1]), distance(center, t[2])});
    b.facets_touching({center, radius + best}, near);
    for (const std::uint32_t g : near) {
      const Triangle& u = b.triangle(g);
      for (int k = 0; k < 3; ++k) {
        best = std::min(best, along_edge(t[k], t[(k + 1) % 3], u));
        best = std::min(best, along_edge(u[k], u[(k + 1) % 3], t));
      }
    }
  }
  return best;
}

class Scene {
 public:
  Scene(const Input& input, const Settings& settings)
      : input_(input),
        built_(build(input.mesh, tree_options(settings))),
        bent_(input.mesh, built_),
        rest_(input.mesh, built_),
        positions_(bend_and_back(input.mesh)[12]),
        a_(input.mesh, bent_),
        b_(input.mesh, rest_),
        size_(bounding_box(input.mesh).diagonal()) {
    require(bent_.update(positions_));
    a_.set_positions(positions_);
    count_ = std::clamp<std::size_t>(settings.questions / 100, 10, 200);
    checks_ = std::min(checked_distances, count_ / 4);
  }

  std::vector<Result> run() {
    for (const auto& [name, gap] : {std::pair{"apart", 0.5}, {"near", 0.02}, {"touching", 1e-4}, {"crossing", -0.02}})
      distances(name, gap * size_);
    primitives();
    return std::move(results_);
  }

 private:
  // b turned at random and moved until it is about this far from a; negative: through it.
  std::vector<RigidTransform> poses(double gap) {
    Random random(7);
    DistanceQuery query;
    std::vector<RigidTransform> found;
    while (found.size() < count_) {
      const Vec3 axis = random_point(random, 1), out = normalized(random_point(random, 1));
      RigidTransform transform =
          RigidTransform::from_axis(axis, random.uniform(0, 2 * std::numbers::pi), out * (2 * size_));
      for (int step = 0; step < 20; ++step) {
        b_.set_transform(transform);
        const DistanceBounds d = query.run(a_, b_);
        if (d.upper <= std::max(gap * 1.01, 1e-9 * size_)) break;
        transform.translation += (d.a.point - d.b.point) * (1 - std::max(gap, 1e-9 * size_) / d.upper);
      }
      if (gap < 0) transform.translation += normalized(-transform.translation) * -gap;
      found.push_back(transform);
    }
    return found;
  }

  void distances(const std::string& name, double gap) {
    const std::vector<RigidTransform> transforms = poses(gap);
    const double slack = 1e-12 * size_;
    const auto item = [&](const std::string& what, const DistanceOptions& options, int warm_steps, bool to_the_end) {
      Result result{.scenario = "distance", .item = name + ", " + what, .mesh = input_.name};
      DistanceQuery query;
      double sphere_tests = 0, facet_tests = 0;
      std::size_t checked = 0, crossing = 0, unsound = 0, loose = 0;
      for (const RigidTransform& start : transforms) {
        b_.set_transform(start);
        require(query.run(a_, b_, options).status);  // memory, and where frames are coherent the last answer
        for (int step = 0; step <= warm_steps; ++step) {
          RigidTransform moved = start;
          moved.translation += Vec3{1, 0.5, -0.3} * (0.002 * size_ * step);
          b_.set_transform(moved);
          DistanceBounds found;
          result.seconds.push_back(thread_seconds_of([&] { found = query.run(a_, b_, options); }));
          sphere_tests += static_cast<double>(found.sphere_tests);
          facet_tests += static_cast<double>(found.facet_tests);
          crossing += found.crossing;
          if (checked++ % std::max<std::size_t>(1, count_ * static_cast<std::size_t>(warm_steps + 1) / checks_) != 0)
            continue;
          const double expected = found.crossing ? 0 : slow_distance(world_mesh(b_), TriangleBvh(world_mesh(a_)));
          unsound += found.lower > expected + slack || found.upper < expected - slack;
          loose += to_the_end && found.upper - found.lower > slack;
        }
      }
      result.expect(unsound == 0, std::to_string(unsound) + " answers without the distance between their bounds");
      result.expect(loose == 0, std::to_string(loose) + " answers that ran to the end with a gap");
      const auto n = static_cast<double>(result.seconds.size());
      result.figures = {{"sphere tests", sphere_tests / n},
                        {"facet pairs", facet_tests / n},
                        {"crossing", static_cast<double>(crossing) / n}};
      results_.push_back(std::move(result));
    };
    item("fresh", {.warm_start = false}, 0, true);
    item("frames", {}, 3, true);
    item("to 1 %", {.tolerance = 0.01 * size_, .warm_start = false}, 0, false);
    item("within 1 %?", {.stop_above = 0.01 * size_, .stop_below = 0.01 * size_, .warm_start = false}, 0, false);
  }

  template <class F>
  static double thread_seconds_of(const F& f) {
    const double start = thread_seconds();
    f();
    return thread_seconds() - start;
  }

  // query(i): the answer; agrees(i, answer): slow.
  template <class Query, class Agrees>
  void item(const std::string& name, const Query& query, const Agrees& agrees) {
    Result result{.scenario = "distance", .item = name, .mesh = input_.name};
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      auto answer = query(i);
      result.seconds.push_back(thread_seconds_of([&] { answer = query(i); }));
      if (i % std::max<std::size_t>(1, count_ / checks_) == 0) wrong += !agrees(i, answer);
    }
    result.expect(wrong == 0, std::to_string(wrong) + " answers differ from brute force");
    results_.push_back(std::move(result));
  }

  void primitives() {
    a_.set_transform({});
    const Mesh world = world_mesh(a_);
    const TriangleBvh bvh(world);
    Random random(3);
    const Box box = bounding_box(world);
    std::vector<Vec3> points, others, on_surface;
    for (std::size_t i = 0; i < count_; ++i) {
      const Triangle t = world.corners(random.next() % world.facet_count());
      on_surface.push_back((t[0] + t[1] + t[2]) / 3.0);
      points.push_back(on_surface.back() + random_point(random, 0.03 * size_));
      others.push_back(points.back() + random_point(random, 0.3 * size_));
    }
    const double slack = 1e-12 * size_, radius = 0.02 * size_;

    TouchQuery touched;
    item(
        "half space, deepest",
        [&](std::size_t i) {
          touched.run(a_, HalfSpace{{0, 0, 1}, box.lower.z + 0.02 * size_ * static_cast<double>(i % 5)},
                      {.nearest = true});
          return touched.result().deepest->depth;
        },
        [&](std::size_t i, double depth) {
          return std::abs(depth - 0.02 * size_ * static_cast<double>(i % 5)) <= slack;
        });
    item(
        "half space, facets",
        [&](std::size_t i) {
          touched.run(a_, HalfSpace{{0, 0, 1}, box.lower.z + 0.02 * size_ * static_cast<double>(i % 5)},
                      {.collect_all = true});
          return touched.result().facets.size();
        },
        [&](std::size_t i, std::size_t count) {
          std::size_t below = 0;
          const double floor = box.lower.z + 0.02 * size_ * static_cast<double>(i % 5);
          for (const Facet& f : world.facets)
            below += std::min({world.positions[f[0]].z, world.positions[f[1]].z, world.positions[f[2]].z}) <= floor;
          return count == below;
        });
    item(
        "sphere, nearest point",
        [&](std::size_t i) {
          touched.run(a_, Sphere{points[i], radius}, {.nearest = true});
          return touched.result().deepest->depth;
        },
        [&](std::size_t i, double depth) {
          return std::abs(radius - depth - std::sqrt(bvh.closest_point(points[i])->squared_distance)) <= slack;
        });
    item(
        "sphere, touches?",
        [&](std::size_t i) {
          touched.run(a_, Sphere{points[i], radius}, {.stop_at_first = true});
          return touched.result().touches;
        },
        [&](std::size_t i, bool touches) { return touches == bvh.closest_point(points[i], radius).has_value(); });
    item(
        "capsule, deepest",
        [&](std::size_t i) {
          touched.run(a_, Capsule{points[i], others[i], radius}, {.nearest = true});
          return touched.result().deepest->depth;
        },
        [&](std::size_t i, double depth) {
          double best = std::numeric_limits<double>::infinity();
          for (std::uint32_t f = 0; f < world.facet_count(); ++f)
            best = std::min(best, along_edge(points[i], others[i], world.corners(f)));
          return std::abs(radius - depth - best) <= 1e-9 * size_;
        });
    item(
        "ray, first hit",
        [&](std::size_t i) {
          return first_hit(a_, {others[i], on_surface[i] - others[i]});
        },
        [&](std::size_t i, const RayHit& found) {
          double first = std::numeric_limits<double>::infinity();
          const Vec3 direction = on_surface[i] - others[i];
          for (std::uint32_t f = 0; f < world.facet_count(); ++f) {
            const Triangle t = world.corners(f);
            const Vec3 n = area_vector(t);
            const double slope = dot(n, direction);
            if (slope == 0) continue;
            const double s = dot(n, t[0] - others[i]) / slope;
            const Vec3 x = others[i] + direction * s;
            if (s >= 0 && closest_point(t, x).squared_distance <= slack * slack) first = std::min(first, s);
          }
          return found.first && std::abs(found.first->t - first) <= 1e-9;
        });
    const MeshReport report = inspect(input_.mesh);
    if (!report.has_volume()) return;
    InsideQuery inside(a_);
    item(
        "inside?", [&](std::size_t i) { return inside.locate(points[i]); },
        [&](std::size_t i, const PointLocation& found) {
          double sum = 0;
          for (std::uint32_t f = 0; f < world.facet_count(); ++f) sum += solid_angle(world.corners(f), points[i]);
          return found.winding == static_cast<int>(std::lround(sum / (4 * std::numbers::pi)));
        });
    item(
        "probe",
        [&](std::size_t i) {
          return inside.probe({points[i], radius});
        },
        [&](std::size_t i, const Probe& found) {
          return std::abs(std::abs(found.distance) - std::sqrt(bvh.closest_point(points[i])->squared_distance)) <=
                 slack;
        });
  }

  const Input& input_;
  CoveredTree built_;
  Body bent_, rest_;
  Frame positions_;
  Collider a_, b_;
  double size_;
  std::size_t count_ = 0, checks_ = 0;  // questions of each item; those checked twice
  std::vector<Result> results_;
};

}  // namespace

std::vector<Result> run_distance(const Input& input, const Settings& settings) {
  return Scene(input, settings).run();
}

}  // namespace morula::bench
