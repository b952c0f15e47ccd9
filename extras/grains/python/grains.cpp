// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Grains: clumps of spheres for discrete element codes, and the mass of a union of spheres.
#include <algorithm>
#include <morula/grains/clump.hpp>
#include <morula/morula.hpp>

#include "building.hpp"
#include "calls.hpp"
#include "choices.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

inline constexpr Choices<ClumpKind> clump_kind_choices{{"cover", ClumpKind::cover}, {"inner", ClumpKind::inner}};

std::string text_of(const ClumpFormat& format, const Clump& clump, const std::string& name) {
  return format.text(clump, name);
}

const ClumpFormat& format_of(std::string_view wanted) {
  const auto all = clump_formats();
  const auto found = std::find_if(all.begin(), all.end(), [&](const ClumpFormat& f) { return f.name == wanted; });
  if (found != all.end()) return *found;
  std::string known;
  for (const ClumpFormat& f : all) known += (known.empty() ? "" : ", ") + std::string(f.name);
  throw std::invalid_argument("format: '" + std::string(wanted) + "', but there are only " + known);
}

/// Names that arguments take, in addition to those of the library (choices.cpp).
void add_choices(nb::module_& m) {
  nb::dict all = nb::borrow<nb::dict>(nb::object(m.attr("_choices")));
  std::vector<std::string> formats;
  for (const ClumpFormat& format : clump_formats()) formats.emplace_back(format.name);
  all["ClumpFormatName"] = nb::cast(formats);
  std::vector<std::string> kinds;
  for (const auto& [word, kind] : clump_kind_choices) kinds.emplace_back(word);
  all["ClumpKind"] = nb::cast(kinds);
}

}  // namespace

