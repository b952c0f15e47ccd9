// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Swept pairs: whole coordinates, whose impacts whole arithmetic decides; and steps of others with exact verdicts.
#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <morula/surface/swept.hpp>
#ifdef MORULA_HAS_IO
#include <morula/io/mesh_file.hpp>
#endif

#include "surfaces.hpp"

namespace morula {
namespace {

using test::Moving;
using test::PlainPair;
using test::Vertices;

constexpr int parts = 32;

/// Whole coordinates at time k / parts, times parts.
struct Whole3 {
  std::int64_t x, y, z;
};
Whole3 at(const Moving& m, std::uint32_t v, int k) {
  const auto along = [&](double from, double to) {
    return static_cast<std::int64_t>(from) * (parts - k) + static_cast<std::int64_t>(to) * k;
  };
  return {along(m.from[v].x, m.to[v].x), along(m.from[v].y, m.to[v].y), along(m.from[v].z, m.to[v].z)};
}
int side(const Moving& m, const Vertices& four, int k) {
  const Whole3 o = at(m, four[0], k);
  const auto d = [&](std::size_t i) {
    const Whole3 p = at(m, four[i], k);
    return Whole3{p.x - o.x, p.y - o.y, p.z - o.z};
  };
  const Whole3 a = d(1), b = d(2), c = d(3);
  const std::int64_t volume =
      a.x * (b.y * c.z - b.z * c.y) - a.y * (b.x * c.z - b.z * c.x) + a.z * (b.x * c.y - b.y * c.x);
  return volume > 0 ? 1 : volume < 0 ? -1 : 0;
}
std::vector<Vec3> pose(const Moving& m, long double t) {
  std::vector<Vec3> p(m.from.size());
  for (std::size_t v = 0; v < p.size(); ++v)
    p[v] = m.from[v] * static_cast<double>(1 - t) + m.to[v] * static_cast<double>(t);
  return p;
}

/// The first time at which the pair surely has met, found by exact signs at whole parts of the step: four points lie in
/// one plane between two parts with different signs, and the features are on each other there. 2 when no such time is
/// seen: a pair that only touches, or crosses twice between two parts, is not.
long double time_met(const Moving& m, const Vertices& a, const Vertices& b) {
  Vertices four = a;
  four.insert(four.end(), b.begin(), b.end());
  int before = side(m, four, 0);
  for (int k = 1; k <= parts; ++k) {
    const int after = side(m, four, k);
    if (before * after < 0) {
      // In doubles: whether the volume has changed its sign.
      const auto sign = [&](long double t) {
        const std::vector<Vec3> p = pose(m, t);
        return dot(cross(p[four[1]] - p[four[0]], p[four[2]] - p[four[0]]), p[four[3]] - p[four[0]]) > 0 ? 1 : -1;
      };
      long double low = (k - 1.0L) / parts, high = static_cast<long double>(k) / parts;
      for (int halving = 0; halving < 45; ++halving) {
        const long double middle = (low + high) / 2;
        (sign(middle) == before ? low : high) = middle;
      }
      if (test::plain_distance(pose(m, high), a, b) < 1e-9L) return high;
    }
    before = after;
  }
  return 2;
}

void expect_impacts_in_time(int rounds, std::uint64_t seed) {
  Random random(seed);
  std::size_t impacts = 0, found_pairs = 0, compared = 0;
  for (int round = 0; round < rounds; ++round) {
    const Moving m = test::random_soup(10 + static_cast<std::size_t>(round) % 7,
                                       4 + static_cast<std::size_t>(round) % 9, 2 + round % 30, random);
    SurfaceTree tree(m.mesh);
    ASSERT_TRUE(tree.update(m.from, m.to));
    SweptQuery query;
    const SurfaceQueryStatus status = query.run(tree);
    ASSERT_TRUE(status && status.finished);
    std::map<PlainPair, double> times;
    // Facets of the same vertices are one plain pair, of one time.
    for (const SweptPair& pair : query.pairs()) times.emplace(test::plain_pair(tree, tree, pair), pair.time);
    test::pairs_with_itself(m.mesh, [&](const Vertices& a, const Vertices& b) {
      ++compared;
      const long double met = time_met(m, a, b);
      if (met > 1) return false;
      ++impacts;
      const auto found = times.find(test::plain_pair(a, b, true));
      EXPECT_NE(found, times.end());
      EXPECT_LE(found == times.end() ? 2 : found->second, static_cast<double>(met) + 1e-12);
      return false;
    });
    found_pairs += times.size();
  }
  EXPECT_GT(impacts, 13u * static_cast<std::size_t>(rounds));
  // What is proven apart is left out: whole coordinates touch often, but not most of the time.
  EXPECT_LT(found_pairs, compared / 4);
  EXPECT_LT(found_pairs, 2 * impacts);
}

TEST(Swept, finds_every_impact_in_time) {
  expect_impacts_in_time(150, 17);
}

// MORULA_SWEPT_STEPS: so many random steps instead.
TEST(LongSwept, finds_every_impact_in_time) {
  const char* const steps = std::getenv("MORULA_SWEPT_STEPS");
  expect_impacts_in_time(steps != nullptr ? std::atoi(steps) : 10000, 18);
}

TEST(Swept, times_are_those_of_falling_points_and_turning_edges) {
  const std::vector<Vec3> floor{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const double height : {1e-6, 1.0, 1e6}) {
    const std::vector<Vec3> from{{0.25, 0.25, height}}, to{{0.25, 0.25, -height}};
    const double time = time_of_impact(from, to, floor, floor);
    EXPECT_LE(time, 0.5);
    EXPECT_GT(time, 0.5 - 1e-6);
    // Within a distance it is earlier.
    EXPECT_NEAR(time_of_impact(from, to, floor, floor, height / 2), 0.25, 1e-6);
    const std::vector<Vec3> beside{{0.75, 0.75, height}}, below{{0.75, 0.75, -height}};
    EXPECT_GT(time_of_impact(beside, below, floor, floor), 1);
  }
  // An edge that turns about the z axis by a right angle on straight lines, above another one and through it.
  const std::vector<Vec3> edge_from{{-1, 0, 0.5}, {1, 0, 0.5}}, edge_to{{0, -1, 0.5}, {0, 1, 0.5}};
  const std::vector<Vec3> other{{-0.6, -0.6, 0}, {0.6, 0.6, 0}};
  EXPECT_GT(time_of_impact(edge_from, edge_to, other, other), 1);
  std::vector<Vec3> edge_down = edge_to;
  for (Vec3& p : edge_down) p.z = -0.5;
  EXPECT_NEAR(time_of_impact(edge_from, edge_down, other, other), 0.5, 1e-6);
  EXPECT_EQ(time_of_impact(floor, floor, std::vector<Vec3>{{0.2, 0.2, 0}}, std::vector<Vec3>{{0.2, 0.2, 9}}), 0);
  EXPECT_THROW(time_of_impact(floor, floor, floor, floor), std::invalid_argument);
}

TEST(Swept, a_step_up_to_the_earliest_time_is_free_of_crossings) {
  Random random(23);
  for (int round = 0; round < 10; ++round) {
    const Moving m = test::wavy_sheet(6, 0.2, random);
    SurfaceTree tree(m.mesh);
    ASSERT_TRUE(tree.update(m.from, m.to));
    SweptQuery query({.filter = {.same_component = true}}),
        candidates({.candidates_only = true, .filter = {.same_component = true}});
    ASSERT_TRUE(query.run(tree));
    ASSERT_TRUE(candidates.run(tree));
    const auto found = test::plain_pairs(tree, tree, query.pairs()),
               all = test::plain_pairs(tree, tree, candidates.candidates());
    EXPECT_TRUE(std::includes(all.begin(), all.end(), found.begin(), found.end()));
    EXPECT_LT(found.size(), all.size());
    const double step = query.collision_free_step();
    const std::vector<Vec3> there = pose(m, step * (1 - 1e-9));
    const auto vertices = test::plain_vertices(m.mesh);
    long double nearest = 1;
    for (const PlainPair& pair : all) nearest = std::min(nearest, test::plain_distance(there, pair.a, pair.b));
    EXPECT_TRUE(step == 0 || nearest > 0);
  }
}

#ifdef MORULA_HAS_IO
std::filesystem::path ccd_folder() {
  const char* const given = std::getenv("MORULA_CCD_DATA");
  return given != nullptr ? std::filesystem::path(given) : std::filesystem::path(MORULA_SHARED_DATA) / "ccd";
}

/// Rows of a table of whole numbers, without its header.
std::vector<std::vector<std::uint32_t>> rows_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::vector<std::vector<std::uint32_t>> rows;
  while (std::getline(file, line)) {
    std::vector<std::uint32_t>& row = rows.emplace_back();
    const char *next = line.data(), *const end = next + line.size();
    while (next < end) {
      std::uint32_t value = 0;
      next = std::from_chars(next, end, value).ptr + 1;
      row.push_back(value);
    }
  }
  return rows;
}

class SweptScene : public testing::TestWithParam<const char*> {};

TEST_P(SweptScene, has_all_pairs_that_an_exact_computation_says_collide) {
  const std::filesystem::path folder = ccd_folder() / GetParam();
  if (!std::filesystem::exists(folder / "vf.csv"))
    GTEST_SKIP()
        << "two steps of simulations with exact verdicts are other people's data and not in the repository: set "
           "MORULA_CCD_DATA to their folder. Random steps in whole numbers make the same claim without them";
  const Mesh from = read_mesh(folder / "from.ply"), to = read_mesh(folder / "to.ply");
  SurfaceTree tree(from);
  ASSERT_TRUE(tree.update(from.positions, to.positions));
  SweptQuery query;
  ASSERT_TRUE(query.run(tree).finished);
  const auto found = test::plain_pairs(tree, tree, query.pairs());
  std::size_t colliding = 0, missed = 0;
  const auto look_for = [&](const Vertices& a, const Vertices& b) {
    ++colliding;
    missed += !std::binary_search(found.begin(), found.end(), test::plain_pair(a, b, true));
  };
  for (const auto& row : rows_of(folder / "vf.csv"))
    if (row[2] != 0) look_for({row[0]}, {from.facets[row[1]].begin(), from.facets[row[1]].end()});
  for (const auto& row : rows_of(folder / "ee.csv"))
    if (row[4] != 0) look_for({row[0], row[1]}, {row[2], row[3]});
  EXPECT_EQ(missed, 0u);
  EXPECT_GT(colliding, 100u);
  // Few that are found do not collide.
  EXPECT_LE(query.pairs().size(), colliding + colliding / 50);
}

INSTANTIATE_TEST_SUITE_P(Shared, SweptScene, testing::Values("cloth-funnel", "rod-twist"), [](const auto& scene) {
  std::string name = scene.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});
#endif

}  // namespace
}  // namespace morula
