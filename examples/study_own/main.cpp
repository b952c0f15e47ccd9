// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A study of one's own: a rule, a generator and a metric beside those of Morula, in one plan.
#include <cstdio>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/study.hpp>

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

void add_own(study::Plan& plan) {
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

int main() {
  study::Plan plan{.bodies = {{"limb", sample_body("limb", 12)}}};
  plan.sources = study::sources_of(plan.bodies, {Method::grid});
  plan.motions = study::paper_motions();
  plan.rules = {Rule::traditional, Rule::approach2, Rule::exact};
  plan.samples = 5;
  plan.resolution = 48;
  add_own(plan);
  const study::Study done = study::make_study(plan);
  for (const char* id : {"drift-below-traditional", "drift-tighter-than-exact", "mine-below-generators"})
    if (const study::Claim* claim = study::find_claim(done.claims, id))
      std::printf("%s: %s. %s\n", claim->claim.c_str(), std::string(word(*claim)).c_str(), claim->numbers.c_str());
  return study::faults(plan, done.result).empty() ? 0 : 1;
}
