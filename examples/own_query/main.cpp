// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A query of your own over the published pair walk: how many pairs of leaves, of spheres above a size, are nearer than
// d?
#include <cstdio>
#include <morula/morula.hpp>

using namespace morula;

struct Large {
  double least_radius;
  bool operator()(const Collider& body, std::uint32_t node) const {
    return body.sphere_state().sphere(node).radius >= least_radius;
  }
};

// A pair that fails the filter is skipped with all below it: of interest are leaves below large spheres only.
template <class Filter>
std::size_t count_near(const Collider& a, const Collider& b, double d, const Filter& filter) {
  std::size_t count = 0;
  walk_pairs(a, b, {.margin = d}, [&](NodePair pair, bool is_final) {
    if (!filter(a, pair.a) || !filter(b, pair.b)) return Step::skip;
    if (is_final) ++count;
    return Step::open;
  });
  return count;
}

// The same by looking at all pairs of leaves, and at the spheres above each.
template <class Filter>
std::size_t count_slowly(const Collider& a, const Collider& b, double d, const Filter& filter, double unsure) {
  const auto gap = [&](std::uint32_t i, std::uint32_t j) {
    const Sphere s = a.sphere_state().sphere(i), t = b.sphere_state().sphere(j);
    return distance(a.transform()(s.center), b.transform()(t.center)) - s.radius - t.radius;
  };
  const auto path = [](const SphereTree& tree, std::uint32_t node) {
    std::vector<std::uint32_t> nodes;
    for (; node != no_node; node = tree.parent[node]) nodes.insert(nodes.begin(), node);
    return nodes;
  };
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < a.tree().node_count(); ++i)
    for (std::uint32_t j = 0; j < b.tree().node_count(); ++j) {
      if (!a.tree().is_leaf(i) || !b.tree().is_leaf(j)) continue;
      const auto above_a = path(a.tree(), i), above_b = path(b.tree(), j);
      bool near = true;
      for (std::size_t k = 0; k < std::max(above_a.size(), above_b.size()); ++k) {
        const std::uint32_t x = above_a[std::min(k, above_a.size() - 1)], y = above_b[std::min(k, above_b.size() - 1)];
        near = near && gap(x, y) <= d + unsure && filter(a, x) && filter(b, y);
      }
      count += near;
    }
  return count;
}

int main() {
  const Mesh limb = sample_body("limb", 12), torus = sample_body("torus", 12);
  const CoveredTree built_limb = build(limb, {.depth = 2}), built_torus = build(torus, {.depth = 2});
  const Body body_limb(limb, built_limb), body_torus(torus, built_torus);
  const Collider a(limb, body_limb);
  Collider b(torus, body_torus);
  int failures = 0;
  for (int i = 0; i < 12; ++i) {
    b.set_transform(RigidTransform::from_axis({1, 2, 3}, 0.5 * i, {0.2 * i, 0.1, 0}));
    const Large filter{0.15};
    const std::size_t found = count_near(a, b, 0.1, filter);
    // Tests of spheres err on the near side, by less than 1e-5 here.
    const bool good = found >= count_slowly(a, b, 0.1, filter, 0) && found <= count_slowly(a, b, 0.1, filter, 1e-5);
    failures += !good;
    std::printf("transform %2d: %5zu pairs of large leaves nearer than 0.1%s\n", i, found, good ? "" : " WRONG");
  }
  return failures == 0 ? 0 : 1;
}
