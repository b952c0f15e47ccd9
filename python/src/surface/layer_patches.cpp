// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Layer patches as columns: of patches, of both sides, and of points.
#include "layer_patches.hpp"

#include "contacts.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void LayerRegions::add(const LayerSide& side) {
  facets.insert(facets.end(), side.facets.begin(), side.facets.end());
  gradients.insert(gradients.end(), side.gradients.begin(), side.gradients.end());
  facets_begin.push_back(facets.size());
  gradients_begin.push_back(gradients.size());
}

LayerPatches::LayerPatches(const LayerPatchQuery& query)
    : patches(query.patches().begin(), query.patches().end()), volume(query.volume()) {
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    LayerPatch& patch = patches[i];
    a.add(patch.a);
    b.add(patch.b);
    for (const LayerPoint& point : patch.points) points.rows.push_back({i, point});
    patch.a.facets = patch.b.facets = {};
    patch.a.gradients = patch.b.gradients = {};
    patch.points = {};
  }
}

void bind_layer_patch_records(nb::module_& m) {
  Record<LayerRegions>(m, "LayerRegions", "The sides of one surface, of all patches, patch after patch.")
      .property(
          "facet", [](const LayerRegions& r) { return own_indices(std::vector(r.facets)); }, doc::LayerSide_facets)
      .property(
          "facets_begin", [](const LayerRegions& r) { return r.facets_begin; },
          "Patch i has rows facets_begin[i] to facets_begin[i + 1] of `facet`.")
      .property("vertex", MORULA_COLUMN(LayerRegions, gradients, vertex), "(m,) uint32, ascending within a patch.")
      .property("gradient", MORULA_COLUMN3(LayerRegions, gradients, gradient),
                "(m, 3) float64: derivative of the volume of the patch with respect to the vertex, mesh units².")
      .property(
          "gradients_begin", [](const LayerRegions& r) { return r.gradients_begin; },
          "Patch i has rows gradients_begin[i] to gradients_begin[i + 1] of `vertex` and `gradient`.");
  Record<LayerPoints>(m, "LayerPoints", doc::LayerPoint)
      .property("patch", MORULA_COLUMN(LayerPoints, rows, patch), "(n,) uint32: row of the patch.")
      .property("id", MORULA_COLUMN(LayerPoints, rows, point.id), doc::LayerPoint_id)
      .property("point", MORULA_COLUMN3(LayerPoints, rows, point.point), doc::LayerPoint_point)
      .property("force", MORULA_COLUMN3(LayerPoints, rows, point.force), doc::LayerPoint_force)
      .property("volume", MORULA_COLUMN(LayerPoints, rows, point.volume), doc::LayerPoint_volume)
      .property("depth", MORULA_COLUMN(LayerPoints, rows, point.depth), doc::LayerPoint_depth)
      .property("facet_a", MORULA_COLUMN(LayerPoints, rows, point.on_a.facet), "(n,) uint32.")
      .property("facet_b", MORULA_COLUMN(LayerPoints, rows, point.on_b.facet), "(n,) uint32.")
      .property("barycentric_a", MORULA_COLUMN3(LayerPoints, rows, point.on_a.barycentric), "(n, 3) float64.")
      .property("barycentric_b", MORULA_COLUMN3(LayerPoints, rows, point.on_b.barycentric), "(n, 3) float64.")
      .property("point_a", MORULA_COLUMN3(LayerPoints, rows, point.on_a.point), "(n, 3) float64, world coordinates.")
      .property("point_b", MORULA_COLUMN3(LayerPoints, rows, point.on_b.point), "(n, 3) float64, world coordinates.")
      .table([](const LayerPoints& self) { return self.rows.size(); });
  Record<LayerPatches>(m, "LayerPatches", doc::LayerPatch)
      .property("id", MORULA_COLUMN(LayerPatches, patches, id), doc::LayerPatch_id)
      .property("volume", MORULA_COLUMN(LayerPatches, patches, volume), "(n,) float64, mesh units³.")
      .property("centroid", MORULA_COLUMN3(LayerPatches, patches, centroid), doc::LayerPatch_centroid)
      .property("normal", MORULA_COLUMN3(LayerPatches, patches, normal), doc::LayerPatch_normal)
      .property("depth", MORULA_COLUMN(LayerPatches, patches, depth), doc::LayerPatch_depth)
      .property("mean_depth", MORULA_COLUMN(LayerPatches, patches, mean_depth), doc::LayerPatch_mean_depth)
      .property("area_a", MORULA_COLUMN(LayerPatches, patches, a.area),
                "(n,) float64: rest area of a nearer to the other side than the thickness, mesh units²")
      .property("area_b", MORULA_COLUMN(LayerPatches, patches, b.area),
                "(n,) float64: rest area of b nearer to the other side than the thickness, mesh units²")
      .property("area_vector_a", MORULA_COLUMN3(LayerPatches, patches, a.area_vector), doc::LayerSide_area_vector)
      .property("area_vector_b", MORULA_COLUMN3(LayerPatches, patches, b.area_vector), doc::LayerSide_area_vector)
      .property("moment_a", MORULA_COLUMN3(LayerPatches, patches, a.moment), doc::LayerSide_moment)
      .property("moment_b", MORULA_COLUMN3(LayerPatches, patches, b.moment), doc::LayerSide_moment)
      .property(
          "a", [](const LayerPatches& p) { return p.a; }, "The sides of a: facets and gradients.")
      .property(
          "b", [](const LayerPatches& p) { return p.b; }, "The sides of b: facets and gradients.")
      .property(
          "points", [](const LayerPatches& p) { return p.points; }, "The points of all patches.")
      .property(
          "total_volume", [](const LayerPatches& p) { return p.volume; }, doc::LayerPatchQuery_volume)
      .table([](const LayerPatches& self) { return self.patches.size(); });
}

}  // namespace morula::python
