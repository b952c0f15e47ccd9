// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes: many bodies and their contacts under one budget; boxes that move.
#include <exception>
#include <morula/morula.hpp>
#include <morula/scene/broad_phase.hpp>
#include <morula/scene/scene.hpp>
#include <optional>

#include "contacts.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// Contacts of one pair of bodies, or of all.
struct SceneContacts {
  std::vector<Contact> rows;
};

/// A pair of bodies, with its contacts.
struct SceneRow {
  ScenePair pair;  // its spans are not used
  SceneContacts contacts;
  ContactSurfaces surfaces;
  Crossings crossings;
};

/// All pairs of an update: a copy, which the next update does not touch.
struct SceneRows {
  std::vector<ScenePair> pairs;  // its spans are not used
  std::vector<std::uint64_t> user_data_a, user_data_b;
  std::vector<std::uint32_t> contacts_begin{0}, crossings_begin{0};
  SceneContacts contacts;
  std::vector<std::size_t> surfaces_begin{0};
  ContactSurfaces surfaces;
  Crossings crossings;

  SceneRow row(std::size_t i) const {
    const auto part = [](const auto& all, std::size_t begin, std::size_t end) {
      using List = std::remove_cvref_t<decltype(all)>;
      return List(all.begin() + static_cast<std::ptrdiff_t>(begin), all.begin() + static_cast<std::ptrdiff_t>(end));
    };
    return {pairs[i],
            {part(contacts.rows, contacts_begin[i], contacts_begin[i + 1])},
            {part(surfaces.rows, surfaces_begin[i], surfaces_begin[i + 1])},
            {part(crossings.pairs, crossings_begin[i], crossings_begin[i + 1])}};
  }
};

struct FoundTouch {
  BodyId body;
  Touch touch;
};

/// A scene, the colliders that it borrows, and the filter that it asks.
struct HeldScene {
  SceneOptions options;
  nb::object keeps = nb::none();
  Scene scene;
  std::vector<std::shared_ptr<Side>> sides;  // by place
  std::exception_ptr raised;                 // by the filter
  bool is_updating = false;
  mutable std::recursive_mutex mutex;  // the filter may ask the scene who its bodies are

  HeldScene(SceneOptions&& given, nb::object&& filter) : options(std::move(given)), keeps(std::move(filter)) {
    connect();
    scene.set_options(options);
  }

  /// The filter is called through this object, which does not move.
  void connect() {
    options.keeps = {};
    if (keeps.is_none()) return;
    options.keeps = [this](BodyId a, BodyId b) {
      if (raised) return true;
      const nb::gil_scoped_acquire gil;
      try {
        return nb::cast<bool>(nb::borrow<nb::callable>(keeps)(a, b));
      } catch (...) {
        raised = std::current_exception();
        return true;
      }
    };
  }
  void require_idle() const {
    if (is_updating) throw std::runtime_error("keeps: the scene that asks it may not be changed or asked for contacts");
  }
  std::vector<const Side*> all() const {
    std::vector<const Side*> found;
    for (const auto& side : sides) {
      if (!side) continue;
      side->current();
      found.push_back(side.get());
    }
    return found;
  }
};

/// Runs f with the scene locked, without the interpreter's lock.
template <class F>
auto locked(const HeldScene& self, const F& f) {
  return without_gil([&] {
    const std::scoped_lock lock(self.mutex);
    return f();
  });
}
template <class F>
auto locked_idle(const HeldScene& self, const F& f) {
  return locked(self, [&] {
    self.require_idle();
    return f();
  });
}

void require_scene(const SceneStatus& status) {
  if (!status) throw std::invalid_argument(message(status));
}

SceneOptions scene_options(std::optional<std::uint32_t> level, double margin, const BudgetGiven& budget, bool surfaces,
                           bool exact, const nb::object& keeps) {
  if (!keeps.is_none() && !PyCallable_Check(keeps.ptr()))
    throw nb::type_error(("keeps: " + describe(keeps) + ", but None or a function of two BodyIds is needed").c_str());
  SceneOptions options;
  options.level = level;
  options.margin = margin;
  options.budget = budget_of(budget);
  options.surfaces = surfaces;
  options.exact = exact;
  return options;
}

