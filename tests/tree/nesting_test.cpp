// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nested trees: containment judged in integers and in long double, the smallest spheres by search.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/generators/build.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>
#include <support/aligned.hpp>
#include <support/meshes.hpp>
#include <support/methods.hpp>

#include "geometry/exact_predicates.hpp"

namespace morula {
namespace {

__extension__ typedef __int128 Integer;

Integer whole(double x) {
  return static_cast<Integer>(static_cast<std::int64_t>(x));
}

// Of spheres in integers below 2^50.
bool integer_encloses(const Sphere& outer, const Sphere& inner) {
  Integer squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Integer d = whole(outer.center[axis]) - whole(inner.center[axis]);
    squared += d * d;
  }
  const Integer room = whole(outer.radius) - whole(inner.radius);
  return room >= 0 && squared <= room * room;
}

Sphere times(const Sphere& s, double factor) {
  return {s.center * factor, s.radius * factor};
}

// |c - c'| + r' - r: right to 2^-60 of it, where pads are 2^-48.
long double excess(const Sphere& outer, const Sphere& inner) {
  long double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const long double d = static_cast<long double>(outer.center[axis]) - static_cast<long double>(inner.center[axis]);
    squared += d * d;
  }
  return std::sqrt(squared) + static_cast<long double>(inner.radius) - static_cast<long double>(outer.radius);
}

long double worst_excess(const SphereTree& tree) {
  long double worst = -std::numeric_limits<long double>::infinity();
  for (std::uint32_t node = 1; node < tree.node_count(); ++node)
    worst = std::max(worst, excess(tree.spheres[tree.parent[node]], tree.spheres[node]));
  return worst;
}

double reach(const Vec3& center, std::span<const Sphere> spheres) {
  double largest = 0;
  for (const Sphere& s : spheres) largest = std::max(largest, distance(center, s.center) + s.radius);
  return largest;
}

// A convex function: where no small step makes it less, it is least. Steps shrink from the whole size to 1e-9 of it.
double smallest_reach(std::span<const Sphere> spheres) {
  static const std::vector<Vec3> directions = fibonacci_directions(200);
  Vec3 center = spheres[0].center;
  double best = reach(center, spheres);
  for (double step = best; step > 1e-9 * best;) {
    Vec3 next = center;
    double least = best;
    for (const Vec3& direction : directions)
      if (const double r = reach(center + step * direction, spheres); r < least) {
        least = r;
        next = center + step * direction;
      }
    if (least < best)
      center = next, best = least;
    else
      step *= 0.7;
  }
  return best;
}

SphereTree root_over(const Sphere& root, std::span<const Sphere> children) {
  SphereTree tree;
  tree.branching = static_cast<std::uint32_t>(std::max<std::size_t>(2, children.size()));
  tree.append_level({}, std::span(&root, 1));
  const std::uint32_t counts[]{static_cast<std::uint32_t>(children.size())};
  tree.append_level(counts, children);
  return tree;
}

TEST(Encloses, agrees_with_integers_where_spheres_touch_from_inside_at_any_scale) {
  Random random(1);
  constexpr double scales[] = {1.0, 0x1p-1074, 0x1p-700, 0x1p-520, 0x1p-515, 0x1p-37, 0x1p300, 0x1p470, 0x1p970};
  constexpr int triples[][4] = {{3, 4, 0, 5}, {2, 3, 6, 7}, {1, 4, 8, 9}, {2, 6, 9, 11}, {0, 0, 1, 1}, {8, 9, 12, 17}};
  std::size_t touching = 0, inside = 0;
  const auto number = [&](double most) { return std::floor(random.uniform(-most, most)); };
  for (int round = 0; round < 40000; ++round) {
    const double most = round % 3 == 0 ? 8 : round % 3 == 1 ? 0x1p20 : 0x1p44;
    const auto& t = triples[static_cast<std::size_t>(round) % std::size(triples)];
    const double k = std::floor(random.uniform(0, most));
    const Sphere inner{{number(most), number(most), number(most)}, std::floor(random.uniform(0, most))};
    // Touching, a unit short of it, or a unit over it.
    const Sphere outer{inner.center + Vec3{t[0] * k, -t[1] * k, t[2] * k},
                       std::max(0.0, inner.radius + t[3] * k + static_cast<double>(round / 3 % 3 - 1))};
    const bool expected = integer_encloses(outer, inner);
    touching += round / 3 % 3 == 1;
    inside += expected;
    const double s = scales[static_cast<std::size_t>(round / 7) % std::size(scales)];
    ASSERT_EQ(detail::encloses(times(outer, s), times(inner, s)), expected) << "scale " << s;
    ASSERT_EQ(detail::encloses(times(inner, s), times(outer, s)), integer_encloses(inner, outer)) << "scale " << s;
  }
  EXPECT_GT(touching, 10000u);
  EXPECT_GT(inside, 20000u);
}

