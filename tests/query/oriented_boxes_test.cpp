// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes beside each other say how far facets are at least: never more than the distance that is computed, since a facet
// that is left out is not looked at again. scripts/mutants takes the allowances away, one after the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/triangle.hpp>
#include <query/oriented_boxes.hpp>
#include <span>
#include <vector>

namespace morula {
using namespace detail;
namespace {

Vec3 in_a_cube(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}

Vec3 area_vector_of(const std::vector<Triangle>& patch) {
  Vec3 sum;
  for (const Triangle& t : patch) sum += cross(t[1] - t[0], t[2] - t[0]);
  return sum * 0.5;
}

// As the index has it: a computed closest point may be off by some ulps of the coordinates.
Box padded_box(const std::vector<Triangle>& patch) {
  Box box;
  for (const Triangle& t : patch)
    for (const Vec3& corner : t) box.add(corner);
  const double pad = 0x1p-48 * std::max(max_norm(box.lower), max_norm(box.upper));
  return {box.lower - Vec3{pad, pad, pad}, box.upper + Vec3{pad, pad, pad}};
}

// A mesh's box, of which patches are a small part.
struct Place {
  Vec3 origin;
  double size = 1;
  Units units() const { return Units(Box{origin - Vec3{size, size, size}, origin + Vec3{size, size, size}}); }
};

enum class Axes { own, coordinates };

BoxMaker boxes_about(const Place& place, const std::vector<std::vector<Triangle>>& patches, Axes axes) {
  Box all;
  for (const std::vector<Triangle>& patch : patches) all.add(padded_box(patch));
  BoxMaker maker(place.units(), all);
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (axes == Axes::own)
      maker.set(static_cast<int>(k), patches[k], area_vector_of(patches[k]));
    else
      maker.set(static_cast<int>(k), padded_box(patches[k]));
  return maker;
}

// Squared, in Units: by the boxes, and by the facets themselves.
std::vector<double> bounds(const Units& units, const OrientedBoxes& boxes, const Vec3& p) {
  return with_distances(units, p, [&](const auto& to) {
    typename std::decay_t<decltype(to)>::Scalar distances[OrientedBoxes::count];
    to(boxes, distances);
    return std::vector<double>(distances, distances + OrientedBoxes::count);
  });
}
// The same of single facets in the axes of their patch; those of the first four.
std::vector<double> facet_bounds(const Units& units, const BoxMaker& maker, int k, const std::vector<Triangle>& patch,
                                 const Vec3& p) {
  const auto some = std::span(patch).first(std::min<std::size_t>(patch.size(), OrientedBoxes::count));
  return with_distances(units, p, [&](const auto& to) {
    typename std::decay_t<decltype(to)>::Scalar distances[OrientedBoxes::count];
    to(maker.boxes(), k, maker.facets_of(k, some), distances);
    return std::vector<double>(distances, distances + some.size());
  });
}
double least(const Units& units, const std::vector<Triangle>& patch, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : patch) least = std::min(least, closest_point(t, p).squared_distance);
  return least * units.scale * units.scale;
}

// Triangles about a place: far from all others or in one plane, long ones, corners of all kinds.
std::vector<std::vector<Triangle>> random_patches(Random& random, const Place& place, double size, int facets) {
  std::vector<std::vector<Triangle>> patches(OrientedBoxes::count);
  const Vec3 middle = place.origin + in_a_cube(random) * (0.4 * place.size);
  const bool flat = random.uniform(0, 1) < 0.5;
  for (std::vector<Triangle>& patch : patches) {
    const Vec3 here = middle + in_a_cube(random) * size, a = normalized(in_a_cube(random));
    const Vec3 b = normalized(cross(a, in_a_cube(random))), c = cross(a, b);
    const double thin = random.uniform(0, 1) < 0.3 ? 1e-5 : 1;
    for (int f = 0; f < facets; ++f) {
      Triangle t;
      for (Vec3& corner : t)
        corner = here + (a * random.uniform(-1, 1) + b * random.uniform(-thin, thin)) * size +
                 c * (flat ? 0 : random.uniform(-0.1, 0.1) * size);
      patch.push_back(t);
    }
  }
  return patches;
}

// Points from which a box is exactly as far as what it is about, but for rounding: above a facet, at any height.
Vec3 point_above(Random& random, const Triangle& t, double height) {
  const double u = random.uniform(0, 1), v = random.uniform(0, 1 - u);
  const int corner = static_cast<int>(random.next() % 3);
  const Vec3 foot = random.uniform(0, 1) < 0.3 ? t[corner] : t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const bool straight = random.uniform(0, 1) < 0.8 && squared_length(normal) > 0;
  return foot + (straight ? normalized(normal) : normalized(in_a_cube(random))) * height;
}

void expect_no_more(Random& random, const Place& place, double size, double lowest, double highest, Axes axes) {
  const auto patches = random_patches(random, place, size * place.size, random.next() % 2 == 0 ? 1 : 5);
  const BoxMaker maker = boxes_about(place, patches, axes);
  const Units units = place.units();
  for (int i = 0; i < 8; ++i) {
    const std::size_t k = static_cast<std::size_t>(i) % patches.size();
    const double height = place.size * std::exp2(random.uniform(lowest, highest));
    const Vec3 p = point_above(random, patches[k][0], height);
    const std::vector<double> bound = bounds(units, maker.boxes(), p);
    for (std::size_t j = 0; j < patches.size(); ++j) {
      ASSERT_LE(bound[j], least(units, patches[j], p)) << place.origin.x << ' ' << size << ' ' << height << ' ' << j;
      const std::vector<double> of_facets = facet_bounds(units, maker, static_cast<int>(j), patches[j], p);
      for (std::size_t f = 0; f < of_facets.size(); ++f)
        ASSERT_LE(of_facets[f], least(units, {patches[j][f]}, p))
            << place.origin.x << ' ' << size << ' ' << height << ' ' << j << ' ' << f;
    }
  }
}

TEST(OrientedBoxes, near_by_are_no_farther_than_their_facets) {
  Random random(1);
  for (int round = 0; round < 6000; ++round) {
    const Place place{{}, std::exp2(static_cast<double>(random.next() % 180) - 90)};
    const double size = std::exp2(random.uniform(-14, -1));
    for (const Axes axes : {Axes::own, Axes::coordinates}) {
      expect_no_more(random, place, size, -40, 8, axes);
      expect_no_more(random, place, size, std::log2(size) - 24, std::log2(size) - 16, axes);
    }
  }
}

TEST(OrientedBoxes, near_by_are_no_farther_where_coordinates_are_large) {
  Random random(2);
  for (int round = 0; round < 4000; ++round) {
    const double far = std::exp2(random.uniform(20, 42));
    const Place place{normalized(in_a_cube(random)) * far, 1};
    const double size = std::exp2(random.uniform(-8, -1));
    for (const Axes axes : {Axes::own, Axes::coordinates}) expect_no_more(random, place, size, -30, 4, axes);
  }
}

TEST(OrientedBoxes, from_afar_are_no_farther_than_their_facets) {
  Random random(3);
  for (int round = 0; round < 4000; ++round) {
    const Place place{{}, std::exp2(static_cast<double>(random.next() % 60) - 30)};
    for (const Axes axes : {Axes::own, Axes::coordinates})
      expect_no_more(random, place, std::exp2(random.uniform(-8, -1)), 11, 50, axes);
  }
}

// A direction that is all but the facet's longest side: nothing is left of the side in the plane across it.
TEST(OrientedBoxes, a_direction_along_the_facet_is_no_danger) {
  Random random(4);
  for (int round = 0; round < 4000; ++round) {
    const Place place;
    const Vec3 middle = in_a_cube(random) * 0.1, side = normalized(in_a_cube(random));
    const Vec3 up = normalized(cross(side, in_a_cube(random)));
    const Triangle t{middle, middle + side * 0.5, middle + side * 0.2 + up * 0.1};
    const double off = std::exp2(random.uniform(-53, -20));
    BoxMaker maker(place.units(), padded_box({t}));
    for (int k = 0; k < OrientedBoxes::count; ++k) maker.set(k, std::vector<Triangle>{t}, side + up * off);
    for (int i = 0; i < 8; ++i) {
      const Vec3 p = point_above(random, t, std::exp2(random.uniform(-4, 4)));
      for (const double bound : bounds(place.units(), maker.boxes(), p)) ASSERT_LE(bound, least(place.units(), {t}, p));
      ASSERT_LE(facet_bounds(place.units(), maker, 0, {t}, p)[0], least(place.units(), {t}, p));
    }
  }
}

TEST(OrientedBoxes, limits_are_no_less) {
  Random random(5);
  for (int round = 0; round < 100000; ++round) {
    const double x = std::exp2(random.uniform(-300, 200)) * random.uniform(0.5, 1);
    const float limit = NearDistances::limit(x);
    ASSERT_TRUE(static_cast<double>(limit) >= x || limit == std::numeric_limits<float>::max()) << x;
    ASSERT_TRUE(static_cast<double>(limit) <= x * (1 + 0x1p-20) + 0x1p-120 || x > 0x1p119) << x;
  }
  EXPECT_GE(NearDistances::limit(0), 0);
  EXPECT_EQ(NearDistances::limit(std::numeric_limits<double>::infinity()), std::numeric_limits<float>::max());
}

// What they are for: a flat patch, seen from above, is as far as its box, and so is what lies beside it.
TEST(OrientedBoxes, a_flat_facet_is_as_far_as_its_box) {
  Random random(6);
  for (int round = 0; round < 2000; ++round) {
    const Place place;
    const auto patches = random_patches(random, place, 0.01, 1);
    const BoxMaker maker = boxes_about(place, patches, Axes::own);
    const Triangle& t = patches[0][0];
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    if (!(length(normal) > 1e-6)) continue;
    const Vec3 p = (t[0] + t[1] + t[2]) / 3.0 + normalized(normal) * random.uniform(0.1, 2);
    ASSERT_GE(facet_bounds(place.units(), maker, 0, patches[0], p)[0], 0.9999 * least(place.units(), patches[0], p));
    ASSERT_GE(bounds(place.units(), maker.boxes(), p)[0], 0.9999 * least(place.units(), patches[0], p));
  }
}

// All corners at one place, at the ends of the range, and boxes that no float holds.
TEST(OrientedBoxes, meshes_without_extent_keep_all_their_facets) {
  for (const double at : {0.0, 1.0, 0x1p-100, 0x1p100}) {
    const Vec3 place{at, 0, 0};
    const Triangle point{place, place, place};
    const Units units((Box{place, place}));
    BoxMaker maker(units, padded_box({point}));
    maker.set(0, std::vector<Triangle>{point}, Vec3{});
    for (const double away : {0.0, 0x1p-120, 1.0, 0x1p90, 0x1p199}) {
      const Vec3 p = place + Vec3{0, away, 0};
      EXPECT_LE(bounds(units, maker.boxes(), p)[0], least(units, {point}, p)) << at << ' ' << away;
      EXPECT_LE(facet_bounds(units, maker, 0, {point}, p)[0], least(units, {point}, p)) << at << ' ' << away;
    }
  }
}

}  // namespace
}  // namespace morula
