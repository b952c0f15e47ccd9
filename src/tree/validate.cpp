// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/tree/cover.hpp>

#include "parallel/float_environment.hpp"

namespace morula {
namespace {

bool sizes_agree(const Mesh& mesh, const Built& built, std::vector<std::string>& faults) {
  const Cover& c = built.cover;
  const auto expect = [&](bool holds, const char* what) {
    if (!holds) faults.emplace_back(what);
    return holds;
  };
  bool ok = expect(c.vertex_count == mesh.vertex_count(), "the cover is for another number of vertices") &&
            expect(c.facet_count == mesh.facet_count(), "the cover is for another number of facets") &&
            expect(c.corner_begin.size() == c.patch_count() + 1 && c.corner_begin.front() == 0 &&
                       c.corner_begin.back() == c.corners.size(),
                   "corner_begin does not span the corners") &&
            expect(c.region_begin.size() == built.tree.node_count() && c.region_end.size() == built.tree.node_count(),
                   "the cover is for another number of nodes");
  if (!ok) return false;
  for (std::size_t p = 0; p < c.patch_count(); ++p)
    ok = ok && expect(c.corner_begin[p] + 3 <= c.corner_begin[p + 1], "a patch has fewer than three corners") &&
         expect(c.patch_facet[p] < mesh.facet_count(), "a patch lies on a facet that the mesh does not have");
  for (const std::uint32_t corner : c.corners)
    ok = ok && expect(corner < c.vertex_count + c.cut_points.size(), "a corner is neither a vertex nor a cut point");
  for (const CutPoint& point : c.cut_points) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      ok = ok && expect(point.vertex[k] < c.vertex_count, "a cut point lies on a vertex that the mesh does not have") &&
           expect(point.weight[k] >= 0 && point.weight[k] <= 1, "a cut point has a weight outside 0…1");
      sum += point.weight[k];
    }
    ok = ok && expect(std::abs(sum - 1) < 1e-12, "the weights of a cut point do not add up to 1");
  }
  return ok;
}

// Barycentric coordinates of a corner on a facet; false when it lies elsewhere.
bool on_facet(const Cover& cover, const Facet& facet, std::uint32_t corner, Barycentric& b) {
  b = {0, 0, 0};
  const auto add = [&](std::uint32_t vertex, double weight) {
    if (weight == 0) return true;
    for (int k = 0; k < 3; ++k)
      if (facet[k] == vertex) {
        b[k] += weight;
        return true;
      }
    return false;
  };
  if (corner < cover.vertex_count) return add(corner, 1);
  const CutPoint& point = cover.cut_points[corner - cover.vertex_count];
  return add(point.vertex[0], point.weight[0]) && add(point.vertex[1], point.weight[1]) &&
         add(point.vertex[2], point.weight[2]);
}

// Twice the signed area in barycentric coordinates, as a share of the facet.
double barycentric_area(const Barycentric& a, const Barycentric& b, const Barycentric& c) {
  return (b[1] - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (b[2] - a[2]);
}

constexpr double area_rounding = 1e-12;

// Convex, counter-clockwise polygons inside the facet whose areas add up to the whole: they tile it.
void check_tiling(const Mesh& mesh, const Cover& cover, std::vector<std::string>& faults) {
  std::vector<double> share(mesh.facet_count());
  std::vector<std::uint32_t> patches(mesh.facet_count());
  std::vector<Barycentric> polygon;
  for (std::size_t p = 0; p < cover.patch_count(); ++p) {
    const std::uint32_t f = cover.patch_facet[p];
    const Facet& facet = mesh.facets[f];
    ++patches[f];
    if (facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0]) {
      // A segment or a point: it must be one patch, uncut.
      share[f] = std::equal(facet.begin(), facet.end(), cover.patch(p).begin(), cover.patch(p).end()) ? 1 : 0;
      continue;
    }
    polygon.clear();
    for (const std::uint32_t corner : cover.patch(p)) {
      Barycentric b;
      if (!on_facet(cover, facet, corner, b)) {
        faults.push_back("patch " + std::to_string(p) + " has a corner off its facet " + std::to_string(f));
        return;
      }
      polygon.push_back(b);
    }
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const double turn =
          barycentric_area(polygon[k], polygon[(k + 1) % polygon.size()], polygon[(k + 2) % polygon.size()]);
      if (turn < -area_rounding) faults.push_back("patch " + std::to_string(p) + " is not convex");
      if (k >= 2) share[f] += barycentric_area(polygon[0], polygon[k - 1], polygon[k]);
    }
  }
  for (std::size_t f = 0; f < share.size(); ++f) {
    const double rounding = area_rounding * (1.0 + patches[f]);
    if (!(std::abs(share[f] - 1) <= rounding))
      faults.push_back("the patches of facet " + std::to_string(f) + " add up to " + std::to_string(share[f]) +
                       " of it instead of the whole");
  }
}

void check_regions(const Built& built, std::vector<std::string>& faults) {
  const SphereTree& tree = built.tree;
  const Cover& cover = built.cover;
  for (std::uint32_t i = 0; i < tree.node_count(); ++i) {
    if (cover.region_begin[i] >= cover.region_end[i] || cover.region_end[i] > cover.patch_count())
      faults.push_back("node " + std::to_string(i) + " owns no patches");
    std::uint32_t next = cover.region_begin[i];
    for (std::uint32_t c = 0; c < tree.child_count[i]; ++c) {
      const std::uint32_t child = tree.first_child[i] + c;
      if (cover.region_begin[child] != next)
        faults.push_back("the regions of node " + std::to_string(i) + "'s children do not follow one another");
      next = cover.region_end[child];
    }
    if (!tree.is_leaf(i) && next != cover.region_end[i])
      faults.push_back("the region of node " + std::to_string(i) + " is not the union of its children's");
  }
  if (cover.region_begin[0] != 0 || cover.region_end[0] != cover.patch_count())
    faults.emplace_back("the root does not own the whole surface");
}

}  // namespace

std::vector<std::string> validate(const Mesh& mesh, const Built& built) {
  const StandardFloats standard;
  std::vector<std::string> faults = validate(built.tree);
  if (!faults.empty() || !sizes_agree(mesh, built, faults)) return faults;
  check_tiling(mesh, built.cover, faults);
  check_regions(built, faults);
  if (!faults.empty()) return faults;
  const Certificate certificate = certify(built.cover, mesh.positions, built.tree.spheres);
  if (!certificate.covered)
    faults.push_back("node " + std::to_string(certificate.worst_node) + " does not wrap its region: a corner is " +
                     std::to_string(certificate.worst_excess) + " outside its sphere");
  return faults;
}

}  // namespace morula
