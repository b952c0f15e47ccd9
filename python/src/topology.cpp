// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Topology: edges, fans, components and borders of meshes; and single triangles.
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <morula/morula.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// Solids from rows of corners; none from None.
template <class Solid>
std::vector<Solid> solids_of(nb::handle given, const char* name) {
  if (given.is_none()) return {};
  constexpr std::size_t columns = std::tuple_size_v<Solid>;
  const std::vector<std::uint32_t> corners = index_rows_of(given, name, columns);
  std::vector<Solid> solids(corners.size() / columns);
  for (std::size_t k = 0; k < corners.size(); ++k) solids[k / columns][k % columns] = corners[k];
  return solids;
}

Triangle triangle_of(const ArrayGiven& given, const char* name) {
  const std::vector<Vec3> corners = points_of(given.object, name);
  if (corners.size() != 3)
    throw std::invalid_argument(std::string(name) + ": " + describe(given.object) + ", but shape (3, 3) is needed");
  return {corners[0], corners[1], corners[2]};
}

/// All indices of a mesh have to be in range, which mesh_of() sees to.
Connectivity connectivity_of(const MeshView& mesh) {
  return without_gil([&] { return connectivity(mesh); });
}

void bind_connectivity(nb::module_& m) {
  m.attr("no_edge") = no_edge;
  m.attr("no_facet") = no_facet;
  m.attr("several_facets") = several_facets;
  Record<Connectivity> record(m, "Connectivity", doc::Connectivity);
  record
      .property(
          "edges",
          [](nb::handle self) {
            const auto& edges = nb::cast<const Connectivity&>(self).edges;
            return IndexPairs(reinterpret_cast<const std::uint32_t*>(edges.data()), {edges.size(), 2}, self);
          },
          doc::Connectivity_edges)
      .property(
          "side_begin", [](nb::handle self) { return indices(nb::cast<const Connectivity&>(self).side_begin, self); },
          doc::Connectivity_side_begin)
      .property(
          "sides", [](nb::handle self) { return indices(nb::cast<const Connectivity&>(self).sides, self); },
          doc::Connectivity_sides)
      .property(
          "facet_edges", [](nb::handle self) { return triples(nb::cast<const Connectivity&>(self).facet_edges, self); },
          doc::Connectivity_facet_edges)
      .property(
          "fan_begin", [](nb::handle self) { return indices(nb::cast<const Connectivity&>(self).fan_begin, self); },
          doc::Connectivity_fan_begin)
      .property(
          "fan_facets", [](nb::handle self) { return indices(nb::cast<const Connectivity&>(self).fan_facets, self); },
          doc::Connectivity_fan_facets);
  record.python()
      .def_prop_ro("edge_count", &Connectivity::edge_count)
      .def(
          "facet_across",
          [](const Connectivity& self, std::uint32_t facet, std::uint32_t k) {
            if (facet >= self.facet_edges.size() || k > 2) throw nb::index_error("no such side");
            return self.facet_across(facet, k);
          },
          nb::arg("facet"), nb::arg("k"), doc::Connectivity_facet_across)
      .def(
          "edge_sides",
          [](const Connectivity& self, std::uint32_t edge) {
            if (edge >= self.edge_count()) throw nb::index_error("edge");
            const auto sides = self.edge_sides(edge);
            return own_indices({sides.begin(), sides.end()});
          },
          nb::arg("edge"), "The sides of an edge.")
      .def(
          "vertex_facets",
          [](const Connectivity& self, std::uint32_t vertex) {
            if (vertex + std::size_t{1} >= self.fan_begin.size()) throw nb::index_error("vertex");
            const auto facets = self.vertex_facets(vertex);
            return own_indices({facets.begin(), facets.end()});
          },
          nb::arg("vertex"), "The facets around a vertex.");
  m.def(
      "connectivity", [](MeshGiven given) { return connectivity_of(*mesh_of(given)); }, nb::arg("mesh"),
      "Edges, and the facets around them and around vertices. Linear time, times the logarithm of the valence.");

  Record<Components>(m, "Components", doc::Components)
      .property("of_facet", [](nb::handle self) { return indices(nb::cast<const Components&>(self).of_facet, self); })
      .field("count", &Components::count);
  m.def(
      "components_by_vertices",
      [](MeshGiven given) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return components_by_vertices(*mesh); });
      },
      nb::arg("mesh"), "Components of a surface: facets that share a vertex belong to one component.");
  m.def(
      "components_by_edges",
      [](MeshGiven given) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return components_by_edges(*mesh, connectivity(*mesh)); });
      },
      nb::arg("mesh"),
      "Components of a surface: facets that share an edge belong to one component; facets that only touch at a vertex "
      "do not.");
  const auto edges = [&m](const char* name, auto find, const char* text) {
    m.def(
        name, [find](const Connectivity& c) { return own_indices(find(c)); }, nb::arg("connectivity"), text);
  };
  edges(
      "border_edges", [](const Connectivity& c) { return border_edges(c); }, "Edges with one side, ascending.");
  edges(
      "nonmanifold_edges", [](const Connectivity& c) { return nonmanifold_edges(c); },
      "Edges with more than two sides, ascending.");
  m.def(
      "nonmanifold_vertices",
      [](MeshGiven given) {
        const auto mesh = mesh_of(given);
        return own_indices(without_gil([&] { return nonmanifold_vertices(*mesh, connectivity(*mesh)); }));
      },
      nb::arg("mesh"), doc::nonmanifold_vertices);
  Record<BorderLoops>(m, "BorderLoops", doc::BorderLoops)
      .property(
          "begin", [](nb::handle self) { return indices(nb::cast<const BorderLoops&>(self).begin, self); },
          doc::BorderLoops_begin)
      .property(
          "sides", [](nb::handle self) { return indices(nb::cast<const BorderLoops&>(self).sides, self); },
          doc::BorderLoops_sides)
      .property(
          "is_loop",
          [](nb::handle self) {
            const auto& flags = nb::cast<const BorderLoops&>(self).is_loop;
            return Flags(reinterpret_cast<const bool*>(flags.data()), {flags.size()}, self);
          },
          doc::BorderLoops_is_loop)
      .python()
      .def("__len__", &BorderLoops::count);
  m.def(
      "border_loops",
      [](MeshGiven given) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return border_loops(*mesh, connectivity(*mesh)); });
      },
      nb::arg("mesh"), doc::border_loops);
  m.def(
      "used_vertices",
      [](MeshGiven given) {
        UsedVertices used = used_vertices(*mesh_of(given));
        return std::make_tuple(std::move(used.mesh), own_indices(std::move(used.index)));
      },
      nb::arg("mesh"),
      "A mesh without the vertices that no facet uses, and the former numbers of its vertices, ascending.");
  m.def(
      "solid_surface",
      [](ArrayGiven given, nb::handle tetrahedra_given, nb::handle hexahedra_given) {
        const std::vector<Vec3> points = points_of(given.object, "points");
        const auto tetrahedra = solids_of<Tetrahedron>(tetrahedra_given, "tetrahedra");
        const auto hexahedra = solids_of<Hexahedron>(hexahedra_given, "hexahedra");
        UsedVertices surface = without_gil([&] { return solid_surface(points, tetrahedra, hexahedra); });
        return std::make_tuple(std::move(surface.mesh), own_indices(std::move(surface.index)));
      },
      nb::arg("points"), nb::arg("tetrahedra") = nb::none(), nb::arg("hexahedra") = nb::none(),
      nb::sig("def solid_surface(points: morula.typing.FloatArray, tetrahedra: morula.typing.Array | None = None, "
              "hexahedra: morula.typing.Array | None = None) -> tuple[Mesh, numpy.ndarray]"),
      with_arguments(doc::solid_surface,
                     {{"points", "(n, 3)"},
                      {"tetrahedra", "(m, 4) integers, or None"},
                      {"hexahedra", "(k, 8) integers, or None. Returns the mesh and the numbers of its vertices"}})
          .c_str());
}

}  // namespace

