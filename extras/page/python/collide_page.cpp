// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of bodies that meet.
#include <cstddef>
#include <memory>
#include <morula/morula.hpp>
#include <morula/page/collide_page.hpp>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "contact_patches.hpp"
#include "contacts.hpp"
#include "held_query.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"
#include "scene_rows.hpp"

namespace morula::python {

namespace {

/// The page is a query; add() runs it.
using HeldCollidePage = HeldQuery<CollidePage, SeenSides>;

/// The marks of contacts from collide(), a ContactQuery or Scene.pairs(), or of a list of PageContact.
std::vector<PageContact> marks_of(nb::handle given) {
  std::vector<PageContact> marks;
  if (given.is_none()) return marks;
  if (nb::isinstance<Contacts>(given)) {
    const auto& found = nb::cast<const Contacts&>(given);
    add_marks(found.contacts, found.surfaces, marks);
  } else if (nb::isinstance<SceneRows>(given)) {
    const auto& found = nb::cast<const SceneRows&>(given);
    // Pair by pair: one that a budget ended has fewer surfaces than contacts.
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
      const SceneRow row = found.row(i);
      add_marks(row.contacts.contacts, row.surfaces.rows, marks);
    }
  } else if (!nb::try_cast(given, marks)) {
    throw nb::type_error(("contacts: " + describe(given) +
                          ", but None, Contacts, ContactPatches, ScenePairs or a list of PageContact is needed")
                             .c_str());
  }
  return marks;
}

/// Contact patches with the facets and points of a copy, which must stay.
struct WholePatches {
  std::vector<ContactPatch> patches;
  std::vector<PatchPoint> points;

  explicit WholePatches(const ContactPatches& found) : patches(found.patches) {
    for (const auto& row : found.points.rows) points.push_back(row.point);
    std::size_t first = 0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const auto facets = [&](const PatchRegions& r) {
        return std::span(r.facets).subspan(r.facets_begin[i], r.facets_begin[i + 1] - r.facets_begin[i]);
      };
      patches[i].a.facets = facets(found.a);
      patches[i].b.facets = facets(found.b);
      std::size_t end = first;
      while (end < points.size() && found.points.rows[end].patch == i) ++end;
      patches[i].points = std::span(points).subspan(first, end - first);
      first = end;
    }
  }
};

void require_facets(const PatchRegions& regions, const Collider& body) {
  for (const PatchFacet& facet : regions.facets)
    if (facet.facet >= body.mesh_facets().size())
      throw std::invalid_argument("contacts: patches of another body, with facet " + std::to_string(facet.facet));
}

/// Adds a frame with patches of the first two bodies, or of the only one with itself.
void add_patches(CollidePage& page, const SeenSides& seen, const std::string& name, const ContactPatches& found) {
  const Collider& a = seen.sides[0]->current();
  const Collider& b = seen.sides[seen.sides.size() > 1 ? 1 : 0]->current();
  require_facets(found.a, a);
  require_facets(found.b, b);
  CrossingQuery crossed;
  if (seen.sides.size() > 1) require(crossed.run(a, b));
  page.add(name, WholePatches(found).patches, crossed.pairs());
}

}  // namespace

void bind_collide_page(nb::module_& m) {
  nb::class_<HeldCollidePage>(m, "CollidePage",
                              "The page of bodies that collide: all as one motion, their spheres below one root, and a "
                              "mark at each contact, as `morula collide --page` writes it.")
      .def(
          "__init__",
          [](HeldCollidePage* self, nb::handle given, const std::string& title, const std::string& rule) {
            SeenSides seen;
            for (nb::handle body : nb::borrow<nb::object>(given)) {
              seen.sides.push_back(side_of(ColliderGiven{{body}}, "bodies"));
              if (!seen.sides.back()->current().has_surface())
                throw std::invalid_argument("bodies: a Collider of spheres alone has no surface to show");
            }
            if (seen.sides.empty()) throw std::invalid_argument("bodies: at least one is needed");
            CollidePage page = without_gil([&] {
              const Reading reading = seen.reading();
              std::vector<const Collider*> colliders;
              for (const auto& side : seen.sides) colliders.push_back(&side->current());
              return CollidePage(title, std::move(colliders), rule);
            });
            new (self) HeldCollidePage(std::move(page), std::move(seen));
          },
          nb::arg("bodies"), nb::kw_only(), nb::arg("title") = "Morula", nb::arg("rule") = "exact",
          nb::sig("def __init__(self, bodies: collections.abc.Iterable[morula.typing.ColliderLike], *, title: str = "
                  "'Morula', rule: morula.typing.Rule = 'exact') -> None"),
          with_arguments("The bodies at rest, at their transforms.",
                         {{"bodies", "colliders, or bodies with their own colliders; at least one"},
                          {"rule", "name of the update rule on the page"}})
              .c_str())
      .def(
          "add",
          [](HeldCollidePage& self, nb::handle contacts, std::string name) {
            const bool has_patches = nb::isinstance<ContactPatches>(contacts);
            std::vector<PageContact> marks = has_patches ? std::vector<PageContact>{} : marks_of(contacts);
            const ContactPatches* const patches = has_patches ? &nb::cast<const ContactPatches&>(contacts) : nullptr;
            self.call([&](CollidePage& page) {
              for (const auto& side : self.seen.sides)
                if (!side->current().has_current_positions())
                  throw std::invalid_argument("the positions of a body's present frame are not known: set_positions()");
              if (patches) {
                add_patches(page, self.seen, name, *patches);
              } else {
                page.add(name, std::move(marks));
              }
            });
          },
          nb::arg("contacts") = nb::none(), nb::kw_only(), nb::arg("name") = "",
          nb::sig("def add(self, contacts: Contacts | ContactPatches | ScenePairs | "
                  "collections.abc.Sequence[PageContact] | None = None, "
                  "*, name: str = '') -> None"),
          with_arguments(
              "Adds a frame: the bodies at their present positions, and their contacts.",
              {{"contacts",
                "contacts of collide(), a ContactQuery or Scene.pairs(), of which the finished ones are "
                "marked; patches of a ContactPatchQuery of the first two bodies, or of the only one, which are "
                "shown with their regions and the lines where surfaces cross now; or a list of marks"},
               {"name", "name of the frame"}})
              .c_str())
      .def(
          "html", [](HeldCollidePage& self) { return self.locked([](CollidePage& page) { return page.text(); }); },
          "The text of the file, after the last frame.");
}

}  // namespace morula::python
