// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The visible parts of spheres: a raster has the sphere in front at each pixel, and the borders of its regions become
// paths.
#include <algorithm>
#include <array>
#include <cmath>

#include "svg/picture.hpp"

namespace morula::study {
namespace {

constexpr double per_unit = 3;  // pixels per page unit
constexpr int nothing = -1;

struct Point {
  double x, y;
};

/// The front sphere of each pixel; spheres.size() for the mesh.
class Raster {
 public:
  Raster(const PictureBox& box)
      : x0_(std::floor(box.x0) - 1),
        y0_(std::floor(box.y0) - 1),
        columns_(static_cast<int>(std::ceil((box.x1 - x0_ + 2) * per_unit))),
        rows_(static_cast<int>(std::ceil((box.y1 - y0_ + 2) * per_unit))),
        owner_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), nothing),
        depth_(owner_.size(), -1e300) {}

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int at(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return nothing;
    return owner_[index(column, row)];
  }
  /// The corner above and left of a pixel.
  Point corner(double column, double row) const { return {x0_ + column / per_unit, y0_ + row / per_unit}; }

  void add(const Sphere& s, const PictureView& view, int id) {
    const double x = (view.x(s.center) - x0_) * per_unit - 0.5;
    const double y = (view.y(s.center) - y0_) * per_unit - 0.5;
    const double r = view.scale * s.radius * per_unit;
    for (int row = first(y - r); row <= last(y + r, rows_); ++row) {
      const double dy = row - y;
      const double half = std::sqrt(std::max(0.0, r * r - dy * dy));
      for (int column = first(x - half); column <= last(x + half, columns_); ++column) {
        const double dx = column - x;
        put(column, row, view.depth(s.center) * per_unit + std::sqrt(std::max(0.0, r * r - dx * dx - dy * dy)), id);
      }
    }
  }

  /// slack: in pixels, by which the mesh has to be in front.
  void add(const std::array<Vec3, 3>& facet, const PictureView& view, int id, double slack) {
    std::array<std::array<double, 3>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = {(view.x(facet[k]) - x0_) * per_unit - 0.5, (view.y(facet[k]) - y0_) * per_unit - 0.5,
              view.depth(facet[k]) * per_unit - slack};
    }
    const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
    if (area == 0) return;
    const auto [low_x, high_x] = std::minmax({p[0][0], p[1][0], p[2][0]});
    const auto [low_y, high_y] = std::minmax({p[0][1], p[1][1], p[2][1]});
    for (int row = first(low_y); row <= last(high_y, rows_); ++row) {
      for (int column = first(low_x); column <= last(high_x, columns_); ++column) {
        std::array<double, 3> w{};
        for (std::size_t k = 0; k < 3; ++k) {
          const auto& a = p[(k + 1) % 3];
          const auto& b = p[(k + 2) % 3];
          w[k] = ((b[0] - a[0]) * (row - a[1]) - (b[1] - a[1]) * (column - a[0])) / area;
        }
        if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
        put(column, row, w[0] * p[0][2] + w[1] * p[1][2] + w[2] * p[2][2], id);
      }
    }
  }

 private:
  static int first(double value) { return std::max(0, static_cast<int>(std::ceil(value))); }
  static int last(double value, int count) { return std::min(count - 1, static_cast<int>(std::floor(value))); }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  void put(int column, int row, double depth, int id) {
    const std::size_t i = index(column, row);
    if (depth <= depth_[i]) return;
    depth_[i] = depth;
    owner_[i] = id;
  }

  double x0_, y0_;
  int columns_, rows_;
  std::vector<int> owner_;
  std::vector<double> depth_;
};

/// An edge of a pixel on the border of a region, which lies on its right.
struct Crack {
  int x, y, to_x, to_y;
  bool used = false;
};

/// The borders of each region, by owner.
std::vector<std::vector<Crack>> cracks(const Raster& raster, std::size_t owners) {
  std::vector<std::vector<Crack>> all(owners);
  for (int y = 0; y < raster.rows(); ++y) {
    for (int x = 0; x < raster.columns(); ++x) {
      const int id = raster.at(x, y);
      if (id == nothing) continue;
      std::vector<Crack>& list = all[static_cast<std::size_t>(id)];
      if (raster.at(x, y - 1) != id) list.push_back({x, y, x + 1, y});
      if (raster.at(x + 1, y) != id) list.push_back({x + 1, y, x + 1, y + 1});
      if (raster.at(x, y + 1) != id) list.push_back({x + 1, y + 1, x, y + 1});
      if (raster.at(x - 1, y) != id) list.push_back({x, y + 1, x, y});
    }
  }
  return all;
}

