// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches of two small closed bodies whose vertices are moved on a lattice, so that much is flat, equal or in
// line: their volume against clipped tetrahedra, and their sums against each other.
#include <algorithm>
#include <array>
#include <clipped_overlap.hpp>
#include <cmath>
#include <memory>
#include <morula/collide/contact_patches.hpp>
#include <morula/generators/build.hpp>
#include <morula/update/body.hpp>
#include <stdexcept>

#include "fuzz.hpp"

namespace morula::fuzz {
namespace {

void add_cube(Mesh& mesh, const Vec3& at) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int corner = 0; corner < 8; ++corner)
    mesh.positions.push_back(at + Vec3{corner & 1 ? 1.0 : 0.0, corner & 2 ? 1.0 : 0.0, corner & 4 ? 1.0 : 0.0});
  for (const Facet& f :
       {Facet{0, 2, 3}, Facet{0, 3, 1}, Facet{4, 5, 7}, Facet{4, 7, 6}, Facet{0, 1, 5}, Facet{0, 5, 4}, Facet{2, 6, 7},
        Facet{2, 7, 3}, Facet{0, 4, 6}, Facet{0, 6, 2}, Facet{1, 3, 7}, Facet{1, 7, 5}})
    mesh.facets.push_back({f[0] + first, f[1] + first, f[2] + first});
}

/// A closed surface: a tetrahedron, an octahedron, a cube, two cubes, or a cube around a smaller one that is hollow.
Mesh closed_body(Bytes& in) {
  Mesh mesh;
  switch (in.below(5)) {
    case 0:
      mesh = {{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}},
              {Facet{0, 2, 1}, Facet{0, 1, 3}, Facet{0, 3, 2}, Facet{1, 2, 3}}};
      break;
    case 1:
      mesh = {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
              {Facet{0, 2, 4}, Facet{2, 1, 4}, Facet{1, 3, 4}, Facet{3, 0, 4}, Facet{2, 0, 5}, Facet{1, 2, 5},
               Facet{3, 1, 5}, Facet{0, 3, 5}}};
      break;
    case 2:
      add_cube(mesh, {});
      break;
    case 3:
      add_cube(mesh, {});
      add_cube(mesh, {in.flag() ? 0.5 : 1.5, 0, 0});
      break;
    default:
      add_cube(mesh, {});
      add_cube(mesh, {});
      for (std::size_t v = 0; v < 8; ++v) mesh.positions[v] = mesh.positions[v] * 2.0 - Vec3{0.5, 0.5, 0.5};
      for (std::size_t f = 12; f < 24; ++f) std::swap(mesh.facets[f][1], mesh.facets[f][2]);
  }
  return mesh;
}

/// Moves some vertices by multiples of a quarter, all of them by others, and perhaps everything by small amounts.
void disturb(Mesh& mesh, Bytes& in) {
  const auto quarters = [&] { return (static_cast<double>(in.below(9)) - 4) / 4; };
  const auto step = [&] {
    const double x = quarters(), y = quarters();
    return Vec3{x, y, quarters()};
  };
  const Vec3 all = step();
  for (Vec3& p : mesh.positions) p += all;
  for (std::size_t moved = in.below(8); moved > 0; --moved) mesh.positions[in.below(mesh.positions.size())] += step();
  if (!in.flag()) return;
  const double size = std::ldexp(1.0, -static_cast<int>(in.below(52)));
  for (Vec3& p : mesh.positions) p += step() * size;
}

struct SmallBody {
  Mesh mesh;
  std::shared_ptr<const CoveredTree> model;
  Body body;
  Collider collider;

  explicit SmallBody(const Mesh& given)
      : mesh(given),
        model(std::make_shared<CoveredTree>(build(mesh, {.method = Method::octree, .depth = 1}))),
        body(mesh, model),
        collider(mesh, body) {}
  SmallBody(const SmallBody&) = delete;
  SmallBody& operator=(const SmallBody&) = delete;
};

void require_sums(const ContactPatch& patch, double slack) {
  require(patch.volume >= 0, "a patch has a negative volume");
  require(length(patch.a.area_vector + patch.b.area_vector) <= slack, "area vectors of a patch do not add up to 0");
  require(length(patch.a.moment + patch.b.moment) <= slack, "moments of a patch do not add up to 0");
  for (const PatchSide* side : {&patch.a, &patch.b}) {
    Vec3 gradients;
    for (const VertexGradient& g : side->gradients) gradients += g.gradient;
    require(length(gradients - side->area_vector) <= slack, "gradients do not add up to the area vector");
  }
  Vec3 force;
  double volume = 0;
  for (const PatchPoint& point : patch.points) force += point.force, volume += point.volume;
  if (patch.points.empty()) return;
  require(length(force + patch.a.area_vector) <= slack, "forces of points do not add up to that of their patch");
  require(std::abs(volume - patch.volume) <= slack, "volumes of points do not add up to that of their patch");
}

void run(Bytes& in) {
  Mesh first = closed_body(in), second = closed_body(in);
  disturb(first, in);
  disturb(second, in);
  SmallBody a(first), b(second);
  if (in.flag()) {
    const double turn = 0.1 * static_cast<double>(in.byte());
    const double x = static_cast<double>(in.below(5)) - 2, y = static_cast<double>(in.below(5)) - 2;
    b.collider.set_transform(RigidTransform::from_axis({x, y, 1}, turn, {0.125, -0.25, 0.0625}));
  }
  std::unique_ptr<ContactPatchQuery> query;
  try {
    query = std::make_unique<ContactPatchQuery>(a.collider, b.collider);
  } catch (const std::invalid_argument&) {
    return;  // inside out
  }
  const ContactPatchOptions options{.max_points = static_cast<std::uint32_t>(in.below(17)), .depths = in.flag()};
  const Status status = query->run(options);
  if (!status) {
    require(status.code == Status::Code::inside_out, "bodies that are closed are refused");
    require(query->patches().empty(), "a run that was refused has patches");
    return;
  }
  // Coordinates are below 10, areas below 500.
  constexpr double slack = 1e-9;
  const double expected = test::clipped_overlap(a.collider, b.collider).volume;
  // The apexes of the oracle's cones are other ones here. A flat cone makes it wrong.
  if (std::abs(test::clipped_overlap(b.collider, a.collider).volume - expected) > slack) return;
  require(std::abs(query->volume() - expected) <= slack, "the volume is not that of clipped tetrahedra");
  double sum = 0;
  for (const ContactPatch& patch : query->patches()) {
    sum += patch.volume;
    require_sums(patch, slack);
  }
  require(std::abs(sum - query->volume()) <= slack, "volumes of patches do not add up to the volume");
}

}  // namespace
}  // namespace morula::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  morula::fuzz::Bytes in(data, size);
  morula::fuzz::run(in);
  return 0;
}