void bind_topology(nb::module_& m) {
  bind_connectivity(m);
  m.def(
      "intersect", [](ArrayGiven a, ArrayGiven b) { return intersect(triangle_of(a, "a"), triangle_of(b, "b")); },
      nb::arg("a"), nb::arg("b"),
      with_arguments(doc::intersect, {{"a", "(3, 3): corners in rows"}, {"b", "the same"}}).c_str());
  m.def(
      "intersection",
      [](ArrayGiven a, ArrayGiven b) -> std::optional<std::pair<Vec3, Vec3>> {
        const auto found = intersection(triangle_of(a, "a"), triangle_of(b, "b"));
        if (!found) return std::nullopt;
        return std::make_pair(found->from, found->to);
      },
      nb::arg("a"), nb::arg("b"), doc::intersection);
  Record<TrianglePoint>(m, "TrianglePoint", "The point of a triangle that is nearest to another.")
      .field("point", &TrianglePoint::point)
      .field("barycentric", &TrianglePoint::barycentric, doc::TrianglePoint_barycentric)
      .field("squared_distance", &TrianglePoint::squared_distance);
  m.def(
      "closest_point", [](ArrayGiven triangle, Vec3 p) { return closest_point(triangle_of(triangle, "triangle"), p); },
      nb::arg("triangle"), nb::arg("p"), doc::closest_point);
  m.def(
      "solid_angle", [](ArrayGiven triangle, Vec3 p) { return solid_angle(triangle_of(triangle, "triangle"), p); },
      nb::arg("triangle"), nb::arg("p"), doc::solid_angle);
}

}  // namespace morula::python
