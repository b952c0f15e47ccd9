// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches as columns: of patches, of both regions, and of points.
#include "contact_patches.hpp"

#include <morula/collide/contact_patches.hpp>
#include <optional>

#include "contacts.hpp"
#include "held_query.hpp"
#include "holders.hpp"
#include "module.hpp"

namespace morula::python {

ContactPatches::ContactPatches(std::span<const ContactPatch> of, bool is_finished, bool is_certified)
    : patches(of.begin(), of.end()), finished(is_finished), certified(is_certified) {
  contacts.finished = finished;
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    ContactPatch& patch = patches[i];
    volume += patch.volume;
    a.add(patch.a);
    b.add(patch.b);
    for (const PatchPoint& point : patch.points) points.rows.push_back({i, point});
    patch.a.facets = patch.b.facets = {};
    patch.a.gradients = patch.b.gradients = {};
    patch.points = {};
  }
}

ContactPatches::ContactPatches(const ContactPatchQuery& query)
    : ContactPatches(query.patches(), query.finished(), query.certified()) {
  volume = query.volume();
  contacts.contacts.assign(query.contacts().begin(), query.contacts().end());
  for (const Contact& contact : contacts.contacts) contacts.finished_count += contact.finished;
}

namespace {

void bind_records(nb::module_& m) {
  Record<PatchRegions>(m, "PatchRegions", "The regions of one body, of all patches, patch after patch.")
      .property("facet", MORULA_COLUMN(PatchRegions, facets, facet), "(n,) uint32, ascending within a patch.")
      .property("area_vector", MORULA_COLUMN3(PatchRegions, facets, area_vector), doc::PatchFacet_area_vector)
      .property(
          "facets_begin", [](const PatchRegions& r) { return r.facets_begin; },
          "Patch i has rows facets_begin[i] to facets_begin[i + 1] of `facet` and `area_vector`.")
      .property("vertex", MORULA_COLUMN(PatchRegions, gradients, vertex), "(m,) uint32, ascending within a patch.")
      .property("gradient", MORULA_COLUMN3(PatchRegions, gradients, gradient), doc::VertexGradient_gradient)
      .property(
          "gradients_begin", [](const PatchRegions& r) { return r.gradients_begin; },
          "Patch i has rows gradients_begin[i] to gradients_begin[i + 1] of `vertex` and `gradient`.");
  Record<PatchPoints>(m, "PatchPoints", doc::PatchPoint)
      .property("patch", MORULA_COLUMN(PatchPoints, rows, patch), "(n,) uint32: row of the patch.")
      .property("id", MORULA_COLUMN(PatchPoints, rows, point.id), doc::PatchPoint_id)
      .property("point", MORULA_COLUMN3(PatchPoints, rows, point.point), doc::PatchPoint_point)
      .property("force", MORULA_COLUMN3(PatchPoints, rows, point.force), doc::PatchPoint_force)
      .property("volume", MORULA_COLUMN(PatchPoints, rows, point.volume), doc::PatchPoint_volume)
      .property("depth", MORULA_COLUMN(PatchPoints, rows, point.depth), doc::PatchPoint_depth)
      .property("facet_a", MORULA_COLUMN(PatchPoints, rows, point.on_a.facet), "(n,) uint32.")
      .property("facet_b", MORULA_COLUMN(PatchPoints, rows, point.on_b.facet), "(n,) uint32.")
      .property("barycentric_a", MORULA_COLUMN3(PatchPoints, rows, point.on_a.barycentric), "(n, 3) float64.")
      .property("barycentric_b", MORULA_COLUMN3(PatchPoints, rows, point.on_b.barycentric), "(n, 3) float64.")
      .property("point_a", MORULA_COLUMN3(PatchPoints, rows, point.on_a.point), "(n, 3) float64, world coordinates.")
      .property("point_b", MORULA_COLUMN3(PatchPoints, rows, point.on_b.point), "(n, 3) float64, world coordinates.")
      .table([](const PatchPoints& self) { return self.rows.size(); });
  Record<ContactPatches>(m, "ContactPatches", "The parts of the overlap of two bodies, or of one with itself.")
      .property("id", MORULA_COLUMN(ContactPatches, patches, id), doc::ContactPatch_id)
      .property("volume", MORULA_COLUMN(ContactPatches, patches, volume), "(n,) float64, mesh units³.")
      .property("centroid", MORULA_COLUMN3(ContactPatches, patches, centroid), doc::ContactPatch_centroid)
      .property("normal", MORULA_COLUMN3(ContactPatches, patches, normal), doc::ContactPatch_normal)
      .property("depth", MORULA_COLUMN(ContactPatches, patches, depth), doc::ContactPatch_depth)
      .property("mean_depth", MORULA_COLUMN(ContactPatches, patches, mean_depth), doc::ContactPatch_mean_depth)
      .property("area_a", MORULA_COLUMN(ContactPatches, patches, a.area),
                "(n,) float64: area of the region of a, mesh units²")
      .property("area_b", MORULA_COLUMN(ContactPatches, patches, b.area),
                "(n,) float64: area of the region of b, mesh units²")
      .property("area_vector_a", MORULA_COLUMN3(ContactPatches, patches, a.area_vector), doc::PatchSide_area_vector)
      .property("area_vector_b", MORULA_COLUMN3(ContactPatches, patches, b.area_vector), doc::PatchSide_area_vector)
      .property("moment_a", MORULA_COLUMN3(ContactPatches, patches, a.moment), doc::PatchSide_moment)
      .property("moment_b", MORULA_COLUMN3(ContactPatches, patches, b.moment), doc::PatchSide_moment)
      .property(
          "a", [](const ContactPatches& p) { return p.a; }, "The regions of a: facets and gradients.")
      .property(
          "b", [](const ContactPatches& p) { return p.b; }, "The regions of b: facets and gradients.")
      .property(
          "points", [](const ContactPatches& p) { return p.points; }, "The points of all patches.")
      .property(
          "total_volume", [](const ContactPatches& p) { return p.volume; }, doc::ContactPatchQuery_volume)
      .property(
          "is_finished", [](const ContactPatches& p) { return p.finished; }, doc::ContactPatchQuery_finished)
      .property(
          "contacts", [](const ContactPatches& p) { return p.contacts; }, doc::ContactPatchQuery_contacts)
      .property(
          "certified", [](const ContactPatches& p) { return p.certified; }, doc::ContactPatchQuery_certified)
      .table([](const ContactPatches& self) { return self.patches.size(); });
}

using HeldPatches = HeldQuery<ContactPatchQuery, SeenSides>;

}  // namespace

