// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features of deforming surfaces, found once: near, swept, crossing.
#include "pairs.hpp"

#include <morula/morula.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// Runs a query once, and throws ValueError for rejected arguments.
template <class Query>
void run_locked(Query& query, const HeldSurface& a, const HeldSurface* b, Threads* workers) {
  warn_of_duplicates(a, b, query.options().filter.rest_distance);
  const SurfaceQueryStatus status = without_gil([&] {
    CallWorkers call(workers);
    const SurfaceReading reading(&a, b);
    return run_on(query, a, b, call);
  });
  require(status);
}

constexpr const char* filter_arguments = R"(

Args:
    b: another surface; None: one surface with itself, without pairs that share a vertex.
    rings: skips pairs with two vertices at most this many edges apart.
    rest_distance: skips pairs that are at most this far apart at rest, mesh units.
    same_component: skips pairs of one component.
    accepts: called with (kind, a, b) of every pair with near boxes; False skips it. Slow, because it needs the GIL.)";

}  // namespace

void warn_of_duplicates(const HeldSurface& a, const HeldSurface* b, double rest_distance) {
  if ((b != nullptr && b != &a) || rest_distance > 0 || a.has_warned) return;
  const std::size_t count = without_gil([&] { return a.tree.duplicate_vertices(); });
  if (count == 0 || a.has_warned.exchange(true)) return;
  const std::string text =
      "the surface has " + std::to_string(count) + (count == 1 ? " vertex" : " vertices") +
      " at the position of another vertex: pairs that meet there are found, as if the surface were cut; "
      "morula.weld_vertices() or morula.read_welded_mesh() merges them";
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) < 0) throw nb::python_error();
}

PairFilter filter_of(std::uint32_t rings, double rest_distance, bool same_component, const Callback& accepts) {
  PairFilter filter;
  filter.rings = rings;
  filter.rest_distance = rest_distance;
  filter.same_component = same_component;
  if (accepts)
    filter.accepts = [accepts](const FeaturePair& pair) {
      return says(accepts, static_cast<int>(pair.kind), pair.a, pair.b);
    };
  return filter;
}

void bind_pair_records(nb::module_& m) {
  Record<FeaturePairs> feature_pairs(m, "FeaturePairs", doc::FeaturePair);
  pair_columns(feature_pairs);
  Record<ProximityPairs> proximity_pairs(m, "ProximityPairs", "Pairs of features within a distance.");
  pair_columns(proximity_pairs);
  const auto near_column3 = [](auto member) {
    return [member](nb::handle self) {
      const auto& pairs = nb::cast<const ProximityPairs&>(self).pairs;
      return column3<ProximityPair>(std::span<const ProximityPair>(pairs),
                                    pairs.empty() ? nullptr : &(pairs[0].*member), self);
    };
  };
  proximity_pairs
      .property(
          "distance",
          [](nb::handle self) {
            const auto& pairs = nb::cast<const ProximityPairs&>(self).pairs;
            return column<ProximityPair>(std::span<const ProximityPair>(pairs),
                                         pairs.empty() ? nullptr : &pairs[0].distance, self);
          },
          doc::ProximityPair_distance)
      .property("weights_a", near_column3(&ProximityPair::weights_a), doc::ProximityPair_weights_a)
      .property("weights_b", near_column3(&ProximityPair::weights_b), doc::ProximityPair_weights_a)
      .property("point_a", near_column3(&ProximityPair::point_a), "(n, 3) float64, mesh units.")
      .property("point_b", near_column3(&ProximityPair::point_b), "(n, 3) float64, mesh units.")
      .property(
          "direction",
          [](const ProximityPairs& self) {
            std::vector<Vec3> directions;
            for (const ProximityPair& pair : self.pairs) directions.push_back(pair.direction());
            return own_points(std::move(directions));
          },
          doc::ProximityPair_direction);
  Record<SweptPairs> swept_pairs(m, "SweptPairs", "Pairs of features that may meet within a step.");
  pair_columns(swept_pairs);
  swept_pairs.property(
      "time",
      [](nb::handle self) {
        const auto& pairs = nb::cast<const SweptPairs&>(self).pairs;
        return column<SweptPair>(std::span<const SweptPair>(pairs), pairs.empty() ? nullptr : &pairs[0].time, self);
      },
      doc::SweptPair_time);
}

