// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/medial/medial_balls.hpp>
#include <morula/query/signed_distance.hpp>

#include "claims.hpp"
#include "samples.hpp"

namespace morula::bits {

Mesh sample(std::string_view name, int resolution) {
  const bool is_open = name.starts_with("open ");
  Mesh mesh = sample_body(is_open ? name.substr(5) : name, resolution);
  if (is_open) {
    std::vector<Facet> kept;
    for (std::size_t f = 0; f < mesh.facet_count(); ++f)
      if (f % 7 != 0) kept.push_back(mesh.facets[f]);
    mesh.facets = kept;
  }
  return mesh;
}

std::uint64_t hash_of(const CoveredTree& model) {
  Sum sum;
  const Cover& cover = model.cover;
  sum.add(tree_hash(model.tree)).add(cover.patch_facet).add(cover.corner_begin).add(cover.corners);
  sum.add(cover.region_begin).add(cover.region_end);
  for (const CutPoint& cut : cover.cut_points) sum.add(cut.vertex).add(cut.weight);
  return sum.value();
}

namespace {

std::uint64_t figures(const Mesh& mesh, const SphereTree& tree, const VoxelGrid& grid, Workers& workers) {
  Sum sum;
  for (const LevelMeasure& m : measure(mesh, tree, {.grid = grid}, workers)) {
    const Looseness& l = m.looseness;
    sum.add(l.looseness).add(l.missed_volume).add(l.outside_volume).add(l.object_volume).add(l.union_volume);
    sum.add(l.voxels).add(l.voxel_edge);
    const Coverage& c = m.coverage;
    sum.add(c.covered)
        .add(c.uncovered_area)
        .add(c.uncovered_distance)
        .add(c.uncovered_distance_upper)
        .add(c.tolerance)
        .add(c.worst_facet);
    sum.add(m.spheres).add(m.protrusion.has_value());
    if (m.protrusion) sum.add(m.protrusion->worst).add(m.protrusion->mean);
  }
  return sum.value();
}

// Smaller spheres than were built, so that there is something bare to measure.
SphereTree shrunk(SphereTree tree) {
  for (Sphere& s : tree.spheres) s.radius *= 0.93;
  return tree;
}

void add_numbers(Claims& claims) {
  Sum angles;
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    const SinCos turn = sin_cos(10 * x);
    angles.add(turn.sin).add(turn.cos).add(angle_of(y, x)).add(angle_of(0.001 * y, x));
  }
  claims.push_back({"sines and angles", angles.value()});
}

void add_queries(Claims& claims, std::string_view name, Workers& workers) {
  const Mesh mesh = sample(name, 12);
  const SignedDistance shape(mesh, workers);
  const Box box = bounding_box(mesh);
  Random random(5);
  Sum distances, volumes;
  for (int i = 0; i < 300; ++i) {
    Vec3 p = box.center();
    for (int axis = 0; axis < 3; ++axis) p[axis] += random.uniform(-0.7, 0.7) * box.extent()[axis];
    const SignedDistance::Result found = shape.at(p);
    distances.add(found.distance).add(found.closest.facet).add(shape.bvh().winding_number(p));
    if (shape.has_volume()) volumes.add(inside_volume(shape, {p, random.uniform(0, 0.3) * box.diagonal()}));
  }
  const std::string of = " of " + std::string(name);
  claims.push_back({"signed distances" + of, distances.value()});
  claims.push_back({"volumes of balls inside" + of, volumes.value()});

  std::vector<Vec3> points, normals;
  for (const SurfacePoint& s : sample_surface(mesh, 400, 7)) {
    const Triangle t = mesh.corners(s.facet);
    points.push_back(s.point), normals.push_back(normalized(cross(t[1] - t[0], t[2] - t[0])));
  }
  for (const bool voronoi : {false, true}) {
    const MedialBalls medial =
        voronoi ? voronoi_balls(shape, points) : shrinking_balls(shape, points, normals, workers);
    claims.push_back({(voronoi ? "Voronoi balls" : "shrunk balls") + of,
                      Sum().add(medial.balls).add(medial.neighbor_begin).add(medial.neighbors).value()});
  }
}

}  // namespace

Claims shapes(Workers& workers) {
  Claims claims;
  add_numbers(claims);
  for (const std::string_view name : sample_body_names())
    claims.push_back({"sample " + std::string(name), mesh_hash(sample_body(name, 24))});

  for (const std::string_view name : {"limb", "two", "bar", "open torus"}) {
    const Mesh mesh = sample(name, 9);
    for (const Method method : all_methods()) {
      // The slow ones once.
      const bool is_slow = method == Method::combined || method == Method::optimized;
      if (is_slow && name == "bar") continue;
      const bool is_quick = method == Method::optimized && name != "limb";
      const Quality quality = is_quick ? Quality::fast : Quality::standard;
      const CoveredTree model =
          build(mesh, {.method = method, .branching = 6, .depth = 2, .quality = quality}, workers);
      const std::string of = " of " + std::string(name) + " by " + std::string(morula::name(method));
      claims.push_back({"tree" + of, hash_of(model)});
      claims.push_back({"covered" + of, hash_of(cover(mesh, shrunk(model.tree), {}, workers))});
      if (method == Method::octree || method == Method::grid) {
        claims.push_back({"figures" + of, figures(mesh, model.tree, {.resolution = 48}, workers)});
        claims.push_back({"bare figures" + of, figures(mesh, shrunk(model.tree), {.resolution = 48}, workers)});
      }
    }
  }
  const Mesh blob = sample("blob", 10);
  for (const Quality quality : {Quality::draft, Quality::fast})
    claims.push_back({"tree of blob by morula, " + std::string(name(quality)),
                      hash_of(build(blob, {.branching = 8, .depth = 3, .quality = quality}, workers))});
  for (const Optimizer optimizer : {Optimizer::recenter, Optimizer::simplex, Optimizer::balance})
    claims.push_back(
        {"tree of blob by medial and " + std::string(name(optimizer)), hash_of(build(blob,
                                                                                     {.method = Method::medial,
                                                                                      .branching = 5,
                                                                                      .depth = 1,
                                                                                      .reducers = {Reduction::burst},
                                                                                      .optimizer = optimizer},
                                                                                     workers))});
  claims.push_back({"40 spheres of blob", hash_of(build(blob, {.spheres = 40, .quality = Quality::fast}, workers))});
  claims.push_back({"flat set of blob by protrusion",
                    hash_of(build(blob, {.method = Method::grid, .max_protrusion = 0.15}, workers))});
  for (const std::string_view name : {"limb", "open limb", "two"}) add_queries(claims, name, workers);
  return claims;
}

}  // namespace morula::bits
