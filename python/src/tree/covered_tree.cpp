// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees with their covers.
#include <morula/morula.hpp>

#include "faults.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void bind_covered_tree(nb::module_& m) {
  nb::class_<KnownPose>(m, "KnownPose", doc::KnownPose)
      .def(
          "__init__",
          [](KnownPose* self, std::string name, ArrayGiven positions, const CoveredTree& model) {
            // A copy: trees share it, and the collector of cycles could not tell whose it is.
            new (self) KnownPose{std::move(name), points_of(positions.object, "positions"),
                                 std::make_shared<const CoveredTree>(model)};
          },
          nb::arg("name"), nb::arg("positions"), nb::arg("model"))
      .def_ro("name", &KnownPose::name)
      .def_prop_ro(
          "positions", [](nb::handle self) { return points(nb::cast<KnownPose&>(self).positions, self); },
          doc::KnownPose_positions)
      .def_prop_ro(
          "model", [](const KnownPose& self) { return std::const_pointer_cast<CoveredTree>(self.model); },
          doc::KnownPose_model)
      .def(
          "__reduce__",
          [](nb::handle self) {
            return nb::make_tuple(self.type(),
                                  nb::make_tuple(self.attr("name"), self.attr("positions"), self.attr("model")));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));

  nb::class_<CoveredTree>(m, "CoveredTree", nb::dynamic_attr(), "A sphere tree with its proof: tree, cover, report.")
      .def(
          "__init__",
          [](CoveredTree* self, const SphereTree& tree, const Cover& cover, std::optional<BuildReport> report,
             std::vector<KnownPose> poses) {
            if (auto faults = validate(tree); !faults.empty()) throw std::invalid_argument("tree: " + joined(faults));
            if (auto faults = validate(tree, cover); !faults.empty())
              throw std::invalid_argument("cover: " + joined(faults));
            new (self) CoveredTree{tree, cover, report.value_or(BuildReport{}), std::move(poses)};
          },
          nb::arg("tree"), nb::arg("cover"), nb::arg("report") = nb::none(),
          nb::arg("poses") = std::vector<KnownPose>{},
          "ValueError, with the fault, if the arrays of tree and cover do not agree.")
      .def_prop_ro(
          "tree", [](CoveredTree& self) -> SphereTree& { return self.tree; }, nb::rv_policy::reference_internal,
          "The SphereTree.")
      .def_prop_ro(
          "cover", [](CoveredTree& self) -> Cover& { return self.cover; }, nb::rv_policy::reference_internal,
          "The part of the surface that each node owns.")
      .def_prop_ro(
          "report", [](const CoveredTree& self) { return self.report; }, doc::BuildReport)
      .def_prop_ro(
          "poses", [](const CoveredTree& self) { return self.poses; }, doc::CoveredTree_poses)
      .def_prop_ro(
          "spheres", [](nb::handle self) { return sphere_rows(nb::cast<CoveredTree&>(self).tree.spheres, self); },
          "(nodes, 4) float64: those of the tree.")
      .def_prop_ro("level_count", [](const CoveredTree& self) { return self.tree.level_count(); })
      .def(
          "level",
          [](const CoveredTree& self, std::size_t level) { return own_spheres(level_set_spheres(self.tree, level)); },
          nb::arg("level"), "The spheres that cover the surface at this level, (n, 4) float64.")
      .def(
          "validate",
          [](const CoveredTree& self, MeshGiven given) {
            const auto mesh = mesh_of(given);
            return without_gil([&] { return validate(*mesh, self); });
          },
          nb::arg("mesh"), doc::validate_2)
      .def("__len__", [](const CoveredTree& self) { return self.tree.node_count(); })
      .def(
          "__eq__",
          [](nb::handle a, nb::handle b) {
            if (!nb::isinstance<CoveredTree>(b)) return false;
            return a.attr("tree").equal(b.attr("tree")) && a.attr("cover").equal(b.attr("cover")) &&
                   a.attr("report").attr("mesh_hash").equal(b.attr("report").attr("mesh_hash"));
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const CoveredTree& self) { return static_cast<std::int64_t>(tree_hash(self.tree) >> 1); })
      .def("__copy__", [](const CoveredTree& self) { return std::make_shared<CoveredTree>(self); })
      .def(
          "__deepcopy__", [](const CoveredTree& self, nb::handle) { return std::make_shared<CoveredTree>(self); },
          nb::arg("memo"), nb::sig("def __deepcopy__(self, memo: object) -> CoveredTree"))
      .def(
          "__reduce__",
          [](nb::handle self) {
            return nb::make_tuple(self.type(), nb::make_tuple(self.attr("tree"), self.attr("cover"),
                                                              self.attr("report"), self.attr("poses")));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__",
           [](const CoveredTree& self) {
             return "<morula.CoveredTree: " + std::to_string(self.tree.node_count()) + " nodes, " +
                    std::to_string(self.tree.level_count()) + " levels, by " + self.report.method + ">";
           })
      .def("_repr_html_", [](nb::handle self) {
        return nb::cast<std::string>(nb::module_::import_("morula.display").attr("tree_html")(self));
      });

  m.def(
      "cover",
      [](MeshGiven given, const SphereTree& tree, std::optional<bool> nested, Threads* workers) {
        const auto mesh = mesh_of(given);
        return without_gil([&] {
          CallWorkers call(workers);
          return std::make_shared<CoveredTree>(cover(*mesh, tree, {.nested = nested.value_or(false)}, call));
        });
      },
      nb::arg("mesh"), nb::arg("tree"), nb::kw_only(), nb::arg("nested") = nb::none(), nb::arg("workers") = nb::none(),
      with_arguments(doc::cover, {{"nested", doc::CoverOptions_nested}}).c_str());
  m.def(
      "with_fewer_cuts",
      [](MeshGiven given, const CoveredTree& model, Threads* workers) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return with_fewer_cuts(*mesh, model, CallWorkers(workers)); });
      },
      nb::arg("mesh"), nb::arg("model"), nb::arg("workers") = nb::none(), doc::with_fewer_cuts);

  Record<Certificate>(m, "Certificate", "The result of certify(). True if the surface is covered.")
      .field("covered", &Certificate::covered)
      .field("worst_excess", &Certificate::worst_excess, doc::Certificate_worst_excess)
      .field("worst_node", &Certificate::worst_node)
      .python()
      .def("__bool__", [](const Certificate& c) { return c.covered; });
  m.def(
      "certify",
      [](const Cover& cover, PositionsGiven given, ArrayGiven rows, Threads* workers) {
        const Positions positions(given.object, "positions");
        const std::vector<Sphere> spheres = spheres_of(rows.object, "spheres");
        require_rows(positions.view().size(), cover.vertex_count, "positions", 3, "the cover's vertices");
        require_rows(spheres.size(), cover.region_begin.size(), "spheres", 4, "the cover's nodes");
        return without_gil([&] { return certify(cover, positions.view(), spheres, CallWorkers(workers)); });
      },
      nb::arg("cover"), nb::arg("positions"), nb::arg("spheres"), nb::arg("workers") = nb::none(), doc::certify);
  m.def(
      "leaf_order", [](const CoveredTree& model) { return own_indices(leaf_order(model)); }, nb::arg("model"),
      doc::leaf_order);
  m.def(
      "renumbered",
      [](const CoveredTree& model, MeshGiven given, ArrayGiven rows) {
        const std::vector<std::uint32_t> order = indices_of(rows.object, "order");
        auto mesh = std::make_shared<Mesh>(renumbered(*mesh_of(given), order));
        auto tree = std::make_shared<CoveredTree>(renumbered(model, *mesh, order));
        return std::make_pair(mesh, tree);
      },
      nb::arg("model"), nb::arg("mesh"), nb::arg("order"),
      (std::string("Mesh and model with renumbered vertices. ") + doc::renumbered).c_str());
}

}  // namespace morula::python