// Where squares are a few least doubles, and each is rounded by up to half of one.
TEST(Encloses, agrees_with_integers_where_squares_vanish) {
  Random random(2);
  const auto number = [&](double most) { return std::floor(random.uniform(0, most)); };
  for (int round = 0; round < 20000; ++round) {
    const Sphere inner{{0, 0, 0}, number(9)};
    const Sphere outer{{number(13), number(13), number(13)}, inner.radius + number(20)};
    for (const double s : {0x1p-538, 0x1p-539, 0x1p-540, 0x1p-542})
      ASSERT_EQ(detail::encloses(times(outer, s), times(inner, s)), integer_encloses(outer, inner)) << "scale " << s;
  }
}

TEST(Encloses, sees_the_last_bit_beside_the_largest_number) {
  constexpr double huge = 0x1p1022, tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_TRUE(detail::encloses({{0, 0, 0}, huge}, {{huge / 2, 0, 0}, huge / 2}));
  EXPECT_FALSE(detail::encloses({{0, 0, 0}, huge}, {{huge / 2, tiny, 0}, huge / 2}));
  EXPECT_FALSE(detail::encloses({{0, 0, 0}, 1}, {{tiny, 0, 0}, 1}));
  EXPECT_TRUE(detail::encloses({{0, 0, 0}, 1 + 0x1p-52}, {{tiny, 0, 0}, 1}));
  EXPECT_TRUE(detail::encloses({{3, 4, 5}, 0}, {{3, 4, 5}, 0}));
  EXPECT_FALSE(detail::encloses({{3, 4, 5}, 0}, {{3, 4, 5}, tiny}));
}

