// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "svg/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace morula::study {
namespace {

constexpr int shade_count = 20;
constexpr int slabs = 16;

toolbox::Shade shade_color(int shade) {
  const double t = static_cast<double>(shade) / (shade_count - 1);
  const auto mix = [&](double dark, double light) {
    return static_cast<std::uint32_t>(std::lround(dark + t * (light - dark)));
  };
  const std::uint32_t color = mix(58, 236) << 16 | mix(66, 222) << 8 | mix(88, 204);
  return {color, color};
}

}  // namespace

PictureView side_view(int axis) {
  const auto unit = [](int k) {
    Vec3 v{0, 0, 0};
    v[k % 3] = 1;
    return v;
  };
  // A quarter of the way to three quarters view: cos and sin of 24° and 16°.
  const Vec3 along = unit(axis), above = unit(axis + 1), front = unit(axis + 2);
  constexpr double cy = 0.9135, sy = 0.4067, cp = 0.9613, sp = 0.2756;
  const Vec3 right = along * cy + front * -sy;
  const Vec3 back = along * sy + front * cy;
  return {right, above * cp + back * -sp, above * sp + back * cp};
}

PictureBox picture_box(const PictureView& view, const PositionView& points, std::span<const Sphere> spheres) {
  PictureBox box{1e300, 1e300, -1e300, -1e300};
  const auto add = [&](double x, double y, double r) {
    box.x0 = std::min(box.x0, x - r), box.x1 = std::max(box.x1, x + r);
    box.y0 = std::min(box.y0, y - r), box.y1 = std::max(box.y1, y + r);
  };
  for (std::size_t i = 0; i < points.size(); ++i) add(view.x(points[i]), view.y(points[i]), 0);
  for (const Sphere& s : spheres) add(view.x(s.center), view.y(s.center), view.scale * s.radius);
  return box;
}

void draw_mesh(const MeshView& mesh, const PictureView& view, toolbox::Drawing& drawing) {
  struct Seen {
    double depth;
    int shade;
    std::size_t facet;
  };
  std::vector<Seen> seen;
  double near = -1e300;
  double far = 1e300;
  const Vec3 light = (view.toward * 0.75 + view.up * 0.55 + view.right * -0.37);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    const Vec3 normal = cross(b - a, c - a);
    const double size = length(normal);
    if (!(size > 0) || dot(normal, view.toward) <= 0) continue;
    const double bright = std::clamp(0.22 + 0.78 * dot(normal, light) / size, 0.0, 1.0);
    const double depth = view.depth((a + b + c) * (1.0 / 3));
    near = std::max(near, depth), far = std::min(far, depth);
    seen.push_back({depth, static_cast<int>(std::lround(bright * (shade_count - 1))), f});
  }
  // Facets of one slab of depth hardly hide each other, so within it those of one shade may share a path.
  const double thickness = std::max((near - far) / slabs, 1e-300);
  std::map<std::pair<int, int>, toolbox::DrawnPath> paths;
  for (const Seen& s : seen) {
    toolbox::DrawnPath& path = paths[{std::min(slabs - 1, static_cast<int>((s.depth - far) / thickness)), s.shade}];
    char kind = 'M';
    for (const Vec3& corner : mesh.corners(s.facet)) {
      path.steps.push_back({kind, view.x(corner), view.y(corner)});
      kind = 'L';
    }
    path.steps.push_back({'Z'});
  }
  for (auto& [key, path] : paths) {
    path.fill = path.stroke = shade_color(key.second);
    path.width = 0.6;
    drawing.items.emplace_back(std::move(path));
  }
}

Mesh coarser(const Mesh& mesh, std::size_t most_facets, std::vector<std::uint32_t>& kept) {
  kept.resize(mesh.vertex_count());
  for (std::size_t v = 0; v < kept.size(); ++v) kept[v] = static_cast<std::uint32_t>(v);
  Mesh result = mesh;
  const Box box = bounding_box(mesh);
  for (double cells = 200; result.facet_count() > most_facets && cells > 8; cells *= 0.85) {
    const double edge = box.diagonal() / cells;
    std::map<std::array<long, 3>, std::uint32_t> place;
    std::vector<std::uint32_t> becomes(mesh.vertex_count());
    kept.clear();
    result = {};
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3 p = (mesh.positions[v] - box.lower) * (1 / edge);
      const auto [at, fresh] = place.try_emplace({std::lround(p.x), std::lround(p.y), std::lround(p.z)},
                                                 static_cast<std::uint32_t>(kept.size()));
      if (fresh) {
        kept.push_back(static_cast<std::uint32_t>(v));
        result.positions.push_back(mesh.positions[v]);
      }
      becomes[v] = at->second;
    }
    for (const Facet& f : mesh.facets) {
      const Facet g{becomes[f[0]], becomes[f[1]], becomes[f[2]]};
      if (g[0] != g[1] && g[1] != g[2] && g[2] != g[0]) result.facets.push_back(g);
    }
  }
  return result;
}

}  // namespace morula::study
