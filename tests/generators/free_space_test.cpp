// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Space that no other ball has, against exact volumes of single spheres and against unions by merged chords.
#include <gtest/gtest.h>

#include <generators/fit/free_space.hpp>
#include <generators/fit/union_lines.hpp>
#include <morula/query/signed_distance.hpp>

#include "on_capsule.hpp"

namespace morula {
using namespace detail;
namespace {

struct Beside : test::OnCapsule {
  // What `ball` takes in beside the others, asked of the space about `around`; every line of the lattice.
  double beside(const Sphere& ball, const std::vector<Sphere>& others, const Sphere& around) const {
    const FreeSpace space(lines, around, lines.cell(), others);
    const auto radius = static_cast<float>(ball.radius / lines.cell());
    EXPECT_TRUE(space.is_inside(space.to_cells(ball.center), radius));
    return static_cast<double>(space.cost(space.to_cells(ball.center), radius)) * lines.cell() * lines.cell() *
           lines.cell();
  }
  double by_unions(const Sphere& ball, const std::vector<Sphere>& others) const {
    std::vector<Sphere> all = others;
    all.push_back(ball);
    UnionLines unions(lines, all, lines.cell());
    for (std::size_t i = 0; i < others.size(); ++i) unions.count(i, true);
    const double before = unions.outside();
    unions.count(others.size(), true);
    return unions.outside() - before;
  }
};

TEST(FreeSpace, beside_no_other_is_what_is_outside_the_object) {
  const Beside on;
  // On the axis, one that is little but the layer between it and the facets; beside it; across the end; far out.
  for (const Sphere& s :
       {Sphere{{0.1, 0, 0}, 0.51}, Sphere{{0.3, 0.4, 0.1}, 0.3}, Sphere{{1.4, 0.1, 0}, 0.4}, Sphere{{0, 3, 0}, 0.7}}) {
    const double exact = outside_volume(on.shape.distance(), s);
    EXPECT_NEAR(on.beside(s, {}, {s.center + Vec3{0.02, -0.01, 0.03}, 1.3 * s.radius}), exact, 0.02 * exact)
        << "at " << s.center.x << ", " << s.center.y;
  }
}

TEST(FreeSpace, is_what_a_union_grows_by) {
  const Beside on;
  // Slabs of a tube, which share nearly all they have; one that lies in it; one apart; one far away.
  const std::vector<Sphere> others{{{-0.06, 0.003, 0}, 0.515}, {{0.05, 0, -0.004}, 0.514}, {{0.1, 0, 0}, 0.2},
                                   {{0.2, 0.62, 0}, 0.05},     {{0, 5, 0}, 0.5},           {{0, -0.58, 0.05}, 0.1}};
  for (const Sphere& s : {Sphere{{0, 0, 0}, 0.512}, Sphere{{0.01, 0.02, 0}, 0.53}, Sphere{{0, 0.3, 0}, 0.5}}) {
    const double expected = on.by_unions(s, others);
    EXPECT_NEAR(on.beside(s, others, {{0, 0.1, 0}, 0.75}), expected, 1e-3 * expected + 1e-7) << s.center.y;
  }
  EXPECT_EQ(on.beside({{0, 0, 0}, 0.4}, {{{0, 0, 0}, 0.5}}, {{0, 0, 0}, 0.6}), 0) << "all is taken";
}

TEST(FreeSpace, is_asked_for_no_more_than_it_was_made_for) {
  const Beside on;
  const FreeSpace space(on.lines, {{0, 0, 0}, 0.5}, 0.1, {});
  const auto cells = [&](double length) { return static_cast<float>(length / on.lines.cell()); };
  EXPECT_TRUE(space.is_inside(space.to_cells({0.1, 0, 0}), cells(0.39)));
  EXPECT_FALSE(space.is_inside(space.to_cells({0.1, 0, 0}), cells(0.41)));
  EXPECT_FALSE(space.is_inside(space.to_cells({0, 0, 0}), cells(0.51)));
  EXPECT_LT(distance(space.from_cells(space.to_cells({0.1, 0.2, -0.3})), Vec3{0.1, 0.2, -0.3}), 1e-6);
}

}  // namespace
}  // namespace morula
