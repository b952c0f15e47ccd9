// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Solids: convex hulls, how much space two bodies share, and when a modal body cannot touch itself.
#include <morula/morula.hpp>

#include "held_query.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "motion.hpp"
#include "surfaces.hpp"

namespace morula::python {

namespace {

void bind_hull(nb::module_& m) {
  nb::class_<ConvexHull>(m, "ConvexHull", doc::ConvexHull)
      .def(
          "__init__",
          [](ConvexHull* self, ArrayGiven given) {
            const std::vector<Vec3> points = points_of(given.object, "points");
            ConvexHull made = without_gil([&] { return ConvexHull(points); });
            new (self) ConvexHull(std::move(made));
          },
          nb::arg("points"), doc::ConvexHull_ConvexHull)
      .def_static(
          "box",
          [](Vec3 lower, Vec3 upper, TransformGiven transform) {
            return ConvexHull::box({lower, upper}, transform_of(transform));
          },
          nb::arg("lower"), nb::arg("upper"), nb::arg("transform") = RigidTransform{}, doc::ConvexHull_box)
      .def(
          "placed",
          [](const ConvexHull& self, TransformGiven transform) { return self.placed(transform_of(transform)); },
          nb::arg("transform"), doc::ConvexHull_placed)
      .def_prop_ro(
          "vertices", [](nb::handle self) { return points(nb::cast<ConvexHull&>(self).vertices(), self); },
          doc::ConvexHull_vertices)
      .def_prop_ro(
          "facets", [](nb::handle self) { return triples(nb::cast<ConvexHull&>(self).facets(), self); },
          doc::ConvexHull_facets)
      .def_prop_ro(
          "faces", [](nb::handle self) { return triples(nb::cast<ConvexHull&>(self).facets(), self); },
          "The facets, under the name that other packages use for meshes.")
      .def_prop_ro(
          "planes",
          [](nb::handle self) {
            const auto planes = nb::cast<ConvexHull&>(self).planes();
            static_assert(sizeof(ConvexHull::Plane) == 4 * sizeof(double));
            return View<double, -1, 4>(reinterpret_cast<const double*>(planes.data()), {planes.size(), 4}, self);
          },
          (std::string("(facets, 4) float64: normal and offset. One per facet. ") + doc::ConvexHull_Plane).c_str())
      .def_prop_ro("largest_coordinate", &ConvexHull::largest_coordinate, doc::ConvexHull_largest_coordinate)
      .def(
          "__reduce__",
          [](nb::handle self) { return nb::make_tuple(self.type(), nb::make_tuple(self.attr("vertices"))); },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__", [](const ConvexHull& self) {
        return "<morula.ConvexHull: " + std::to_string(self.vertices().size()) + " vertices, " +
               std::to_string(self.facets().size()) + " facets>";
      });
}

using HeldPenetration = HeldQuery<PenetrationQuery, SeenSides>;

PenetrationOptions penetration_options(double tolerance, double volume_tolerance, const BudgetGiven& budget) {
  PenetrationOptions options;
  options.tolerance = tolerance;
  options.volume_tolerance = volume_tolerance;
  options.budget = budget_of(budget);
  return options;
}

void bind_penetration(nb::module_& m) {
  Record<Penetration>(m, "Penetration", "The volume that two bodies share, between bounds.")
      .field("lower", &Penetration::lower, doc::Penetration_lower)
      .field("upper", &Penetration::upper)
      .field("estimate", &Penetration::estimate, doc::Penetration_estimate)
      .field("center", &Penetration::center, doc::Penetration_center)
      .field("finished", &Penetration::finished, doc::Penetration_finished)
      .field("certified", &Penetration::certified, doc::Penetration_certified)
      .field("probes", &Penetration::probes, doc::Penetration_probes);
  const std::initializer_list<std::pair<const char*, const char*>> arguments{
      {"tolerance", doc::PenetrationOptions_tolerance},
      {"volume_tolerance", doc::PenetrationOptions_volume_tolerance},
      {"budget", doc::PenetrationOptions_budget}};
  nb::class_<HeldPenetration>(m, "PenetrationQuery", collected<HeldPenetration>(), doc::PenetrationQuery)
      .def(
          "__init__",
          [](HeldPenetration* self, ColliderGiven ga, ColliderGiven gb) {
            auto a = kept_side_of(ga, "a"), b = kept_side_of(gb, "b");
            PenetrationQuery query = without_gil([&] {
              const Reading reading({a.get(), b.get()});
              return PenetrationQuery(a->current(), b->current());
            });
            new (self) HeldPenetration(std::move(query), {{std::move(a), std::move(b)}});
          },
          nb::arg("a"), nb::arg("b"), doc::PenetrationQuery_PenetrationQuery)
      .def(
          "run",
          [](HeldPenetration& self, double tolerance, double volume_tolerance, BudgetGiven budget) {
            const PenetrationOptions options = penetration_options(tolerance, volume_tolerance, budget);
            const Penetration found = self.call([&](PenetrationQuery& query) { return query.run(options); });
            require(found.status);
            return found;
          },
          nb::kw_only(), nb::arg("tolerance") = 0.25, nb::arg("volume_tolerance") = 0.0, nb::arg("budget") = 20000,
          with_arguments(doc::PenetrationQuery_run, arguments).c_str())
      .def(
          "resume",
          [](HeldPenetration& self, double tolerance, double volume_tolerance, BudgetGiven budget) {
            const PenetrationOptions options = penetration_options(tolerance, volume_tolerance, budget);
            const Penetration found = self.call([&](PenetrationQuery& query) { return query.resume(options); });
            require(found.status);
            return found;
          },
          nb::kw_only(), nb::arg("tolerance") = 0.25, nb::arg("volume_tolerance") = 0.0, nb::arg("budget") = 20000,
          with_arguments(doc::PenetrationQuery_resume, arguments).c_str());
}

/// Its answers use memory of its own.
struct HeldCertificate {
  ModalCertificate certificate;
  std::size_t mode_count, vertex_count;
  mutable std::mutex mutex;