void bind_contact_patches(nb::module_& m) {
  bind_records(m);
  nb::class_<HeldPatches>(m, "ContactPatchQuery", collected<HeldPatches>(), doc::ContactPatchQuery)
      .def(
          "__init__",
          [](HeldPatches* self, ColliderGiven ga, ColliderGiven gb) {
            auto a = kept_side_of(ga, "a"), b = kept_side_of(gb, "b");
            ContactPatchQuery query = without_gil([&] {
              const Reading reading({a.get(), b.get()});
              return ContactPatchQuery(a->current(), b->current());
            });
            new (self) HeldPatches(std::move(query), {{std::move(a), std::move(b)}});
          },
          nb::arg("a"), nb::arg("b"), doc::ContactPatchQuery_ContactPatchQuery)
      .def(
          "__init__",
          [](HeldPatches* self, ColliderGiven given) {
            auto body = kept_side_of(given, "body");
            ContactPatchQuery query = without_gil([&] {
              const Reading reading({body.get()});
              return ContactPatchQuery(body->current());
            });
            new (self) HeldPatches(std::move(query), {{std::move(body)}});
          },
          nb::arg("body"), doc::ContactPatchQuery_ContactPatchQuery_2)
      .def(
          "run",
          [](HeldPatches& self, std::uint32_t max_points, bool depths, BudgetGiven budget) {
            const ContactPatchOptions options{.max_points = max_points, .depths = depths, .budget = budget_of(budget)};
            std::optional<ContactPatches> found;
            const Status status = self.call([&](ContactPatchQuery& query) {
              const Status result = query.run(options);
              if (result) found.emplace(query);
              return result;
            });
            require(status);
            return std::move(*found);
          },
          nb::kw_only(), nb::arg("max_points") = 4, nb::arg("depths") = true, nb::arg("budget") = nb::none(),
          with_arguments(doc::ContactPatchQuery_run, {{"max_points", doc::ContactPatchOptions_max_points},
                                                      {"depths", doc::ContactPatchOptions_depths},
                                                      {"budget", doc::ContactPatchOptions_budget}})
              .c_str());
}

}  // namespace morula::python
