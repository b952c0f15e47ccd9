// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario layers: a sheet of as many cells as the mesh has facets, up to 5,000, waves over the mesh's top, at most a
// cell away. Times include the update of the sheet. The peer is the proximity query of the same pairs, which a solver
// would sum up by itself. Verified: reaction equals action, and steps change the volume as gradients say.
#include <algorithm>
#include <cmath>
#include <morula/surface/layer_patches.hpp>
#include <morula/surface/proximity.hpp>

#include "resources.hpp"
#include "scenario.hpp"

namespace morula::bench {
namespace {

constexpr int frames = 24;

/// A sheet over the top of a box, and its cells.
struct Sheet {
  Mesh mesh;
  double cell;

  Sheet(const Box& box, int n) : cell(std::max(box.extent().x, box.extent().y) / n) {
    const auto corner = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        mesh.positions.push_back({box.lower.x + cell * i, box.lower.y + cell * j, box.upper.z});
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        mesh.facets.push_back({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
        mesh.facets.push_back({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
      }
  }
  std::vector<Vec3> at(double t) const {
    std::vector<Vec3> positions = mesh.positions;
    for (Vec3& p : positions) p.z += cell * (0.3 + 0.25 * std::sin(8 * t + (p.x + 2 * p.y) / (4 * cell)));
    return positions;
  }
};

/// Compares the change of the volume in a small step of the sheet with its gradients.
void verify(LayerPatchQuery& query, SurfaceTree& sheet, const SurfaceTree& body, const Sheet& of, double t,
            Result& result) {
  const std::vector<Vec3> before = of.at(t), after = of.at(t + 1e-6);
  double change = 0, volumes[2];
  require(sheet.update(before));
  require(query.run(sheet, body));
  volumes[0] = query.volume();
  double moved = 0;
  for (const LayerPatch& patch : query.patches()) {
    result.expect(length(patch.a.area_vector + patch.b.area_vector) <= 1e-11 * (patch.a.area + patch.b.area),
                  "action is not reaction");
    for (const VertexGradient& g : patch.a.gradients) {
      change += dot(g.gradient, after[g.vertex] - before[g.vertex]);
      moved += std::abs(dot(g.gradient, after[g.vertex] - before[g.vertex]));
    }
  }
  require(sheet.update(after));
  require(query.run(sheet, body));
  volumes[1] = query.volume();
  result.expect(volumes[0] > 0, "nothing is near");
  result.expect(std::abs(volumes[1] - volumes[0] - change) <= 1e-3 * moved, "not the change that gradients say");
}

}  // namespace

std::vector<Result> run_layers(const Input& input, const Settings& settings) {
  const auto cells = static_cast<int>(std::sqrt(std::min<double>(5000, static_cast<double>(input.mesh.facet_count()))));
  const Sheet of(bounding_box(input.mesh), std::max(4, cells));
  SurfaceTree sheet(of.mesh), body(input.mesh);
  LayerPatchQuery query({.thickness = of.cell});
  ProximityQuery near({.distance = of.cell});
  Result own{.scenario = "layers", .item = "patches", .mesh = input.name};
  Result peer{.scenario = "layers", .item = "proximity", .mesh = input.name};
  double patches = 0, facets = 0, pairs = 0;
  for (int f = 0; f < frames; f += 6) verify(query, sheet, body, of, static_cast<double>(f) / frames, own);
  timed(settings, [&] {
    for (int f = 0; f < frames; ++f) {
      const std::vector<Vec3> positions = of.at(static_cast<double>(f) / frames);
      const double moving = processor_seconds_of([&] { require(sheet.update(positions)); });
      own.seconds.push_back(moving + processor_seconds_of([&] { require(query.run(sheet, body)); }));
      peer.seconds.push_back(moving + processor_seconds_of([&] { require(near.run(sheet, body)); }));
      patches += static_cast<double>(query.patches().size());
      pairs += static_cast<double>(near.pairs().size());
      for (const LayerPatch& patch : query.patches())
        facets += static_cast<double>(patch.a.facets.size() + patch.b.facets.size());
    }
  });
  const double count = static_cast<double>(own.seconds.size());
  own.figures = {{"patches", patches / count},
                 {"facets", facets / count},
                 {"times_proximity", median(own.seconds) / median(peer.seconds)}};
  peer.figures = {{"pairs", pairs / count}};
  return {own, peer};
}

}  // namespace morula::bench
