// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Surfaces of solids in memory, against a count of faces in a map and against shapes of known volume.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/solid_surface.hpp>
#include <numeric>
#include <set>
#include <support/error_text.hpp>

namespace morula {
namespace {

using test::error_text;

struct Grid {
  std::vector<Vec3> points;
  std::vector<Hexahedron> hexahedra;
  std::vector<Tetrahedron> tetrahedra;  // six per hexahedron, about its long diagonal; they share whole faces
};

/// A block of unit cells, of which `is_full` chooses some. Every other tetrahedron is mirrored.
template <class Full>
Grid grid(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, const Full& is_full) {
  Grid made;
  const auto at = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return (z * (ny + 1) + y) * (nx + 1) + x; };
  for (std::uint32_t z = 0; z <= nz; ++z)
    for (std::uint32_t y = 0; y <= ny; ++y)
      for (std::uint32_t x = 0; x <= nx; ++x) made.points.emplace_back(x, y, z);
  for (std::uint32_t z = 0; z < nz; ++z)
    for (std::uint32_t y = 0; y < ny; ++y)
      for (std::uint32_t x = 0; x < nx; ++x) {
        if (!is_full(x, y, z)) continue;
        made.hexahedra.push_back({at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z), at(x, y + 1, z), at(x, y, z + 1),
                                  at(x + 1, y, z + 1), at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)});
        std::array<int, 3> axes{0, 1, 2};
        do {  // one path along the three axes for each tetrahedron
          std::array<std::uint32_t, 3> corner{x, y, z};
          Tetrahedron made_of{at(x, y, z)};
          for (std::size_t k = 0; k < 3; ++k) {
            ++corner[static_cast<std::size_t>(axes[k])];
            made_of[k + 1] = at(corner[0], corner[1], corner[2]);
          }
          made.tetrahedra.push_back(made_of);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
  return made;
}

bool everywhere(std::uint32_t, std::uint32_t, std::uint32_t) {
  return true;
}

TEST(SolidSurface, of_tetrahedra_has_the_faces_that_one_of_them_has) {
  const Grid block = grid(4, 3, 2, [](auto x, auto y, auto) { return x != 1 || y != 1; });
  std::map<std::set<std::uint32_t>, int> count;
  for (const Tetrahedron& t : block.tetrahedra)
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::set<std::uint32_t> face(t.begin(), t.end());
      face.erase(t[left_out]);
      ++count[face];
    }
  std::set<std::set<std::uint32_t>> expected, found;
  for (const auto& [face, times] : count)
    if (times == 1) expected.insert(face);
  const UsedVertices surface = solid_surface(block.points, block.tetrahedra);
  for (const Facet& f : surface.mesh.facets)
    found.insert({surface.index[f[0]], surface.index[f[1]], surface.index[f[2]]});
  EXPECT_EQ(found, expected);
  EXPECT_EQ(surface.mesh.facet_count(), expected.size());
  const MeshReport report = inspect(surface.mesh);
  EXPECT_TRUE(report.closed && report.oriented && report.unused_vertices == 0);
  EXPECT_DOUBLE_EQ(report.volume, 22);  // outward; 4 × 3 × 2 cells but two
}

TEST(SolidSurface, of_a_block_has_its_volume_its_area_and_the_points_on_its_sides) {
  const Grid block = grid(4, 3, 3, everywhere);
  for (const bool whole_cells : {false, true}) {
    const UsedVertices surface =
        whole_cells ? solid_surface(block.points, {}, block.hexahedra) : solid_surface(block.points, block.tetrahedra);
    EXPECT_DOUBLE_EQ(signed_volume(surface.mesh), 36);
    EXPECT_DOUBLE_EQ(surface_area(surface.mesh), 2 * (4 * 3 + 4 * 3 + 3 * 3));
    EXPECT_EQ(surface.mesh.facet_count(), 4u * (4 * 3 + 4 * 3 + 3 * 3));
    std::vector<std::uint32_t> sides;
    for (std::uint32_t v = 0; v < block.points.size(); ++v) {
      const Vec3& p = block.points[v];
      if (p.x == 0 || p.x == 4 || p.y == 0 || p.y == 3 || p.z == 0 || p.z == 3) sides.push_back(v);
    }
    EXPECT_EQ(surface.index, sides);
    for (std::size_t i = 0; i < sides.size(); ++i) EXPECT_EQ(surface.mesh.positions[i], block.points[sides[i]]);
  }
}

