// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Flat sets: as tight as one level of as many spheres, and never looser than a smaller set.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <support/meshes.hpp>

namespace morula {
namespace {

struct Part {
  double from, to;
};

// Space inside spheres and outside a closed mesh, along columns: every column is tried against every facet and every
// sphere, and shares no code with the library.
class Judge {
 public:
  explicit Judge(const Mesh& mesh) {
    for (const Vec3& p : mesh.positions)
      for (const double v : {p.x, p.y, p.z}) reach_ = std::max(reach_, 1.5 * std::abs(v));
    for (int i = 0; i < columns; ++i)
      for (int j = 0; j < columns; ++j) {
        const double x = at(i, 0.4142), y = at(j, 0.7321);
        std::vector<double> crossings;
        for (const Facet& f : mesh.facets) {
          const Vec3 &a = mesh.positions[f[0]], &b = mesh.positions[f[1]], &c = mesh.positions[f[2]];
          const double wa = (b.x - x) * (c.y - y) - (c.x - x) * (b.y - y);
          const double wb = (c.x - x) * (a.y - y) - (a.x - x) * (c.y - y);
          const double wc = (a.x - x) * (b.y - y) - (b.x - x) * (a.y - y);
          if (!((wa > 0 && wb > 0 && wc > 0) || (wa < 0 && wb < 0 && wc < 0))) continue;
          crossings.push_back((wa * a.z + wb * b.z + wc * c.z) / (wa + wb + wc));
        }
        std::sort(crossings.begin(), crossings.end());
        std::vector<Part> inside;
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) inside.push_back({crossings[k], crossings[k + 1]});
        object_.push_back(std::move(inside));
      }
  }

  double volume() const {
    double sum = 0;
    for (std::vector<Part> inside : object_) sum += covered(inside);
    const double width = 2 * reach_ / columns;
    return sum * width * width;
  }

  double outside(const CoveredTree& model) const {
    double sum = 0;
    for (int i = 0; i < columns; ++i)
      for (int j = 0; j < columns; ++j) {
        std::vector<Part> parts = object_[index(i, j)];
        const double inside = covered(parts);
        for (std::uint32_t node = 0; node < model.tree.node_count(); ++node) {
          if (!model.tree.is_leaf(node)) continue;
          const Sphere& s = model.tree.spheres[node];
          const double dx = at(i, 0.4142) - s.center.x, dy = at(j, 0.7321) - s.center.y;
          const double half = s.radius * s.radius - dx * dx - dy * dy;
          if (half > 0) parts.push_back({s.center.z - std::sqrt(half), s.center.z + std::sqrt(half)});
        }
        sum += covered(parts) - inside;
      }
    const double width = 2 * reach_ / columns;
    return sum * width * width;
  }

 private:
  static constexpr int columns = 200;
  double at(int i, double shift) const { return (2 * (i + shift) / columns - 1) * reach_; }
  static std::size_t index(int i, int j) { return static_cast<std::size_t>(i) * columns + static_cast<std::size_t>(j); }
  static double covered(std::vector<Part>& parts) {
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.from < b.from; });
    double sum = 0, up_to = -1e300;
    for (const Part& p : parts) {
      if (p.to <= up_to) continue;
      sum += p.to - std::max(p.from, up_to);
      up_to = p.to;
    }
    return sum;
  }

  double reach_ = 0;
  std::vector<std::vector<Part>> object_;
};

TEST(FlatSetJudge, knows_the_volume_about_a_cube) {
  const Mesh bar = sample_body("bar", 3);  // 4 × 1 × 1
  CoveredTree model;
  model.tree.branching = 8;
  const Sphere around{{0, 0, 0}, std::sqrt(4.5)};
  model.tree.append_level({}, std::span(&around, 1));
  EXPECT_NEAR(Judge(bar).outside(model), 4.0 / 3 * std::numbers::pi * std::pow(4.5, 1.5) - 4, 0.1);
  EXPECT_NEAR(Judge(bar).volume(), 4, 0.1);
}

struct Case {
  Method method;
  Quality quality;
};

// Sizes that every larger set is compared with (docs/how-to/choosing.md). Between others, luck may show.
bool compared_with(std::size_t spheres) {
  return std::has_single_bit(spheres) || spheres == 3 || spheres == 6;
}

void expect_tight(const char* body, int resolution, const Case& by, std::uint64_t seed,
                  std::span<const std::size_t> counts) {
  const Mesh mesh = sample_body(body, resolution);
  const Judge judge(mesh);
  // Columns miss what lies between them.
  constexpr double error = 0.005;
  double before = std::numeric_limits<double>::infinity();
  for (const std::size_t spheres : counts) {
    const std::string what = std::string(body) + ", " + std::string(name(by.method)) + ", seed " +
                             std::to_string(seed) + ", " + std::to_string(spheres);
    const CoveredTree flat =
        build(mesh, {.method = by.method, .spheres = spheres, .seed = seed, .quality = by.quality});
    EXPECT_TRUE(validate(mesh, flat).empty()) << what;
    const double now = judge.outside(flat);
    EXPECT_LE(now, before * (1 + error)) << what;
    if (compared_with(spheres)) before = std::min(before, now);
    if (spheres > static_cast<std::size_t>(max_branching)) continue;
    const CoveredTree level = build(
        mesh,
        {.method = by.method, .branching = static_cast<int>(spheres), .depth = 1, .seed = seed, .quality = by.quality});
    EXPECT_LE(now, judge.outside(level) * (1 + error)) << what;
  }
}

