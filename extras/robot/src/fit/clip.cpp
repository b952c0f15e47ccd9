// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/clip.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <morula/tree/sphere_tree.hpp>
#include <utility>

namespace morula::robot {

namespace {

constexpr std::uint32_t no_place = 0xffffffffu;

/// One half space of a mesh, its unused vertices left out.
class Cutter {
 public:
  Cutter(const Mesh& mesh, const ClipPlane& plane, double offset) : mesh_(mesh) {
    for (const Vec3& p : mesh.positions) heights_.push_back(dot(plane.normal, p) - offset);
    places_.assign(mesh.positions.size(), no_place);
  }

  Mesh run() {
    for (const Facet& facet : mesh_.facets) {
      std::vector<std::uint32_t> corners;  // corners of the kept part of the facet, up to four
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = facet[k], b = facet[(k + 1) % 3];
        if (kept(a)) corners.push_back(place(a));
        if (kept(a) != kept(b)) corners.push_back(cut(a, b));
      }
      for (std::size_t k = 2; k < corners.size(); ++k) {
        result_.facets.push_back({corners[0], corners[k - 1], corners[k]});
      }
    }
    return std::move(result_);
  }

 private:
  bool kept(std::uint32_t vertex) const { return heights_[vertex] >= 0; }

  std::uint32_t add(const Vec3& p) {
    result_.positions.push_back(p);
    return static_cast<std::uint32_t>(result_.positions.size() - 1);
  }
  std::uint32_t place(std::uint32_t vertex) {
    if (places_[vertex] == no_place) places_[vertex] = add(mesh_.positions[vertex]);
    return places_[vertex];
  }
  /// The point of an edge in the plane, the same for both facets.
  std::uint32_t cut(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [at, fresh] = cuts_.try_emplace({a, b}, no_place);
    if (fresh) {
      const double share = heights_[a] / (heights_[a] - heights_[b]);
      at->second = add(mesh_.positions[a] + share * (mesh_.positions[b] - mesh_.positions[a]));
    }
    return at->second;
  }

  const Mesh& mesh_;
  Mesh result_;
  std::vector<double> heights_;
  std::vector<std::uint32_t> places_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cuts_;
};

constexpr std::size_t most_spheres = 20'000;
constexpr int deepest_division = 16;

void add_what_stays(const std::function<bool(const Sphere&)>& stays,
                    const std::function<bool(const Sphere&, const Mesh&)>& may_stay, const Mesh& mesh,
                    const CoveredTree& model, const BuildOptions& options, int depth, std::vector<Sphere>& spheres) {
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node) {
    if (model.tree.child_count[node] != 0) continue;
    const Sphere& s = model.tree.spheres[node];
    // mutant robot-clip-stays: `stays(s)` -> `true`
    if (stays(s) || depth == deepest_division || spheres.size() > most_spheres) {
      spheres.push_back(s);
      continue;
    }
    const Mesh region = region_mesh(mesh, model.cover, node);
    if (!may_stay(s, region)) {
      spheres.push_back(s);
      continue;
    }
    CoveredTree smaller = build(region, options, serial_workers());
    // A region that is round may be covered best by one sphere. The spheres of an octree are as small as its cells.
    if (smaller.tree.leaf_count() < 2 || depth >= 4) {
      smaller = build(region, {.method = Method::octree, .depth = 1, .stop = options.stop}, serial_workers());
    }
    add_what_stays(stays, may_stay, region, smaller, options, depth + 1, spheres);
  }
}

}  // namespace

Mesh region_mesh(const Mesh& mesh, const Cover& cover, std::uint32_t node) {
  Mesh region;
  for (std::uint32_t p = cover.region_begin[node]; p < cover.region_end[node]; ++p) {
    const auto base = static_cast<std::uint32_t>(region.positions.size());
    const std::span<const std::uint32_t> corners = cover.patch(p);
    for (const std::uint32_t corner : corners) {
      region.positions.push_back(corner_position(cover, corner, mesh.positions));
    }
    for (std::uint32_t k = 2; k < corners.size(); ++k) region.facets.push_back({base, base + k - 1, base + k});
  }
  return region;
}

void divide_until(const std::function<bool(const Sphere&)>& stays,
                  const std::function<bool(const Sphere&, const Mesh&)>& may_stay, const Mesh& mesh, CoveredTree& model,
                  const BuildOptions& options) {
  BuildOptions four = options;
  four.spheres = 4;
  std::vector<Sphere> spheres;
  add_what_stays(stays, may_stay, mesh, model, four, 0, spheres);
  if (spheres == level_set_spheres(model.tree, model.tree.level_count() - 1)) return;
  CoveredTree fitted = cover(mesh, tree_from_spheres(spheres), {.nested = true}, serial_workers());
  fitted.report.complete = model.report.complete;
  model = std::move(fitted);
}

void append_mesh(Mesh& to, const Mesh& mesh) {
  const auto base = static_cast<std::uint32_t>(to.positions.size());
  to.positions.insert(to.positions.end(), mesh.positions.begin(), mesh.positions.end());
  for (const Facet& f : mesh.facets) to.facets.push_back({base + f[0], base + f[1], base + f[2]});
}

Mesh ball_mesh_of(const Sphere& s, RoundShapes round) {
  Shape ball;
  ball.kind = Shape::Kind::ellipsoid;
  ball.size = 2 * s.radius * Vec3{1, 1, 1};
  ball.origin.translation = s.center;
  return surface_of({}, std::span(&ball, 1), round).mesh;
}

double reach_beyond(std::span<const Sphere> spheres, std::span<const ClipPlane> planes, double growth) {
  double most = 0;
  for (const Sphere& s : spheres) {
    for (const ClipPlane& plane : planes) most = std::max(most, reach_beyond(s, plane) + growth);
  }
  return most;
}

double least_height(const Mesh& mesh, std::span<const ClipPlane> planes) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& p : mesh.positions)
    for (const ClipPlane& plane : planes) least = std::min(least, dot(plane.normal, p) - plane.offset);
  return least;
}

LinkSurface clipped(const LinkSurface& surface, std::span<const ClipPlane> planes, double margin) {
  LinkSurface result;
  result.mesh = surface.mesh;
  for (const Sphere& s : surface.spheres) {
    double depth = s.radius;  // least depth of the center inside of the planes
    for (const ClipPlane& plane : planes) depth = std::min(depth, dot(plane.normal, s.center) - plane.offset - margin);
    if (depth >= s.radius) {
      result.spheres.push_back(s);
    } else if (depth > -s.radius) {
      append_mesh(result.mesh, ball_mesh_of(s, RoundShapes::around));
    }
  }
  for (const ClipPlane& plane : planes) result.mesh = Cutter(result.mesh, plane, plane.offset + margin).run();
  return result;
}

}  // namespace morula::robot