void bind_grains_extra(nb::module_& m) {
  add_choices(m);
  Record<Clump>(m, "Clump", doc::Clump)
      .property(
          "kind", [](const Clump& c) { return std::string(name(c.kind)); },
          (std::string("cover: ") + doc::ClumpKind_cover + "; inner: " + doc::ClumpKind_inner).c_str())
      .property(
          "spheres", [](nb::handle self) { return sphere_rows(nb::cast<Clump&>(self).spheres, self); },
          "(n, 4) float64: x, y, z, radius in mesh units, read-only; no copy.")
      .field("proven", &Clump::proven, doc::Clump_proven)
      .field("within", &Clump::within, doc::Clump_within)
      .field("uncovered_distance", &Clump::uncovered_distance, doc::Clump_uncovered_distance)
      .field("protrusion_max", &Clump::protrusion_max, doc::Clump_protrusion_max)
      .field("object_volume", &Clump::object_volume, doc::Clump_object_volume)
      .field("missed_volume", &Clump::missed_volume, doc::Clump_missed_volume)
      .field("outside_volume", &Clump::outside_volume, doc::Clump_outside_volume)
      .field("solid", &Clump::solid, doc::Clump_solid)
      .field("solid_change", &Clump::solid_change, doc::Clump_solid_change)
      .field("density", &Clump::density)
      .property(
          "mass", [](const Clump& c) { return c.mass(); }, "density times the volume of the union.")
      .field("principal", &Clump::principal, doc::Clump_principal)
      .field("principal_inertia", &Clump::principal_inertia, doc::Clump_principal_inertia)
      .field("notes", &Clump::notes)
      .python()
      .def("__len__", [](const Clump& c) { return c.spheres.size(); })
      .def(
          "text",
          [](const Clump& c, ClumpFormatName format, const std::string& called) {
            return text_of(format_of(format), c, called);
          },
          nb::arg("format"), nb::arg("name") = "grain",
          "The clump in the format of a discrete element code, one of clump_formats(). name: name of the clump in the "
          "text.");
  nb::class_<ClumpFormat>(m, "ClumpFormat", only_returned(), doc::ClumpFormat)
      .def_prop_ro(
          "name", [](const ClumpFormat& f) { return std::string(f.name); }, doc::ClumpFormat_name)
      .def_prop_ro(
          "extension", [](const ClumpFormat& f) { return std::string(f.extension); }, doc::ClumpFormat_extension)
      .def_prop_ro(
          "program", [](const ClumpFormat& f) { return std::string(f.program); }, doc::ClumpFormat_program)
      .def_prop_ro(
          "axes", [](const ClumpFormat& f) { return std::string(f.axes); }, doc::ClumpFormat_axes)
      .def("text", &text_of, nb::arg("clump"), nb::arg("name") = "grain", "The text of a file.")
      .def("__repr__", [](const ClumpFormat& f) {
        return "<morula.ClumpFormat: " + std::string(f.name) + ", " + std::string(f.program) + ">";
      });
  m.def(
      "clump_formats", [] { return std::vector<ClumpFormat>(clump_formats().begin(), clump_formats().end()); },
      "The formats of discrete element codes that Clump.text() writes.");
  m.def(
      "fit_clump",
      [](MeshGiven given, std::string_view kind, std::size_t spheres, std::optional<double> max_protrusion,
         double tolerance, double min_radius, std::optional<double> max_radius, double density, MethodName method,
         QualityName quality, std::size_t candidates, std::uint64_t seed, nb::object progress, Threads* workers) {
        ClumpOptions options;
        options.kind = choice<ClumpKind>(kind, "kind", clump_kind_choices);
        options.spheres = spheres;
        options.max_protrusion = max_protrusion;
        options.tolerance = tolerance;
        options.min_radius = min_radius;
        options.max_radius = max_radius;
        options.density = density;
        options.method = method_of(method);
        options.quality = quality_of(quality);
        options.candidates = candidates;
        options.seed = seed;
        options.progress = progress_of(progress);
        const auto mesh = mesh_of(given);
        return without_gil([&] { return fit_clump(*mesh, options, CallWorkers(workers)); });
      },
      nb::arg("mesh"), nb::kw_only(), nb::arg("kind") = "cover", nb::arg("spheres") = 16,
      nb::arg("max_protrusion") = nb::none(), nb::arg("tolerance") = 0.0, nb::arg("min_radius") = 0.0,
      nb::arg("max_radius") = nb::none(), nb::arg("density") = 1000.0, nb::arg("method") = "optimized",
      nb::arg("quality") = "default", nb::arg("candidates") = 2000, nb::arg("seed") = 1,
      nb::arg("progress").none().sig("None") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig(
          "def fit_clump(mesh: morula.typing.MeshLike, *, kind: morula.typing.ClumpKind = 'cover', spheres: int = 16, "
          "max_protrusion: float | None = None, tolerance: float = 0.0, min_radius: float = 0.0, max_radius: float | "
          "None = None, "
          "density: float = 1000.0, "
          "method: morula.typing.Method = 'optimized', quality: morula.typing.Quality = 'default', candidates: int = "
          "2000, seed: int = 1, "
          "progress: collections.abc.Callable[[BuildProgress], object] | None = None, "
          "workers: Workers | None = None) -> Clump"),
      with_arguments("Spheres that represent a grain, with their mass and inertia. ValueError for options out of range "
                     "and unusable meshes, and for inner spheres of a mesh that has no inside or no balls of this "
                     "size. The result has the same bits for any number of workers.",
                     {{"kind", "cover: the spheres contain the surface; inner: every sphere is inside the grain"},
                      {"spheres", doc::ClumpOptions_spheres},
                      {"max_protrusion", doc::ClumpOptions_max_protrusion},
                      {"tolerance", doc::ClumpOptions_tolerance},
                      {"min_radius", doc::ClumpOptions_min_radius},
                      {"max_radius", doc::ClumpOptions_max_radius},
                      {"density", doc::ClumpOptions_density},
                      {"method", doc::ClumpOptions_method},
                      {"quality", doc::ClumpOptions_quality},
                      {"candidates", doc::ClumpOptions_candidates},
                      {"progress", "called with a BuildProgress at intervals; an exception of it ends the fit"}})
          .c_str());
}

}  // namespace morula::python