constexpr std::array<std::size_t, 4> few{2, 4, 8, 20};
constexpr std::array<std::size_t, 8> all{4, 6, 8, 16, 20, 50, 64, 100};

TEST(FlatSet, hangs_below_one_root_for_every_branching) {
  const Mesh mesh = sample_body("bar", 4);
  for (int branching = 2; branching <= 9; ++branching)
    for (const std::size_t spheres : {1, 2, 3, 5, 7, 12}) {
      const CoveredTree flat = build(mesh, {.method = Method::grid, .branching = branching, .spheres = spheres});
      EXPECT_TRUE(validate(mesh, flat).empty()) << branching << ", " << spheres;
      std::size_t leaves = 0;
      for (std::uint32_t node = 0; node < flat.tree.node_count(); ++node) {
        leaves += flat.tree.is_leaf(node) ? 1 : 0;
        EXPECT_LE(flat.tree.child_count[node], static_cast<std::uint32_t>(branching));
      }
      EXPECT_LE(leaves, spheres);
    }
}

TEST(FlatSetTightness, of_few_spheres_is_that_of_one_level_and_of_smaller_sets) {
  for (const char* body : {"bar", "limb"})
    for (const Case& by : {Case{Method::grid, Quality::standard}, Case{Method::optimized, Quality::fast}})
      expect_tight(body, 8, by, 1, few);
}

// The largest volume of a union over the smallest of fewer spheres.
double worst_step(const char* body, int resolution, Quality quality, std::size_t first, std::size_t last) {
  const Mesh mesh = sample_body(body, resolution);
  const Judge judge(mesh);
  double least = std::numeric_limits<double>::infinity(), worst = 0;
  for (std::size_t spheres = first; spheres <= last; ++spheres) {
    const CoveredTree model = build(mesh, {.spheres = spheres, .quality = quality});
    EXPECT_LE(model.tree.leaf_count(), spheres) << body;
    const double now = judge.volume() + judge.outside(model);
    worst = std::max(worst, now / least);
    least = std::min(least, now);
  }
  return worst;
}

// By luck, a set that is sought at once is tighter or looser than its neighbors: without growing, these steps are 1.19
// and 1.05; where nothing is sought by another start, the last is 1.22.
TEST(FlatSetTightness, of_one_sphere_more_is_that_of_a_set_that_grew) {
  EXPECT_LE(worst_step("torus", 16, Quality::fast, 9, 14), 1.005);
  EXPECT_LE(worst_step("limb", 12, Quality::fast, 28, 33), 1.005);
  for (const Quality quality : {Quality::draft, Quality::fast})
    EXPECT_LE(worst_step("torus", 32, quality, 11, 13), 1.005);
}

// What is measured, not promised: sets that were sought at once can be tighter than what has grown.
TEST(NightlyFlatSetTightness, of_one_sphere_more_seldom_gets_worse) {
  for (const Quality quality : {Quality::draft, Quality::fast})
    for (const int resolution : {16, 32}) EXPECT_LE(worst_step("torus", resolution, quality, 2, 64), 1.005);
  EXPECT_LE(worst_step("limb", 12, Quality::draft, 2, 64), 1.02);
  EXPECT_LE(worst_step("limb", 12, Quality::fast, 2, 64), 1.005);
  EXPECT_LE(worst_step("limb", 12, Quality::standard, 8, 40), 1.01);
}

// MORULA_FLAT_SET_SEEDS: so many seeds of every body by every method, which takes an hour each; else every body and
// every method once.
TEST(NightlyFlatSetTightness, is_that_of_one_level_and_of_smaller_sets) {
  constexpr std::array bodies{"bar", "capsule", "limb", "torus", "blob", "two", "tool"};
  constexpr std::array cases{Case{Method::grid, Quality::standard},     Case{Method::hubbard, Quality::standard},
                             Case{Method::spawn, Quality::standard},    Case{Method::medial, Quality::standard},
                             Case{Method::combined, Quality::standard}, Case{Method::optimized, Quality::fast},
                             Case{Method::optimized, Quality::standard}};
  const char* const given = std::getenv("MORULA_FLAT_SET_SEEDS");
  const std::uint64_t seeds = given != nullptr ? std::strtoull(given, nullptr, 10) : 1;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t c = 0; c < cases.size(); ++c)
      for (std::uint64_t seed = 1; seed <= seeds && (given != nullptr || b == c); ++seed)
        expect_tight(bodies[b], 12, cases[c], seed, all);
}

}  // namespace
}  // namespace morula
