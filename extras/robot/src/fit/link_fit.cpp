// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/link_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <morula/geometry/box.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/tree/cover.hpp>
#include <stdexcept>
#include <utility>

#include "fit/clip.hpp"
#include "fit/inner.hpp"
#include "fit/margin.hpp"
#include "fit/measure.hpp"
#include "fit/rounding.hpp"
#include "fit/within.hpp"
#include "platform/path_text.hpp"

namespace morula::robot {

namespace {

constexpr std::size_t most_spheres_for_radius = 256;

std::vector<Sphere> leaves(const CoveredTree& model) {
  return level_set_spheres(model.tree, model.tree.level_count() - 1);
}

double largest_radius(const CoveredTree& model) {
  double radius = 0;
  for (const Sphere& s : leaves(model)) radius = std::max(radius, s.radius);
  return radius;
}

/// Removes spheres that are equal to an earlier one.
void remove_repeated(std::vector<Sphere>& spheres) {
  std::vector<Sphere> kept;
  for (const Sphere& s : spheres)
    if (std::find(kept.begin(), kept.end(), s) == kept.end()) kept.push_back(s);
  spheres = std::move(kept);
}

}  // namespace

const std::vector<Shape>& LinkFitter::shapes_of(const LinkSpheres& link) const {
  const Link& of_robot = robot_.links[link.link];
  return o_.visual ? of_robot.visual : of_robot.collision;
}

const std::vector<ClipPlane>& LinkFitter::planes_of(const LinkSpheres& link) const {
  static const std::vector<ClipPlane> none_of_them;
  const auto found = o_.clip.find(name_of(link));
  return found == o_.clip.end() ? none_of_them : found->second;
}

void LinkFitter::read_surface(LinkSpheres& link) const {
  LinkSurface& surface = link.surface;
  surface = surface_of(robot_.file, shapes_of(link));
  const std::vector<ClipPlane>& planes = planes_of(link);
  if (planes.empty()) return;
  std::vector<std::string> notes = std::move(surface.notes);
  surface = clipped(surface, planes, o_.clip_margin.value_or(0));
  surface.notes = std::move(notes);
  if (o_.clip_margin && o_.fixed_spheres.count(name_of(link)) == 0)
    require_margin(name_of(link), surface.mesh, planes, o_);
}

Demand LinkFitter::demand(const LinkSpheres& link) const {
  Demand demand;
  demand.fixed = link.surface.spheres.size();
  demand.has_mesh = !link.surface.mesh.facets.empty();
  if (!demand.has_mesh) return demand;
  BuildOptions options{.method = o_.method, .seed = o_.seed, .quality = quality(Quality::draft), .stop = o_.stop};
  std::array<double, 4> volumes{};
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    if (Demand::counts[k] == 1) {
      volumes[k] = volume(enclosing_sphere(link.surface.mesh.positions));
      continue;
    }
    options.spheres = Demand::counts[k];
    volumes[k] = union_mass(leaves(build_link(link, options)), 64).volume;
  }
  // A surface that is open has no volume of its own: the rest of many spheres replaces it.
  const MeshReport report = inspect(link.surface.mesh);
  const double object = report.has_volume() ? std::abs(report.volume) : 0;
  const double inside = object > 0 && object < volumes.back() ? object : 0.8 * volumes.back();
  for (std::size_t k = 0; k < volumes.size(); ++k) demand.outside[k] = std::max(0.0, volumes[k] - inside);
  return demand;
}

/// The quality for a build; the methods other than optimized have only one.
Quality LinkFitter::quality(Quality of_optimized) const {
  return o_.method == Method::optimized ? of_optimized : Quality::standard;
}

/// Everything but the number of spheres.
BuildOptions LinkFitter::build_options(const LinkSpheres& link) const {
  BuildOptions options{
      .method = o_.method, .seed = o_.seed, .quality = quality(o_.quality.value_or(Quality::fast)), .stop = o_.stop};
  options.tolerance = o_.tolerance;
  options.max_protrusion = o_.max_protrusion;
  if (o_.max_protrusion_share) {
    Box box;
    for (const Vec3& p : link.surface.mesh.positions) box.add(p);
    const double own = *o_.max_protrusion_share * box.diagonal();
    options.max_protrusion = std::min(options.max_protrusion.value_or(own), own);
  }
  return options;
}

CoveredTree LinkFitter::build_link(const LinkSpheres& link, const BuildOptions& options) const {
  // The mesh is the file's fault; other arguments are the caller's.
  try {
    require_usable(link.surface.mesh);
    require_usable_scale(link.surface.mesh);
  } catch (const std::invalid_argument& error) {
    throw FileError(fmt::format("{}:{}: link {}: {}", platform::text_of(robot_.file), robot_.links[link.link].line,
                                name_of(link), error.what()));
  }
  return build(link.surface.mesh, options, serial_workers());
}

