// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "bodies.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <numbers>
#include <numeric>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

namespace morula::test {
namespace {

struct Patch {
  std::uint32_t facet;
  std::vector<std::uint32_t> corners;
};

class TreeMaker {
 public:
  TreeMaker(const Mesh& mesh, const HandMade& how) : mesh_(mesh), how_(how), random_(how.seed) {
    built_.cover.vertex_count = static_cast<std::uint32_t>(mesh.vertex_count());
    built_.cover.facet_count = static_cast<std::uint32_t>(mesh.facet_count());
    for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) cut(f);
  }

  CoveredTree make() {
    std::vector<std::uint32_t> all(patches_.size());
    std::iota(all.begin(), all.end(), 0u);
    built_.tree.branching = static_cast<std::uint32_t>(how_.branching);
    std::vector<std::vector<std::uint32_t>> regions{all};  // of all nodes
    std::vector<Sphere> spheres{sphere_of(all)};
    built_.tree.append_level({}, spheres);
    for (int level = 1; level <= how_.depth; ++level) {
      const std::size_t first = built_.tree.level_begin[level - 1], last = regions.size();
      std::vector<std::uint32_t> counts;
      spheres.clear();
      for (std::size_t node = first; node < last; ++node) {
        const auto children = divided(regions[node]);
        counts.push_back(static_cast<std::uint32_t>(children.size()));
        for (const auto& child : children) {
          spheres.push_back(sphere_of(child));
          regions.push_back(child);
        }
      }
      if (spheres.empty()) break;
      built_.tree.append_level(counts, spheres);
    }
    built_.cover.corner_begin.push_back(0);
    built_.cover.region_begin.resize(regions.size());
    built_.cover.region_end.resize(regions.size());
    line_up(regions, 0);
    return built_;
  }

 private:
  std::uint32_t add_cut_point(const CutPoint& point) {
    built_.cover.cut_points.push_back(point);
    return static_cast<std::uint32_t>(mesh_.vertex_count() + built_.cover.cut_points.size() - 1);
  }

  void cut(std::uint32_t f) {
    const auto [a, b, c] = mesh_.facets[f];
    const double kind = how_.cut_facets ? random_.uniform() : 0;
    if (kind < 0.4 || a == b || b == c || c == a) {
      patches_.push_back({f, {a, b, c}});
    } else if (kind < 0.7) {
      const double t = random_.uniform(0.05, 0.95);
      const std::uint32_t e = add_cut_point({{a, b, b}, {1 - t, t, 0}});
      patches_.push_back({f, {a, e, c}});
      patches_.push_back({f, {e, b, c}});
    } else {
      const double t = random_.uniform(0.1, 0.45), u = random_.uniform(0.1, 0.45);
      const std::uint32_t p = add_cut_point({{a, b, c}, {1 - t - u, t, u}});
      patches_.push_back({f, {a, b, p}});
      patches_.push_back({f, {b, c, p}});
      patches_.push_back({f, {c, a, p}});
    }
  }

  std::vector<Vec3> corner_points(const std::vector<std::uint32_t>& patches) const {
    std::vector<Vec3> points;
    for (const std::uint32_t p : patches)
      for (const std::uint32_t c : patches_[p].corners)
        points.push_back(corner_position(built_.cover, c, mesh_.positions));
    return points;
  }

  Sphere sphere_of(const std::vector<std::uint32_t>& patches) {
    const std::vector<Vec3> points = corner_points(patches);
    Box box;
    double largest = 0;
    for (const Vec3& p : points) box.add(p), largest = std::max(largest, max_norm(p));
    const double shift = how_.center_shift * box.diagonal();
    const Vec3 center = box.center() + Vec3{random_.uniform(-shift, shift), random_.uniform(-shift, shift),
                                            random_.uniform(-shift, shift)};
    return {center, rounded_up_radius(farthest_distance(center, points), largest + shift)};
  }

  // Halves the largest part until there are as many as the branching.
  std::vector<std::vector<std::uint32_t>> divided(const std::vector<std::uint32_t>& region) const {
    if (region.size() <= how_.smallest_leaf) return {};
    std::vector<std::vector<std::uint32_t>> parts{region};
    while (static_cast<int>(parts.size()) < how_.branching) {
      const auto largest = std::max_element(parts.begin(), parts.end(),
                                            [](const auto& a, const auto& b) { return a.size() < b.size(); });
      if (largest->size() < 2) break;
      Box box;
      std::vector<Vec3> middle(patches_.size());
      for (const std::uint32_t p : *largest) {
        const std::vector<Vec3> corners = corner_points({p});
        for (const Vec3& x : corners) middle[p] += x / static_cast<double>(corners.size());
        box.add(middle[p]);
      }
      const int axis = box.longest_axis();
      std::stable_sort(largest->begin(), largest->end(),
                       [&](std::uint32_t a, std::uint32_t b) { return middle[a][axis] < middle[b][axis]; });
      const auto half = largest->begin() + static_cast<std::ptrdiff_t>(largest->size() / 2);
      std::vector<std::uint32_t> upper(half, largest->end());
      largest->erase(half, largest->end());
      parts.push_back(std::move(upper));
    }
    return parts;
  }

