// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/body.hpp>
#include <morula/update/kdop_tree.hpp>
#include <morula/update/looseness_estimate.hpp>

#include "claims.hpp"
#include "samples.hpp"

namespace morula::bits {
namespace {

using Poses = std::vector<std::vector<Vec3>>;

// Out and back by every deformation, then noise without rhyme or reason, a collapse, and far away.
Poses poses_of(const Mesh& mesh) {
  Poses poses;
  for (const Deformation& deformation :
       {Deformation{Stretch{}}, Deformation{Twist{}}, Deformation{Bend{}}, Deformation{Poke{}}, Deformation{Noise{}}})
    for (const double t : {0.3, 1.0, 0.0}) poses.push_back(deform(mesh, {deformation}, t));
  Random random(9);
  std::vector<Vec3> rough = mesh.positions, flat = mesh.positions, far = mesh.positions;
  for (Vec3& p : rough)
    for (int axis = 0; axis < 3; ++axis) p[axis] += random.uniform(-0.4, 0.4);
  for (Vec3& p : flat) p.y = 0;
  for (Vec3& p : far) p = 1.25 * p + Vec3{1e9, -3e8, 7e7};
  for (std::vector<Vec3>* pose : {&rough, &flat, &far}) poses.push_back(std::move(*pose));
  return poses;
}

std::uint64_t hash_of_motion(Body body, const Poses& poses, Workers& workers) {
  Sum sum;
  sum.add(body.hash());
  for (const std::vector<Vec3>& pose : poses) {
    // Double, float, and float inside larger records: each is read by code of its own.
    const std::vector<Vec3f> floats(pose.begin(), pose.end());
    std::vector<float> records;
    for (const Vec3f& p : floats) records.insert(records.end(), {p.x, p.y, p.z, -1.0f});
    for (const PositionView& positions : {PositionView(pose), PositionView(floats),
                                          PositionView::strided(records.data(), floats.size(), 4 * sizeof(float))}) {
      const UpdateStatus status = body.update(positions, workers);
      sum.add(status.points_tested).add(body.hash());
    }
  }
  return sum.value();
}

std::uint64_t hash_of_parts(Body body, const Poses& poses, Workers& workers) {
  Sum sum;
  std::vector<Vec3> now = poses[1];
  require(body.update(now, workers));
  const auto count = static_cast<std::uint32_t>(now.size());
  for (std::uint32_t k = 0; k < 6; ++k) {
    const VertexRange moved{count * k / 7, count * k / 7 + count / 9};
    for (std::uint32_t v = moved.begin; v < moved.end; ++v) now[v] += Vec3{0.03, -0.02 * k, 0.01};
    require(body.update(now, std::span(&moved, 1), workers));
    sum.add(body.hash());
  }
  require(body.update_lazily(poses[4], 1, workers));
  for (std::uint32_t node = 0; node < body.spheres().size(); node += 3)
    if (body.is_fresh(node)) sum.add(body.refresh_children(node)).add(body.sphere(node));
  return sum.value();
}

Modes waves(const Mesh& mesh, std::size_t mode_count) {
  Modes modes{.vertex_count = mesh.vertex_count(), .mode_count = mode_count, .displacements = {}};
  for (std::size_t j = 0; j < mode_count; ++j)
    for (const Vec3& p : mesh.positions) {
      const double k = 1 + 0.5 * static_cast<double>(j);
      modes.displacements.push_back({0.1 * p.y * p.y - 0.05 * k * p.z, 0.2 * k * p.x * p.z, 0.1 * p.x * p.x / k});
    }
  return modes;
}

std::uint64_t hash_of_modal(const Mesh& mesh, const CoveredTree& model, RuleOptions::ModalBound bound,
                            Workers& workers) {
  UpdateOptions options{.rules = {Rule::modal}};
  options.details.modal_bound = bound;
  options.modes = waves(mesh, 5);
  Body body(mesh, model, options, workers);
  Sum sum;
  Random random(21);
  for (int frame = 0; frame < 8; ++frame) {
    std::vector<double> coordinates(5);
    for (double& q : coordinates) q = random.uniform(-2, 2);
    require(body.update_modal(coordinates, workers));
    sum.add(body.hash()).add(body.modal_sphere(1, coordinates));
  }
  return sum.value();
}

std::uint64_t hash_of_skinned(const Mesh& mesh, const CoveredTree& model, Workers& workers) {
  UpdateOptions options{.rules = {Rule::skinned}, .skin = {.bone_count = 4, .begin = {0}}};
  Skin& skin = options.skin;
  for (const Vec3& p : mesh.positions) {
    const std::array<double, 3> shares{1 + p.x * p.x, 0.5 + p.y * p.y, std::abs(p.z)};
    for (std::uint32_t k = 0; k < 3; ++k) {
      skin.bones.push_back(p.x < 0 ? k : k + 1);
      skin.weights.push_back(shares[k] / (shares[0] + shares[1] + shares[2]));
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  Body body(mesh, model, options, workers);
  Sum sum;
  Random random(22);
  for (int frame = 0; frame < 8; ++frame) {
    std::vector<AffineTransform> transforms(4);
    for (AffineTransform& t : transforms)
      for (Vec3* v : {&t.columns[0], &t.columns[1], &t.columns[2], &t.translation})
        *v += Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * (0.2 * frame);
    require(body.update_skinned(transforms, workers));
    sum.add(body.hash());
  }
  return sum.value();
}

void add_updates(Claims& claims, std::string_view name, Method method, Workers& workers) {
  const Mesh mesh = sample(name, 14);
  const CoveredTree model =
      build(mesh, {.method = method, .branching = 8, .depth = method == Method::grid ? 2 : 3}, workers);
  const Poses poses = poses_of(mesh);
  const std::string of = " of " + std::string(name) + ", " + std::string(morula::name(method));
  const auto add = [&](const std::string& what, std::uint64_t hash) { claims.push_back({what + of, hash}); };

  for (const Rule rule : position_rules())
    for (const bool conservative : {false, true}) {
      const UpdateOptions options{.rules = {rule}, .conservative = conservative};
      add("rule " + std::string(morula::name(rule)) + (conservative ? ", made to cover" : ""),
          hash_of_motion(Body(mesh, model, options, workers), poses, workers));
    }
  RuleOptions other{.approach1_weights = RuleOptions::Weights::inverse_distance,
                    .approach1_inner_center = RuleOptions::InnerCenter::linked_vertices,
                    .approach2_inner_boxes = RuleOptions::InnerBoxes::child_centers,
                    .distance_floor = 0.25};
  add("a mixture of rules",
      hash_of_motion(
          Body(mesh, model,
               {.rules = {Rule::exact, Rule::approach1, Rule::approach2, Rule::approach1}, .details = other}, workers),
          poses, workers));
  add("parts and lazy updates", hash_of_parts(Body(mesh, model, {}, workers), poses, workers));
  add("modal by gradients", hash_of_modal(mesh, model, RuleOptions::ModalBound::gradient, workers));
  add("skinned", hash_of_skinned(mesh, model, workers));
  add("modal by shifts", hash_of_modal(mesh, model, RuleOptions::ModalBound::shift, workers));

  for (const int k : {6, 14, 18, 26}) {
    KDopTree tree(mesh, model, k, workers);
    Sum sum;
    for (const std::vector<Vec3>& pose : poses) require(tree.update(pose, workers)), sum.add(tree.hash());
    add(std::to_string(k) + "-DOPs", sum.value());
  }
  LoosenessEstimator estimator(mesh, 512);
  Body body(mesh, model, {}, workers);
  Sum estimates;
  for (std::size_t i = 0; i < 12; ++i) {
    std::vector<double> looseness(4);
    require(body.update(poses[i], workers));
    estimator.pose(poses[i]);
    estimator.estimate(body, looseness);
    estimates.add(looseness).add(estimator.volume());
  }
  add("estimated looseness", estimates.value());
}

// Two bodies, deformed, one of them placed: all queries about them.
class Pair {
 public:
  Pair(std::string_view name_a, std::string_view name_b, Workers& workers)
      : a_(name_a, 14, workers), b_(name_b, 12, workers), workers_(&workers) {}

  void add_claims(Claims& claims) {
    Sum contacts, carried, crossing, distances, shapes, inside;
    ContactQuery query({.priority = Priority::overlap});
    query.add(a_.collider, b_.collider);
    DistanceQuery distance;
    InsideQuery test(a_.collider);
    CrossingQuery pairs;
    bool is_first = true;
    Random random(31);
    for (int step = 0; step < 12; ++step) {
      a_.deform(Bend{.degrees = 5.0 * step});
      b_.deform(Twist{.degrees = 11.0 * step});
      const Vec3 away{random.uniform(-1, 1), 0.12 * step, random.uniform(-0.5, 0.5)};
      b_.collider.set_transform(RigidTransform::from_axis({0.3, 0.2, 1}, 0.4 * step, away));

      add(contacts, collide(a_.collider, b_.collider, {.surfaces = true, .find_crossings = true, .containment = true}));
      add(contacts, collide(a_.collider, b_.collider, {.level = 1, .margin = 0.1}));
      contacts.add(overlap(a_.collider, b_.collider));
      query.set_options({.budget = 40 + 10 * step, .priority = Priority::overlap});
      require(is_first ? query.start(*workers_) : query.carry(*workers_));
      is_first = false;
      add(carried, query.contacts());
      query.set_options({});
      require(query.resume(*workers_));
      add(carried, query.contacts());

      require(pairs.run(a_.collider, b_.collider));
      for (const Crossing& x : pairs.pairs())
        crossing.add(x.facet_a).add(x.facet_b).add(x.segment.from).add(x.segment.to);
      crossing.add(pairs.pairs_tested());

      for (const Budget& budget : {Budget(60), Budget()}) {
        const DistanceBounds bounds = distance.run(a_.collider, b_.collider, {.budget = budget});
        distances.add(bounds.lower).add(bounds.upper).add(bounds.a).add(bounds.b).add(bounds.crossing);
        distances.add(bounds.sphere_tests).add(bounds.facet_tests);
      }
      add_shapes(shapes, random);
      for (int k = 0; k < 20; ++k) {
        const Vec3 p{random.uniform(-2, 2), random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)};
        const PointLocation where = test.locate(p);
        const Probe probe = test.probe({p, 0.2});
        inside.add(where.inside).add(where.winding).add(probe.distance).add(probe.nearest).add(probe.normal);
      }
    }
    const std::string of = " of " + a_.name + " and " + b_.name;
    claims.push_back({"contacts" + of, contacts.value()});
    claims.push_back({"carried contacts" + of, carried.value()});
    claims.push_back({"crossings" + of, crossing.value()});
    claims.push_back({"distances" + of, distances.value()});
    claims.push_back({"primitives" + of, shapes.value()});
    claims.push_back({"inside tests" + of, inside.value()});
  }

 private:
  struct Side {
    Side(std::string_view n, int resolution, Workers& workers)
        : name(n),
          mesh(sample(n, resolution)),
          body(mesh, build(mesh, {.method = Method::octree, .branching = 8, .depth = 3}, workers)),
          collider(mesh, body) {}
    void deform(const Deformation& deformation) {
      positions = morula::deform(mesh, {deformation}, 1);
      require(body.update(positions));
      collider.set_positions(positions);
    }
    std::string name;
    Mesh mesh;
    Body body;
    Collider collider;
    std::vector<Vec3> positions;
  };

  static void add(Sum& sum, const Contacts& found) {
    for (const Contact& c : found.contacts)
      sum.add(c.node_a)
          .add(c.node_b)
          .add(c.finished)
          .add(c.point)
          .add(c.normal)
          .add(c.depth)
          .add(c.lens_volume)
          .add(c.error_bound);
    for (const ContactSurface& s : found.surfaces) sum.add(s.on_a).add(s.on_b).add(s.normal).add(s.depth);
    for (const Crossing& x : found.crossings) sum.add(x.facet_a).add(x.facet_b).add(x.segment.from).add(x.segment.to);
    for (const MutualContainment& m : found.containment) sum.add(m.a_in_b.inside).add(m.b_in_a.inside);
    sum.add(found.pair_tests).add(found.finished_count).add(found.achieved_level);
  }

  void add_shapes(Sum& sum, Random& random) const {
    const auto any = [&] { return random.uniform(-1, 1); };
    const TouchOptions options{.nearest = true, .collect_all = true};
    const auto add_touch = [&](const Touch& t) {
      sum.add(t.deepest.has_value()).add(t.touches).add(t.lower).add(t.facets.size()).add(t.leaves);
      if (t.deepest) sum.add(t.deepest->point).add(t.deepest->depth).add(t.deepest->normal);
    };
    for (int k = 0; k < 4; ++k) {
      add_touch(touch(b_.collider, HalfSpace{normalized(Vec3{any(), any(), 1}), any()}, options));
      add_touch(touch(b_.collider, Sphere{{any(), any(), any()}, 0.4}, options));
      add_touch(touch(b_.collider, Capsule{{any(), any(), any()}, {any(), any(), any()}, 0.2}, options));
      const RayHit hit = first_hit(b_.collider, {{3 * any(), 3 * any(), 3}, {any(), any(), -3}});
      sum.add(hit.first.has_value());
      if (hit.first) sum.add(hit.first->t).add(hit.first->point).add(hit.first->normal);
    }
  }

  Side a_, b_;
  Workers* workers_;
};

}  // namespace

Claims motions(Workers& workers) {
  Claims claims;
  add_updates(claims, "limb", Method::grid, workers);
  add_updates(claims, "torus", Method::octree, workers);
  add_updates(claims, "open bar", Method::octree, workers);
  Pair("limb", "torus", workers).add_claims(claims);
  Pair("blob", "open limb", workers).add_claims(claims);
  return claims;
}

}  // namespace morula::bits
