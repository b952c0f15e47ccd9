// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies and spheres seen from one side, as paths: shaded facets, and the visible part of every sphere.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <toolbox/drawing.hpp>

namespace morula::study {

/// Parallel projection. right, up, toward: an orthonormal frame; toward points at the viewer.
struct PictureView {
  Vec3 right, up, toward;
  double scale = 1;  // page units per mesh unit
  double page_x = 0;
  double page_y = 0;  // place of the mesh's origin on the page; the page's y points down

  double x(const Vec3& p) const { return page_x + scale * dot(right, p); }
  double y(const Vec3& p) const { return page_y - scale * dot(up, p); }
  double depth(const Vec3& p) const { return scale * dot(toward, p); }
};

/// A view of bodies that lie along `axis`: from the side, a little from above and turned.
PictureView side_view(int axis);

/// The box of a drawing, in page units, without any shift.
struct PictureBox {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
PictureBox picture_box(const PictureView& view, const PositionView& points, std::span<const Sphere> spheres);

/// Facets that face the viewer, in the order of their depth; neighboring ones of one shade share a path.
void draw_mesh(const MeshView& mesh, const PictureView& view, toolbox::Drawing& drawing);

/// The visible part of every sphere, shaded as a ball, and in a color of its own the part of the mesh that is in front
/// of all spheres: uncovered surface. It is found on a raster of a third of a page unit.
void draw_spheres(const MeshView& mesh, std::span<const Sphere> spheres, const PictureView& view,
                  toolbox::Drawing& drawing);

/// The color of uncovered surface.
inline constexpr toolbox::Shade uncovered_shade{0xd55e00, 0xd55e00};

/// A coarser mesh for pictures: vertices that share a cell of a lattice become one, at the position of the first of
/// them. `kept` has, for each of its vertices, the index of that vertex in the mesh.
Mesh coarser(const Mesh& mesh, std::size_t most_facets, std::vector<std::uint32_t>& kept);

}  // namespace morula::study