SceneRows rows_of(const HeldScene& self) {
  SceneRows rows;
  for (const ScenePair& pair : self.scene.pairs()) {
    rows.pairs.push_back(pair);
    rows.user_data_a.push_back(self.scene.user_data(pair.a));
    rows.user_data_b.push_back(self.scene.user_data(pair.b));
    rows.contacts.rows.insert(rows.contacts.rows.end(), pair.contacts.begin(), pair.contacts.end());
    rows.surfaces.rows.insert(rows.surfaces.rows.end(), pair.surfaces.begin(), pair.surfaces.end());
    rows.crossings.pairs.insert(rows.crossings.pairs.end(), pair.crossings.begin(), pair.crossings.end());
    rows.contacts_begin.push_back(static_cast<std::uint32_t>(rows.contacts.rows.size()));
    rows.surfaces_begin.push_back(rows.surfaces.rows.size());
    rows.crossings_begin.push_back(static_cast<std::uint32_t>(rows.crossings.pairs.size()));
  }
  return rows;
}

SceneRow row_of(const ScenePair& pair) {
  return {pair,
          {{pair.contacts.begin(), pair.contacts.end()}},
          {{pair.surfaces.begin(), pair.surfaces.end()}},
          {{pair.crossings.begin(), pair.crossings.end()}}};
}

void bind_scene_results(nb::module_& m) {
  Record<BodyId> id(m, "BodyId", doc::BodyId);
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
      .def("__reduce__", [](nb::handle self) {
        const auto& body = nb::cast<const BodyId&>(self);
        return nb::make_tuple(nb::object(nb::borrow(self.type())), nb::make_tuple(body.place, body.generation));
      });
  Record<SceneContacts>(m, "SceneContacts", doc::ScenePair_contacts)
      .property("node_a", MORULA_COLUMN(SceneContacts, rows, node_a), "(n,) uint32.")
      .property("node_b", MORULA_COLUMN(SceneContacts, rows, node_b), "(n,) uint32.")
      .property("finished", MORULA_COLUMN(SceneContacts, rows, finished), doc::Contact_finished)
      .property("point", MORULA_COLUMN3(SceneContacts, rows, point), doc::Contact_point)
      .property("normal", MORULA_COLUMN3(SceneContacts, rows, normal), doc::Contact_normal)
      .property("depth", MORULA_COLUMN(SceneContacts, rows, depth), doc::Contact_depth)
      .property("lens_volume", MORULA_COLUMN(SceneContacts, rows, lens_volume), doc::Contact_lens_volume)
      .property("error_bound", MORULA_COLUMN(SceneContacts, rows, error_bound), doc::Contact_error_bound)
      .table([](const SceneContacts& self) { return self.rows.size(); });
  Record<SceneRow>(m, "ScenePair", "Two bodies in contact, as of the update that they were read after.")
      .property(
          "a", [](const SceneRow& row) { return row.pair.a; }, doc::ScenePair_a)
      .property("b", [](const SceneRow& row) { return row.pair.b; })
      .property(
          "id", [](const SceneRow& row) { return row.pair.id; }, doc::ScenePair_id)
      .property(
          "began", [](const SceneRow& row) { return row.pair.began; }, doc::ScenePair_began)
      .property(
          "finished", [](const SceneRow& row) { return row.pair.finished; }, doc::ScenePair_finished)
      .field("contacts", &SceneRow::contacts)
      .field("surfaces", &SceneRow::surfaces, doc::ScenePair_surfaces)
      .field("crossings", &SceneRow::crossings, doc::ScenePair_crossings);
  Record<SceneRows> rows(m, "ScenePairs",
                         "Bodies in contact, in the order of their places: pairs[i] and loops give ScenePair objects, "
                         "attributes are columns of all of them. A copy: the next update leaves it alone.");
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
      .property("began", MORULA_COLUMN(SceneRows, pairs, began), doc::ScenePair_began)
      .property("finished", MORULA_COLUMN(SceneRows, pairs, finished), doc::ScenePair_finished)
      .property(
          "contacts_begin",
          [](nb::handle self) { return indices(nb::cast<const SceneRows&>(self).contacts_begin, self); },
          "(n + 1,) uint32: contacts of pair i are [contacts_begin[i], contacts_begin[i + 1]).")
      .property(
          "contacts", [](const SceneRows& self) { return self.contacts; }, "Of all pairs, one pair after the other.")
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
  Record<SceneStatus>(m, "SceneStatus", "How far an update came.")
      .field("finished", &SceneStatus::finished, doc::SceneStatus_finished)
      .field("near_pairs", &SceneStatus::near_pairs, doc::SceneStatus_near_pairs)
      .field("open_pairs", &SceneStatus::open_pairs, doc::SceneStatus_open_pairs)
      .field("pair_tests", &SceneStatus::pair_tests, doc::SceneStatus_pair_tests);
  Record<FoundTouch>(m, "SceneTouch", "A body that a shape touches, and where.")
      .field("body", &FoundTouch::body)
      .field("touch", &FoundTouch::touch);
  Record<SceneRayHit>(m, "SceneRayHit", "What Scene.first_hit() found.")
      .field("body", &SceneRayHit::body, doc::SceneRayHit_body)
      .field("first", &SceneRayHit::first)
      .field("certified", &SceneRayHit::certified, doc::SceneRayHit_certified)
      .python()
      .def("__bool__", [](const SceneRayHit& hit) { return hit.first.has_value(); });
}

