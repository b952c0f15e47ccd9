// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere trees.
#include <morula/morula.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <utility>

#include "faults.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void bind_sphere_tree(nb::module_& m) {
  m.attr("no_node") = no_node;
  m.attr("max_branching") = max_branching;
  m.attr("max_depth") = max_depth;
  nb::class_<SphereTree>(m, "SphereTree", doc::SphereTree)
      .def(
          "__init__",
          [](SphereTree* self, ArrayGiven spheres, ArrayGiven first_child, ArrayGiven child_count, ArrayGiven parent,
             ArrayGiven level_begin, std::uint32_t branching, bool nested) {
            SphereTree tree;
            tree.spheres = spheres_of(spheres.object, "spheres");
            tree.first_child = indices_of(first_child.object, "first_child");
            tree.child_count = indices_of(child_count.object, "child_count");
            tree.parent = indices_of(parent.object, "parent");
            tree.level_begin = indices_of(level_begin.object, "level_begin");
            tree.branching = branching;
            tree.nested = nested;
            if (const auto faults = validate(tree); !faults.empty()) throw std::invalid_argument(joined(faults));
            new (self) SphereTree(std::move(tree));
          },
          nb::arg("spheres"), nb::arg("first_child"), nb::arg("child_count"), nb::arg("parent"), nb::arg("level_begin"),
          nb::arg("branching") = 8, nb::arg("nested") = false,
          "A tree of these arrays, copied. ValueError, with the fault, for arrays that are not a tree.")
      .def_prop_ro(
          "spheres", [](nb::handle self) { return sphere_rows(nb::cast<SphereTree&>(self).spheres, self); },
          "(nodes, 4) float64: x, y, z, radius in mesh units, read-only; no copy.")
      .def_prop_ro(
          "first_child", [](nb::handle self) { return indices(nb::cast<SphereTree&>(self).first_child, self); },
          "(nodes,) uint32; morula.no_node for a leaf.")
      .def_prop_ro(
          "child_count", [](nb::handle self) { return indices(nb::cast<SphereTree&>(self).child_count, self); },
          doc::SphereTree_child_count)
      .def_prop_ro(
          "parent", [](nb::handle self) { return indices(nb::cast<SphereTree&>(self).parent, self); },
          "(nodes,) uint32; morula.no_node for the root.")
      .def_prop_ro(
          "level_begin", [](nb::handle self) { return indices(nb::cast<SphereTree&>(self).level_begin, self); },
          doc::SphereTree_level_begin)
      .def_ro("branching", &SphereTree::branching, doc::SphereTree_branching)
      .def_ro("nested", &SphereTree::nested, doc::SphereTree_nested)
      .def_prop_ro("node_count", &SphereTree::node_count)
      .def_prop_ro("level_count", &SphereTree::level_count, doc::SphereTree_level_count)
      .def_prop_ro("leaf_count", &SphereTree::leaf_count)
      .def(
          "is_leaf",
          [](const SphereTree& self, std::uint32_t node) {
            if (node >= self.node_count()) throw nb::index_error("node");
            return self.is_leaf(node);
          },
          nb::arg("node"))
      .def(
          "level_of",
          [](const SphereTree& self, std::uint32_t node) {
            if (node >= self.node_count()) throw nb::index_error("node");
            return self.level_of(node);
          },
          nb::arg("node"))
      .def(
          "level_set", [](const SphereTree& self, std::size_t level) { return own_indices(level_set(self, level)); },
          nb::arg("level"), doc::level_set)
      .def(
          "level_set_spheres",
          [](const SphereTree& self, std::size_t level) { return own_spheres(level_set_spheres(self, level)); },
          nb::arg("level"), "The spheres of level set `level`, (n, 4) float64.")
      .def(
          "level",
          [](const SphereTree& self, std::size_t level) { return own_spheres(level_set_spheres(self, level)); },
          nb::arg("level"), "The spheres that cover the surface at this level: level_set_spheres().")
      .def(
          "validate", [](const SphereTree& self) { return validate(self); }, doc::validate_3)
      .def(
          "hash", [](const SphereTree& self) { return tree_hash(self); }, doc::tree_hash)
      .def("__len__", &SphereTree::node_count)
      .def(
          "__eq__",
          [](const SphereTree& a, nb::handle other) {
            if (!nb::isinstance<SphereTree>(other)) return false;
            const SphereTree& b = nb::cast<const SphereTree&>(other);
            return a.spheres == b.spheres && a.first_child == b.first_child && a.child_count == b.child_count &&
                   a.parent == b.parent && a.level_begin == b.level_begin && a.branching == b.branching &&
                   a.nested == b.nested;
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const SphereTree& self) { return static_cast<std::int64_t>(tree_hash(self) >> 1); })
      .def("__copy__", [](const SphereTree& self) { return SphereTree(self); })
      .def(
          "__deepcopy__", [](const SphereTree& self, nb::handle) { return SphereTree(self); }, nb::arg("memo"),
          nb::sig("def __deepcopy__(self, memo: object) -> SphereTree"))
      .def(
          "__reduce__",
          [](nb::handle self) {
            return nb::make_tuple(
                self.type(), nb::make_tuple(self.attr("spheres"), self.attr("first_child"), self.attr("child_count"),
                                            self.attr("parent"), self.attr("level_begin"), self.attr("branching"),
                                            self.attr("nested")));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__", [](const SphereTree& self) {
        return "<morula.SphereTree: " + std::to_string(self.node_count()) + " nodes, " +
               std::to_string(self.level_count()) + " levels, branching " + std::to_string(self.branching) + ">";
      });
  m.def(
      "level_set", [](const SphereTree& tree, std::size_t level) { return own_indices(level_set(tree, level)); },
      nb::arg("tree"), nb::arg("level"), doc::level_set);
  m.def(
      "tree_from_spheres",
      [](ArrayGiven balls, std::uint32_t branching) {
        const std::vector<Sphere> spheres = spheres_of(balls.object, "balls");
        return without_gil([&] { return tree_from_spheres(spheres, branching); });
      },
      nb::arg("balls"), nb::arg("branching") = 8, doc::tree_from_spheres);
  Record<Nesting>(m, "Nesting", doc::Nesting)
      .field("nested", &Nesting::nested)
      .field("outside", &Nesting::outside, doc::Nesting_outside)
      .field("worst_excess", &Nesting::worst_excess, doc::Nesting_worst_excess)
      .field("worst_node", &Nesting::worst_node, doc::Nesting_worst_node);
  m.def(
      "certify_nesting",
      [](const SphereTree& tree, std::optional<ArrayGiven> given) {
        const std::vector<Sphere> spheres =
            given && !given->object.is_none() ? spheres_of(given->object, "spheres") : tree.spheres;
        return without_gil([&] { return certify_nesting(tree, spheres); });
      },
      nb::arg("tree"), nb::arg("spheres") = nb::none(), doc::certify_nesting);
  m.def(
      "reduced",
      [](const SphereTree& tree, double length) { return without_gil([&] { return reduced(tree, length); }); },
      nb::arg("tree"), nb::arg("length"),
      "The tree with smaller radii: each radius less `length` (mesh units, 0 or more), at least 0, rounded up. If a "
      "level "
      "covers a surface, every point of the surface lies within `length` of the reduced level.");
  m.def(
      "make_nested",
      [](const SphereTree& tree) {
        SphereTree nested = tree;
        without_gil([&] { make_nested(nested); });
        return nested;
      },
      nb::arg("tree"), (std::string("A copy that is nested. ") + doc::make_nested).c_str());
}

}  // namespace morula::python
