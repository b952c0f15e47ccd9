// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere trees, covers and their certificates.
#include <morula/morula.hpp>
#include <morula/tree/ball_tree.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

std::string joined(const std::vector<std::string>& faults) {
  std::string all;
  for (const std::string& fault : faults) all += (all.empty() ? "" : "; ") + fault;
  return all;
}

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
          "Of its arrays, copied. ValueError, with what is wrong, for arrays that are no tree.")
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
      "tree_over_balls",
      [](ArrayGiven balls, std::uint32_t branching) {
        const std::vector<Sphere> spheres = spheres_of(balls.object, "balls");
        return without_gil([&] { return tree_over_balls(spheres, branching); });
      },
      nb::arg("balls"), nb::arg("branching") = 8, doc::tree_over_balls);
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
      "nest",
      [](const SphereTree& tree) {
        SphereTree nested = tree;
        without_gil([&] { nest(nested); });
        return nested;
      },
      nb::arg("tree"), (std::string("A copy that is nested. ") + doc::nest).c_str());
}

using CoverArrays = std::tuple<std::uint32_t, std::uint32_t>;

void bind_cover(nb::module_& m) {
  nb::class_<Cover>(m, "Cover", doc::Cover)
      .def(
          "__init__",
          [](Cover* self, std::uint32_t vertex_count, std::uint32_t facet_count, ArrayGiven cut_vertices,
             ArrayGiven cut_weights, ArrayGiven patch_facet, ArrayGiven corner_begin, ArrayGiven corners,
             ArrayGiven region_begin, ArrayGiven region_end) {
            Cover cover;
            cover.vertex_count = vertex_count;
            cover.facet_count = facet_count;
            const auto vertices = facets_of(cut_vertices.object, "cut_vertices");
            const auto weights = points_of(cut_weights.object, "cut_weights");
            if (vertices.size() != weights.size()) throw std::invalid_argument("cut_weights: one row per cut point");
            for (std::size_t i = 0; i < vertices.size(); ++i) {
              cover.cut_points.push_back({vertices[i], {weights[i].x, weights[i].y, weights[i].z}});
            }
            cover.patch_facet = indices_of(patch_facet.object, "patch_facet");
            cover.corner_begin = indices_of(corner_begin.object, "corner_begin");
            cover.corners = indices_of(corners.object, "corners");
            cover.region_begin = indices_of(region_begin.object, "region_begin");
            cover.region_end = indices_of(region_end.object, "region_end");
            new (self) Cover(std::move(cover));
          },
          nb::arg("vertex_count"), nb::arg("facet_count"), nb::arg("cut_vertices"), nb::arg("cut_weights"),
          nb::arg("patch_facet"), nb::arg("corner_begin"), nb::arg("corners"), nb::arg("region_begin"),
          nb::arg("region_end"), "Of its arrays, copied; CoveredTree checks them.")
      .def_ro("vertex_count", &Cover::vertex_count, doc::Cover_vertex_count)
      .def_ro("facet_count", &Cover::facet_count)
      .def_prop_ro("patch_count", &Cover::patch_count)
      .def_prop_ro(
          "cut_vertices",
          [](nb::handle self) {
            const Cover& cover = nb::cast<const Cover&>(self);
            const std::size_t shape[]{cover.cut_points.size(), 3};
            const std::int64_t strides[]{sizeof(CutPoint) / sizeof(std::uint32_t), 1};
            return IndexTriples(reinterpret_cast<const std::uint32_t*>(cover.cut_points.data()), 2, shape, self,
                                strides);
          },
          "(cut points, 3) uint32: the vertices of every cut point.")
      .def_prop_ro(
          "cut_weights",
          [](nb::handle self) {
            const Cover& cover = nb::cast<const Cover&>(self);
            return column3(std::span<const CutPoint>(cover.cut_points),
                           cover.cut_points.empty() ? nullptr : &cover.cut_points[0].weight, self);
          },
          "(cut points, 3) float64: their weights.")
      .def_prop_ro(
          "patch_facet", [](nb::handle self) { return indices(nb::cast<Cover&>(self).patch_facet, self); },
          doc::Cover_patch_facet)
      .def_prop_ro(
          "corner_begin", [](nb::handle self) { return indices(nb::cast<Cover&>(self).corner_begin, self); },
          doc::Cover_corner_begin)
      .def_prop_ro(
          "corners", [](nb::handle self) { return indices(nb::cast<Cover&>(self).corners, self); }, doc::Cover_corners)
      .def_prop_ro(
          "region_begin", [](nb::handle self) { return indices(nb::cast<Cover&>(self).region_begin, self); },
          doc::Cover_region_begin)
      .def_prop_ro("region_end", [](nb::handle self) { return indices(nb::cast<Cover&>(self).region_end, self); })
      .def(
          "__eq__",
          [](const Cover& a, nb::handle other) {
            if (!nb::isinstance<Cover>(other)) return false;
            const Cover& b = nb::cast<const Cover&>(other);
            return a.vertex_count == b.vertex_count && a.facet_count == b.facet_count && a.cut_points == b.cut_points &&
                   a.patch_facet == b.patch_facet && a.corner_begin == b.corner_begin && a.corners == b.corners &&
                   a.region_begin == b.region_begin && a.region_end == b.region_end;
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def(
          "__reduce__",
          [](nb::handle self) {
            return nb::make_tuple(
                self.type(),
                nb::make_tuple(self.attr("vertex_count"), self.attr("facet_count"), self.attr("cut_vertices"),
                               self.attr("cut_weights"), self.attr("patch_facet"), self.attr("corner_begin"),
                               self.attr("corners"), self.attr("region_begin"), self.attr("region_end")));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__", [](const Cover& self) {
        return "<morula.Cover: " + std::to_string(self.patch_count()) + " patches of " +
               std::to_string(self.facet_count) + " facets, " + std::to_string(self.cut_points.size()) + " cut points>";
      });

  Record<LevelGrowth>(m, "LevelGrowth", "What had to grow on a level for an imported tree to cover.")
      .field("grown", &LevelGrowth::grown, doc::LevelGrowth_grown)
      .field("largest_factor", &LevelGrowth::largest_factor, doc::LevelGrowth_largest_factor)
      .field("largest_growth", &LevelGrowth::largest_growth, doc::LevelGrowth_largest_growth);
  Record<BuildReport> report(m, "BuildReport", doc::BuildReport);
  report.field("method", &BuildReport::method, doc::BuildReport_method)
      .field("branching", &BuildReport::branching)
      .field("depth", &BuildReport::depth, doc::BuildReport_depth)
      .field("seed", &BuildReport::seed)
      .field("mesh_hash", &BuildReport::mesh_hash)
      .field("growth", &BuildReport::growth, doc::BuildReport_growth)
      .field("early_leaves", &BuildReport::early_leaves, doc::BuildReport_early_leaves)
      .field("leftover_patches", &BuildReport::leftover_patches, doc::BuildReport_leftover_patches)
      .field("dropped_spheres", &BuildReport::dropped_spheres, doc::BuildReport_dropped_spheres)
      .field("notes", &BuildReport::notes, doc::BuildReport_notes)
      .field("complete", &BuildReport::complete, doc::BuildReport_complete)
      .field("level_seconds", &BuildReport::level_seconds, doc::BuildReport_level_seconds)
      .field("protrusion_bound", &BuildReport::protrusion_bound, doc::BuildReport_protrusion_bound);
  using Growth = std::vector<std::tuple<std::size_t, double, double>>;
  using ReportState =
      std::tuple<std::string, std::uint32_t, std::uint32_t, std::uint64_t, std::uint64_t, Growth, std::size_t,
                 std::size_t, std::size_t, std::vector<std::string>, bool, std::vector<double>, std::optional<double>>;
  report.python()
      .def("__getstate__",
           [](const BuildReport& r) {
             Growth growth;
             for (const LevelGrowth& g : r.growth) growth.emplace_back(g.grown, g.largest_factor, g.largest_growth);
             return ReportState(r.method, r.branching, r.depth, r.seed, r.mesh_hash, growth, r.early_leaves,
                                r.leftover_patches, r.dropped_spheres, r.notes, r.complete, r.level_seconds,
                                r.protrusion_bound);
           })
      .def("__setstate__", [](BuildReport& self, const ReportState& s) {
        new (&self) BuildReport();
        Growth growth;
        std::tie(self.method, self.branching, self.depth, self.seed, self.mesh_hash, growth, self.early_leaves,
                 self.leftover_patches, self.dropped_spheres, self.notes, self.complete, self.level_seconds,
                 self.protrusion_bound) = s;
        for (const auto& [grown, factor, most] : growth) self.growth.push_back({grown, factor, most});
      });
}

void bind_covered_tree(nb::module_& m) {
  nb::class_<KnownPose>(m, "KnownPose", doc::KnownPose)
      .def(
          "__init__",
          [](KnownPose* self, std::string name, ArrayGiven positions, std::shared_ptr<CoveredTree> built) {
            new (self) KnownPose{std::move(name), points_of(positions.object, "positions"), std::move(built)};
          },
          nb::arg("name"), nb::arg("positions"), nb::arg("built"))
      .def_ro("name", &KnownPose::name)
      .def_prop_ro(
          "positions", [](nb::handle self) { return points(nb::cast<KnownPose&>(self).positions, self); },
          doc::KnownPose_positions)
      .def_prop_ro(
          "built", [](const KnownPose& self) { return std::const_pointer_cast<CoveredTree>(self.built); },
          doc::KnownPose_built)
      .def(
          "__reduce__",
          [](nb::handle self) {
            return nb::make_tuple(self.type(),
                                  nb::make_tuple(self.attr("name"), self.attr("positions"), self.attr("built")));
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
          "ValueError, with what is wrong, where the arrays of tree and cover do not agree.")
      .def_prop_ro(
          "tree", [](CoveredTree& self) -> SphereTree& { return self.tree; }, nb::rv_policy::reference_internal,
          "The SphereTree.")
      .def_prop_ro(
          "cover", [](CoveredTree& self) -> Cover& { return self.cover; }, nb::rv_policy::reference_internal,
          "Which part of the surface each node answers for.")
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
          return std::make_shared<CoveredTree>(nested ? cover(*mesh, tree, CoverOptions{*nested}, call)
                                                      : cover(*mesh, tree, static_cast<Workers&>(call)));
        });
      },
      nb::arg("mesh"), nb::arg("tree"), nb::kw_only(), nb::arg("nested") = nb::none(), nb::arg("workers") = nb::none(),
      with_arguments(doc::cover, {{"nested", doc::CoverOptions_nested}}).c_str());
  m.def(
      "with_fewer_cuts",
      [](MeshGiven given, const CoveredTree& built, Threads* workers) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return with_fewer_cuts(*mesh, built, CallWorkers(workers)); });
      },
      nb::arg("mesh"), nb::arg("built"), nb::arg("workers") = nb::none(), doc::with_fewer_cuts);

  Record<Certificate>(m, "Certificate", "What certify() found. True when all is covered.")
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
        if (positions.view().size() != cover.vertex_count) {
          throw std::invalid_argument("positions: " + std::to_string(positions.view().size()) +
                                      " rows, but the cover is of " + std::to_string(cover.vertex_count) + " vertices");
        }
        if (spheres.size() != cover.region_begin.size()) {
          throw std::invalid_argument("spheres: " + std::to_string(spheres.size()) + " rows, but the cover is of " +
                                      std::to_string(cover.region_begin.size()) + " nodes");
        }
        return without_gil([&] { return certify(cover, positions.view(), spheres, CallWorkers(workers)); });
      },
      nb::arg("cover"), nb::arg("positions"), nb::arg("spheres"), nb::arg("workers") = nb::none(), doc::certify);
  m.def(
      "leaf_order", [](const CoveredTree& built) { return own_indices(leaf_order(built)); }, nb::arg("built"),
      doc::leaf_order);
  m.def(
      "renumbered",
      [](const CoveredTree& built, MeshGiven given, ArrayGiven rows) {
        const std::vector<std::uint32_t> order = indices_of(rows.object, "order");
        auto mesh = std::make_shared<Mesh>(renumbered(*mesh_of(given), order));
        auto tree = std::make_shared<CoveredTree>(renumbered(built, *mesh, order));
        return std::make_pair(mesh, tree);
      },
      nb::arg("built"), nb::arg("mesh"), nb::arg("order"),
      (std::string("Mesh and tree with vertices renumbered. ") + doc::renumbered).c_str());
}

}  // namespace

void bind_tree(nb::module_& m) {
  bind_sphere_tree(m);
  bind_cover(m);
  bind_covered_tree(m);
}

}  // namespace morula::python
