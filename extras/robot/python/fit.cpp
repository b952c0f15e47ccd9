// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres for the links of a robot.
#include <map>
#include <morula/morula.hpp>
#include <morula/robot/fit.hpp>
#include <set>
#include <string>
#include <vector>

#include "building.hpp"
#include "holders.hpp"
#include "records.hpp"
#include "robots.hpp"

namespace morula::python {

namespace {

std::map<std::string, std::vector<robot::ClipPlane>> clip_of(nb::handle given) {
  std::map<std::string, std::vector<robot::ClipPlane>> clip;
  if (given.is_none()) return clip;
  for (const auto& item : value_of<nb::dict>(given, "clip", "a dict of planes by link")) {
    const auto link = value_of<std::string>(item.first, "clip", "a dict of planes by link");
    const std::string argument = "clip['" + link + "']";
    std::vector<std::size_t> shape;
    const std::vector<double> rows = numbers_of(item.second, argument.c_str(), {-1, 4}, shape);
    for (std::size_t i = 0; i < rows.size(); i += 4)
      clip[link].push_back({{rows[i], rows[i + 1], rows[i + 2]}, rows[i + 3]});
  }
  return clip;
}

}  // namespace

void bind_robot_fit(nb::module_& m) {
  using robot::LinkFigures;
  using robot::LinkSpheres;
  using robot::RobotSpheres;
  Record<LinkFigures>(m, "LinkFigures", "Figures of the spheres of a link.")
      .field("facets", &LinkFigures::facets)
      .field("covered", &LinkFigures::covered, doc::LinkFigures_covered)
      .field("within", &LinkFigures::within, doc::LinkFigures_within)
      .field("uncovered_distance", &LinkFigures::uncovered_distance, doc::LinkFigures_uncovered_distance)
      .field("uncovered_share", &LinkFigures::uncovered_share, doc::LinkFigures_uncovered_share)
      .field("protrusion_mean", &LinkFigures::protrusion_mean, doc::LinkFigures_protrusion_mean)
      .field("protrusion_p95", &LinkFigures::protrusion_p95, doc::LinkFigures_protrusion_mean)
      .field("protrusion_max", &LinkFigures::protrusion_max, doc::LinkFigures_protrusion_mean)
      .field("object_volume", &LinkFigures::object_volume, doc::LinkFigures_object_volume)
      .field("outside_volume", &LinkFigures::outside_volume, doc::LinkFigures_outside_volume)
      .field("solid", &LinkFigures::solid, doc::UnionMass)
      .field("mass", &LinkFigures::mass, doc::LinkFigures_mass)
      .field("beyond_clip", &LinkFigures::beyond_clip, doc::LinkFigures_beyond_clip);
  Record<LinkSpheres>(m, "LinkSpheres", "The spheres of a link.")
      .property(
          "link", [](const LinkSpheres& l) { return index_or_none(l.link); }, "An index of Robot.links.")
      .property(
          "spheres", [](nb::handle self) { return sphere_rows(nb::cast<LinkSpheres&>(self).spheres, self); },
          (std::string("(n, 4) float64, read-only; no copy. ") + doc::LinkSpheres_spheres).c_str())
      .property(
          "same_shape_as", [](const LinkSpheres& l) { return index_or_none(l.same_shape_as); },
          doc::LinkSpheres_same_shape_as)
      .field("surface", &LinkSpheres::surface)
      .property(
          "tree", [](const LinkSpheres& l) { return std::const_pointer_cast<CoveredTree>(l.tree); },
          doc::LinkSpheres_tree)
      .field("figures", &LinkSpheres::figures)
      .property(
          "inner", [](nb::handle self) { return sphere_rows(nb::cast<LinkSpheres&>(self).inner, self); },
          doc::LinkSpheres_inner)
      .field("inner_volume", &LinkSpheres::inner_volume, doc::LinkSpheres_inner_volume)
      .field("notes", &LinkSpheres::notes)
      .shown({"link", "spheres", "inner", "notes"});
  Record<RobotSpheres>(m, "RobotSpheres", "Spheres for a robot.")
      .field("links", &RobotSpheres::links, doc::RobotSpheres_links)
      .field("notes", &RobotSpheres::notes, doc::RobotSpheres_notes)
      .field("visual", &RobotSpheres::visual, doc::RobotSpheres_visual)
      .property("inner_count", [](const RobotSpheres& r) { return r.inner_count(); })
      .property("sphere_count", [](const RobotSpheres& r) { return r.sphere_count(); })
      .property(
          "covered", [](const RobotSpheres& r) { return r.covered(); }, "True if all links are proven covered.")
      .property(
          "within", [](const RobotSpheres& r) { return r.within(); }, doc::RobotSpheres_within)
      .property(
          "uncovered_share", [](const RobotSpheres& r) { return r.uncovered_share(); },
          doc::RobotSpheres_uncovered_share)
      .shown({"links", "sphere_count", "inner_count", "covered", "notes"})
      .python()
      .def(
          "with_inner_spheres", [](const RobotSpheres& r) { return r.with_inner_spheres(); },
          doc::RobotSpheres_with_inner_spheres)
      .def(
          "of",
          [](const RobotSpheres& r, std::size_t link) -> std::optional<LinkSpheres> {
            const LinkSpheres* found = r.of(link);
            if (!found) return std::nullopt;
            return *found;
          },
          nb::arg("link"), "The spheres of a link of Robot.links; None if it has none.");
  m.def(
      "fit_spheres",
      [](const robot::Robot& robot, std::optional<std::size_t> spheres, std::optional<std::size_t> max_total,
         const std::map<std::string, std::size_t>& link_spheres, std::optional<double> max_protrusion,
         std::optional<double> max_protrusion_share, double tolerance, std::optional<double> max_uncovered,
         double padding, double min_radius, std::optional<double> max_radius, bool visual,
         const std::set<std::string>& skip, nb::handle fixed_given, MethodName method,
         std::optional<QualityName> quality, std::uint64_t seed, double density, nb::handle clip,
         std::optional<double> clip_margin, std::size_t inner, nb::object progress, Threads* workers) {
        robot::FitOptions options;
        options.spheres = spheres;
        options.max_total = max_total;
        options.link_spheres = link_spheres;
        options.max_protrusion = max_protrusion;
        options.max_protrusion_share = max_protrusion_share;
        options.tolerance = tolerance;
        options.max_uncovered = max_uncovered;
        options.padding = padding;
        options.min_radius = min_radius;
        options.max_radius = max_radius;
        options.visual = visual;
        options.skip = skip;
        if (!fixed_given.is_none()) {
          for (const auto& item : value_of<nb::dict>(fixed_given, "fixed_spheres", "a dict of spheres by link")) {
            const auto link = value_of<std::string>(item.first, "fixed_spheres", "a dict of spheres by link");
            options.fixed_spheres[link] = spheres_of(item.second, ("fixed_spheres['" + link + "']").c_str());
          }
        }
        options.method = method_of(method);
        if (quality) options.quality = quality_of(*quality);
        options.seed = seed;
        options.density = density;
        options.clip = clip_of(clip);
        options.clip_margin = clip_margin;
        options.inner = inner;
        options.progress = progress_of(progress);
        return without_gil([&] { return robot::fit_spheres(robot, options, CallWorkers(workers)); });
      },
      nb::arg("robot"), nb::kw_only(), nb::arg("spheres") = nb::none(), nb::arg("max_total") = nb::none(),
      nb::arg("link_spheres") = std::map<std::string, std::size_t>{}, nb::arg("max_protrusion") = nb::none(),
      nb::arg("max_protrusion_share") = nb::none(), nb::arg("tolerance") = 0.0, nb::arg("max_uncovered") = nb::none(),
      nb::arg("padding") = 0.0, nb::arg("min_radius") = 0.0, nb::arg("max_radius") = nb::none(),
      nb::arg("visual") = false, nb::arg("skip") = std::set<std::string>{}, nb::arg("fixed_spheres") = nb::none(),
      nb::arg("method") = "optimized", nb::arg("quality") = nb::none(), nb::arg("seed") = 1,
      nb::arg("density") = 1000.0, nb::arg("clip") = nb::none(), nb::arg("clip_margin") = nb::none(),
      nb::arg("inner") = 0, nb::arg("progress") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig(
          "def fit_spheres(robot: Robot, *, spheres: int | None = None, max_total: int | None = None, link_spheres: "
          "dict[str, "
          "int] "
          "= {}, "
          "max_protrusion: float | None = None, max_protrusion_share: float | None = None, tolerance: float = 0.0, "
          "max_uncovered: float | None = None, padding: float = 0.0, "
          "min_radius: float = 0.0, max_radius: float | None = None, visual: bool = False, skip: set[str] = set(), "
          "fixed_spheres: dict[str, morula.typing.FloatArray] | None = None, method: morula.typing.Method = "
          "'optimized', "
          "quality: morula.typing.Quality | None = None, seed: int = 1, density: float = 1000.0, "
          "clip: dict[str, morula.typing.FloatArray] | None = None, clip_margin: float | None = None, inner: int = 0, "
          "progress: collections.abc.Callable[[float, str], object] | None = None, "
          "workers: morula._morula.Workers | None = None) -> RobotSpheres"),
      with_arguments(
          doc::fit_spheres,
          {{"spheres", doc::FitOptions_spheres},
           {"max_total", doc::FitOptions_max_total},
           {"link_spheres", doc::FitOptions_link_spheres},
           {"max_protrusion", doc::FitOptions_max_protrusion},
           {"max_protrusion_share", doc::FitOptions_max_protrusion_share},
           {"tolerance", doc::FitOptions_tolerance},
           {"max_uncovered", doc::FitOptions_max_uncovered},
           {"padding", doc::FitOptions_padding},
           {"min_radius", doc::FitOptions_min_radius},
           {"max_radius", doc::FitOptions_max_radius},
           {"visual", doc::FitOptions_visual},
           {"skip", doc::FitOptions_skip},
           {"fixed_spheres", doc::FitOptions_fixed_spheres},
           {"quality", doc::FitOptions_quality},
           {"density", doc::FitOptions_density},
           {"clip", "planes (n, 4) by link: normal and offset. The part of a link beyond a plane need not be covered"},
           {"clip_margin", doc::FitOptions_clip_margin},
           {"inner", doc::FitOptions_inner},
           {"progress", "called with the completed share and a link at intervals"}})
          .c_str());
}

}  // namespace morula::python
