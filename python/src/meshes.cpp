// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes: arrays of positions and facets, samples, reports, repairs; transforms.
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/morula.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

void bind_mesh(nb::module_& m) {
  nb::class_<Mesh>(
      m, "Mesh",
      "A triangle mesh: positions (vertices, 3) float64 and facets (facets, 3) uint32. A value, fixed once made: it "
      "copies its arrays, since it has a hash, is compared and pickled, and bodies share it. Every function that takes "
      "a "
      "mesh also takes a tuple of arrays or an object with vertices and faces, and copies neither float32 and float64 "
      "positions nor int32 and uint32 facets in C order. Vertex order is the caller's, and motions refer to it.")
      .def(
          "__init__",
          [](Mesh* self, ArrayGiven positions, ArrayGiven facets) {
            const nb::tuple both = nb::make_tuple(positions.object, facets.object);
            new (self) Mesh();
            self->positions = points_of(positions.object, "positions");
            self->facets = facets_of(facets.object, "facets");
            without_gil([&] { require_usable(*self); });
          },
          nb::arg("positions"), nb::arg("facets"),
          "Copies both. positions: (vertices, 3), float32 or float64. facets: (facets, 3), any integers, "
          "counter-clockwise seen from outside. ValueError, naming the first offender, for indices out of range and "
          "used positions that are not finite.")
      .def_static(
          "of", [](MeshGiven given) { return Mesh(*kept_mesh_of(given)); }, nb::arg("mesh"),
          "A copy of anything that is a mesh: with vertices and faces (trimesh), a meshio.Mesh of triangles, a tuple "
          "of arrays.")
      .def_prop_ro(
          "positions", [](nb::handle self) { return points(nb::cast<Mesh&>(self).positions, self); },
          "(vertices, 3) float64, read-only; no copy.")
      .def_prop_ro(
          "facets", [](nb::handle self) { return triples(nb::cast<Mesh&>(self).facets, self); },
          "(facets, 3) uint32, read-only; no copy.")
      .def_prop_ro(
          "vertices", [](nb::handle self) { return points(nb::cast<Mesh&>(self).positions, self); },
          "The positions, as other packages call them.")
      .def_prop_ro(
          "faces", [](nb::handle self) { return triples(nb::cast<Mesh&>(self).facets, self); },
          "The facets, as other packages call them.")
      .def_prop_ro("vertex_count", &Mesh::vertex_count)
      .def_prop_ro("facet_count", &Mesh::facet_count)
      .def(
          "hash", [](const Mesh& self) { return mesh_hash(self); }, doc::mesh_hash)
      .def(
          "__eq__",
          [](const Mesh& a, nb::handle other) {
            if (!nb::isinstance<Mesh>(other)) return false;
            const Mesh& b = nb::cast<const Mesh&>(other);
            return a.positions == b.positions && a.facets == b.facets;
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const Mesh& self) { return static_cast<std::int64_t>(mesh_hash(self) >> 1); })
      .def(
          "__copy__", [](nb::handle self) { return nb::borrow(self); }, nb::sig("def __copy__(self) -> Mesh"))
      .def(
          "__deepcopy__", [](nb::handle self, nb::handle) { return nb::borrow(self); }, nb::arg("memo"),
          nb::sig("def __deepcopy__(self, memo: object) -> Mesh"))
      .def(
          "__reduce__",
          [](nb::handle self) {
            return nb::make_tuple(self.type(), nb::make_tuple(self.attr("positions"), self.attr("facets")));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__", [](const Mesh& self) {
        return "<morula.Mesh: " + std::to_string(self.vertex_count()) + " vertices, " +
               std::to_string(self.facet_count()) + " facets>";
      });

  m.def(
      "sample_body_names",
      [] { return std::vector<std::string>(sample_body_names().begin(), sample_body_names().end()); },
      doc::sample_body_names);
  m.def(
      "sample_body",
      [](std::string_view name, int resolution) { return without_gil([&] { return sample_body(name, resolution); }); },
      nb::arg("name"), nb::arg("resolution") = 48, doc::sample_body);
}

static std::vector<std::uint32_t> labels_of(nb::handle given) {
  return given.is_none() ? std::vector<std::uint32_t>{} : indices_of(given, "labels");
}