/// What a scene keeps of Python, for the collector of cycles: a filter often refers to its scene.
int traverse(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nb::inst_ready(self)) return 0;
  const nb::handle keeps = nb::inst_ptr<HeldScene>(self)->keeps;
  Py_VISIT(keeps.ptr());
  return 0;
}
int clear(PyObject* self) {
  if (nb::inst_ready(self)) nb::inst_ptr<HeldScene>(self)->keeps.reset();
  return 0;
}
PyType_Slot scene_slots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(traverse)}, {Py_tp_clear, reinterpret_cast<void*>(clear)}, {0, nullptr}};

template <class Class>
void bind_scene_bodies(Class& scene) {
  scene
      .def(
          "add",
          [](HeldScene& self, ColliderGiven given, bool is_static, std::uint32_t of, std::uint32_t with, double weight,
             std::uint64_t user_data) {
            const std::shared_ptr<Side> side = side_of(given, "collider");
            return locked_idle(self, [&] {
              const Reading reading({side.get()});
              const BodyId id = self.scene.add(side->current(), {is_static, of, with, weight, user_data});
              if (self.sides.size() <= id.place) self.sides.resize(id.place + 1);
              self.sides[id.place] = side;
              return id;
            });
          },
          nb::arg("collider"), nb::kw_only(), nb::arg("is_static") = false, nb::arg("of") = 1,
          nb::arg("with_") = ~std::uint32_t{0}, nb::arg("weight") = 1.0, nb::arg("user_data") = 0,
          with_arguments(doc::Scene_add, {{"collider",
                                           "kept until remove() or replace(); a body may stand in for its "
                                           "own, and collider() gives it then"},
                                          {"is_static", doc::SceneBodyOptions_is_static},
                                          {"of", doc::SceneBodyOptions_of},
                                          {"with_", "`with` of C++"},
                                          {"weight", doc::SceneBodyOptions_weight},
                                          {"user_data", doc::SceneBodyOptions_user_data}})
              .c_str())
      .def(
          "remove",
          [](HeldScene& self, BodyId body) {
            std::shared_ptr<Side> side;
            locked_idle(self, [&] {
              self.scene.remove(body);
              std::swap(side, self.sides[body.place]);
            });
          },
          nb::arg("body"), doc::Scene_remove)
      .def(
          "replace",
          [](HeldScene& self, BodyId body, ColliderGiven given) {
            std::shared_ptr<Side> side = side_of(given, "collider");
            locked_idle(self, [&] {
              const Reading reading({side.get()});
              self.scene.replace(body, side->current());
              std::swap(side, self.sides[body.place]);
            });
          },
          nb::arg("body"), nb::arg("collider"), doc::Scene_replace)
      .def(
          "sleep", [](HeldScene& self, BodyId body) { locked_idle(self, [&] { self.scene.sleep(body); }); },
          nb::arg("body"), doc::Scene_sleep)
      .def(
          "wake", [](HeldScene& self, BodyId body) { locked_idle(self, [&] { self.scene.wake(body); }); },
          nb::arg("body"), doc::Scene_wake)
      .def(
          "set_masks",
          [](HeldScene& self, BodyId body, std::uint32_t of, std::uint32_t with) {
            locked_idle(self, [&] { self.scene.set_masks(body, of, with); });
          },
          nb::arg("body"), nb::arg("of"), nb::arg("with_"), doc::SceneBodyOptions_of)
      .def(
          "has", [](const HeldScene& self, BodyId body) { return locked(self, [&] { return self.scene.has(body); }); },
          nb::arg("body"))
      .def(
          "is_asleep",
          [](const HeldScene& self, BodyId body) { return locked(self, [&] { return self.scene.is_asleep(body); }); },
          nb::arg("body"))
      .def(
          "user_data",
          [](const HeldScene& self, BodyId body) { return locked(self, [&] { return self.scene.user_data(body); }); },
          nb::arg("body"), doc::SceneBodyOptions_user_data)
      .def(
          "collider",
          [](const HeldScene& self, BodyId body) {
            return locked(self, [&] {
              self.scene.collider(body);  // throws where there is no such body
              return self.sides[body.place];
            });
          },
          nb::arg("body"), nb::sig("def collider(self, body: BodyId) -> Collider"),
          "The collider of a body: place() moves it.")
      .def("__len__", [](const HeldScene& self) { return locked(self, [&] { return self.scene.size(); }); })
      .def(
          "__contains__",
          [](const HeldScene& self, BodyId body) { return locked(self, [&] { return self.scene.has(body); }); },
          nb::arg("body"));
}