void LinkFitter::fit(LinkSpheres& link, std::size_t budget) const {
  if (const auto kept = o_.fixed_spheres.find(name_of(link)); kept != o_.fixed_spheres.end()) {
    link.spheres = kept->second;
  } else {
    fit_new(link, budget);
  }
  measure_link(link, planes_of(link), o_.tolerance);
  if (o_.clip_margin && link.figures.beyond_clip.value_or(0) > 0) {
    link.notes.push_back(
        fmt::format("link {}: spheres reach beyond its clip planes; give a larger margin, or less padding or smaller "
                    "radii",
                    name_of(link)));
  }
  if (o_.inner > 0) fit_inner(link);
}

void LinkFitter::fit_new(LinkSpheres& link, std::size_t budget) const {
  link.spheres = link.surface.spheres;
  if (!link.surface.mesh.facets.empty()) fit_mesh(link, budget);
  if (o_.tolerance > 0 && planes_of(link).empty())
    grow_inside(link.surface.mesh, link.spheres, o_.max_radius ? *o_.max_radius - o_.padding : 1e30);
  for (Sphere& s : link.spheres) s.radius = padded_radius(s.radius, o_);
  round_outward(link.spheres);
  remove_repeated(link.spheres);
}

/// Adds the spheres for the mesh to those among the shapes.
void LinkFitter::fit_mesh(LinkSpheres& link, std::size_t budget) const {
  BuildOptions options = build_options(link);
  const std::size_t beside = link.surface.spheres.size();
  if (budget != 0) options.spheres = budget > beside ? budget - beside : 1;
  if (budget != 0 && budget <= beside) {
    link.notes.push_back(
        fmt::format("link {} has {} spheres of its own and gets one more for the rest", name_of(link), beside));
  }
  auto model = std::make_shared<CoveredTree>(build_link(link, options));
  enforce_max_radius(link, options, *model);
  if (o_.clip_margin && !planes_of(link).empty()) enforce_margin(link, *model);
  if (!model->report.complete) {
    link.notes.push_back(
        fmt::format("link {}: the spheres exceed the largest protrusion; allow more of them", name_of(link)));
  }
  for (const Sphere& leaf : leaves(*model)) link.spheres.push_back(reduced(leaf, o_.tolerance));
  link.tree = std::move(model);
}

void LinkFitter::enforce_max_radius(LinkSpheres& link, BuildOptions options, CoveredTree& model) const {
  if (!o_.max_radius) return;
  const auto fits = [&](const CoveredTree& tree) {
    return largest_radius(tree) - o_.tolerance + o_.padding <= *o_.max_radius;
  };
  std::size_t spheres = options.spheres.value_or(model.tree.leaf_count());
  while (!fits(model) && spheres < most_spheres_for_radius) {
    options.spheres = spheres *= 2;
    model = build_link(link, options);
  }
  // A thick link is covered best by spheres that fill it, for any number of them. The spheres of an octree are as
  // small as its cells.
  for (int depth = 1; !fits(model) && depth <= max_depth; ++depth) {
    model = build_link(link, {.method = Method::octree, .depth = depth, .seed = o_.seed, .stop = o_.stop});
  }
  if (!fits(model)) {
    link.notes.push_back(fmt::format("link {}: spheres exceed the largest radius; allow larger ones", name_of(link)));
  }
}

void LinkFitter::enforce_margin(LinkSpheres& link, CoveredTree& model) const {
  const std::size_t before = model.tree.leaf_count();
  keep_from_planes(link.surface.mesh, planes_of(link), o_, model);
  const std::vector<Sphere> divided = leaves(model);
  if (divided.size() == before || !stays_from_planes(link.surface.mesh, divided, planes_of(link), o_)) return;
  link.notes.push_back(fmt::format("link {} has {} spheres instead of {}, so that none reaches beyond its clip planes",
                                   name_of(link), divided.size(), before));
}

void LinkFitter::fit_inner(LinkSpheres& link) const {
  link.inner = inner_spheres(robot_.file, shapes_of(link), planes_of(link), o_.inner, o_.seed, o_.stop);
  if (o_.stop.stop_requested()) throw BuildStopped();
  link.inner_volume = union_mass(link.inner).volume;
  if (link.inner.empty())
    link.notes.push_back(fmt::format("link {} has no inner spheres: no surface of it is closed", name_of(link)));
}

}  // namespace morula::robot
