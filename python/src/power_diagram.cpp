// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The power diagram of spheres, cut into facets.
#include <algorithm>
#include <array>
#include <memory>
#include <morula/morula.hpp>
#include <morula/query/power_diagram.hpp>
#include <string>
#include <utility>
#include <vector>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

struct HeldDiagram {
  std::unique_ptr<const std::vector<Sphere>> spheres;  // which the diagram borrows
  PowerDiagram diagram;
};

constexpr const char* vertices_text =
    "numbers of the corners in a mesh, which give its edges a direction: cuts agree along them, bit for bit";

Triangle corners_of(const ArrayGiven& given) {
  const std::vector<Vec3> corners = points_of(given.object, "triangle");
  if (corners.size() != 3) throw std::invalid_argument("triangle: shape (3, 3) is needed");
  return {corners[0], corners[1], corners[2]};
}

/// Polygons of a facet, in barycentric coordinates; none: the whole facet.
std::vector<Barycentric> polygon_of(nb::handle given) {
  if (given.is_none()) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<Barycentric> polygon;
  for (const Vec3& corner : points_of(given, "polygon")) polygon.push_back({corner.x, corner.y, corner.z});
  if (polygon.size() < 3) throw std::invalid_argument("polygon: at least three corners are needed");
  return polygon;
}

/// Numbers of the spheres; none: all.
std::vector<std::uint32_t> candidates_of(nb::handle given, std::size_t count) {
  std::vector<std::uint32_t> candidates;
  if (given.is_none()) {
    for (std::uint32_t i = 0; i < count; ++i) candidates.push_back(i);
  } else {
    candidates = indices_of(given, "candidates");
  }
  if (candidates.empty()) throw std::invalid_argument("candidates: at least one is needed");
  for (const std::uint32_t i : candidates)
    if (i >= count) throw nb::index_error("candidates: there is no such sphere");
  return candidates;
}

}  // namespace

