// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/power_diagram.hpp>
#include <numeric>
#include <set>

namespace morula {
namespace {

std::vector<Sphere> random_spheres(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i)
    spheres.push_back({{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0, 0.5)});
  return spheres;
}

Vec3 random_point(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

std::uint32_t owner_by_force(std::span<const Sphere> spheres, const Vec3& x) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < spheres.size(); ++i)
    if (power(spheres[i], x) < power(spheres[best], x)) best = i;
  return best;
}

double share(std::span<const Barycentric> polygon) {  // of the facet, signed
  double sum = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Barycentric &a = polygon[0], &b = polygon[k - 1], &c = polygon[k];
    sum += (b[1] - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (b[2] - a[2]);
  }
  return sum;
}

bool contains(std::span<const Barycentric> polygon, const Barycentric& x, double margin) {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Barycentric &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if ((b[1] - a[1]) * (x[2] - a[2]) - (x[1] - a[1]) * (b[2] - a[2]) < -margin) return false;
  }
  return true;
}

TEST(PowerDiagram, pieces_tile_the_facet_and_belong_to_the_sphere_of_least_power) {
  Random random(1);
  std::vector<std::uint32_t> scratch;
  CutFacet cut;
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<Sphere> spheres = random_spheres(1 + trial % 40, 100 + trial);
    const PowerDiagram diagram(spheres);
    const FacetGeometry facet{{random_point(random), random_point(random), random_point(random)}, {5, 2, 9}};
    cut.clear();
    diagram.cut(facet, scratch, cut);
    double total = 0;
    for (std::size_t k = 0; k < cut.size(); ++k) {
      const double s = share(cut.polygon(k));
      EXPECT_GE(s, -1e-14);
      total += s;
      for (const Barycentric& b : cut.polygon(k)) {
        const Vec3 x = at_barycentric(facet.corners, b);
        EXPECT_NEAR(power(spheres[cut.owner[k]], x), power(spheres[owner_by_force(spheres, x)], x), 1e-13);
      }
    }
    EXPECT_NEAR(total, 1, 1e-13);
    for (int i = 0; i < 30; ++i) {  // every point is in a piece of its owner
      const double r = std::sqrt(random.uniform()), s = random.uniform();
      const Barycentric b{1 - r, r * (1 - s), r * s};
      const std::uint32_t owner = owner_by_force(spheres, at_barycentric(facet.corners, b));
      bool found = false;
      for (std::size_t k = 0; k < cut.size() && !found; ++k)
        found = cut.owner[k] == owner && contains(cut.polygon(k), b, 1e-9);
      EXPECT_TRUE(found);
    }
  }
}

TEST(PowerDiagram, one_facet_falls_into_thousands_of_pieces) {
  Random random(7);
  constexpr int across = 60;
  for (const double jitter : {0.0, 0.4}) {  // aligned cells with ties, and cells of any shape
    std::vector<Sphere> spheres;
    for (int y = 0; y < across; ++y)
      for (int x = 0; x < across; ++x)
        spheres.push_back(
            {{(x + jitter * random.uniform()) / across, (y + jitter * random.uniform()) / across, 0}, 0.1});
    const FacetGeometry facet{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}, {0, 1, 2}};
    std::vector<std::uint32_t> scratch;
    CutFacet cut;
    PowerDiagram(spheres).cut(facet, scratch, cut);
    double total = 0;
    std::set<std::uint32_t> owners;
    for (std::size_t k = 0; k < cut.size(); ++k) {
      total += share(cut.polygon(k));
      owners.insert(cut.owner[k]);
      Barycentric middle{};
      for (const Barycentric& b : cut.polygon(k))
        for (int c = 0; c < 3; ++c) middle[c] += b[c] / static_cast<double>(cut.polygon(k).size());
      const Vec3 x = at_barycentric(facet.corners, middle);
      EXPECT_NEAR(power(spheres[cut.owner[k]], x), power(spheres[owner_by_force(spheres, x)], x), 1e-13);
    }
    EXPECT_NEAR(total, 1, 1e-12);
    EXPECT_GT(owners.size(), 1700u);  // half of 3,600
  }
}