TEST(SolidSurface, follows_moved_points_by_its_index) {
  Grid block = grid(2, 2, 2, everywhere);
  const UsedVertices surface = solid_surface(block.points, block.tetrahedra);
  for (Vec3& p : block.points) p = Vec3{2 * p.x + p.y, p.y, 3 * p.z};
  const auto moved = PositionView::indexed(block.points, surface.index).to_vector();
  EXPECT_DOUBLE_EQ(signed_volume(MeshView(moved, surface.mesh.facets)), 6 * 8);
}

TEST(SolidSurface, reads_strided_floats) {
  const Grid block = grid(2, 1, 1, everywhere);
  std::vector<float> records;
  for (const Vec3& p : block.points)
    for (const double number : {p.x, p.y, p.z, 7.0}) records.push_back(static_cast<float>(number));
  const auto view = PositionView::strided(records.data(), block.points.size(), 4 * sizeof(float));
  EXPECT_EQ(solid_surface(view, block.tetrahedra).mesh.facets,
            solid_surface(block.points, block.tetrahedra).mesh.facets);
}

TEST(SolidSurface, keeps_a_cavity_facing_into_it) {
  const Grid block = grid(3, 3, 3, [](auto x, auto y, auto z) { return x != 1 || y != 1 || z != 1; });
  const UsedVertices surface = solid_surface(block.points, block.tetrahedra);
  EXPECT_DOUBLE_EQ(signed_volume(surface.mesh), 26);
  EXPECT_DOUBLE_EQ(surface_area(surface.mesh), 54 + 6);
}

TEST(SolidSurface, names_the_offender) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {1, 1, 0}, {1, 1, 1}};
  const auto error = [&](std::vector<Tetrahedron> tetrahedra) {
    return error_text([&] { return solid_surface(points, tetrahedra); });
  };
  EXPECT_EQ(error({}), "no tetrahedra and no hexahedra");
  EXPECT_EQ(error({{0, 1, 2, 3}, {0, 1, 2, 7}}), "tetrahedron 1 has the corner 7; there are 7 points");
  EXPECT_EQ(error({{0, 1, 2, 3}, {0, 1, 1, 4}}), "tetrahedron 1 has the corner 1 twice");
  EXPECT_EQ(error({{0, 1, 2, 5}}), "tetrahedron 0 has no volume: its corners lie in one plane");
  EXPECT_EQ(error({{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 6}}),
            "tetrahedron 0 and tetrahedron 1 share a face with tetrahedron 2; a face may belong to two solids");
  EXPECT_EQ(error({{0, 1, 2, 3}, {0, 1, 2, 4}, {3, 2, 1, 0}}),
            "tetrahedron 0 and tetrahedron 1 share a face with tetrahedron 2; a face may belong to two solids");
  EXPECT_EQ(error({{0, 1, 2, 3}, {3, 2, 1, 0}}),
            "tetrahedron 0 and tetrahedron 1 lie on the same side of a common face: one is repeated, or they overlap");
  EXPECT_EQ(error({{0, 1, 2, 3}, {0, 1, 2, 6}}),
            "tetrahedron 0 and tetrahedron 1 lie on the same side of a common face: one is repeated, or they overlap");
  EXPECT_EQ(error({{0, 1, 2, 3}, {0, 1, 2, 4}}), "");
  std::vector<Vec3> broken = points;
  broken[3].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_text([&] {
              return solid_surface(broken, std::vector<Tetrahedron>{{0, 1, 2, 4}, {0, 1, 2, 3}});
            }),
            "tetrahedron 1 has the corner 3, whose position is not finite");
  EXPECT_EQ(error_text([&] {
              return solid_surface(std::vector<Vec3>(8), {}, std::vector<Hexahedron>{{0, 1, 2, 3, 4, 5, 6, 7}});
            }),
            "hexahedron 0 has no volume");
}

TEST(SolidSurface, skips_points_of_no_solid_whatever_they_hold) {
  std::vector<Vec3> points{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  points[1].x = std::numeric_limits<double>::quiet_NaN();
  const UsedVertices surface = solid_surface(points, std::vector<Tetrahedron>{{0, 2, 3, 4}});
  EXPECT_EQ(surface.index, (std::vector<std::uint32_t>{0, 2, 3, 4}));
  EXPECT_DOUBLE_EQ(signed_volume(surface.mesh), 1.0 / 6);
}

}  // namespace
}  // namespace morula