static void bind_weld(nb::module_& m) {
  Record<MeshWeld>(m, "MeshWeld", doc::MeshWeld)
      .property(
          "new_vertex", [](const MeshWeld& w) { return own_indices(std::vector(w.new_vertex)); },
          doc::MeshWeld_new_vertex)
      .property(
          "old_vertex", [](const MeshWeld& w) { return own_indices(std::vector(w.old_vertex)); },
          doc::MeshWeld_old_vertex)
      .field("kept_apart", &MeshWeld::kept_apart, doc::MeshWeld_kept_apart)
      .property(
          "merged_count", [](const MeshWeld& w) { return w.merged_count(); }, doc::MeshWeld_merged_count);
  m.def(
      "weld_vertices",
      [](MeshGiven given, nb::handle labels) {
        const auto mesh = mesh_of(given);
        const std::vector<std::uint32_t> numbers = labels_of(labels);
        return without_gil([&] { return weld_vertices(*mesh, numbers); });
      },
      nb::arg("mesh"), nb::arg("labels") = nb::none(),
      nb::sig("def weld_vertices(mesh: morula.typing.MeshLike, labels: morula.typing.Array | None = None) -> "
              "MeshWeld"),
      doc::weld_vertices);
  m.def(
      "welded",
      [](MeshGiven given, const MeshWeld& weld) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return welded(*mesh, weld); });
      },
      nb::arg("mesh"), nb::arg("weld"), doc::welded);
  m.def(
      "welded_positions",
      [](ArrayGiven given, const MeshWeld& weld) {
        return own_points(welded_positions(points_of(given.object, "positions"), weld));
      },
      nb::arg("positions"), nb::arg("weld"), doc::welded_positions);
}

