// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/tree/cover.hpp>
#include <utility>

#include "parallel/float_environment.hpp"
#include "tree/region.hpp"

namespace morula {
using namespace detail;
namespace {

// The first broken promise of the patches, as text; empty when all hold. Each check reads only entries that earlier
// checks have shown to exist.
std::string fault_of_patches(const Cover& c) {
  // mutant validate-corner-front: `| c.corner_begin.front() != 0 ||` -> `|`
  if (c.corner_begin.size() != c.patch_count() + 1 || c.corner_begin.front() != 0 ||
      // mutant validate-corner-end: `c.corner_begin.back() != c.corners.size()` -> `false`
      c.corner_begin.back() != c.corners.size())
    return "corner_begin does not span the corners of all patches";
  for (std::size_t p = 0; p < c.patch_count(); ++p) {
    // The sum begin + 3 would wrap around at the end of 32 bits.
    // mutant validate-three-corners: `|| c.corner_begin[p + 1] - c.corner_begin[p] < 3` -> ``
    // mutant validate-corner-order: `< c.corner_begin[p] || c.corner_begin[p + 1] -` -> `-`
    if (c.corner_begin[p + 1] < c.corner_begin[p] || c.corner_begin[p + 1] - c.corner_begin[p] < 3)
      return "patch " + std::to_string(p) + " has fewer than 3 corners";
    // mutant validate-patch-facet: `c.patch_facet[p] >= c.facet_count` -> `false`
    if (c.patch_facet[p] >= c.facet_count)
      return "patch " + std::to_string(p) + " lies on facet " + std::to_string(c.patch_facet[p]) + " of " +
             std::to_string(c.facet_count);
  }
  const std::uint64_t points = std::uint64_t{c.vertex_count} + c.cut_points.size();
  for (const std::uint32_t corner : c.corners)
    // mutant validate-corner-index: `corner >= points` -> `false`
    if (corner >= points)
      return "a patch has corner " + std::to_string(corner) + " of " + std::to_string(points) +
             ", neither a vertex nor a cut point";
  return {};
}

std::string fault_of_cut_points(const Cover& c) {
  for (std::size_t i = 0; i < c.cut_points.size(); ++i) {
    const CutPoint& point = c.cut_points[i];
    const auto cut_point = [i] { return "cut point " + std::to_string(i); };
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      // mutant validate-cut-vertex: `point.vertex[k] >= c.vertex_count` -> `false`
      if (point.vertex[k] >= c.vertex_count)
        return cut_point() + " refers to vertex " + std::to_string(point.vertex[k]) + " of " +
               std::to_string(c.vertex_count);
      // mutant validate-weight-range: `>= 0 && point.weight[k] <` -> `<`
      if (!(point.weight[k] >= 0 && point.weight[k] <= 1)) return cut_point() + " has a weight that is not in 0…1";
      sum += point.weight[k];
    }
    // mutant validate-weights: `12` -> `8`
    if (!(std::abs(sum - 1) < 1e-12)) return cut_point() + " has weights that do not add up to 1";
  }
  return {};
}

void check_regions(const SphereTree& tree, const Cover& cover, std::vector<std::string>& faults) {
  // mutant validate-root: `cover.region_begin[0] != 0 || cover.region_end[0] != cover.patch_count()` -> `false`
  if (cover.region_begin[0] != 0 || cover.region_end[0] != cover.patch_count())
    faults.emplace_back("the root does not own the whole surface");
  for (std::uint32_t i = 0; i < tree.node_count(); ++i) {
    // mutant validate-owns-patches: `cover.region_begin[i] >= cover.region_end[i]` -> `false`
    if (cover.region_begin[i] >= cover.region_end[i])
      faults.push_back("node " + std::to_string(i) + " owns no patches");
    // mutant validate-regions-end: `cover.region_end[i] > cover.patch_count()` -> `false`
    if (cover.region_end[i] > cover.patch_count())
      faults.push_back("the region of node " + std::to_string(i) + " goes beyond the last patch");
    std::uint32_t next = cover.region_begin[i];
    for (std::uint32_t c = 0; c < tree.child_count[i]; ++c) {
      const std::uint32_t child = tree.first_child[i] + c;
      // mutant validate-children-follow: `cover.region_begin[child] != next` -> `false`
      if (cover.region_begin[child] != next)
        faults.push_back("the regions of node " + std::to_string(i) + "'s children do not follow one another");
      next = cover.region_end[child];
    }
    // mutant validate-union: `!tree.is_leaf(i) && next != cover.region_end[i]` -> `false`
    if (!tree.is_leaf(i) && next != cover.region_end[i])
      faults.push_back("the region of node " + std::to_string(i) + " is not the union of its children's");
  }
}

// Twice the signed area in barycentric coordinates, as a share of the facet.
double barycentric_area(const Barycentric& a, const Barycentric& b, const Barycentric& c) {
  return (b[1] - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (b[2] - a[2]);
}

// mutant validate-areas: `12` -> `4`
constexpr double area_rounding = 1e-12;

// Checks for convex, counter-clockwise polygons inside the facet whose areas add up to the whole: they tile it.
void check_tiling(const MeshView& mesh, const Cover& cover, std::vector<std::string>& faults) {
  std::vector<double> share(mesh.facet_count());
  std::vector<std::uint32_t> patches(mesh.facet_count());
  std::vector<Barycentric> polygon;
  for (std::size_t p = 0; p < cover.patch_count(); ++p) {
    const std::uint32_t f = cover.patch_facet[p];
    const Facet& facet = mesh.facets[f];
    ++patches[f];
    if (facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0]) {
      // A segment or a point has to be one patch, uncut.
      // mutant validate-flat-facet: `std::equal ... ? 1 : 0` -> `1`
      share[f] = std::equal(facet.begin(), facet.end(), cover.patch(p).begin(), cover.patch(p).end()) ? 1 : 0;
      continue;
    }
    polygon.clear();
    for (const std::uint32_t corner : cover.patch(p)) {
      const std::optional<Barycentric> b = barycentric_on(cover, facet, corner);
      // mutant validate-corner-off-facet: `(!b) {` -> `(!b) continue; else if (false) {`
      if (!b) {
        faults.push_back("patch " + std::to_string(p) + " has a corner off its facet " + std::to_string(f));
        return;
      }
      polygon.push_back(*b);
    }
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const double turn =
          barycentric_area(polygon[k], polygon[(k + 1) % polygon.size()], polygon[(k + 2) % polygon.size()]);
      // mutant validate-convex: `turn < -area_rounding` -> `false`
      if (turn < -area_rounding) faults.push_back("patch " + std::to_string(p) + " is not convex");
      if (k >= 2) share[f] += barycentric_area(polygon[0], polygon[k - 1], polygon[k]);
    }
  }
  for (std::size_t f = 0; f < share.size(); ++f) {
    const double rounding = area_rounding * (1.0 + patches[f]);
    // mutant validate-whole: `!(std::abs(share[f] - 1) <= rounding)` -> `false`
    // mutant validate-gaps-only: `std::abs(share[f] - 1)` -> `1 - share[f]`
    if (!(std::abs(share[f] - 1) <= rounding))
      faults.push_back("the patches of facet " + std::to_string(f) + " add up to " + std::to_string(share[f]) +
                       " of it instead of the whole");
  }
}

}  // namespace

