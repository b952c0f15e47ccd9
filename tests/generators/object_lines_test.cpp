// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lines through the object, against volumes that are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <generators/fit/object_lines.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/meshes.hpp>

namespace morula {
using namespace detail;
namespace {

ObjectLines lines_of(const Mesh& mesh, int cells, Workers& workers = serial_workers()) {
  return {mesh, ObjectShape(mesh), cells, workers};
}

template <class Visit>
void each_line(const ObjectLines& lines, int axis, const Visit& visit) {
  for (int v = 0; v < lines.count()[static_cast<std::size_t>((axis + 2) % 3)]; ++v)
    for (int u = 0; u < lines.count()[static_cast<std::size_t>((axis + 1) % 3)]; ++u) visit(lines.line(axis, u, v));
}

double inside_volume_by_lines(const ObjectLines& lines, int axis) {
  double sum = 0;
  each_line(lines, axis, [&](auto crossings) {
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
      sum += static_cast<double>(crossings[i + 1].at) - static_cast<double>(crossings[i].at);
  });
  return sum * lines.cell() * lines.cell() * lines.cell();
}

// Sides that no line runs along and no cell wall lies in.
Mesh askew_box() {
  Mesh mesh = test::box_mesh({0, 0, 0}, {3, 2, 1}, 4);
  const Vec3 x = normalized(Vec3{3, 1, 0.5}), y = normalized(cross(Vec3{0.2, 0.1, 1}, x)), z = cross(x, y);
  for (Vec3& p : mesh.positions) p = x * p.x + y * p.y + z * p.z + Vec3{0.123, -4.7, 2.31};
  return mesh;
}

struct Body {
  const char* name;
  Mesh mesh;
};
std::vector<Body> closed_bodies() {
  return {{"askew box", askew_box()},
          {"icosphere", test::icosphere(4)},
          {"torus", sample_body("torus", 32)},
          {"limb", sample_body("limb", 24)},
          {"two", sample_body("two", 24)}};
}

void expect_same_lines(const ObjectLines& a, const ObjectLines& b) {
  ASSERT_EQ(a.count(), b.count());
  EXPECT_EQ(a.cell(), b.cell());
  for (int axis = 0; axis < 3; ++axis) {
    const int nu = a.count()[static_cast<std::size_t>((axis + 1) % 3)];
    const int nv = a.count()[static_cast<std::size_t>((axis + 2) % 3)];
    for (int v = 0; v < nv; ++v)
      for (int u = 0; u < nu; ++u) {
        const auto p = a.line(axis, u, v), q = b.line(axis, u, v);
        const bool same = std::equal(p.begin(), p.end(), q.begin(), q.end(),
                                     [](const auto& s, const auto& t) { return s.at == t.at && s.facet == t.facet; });
        ASSERT_TRUE(same) << "axis " << axis << ", line " << u << ", " << v;
      }
  }
  for (int z = 0; z < a.count()[2]; z += 3)
    for (int y = 0; y < a.count()[1]; y += 3)
      for (int x = 0; x < a.count()[0]; x += 3)
        for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(a.weight(axis, {x, y, z}), b.weight(axis, {x, y, z}));
}

TEST(ObjectLines, enter_and_leave_closed_bodies_in_turn) {
  for (const Body& body : closed_bodies()) {
    const ObjectLines lines = lines_of(body.mesh, 64);
    for (int axis = 0; axis < 3; ++axis) {
      const int length = lines.count()[static_cast<std::size_t>(axis)];
      std::size_t crossed = 0;
      each_line(lines, axis, [&](auto crossings) {
        ASSERT_EQ(crossings.size() % 2, 0u) << body.name;
        crossed += !crossings.empty();
        for (std::size_t i = 0; i < crossings.size(); ++i) {
          ASSERT_GE(crossings[i].at, i == 0 ? -1e-3F : crossings[i - 1].at) << body.name;
          ASSERT_LE(crossings[i].at, static_cast<float>(length) + 1e-3F) << body.name;
          const Triangle t = body.mesh.corners(crossings[i].facet);
          const double out = cross(t[1] - t[0], t[2] - t[0])[axis];
          ASSERT_TRUE(i % 2 == 0 ? out < 0 : out > 0) << body.name << ": the facet faces the other way";
        }
      });
      EXPECT_GT(crossed, 100u) << body.name;
    }
  }
}

TEST(ObjectLines, inside_length_times_cell_area_is_the_volume_on_every_axis) {
  for (const Body& body : closed_bodies()) {
    const ObjectLines lines = lines_of(body.mesh, 96);
    const double volume = signed_volume(body.mesh);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(inside_volume_by_lines(lines, axis) / volume, 1, 0.01) << body.name << ", axis " << axis;
  }
}

TEST(ObjectLines, along_the_sides_of_a_box_count_it_to_a_cell) {
  const ObjectLines lines = lines_of(test::box_mesh({0, 0, 0}, {3, 2, 1}, 5), 64);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(inside_volume_by_lines(lines, axis) / 6, 1, 2 * lines.cell()) << axis;
}

TEST(ObjectLines, are_the_same_inside_out) {
  for (const Body& body : closed_bodies())
    expect_same_lines(lines_of(test::inverted(body.mesh), 48), lines_of(body.mesh, 48));
}

TEST(ObjectLines, vote_closes_an_open_scan) {
  // The unit sphere without its facets above z = 0.6: two of three lines see the rest below as inside.
  const ObjectLines lines = lines_of(test::mesh_named("open_scan").mesh, 96);
  const double h = 0.4, cap = std::numbers::pi * h * h * (1 - h / 3);
  const double expected = 4.0 / 3 * std::numbers::pi - cap;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(inside_volume_by_lines(lines, axis) / expected, 1, 0.05) << axis;
}

TEST(ObjectLines, vote_gives_all_three_axes_the_same_cells) {
  for (const char* name : {"open_scan", "facet_soup", "moebius_strip", "duplicated_facet", "three_pages"}) {
    const ObjectLines lines = lines_of(test::mesh_named(name).mesh, 40);
    const double x = inside_volume_by_lines(lines, 0);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(inside_volume_by_lines(lines, axis), x, 1e-5) << name;
      each_line(lines, axis, [&](auto crossings) {
        ASSERT_EQ(crossings.size() % 2, 0u) << name;
        for (const auto& c : crossings) {
          EXPECT_EQ(c.at, std::floor(c.at)) << name;
          EXPECT_LT(c.facet, test::mesh_named(name).mesh.facet_count()) << name;
        }
      });
    }
  }
}

TEST(ObjectLines, of_a_soup_are_inside_less_than_its_box) {
  const Mesh soup = test::facet_soup(200, 3);
  const ObjectLines lines = lines_of(soup, 48);
  const Vec3 extent = bounding_box(soup).extent();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GE(inside_volume_by_lines(lines, axis), 0);
    EXPECT_LE(inside_volume_by_lines(lines, axis), extent.x * extent.y * extent.z);
  }
}

