// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body and a half space, a capsule, a hull or a ball.
#include <initializer_list>
#include <morula/morula.hpp>
#include <string>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// The shape as text: the call that makes it.
std::string shown(nb::handle shape, std::initializer_list<const char*> names) {
  std::string text = nb::cast<std::string>(nb::object(nb::handle(shape.type()).attr("__name__")));
  const char* before = "(";
  for (const char* name : names) {
    text += std::string(before) + name + "=" + nb::cast<std::string>(nb::repr(nb::object(shape.attr(name))));
    before = ", ";
  }
  return text + ")";
}

}  // namespace

void bind_touch(nb::module_& m) {
  nb::class_<HalfSpace>(m, "HalfSpace", doc::HalfSpace)
      .def(
          "__init__",
          [](HalfSpace* self, Vec3 normal, double offset) {
            new (self) HalfSpace{normal, offset};
          },
          nb::arg("normal") = Vec3{0, 0, 1}, nb::arg("offset") = 0.0)
      .def_ro("normal", &HalfSpace::normal)
      .def_ro("offset", &HalfSpace::offset)
      .def("__repr__", [](nb::handle self) {
        return shown(self, {"normal", "offset"});
      });
  nb::class_<Capsule>(m, "Capsule", doc::Capsule)
      .def(
          "__init__",
          [](Capsule* self, Vec3 p, Vec3 q, double radius) {
            new (self) Capsule{p, q, radius};
          },
          nb::arg("p"), nb::arg("q"), nb::arg("radius"))
      .def_ro("p", &Capsule::p)
      .def_ro("q", &Capsule::q)
      .def_ro("radius", &Capsule::radius)
      .def("__repr__", [](nb::handle self) {
        return shown(self, {"p", "q", "radius"});
      });
  Record<TouchingFacet>(m, "TouchingFacet", doc::TouchingFacet)
      .field("point", &TouchingFacet::point)
      .field("depth", &TouchingFacet::depth, doc::TouchingFacet_depth)
      .field("normal", &TouchingFacet::normal, doc::TouchingFacet_normal);
  Record<Touch>(m, "Touch", "What touch() found.")
      .field("touches", &Touch::touches, doc::Touch_touches)
      .field("proven_clear", &Touch::proven_clear, doc::Touch_proven_clear)
      .field("certified", &Touch::certified, doc::Touch_certified)
      .field("lower", &Touch::lower, doc::Touch_lower)
      .field("deepest", &Touch::deepest, doc::Touch_deepest)
      .field("facets", &Touch::facets, doc::Touch_facets)
      .field("leaves", &Touch::leaves, doc::Touch_leaves)
      .field("sphere_tests", &Touch::sphere_tests)
      .field("facet_tests", &Touch::facet_tests);
  m.def(
      "touch",
      [](ColliderGiven given, ShapeGiven shape, double margin, bool nearest, bool stop_at_first, bool collect_all) {
        const auto side = side_of(given, "body");
        const TouchOptions options{margin, nearest, stop_at_first, collect_all};
        return with_shape(shape, [&](const auto& s) {
          return without_gil([&] {
            const Reading reading({side.get()});
            return touch(side->current(), s, options);
          });
        });
      },
      nb::arg("body"), nb::arg("shape"), nb::kw_only(), nb::arg("margin") = 0.0, nb::arg("nearest") = false,
      nb::arg("stop_at_first") = false, nb::arg("collect_all") = false,
      with_arguments(
          "The contact of the body's surface with a half space, a capsule, a ConvexHull or a sphere (x, y, z, radius).",
          {{"margin", doc::TouchOptions_margin},
           {"nearest", doc::TouchOptions_nearest},
           {"stop_at_first", doc::TouchOptions_stop_at_first},
           {"collect_all", doc::TouchOptions_collect_all}})
          .c_str());
  Record<SweepPoint>(m, "SweepPoint", doc::SweepPoint)
      .field("t", &SweepPoint::t, doc::SweepPoint_t)
      .field("point", &SweepPoint::point, doc::SweepPoint_point)
      .field("normal", &SweepPoint::normal, doc::SweepPoint_normal);
  Record<SweepHit>(m, "SweepHit", "What sweep() found.")
      .field("first", &SweepHit::first, doc::SweepHit_first)
      .field("certified", &SweepHit::certified, doc::SweepHit_certified)
      .field("sphere_tests", &SweepHit::sphere_tests)
      .field("facet_tests", &SweepHit::facet_tests)
      .python()
      .def("__bool__", [](const SweepHit& hit) { return hit.first.has_value(); });
  m.def(
      "sweep",
      [](ColliderGiven given, ShapeGiven shape, Vec3 motion) {
        const auto side = side_of(given, "body");
        return with_shape(shape, [&](const auto& s) -> SweepHit {
          if constexpr (std::same_as<std::remove_cvref_t<decltype(s)>, HalfSpace>) {
            throw nb::type_error("shape: a HalfSpace has no first touch; a Capsule, a ConvexHull or a sphere has");
          } else {
            return without_gil([&] {
              const Reading reading({side.get()});
              return sweep(side->current(), s, motion);
            });
          }
        });
      },
      nb::arg("body"), nb::arg("shape"), nb::arg("motion"), doc::SweepQuery);
}

}  // namespace morula::python