  std::vector<double> coordinates_of(const ArrayGiven& given) const {
    std::vector<std::size_t> shape;
    return numbers_of(given.object, "coordinates", {static_cast<std::int64_t>(mode_count)}, shape);
  }
};

void bind_modal_certificate(nb::module_& m) {
  nb::class_<HeldCertificate>(m, "ModalCertificate", doc::ModalCertificate)
      .def(
          "__init__",
          [](HeldCertificate* self, MeshGiven given, nb::handle modes_given, double largest_norm, double margin,
             double rest_distance, nb::handle scales) {
            const auto mesh = mesh_of(given, "rest");
            const Modes modes = modes_of(modes_given, "modes");
            ModalCertificateOptions options;
            options.largest_norm = largest_norm;
            options.margin = margin;
            options.rest_distance = rest_distance;
            std::vector<std::size_t> shape;
            if (!scales.is_none()) options.scales = numbers_of(scales, "scales", {-1}, shape);
            ModalCertificate made = without_gil([&] { return ModalCertificate(*mesh, modes, options); });
            new (self) HeldCertificate{std::move(made), modes.mode_count, modes.vertex_count, {}};
          },
          nb::arg("rest"), nb::arg("modes"), nb::kw_only(), nb::arg("largest_norm") = 1.0, nb::arg("margin") = 0.0,
          nb::arg("rest_distance") = 0.0, nb::arg("scales") = nb::none(),
          nb::sig("def __init__(self, rest: morula.typing.MeshLike, modes: Modes | morula.typing.FloatArray, *, "
                  "largest_norm: float = 1.0, margin: float = 0.0, rest_distance: float = 0.0, "
                  "scales: morula.typing.FloatArray | None = None) -> None"),
          with_arguments(doc::ModalCertificate_ModalCertificate,
                         {{"largest_norm", doc::ModalCertificateOptions_largest_norm},
                          {"margin", doc::ModalCertificateOptions_margin},
                          {"rest_distance", doc::ModalCertificateOptions_rest_distance},
                          {"scales", doc::ModalCertificateOptions_scales}})
              .c_str())
      .def(
          "norm",
          [](const HeldCertificate& self, ArrayGiven given) {
            return self.certificate.norm(self.coordinates_of(given));
          },
          nb::arg("coordinates"), doc::ModalCertificate_norm)
      .def_prop_ro(
          "free_norm", [](const HeldCertificate& self) { return self.certificate.free_norm(); },
          doc::ModalCertificate_free_norm)
      .def(
          "is_free",
          [](const HeldCertificate& self, ArrayGiven given) {
            return self.certificate.is_free(self.coordinates_of(given));
          },
          nb::arg("coordinates"), "True if the norm is at most free_norm, so no facets touch.")
      .def(
          "is_known",
          [](const HeldCertificate& self, ArrayGiven given) {
            return self.certificate.is_known(self.coordinates_of(given));
          },
          nb::arg("coordinates"), doc::ModalCertificate_is_known)
      .def(
          "open",
          [](const HeldCertificate& self, ArrayGiven given) {
            const std::vector<double> coordinates = self.coordinates_of(given);
            const std::scoped_lock lock(self.mutex);
            const auto found = self.certificate.open(coordinates);
            return FeaturePairs{{found.begin(), found.end()}};
          },
          nb::arg("coordinates"), doc::ModalCertificate_open)
      .def(
          "crossings",
          [](const HeldCertificate& self, ArrayGiven given, PositionsGiven at) -> std::optional<FeaturePairs> {
            const std::vector<double> coordinates = self.coordinates_of(given);
            const Positions positions(at.object, "positions");
            require_rows(positions.view().size(), self.vertex_count, "positions", 3, "the modes' vertices");
            FeaturePairs found;
            const bool known = without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              return self.certificate.crossings(coordinates, positions.view(), found.pairs);
            });
            if (!known) return std::nullopt;
            return found;
          },
          nb::arg("coordinates"), nb::arg("positions"),
          "The pairs of open() whose facets intersect, exactly, at the present vertices, in the order of (a, b). These "
          "are the results of surface_crossings() with the same rest distance, if positions are those of "
          "move_by_modes() at these coordinates. None for coordinates beyond largest_norm.")
      .def_prop_ro(
          "tested_facet_pairs", [](const HeldCertificate& self) { return self.certificate.tested_facet_pairs(); },
          doc::ModalCertificate_tested_facet_pairs)
      .def_prop_ro(
          "tested_node_pairs", [](const HeldCertificate& self) { return self.certificate.tested_node_pairs(); },
          doc::ModalCertificate_tested_facet_pairs);
}

}  // namespace

void bind_solids(nb::module_& m) {
  bind_hull(m);
  bind_penetration(m);
  bind_modal_certificate(m);
}

}  // namespace morula::python