TEST(PowerDiagram, index_agrees_with_brute_force) {
  Random random(2);
  std::vector<std::uint32_t> candidates;
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<Sphere> spheres = random_spheres(1 + 7 * trial, trial);
    const PowerDiagram diagram(spheres);
    const Triangle t{random_point(random), random_point(random), random_point(random)};
    diagram.candidates(t, candidates);
    EXPECT_TRUE(std::is_sorted(candidates.begin(), candidates.end()));
    for (int i = 0; i < 50; ++i) {
      const double r = std::sqrt(random.uniform()), s = random.uniform();
      const Vec3 x = at_barycentric(t, {1 - r, r * (1 - s), r * s});
      const std::uint32_t owner = owner_by_force(spheres, x);
      EXPECT_EQ(diagram.owner(x), owner);
      EXPECT_TRUE(std::binary_search(candidates.begin(), candidates.end(), owner));
    }
    const PowerDiagram::Growth growth = diagram.least_growth(t);
    PowerDiagram::Growth expected{0, std::numeric_limits<double>::infinity()};
    for (std::uint32_t i = 0; i < spheres.size(); ++i)
      if (const double g = farthest_distance(spheres[i].center, t) - spheres[i].radius; g < expected.amount)
        expected = {i, g};
    EXPECT_EQ(growth.sphere, expected.sphere);
    EXPECT_EQ(growth.amount, expected.amount);
  }
}

TEST(PowerDiagram, equal_and_nested_spheres_leave_the_lower_index_or_the_stronger_sphere) {
  const FacetGeometry facet{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}, {0, 1, 2}};
  std::vector<std::uint32_t> scratch;
  CutFacet cut;
  const std::vector<Sphere> equal{{{0.3, 0.3, 0}, 1}, {{0.3, 0.3, 0}, 1}, {{0.3, 0.3, 0}, 1}};
  PowerDiagram(equal).cut(facet, scratch, cut);
  EXPECT_EQ(cut.owner, (std::vector<std::uint32_t>{0}));
  cut.clear();
  const std::vector<Sphere> nested{{{0.3, 0.3, 0}, 1}, {{0.3, 0.3, 0}, 2}};
  PowerDiagram(nested).cut(facet, scratch, cut);
  EXPECT_EQ(cut.owner, (std::vector<std::uint32_t>{1}));
}

TEST(PowerDiagram, equal_spheres_on_a_lattice_cut_along_the_cell_walls) {
  const FacetGeometry facet{{Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{-1, 1, 0}}, {0, 1, 2}};
  const std::vector<Sphere> spheres{{{-0.5, -0.5, 0}, 1}, {{0.5, -0.5, 0}, 1}, {{-0.5, 0.5, 0}, 1}};
  std::vector<std::uint32_t> scratch;
  CutFacet cut;
  PowerDiagram(spheres).cut(facet, scratch, cut);
  std::map<std::uint32_t, double> shares;
  for (std::size_t k = 0; k < cut.size(); ++k) shares[cut.owner[k]] += share(cut.polygon(k));
  EXPECT_NEAR(shares[0], 0.5, 1e-15);
  EXPECT_NEAR(shares[1], 0.25, 1e-15);
  EXPECT_NEAR(shares[2], 0.25, 1e-15);
}

TEST(PowerDiagram, facets_on_both_sides_of_an_edge_find_the_same_cut_points) {
  const Mesh mesh = sample_body("torus", 12);
  const std::vector<Sphere> spheres = random_spheres(30, 77);
  const PowerDiagram diagram(spheres);
  std::vector<std::uint32_t> scratch;
  CutFacet cut;
  // Per mesh edge and direction of travel: weights of the higher vertex where two owners meet. (Where one owner's
  // pieces meet, a facet may have a cut that its neighbor does without.)
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Edge, std::set<double>> found[2];
  for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) {
    const Facet& facet = mesh.facets[f];
    cut.clear();
    diagram.cut({mesh.corners(f), facet}, scratch, cut);
    std::map<Barycentric, std::set<std::uint32_t>> owners;
    for (std::size_t k = 0; k < cut.size(); ++k)
      for (const Barycentric& b : cut.polygon(k)) owners[b].insert(cut.owner[k]);
    for (const auto& [b, who] : owners)
      for (int k = 0; k < 3; ++k) {
        const int from = (k + 1) % 3, to = (k + 2) % 3;
        if (b[k] != 0 || b[from] == 0 || b[to] == 0 || who.size() < 2) continue;
        const bool forward = facet[from] < facet[to];
        found[forward][std::minmax({facet[from], facet[to]})].insert(forward ? b[to] : b[from]);
      }
  }
  ASSERT_GT(found[0].size(), 100u);
  EXPECT_EQ(found[0], found[1]);
}

TEST(PowerDiagram, never_cuts_a_facet_with_a_repeated_vertex) {
  const FacetGeometry segment{{Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 0, 0}}, {0, 1, 1}};
  const std::vector<Sphere> spheres{{{-1, 0, 0}, 0.2}, {{1, 0, 0}, 0.3}, {{0, 0, 0}, 0.9}};
  std::vector<std::uint32_t> scratch;
  CutFacet cut;
  PowerDiagram(spheres).cut(segment, scratch, cut);
  EXPECT_EQ(cut.owner, (std::vector<std::uint32_t>{2}));  // the one that grows least
}

}  // namespace
}  // namespace morula
