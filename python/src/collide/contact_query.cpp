// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts of two bodies within a budget, once or again and again.
#include <initializer_list>
#include <morula/morula.hpp>
#include <optional>
#include <utility>

#include "calls.hpp"
#include "choices.hpp"
#include "contacts.hpp"
#include "held_query.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

CollideOptions collide_options(std::optional<std::uint32_t> level, double margin, const BudgetGiven& budget,
                               PriorityName priority, bool surfaces, bool find_crossings, bool containment) {
  CollideOptions options;
  options.level = level;
  options.margin = margin;
  options.budget = budget_of(budget);
  options.priority = choice<Priority>(priority, "priority", priority_choices);
  options.surfaces = surfaces;
  options.find_crossings = find_crossings;
  options.containment = containment;
  return options;
}

/// Brings nodes of lazily updated bodies up to date as the query comes to them.
void reach_by(CollideOptions& options, const std::vector<const Side*>& sides) {
  options.refresh_children = [sides](const Collider& collider, std::uint32_t node) {
    for (const Side* side : sides) {
      if (!(*side->collider == collider)) continue;
      if (Body* body = side->posed->body()) body->refresh_children(node);
    }
    return true;
  };
}

struct FrontPairs {
  std::vector<FrontPair> rows;
};

/// A query about several pairs of colliders.
struct HeldContactQuery : HeldQuery<ContactQuery, SeenSides> {
  CollideOptions options;

  HeldContactQuery(ContactQuery&& made, CollideOptions&& given, bool reach)
      : HeldQuery(std::move(made), {{}, reach}), options(std::move(given)) {}
};

template <class Call>
Contacts contacts_of_call(HeldContactQuery& self, Threads* workers, bool keep, const Call& call) {
  Contacts contacts;
  require(self.call(workers, [&](ContactQuery& query, Workers& threads) {
    if (self.seen.exclusive) {
      CollideOptions options = self.options;
      reach_by(options, self.seen.all());
      query.set_options(std::move(options));
    }
    const ContactStatus status = call(query, threads);
    if (status && keep) contacts = query.contacts();
    if (status && !keep) contacts = query.take_contacts();
    return status;
  }));
  return contacts;
}

}  // namespace