void bind_power_diagram(nb::module_& m) {
  Record<CutFacet>(m, "CutFacet", "Convex polygons inside one facet, with their owners.")
      .property(
          "corners",
          [](nb::handle self) {
            const auto& corners = nb::cast<const CutFacet&>(self).corners;
            return Points(reinterpret_cast<const double*>(corners.data()), {corners.size(), 3}, self);
          },
          "(corners, 3) float64: barycentric coordinates.")
      .property(
          "corner_begin", [](nb::handle self) { return indices(nb::cast<const CutFacet&>(self).corner_begin, self); },
          doc::CutFacet_corner_begin)
      .property(
          "owner", [](nb::handle self) { return indices(nb::cast<const CutFacet&>(self).owner, self); },
          doc::CutFacet_owner)
      .python()
      .def("__len__", &CutFacet::size)
      .def(
          "polygon",
          [](nb::handle self, std::size_t k) {
            const auto& cut = nb::cast<const CutFacet&>(self);
            if (k >= cut.size()) throw nb::index_error("k");
            const auto polygon = cut.polygon(k);
            return Points(reinterpret_cast<const double*>(polygon.data()), {polygon.size(), 3}, self);
          },
          nb::arg("k"), "(n, 3) float64: barycentric corners of one polygon, in order.");
  m.def(
      "cut_by_power",
      [](ArrayGiven triangle, ArrayGiven given, nb::handle polygon, nb::handle numbers,
         std::array<std::uint32_t, 3> vertices) {
        const FacetGeometry facet{corners_of(triangle), vertices};
        const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
        const std::vector<Barycentric> corners = polygon_of(polygon);
        const std::vector<std::uint32_t> candidates = candidates_of(numbers, spheres.size());
        CutFacet cut;
        cut_by_power(facet, corners, spheres, candidates, cut);
        return cut;
      },
      nb::arg("triangle"), nb::arg("spheres"), nb::arg("polygon") = nb::none(), nb::arg("candidates") = nb::none(),
      nb::arg("vertices") = std::array<std::uint32_t, 3>{0, 1, 2},
      nb::sig("def cut_by_power(triangle: morula.typing.FloatArray, spheres: morula.typing.FloatArray, polygon: "
              "morula.typing.FloatArray | None = None, candidates: morula.typing.Array | None = None, vertices: "
              "collections.abc.Sequence[int] = (0, 1, 2)) -> CutFacet"),
      "Cuts one convex polygon of a facet by the power diagram of a few spheres. The parts tile it under any rounding, "
      "because both sides share every cut. The owner of each part has the least power at all its corners, up to "
      "rounding; ties go to the lower index. A facet with a repeated vertex is never cut.\n\nArgs:\n    triangle: (3, "
      "3), corners in rows.\n    spheres: (n, 4).\n    polygon: (k, 3), barycentric corners in order, at least three; "
      "None: the whole facet.\n    candidates: numbers of the spheres that may own a part; None: all.\n    vertices: "
      "numbers of the corners in a mesh, which give its edges a direction: cuts agree along them, bit for bit.");

  nb::class_<HeldDiagram>(m, "PowerDiagram", doc::PowerDiagram)
      .def(
          "__init__",
          [](HeldDiagram* self, ArrayGiven given) {
            auto spheres = std::make_unique<const std::vector<Sphere>>(spheres_of(given.object, "spheres"));
            if (spheres->empty()) throw std::invalid_argument("spheres: at least one is needed");
            PowerDiagram diagram = without_gil([&] { return PowerDiagram(*spheres); });
            new (self) HeldDiagram{std::move(spheres), std::move(diagram)};
          },
          nb::arg("spheres"), "Copies the spheres: (n, 4), at least one. O(n log n).")
      .def(
          "owners",
          [](const HeldDiagram& self, ArrayGiven given, Threads* workers) {
            const std::vector<Vec3> points = points_of(given.object, "points");
            return own_indices(without_gil([&] {
              std::vector<std::uint32_t> owners(points.size());
              CallWorkers call(workers);
              parallel_for(static_cast<Workers&>(call), points.size(), 256, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) owners[i] = self.diagram.owner(points[i]);
              });
              return owners;
            }));
          },
          nb::arg("points"), nb::arg("workers") = nb::none(),
          (std::string("Owners of points (n, 3). ") + doc::PowerDiagram_owner).c_str())
      .def(
          "candidates",
          [](const HeldDiagram& self, ArrayGiven given) {
            std::vector<std::uint32_t> found;
            self.diagram.candidates(corners_of(given), found);
            return own_indices(std::move(found));
          },
          nb::arg("triangle"), doc::PowerDiagram_candidates)
      .def(
          "cut",
          [](const HeldDiagram& self, ArrayGiven triangle, std::array<std::uint32_t, 3> vertices) {
            const FacetGeometry facet{corners_of(triangle), vertices};
            CutFacet cut;
            std::vector<std::uint32_t> scratch;
            self.diagram.cut(facet, scratch, cut);
            return cut;
          },
          nb::arg("triangle"), nb::arg("vertices") = std::array<std::uint32_t, 3>{0, 1, 2},
          nb::sig("def cut(self, triangle: morula.typing.FloatArray, vertices: collections.abc.Sequence[int] = (0, 1, "
                  "2)) -> CutFacet"),
          with_arguments(doc::PowerDiagram_cut, {{"triangle", "(3, 3): corners in rows"}, {"vertices", vertices_text}})
              .c_str())
      .def(
          "least_growth",
          [](const HeldDiagram& self, ArrayGiven given) {
            const std::vector<Vec3> points = points_of(given.object, "points");
            if (points.empty()) throw std::invalid_argument("points: at least one is needed");
            const PowerDiagram::Growth growth = self.diagram.least_growth(points);
            return std::make_pair(growth.sphere, growth.amount);
          },
          nb::arg("points"), (std::string("A sphere and an amount. ") + doc::PowerDiagram_least_growth).c_str());
}

}  // namespace morula::python
