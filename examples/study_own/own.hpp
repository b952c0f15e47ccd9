// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A rule, a generator and a metric for a plan of a study.
#pragma once

#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/study.hpp>
#include <span>
#include <vector>

namespace example {

using namespace morula;

// [own]
/// A rule: spheres keep their radii and move with the mean of all vertices.
struct Drift {
  const Mesh& rest;
  SphereTree tree;
  SphereTree follow(const std::vector<Vec3>& positions) {
    Vec3 moved{};
    for (std::size_t v = 0; v < positions.size(); ++v) moved += positions[v] - rest.positions[v];
    SphereTree now = tree;
    for (Sphere& sphere : now.spheres) sphere.center += moved / static_cast<double>(positions.size());
    return now;
  }
};

inline void add_own(study::Plan& plan) {
  plan.rules.emplace_back(study::own_rule("drift", [](const Mesh& rest, const CoveredTree& model) {
    return Drift{rest, model.tree};
  }));
  plan.sources.push_back(study::own_source(0, study::own_generator("mine", [](const Mesh& mesh) {
                                             return build(mesh, {.method = Method::grid, .branching = 4});
                                           })));
  plan.metrics.push_back({"mean-radius", "mesh units", [](const Mesh&, std::span<const Sphere> spheres, std::size_t) {
                            double sum = 0;
                            for (const Sphere& sphere : spheres) sum += sphere.radius;
                            return sum / static_cast<double>(spheres.size());
                          }});
}
// [end]

}  // namespace example