void bind_contact_query(nb::module_& m) {
  const std::initializer_list<std::pair<const char*, const char*>> arguments{
      {"level", doc::CollideOptions_level},
      {"margin", doc::CollideOptions_margin},
      {"budget", "None: no limit; an int: pair tests; a datetime.timedelta or a text such as '200us': time"},
      {"priority", "level, overlap or importance: order in which a query with a budget opens pairs"},
      {"surfaces", doc::CollideOptions_surfaces},
      {"find_crossings", doc::CollideOptions_find_crossings},
      {"containment", doc::CollideOptions_containment},
      {"refresh_children", "refreshes nodes of lazily updated bodies that the query visits"}};
  nb::enum_<FrontPair::State>(m, "FrontPairState", nb::is_arithmetic(), "The verdict on a pair of the cut.")
      .value("separated", FrontPair::State::separated)
      .value("finished", FrontPair::State::finished)
      .value("waiting", FrontPair::State::waiting);
  Record<FrontPairs>(m, "FrontPairs", "The complete cut of a query: pairs of nodes.")
      .property("pair", MORULA_COLUMN(FrontPairs, rows, pair), "(n,) uint32: pair of bodies.")
      .property("node_a", MORULA_COLUMN(FrontPairs, rows, a), "(n,) uint32.")
      .property("node_b", MORULA_COLUMN(FrontPairs, rows, b), "(n,) uint32.")
      .property(
          "state",
          [](nb::handle self) {
            const auto& all = nb::cast<const FrontPairs&>(self).rows;
            const auto* first = all.empty() ? nullptr : reinterpret_cast<const std::uint8_t*>(&all[0].state);
            return column<FrontPair>(std::span<const FrontPair>(all), first, self);
          },
          "(n,) uint8: morula.FrontPairState of each.")
      .table([](const FrontPairs& self) { return self.rows.size(); });
  nb::class_<Front>(m, "Front", only_returned(), doc::Front)
      .def_ro("margin", &Front::margin)
      .def_prop_ro(
          "pair_count", [](const Front& self) { return self.pairs.size(); }, "Of bodies.")
      .def_prop_ro(
          "opened_count", [](const Front& self) { return self.opened.size(); }, "Pairs of nodes.")
      .def_prop_ro(
          "waiting_count", [](const Front& self) { return self.waiting.size(); }, doc::Front_waiting)
      .def(
          "__eq__", [](const Front& self, const Front& other) { return self == other; }, nb::arg("other"),
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__repr__", [](const Front& self) {
        return "<morula.Front: " + std::to_string(self.opened.size()) + " pairs opened, " +
               std::to_string(self.waiting.size()) + " waiting>";
      });
  nb::class_<HeldContactQuery> query(m, "ContactQuery", collected<HeldContactQuery>(), doc::ContactQuery);
  query
      .def(
          "__init__",
          [](HeldContactQuery* self, std::optional<std::uint32_t> level, double margin, BudgetGiven budget,
             PriorityName priority, bool surfaces, bool find_crossings, bool containment, bool reach) {
            CollideOptions options =
                collide_options(level, margin, budget, priority, surfaces, find_crossings, containment);
            ContactQuery query(options);
            new (self) HeldContactQuery(std::move(query), std::move(options), reach);
          },
          nb::kw_only(), nb::arg("level") = nb::none(), nb::arg("margin") = 0.0, nb::arg("budget") = nb::none(),
          nb::arg("priority") = "overlap", nb::arg("surfaces") = false, nb::arg("find_crossings") = false,
          nb::arg("containment") = false, nb::arg("refresh_children") = false,
          with_arguments(doc::ContactQuery_ContactQuery, arguments).c_str())
      .def(
          "add",
          [](HeldContactQuery& self, std::shared_ptr<Side> a, std::shared_ptr<Side> b, double weight) {
            return self.locked([&](ContactQuery& all) {
              const std::uint32_t number = all.add(a->current(), b->current(), weight);
              self.seen.sides.push_back(a);
              self.seen.sides.push_back(b);
              return number;
            });
          },
          nb::arg("a"), nb::arg("b"), nb::arg("weight") = 1.0, doc::ContactQuery_add)
      .def("clear", [](HeldContactQuery& self) {
        std::vector<std::shared_ptr<Side>> sides;
        self.locked([&](ContactQuery& all) {
          all.clear();
          std::swap(self.seen.sides, sides);
        });
      });
  bind_set_budget(query);
  query
      .def(
          "warm_up",
          [](HeldContactQuery& self, Threads* workers) {
            require(self.call(workers, [](ContactQuery& q, Workers& c) { return q.warm_up(c); }));
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_warm_up)
      .def(
          "run",
          [](HeldContactQuery& self, Threads* w) {
            return contacts_of_call(self, w, false, [](ContactQuery& q, Workers& c) { return q.run(c); });
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_run)
      .def(
          "start",
          [](HeldContactQuery& self, Threads* w) {
            return contacts_of_call(self, w, true, [](ContactQuery& q, Workers& c) { return q.start(c); });
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_start)
      .def(
          "resume",
          [](HeldContactQuery& self, Threads* w) {
            return contacts_of_call(self, w, true, [](ContactQuery& q, Workers& c) { return q.resume(c); });
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_resume)
      .def(
          "carry",
          [](HeldContactQuery& self, Threads* w) {
            return contacts_of_call(self, w, true, [](ContactQuery& q, Workers& c) { return q.carry(c); });
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_carry)
      .def(
          "surface",
          [](HeldContactQuery& self, std::size_t contact) {
            return ContactSurfaces{{self.call([&](ContactQuery& q) { return q.surface(contact); })}};
          },
          nb::arg("contact"), doc::ContactQuery_surface)
      .def(
          "cut",
          [](HeldContactQuery& self) {
            FrontPairs cut;
            self.call([&](ContactQuery& q) { q.cut(cut.rows); });
            return cut;
          },
          doc::ContactQuery_cut)
      .def(
          "front", [](HeldContactQuery& self) { return self.locked([](ContactQuery& q) { return q.front(); }); },
          (std::string("A copy. ") + doc::Front).c_str())
      .def(
          "set_front",
          [](HeldContactQuery& self, const Front& front) { self.locked([&](ContactQuery& q) { q.set_front(front); }); },
          nb::arg("front"), doc::ContactQuery_set_front);

  m.def(
      "collide",
      [](ColliderGiven ga, ColliderGiven gb, std::optional<std::uint32_t> level, double margin, BudgetGiven budget,
         PriorityName priority, bool surfaces, bool find_crossings, bool containment, bool reach) {
        CollideOptions options =
            collide_options(level, margin, budget, priority, surfaces, find_crossings, containment);
        const auto a = side_of(ga, "a"), b = side_of(gb, "b");
        return without_gil([&] {
          const Reading reading({a.get(), b.get()}, reach);
          if (reach) reach_by(options, {a.get(), b.get()});
          return collide(a->current(), b->current(), options);
        });
      },
      nb::arg("a"), nb::arg("b"), nb::kw_only(), nb::arg("level") = nb::none(), nb::arg("margin") = 0.0,
      nb::arg("budget") = nb::none(), nb::arg("priority") = "overlap", nb::arg("surfaces") = false,
      nb::arg("find_crossings") = false, nb::arg("containment") = false, nb::arg("refresh_children") = false,
      (with_arguments(doc::collide, arguments) +
       "\n\nA body can replace its collider; the cost of making one is linear in its tree.")
          .c_str());
}

}  // namespace morula::python
