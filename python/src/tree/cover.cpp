// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Covers, and their certificates.
#include <morula/morula.hpp>

#include "faults.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

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
          nb::arg("region_end"), "A cover of these arrays, copied; CoveredTree checks them.")
      .def_ro("vertex_count", &Cover::vertex_count, doc::Cover_vertex_count)
      .def_ro("facet_count", &Cover::facet_count)
      .def_prop_ro("patch_count", &Cover::patch_count)
      .def_prop_ro("most_patches_of_a_facet", &Cover::most_patches_of_a_facet, doc::Cover_most_patches_of_a_facet)
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

  Record<LevelGrowth>(m, "LevelGrowth", "The growth on a level that an imported tree needed to cover.")
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
      .field("most_patches_of_a_facet", &BuildReport::most_patches_of_a_facet, doc::BuildReport_most_patches_of_a_facet)
      .field("complete", &BuildReport::complete, doc::BuildReport_complete)
      .field("level_seconds", &BuildReport::level_seconds, doc::BuildReport_level_seconds)
      .field("protrusion_bound", &BuildReport::protrusion_bound, doc::BuildReport_protrusion_bound);
  using Growth = std::vector<std::tuple<std::size_t, double, double>>;
  using ReportState = std::tuple<std::string, std::uint32_t, std::uint32_t, std::uint64_t, std::uint64_t, Growth,
                                 std::size_t, std::size_t, std::size_t, std::vector<std::string>, std::size_t, bool,
                                 std::vector<double>, std::optional<double>>;
  report.python()
      .def("__getstate__",
           [](const BuildReport& r) {
             Growth growth;
             for (const LevelGrowth& g : r.growth) growth.emplace_back(g.grown, g.largest_factor, g.largest_growth);
             return ReportState(r.method, r.branching, r.depth, r.seed, r.mesh_hash, growth, r.early_leaves,
                                r.leftover_patches, r.dropped_spheres, r.notes, r.most_patches_of_a_facet, r.complete,
                                r.level_seconds, r.protrusion_bound);
           })
      .def("__setstate__", [](BuildReport& self, const ReportState& s) {
        new (&self) BuildReport();
        Growth growth;
        std::tie(self.method, self.branching, self.depth, self.seed, self.mesh_hash, growth, self.early_leaves,
                 self.leftover_patches, self.dropped_spheres, self.notes, self.most_patches_of_a_facet, self.complete,
                 self.level_seconds, self.protrusion_bound) = s;
        for (const auto& [grown, factor, most] : growth) self.growth.push_back({grown, factor, most});
      });
}

}  // namespace morula::python