template <class Class>
void bind_scene_questions(Class& scene) {
  scene
      .def(
          "update",
          [](HeldScene& self, Threads* workers) {
            SceneStatus status;
            std::exception_ptr raised;
            {
              const nb::gil_scoped_release released;
              CallWorkers call(workers);
              const std::scoped_lock lock(self.mutex);
              self.require_idle();
              const Reading reading(self.all());
              self.is_updating = true;
              try {
                status = self.scene.update(call);
              } catch (...) {
                self.is_updating = false;
                throw;
              }
              self.is_updating = false;
              std::swap(raised, self.raised);
              // Who was not asked is asked by the next update.
              if (raised) self.scene.set_options(self.options);
            }
            if (raised) std::rethrow_exception(raised);
            require_scene(status);
            return status;
          },
          nb::arg("workers") = nb::none(), doc::Scene_update)
      .def(
          "pairs", [](const HeldScene& self) { return locked_idle(self, [&] { return rows_of(self); }); },
          doc::Scene_pairs)
      .def(
          "ended",
          [](const HeldScene& self) {
            return locked_idle(self, [&] {
              const auto ended = self.scene.ended();
              return std::vector<EndedPair>(ended.begin(), ended.end());
            });
          },
          doc::EndedPair)
      .def(
          "find",
          [](const HeldScene& self, BodyId a, BodyId b) {
            return locked_idle(self, [&]() -> std::optional<SceneRow> {
              const ScenePair* pair = self.scene.find(a, b);
              if (!pair) return std::nullopt;
              return row_of(*pair);
            });
          },
          nb::arg("a"), nb::arg("b"), doc::Scene_find)
      .def(
          "first_hit",
          [](const HeldScene& self, Vec3 origin, Vec3 direction, double t_end) {
            const SceneRayHit hit = locked_idle(self, [&] {
              const Reading reading(self.all());
              return self.scene.first_hit({origin, direction, t_end});
            });
            require_scene(hit.status);
            return hit;
          },
          nb::arg("origin"), nb::arg("direction"), nb::arg("t_end") = std::numeric_limits<double>::infinity(),
          doc::Scene_first_hit)
      .def(
          "touch",
          [](HeldScene& self, ShapeGiven shape, double margin, bool any, bool list) {
            const TouchOptions options{.margin = margin, .nearest = false, .any = any, .list = list};
            std::vector<FoundTouch> found;
            const SceneStatus status = with_shape(shape, [&](const auto& s) {
              return locked_idle(self, [&] {
                const Reading reading(self.all());
                const SceneStatus asked = self.scene.touch(s, options);
                if (asked)
                  for (const SceneTouch& touch : self.scene.touches()) found.push_back({touch.body, *touch.touch});
                return asked;
              });
            });
            require_scene(status);
            return found;
          },
          nb::arg("shape"), nb::kw_only(), nb::arg("margin") = 0.0, nb::arg("any") = false, nb::arg("list") = false,
          with_arguments(
              doc::Scene_touch,
              {{"margin", doc::TouchOptions_margin}, {"any", doc::TouchOptions_any}, {"list", doc::TouchOptions_list}})
              .c_str());
}

