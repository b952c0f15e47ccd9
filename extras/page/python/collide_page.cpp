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
    throw nb::type_error(
        ("contacts: " + describe(given) + ", but None, Contacts, ScenePairs or a list of PageContact is needed")
            .c_str());
  }
  return marks;
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
            std::vector<PageContact> marks = marks_of(contacts);
            self.call([&](CollidePage& page) {
              for (const auto& side : self.seen.sides)
                if (!side->current().has_current_positions())
                  throw std::invalid_argument("the positions of a body's present frame are not known: set_positions()");
              page.add(name, std::move(marks));
            });
          },
          nb::arg("contacts") = nb::none(), nb::kw_only(), nb::arg("name") = "",
          nb::sig(
              "def add(self, contacts: Contacts | ScenePairs | collections.abc.Sequence[PageContact] | None = None, "
              "*, name: str = '') -> None"),
          with_arguments("Adds a frame: the bodies at their present positions, and their contacts.",
                         {{"contacts",
                           "contacts of collide(), a ContactQuery or Scene.pairs(), of which the finished ones are "
                           "marked; or a list of marks"},
                          {"name", "name of the frame"}})
              .c_str())
      .def(
          "html", [](HeldCollidePage& self) { return self.locked([](CollidePage& page) { return page.text(); }); },
          "The text of the file, after the last frame.");
}

}  // namespace morula::python
