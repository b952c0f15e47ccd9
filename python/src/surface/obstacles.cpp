// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Obstacles of surfaces: floors, balls, capsules, hulls and distance fields, where they are or over a step.
#include <algorithm>
#include <limits>
#include <morula/morula.hpp>

#include "choices.hpp"
#include "contacts.hpp"
#include "held_query.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "surfaces.hpp"

namespace morula::python {

namespace {

/// A field as Python gives it: a SignedDistance, or a function of points.
struct HeldField {
  nb::object value, gradient;
  double lipschitz, tolerance;

  void visit(References& references) const {
    references(value);
    references(gradient);
  }
  void forget() {
    value.reset();
    gradient.reset();
  }
};

struct ObstacleContacts {
  std::vector<ObstacleContact> rows;
};
struct ObstacleImpacts {
  std::vector<ObstacleImpact> rows;
};

/// The caller keeps `held` for as long as the field is used. If the collector has dropped its functions, all distances
/// are large.
DistanceField field_of(const HeldField& held) {
  DistanceField field;
  field.lipschitz = held.lipschitz;
  field.tolerance = held.tolerance;
  if (nb::isinstance<SignedDistance>(held.value)) {
    const auto* distance = nb::cast<const SignedDistance*>(held.value);
    field.value = [distance](const Vec3& p) { return (*distance)(p); };
  } else {
    field.value = [&held](const Vec3& p) {
      const nb::gil_scoped_acquire gil;
      if (!held.value.is_valid()) return std::numeric_limits<double>::max();
      return returned<double>(held.value(p), "value", "a number");
    };
  }
  if (!held.gradient.is_none()) {
    field.gradient = [&held](const Vec3& p) {
      const nb::gil_scoped_acquire gil;
      if (!held.gradient.is_valid()) return Vec3{1, 0, 0};
      return returned<Vec3>(held.gradient(p), "gradient", "three numbers");
    };
  }
  return field;
}

Obstacle obstacle_of(const ObstacleGiven& given) {
  const nb::handle object = given.object;
  if (nb::isinstance<HalfSpace>(object)) return nb::cast<HalfSpace>(object);
  if (nb::isinstance<Capsule>(object)) return nb::cast<Capsule>(object);
  if (nb::isinstance<ConvexHull>(object)) return nb::cast<const ConvexHull&>(object);
  if (nb::isinstance<HeldField>(object)) return field_of(nb::cast<const HeldField&>(object));
  Sphere sphere;
  if (!nb::try_cast(object, sphere)) {
    throw nb::type_error(("obstacle: " + describe(object) +
                          ", but a HalfSpace, a Capsule, a ConvexHull, a DistanceField or a sphere (x, y, z, radius) "
                          "is needed")
                             .c_str());
  }
  return sphere;
}

ObstacleOptions options_of(double margin, std::string_view features, const Callback& accepts,
                           const BudgetGiven& budget) {
  ObstacleOptions options;
  options.margin = margin;
  options.features = choice<ObstacleFeatures>(features, "features", feature_choices);
  if (accepts) options.accepts = [accepts](std::uint32_t feature) { return says(accepts, feature); };
  options.budget = budget_of(budget);
  return options;
}

/// A surface, and an obstacle with the Python functions that fields call.
struct SeenObstacle {
  std::shared_ptr<HeldSurface> surface;
  nb::object given;
  Obstacle obstacle;

  SurfaceReading reading() const { return SurfaceReading(surface.get()); }
  void visit(References& references) const {
    references(surface);
    references(given);
  }
};

template <class Query>
using HeldObstacleQuery = HeldSurfaceQuery<Query, ObstacleOptions, SeenObstacle>;

constexpr const char* obstacle_query_arguments = R"(

Args:
    margin: largest distance outside that counts as a contact, mesh units.
    features: facets; or the vertices that facets use, which are sufficient for a floor.
    accepts: called with the number of every near vertex or facet; False skips it. Slow, because it needs the GIL.
    budget: box tests, or a time.)";

template <class Query>
nb::class_<HeldObstacleQuery<Query>> bind_query(nb::module_& m, const char* name, const char* text) {
  using Held = HeldObstacleQuery<Query>;
  nb::class_<Held> query(m, name, collected<Held>(), text);
  query.def(
      "__init__",
      [](Held* self, double margin, std::string_view features, const nb::object& accepts, BudgetGiven budget) {
        Callback callback = callback_of(accepts, "accepts", "None or a function of a number");
        ObstacleOptions options = options_of(margin, features, callback, budget);
        new (self) Held(std::move(options), std::move(callback));
      },
      nb::kw_only(), nb::arg("margin") = 0.0, nb::arg("features") = "facets", nb::arg("accepts") = nb::none(),
      nb::arg("budget") = nb::none(),
      nb::sig("def __init__(self, *, margin: float = 0.0, features: morula.typing.Features = 'facets', "
              "accepts: collections.abc.Callable[[int], bool] | None = None, budget: morula.typing.Budget = None) "
              "-> None"),
      (std::string(doc::ObstacleQuery_ObstacleQuery) + obstacle_query_arguments).c_str());
  bind_going_on(query, doc::ObstacleQuery_resume);
  query.def(
      "open",
      [](Held& self) {
        auto open = self.locked([](const Query& q) {
          std::vector<std::vector<std::uint32_t>> parts;
          for (const std::span<const std::uint32_t> part : q.open()) parts.emplace_back(part.begin(), part.end());
          return parts;
        });
        nb::list all;
        for (auto& facets : open) all.append(own_indices(std::move(facets)));
        return all;
      },
      nb::sig("def open(self) -> list[numpy.typing.NDArray[numpy.uint32]]"), doc::ObstacleQuery_open);
  return query;
}

SeenObstacle seen_of(std::shared_ptr<HeldSurface> surface, const ObstacleGiven& obstacle) {
  return {std::move(surface), nb::borrow(obstacle.object), obstacle_of(obstacle)};
}

}  // namespace