/// Closed loops through the middles of cracks: diagonals instead of stairs.
std::vector<std::vector<Point>> loops(std::vector<Crack>& list, const Raster& raster) {
  const auto before = [](const Crack& a, const Crack& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; };
  std::stable_sort(list.begin(), list.end(), before);
  std::vector<std::vector<Point>> all;
  for (Crack& start : list) {
    if (start.used) continue;
    std::vector<Point> loop;
    for (Crack* crack = &start; crack != nullptr;) {
      crack->used = true;
      loop.push_back(raster.corner(0.5 * (crack->x + crack->to_x), 0.5 * (crack->y + crack->to_y)));
      const Crack wanted{crack->to_x, crack->to_y, 0, 0};
      auto next = std::lower_bound(list.begin(), list.end(), wanted, before);
      while (next != list.end() && next->x == wanted.x && next->y == wanted.y && next->used) ++next;
      crack = next != list.end() && next->x == wanted.x && next->y == wanted.y ? &*next : nullptr;
    }
    all.push_back(std::move(loop));
  }
  return all;
}

double distance_to_line(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double size = std::hypot(dx, dy);
  if (size == 0) return std::hypot(p.x - a.x, p.y - a.y);
  return std::abs(dx * (p.y - a.y) - dy * (p.x - a.x)) / size;
}

/// Douglas and Peucker: keeps points that are farther than `tolerance` from the straight line.
void simplify(const std::vector<Point>& loop, std::size_t begin, std::size_t end, double tolerance,
              std::vector<Point>& kept) {
  double farthest = 0;
  std::size_t at = begin;
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double distance = distance_to_line(loop[i], loop[begin], loop[end % loop.size()]);
    if (distance > farthest) farthest = distance, at = i;
  }
  if (farthest <= tolerance) {
    kept.push_back(loop[begin]);
    return;
  }
  simplify(loop, begin, at, tolerance, kept);
  simplify(loop, at, end, tolerance, kept);
}

void add_loop(const std::vector<Point>& loop, toolbox::DrawnPath& path) {
  std::size_t half = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (std::hypot(loop[i].x - loop[0].x, loop[i].y - loop[0].y) >
        std::hypot(loop[half].x - loop[0].x, loop[half].y - loop[0].y))
      half = i;
  std::vector<Point> kept;
  constexpr double tolerance = 0.62 / per_unit;
  simplify(loop, 0, half, tolerance, kept);
  simplify(loop, half, loop.size(), tolerance, kept);
  if (kept.size() < 3) return;
  char kind = 'M';
  for (const Point& point : kept) {
    path.steps.push_back({kind, point.x, point.y});
    kind = 'L';
  }
  path.steps.push_back({'Z'});
}

}  // namespace

void draw_spheres(const MeshView& mesh, std::span<const Sphere> spheres, const PictureView& view,
                  toolbox::Drawing& drawing) {
  Raster raster(picture_box(view, mesh.positions, spheres));
  for (std::size_t i = 0; i < spheres.size(); ++i) raster.add(spheres[i], view, static_cast<int>(i));
  // Spheres that touch the surface from outside must not get spots by rounding: a sixth of a page unit.
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    raster.add(mesh.corners(f), view, static_cast<int>(spheres.size()), 0.5);
  std::vector<std::vector<Crack>> borders = cracks(raster, spheres.size() + 1);
  for (std::size_t i = 0; i <= spheres.size(); ++i) {
    toolbox::DrawnPath path;
    for (const std::vector<Point>& loop : loops(borders[i], raster)) add_loop(loop, path);
    if (path.steps.empty()) continue;
    path.even_odd = true;
    path.width = 0.3;
    if (i == spheres.size()) {
      path.fill = uncovered_shade;
    } else {
      const double x = view.x(spheres[i].center), y = view.y(spheres[i].center), r = view.scale * spheres[i].radius;
      path.ball = toolbox::Ball{x, y, r, x - 0.3 * r, y - 0.4 * r};
    }
    drawing.items.emplace_back(std::move(path));
  }
}

}  // namespace morula::study