void bind_pairs(nb::module_& m) {
  m.def(
      "proximity",
      [](const HeldSurface& a, const HeldSurface* b, double distance, bool nearest_features_once, std::uint32_t rings,
         double rest_distance, bool same_component, const nb::object& accepts, Threads* workers) {
        ProximityQuery query(
            {distance,
             nearest_features_once,
             filter_of(rings, rest_distance, same_component, callback_of(accepts, "accepts", pair_filter_wanted)),
             {},
             {}});
        run_locked(query, a, b, workers);
        return ProximityPairs{copy_of(query.pairs())};
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("distance"),
      nb::arg("nearest_features_once") = false, nb::arg("rings") = 0, nb::arg("rest_distance") = 0.0,
      nb::arg("same_component") = false, nb::arg("accepts") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig("def proximity(a: SurfaceTree, b: SurfaceTree | None = None, *, distance: float, nearest_features_once: "
              "bool = False, rings: int = 0, rest_distance: float = 0.0, same_component: bool = False, accepts: "
              "collections.abc.Callable[[int, int, int], bool] | None = None, workers: Workers | None = None) -> "
              "ProximityPairs"),
      (std::string("All pairs of features within a distance. ") + doc::ProximityQuery + filter_arguments).c_str());
  m.def(
      "safe_distances",
      [](const HeldSurface& a, const HeldSurface* b, double distance, Threads* workers) {
        ProximityQuery query({distance, false, {}, {}, {}});
        run_locked(query, a, b, workers);
        std::vector<double> distances(a.tree.vertex_count());
        query.safe_distances(distances);
        return own_numbers(std::move(distances));
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("distance"), nb::arg("workers") = nb::none(),
      doc::ProximityQuery_safe_distances);
  m.def(
      "swept",
      [](const HeldSurface& a, const HeldSurface* b, double distance, std::uint32_t rings, double rest_distance,
         bool same_component, const nb::object& accepts, Threads* workers) {
        SweptQuery query(
            {distance,
             false,
             filter_of(rings, rest_distance, same_component, callback_of(accepts, "accepts", pair_filter_wanted)),
             {},
             {}});
        run_locked(query, a, b, workers);
        return SweptPairs{copy_of(query.pairs())};
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("distance") = 0.0, nb::arg("rings") = 0,
      nb::arg("rest_distance") = 0.0, nb::arg("same_component") = false, nb::arg("accepts") = nb::none(),
      nb::arg("workers") = nb::none(),
      nb::sig("def swept(a: SurfaceTree, b: SurfaceTree | None = None, *, distance: float = 0.0, rings: int = 0, "
              "rest_distance: float = 0.0, same_component: bool = False, "
              "accepts: collections.abc.Callable[[int, int, int], bool] | None = None, workers: Workers | None = None) "
              "-> SweptPairs"),
      (std::string(doc::SweptQuery) + filter_arguments).c_str());
  m.def(
      "swept_candidates",
      [](const HeldSurface& a, const HeldSurface* b, double distance, std::uint32_t rings, Threads* workers) {
        SweptQuery query({distance, true, filter_of(rings, 0, false, nullptr), {}, {}});
        run_locked(query, a, b, workers);
        return FeaturePairs{copy_of(query.candidates())};
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("distance") = 0.0, nb::arg("rings") = 0,
      nb::arg("workers") = nb::none(), doc::SweptOptions_candidates_only);
  m.def(
      "surface_crossings",
      [](const HeldSurface& a, const HeldSurface* b, std::uint32_t rings, double rest_distance, bool same_component,
         const nb::object& accepts, Threads* workers) {
        SurfaceCrossingQuery query(
            {filter_of(rings, rest_distance, same_component, callback_of(accepts, "accepts", pair_filter_wanted)),
             {},
             {}});
        run_locked(query, a, b, workers);
        return FeaturePairs{copy_of(query.pairs())};
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("rings") = 0, nb::arg("rest_distance") = 0.0,
      nb::arg("same_component") = false, nb::arg("accepts") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig("def surface_crossings(a: SurfaceTree, b: SurfaceTree | None = None, *, rings: int = 0, rest_distance: "
              "float = 0.0, same_component: bool = False, accepts: collections.abc.Callable[[int, int, int], bool] | "
              "None = None, workers: Workers | None = None) -> FeaturePairs"),
      (std::string(doc::SurfaceCrossingQuery) + filter_arguments).c_str());
  m.def(
      "time_of_impact",
      [](ArrayGiven a_from, ArrayGiven a_to, ArrayGiven b_from, ArrayGiven b_to, double distance) {
        const auto af = points_of(a_from.object, "a_from"), at = points_of(a_to.object, "a_to"),
                   bf = points_of(b_from.object, "b_from"), bt = points_of(b_to.object, "b_to");
        const bool fits = af.size() == at.size() && bf.size() == bt.size() &&
                          ((af.size() == 1 && bf.size() == 3) || (af.size() == 3 && bf.size() == 1) ||
                           (af.size() == 2 && bf.size() == 2));
        if (!fits)
          throw std::invalid_argument(
              "a vertex (1, 3) and a facet (3, 3), or two edges (2, 3) are needed, at both ends of the step");
        return time_of_impact(af, at, bf, bt, distance);
      },
      nb::arg("a_from"), nb::arg("a_to"), nb::arg("b_from"), nb::arg("b_to"), nb::arg("distance") = 0.0,
      doc::time_of_impact);
}

}  // namespace morula::python