TEST(ObjectLines, read_a_surface_that_is_there_twice_as_one) {
  const Mesh once = test::icosphere(4);
  Mesh same_vertices = once;
  same_vertices.facets.insert(same_vertices.facets.end(), once.facets.begin(), once.facets.end());
  const double volume = signed_volume(once);
  for (const Mesh& twice : {same_vertices, test::joined(once, once)}) {
    const ObjectLines lines = lines_of(twice, 96);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(inside_volume_by_lines(lines, axis) / volume, 1, 0.03) << axis;
  }
  const ObjectLines cube = lines_of(test::mesh_named("duplicated_facet").mesh, 48);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(inside_volume_by_lines(cube, axis), 1, 0.05) << axis;
}

TEST(ObjectLines, weights_sum_to_one_on_the_lattice_and_off_it) {
  Random random(1);
  for (const test::NamedMesh& named : test::all_meshes()) {
    const ObjectLines lines = lines_of(named.mesh, 80);
    for (int i = 0; i < 500; ++i) {
      std::array<int, 3> cell;
      for (std::size_t k = 0; k < 3; ++k)
        cell[k] = static_cast<int>(random.uniform(-20, static_cast<double>(lines.count()[k]) + 20));
      float sum = 0;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(lines.weight(axis, cell), 0) << named.name;
        sum += lines.weight(axis, cell);
      }
      EXPECT_NEAR(sum, 1, 1e-5) << named.name;
    }
  }
}

TEST(ObjectLines, weights_follow_the_normal) {
  const ObjectLines lines = lines_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 64);
  for (int axis = 0; axis < 3; ++axis) {
    std::array<int, 3> cell{32, 32, 32};
    cell[static_cast<std::size_t>(axis)] = 0;
    EXPECT_NEAR(lines.weight(axis, cell), 1, 1e-5);
  }
}

TEST(ObjectLines, have_the_same_bits_for_any_number_of_workers) {
  for (const Mesh& mesh : {sample_body("limb", 32), test::facet_soup(300, 2)}) {
    const ObjectLines reference = lines_of(mesh, 64);
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
      Workers workers(threads);
      expect_same_lines(lines_of(mesh, 64, workers), reference);
    }
  }
}

}  // namespace
}  // namespace morula
