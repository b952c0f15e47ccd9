// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Results of a scene: pairs of bodies with their contacts, and the bodies that shapes and rays meet.
#include <cstdint>
#include <iterator>
#include <morula/morula.hpp>
#include <morula/scene/scene.hpp>
#include <span>

#include "module.hpp"
#include "records.hpp"
#include "scene_rows.hpp"

namespace morula::python {

namespace {

ContactPatches patches_of(const Scene& scene, const ScenePair& pair) {
  const auto covers = [&](BodyId id) { return scene.collider(id).sphere_state().covers; };
  return {pair.patches, pair.has_patches, covers(pair.a) && covers(pair.b)};
}

}  // namespace

SceneRows rows_of(const Scene& scene) {
  SceneRows rows;
  for (const ScenePair& pair : scene.pairs()) {
    rows.pairs.push_back(pair);
    rows.user_data_a.push_back(scene.user_data(pair.a));
    rows.user_data_b.push_back(scene.user_data(pair.b));
    rows.contacts.contacts.insert(rows.contacts.contacts.end(), pair.contacts.begin(), pair.contacts.end());
    rows.surfaces.rows.insert(rows.surfaces.rows.end(), pair.surfaces.begin(), pair.surfaces.end());
    rows.crossings.pairs.insert(rows.crossings.pairs.end(), pair.crossings.begin(), pair.crossings.end());
    rows.patches.push_back(patches_of(scene, pair));
    rows.contacts_begin.push_back(static_cast<std::uint32_t>(rows.contacts.contacts.size()));
    rows.surfaces_begin.push_back(rows.surfaces.rows.size());
    rows.crossings_begin.push_back(static_cast<std::uint32_t>(rows.crossings.pairs.size()));
  }
  return rows;
}

SceneRow row_of(const Scene& scene, const ScenePair& pair) {
  return {pair,
          {{pair.contacts.begin(), pair.contacts.end()}},
          {{pair.surfaces.begin(), pair.surfaces.end()}},
          {{pair.crossings.begin(), pair.crossings.end()}},
          patches_of(scene, pair)};
}

void bind_scene_results(nb::module_& m) {
  Record<BodyId> id(m, "BodyId", doc::BodyId, MadeBy::calls);
  id.field("place", &BodyId::place, doc::BodyId_place).field("generation", &BodyId::generation);
  id.python()
      .def(
          "__init__",
          [](BodyId* self, std::uint32_t place, std::uint32_t generation) {
            new (self) BodyId{place, generation};
          },
          nb::arg("place"), nb::arg("generation"))
      .def("__hash__",
           [](const BodyId& self) {
             return static_cast<std::int64_t>((std::uint64_t{self.generation} << 32 | self.place) >> 1);
           })
      .def(
          "__lt__", [](const BodyId& a, const BodyId& b) { return a < b; }, nb::arg("other"))
      .def(
          "__reduce__",
          [](nb::handle self) {
            const auto& body = nb::cast<const BodyId&>(self);
            return nb::make_tuple(nb::object(nb::borrow(self.type())), nb::make_tuple(body.place, body.generation));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
  Record<SceneContacts> contacts(m, "SceneContacts", "Contacts of one pair of bodies, or of all pairs of a scene.");
  contact_columns(contacts).table([](const SceneContacts& self) { return self.contacts.size(); });
  Record<SceneRow>(m, "ScenePair", "Two bodies that touch or may touch after the update that it was read from.")
      .property(
          "a", [](const SceneRow& row) { return row.pair.a; }, doc::ScenePair_a)
      .property("b", [](const SceneRow& row) { return row.pair.b; })
      .property(
          "id", [](const SceneRow& row) { return row.pair.id; }, doc::ScenePair_id)
      .property(
          "touches", [](const SceneRow& row) { return row.pair.touches; }, doc::ScenePair_touches)
      .property(
          "confirmed", [](const SceneRow& row) { return row.pair.confirmed; }, doc::ScenePair_confirmed)
      .property(
          "began", [](const SceneRow& row) { return row.pair.began; }, doc::ScenePair_began)
      .property(
          "finished", [](const SceneRow& row) { return row.pair.finished; }, doc::ScenePair_finished)
      .property(
          "has_patches", [](const SceneRow& row) { return row.pair.has_patches; }, doc::ScenePair_has_patches)
      .field("contacts", &SceneRow::contacts)
      .field("patches", &SceneRow::patches, doc::ScenePair_patches)
      .field("surfaces", &SceneRow::surfaces, doc::ScenePair_surfaces)
      .field("crossings", &SceneRow::crossings, doc::ScenePair_crossings);
  Record<SceneRows> rows(
      m, "ScenePairs",
      "Bodies that touch or may touch, in the order of their places: pairs[i] and loops give ScenePair objects, "
      "attributes are columns of all of them. A copy, which later updates do not change.");
  rows.property("place_a", MORULA_COLUMN(SceneRows, pairs, a.place), "(n,) uint32: BodyId.place.")
      .property("place_b", MORULA_COLUMN(SceneRows, pairs, b.place), "(n,) uint32: BodyId.place.")
      .property(
          "user_data_a",
          [](nb::handle self) {
            const auto& values = nb::cast<const SceneRows&>(self).user_data_a;
            return View<std::uint64_t, -1>(values.data(), {values.size()}, self);
          },
          "(n,) uint64.")
      .property(
          "user_data_b",
          [](nb::handle self) {
            const auto& values = nb::cast<const SceneRows&>(self).user_data_b;
            return View<std::uint64_t, -1>(values.data(), {values.size()}, self);
          },
          "(n,) uint64.")
      .property("id", MORULA_COLUMN(SceneRows, pairs, id), doc::ScenePair_id)
      .property("touches", MORULA_COLUMN(SceneRows, pairs, touches), doc::ScenePair_touches)
      .property("confirmed", MORULA_COLUMN(SceneRows, pairs, confirmed), doc::ScenePair_confirmed)
      .property("began", MORULA_COLUMN(SceneRows, pairs, began), doc::ScenePair_began)
      .property("finished", MORULA_COLUMN(SceneRows, pairs, finished), doc::ScenePair_finished)
      .property("has_patches", MORULA_COLUMN(SceneRows, pairs, has_patches), doc::ScenePair_has_patches)
      .property(
          "contacts_begin",
          [](nb::handle self) { return indices(nb::cast<const SceneRows&>(self).contacts_begin, self); },
          "(n + 1,) uint32: contacts of pair i are [contacts_begin[i], contacts_begin[i + 1]).")
      .property(
          "contacts", [](const SceneRows& self) { return self.contacts; }, "The contacts of all pairs, pair by pair.")
      .property(
          "surfaces", [](const SceneRows& self) { return self.surfaces; }, doc::ScenePair_surfaces)
      .property(
          "crossings", [](const SceneRows& self) { return self.crossings; }, doc::ScenePair_crossings)
      .property(
          "crossings_begin",
          [](nb::handle self) { return indices(nb::cast<const SceneRows&>(self).crossings_begin, self); },
          "(n + 1,) uint32, as contacts_begin.");
  rows.python()
      .def("__len__", [](const SceneRows& self) { return self.pairs.size(); })
      .def(
          "__getitem__",
          [](const SceneRows& self, std::ptrdiff_t index) {
            const auto count = static_cast<std::ptrdiff_t>(self.pairs.size());
            if (index < -count || index >= count) throw nb::index_error("no such pair");
            return self.row(static_cast<std::size_t>(index < 0 ? index + count : index));
          },
          nb::arg("index"))
      .def(
          "__iter__",
          [](const SceneRows& self) {
            nb::list all;
            for (std::size_t i = 0; i < self.pairs.size(); ++i) all.append(self.row(i));
            return nb::iter(all);
          },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[ScenePair]"));
  Record<EndedPair>(m, "EndedPair", doc::EndedPair)
      .field("a", &EndedPair::a)
      .field("b", &EndedPair::b)
      .field("id", &EndedPair::id, doc::ScenePair_id);
  Record<SceneStatus>(m, "SceneStatus", "The progress of an update.")
      .field("finished", &SceneStatus::finished, doc::SceneStatus_finished)
      .field("near_pairs", &SceneStatus::near_pairs, doc::SceneStatus_near_pairs)
      .field("open_pairs", &SceneStatus::open_pairs, doc::SceneStatus_open_pairs)
      .field("undecided_pairs", &SceneStatus::undecided_pairs, doc::SceneStatus_undecided_pairs)
      .field("pair_tests", &SceneStatus::pair_tests, doc::SceneStatus_pair_tests)
      .field("tests_to_open", &SceneStatus::tests_to_open, doc::SceneStatus_tests_to_open);
  Record<FoundTouch>(m, "SceneTouch", "A body that a shape touches, and the touch.")
      .field("body", &FoundTouch::body)
      .field("touch", &FoundTouch::touch);
  Record<SceneHit>(m, "SceneHit", doc::SceneHit).field("body", &SceneHit::body).field("hit", &SceneHit::hit);
  Record<SceneRayHit>(m, "SceneRayHit", "What Scene.first_hit() found.")
      .field("body", &SceneRayHit::body, doc::SceneRayHit_body)
      .field("first", &SceneRayHit::first)
      .field("certified", &SceneRayHit::certified, doc::SceneRayHit_certified)
      .python()
      .def("__bool__", [](const SceneRayHit& hit) { return hit.first.has_value(); });
  Record<SceneSweep>(m, "SceneSweep", doc::SceneSweep)
      .field("body", &SceneSweep::body)
      .field("first", &SceneSweep::first);
  Record<SceneSweepHit>(m, "SceneSweepHit", "What Scene.sweep() found.")
      .field("body", &SceneSweepHit::body, doc::SceneSweepHit_body)
      .field("first", &SceneSweepHit::first)
      .field("certified", &SceneSweepHit::certified, doc::SceneSweepHit_certified)
      .python()
      .def("__bool__", [](const SceneSweepHit& hit) { return hit.first.has_value(); });
}

}  // namespace morula::python