void bind_reports(nb::module_& m) {
  bind_weld(m);

  Record<MeshReport>(m, "MeshReport", doc::MeshReport)
      .field("vertex_count", &MeshReport::vertex_count)
      .field("facet_count", &MeshReport::facet_count)
      .field("component_count", &MeshReport::component_count, doc::MeshReport_component_count)
      .field("boundary_edges", &MeshReport::boundary_edges, doc::MeshReport_boundary_edges)
      .field("nonmanifold_edges", &MeshReport::nonmanifold_edges, doc::MeshReport_nonmanifold_edges)
      .field("misoriented_edges", &MeshReport::misoriented_edges, doc::MeshReport_misoriented_edges)
      .field("nonmanifold_vertices", &MeshReport::nonmanifold_vertices, doc::MeshReport_nonmanifold_vertices)
      .field("degenerate_facets", &MeshReport::degenerate_facets, doc::MeshReport_degenerate_facets)
      .field("duplicate_facets", &MeshReport::duplicate_facets, doc::MeshReport_duplicate_facets)
      .field("duplicate_vertices", &MeshReport::duplicate_vertices, doc::MeshReport_duplicate_vertices)
      .field("unused_vertices", &MeshReport::unused_vertices, doc::MeshReport_unused_vertices)
      .field("closed", &MeshReport::closed, doc::MeshReport_closed)
      .field("oriented", &MeshReport::oriented, doc::MeshReport_oriented)
      .field("manifold", &MeshReport::manifold, doc::MeshReport_manifold)
      .property(
          "box", [](const MeshReport& r) { return std::make_tuple(r.box.lower, r.box.upper); },
          "Lower and upper corner.")
      .field("area", &MeshReport::area)
      .field("volume", &MeshReport::volume, doc::MeshReport_volume)
      .property(
          "has_volume", [](const MeshReport& r) { return r.has_volume(); }, doc::MeshReport_has_volume);
  m.def(
      "inspect",
      [](MeshGiven given) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return inspect(*mesh); });
      },
      nb::arg("mesh"), doc::inspect);

  Record<RepairReport>(m, "RepairReport", "What repair() did.")
      .field("merged_vertices", &RepairReport::merged_vertices)
      .field("collapsed_facets", &RepairReport::collapsed_facets, doc::RepairReport_collapsed_facets)
      .field("degenerate_facets", &RepairReport::degenerate_facets, doc::RepairReport_degenerate_facets)
      .field("turned_facets", &RepairReport::turned_facets, doc::RepairReport_turned_facets)
      .field("unorientable_pieces", &RepairReport::unorientable_pieces, doc::RepairReport_unorientable_pieces)
      .field("capped_holes", &RepairReport::capped_holes)
      .field("cap_facets", &RepairReport::cap_facets, doc::RepairReport_cap_facets)
      .field("open_holes", &RepairReport::open_holes, doc::RepairReport_open_holes)
      .property(
          "new_vertex", [](const RepairReport& r) { return own_indices(std::vector(r.new_vertex)); },
          doc::RepairReport_new_vertex)
      .property(
          "old_vertex", [](const RepairReport& r) { return own_indices(std::vector(r.old_vertex)); },
          doc::RepairReport_old_vertex)
      .property("changed", [](const RepairReport& r) { return r.changed(); });
  m.def(
      "repair",
      [](MeshGiven given, std::optional<double> merge_distance, bool remove_degenerate, bool orient,
         std::size_t cap_edges, nb::handle labels) {
        const auto mesh = mesh_of(given);
        const std::vector<std::uint32_t> numbers = labels_of(labels);
        const RepairOptions options{merge_distance, remove_degenerate, orient, cap_edges, numbers};
        RepairedMesh repaired = without_gil([&] { return repair(*mesh, options); });
        return std::make_tuple(std::move(repaired.mesh), std::move(repaired.report));
      },
      nb::arg("mesh"), nb::kw_only(), nb::arg("merge_distance") = 0.0, nb::arg("remove_degenerate") = false,
      nb::arg("orient") = true, nb::arg("cap_edges") = 0, nb::arg("labels") = nb::none(),
      nb::sig("def repair(mesh: morula.typing.MeshLike, *, merge_distance: float | None = 0.0, remove_degenerate: bool "
              "= False, orient: bool = True, cap_edges: int = 0, labels: morula.typing.Array | None = None) -> "
              "tuple[Mesh, RepairReport]"),
      with_arguments(doc::repair, {{"merge_distance", doc::RepairOptions_merge_distance},
                                   {"remove_degenerate", doc::RepairOptions_remove_degenerate},
                                   {"orient", doc::RepairOptions_orient},
                                   {"cap_edges", doc::RepairOptions_cap_edges},
                                   {"labels", doc::RepairOptions_labels}})
          .c_str());
}

void bind_points(nb::module_& m) {
  m.def(
      "bounding_box",
      [](MeshGiven given) {
        const Box box = bounding_box(*mesh_of(given));
        return std::make_tuple(box.lower, box.upper);
      },
      nb::arg("mesh"), doc::bounding_box);
  m.def(
      "surface_area", [](MeshGiven given) { return surface_area(*mesh_of(given)); }, nb::arg("mesh"),
      "Area of all facets, mesh units squared.");
  m.def(
      "signed_volume", [](MeshGiven given) { return signed_volume(*mesh_of(given)); }, nb::arg("mesh"),
      doc::signed_volume);
  m.def(
      "mesh_hash", [](MeshGiven given) { return mesh_hash(*mesh_of(given)); }, nb::arg("mesh"), doc::mesh_hash);
  m.def(
      "sample_surface",
      [](MeshGiven given, std::size_t count, std::uint64_t seed) {
        const auto mesh = mesh_of(given);
        std::vector<SurfacePoint> found = without_gil([&] { return sample_surface(*mesh, count, seed); });
        std::vector<Vec3> points;
        std::vector<std::uint32_t> facets;
        for (const SurfacePoint& p : found) {
          points.push_back(p.point);
          facets.push_back(p.facet);
        }
        return std::make_tuple(own_points(std::move(points)), own_indices(std::move(facets)));
      },
      nb::arg("mesh"), nb::arg("count"), nb::arg("seed") = 1,
      (std::string(doc::sample_surface) + "\n\nReturns points (count, 3) and their facets (count,).").c_str());
  m.def(
      "fibonacci_directions", [](std::size_t count) { return own_points(fibonacci_directions(count)); },
      nb::arg("count"), doc::fibonacci_directions);
  m.def(
      "enclosing_sphere",
      [](ArrayGiven given) {
        const std::vector<Vec3> points = points_of(given.object, "points");
        return without_gil([&] { return enclosing_sphere(points); });
      },
      nb::arg("points"), doc::enclosing_sphere);
  m.def(
      "enclosing_sphere_of_spheres",
      [](ArrayGiven given) {
        const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
        return without_gil([&] { return enclosing_sphere_of_spheres(spheres); });
      },
      nb::arg("spheres"), doc::enclosing_sphere_of_spheres);
}

