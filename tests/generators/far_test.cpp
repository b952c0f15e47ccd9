// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies so far from the origin that the rounding of their coordinates is a part of their size.
#include <gtest/gtest.h>

#include <generators/divide/exchange.hpp>
#include <generators/reduce/reduce.hpp>
#include <generators/reduce/reducers.hpp>
#include <morula/generators/build.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <support/meshes.hpp>
#include <support/methods.hpp>

namespace morula {
using namespace detail;
namespace {

using Wide = Vector3<long double>;

// Two bodies that builds were found not to cover, at their place: unit cubes that touch, each with its own vertices.
Mesh cubes(std::span<const Vec3> lower) {
  Mesh mesh;
  for (const Vec3& p : lower) {
    const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
    for (int i = 0; i < 8; ++i) mesh.positions.push_back(p + Vec3(i & 1, i >> 1 & 1, i >> 2));
    for (const auto& [a, b, c] : {Facet{0, 2, 1},
                                  {1, 2, 3},
                                  {4, 5, 6},
                                  {5, 7, 6},
                                  {0, 1, 4},
                                  {1, 5, 4},
                                  {2, 6, 3},
                                  {3, 6, 7},
                                  {0, 4, 2},
                                  {2, 4, 6},
                                  {1, 3, 5},
                                  {3, 7, 5}})
      mesh.facets.push_back({first + a, first + b, first + c});
  }
  return mesh;
}
Mesh far_cubes() {
  const std::array<Vec3, 8> lower{Vec3{0, 0, 0}, {-1, -2, 1}, {1, -2, 1},  {0, 1, 0},
                                  {-1, -2, 1},   {-1, 0, -1}, {0, -2, -1}, {0, -2, -2}};
  return test::translated(cubes(lower), {27238347227025.852, 48894146708829.438, -24953405017700.152});
}

// Half of the smallest radius that is divided.
double rounding_of(const Mesh& mesh) {
  return largest_coordinate(mesh) * 0x1p-48;
}

// The cover, in the wider arithmetic of long double: every corner of a node's region in its sphere.
long double worst_excess(const Mesh& mesh, const CoveredTree& model) {
  long double worst = -std::numeric_limits<long double>::infinity();
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
    for (const std::uint32_t corner : model.cover.region_corners(node)) {
      Wide p{};
      if (corner < mesh.vertex_count()) {
        p = Wide(mesh.positions[corner]);
      } else {
        const CutPoint& cut = model.cover.cut_points[corner - mesh.vertex_count()];
        for (int k = 0; k < 3; ++k) p += Wide(mesh.positions[cut.vertex[k]]) * static_cast<long double>(cut.weight[k]);
      }
      const Sphere& s = model.tree.spheres[node];
      worst = std::max(worst, length(p - Wide(s.center)) - static_cast<long double>(s.radius));
    }
  return worst;
}

void expect_covers(const Mesh& mesh, const BuildOptions& options, const std::string& what) {
  const CoveredTree model = build(mesh, options);
  const auto faults = validate(mesh, model);
  EXPECT_TRUE(faults.empty()) << what << ": " << faults.front();
  // What long double loses is a two-thousandth of what double does.
  EXPECT_LE(worst_excess(mesh, model), 0x1p-58L * largest_coordinate(mesh)) << what;
}

class FarBuildBy : public test::ByMethod {};

TEST_P(FarBuildBy, covers_bodies_of_a_thousand_roundings) {
  const Mesh mesh = far_cubes();
  for (std::uint64_t seed = 1; seed <= 2; ++seed)
    expect_covers(mesh, {.method = GetParam(), .depth = 2, .seed = seed, .quality = Quality::standard},
                  std::string(name(GetParam())) + " seed " + std::to_string(seed));
}

TEST_P(FarBuildBy, covers_bodies_to_the_end_of_the_range) {
  const bool quick = GetParam() == Method::octree;
  const Mesh ball = test::icosphere(quick ? 2 : 0);
  for (const double largest : {0x1p-99, 1.0, 0x1p99})
    for (const int exponent : {10, 42, 44, 46, 50, 53}) {
      const double size = std::ldexp(largest, -exponent);
      const Mesh mesh = test::translated(test::scaled(ball, size), {largest, -0.3 * largest, 0.7 * largest});
      BuildOptions options{.method = GetParam(), .branching = 4, .depth = 2};
      if (GetParam() == Method::optimized) options.quality = Quality::fast;
      expect_covers(mesh, options, std::string(name(GetParam())) + ", 2^" + std::to_string(exponent) + " sizes away");
    }
}

INSTANTIATE_TEST_SUITE_P(Quick, FarBuildBy, testing::ValuesIn(test::quick_methods), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, FarBuildBy, testing::ValuesIn(test::slow_methods), test::method_name);

// Parts go to nodes whose ancestors contain them with the room of rounded_up_radius: no less than a quarter of it is
// left in real numbers.
TEST(FarExchange, leaves_the_room_of_rounded_coordinates) {
  const Mesh mesh = far_cubes();
  const ObjectShape shape(mesh);
  const ObjectLines lines(mesh, shape, 96, serial_workers());
  const FitInput input = fit_input(mesh, shape, lines);
  const ReduceSettings settings{
      .fit = {.spacing = 0.15, .cell = 0.25, .cells_per_radius = 4, .balance = 0, .exact_rounds = 2},
      .changes = {4, 4, 4},
      .move_every = 5};
  std::size_t across = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const BuildRun run({.method = Method::spawn, .depth = 2, .seed = seed}, mesh);
    top_down(mesh, run,
             {.divide = divide_by(input, run, propose_spawn, settings),
              .new_level =
                  [&](std::vector<BuildNode>& nodes) {
                    if (nodes[0].level != 2) return;
                    std::vector<Region> before;
                    for (const BuildNode& node : nodes) before.push_back(node.region);
                    exchange(input, nodes, 1, serial_workers());
                    for (std::size_t i = 0; i < nodes.size(); ++i) {
                      std::vector<Vec3> own, now;
                      corner_positions(mesh, before[i], own);
                      corner_positions(mesh, nodes[i].region, now);
                      for (const Vec3& p : now) {
                        if (std::find(own.begin(), own.end(), p) != own.end()) continue;
                        ++across;
                        for (const Sphere& a : nodes[i].ancestors)
                          EXPECT_LE(length(Wide(p) - Wide(a.center)) + rounding_of(mesh) / 4,
                                    static_cast<long double>(a.radius))
                              << seed;
                      }
                    }
                  }},
             serial_workers());
  }
  EXPECT_GT(across, 100u);
}

}  // namespace
}  // namespace morula