TEST(EnclosingSphereOfSpheres, is_the_smallest_of_exact_arrangements) {
  const auto of = [](const std::vector<Sphere>& spheres) { return enclosing_sphere_of_spheres(spheres); };
  EXPECT_EQ(of({}), Sphere());
  EXPECT_EQ(of({{{1, 2, 3}, 4}}), (Sphere{{1, 2, 3}, 4}));
  // Two beside each other: half of what they span.
  const Sphere two = of({{{0, 0, 0}, 1}, {{10, 0, 0}, 3}});
  EXPECT_NEAR(two.radius, 7, 1e-12);
  EXPECT_NEAR(distance(two.center, {6, 0, 0}), 0, 1e-12);
  // One inside another, and equal ones.
  EXPECT_NEAR(of({{{0.5, 0, 0}, 0.25}, {{0, 0, 0}, 2}, {{0, 1, 0}, 1}}).radius, 2, 1e-12);
  EXPECT_NEAR(of(std::vector<Sphere>(5, Sphere{{7, 8, 9}, 2})).radius, 2, 1e-12);
  // Unit spheres about the corners of a square, and of a tetrahedron; a fifth in the middle changes nothing.
  EXPECT_NEAR(of({{{1, 1, 0}, 1}, {{-1, 1, 0}, 1}, {{1, -1, 0}, 1}, {{-1, -1, 0}, 1}}).radius, 1 + std::sqrt(2.0),
              1e-12);
  const Sphere four = of({{{0, 0, 0}, 1.2}, {{1, 1, 1}, 1}, {{1, -1, -1}, 1}, {{-1, 1, -1}, 1}, {{-1, -1, 1}, 1}});
  EXPECT_NEAR(four.radius, 1 + std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(length(four.center), 0, 1e-12);
  // In a line, and about one point.
  EXPECT_NEAR(of({{{-3, 0, 0}, 1}, {{0, 0, 0}, 2}, {{5, 0, 0}, 0.5}, {{1, 0, 0}, 0}}).radius, 4.75, 1e-12);
  EXPECT_NEAR(of({{{1, 1, 1}, 1}, {{1, 1, 1}, 3}, {{1, 1, 1}, 2}}).radius, 3, 1e-12);
}

TEST(EnclosingSphereOfSpheres, is_no_larger_than_what_a_search_finds_at_any_scale) {
  Random random(3);
  for (int round = 0; round < 150; ++round) {
    const auto count = static_cast<std::size_t>(2 + random.uniform(0, round % 10 == 0 ? 62 : 7));
    const double radii = round % 3 == 0 ? 0.01 : round % 3 == 1 ? 0.5 : 2.0, depth = round % 4 == 0 ? 0.0 : 1.0;
    std::vector<Sphere> spheres;
    for (std::size_t i = 0; i < count; ++i)
      spheres.push_back(
          {{random.uniform(-1, 1), random.uniform(-1, 1), depth * random.uniform(-1, 1)}, random.uniform(0, radii)});
    const double least = smallest_reach(spheres);
    for (const double s : {1.0, 0x1p-100, 0x1p-600, 0x1p600}) {
      std::vector<Sphere> at_scale;
      for (const Sphere& sphere : spheres) at_scale.push_back(times(sphere, s));
      const Sphere found = enclosing_sphere_of_spheres(at_scale);
      EXPECT_LE(found.radius / s, least * (1 + 1e-9)) << count << " spheres, scale " << s;
      EXPECT_NEAR(found.radius / s, reach(found.center / s, spheres), 1e-12);
    }
  }
}

TEST(Nesting, spheres_contain_their_childrens_and_are_no_larger_than_necessary) {
  Random random(4);
  for (int round = 0; round < 80; ++round) {
    const double scale = std::ldexp(1.0, static_cast<int>(random.uniform(-60, 60)));
    std::vector<Sphere> children;
    for (int i = 0; i < 2 + round % 7; ++i)
      children.push_back(
          times({{random.uniform(-1, 1) + round, random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0, 0.6)},
                scale));
    const Sphere root = times({{random.uniform(-1, 1) + round, 0, 0}, random.uniform(0, 3)}, scale);
    SphereTree tree = root_over(root, children);
    const bool held = worst_excess(tree) <= 0;
    EXPECT_EQ(certify_nesting(tree, tree.spheres).nested, held);
    make_nested(tree);
    EXPECT_TRUE(tree.nested);
    EXPECT_LE(worst_excess(tree), 0) << round;
    EXPECT_TRUE(std::equal(children.begin(), children.end(), tree.spheres.begin() + 1)) << "leaves stay";
    const double smallest = smallest_reach(children), about_old = reach(root.center, children);
    const double most = held ? std::min(root.radius, smallest) : std::min(about_old, smallest);
    EXPECT_LE(tree.spheres[0].radius, most * (1 + 1e-9) + 1e-12 * max_norm(root.center));
    if (held && root.radius < smallest) {
      EXPECT_EQ(tree.spheres[0], root);
    }
  }
}

TEST(Nesting, holds_for_numbers_of_any_size) {
  Random random(5);
  for (const double scale : {0x1p-1074, 0x1p-1060, 0x1p-1022, 0x1p-520, 0x1p300, 0x1p1000})
    for (int round = 0; round < 200; ++round) {
      std::vector<Sphere> children;
      for (int i = 0; i < 2 + round % 3; ++i) {
        const auto number = [&] { return std::floor(random.uniform(-40, 40)); };
        children.push_back(times({{number(), number(), number()}, std::abs(number())}, scale));
      }
      SphereTree tree = root_over(times({{1, 2, 3}, 1}, scale), children);
      make_nested(tree);
      // Exact: the differences and radii are small integers times the scale, and so is the parent's center or nearly.
      EXPECT_LE(worst_excess(tree), 0) << scale << ", round " << round;
      EXPECT_TRUE(validate(tree).empty());
    }
  const double infinity = std::numeric_limits<double>::infinity();
  SphereTree large = root_over({{0, 0, 0}, 1}, std::vector<Sphere>{{{1e308, 0, 0}, 1e308}, {{-1e308, 0, 0}, 1e308}});
  EXPECT_THROW(make_nested(large), std::invalid_argument);
  EXPECT_FALSE(large.nested);
  EXPECT_EQ(large.spheres[0].radius, 1) << "unchanged";
  large.spheres[1].radius = infinity;
  EXPECT_THROW(make_nested(large), std::invalid_argument);
  EXPECT_FALSE(certify_nesting(large, large.spheres).nested);
  large.spheres[0].radius = infinity;
  large.spheres[1].radius = large.spheres[2].radius = 1;
  EXPECT_FALSE(certify_nesting(large, large.spheres).nested) << "what is not finite counts as outside";
}

TEST(Nesting, certificate_names_the_worst_and_asks_only_whom_it_is_told_to) {
  SphereTree tree = root_over({{0, 0, 0}, 2}, std::vector<Sphere>{{{1, 0, 0}, 1}, {{1, 0, 0}, 1.5}, {{0, 3, 0}, 1}});
  const Nesting all = certify_nesting(tree, tree.spheres);
  EXPECT_FALSE(all.nested);
  EXPECT_EQ(all.outside, 2u);
  EXPECT_EQ(all.worst_node, 3u);
  EXPECT_NEAR(all.worst_excess, 2, 1e-12);
  const std::vector<std::uint8_t> nobody(4), root{1, 0, 0, 0};
  EXPECT_TRUE(certify_nesting(tree, tree.spheres, nobody).nested);
  EXPECT_EQ(certify_nesting(tree, tree.spheres, root).outside, 2u);
  EXPECT_THROW(static_cast<void>(certify_nesting(tree, std::span(tree.spheres).first(3))), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(certify_nesting(tree, tree.spheres, std::span(root).first(3))), std::invalid_argument);
}

TEST(Nesting, validate_finds_a_tree_that_says_so_and_is_not) {
  SphereTree tree = root_over({{0, 0, 0}, 2}, std::vector<Sphere>{{{1, 0, 0}, 1}, {{-1, 0, 0}, 1}});
  tree.nested = true;
  EXPECT_TRUE(validate(tree).empty()) << "touching from inside";
  tree.spheres[2].radius = std::nextafter(1.0, 2.0);
  ASSERT_EQ(validate(tree).size(), 1u);
  EXPECT_NE(validate(tree)[0].find("node 2 sticks out of node 0"), std::string::npos) << validate(tree)[0];
  EXPECT_THROW(make_nested(tree = root_over({{0, 0, 0}, -1}, std::vector<Sphere>{{{0, 0, 0}, 1}})),
               std::invalid_argument);
  tree.nested = false;
  tree.spheres[0].radius = 0;
  EXPECT_TRUE(validate(tree).empty()) << "it promises nothing";
}

// What is left of the promises when a tree is nested, judged without the library.
void expect_nested(const std::string& name, const Mesh& mesh, const CoveredTree& model) {
  EXPECT_TRUE(model.tree.nested) << name;
  if (model.tree.node_count() > 1) {
    EXPECT_LE(worst_excess(model.tree), 0) << name;
  }
  EXPECT_TRUE(certify_nesting(model.tree, model.tree.spheres).nested) << name;
  const auto faults = validate(mesh, model);
  EXPECT_TRUE(faults.empty()) << name << ": " << faults.front();
}

// Leaves are those of the tree that is not nested, bit for bit; no inner sphere is larger than it has to be.
void expect_same_leaves(const std::string& name, const CoveredTree& nested, const CoveredTree& plain) {
  ASSERT_EQ(nested.tree.node_count(), plain.tree.node_count()) << name;
  EXPECT_EQ(nested.cover.corners, plain.cover.corners) << name;
  for (std::uint32_t node = 0; node < nested.tree.node_count(); ++node) {
    const Sphere& s = nested.tree.spheres[node];
    if (nested.tree.is_leaf(node)) {
      EXPECT_EQ(s, plain.tree.spheres[node]) << name;
      continue;
    }
    const auto children =
        std::span(nested.tree.spheres).subspan(nested.tree.first_child[node], nested.tree.child_count[node]);
    const Vec3& old = plain.tree.spheres[node].center;
    EXPECT_LE(s.radius, std::max(plain.tree.spheres[node].radius, reach(old, children)) * (1 + 1e-12) +
                            1e-13 * max_norm(s.center))
        << name << ", node " << node;
  }
}

using NestedTreesBy = test::ByMethod;

void expect_nested_where_asked(const test::NamedMesh& named, Method method) {
  BuildOptions options{.method = method, .branching = 4, .depth = 2};
  if (options.method == Method::optimized) options.quality = Quality::fast;
  const CoveredTree plain = build(named.mesh, options);
  options.nested = true;
  const CoveredTree nested = build(named.mesh, options);
  expect_nested(named.name, named.mesh, nested);
  expect_same_leaves(named.name, nested, plain);
  EXPECT_FALSE(plain.tree.nested) << named.name;
}

TEST_P(NestedTreesBy, hold_on_aligned_bodies) {
  for (const test::NamedMesh& named : test::aligned_bodies()) expect_nested_where_asked(named, GetParam());
}

TEST_P(NestedTreesBy, hold_for_flat_sets) {
  const Mesh mesh = test::icosphere(2);
  BuildOptions options{.method = GetParam(), .spheres = 20, .nested = true};
  if (options.method == Method::optimized) options.quality = Quality::fast;
  expect_nested("ball", mesh, build(mesh, options));
}

INSTANTIATE_TEST_SUITE_P(Quick, NestedTreesBy, testing::Values(Method::octree, Method::grid), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, NestedTreesBy,
                         testing::Values(Method::hubbard, Method::spawn, Method::medial, Method::combined,
                                         Method::optimized),
                         test::method_name);

TEST(NestedTrees, hold_on_meshes_of_every_kind) {
  for (const test::NamedMesh& named : test::all_meshes()) expect_nested_where_asked(named, Method::octree);
}

TEST(NightlyNestedTrees, hold_on_meshes_of_every_kind_by_every_method) {
  for (const Method method : all_methods())
    for (const test::NamedMesh& named : test::all_meshes()) expect_nested_where_asked(named, method);
}

TEST(NestedCover, repairs_trees_of_others_and_keeps_what_they_say) {
  for (const test::NamedMesh& named : test::all_meshes()) {
    std::vector<Sphere> balls;
    const Box box = bounding_box(named.mesh);
    for (const SurfacePoint& p : sample_surface(named.mesh, 30)) balls.push_back({p.point, 0.2 * box.diagonal()});
    if (balls.empty()) continue;
    SphereTree tree = tree_from_spheres(balls, 4);
    EXPECT_FALSE(cover(named.mesh, tree).tree.nested);
    expect_nested(named.name, named.mesh, cover(named.mesh, tree, {.nested = true}));
    make_nested(tree);
    expect_nested(named.name, named.mesh, cover(named.mesh, tree));
  }
}

}  // namespace
}  // namespace morula
