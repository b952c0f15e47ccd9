// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Long, thin facets: how many patches and how much memory their trees take, beside those of ordinary facets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sampling.hpp>
#include <numbers>
#include <set>
#include <support/allocations.hpp>
#include <support/methods.hpp>

namespace morula {
namespace {

struct Body {
  const char* name;
  Mesh mesh;
};

// A cylinder along z between fans about the middle of its ends.
Mesh cylinder(std::uint32_t sides, std::uint32_t rings, double length, double radius) {
  Mesh mesh;
  for (std::uint32_t ring = 0; ring <= rings; ++ring)
    for (std::uint32_t side = 0; side < sides; ++side) {
      const double angle = 2 * std::numbers::pi * side / sides;
      mesh.positions.push_back({radius * std::cos(angle), radius * std::sin(angle), length * ring / rings});
    }
  const auto bottom = static_cast<std::uint32_t>(mesh.vertex_count());
  mesh.positions.push_back({0, 0, 0});
  mesh.positions.push_back({0, 0, length});
  for (std::uint32_t side = 0; side < sides; ++side) {
    const std::uint32_t next = (side + 1) % sides, top = rings * sides;
    for (std::uint32_t ring = 0; ring < top; ring += sides) {
      mesh.facets.push_back({ring + side, ring + next, ring + sides + next});
      mesh.facets.push_back({ring + side, ring + sides + next, ring + sides + side});
    }
    mesh.facets.push_back({bottom, next, side});
    mesh.facets.push_back({bottom + 1, top + side, top + next});
  }
  return mesh;
}

// Open: facets from one point to a circle that is bent out of its plane.
Mesh fan(std::uint32_t facets) {
  Mesh mesh{{{0, 0, 1}}, {}};
  for (std::uint32_t k = 0; k < facets; ++k) {
    const double angle = 2 * std::numbers::pi * k / facets;
    mesh.positions.push_back({std::cos(angle), std::sin(angle), 0.2 * std::cos(3 * angle)});
    mesh.facets.push_back({0, 1 + k, 1 + (k + 1) % facets});
  }
  return mesh;
}

// A strip to and fro, each facet reaching from one border to the other.
Mesh slivers(std::uint32_t facets) {
  Mesh mesh;
  for (std::uint32_t k = 0; k < facets + 2; ++k)
    mesh.positions.push_back({0.002 * k, k % 2 == 0 ? 0.0 : 3.0, 0.3 * std::sin(0.02 * k)});
  for (std::uint32_t k = 0; k < facets; ++k)
    mesh.facets.push_back(k % 2 == 0 ? Facet{k, k + 1, k + 2} : Facet{k + 1, k, k + 2});
  return mesh;
}

Mesh with_degenerate_facets(Mesh mesh) {
  const auto last = static_cast<std::uint32_t>(mesh.vertex_count() - 1);
  mesh.facets.push_back({0, 0, last});
  mesh.facets.push_back({0, last, last});
  mesh.facets.push_back({last, last, last});
  // Three vertices on a line.
  mesh.positions.push_back((mesh.positions[0] + mesh.positions[last]) * 0.5);
  mesh.facets.push_back({0, last + 1, last});
  return mesh;
}

const std::vector<Body>& needles() {
  static const std::vector<Body> bodies{
      {"rod", cylinder(48, 1, 200, 0.5)},
      {"rod far away",
       [] {
         Mesh mesh = cylinder(24, 1, 200, 0.5);
         for (Vec3& p : mesh.positions) p = p + Vec3{3e6, -1e6, 2e6};
         return mesh;
       }()},
      {"drum", cylinder(64, 1, 2, 1)},
      {"fan", fan(64)},
      {"slivers", slivers(96)},
      {"one facet", Mesh{{{0, 0, 0}, {10, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}}},
      {"one needle", Mesh{{{0, 0, 0}, {1000, 0, 1}, {500, 0.001, 0}}, {{0, 1, 2}}}},
      {"degenerate", with_degenerate_facets(cylinder(16, 1, 50, 0.5))},
  };
  return bodies;
}

BuildOptions quick(Method method, std::optional<int> depth) {
  return {.method = method, .depth = depth, .quality = method == Method::optimized ? Quality::fast : Quality::standard};
}

// Counted from the arrays, facet by facet.
struct Counts {
  std::size_t most_of_a_facet = 0;
  std::size_t owners = 0;           // pairs of a leaf and a facet of which it owns some
  std::size_t owned_in_pieces = 0;  // patches beyond the first of such a pair
};

Counts counts_of(const CoveredTree& model) {
  Counts counts;
  std::map<std::uint32_t, std::size_t> patches;
  std::set<std::pair<std::uint32_t, std::uint32_t>> owners;
  const Cover& cover = model.cover;
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
    for (std::uint32_t p = cover.region_begin[node]; model.tree.is_leaf(node) && p < cover.region_end[node]; ++p) {
      counts.most_of_a_facet = std::max(counts.most_of_a_facet, ++patches[cover.patch_facet[p]]);
      owners.insert({node, cover.patch_facet[p]});
    }
  counts.owners = owners.size();
  counts.owned_in_pieces = cover.patch_count() - owners.size();
  return counts;
}

// In extended precision, by points of facets: each is in some sphere of every level.
void expect_cover(const Mesh& mesh, const SphereTree& tree, const std::string& name) {
  using Real = long double;
  Random random(3);
  for (std::size_t sample = 0; sample < 300; ++sample) {
    const Triangle t =
        mesh.corners(static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(mesh.facet_count())));
    // Some on edges and at vertices.
    Real u = random.uniform(), v = random.uniform() < 0.2 ? 0 : random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    if (sample % 7 == 0) u = 1, v = 0;
    const auto at = [&](int axis) { return (1 - u - v) * t[0][axis] + u * t[1][axis] + v * t[2][axis]; };
    for (std::size_t level = 0; level < tree.level_count(); ++level) {
      bool inside = false;
      for (const Sphere& s : level_set_spheres(tree, level))
        inside = inside || std::hypot(at(0) - s.center.x, at(1) - s.center.y, at(2) - s.center.z) <= s.radius;
      EXPECT_TRUE(inside) << name << ", level " << level;
    }
  }
}

class NeedlesBy : public test::ByMethod {};

// However often a facet was cut, what a leaf has of it is one patch, but for a few that are not convex. A single facet
// that is as wide as hundreds of leaves has more of these: exchange gives away what fits, whatever shape is left.
TEST_P(NeedlesBy, are_in_about_as_many_patches_as_they_have_owners) {
  for (const auto& [name, mesh] : needles())
    for (const int depth : {2, 3}) {
      if (depth == 3 && mesh.facet_count() > 4) continue;
      SCOPED_TRACE(std::string(name) + ", depth " + std::to_string(depth));
      const CoveredTree model = build(mesh, quick(GetParam(), depth));
      const Counts counts = counts_of(model);
      EXPECT_EQ(model.report.most_patches_of_a_facet, counts.most_of_a_facet);
      EXPECT_EQ(model.cover.most_patches_of_a_facet(), counts.most_of_a_facet);
      EXPECT_LE(counts.owned_in_pieces, mesh.facet_count() == 1 ? 5 * counts.owners : counts.owners / 2)
          << counts.owners;
      const auto faults = validate(mesh, model);
      EXPECT_TRUE(faults.empty()) << faults.front();
      expect_cover(mesh, model.tree, name);
    }
}
INSTANTIATE_TEST_SUITE_P(Quick, NeedlesBy, testing::ValuesIn(test::quick_methods), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, NeedlesBy, testing::ValuesIn(test::slow_methods), test::method_name);

struct Cost {
  std::size_t patches;
  std::size_t bytes;      // that the tree and its cover hold
  std::size_t allocated;  // by the build, all together
};

// By the allocator.
Cost cost_of(const Mesh& mesh, const BuildOptions& options) {
  build(mesh, options);  // what is made once stays
  const std::size_t live = test::live_bytes, allocated = test::allocated_bytes;
  const CoveredTree model = build(mesh, options);
  return {model.cover.patch_count(), test::live_bytes - live, test::allocated_bytes - allocated};
}

class AutomaticDepthBy : public test::ByMethod {};

TEST_P(AutomaticDepthBy, of_needles_costs_at_most_three_times_as_much_as_of_ordinary_facets) {
  // As many facets of the same body: sides × rings.
  struct Pair {
    const char* name;
    Mesh needles, ordinary;
  };
  const Pair pairs[] = {
      {"rod", cylinder(256, 1, 1000, 0.5), cylinder(8, 63, 1000, 0.5)},
      {"drum", cylinder(256, 1, 2, 1), cylinder(32, 15, 2, 1)},
  };
  for (const auto& [name, needles, ordinary] : pairs) {
    ASSERT_EQ(needles.facet_count(), ordinary.facet_count());
    const BuildOptions options = quick(GetParam(), std::nullopt);
    const Cost of_needles = cost_of(needles, options), of_ordinary = cost_of(ordinary, options);
    EXPECT_LE(of_needles.patches, 3 * of_ordinary.patches) << name;
    // A patch that is cut takes some three times the memory of a whole facet.
    EXPECT_LE(of_needles.bytes, 4 * of_ordinary.bytes) << name;
    EXPECT_LE(of_needles.allocated, 3 * of_ordinary.allocated) << name;
  }
}
INSTANTIATE_TEST_SUITE_P(Quick, AutomaticDepthBy, testing::ValuesIn(test::quick_methods), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, AutomaticDepthBy, testing::ValuesIn(test::slow_methods), test::method_name);

TEST(AutomaticDepth, is_less_for_needles_and_the_same_for_ordinary_facets) {
  EXPECT_EQ(automatic_depth(1024, 8), 2);
  EXPECT_EQ(automatic_depth(cylinder(8, 63, 1000, 0.5), 8), 2);
  EXPECT_EQ(automatic_depth(cylinder(256, 1, 1000, 0.5), 8), 1);
  EXPECT_EQ(automatic_depth(cylinder(32, 15, 2, 1), 8), 2);
  EXPECT_EQ(automatic_depth(cylinder(100, 159, 2, 1), 8), 3);
  EXPECT_EQ(automatic_depth(cylinder(8000, 1, 2, 1), 8), 1);
  EXPECT_EQ(automatic_depth(cylinder(4000, 3, 2, 1), 8), 2);
  // A few needles among many ordinary facets do not matter.
  Mesh mixed = cylinder(32, 31, 2, 1);
  for (std::uint32_t k = 0; k < 20; ++k) mixed.facets.push_back({k, k + 1, 32 * 31 + k});
  EXPECT_EQ(automatic_depth(mixed, 8), automatic_depth(mixed.facet_count(), 8));
  // Never more than by number, never less than 1; surfaces without area and scaled ones are no special case.
  for (const double scale : {1.0, 0x1p-90, 0x1p90}) {
    Mesh rod = cylinder(256, 1, 1000, 0.5);
    for (Vec3& p : rod.positions) p = p * scale;
    for (int branching = 2; branching <= 64; branching *= 2) {
      const int depth = automatic_depth(rod, branching);
      EXPECT_GE(depth, 1);
      EXPECT_LE(depth, automatic_depth(rod.facet_count(), branching));
      Mesh line = rod;
      for (Vec3& p : line.positions) p.x = p.y = 0;
      EXPECT_GE(automatic_depth(line, branching), 1);
      for (Vec3& p : line.positions) p.z = scale;
      EXPECT_EQ(automatic_depth(line, branching), automatic_depth(rod.facet_count(), branching));
    }
    EXPECT_EQ(automatic_depth(rod, 8), 1) << scale;
  }
}

}  // namespace
}  // namespace morula