  void line_up(const std::vector<std::vector<std::uint32_t>>& regions, std::uint32_t node) {
    Cover& cover = built_.cover;
    cover.region_begin[node] = static_cast<std::uint32_t>(cover.patch_count());
    if (built_.tree.is_leaf(node))
      for (const std::uint32_t p : regions[node]) {
        cover.patch_facet.push_back(patches_[p].facet);
        cover.corners.insert(cover.corners.end(), patches_[p].corners.begin(), patches_[p].corners.end());
        cover.corner_begin.push_back(static_cast<std::uint32_t>(cover.corners.size()));
      }
    for (std::uint32_t c = 0; c < built_.tree.child_count[node]; ++c)
      line_up(regions, built_.tree.first_child[node] + c);
    cover.region_end[node] = static_cast<std::uint32_t>(cover.patch_count());
  }

  const Mesh& mesh_;
  HandMade how_;
  Random random_;
  CoveredTree built_;
  std::vector<Patch> patches_;
};

Mesh bumpy_ball() {
  Mesh mesh = icosphere(3, 1.0, {0.3, -0.2, 0.1});
  for (Vec3& p : mesh.positions) p = p * (1 + 0.3 * std::sin(5 * p.x) * std::cos(4 * p.y + p.z));
  return mesh;
}

// A soup, half of its vertices without a facet and not a number, and a few facets without area among the good ones.
Mesh rough_soup() {
  Mesh soup = facet_soup(60, 7);
  Mesh mesh;
  using test::nan;
  for (const Vec3& p : soup.positions) {
    mesh.positions.push_back({nan, nan, nan});
    mesh.positions.push_back(p);
  }
  for (const Facet& f : soup.facets) mesh.facets.push_back({2 * f[0] + 1, 2 * f[1] + 1, 2 * f[2] + 1});
  mesh.facets.push_back({1, 1, 3});
  mesh.facets.push_back({5, 5, 5});
  mesh.facets.push_back({9, 11, 9});
  return mesh;
}

Mesh single_facet() {
  return {{{0, 0, 0}, {1, 0, 0}, {0.2, 0.9, 0.3}}, {{0, 1, 2}}};
}

std::vector<Vec3> mapped(std::vector<Vec3> positions, const std::function<Vec3(const Vec3&)>& f) {
  for (Vec3& p : positions) p = f(p);
  return positions;
}

}  // namespace

CoveredTree hand_made_tree(const Mesh& mesh, const HandMade& how) {
  return TreeMaker(mesh, how).make();
}

CoveredTree root_with_leaves(const Mesh& mesh, const Sphere& root, std::span<const Sphere> leaves) {
  CoveredTree model;
  model.tree.branching = static_cast<std::uint32_t>(std::max<std::size_t>(2, leaves.size()));
  model.tree.append_level({}, std::span(&root, 1));
  const std::uint32_t counts[]{static_cast<std::uint32_t>(leaves.size())};
  model.tree.append_level(counts, leaves);
  Cover& cover = model.cover;
  cover.vertex_count = static_cast<std::uint32_t>(mesh.vertex_count());
  cover.facet_count = static_cast<std::uint32_t>(mesh.facet_count());
  // More leaves than facets: a facet is named again as often as it takes. Only rules that do not read the cover are
  // tested with such a tree.
  const std::size_t patches = std::max(leaves.size(), mesh.facet_count());
  cover.corner_begin.push_back(0);
  cover.region_begin.resize(1 + leaves.size());
  cover.region_end.resize(1 + leaves.size());
  cover.region_end[0] = static_cast<std::uint32_t>(patches);
  for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf) {
    cover.region_begin[1 + leaf] = static_cast<std::uint32_t>(cover.patch_count());
    for (std::size_t p = leaf; p < patches; p += leaves.size()) {
      const auto f = static_cast<std::uint32_t>(p % mesh.facet_count());
      cover.patch_facet.push_back(f);
      cover.corners.insert(cover.corners.end(), mesh.facets[f].begin(), mesh.facets[f].end());
      cover.corner_begin.push_back(static_cast<std::uint32_t>(cover.corners.size()));
    }
    cover.region_end[1 + leaf] = static_cast<std::uint32_t>(cover.patch_count());
  }
  return model;
}