std::vector<std::string> validate(const SphereTree& tree, const Cover& cover) {
  for (std::string fault : {fault_of_patches(cover), fault_of_cut_points(cover)})
    if (!fault.empty()) return {std::move(fault)};
  // mutant validate-region-count: `cover.region_begin ... || cover` -> `cover`
  if (cover.region_begin.size() != tree.node_count() || cover.region_end.size() != tree.node_count())
    return {"the cover is for another number of nodes"};
  std::vector<std::string> faults;
  check_regions(tree, cover, faults);
  return faults;
}

static std::vector<std::string> faults_at_rest(const MeshView& mesh, const CoveredTree& model) {
  std::vector<std::string> faults = validate(model.tree);
  if (!faults.empty()) return faults;
  // mutant validate-vertex-count: `model.cover.vertex_count != mesh.vertex_count()` -> `false`
  if (model.cover.vertex_count != mesh.vertex_count()) return {"the cover is for another number of vertices"};
  // mutant validate-facet-count: `model.cover.facet_count != mesh.facet_count()` -> `false`
  if (model.cover.facet_count != mesh.facet_count()) return {"the cover is for another number of facets"};
  faults = validate(model.tree, model.cover);
  if (!faults.empty()) return faults;
  check_tiling(mesh, model.cover, faults);
  if (!faults.empty()) return faults;
  const Certificate certificate = certify(model.cover, mesh.positions, model.tree.spheres);
  // mutant validate-wraps: `!certificate.covered` -> `false`
  if (!certificate.covered)
    faults.push_back("node " + std::to_string(certificate.worst_node) + " does not wrap its region: a corner is " +
                     std::to_string(certificate.worst_excess) + " outside its sphere");
  return faults;
}

// The first fault of a known pose, as text; empty if there is none.
static std::string fault_of_pose(const MeshView& mesh, const KnownPose& pose) {
  if (!pose.model) return "it has no tree";
  if (!pose.model->poses.empty()) return "its tree carries poses of its own";
  if (pose.positions.size() != mesh.vertex_count())
    return "it has " + std::to_string(pose.positions.size()) + " positions for " + std::to_string(mesh.vertex_count()) +
           " vertices";
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f)
      if (!is_finite(pose.positions[v])) return "vertex " + std::to_string(v) + " is not finite";
  const std::vector<std::string> faults = faults_at_rest({pose.positions, mesh.facets}, *pose.model);
  return faults.empty() ? std::string() : faults.front();
}

std::vector<std::string> validate(const MeshView& mesh, const CoveredTree& model) {
  const StandardFloats standard;
  std::vector<std::string> faults = faults_at_rest(mesh, model);
  for (const KnownPose& pose : model.poses)
    if (const std::string fault = fault_of_pose(mesh, pose); !fault.empty())
      faults.push_back("known pose \"" + pose.name + "\": " + fault);
  return faults;
}

}  // namespace morula