void bind_scene_class(nb::module_& m) {
  const std::initializer_list<std::pair<const char*, const char*>> arguments{
      {"level", doc::SceneOptions_level},
      {"margin", doc::SceneOptions_margin},
      {"budget", doc::SceneOptions_budget},
      {"surfaces", doc::SceneOptions_surfaces},
      {"exact", doc::SceneOptions_exact},
      {"keeps",
       "called with two BodyIds. Keeps a pair when it returns True. Asked once when two bodies come near each "
       "other; it may ask the scene whose they are, and must not move bodies. What it raises comes out of "
       "update(), and who was not asked is asked by the next one"}};
  nb::class_<HeldScene> scene(m, "Scene", nb::type_slots(scene_slots), doc::Scene);
  scene
      .def(
          "__init__",
          [](HeldScene* self, std::optional<std::uint32_t> level, double margin, BudgetGiven budget, bool surfaces,
             bool exact, nb::object keeps) {
            new (self) HeldScene(scene_options(level, margin, budget, surfaces, exact, keeps), std::move(keeps));
          },
          nb::kw_only(), nb::arg("level") = nb::none(), nb::arg("margin") = 0.0, nb::arg("budget") = nb::none(),
          nb::arg("surfaces") = false, nb::arg("exact") = false, nb::arg("keeps") = nb::none(),
          nb::sig("def __init__(self, *, level: int | None = None, margin: float = 0.0, budget: morula.typing.Budget = "
                  "None, surfaces: bool = False, exact: bool = False, keeps: collections.abc.Callable[[BodyId, "
                  "BodyId], bool] | None = None) -> None"),
          with_arguments(doc::Scene_Scene, arguments).c_str())
      .def(
          "set_options",
          [](HeldScene& self, std::optional<std::uint32_t> level, double margin, BudgetGiven budget, bool surfaces,
             bool exact, nb::object keeps) {
            SceneOptions options = scene_options(level, margin, budget, surfaces, exact, keeps);
            locked_idle(self, [&] {
              const Scene checked(options);  // throws for what is out of range
              std::swap(self.options, options);
              std::swap(self.keeps, keeps);
              self.connect();
              self.scene.set_options(self.options);
            });
          },
          nb::kw_only(), nb::arg("level") = nb::none(), nb::arg("margin") = 0.0, nb::arg("budget") = nb::none(),
          nb::arg("surfaces") = false, nb::arg("exact") = false, nb::arg("keeps") = nb::none(),
          nb::sig(
              "def set_options(self, *, level: int | None = None, margin: float = 0.0, budget: morula.typing.Budget "
              "= None, surfaces: bool = False, exact: bool = False, keeps: collections.abc.Callable[[BodyId, "
              "BodyId], bool] | None = None) -> None"),
          with_arguments(doc::Scene_set_options, arguments).c_str())
      .def(
          "set_budget",
          [](HeldScene& self, BudgetGiven budget) {
            const Budget next = budget_of(budget);
            locked_idle(self, [&] {
              self.options.budget = next;
              self.scene.set_options(self.options);
            });
          },
          nb::arg("budget"), "For the next update; other options stay.")
      .def("__repr__", [](const HeldScene& self) {
        const std::size_t count = locked(self, [&] { return self.scene.size(); });
        return "<morula.Scene: " + std::to_string(count) + (count == 1 ? " body>" : " bodies>");
      });
  bind_scene_bodies(scene);
  bind_scene_questions(scene);
}

/// For one thread at a time: others wait.
struct HeldBroadPhase {
  BroadPhase boxes;
  mutable std::mutex mutex;
};

IndexPairs own_pairs(std::span<const BoxPair> pairs) {
  auto [values, owner] = kept(std::vector<BoxPair>(pairs.begin(), pairs.end()));
  return IndexPairs(reinterpret_cast<const std::uint32_t*>(values->data()), {values->size(), 2}, owner);
}

