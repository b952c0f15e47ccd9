// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes: many bodies and their contacts under one budget.
#include <concepts>
#include <exception>
#include <limits>
#include <memory>
#include <morula/morula.hpp>
#include <morula/scene/scene.hpp>
#include <mutex>
#include <optional>
#include <type_traits>
#include <vector>

#include "contacts.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"
#include "scene_rows.hpp"

namespace morula::python {

namespace {

/// A scene, the colliders that it borrows, and the filter that it calls.
struct HeldScene : Exchanging {
  SceneOptions options;
  nb::object accepts = nb::none();
  Scene scene;
  std::vector<std::shared_ptr<Side>> sides;  // by place
  std::exception_ptr raised;                 // by the filter
  bool is_updating = false;
  mutable std::recursive_mutex mutex;  // recursive: the filter may read the bodies of the scene

  HeldScene(SceneOptions&& given, nb::object&& filter) : options(std::move(given)), accepts(std::move(filter)) {
    connect();
    scene.set_options(options);
  }

  /// The filter is called through this object, which does not move.
  void connect() {
    options.accepts = {};
    if (accepts.is_none()) return;
    options.accepts = [this](BodyId a, BodyId b) {
      if (raised) return true;
      const nb::gil_scoped_acquire gil;
      if (accepts.is_none()) return true;
      try {
        const nb::object answer = accepts(a, b);
        const int truth = PyObject_IsTrue(answer.ptr());
        if (truth < 0) throw nb::python_error();
        return truth != 0;
      } catch (...) {
        raised = std::current_exception();
        return true;
      }
    };
  }
  void require_idle() const {
    if (is_updating) throw std::runtime_error("accepts: its scene cannot be changed or queried during the call");
  }
  /// A filter often refers to its scene.
  void visit(References& references) const {
    references(accepts);
    for (const auto& side : sides) references(side);
  }
  void forget() { accepts = nb::none(); }
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

/// Runs f with the scene locked, without the GIL.
template <class F>
auto locked(const HeldScene& self, const F& f) {
  return without_gil(self, [&] {
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
                           bool find_crossings, bool patches, std::uint32_t patch_points, bool patch_depths,
                           const nb::object& accepts) {
  if (!accepts.is_none() && !PyCallable_Check(accepts.ptr()))
    throw nb::type_error(
        ("accepts: " + describe(accepts) + ", but None or a function of two BodyIds is needed").c_str());
  SceneOptions options;
  options.level = level;
  options.margin = margin;
  options.budget = budget_of(budget);
  options.surfaces = surfaces;
  options.find_crossings = find_crossings;
  options.patches = patches;
  options.patch_points = patch_points;
  options.patch_depths = patch_depths;
  return options;
}

template <class Class>
void bind_scene_bodies(Class& scene) {
  scene
      .def(
          "add",
          [](HeldScene& self, ColliderGiven given, bool is_static, std::uint32_t category, std::uint32_t mask,
             double weight, std::uint64_t user_data) {
            const std::shared_ptr<Side> side = kept_side_of(given, "collider");
            return locked_idle(self, [&] {
              const Reading reading({side.get()});
              const BodyId id = self.scene.add(side->current(), {is_static, category, mask, weight, user_data});
              if (self.sides.size() <= id.place) self.sides.resize(id.place + 1);
              self.sides[id.place] = side;
              return id;
            });
          },
          nb::arg("collider"), nb::kw_only(), nb::arg("is_static") = false, nb::arg("category") = 1,
          nb::arg("mask") = ~std::uint32_t{0}, nb::arg("weight") = 1.0, nb::arg("user_data") = 0,
          with_arguments(doc::Scene_add, {{"collider",
                                           "kept until remove() or replace(); a body can replace its own collider, and "
                                           "collider() then returns it"},
                                          {"is_static", doc::SceneBodyOptions_is_static},
                                          {"category", doc::SceneBodyOptions_category},
                                          {"mask", "the groups whose bodies it may touch, one bit per group"},
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
            std::shared_ptr<Side> side = kept_side_of(given, "collider");
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
          [](HeldScene& self, BodyId body, std::uint32_t category, std::uint32_t mask) {
            locked_idle(self, [&] { self.scene.set_masks(body, category, mask); });
          },
          nb::arg("body"), nb::arg("category"), nb::arg("mask"), doc::SceneBodyOptions_category)
      .def(
          "reserve",
          [](HeldScene& self, std::size_t bodies, std::size_t near_pairs, std::size_t contacts) {
            locked_idle(self, [&] { self.scene.reserve({bodies, near_pairs, contacts}); });
          },
          nb::kw_only(), nb::arg("bodies") = 0, nb::arg("near_pairs") = 0, nb::arg("contacts") = 0,
          with_arguments(doc::Scene_reserve, {{"bodies", doc::SceneReserve_bodies},
                                              {"near_pairs", doc::SceneReserve_near_pairs},
                                              {"contacts", doc::SceneReserve_contacts}})
              .c_str())
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
          "The collider of a body: set_transform() moves it.")
      .def("__len__", [](const HeldScene& self) { return locked(self, [&] { return self.scene.size(); }); })
      .def(
          "__contains__",
          [](const HeldScene& self, BodyId body) { return locked(self, [&] { return self.scene.has(body); }); },
          nb::arg("body"));
}

/// Calls f with the moving shape that is given. Throws TypeError for anything else.
template <class F>
auto with_moving_shape(const ShapeGiven& given, const F& f) {
  return with_shape(given, [&](const auto& shape) -> decltype(f(Sphere{})) {
    if constexpr (std::same_as<std::remove_cvref_t<decltype(shape)>, HalfSpace>) {
      throw nb::type_error("shape: a HalfSpace has no first touch; a Capsule, a ConvexHull or a sphere has");
    } else {
      return f(shape);
    }
  });
}

template <class Class>
void bind_scene_sweeps(Class& scene) {
  const std::initializer_list<std::pair<const char*, const char*>> filter_arguments{
      {"mask", doc::SceneFilter_mask}, {"ignored", doc::SceneFilter_ignored}};
  scene
      .def(
          "sweep",
          [](const HeldScene& self, ShapeGiven shape, Vec3 motion, std::uint32_t mask,
             const std::vector<BodyId>& ignored) {
            const SceneSweepHit hit = with_moving_shape(shape, [&](const auto& s) {
              return locked_idle(self, [&] {
                const Reading reading(self.all());
                return self.scene.sweep(s, motion, {mask, ignored});
              });
            });
            require_scene(hit.status);
            return hit;
          },
          nb::arg("shape"), nb::arg("motion"), nb::kw_only(), nb::arg("mask") = ~std::uint32_t{0},
          nb::arg("ignored") = std::vector<BodyId>(), with_arguments(doc::Scene_sweep, filter_arguments).c_str())
      .def(
          "sweep_all",
          [](HeldScene& self, ShapeGiven shape, Vec3 motion, std::uint32_t mask, const std::vector<BodyId>& ignored) {
            std::vector<SceneSweep> hits;
            const SceneStatus status = with_moving_shape(shape, [&](const auto& s) {
              return locked_idle(self, [&] {
                const Reading reading(self.all());
                const SceneSweepHits all = self.scene.sweep_all(s, motion, {mask, ignored});
                hits.assign(all.hits.begin(), all.hits.end());
                return all.status;
              });
            });
            require_scene(status);
            return hits;
          },
          nb::arg("shape"), nb::arg("motion"), nb::kw_only(), nb::arg("mask") = ~std::uint32_t{0},
          nb::arg("ignored") = std::vector<BodyId>(), with_arguments(doc::Scene_sweep_all, filter_arguments).c_str());
}

template <class Class>
void bind_scene_questions(Class& scene) {
  const std::initializer_list<std::pair<const char*, const char*>> filter_arguments{
      {"mask", doc::SceneFilter_mask}, {"ignored", doc::SceneFilter_ignored}};
  scene
      .def(
          "update",
          [](HeldScene& self, Threads* workers) {
            SceneStatus status;
            std::exception_ptr raised;
            {
              const Exchanging::Call exchanging(self);
              const nb::gil_scoped_release released;
              SignalCheck check;
              const Interrupt interrupt([&check] { check(); });
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
              // The filter raised, so the next update calls it for the pairs that are left.
              if (raised) self.scene.set_options(self.options);
            }
            if (raised) std::rethrow_exception(raised);
            require_scene(status);
            return status;
          },
          nb::arg("workers") = nb::none(), doc::Scene_update)
      .def(
          "pairs", [](const HeldScene& self) { return locked_idle(self, [&] { return rows_of(self.scene); }); },
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
              return row_of(self.scene, *pair);
            });
          },
          nb::arg("a"), nb::arg("b"), doc::Scene_find)
      .def(
          "first_hit",
          [](const HeldScene& self, Vec3 origin, Vec3 direction, double t_end, std::uint32_t mask,
             const std::vector<BodyId>& ignored) {
            const SceneRayHit hit = locked_idle(self, [&] {
              const Reading reading(self.all());
              return self.scene.first_hit({origin, direction, t_end}, {mask, ignored});
            });
            require_scene(hit.status);
            return hit;
          },
          nb::arg("origin"), nb::arg("direction"), nb::arg("t_end") = std::numeric_limits<double>::infinity(),
          nb::kw_only(), nb::arg("mask") = ~std::uint32_t{0}, nb::arg("ignored") = std::vector<BodyId>(),
          with_arguments(doc::Scene_first_hit, filter_arguments).c_str())
      .def(
          "all_hits",
          [](HeldScene& self, Vec3 origin, Vec3 direction, double t_end, std::uint32_t mask,
             const std::vector<BodyId>& ignored) {
            std::vector<SceneHit> hits;
            const SceneStatus status = locked_idle(self, [&] {
              const Reading reading(self.all());
              const SceneRayHits all = self.scene.all_hits({origin, direction, t_end}, {mask, ignored});
              hits.assign(all.hits.begin(), all.hits.end());
              return all.status;
            });
            require_scene(status);
            return hits;
          },
          nb::arg("origin"), nb::arg("direction"), nb::arg("t_end") = std::numeric_limits<double>::infinity(),
          nb::kw_only(), nb::arg("mask") = ~std::uint32_t{0}, nb::arg("ignored") = std::vector<BodyId>(),
          with_arguments(doc::Scene_all_hits, filter_arguments).c_str())
      .def(
          "touch",
          [](HeldScene& self, ShapeGiven shape, double margin, bool nearest, bool stop_at_first, bool collect_all,
             std::uint32_t mask, const std::vector<BodyId>& ignored) {
            const TouchOptions options{
                .margin = margin, .nearest = nearest, .stop_at_first = stop_at_first, .collect_all = collect_all};
            std::vector<FoundTouch> found;
            const SceneStatus status = with_shape(shape, [&](const auto& s) {
              return locked_idle(self, [&] {
                const Reading reading(self.all());
                const SceneStatus result = self.scene.touch(s, options, {mask, ignored});
                if (result)
                  for (const SceneTouch& touch : self.scene.touches()) found.push_back({touch.body, *touch.touch});
                return result;
              });
            });
            require_scene(status);
            return found;
          },
          nb::arg("shape"), nb::kw_only(), nb::arg("margin") = 0.0, nb::arg("nearest") = false,
          nb::arg("stop_at_first") = false, nb::arg("collect_all") = false, nb::arg("mask") = ~std::uint32_t{0},
          nb::arg("ignored") = std::vector<BodyId>(),
          with_arguments(doc::Scene_touch, {{"margin", doc::TouchOptions_margin},
                                            {"nearest", doc::TouchOptions_nearest},
                                            {"stop_at_first", doc::TouchOptions_stop_at_first},
                                            {"collect_all", doc::TouchOptions_collect_all},
                                            {"mask", doc::SceneFilter_mask},
                                            {"ignored", doc::SceneFilter_ignored}})
              .c_str());
}

}  // namespace

void bind_scene_class(nb::module_& m) {
  const std::initializer_list<std::pair<const char*, const char*>> arguments{
      {"level", doc::SceneOptions_level},
      {"margin", doc::SceneOptions_margin},
      {"budget", doc::SceneOptions_budget},
      {"surfaces", doc::SceneOptions_surfaces},
      {"find_crossings", doc::SceneOptions_find_crossings},
      {"patches", doc::SceneOptions_patches},
      {"patch_points", doc::SceneOptions_patch_points},
      {"patch_depths", doc::SceneOptions_patch_depths},
      {"accepts",
       "called with two BodyIds; returns True to keep a pair. It is called once when two bodies come near each other. "
       "It may call the scene's methods that identify bodies, and must not move bodies. Its exceptions come out of "
       "update(), and the next update calls it for the remaining pairs"}};
  nb::class_<HeldScene> scene(m, "Scene", collected<HeldScene>(), doc::Scene);
  scene
      .def(
          "__init__",
          [](HeldScene* self, std::optional<std::uint32_t> level, double margin, BudgetGiven budget, bool surfaces,
             bool find_crossings, bool patches, std::uint32_t patch_points, bool patch_depths, nb::object accepts) {
            new (self) HeldScene(scene_options(level, margin, budget, surfaces, find_crossings, patches, patch_points,
                                               patch_depths, accepts),
                                 std::move(accepts));
          },
          nb::kw_only(), nb::arg("level") = nb::none(), nb::arg("margin") = 0.0, nb::arg("budget") = nb::none(),
          nb::arg("surfaces") = false, nb::arg("find_crossings") = false, nb::arg("patches") = false,
          nb::arg("patch_points") = 4, nb::arg("patch_depths") = true, nb::arg("accepts") = nb::none(),
          nb::sig("def __init__(self, *, level: int | None = None, margin: float = 0.0, budget: morula.typing.Budget = "
                  "None, surfaces: bool = False, find_crossings: bool = False, patches: bool = False, patch_points: "
                  "int = 4, patch_depths: bool = True, accepts: collections.abc.Callable[[BodyId, "
                  "BodyId], bool] | None = None) -> None"),
          with_arguments(doc::Scene_Scene, arguments).c_str())
      .def(
          "set_options",
          [](HeldScene& self, std::optional<std::uint32_t> level, double margin, BudgetGiven budget, bool surfaces,
             bool find_crossings, bool patches, std::uint32_t patch_points, bool patch_depths, nb::object accepts) {
            SceneOptions options = scene_options(level, margin, budget, surfaces, find_crossings, patches, patch_points,
                                                 patch_depths, accepts);
            locked_idle(self, [&] {
              const Scene checked(options);  // throws for options out of range
              std::swap(self.options, options);
              std::swap(self.accepts, accepts);
              self.connect();
              self.scene.set_options(self.options);
            });
          },
          nb::kw_only(), nb::arg("level") = nb::none(), nb::arg("margin") = 0.0, nb::arg("budget") = nb::none(),
          nb::arg("surfaces") = false, nb::arg("find_crossings") = false, nb::arg("patches") = false,
          nb::arg("patch_points") = 4, nb::arg("patch_depths") = true, nb::arg("accepts") = nb::none(),
          nb::sig(
              "def set_options(self, *, level: int | None = None, margin: float = 0.0, budget: morula.typing.Budget "
              "= None, surfaces: bool = False, find_crossings: bool = False, patches: bool = False, patch_points: int "
              "= 4, patch_depths: bool = True, accepts: "
              "collections.abc.Callable[[BodyId, "
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
          nb::arg("budget").none(), "Sets options of the next update; others stay unchanged.")
      .def("__repr__", [](const HeldScene& self) {
        const std::size_t count = locked(self, [&] { return self.scene.size(); });
        return "<morula.Scene: " + std::to_string(count) + (count == 1 ? " body>" : " bodies>");
      });
  bind_scene_bodies(scene);
  bind_scene_questions(scene);
  bind_scene_sweeps(scene);
}

}  // namespace morula::python