void bind_obstacles(nb::module_& m) {
  nb::class_<HeldField>(m, "DistanceField", collected<HeldField>(), doc::DistanceField)
      .def(
          "__init__",
          [](HeldField* self, nb::object value, double lipschitz, double tolerance, nb::object gradient) {
            if (!nb::isinstance<SignedDistance>(value) && !PyCallable_Check(value.ptr()))
              throw nb::type_error(
                  ("value: " + describe(value) + ", but a SignedDistance or a function of a point is needed").c_str());
            if (!gradient.is_none() && !PyCallable_Check(gradient.ptr()))
              throw nb::type_error(
                  ("gradient: " + describe(gradient) + ", but None or a function of a point is needed").c_str());
            new (self) HeldField{std::move(value), std::move(gradient), lipschitz, tolerance};
          },
          nb::arg("value"), nb::kw_only(), nb::arg("lipschitz") = 1.0, nb::arg("tolerance") = 0.0,
          nb::arg("gradient") = nb::none(),
          nb::sig("def __init__(self, value: SignedDistance | collections.abc.Callable[[tuple[float, float, float]], "
                  "float], *, lipschitz: float = 1.0, tolerance: float = 0.0, gradient: "
                  "collections.abc.Callable[[tuple[float, float, float]], morula.typing.Vector] | None = None) -> "
                  "None"),
          with_arguments(
              "A Python function is called with the GIL, for one point at a time; a SignedDistance needs no GIL.",
              {{"value", doc::DistanceField_value},
               {"lipschitz", doc::DistanceField_lipschitz},
               {"tolerance", doc::DistanceField_tolerance},
               {"gradient", doc::DistanceField_gradient}})
              .c_str())
      .def_ro("lipschitz", &HeldField::lipschitz)
      .def_ro("tolerance", &HeldField::tolerance);

  Record<ObstacleContacts>(m, "ObstacleContacts", doc::ObstacleContact)
      .property("feature", MORULA_COLUMN(ObstacleContacts, rows, feature), doc::ObstacleContact_feature)
      .property("distance", MORULA_COLUMN(ObstacleContacts, rows, distance), doc::ObstacleContact_distance)
      .property("point", MORULA_COLUMN3(ObstacleContacts, rows, point), doc::ObstacleContact_point)
      .property("weights", MORULA_COLUMN3(ObstacleContacts, rows, weights), doc::ObstacleContact_weights)
      .property("normal", MORULA_COLUMN3(ObstacleContacts, rows, normal), doc::ObstacleContact_normal)
      .table([](const ObstacleContacts& self) { return self.rows.size(); });
  Record<ObstacleImpacts>(m, "ObstacleImpacts", doc::ObstacleImpact)
      .property("feature", MORULA_COLUMN(ObstacleImpacts, rows, feature), "(n,) uint32: vertices or facets.")
      .property("time", MORULA_COLUMN(ObstacleImpacts, rows, time), doc::ObstacleImpact_time)
      .table([](const ObstacleImpacts& self) { return self.rows.size(); });

  using Still = HeldObstacleQuery<ObstacleQuery>;
  bind_query<ObstacleQuery>(m, "ObstacleQuery", doc::ObstacleQuery)
      .def(
          "run",
          [](Still& self, std::shared_ptr<HeldSurface> surface, ObstacleGiven obstacle, Threads* workers) {
            return self.run(seen_of(std::move(surface), obstacle), workers,
                            [](ObstacleQuery& query, const SeenObstacle& seen, Workers& call) {
                              return query.run(seen.surface->tree, seen.obstacle, call);
                            });
          },
          nb::arg("surface"), nb::arg("obstacle"), nb::arg("workers") = nb::none(), doc::ObstacleQuery_run)
      .def(
          "contacts",
          [](Still& self) { return found_by<ObstacleContacts>(self, [](ObstacleQuery& q) { return q.contacts(); }); },
          doc::ObstacleQuery_contacts);
  using Swept = HeldObstacleQuery<SweptObstacleQuery>;
  bind_query<SweptObstacleQuery>(m, "SweptObstacleQuery", doc::SweptObstacleQuery)
      .def(
          "run",
          [](Swept& self, std::shared_ptr<HeldSurface> surface, ObstacleGiven obstacle, Vec3 motion, Threads* workers) {
            return self.run(seen_of(std::move(surface), obstacle), workers,
                            [&](SweptObstacleQuery& query, const SeenObstacle& seen, Workers& call) {
                              return query.run(seen.surface->tree, seen.obstacle, motion, call);
                            });
          },
          nb::arg("surface"), nb::arg("obstacle"), nb::arg("motion") = Vec3{}, nb::arg("workers") = nb::none(),
          doc::SweptObstacleQuery_run)
      .def(
          "impacts",
          [](Swept& self) {
            return found_by<ObstacleImpacts>(self, [](SweptObstacleQuery& q) { return q.impacts(); });
          },
          doc::ObstacleImpact)
      .def(
          "collision_free_step",
          [](Swept& self) { return self.locked([](const SweptObstacleQuery& q) { return q.collision_free_step(); }); },
          doc::SweptObstacleQuery_collision_free_step);
}

}  // namespace morula::python