void bind_broad_phase(nb::module_& m) {
  const auto ask = [](const HeldBroadPhase& self, const auto& find) {
    return own_indices(without_gil([&] {
      std::vector<std::uint32_t> found;
      const std::scoped_lock lock(self.mutex);
      find(found);
      return found;
    }));
  };
  nb::class_<HeldBroadPhase>(m, "BroadPhase", doc::BroadPhase)
      .def(nb::init<>())
      .def(
          "add",
          [](HeldBroadPhase& self, Vec3 lower, Vec3 upper, bool is_static) {
            return without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              return self.boxes.add({lower, upper}, is_static);
            });
          },
          nb::arg("lower"), nb::arg("upper"), nb::arg("is_static") = false, doc::BroadPhase_add)
      .def(
          "remove",
          [](HeldBroadPhase& self, std::uint32_t number) {
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              self.boxes.remove(number);
            });
          },
          nb::arg("number"), doc::BroadPhase_remove)
      .def(
          "move",
          [](HeldBroadPhase& self, std::uint32_t number, Vec3 lower, Vec3 upper) {
            require(without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              return self.boxes.move(number, {lower, upper});
            }));
          },
          nb::arg("number"), nb::arg("lower"), nb::arg("upper"), doc::BroadPhase_move)
      .def(
          "move_all",
          [](HeldBroadPhase& self, ArrayGiven given, ArrayGiven from, ArrayGiven to) {
            const std::vector<std::uint32_t> numbers = indices_of(given.object, "numbers");
            const std::vector<Vec3> lower = points_of(from.object, "lower"), upper = points_of(to.object, "upper");
            if (lower.size() != numbers.size() || upper.size() != numbers.size())
              throw std::invalid_argument("lower, upper: one row per number is needed");
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              for (std::size_t i = 0; i < numbers.size(); ++i)
                require(self.boxes.move(numbers[i], {lower[i], upper[i]}));
            });
          },
          nb::arg("numbers"), nb::arg("lower"), nb::arg("upper"),
          "move() for many. numbers: (n,); lower, upper: (n, 3). Those before the first that is refused have moved.")
      .def(
          "has",
          [](const HeldBroadPhase& self, std::uint32_t number) {
            const std::scoped_lock lock(self.mutex);
            return self.boxes.has(number);
          },
          nb::arg("number"))
      .def(
          "box",
          [](const HeldBroadPhase& self, std::uint32_t number) {
            const std::scoped_lock lock(self.mutex);
            if (!self.boxes.has(number)) throw nb::index_error("number: there is no such box");
            const Box& box = self.boxes.box(number);
            return std::make_tuple(box.lower, box.upper);
          },
          nb::arg("number"), "Lower and upper corner.")
      .def("__len__",
           [](const HeldBroadPhase& self) {
             const std::scoped_lock lock(self.mutex);
             return self.boxes.size();
           })
      .def(
          "update",
          [](HeldBroadPhase& self) {
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              self.boxes.update();
            });
          },
          doc::BroadPhase_update)
      .def(
          "pairs",
          [](const HeldBroadPhase& self) {
            const std::scoped_lock lock(self.mutex);
            return own_pairs(self.boxes.pairs());
          },
          "(n, 2) uint32. As of the last update, ascending.")
      .def(
          "find",
          [ask](const HeldBroadPhase& self, Vec3 lower, Vec3 upper) {
            return ask(self, [&](auto& found) { self.boxes.find({lower, upper}, found); });
          },
          nb::arg("lower"), nb::arg("upper"), doc::BroadPhase_find)
      .def(
          "find_behind",
          [ask](const HeldBroadPhase& self, Vec3 normal, double offset) {
            return ask(self, [&](auto& found) { self.boxes.find_behind(normal, offset, found); });
          },
          nb::arg("normal"), nb::arg("offset"), doc::BroadPhase_find_behind)
      .def(
          "find_along",
          [ask](const HeldBroadPhase& self, Vec3 origin, Vec3 direction, double t_end) {
            return ask(self, [&](auto& found) { self.boxes.find_along(origin, direction, t_end, found); });
          },
          nb::arg("origin"), nb::arg("direction"), nb::arg("t_end") = std::numeric_limits<double>::infinity(),
          doc::BroadPhase_find_along);
}

}  // namespace

void bind_scene(nb::module_& m) {
  bind_scene_results(m);
  bind_scene_class(m);
  bind_broad_phase(m);
}

}  // namespace morula::python