const std::vector<Specimen>& specimens() {
  static const std::vector<Specimen> bodies = [] {
    std::vector<Specimen> made;
    const auto add = [&](const char* name, Mesh mesh, const HandMade& how) {
      CoveredTree model = hand_made_tree(mesh, how);
      made.push_back({name, std::move(mesh), std::move(model)});
    };
    add("ball", icosphere(3), {.depth = 2});
    add("plate", grid_plate(16, 2.0, 1.0), {.depth = 2, .center_shift = 0.0});
    add("bumpy", bumpy_ball(), {.depth = 3, .cut_facets = true});
    add("coarse box", box_mesh({-1, -1, -1}, {1, 2, 3}), {.depth = 2, .branching = 4, .cut_facets = true});
    add("soup", rough_soup(), {.depth = 4, .branching = 3, .smallest_leaf = 5, .cut_facets = true});
    add("facet", single_facet(), {.depth = 2});
    return made;
  }();
  return bodies;
}

std::vector<Sphere> spheres_of(const Body& body) {
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  return spheres;
}

const std::vector<Motion>& motions() {
  static const std::vector<Motion> motions = [] {
    using Positions = std::vector<Vec3>;
    std::vector<Motion> made;
    const auto add_map = [&](const char* name, Vec3 (*f)(const Vec3&)) {
      made.push_back({name, [f](const Positions& p) { return mapped(p, f); }});
    };
    made.push_back({"translation", [](const Positions& p) { return translated(p, {3, -50, 700}); }});
    made.push_back({"rotation 37", [](const Positions& p) { return rotated(p, {1, 2, 3}, 37); }});
    made.push_back({"rotation 180", [](const Positions& p) { return rotated(p, {0, 1, 1}, 180); }});
    add_map("stretch", [](const Vec3& p) { return Vec3{2 * p.x, p.y / std::sqrt(2.0), p.z / std::sqrt(2.0)}; });
    add_map("shear", [](const Vec3& p) { return Vec3{p.x + 0.8 * p.y - 0.3 * p.z, p.y, p.z + 0.5 * p.x}; });
    add_map("twist", [](const Vec3& p) {
      const double s = std::sin(1.5 * p.x), c = std::cos(1.5 * p.x);
      return Vec3{p.x, c * p.y - s * p.z, s * p.y + c * p.z};
    });
    add_map("bend", [](const Vec3& p) {
      const double radius = 2.5, angle = p.x / radius;
      return Vec3{(radius - p.y) * std::sin(angle), radius - (radius - p.y) * std::cos(angle), p.z};
    });
    add_map("collapse", [](const Vec3& p) { return Vec3{p.x, 0.0, p.z}; });
    made.push_back({"noise", [](const Positions& p) { return noisy(p, 0.3, 5); }});
    return made;
  }();
  return motions;
}

Modes smooth_modes(const Mesh& mesh, std::size_t mode_count) {
  Modes modes{mesh.vertex_count(), mode_count, {}};
  for (std::size_t j = 0; j < mode_count; ++j)
    for (const Vec3& p : mesh.positions) {
      const Vec3 x = is_finite(p) ? p : Vec3{};
      const double wave = 1 + 0.4 * static_cast<double>(j);
      Vec3 u;
      u[static_cast<int>(j % 3)] = std::sin(wave * x[static_cast<int>((j + 1) % 3)] + static_cast<double>(j));
      u[static_cast<int>((j + 2) % 3)] = 0.5 * std::cos(wave * x[static_cast<int>(j % 3)]);
      modes.displacements.push_back(u);
    }
  return modes;
}

Modes rough_modes(const Mesh& mesh, std::size_t mode_count) {
  const std::vector<Vec3> zeros(mesh.vertex_count() * mode_count);
  return {mesh.vertex_count(), mode_count, noisy(zeros, 1.0, 17)};
}

Modes linear_modes(const Mesh& mesh) {
  Modes modes{mesh.vertex_count(), 9, {}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      for (const Vec3& p : mesh.positions) {
        Vec3 u;
        if (is_finite(p)) u[row] = p[column];
        modes.displacements.push_back(u);
      }
  return modes;
}

std::vector<Vec3> translated(std::vector<Vec3> positions, const Vec3& offset) {
  return mapped(std::move(positions), [&](const Vec3& p) { return p + offset; });
}

std::vector<Vec3> scaled(std::vector<Vec3> positions, double factor) {
  return mapped(std::move(positions), [&](const Vec3& p) { return p * factor; });
}

std::vector<Vec3> rotated(std::vector<Vec3> positions, const Vec3& axis, double degrees) {
  const Vec3 a = normalized(axis);
  const double angle = degrees * std::numbers::pi / 180, s = std::sin(angle), c = std::cos(angle);
  return mapped(std::move(positions),
                [&](const Vec3& p) { return p * c + cross(a, p) * s + a * (dot(a, p) * (1 - c)); });
}

std::vector<Vec3> noisy(std::vector<Vec3> positions, double amplitude, std::uint64_t seed) {
  Random random(seed);
  return mapped(std::move(positions), [&](const Vec3& p) {
    const double dx = random.uniform(-amplitude, amplitude), dy = random.uniform(-amplitude, amplitude);
    return p + Vec3{dx, dy, random.uniform(-amplitude, amplitude)};
  });
}

}  // namespace morula::test