std::array<double, 16> matrix_of(const RigidTransform& t) {
  std::array<double, 16> matrix{};
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) matrix[4 * row + k] = t.rows[row][k];
    matrix[4 * row + 3] = t.translation[row];
  }
  matrix[15] = 1;
  return matrix;
}

void bind_transform(nb::module_& m) {
  nb::class_<RigidTransform>(m, "RigidTransform", doc::RigidTransform)
      .def(nb::init<>())
      .def(
          "__init__",
          [](RigidTransform* self, Vec3 translation) {
            new (self) RigidTransform();
            self->translation = translation;
          },
          nb::kw_only(), nb::arg("translation"), "A translation, mesh units.")
      .def(
          "__init__",
          [](RigidTransform* self, ArrayGiven matrix) {
            new (self) RigidTransform(matrix_transform(matrix.object, "matrix"));
          },
          nb::arg("matrix"), "A (4, 4) or (3, 4) matrix that acts on columns.")
      .def_static("from_quaternion", &RigidTransform::from_quaternion, nb::arg("w"), nb::arg("x"), nb::arg("y"),
                  nb::arg("z"), nb::arg("translation") = Vec3{}, doc::RigidTransform_from_quaternion)
      .def_static("from_axis", &RigidTransform::from_axis, nb::arg("axis"), nb::arg("angle_radians"),
                  nb::arg("translation") = Vec3{}, doc::RigidTransform_from_axis)
      .def_ro("translation", &RigidTransform::translation)
      .def_prop_ro(
          "matrix",
          [](const RigidTransform& self) {
            const auto numbers = matrix_of(self);
            auto [values, owner] = kept(std::vector<double>(numbers.begin(), numbers.end()));
            return Copy<double, 4, 4>(values->data(), {4, 4}, owner);
          },
          nb::rv_policy::automatic, "(4, 4) float64.")
      .def(
          "__call__", [](const RigidTransform& self, Vec3 p) { return self(p); }, nb::arg("point"))
      .def("inverse", [](const RigidTransform& self) { return inverse(self); })
      .def(
          "rotate", [](const RigidTransform& self, Vec3 v) { return self.rotate(v); }, nb::arg("v"),
          "The rotation alone: of a direction.")
      .def(
          "inverse_rotate", [](const RigidTransform& self, Vec3 v) { return self.inverse_rotate(v); }, nb::arg("v"),
          doc::RigidTransform_inverse_rotate)
      .def(
          "__eq__",
          [](const RigidTransform& a, nb::handle other) {
            return nb::isinstance<RigidTransform>(other) && a == nb::cast<const RigidTransform&>(other);
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def(
          "__reduce__",
          [](nb::handle self) { return nb::make_tuple(self.type(), nb::make_tuple(self.attr("matrix"))); },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__", [](nb::handle self) {
        return "RigidTransform(" + nb::cast<std::string>(nb::repr(self.attr("matrix").attr("tolist")())) + ")";
      });
  m.def("deviation_from_rigid", &deviation_from_rigid, nb::arg("t"), doc::deviation_from_rigid);
  m.attr("largest_rigid_deviation") = largest_rigid_deviation;
  m.def("orthonormalized", &orthonormalized, nb::arg("t"), doc::orthonormalized);
  m.attr("largest_float_deviation") = largest_float_deviation;
  m.def("relative_to", &relative_to, nb::arg("base"), nb::arg("p"), doc::relative_to);
}

}  // namespace

void bind_meshes(nb::module_& m) {
  bind_mesh(m);
  bind_reports(m);
  bind_points(m);
  bind_transform(m);
}

}  // namespace morula::python
