// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features of deforming surfaces: near, swept, crossing.
#include <algorithm>
#include <morula/morula.hpp>

#include "held_query.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "surfaces.hpp"

namespace morula::python {

namespace {

struct ProximityPairs {
  std::vector<ProximityPair> pairs;
};
struct SweptPairs {
  std::vector<SweptPair> pairs;
};

PairFilter filter_of(std::uint32_t rings, double rest_distance, bool same_component, nb::handle keeps) {
  PairFilter filter;
  filter.rings = rings;
  filter.rest_distance = rest_distance;
  filter.same_component = same_component;
  if (!keeps.is_none()) {
    filter.keeps = [keeps](const FeaturePair& pair) {
      const nb::gil_scoped_acquire gil;
      return nb::cast<bool>(nb::borrow<nb::callable>(keeps)(static_cast<int>(pair.kind), pair.a, pair.b));
    };
  }
  return filter;
}

/// Runs a query on one surface, or on two, and throws ValueError for what is refused.
template <class Query>
SurfaceQueryStatus ask(Query& query, const HeldSurface& a, const HeldSurface* b, Threads* workers) {
  const SurfaceQueryStatus status = without_gil([&] {
    CallWorkers call(workers);
    const SurfaceReading reading(&a, b);
    return b && b != &a ? query.run(a.tree, b->tree, call) : query.run(a.tree, call);
  });
  require(status);
  return status;
}

/// None, or a tuple (of, with) of bits per facet.
FacetMasks masks_of(nb::handle given, const char* name) {
  if (given.is_none()) return {};
  if (!PyTuple_Check(given.ptr()) || PyTuple_Size(given.ptr()) != 2) {
    throw nb::type_error(
        (std::string(name) + ": " + describe(given) + ", but None or a tuple of two arrays, of and with, is needed")
            .c_str());
  }
  return {indices_of(nb::object(given[0]), (std::string(name) + "[0]").c_str()),
          indices_of(nb::object(given[1]), (std::string(name) + "[1]").c_str())};
}

/// One surface, or two.
struct SeenSurfaces {
  std::shared_ptr<HeldSurface> a, b;

  SurfaceReading reading() const { return SurfaceReading(a.get(), b.get()); }
};

template <class Query, class Options>
using HeldPairQuery = HeldSurfaceQuery<Query, Options, SeenSurfaces>;

template <class Query, class Options>
nb::class_<HeldPairQuery<Query, Options>> bind_pair_query(nb::module_& m, const char* name, const char* text,
                                                          const char* run_text) {
  using Held = HeldPairQuery<Query, Options>;
  nb::class_<Held> query(m, name, text);
  query.def(
      "run",
      [](Held& self, std::shared_ptr<HeldSurface> a, std::shared_ptr<HeldSurface> b, Threads* workers) {
        return self.run({std::move(a), std::move(b)}, workers, [](Query& q, const SeenSurfaces& seen, Workers& call) {
          return seen.b && seen.b != seen.a ? q.run(seen.a->tree, seen.b->tree, call) : q.run(seen.a->tree, call);
        });
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::arg("workers") = nb::none(), run_text);
  bind_going_on(query, doc::ProximityQuery_resume);
  query.def(
      "open",
      [](Held& self) {
        auto open = self.locked([](const Query& q) {
          std::vector<std::pair<std::vector<std::uint32_t>, std::vector<std::uint32_t>>> parts;
          for (const OpenFacets& part : q.open())
            parts.emplace_back(std::vector<std::uint32_t>(part.a.begin(), part.a.end()),
                               std::vector<std::uint32_t>(part.b.begin(), part.b.end()));
          return parts;
        });
        nb::list all;
        for (auto& [of_a, of_b] : open)
          all.append(nb::make_tuple(own_indices(std::move(of_a)), own_indices(std::move(of_b))));
        return all;
      },
      nb::sig("def open(self) -> list[tuple[numpy.typing.NDArray[numpy.uint32], "
              "numpy.typing.NDArray[numpy.uint32]]]"),
      (std::string("A list of pairs of arrays. ") + doc::OpenFacets).c_str());
  return query;
}

/// A copy of what a query found.
template <class Rows, class Held, class Get>
Rows found_by(Held& self, const Get& get) {
  return self.locked([&](auto& query) {
    const auto found = get(query);
    return Rows{{found.begin(), found.end()}};
  });
}

PairFilter whole_filter(std::uint32_t rings, double rest_distance, bool same_component, nb::handle keeps,
                        nb::handle masks_a, nb::handle masks_b) {
  PairFilter filter = filter_of(rings, rest_distance, same_component, keeps);
  filter.masks_a = masks_of(masks_a, "masks_a");
  filter.masks_b = masks_of(masks_b, "masks_b");
  return filter;
}

constexpr const char* filter_arguments = R"(

Args:
    b: another surface; none: one surface with itself. Pairs that share a vertex are left out then.
    rings: pairs of which some two vertices are at most so many edges apart are left out.
    rest_distance: pairs that are this close at rest are left out, mesh units.
    same_component: pairs of one piece are left out.
    keeps: called with (kind, a, b) of every pair whose boxes are near; False leaves it out. Slow: it holds the
        interpreter's lock.)";

constexpr const char* query_arguments = R"(

Args:
    rings: pairs of which some two vertices are at most so many edges apart are left out, of one surface with itself.
    rest_distance: pairs that are this close at rest are left out, mesh units.
    same_component: pairs of one piece are left out.
    masks_a: two arrays of bits per facet, of and with: facets i of a and j of b are looked at when of[i] & with[j]
        and of[j] & with[i] are not 0. masks_b: the same of the other surface.
    keeps: called with (kind, a, b) of every pair whose boxes are near; False leaves it out. Slow.
    budget: box tests, or a time.)";

void bind_queries(nb::module_& m) {
  Record<SurfaceQueryStatus>(m, "SurfaceQueryStatus", "How far a query came.")
      .field("finished", &SurfaceQueryStatus::finished)
      .field("box_tests", &SurfaceQueryStatus::box_tests, doc::SurfaceQueryStatus_box_tests)
      .field("candidates", &SurfaceQueryStatus::candidates, doc::SurfaceQueryStatus_candidates);
  using Near = HeldPairQuery<ProximityQuery, ProximityOptions>;
  bind_pair_query<ProximityQuery, ProximityOptions>(m, "ProximityQuery", doc::ProximityQuery, doc::ProximityQuery_run)
      .def(
          "__init__",
          [](Near* self, double distance, bool nearest_features_once, std::uint32_t rings, double rest_distance,
             bool same_component, nb::handle masks_a, nb::handle masks_b, nb::object keeps, BudgetGiven budget) {
            PairFilter filter = whole_filter(rings, rest_distance, same_component, keeps, masks_a, masks_b);
            new (self) Near(ProximityOptions{distance, nearest_features_once, std::move(filter), budget_of(budget), {}},
                            std::move(keeps));
          },
          nb::kw_only(), nb::arg("distance"), nb::arg("nearest_features_once") = false, nb::arg("rings") = 0,
          nb::arg("rest_distance") = 0.0, nb::arg("same_component") = false, nb::arg("masks_a") = nb::none(),
          nb::arg("masks_b") = nb::none(), nb::arg("keeps") = nb::none(), nb::arg("budget") = nb::none(),
          nb::sig(
              "def __init__(self, *, distance: float, nearest_features_once: bool = False, rings: int = 0, "
              "rest_distance: float = 0.0, same_component: bool = False, "
              "masks_a: tuple[morula.typing.Array, morula.typing.Array] | None = None, masks_b: "
              "tuple[morula.typing.Array, morula.typing.Array] | None = None, "
              "keeps: collections.abc.Callable[[int, int, int], bool] | None = None, budget: morula.typing.Budget = "
              "None) -> None"),
          (std::string(doc::ProximityQuery_ProximityQuery) + query_arguments).c_str())
      .def(
          "pairs",
          [](Near& self) { return found_by<ProximityPairs>(self, [](ProximityQuery& q) { return q.pairs(); }); },
          doc::ProximityQuery_pairs)
      .def(
          "safe_distances",
          [](Near& self) {
            return own_numbers(self.locked([&](const ProximityQuery& query) {
              if (!self.seen.a) throw std::invalid_argument("nothing was asked yet");
              std::vector<double> distances(self.seen.a->tree.vertex_count());
              query.safe_distances(distances);
              return distances;
            }));
          },
          doc::ProximityQuery_safe_distances);
  using Swept = HeldPairQuery<SweptQuery, SweptOptions>;
  bind_pair_query<SweptQuery, SweptOptions>(m, "SweptQuery", doc::SweptQuery, doc::SweptQuery_run)
      .def(
          "__init__",
          [](Swept* self, double distance, bool candidates_only, std::uint32_t rings, double rest_distance,
             bool same_component, nb::handle masks_a, nb::handle masks_b, nb::object keeps, BudgetGiven budget) {
            PairFilter filter = whole_filter(rings, rest_distance, same_component, keeps, masks_a, masks_b);
            new (self) Swept(SweptOptions{distance, candidates_only, std::move(filter), budget_of(budget), {}},
                             std::move(keeps));
          },
          nb::kw_only(), nb::arg("distance") = 0.0, nb::arg("candidates_only") = false, nb::arg("rings") = 0,
          nb::arg("rest_distance") = 0.0, nb::arg("same_component") = false, nb::arg("masks_a") = nb::none(),
          nb::arg("masks_b") = nb::none(), nb::arg("keeps") = nb::none(), nb::arg("budget") = nb::none(),
          nb::sig(
              "def __init__(self, *, distance: float = 0.0, candidates_only: bool = False, rings: int = 0, "
              "rest_distance: float = 0.0, same_component: bool = False, "
              "masks_a: tuple[morula.typing.Array, morula.typing.Array] | None = None, masks_b: "
              "tuple[morula.typing.Array, morula.typing.Array] | None = None, "
              "keeps: collections.abc.Callable[[int, int, int], bool] | None = None, budget: morula.typing.Budget = "
              "None) -> None"),
          (std::string(doc::SweptQuery_SweptQuery) + query_arguments).c_str())
      .def(
          "pairs", [](Swept& self) { return found_by<SweptPairs>(self, [](SweptQuery& q) { return q.pairs(); }); },
          doc::SweptQuery_pairs)
      .def(
          "candidates",
          [](Swept& self) { return found_by<FeaturePairs>(self, [](SweptQuery& q) { return q.candidates(); }); },
          doc::SweptQuery_candidates)
      .def(
          "collision_free_step",
          [](Swept& self) { return self.locked([](const SweptQuery& q) { return q.collision_free_step(); }); },
          doc::SweptQuery_collision_free_step);
  using Crossing = HeldPairQuery<SurfaceCrossingQuery, SurfaceCrossingOptions>;
  bind_pair_query<SurfaceCrossingQuery, SurfaceCrossingOptions>(m, "SurfaceCrossingQuery", doc::SurfaceCrossingQuery,
                                                                doc::ProximityQuery_run)
      .def(
          "__init__",
          [](Crossing* self, std::uint32_t rings, double rest_distance, bool same_component, nb::handle masks_a,
             nb::handle masks_b, nb::object keeps, BudgetGiven budget) {
            PairFilter filter = whole_filter(rings, rest_distance, same_component, keeps, masks_a, masks_b);
            new (self) Crossing(SurfaceCrossingOptions{std::move(filter), budget_of(budget), {}}, std::move(keeps));
          },
          nb::kw_only(), nb::arg("rings") = 0, nb::arg("rest_distance") = 0.0, nb::arg("same_component") = false,
          nb::arg("masks_a") = nb::none(), nb::arg("masks_b") = nb::none(), nb::arg("keeps") = nb::none(),
          nb::arg("budget") = nb::none(),
          nb::sig(
              "def __init__(self, *, rings: int = 0, rest_distance: float = 0.0, same_component: bool = False, "
              "masks_a: tuple[morula.typing.Array, morula.typing.Array] | None = None, masks_b: "
              "tuple[morula.typing.Array, morula.typing.Array] | None = None, "
              "keeps: collections.abc.Callable[[int, int, int], bool] | None = None, budget: morula.typing.Budget = "
              "None) -> None"),
          (std::string("Pairs of facets that really intersect, as far as a budget reaches.") + query_arguments).c_str())
      .def(
          "pairs",
          [](Crossing& self) {
            return found_by<FeaturePairs>(self, [](SurfaceCrossingQuery& q) { return q.pairs(); });
          },
          doc::SurfaceCrossingQuery_pairs);
}

}  // namespace

void bind_surface(nb::module_& m) {
  nb::enum_<PairKind>(m, "PairKind", nb::is_arithmetic(), doc::PairKind)
      .value("vertex_facet", PairKind::vertex_facet, doc::PairKind_vertex_facet)
      .value("facet_vertex", PairKind::facet_vertex)
      .value("edge_edge", PairKind::edge_edge)
      .value("facet_facet", PairKind::facet_facet, doc::PairKind_facet_facet);

  nb::class_<HeldSurface>(m, "SurfaceTree", doc::SurfaceTree)
      .def(
          "__init__",
          [](HeldSurface* self, MeshGiven given) {
            const auto mesh = mesh_of(given, "rest");
            new (self) HeldSurface(without_gil([&] { return SurfaceTree(*mesh); }));
          },
          nb::arg("rest"), doc::SurfaceTree_SurfaceTree)
      .def(
          "update",
          [](HeldSurface& self, PositionsGiven from, nb::handle to, Threads* workers) {
            std::vector<Positions> positions;
            positions.emplace_back(from.object, "positions");
            if (!to.is_none()) positions.emplace_back(to, "to");
            Status status;
            {
              const nb::gil_scoped_release released;
              CallWorkers call(workers);
              const std::unique_lock lock(self.mutex);
              status = positions.size() == 1 ? self.tree.update(positions[0].view(), call)
                                             : self.tree.update(positions[0].view(), positions[1].view(), call);
              if (status) std::swap(self.positions, positions);
            }
            require(status);
          },
          nb::arg("positions"), nb::arg("to") = nb::none(), nb::arg("workers") = nb::none(),
          nb::sig("def update(self, positions: morula.typing.FloatArray, to: morula.typing.FloatArray | None = None, "
                  "workers: Workers | None = None) -> None"),
          (std::string(doc::SurfaceTree_update) + "\n\nto: where vertices go in a step. " + doc::SurfaceTree_update_2)
              .c_str())
      .def_prop_ro("is_step", [](const HeldSurface& self) { return self.tree.is_step(); })
      .def_prop_ro("vertex_count", [](const HeldSurface& self) { return self.tree.vertex_count(); })
      .def_prop_ro(
          "facets", [](nb::handle self) { return triples(nb::cast<HeldSurface&>(self).tree.facets(), self); },
          "(facets, 3) uint32; no copy.")
      .def_prop_ro(
          "edges",
          [](nb::handle self) {
            const auto edges = nb::cast<HeldSurface&>(self).tree.edges();
            return IndexPairs(reinterpret_cast<const std::uint32_t*>(edges.data()), {edges.size(), 2}, self);
          },
          doc::SurfaceTree_edges)
      .def(
          "hash", [](const HeldSurface& self) { return self.tree.hash(); }, doc::SurfaceTree_hash)
      .def("__repr__", [](const HeldSurface& self) {
        return "<morula.SurfaceTree: " + std::to_string(self.tree.facets().size()) + " facets, " +
               std::to_string(self.tree.edges().size()) + " edges>";
      });

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
      .property("point_b", near_column3(&ProximityPair::point_b), "(n, 3) float64, mesh units.");
  Record<SweptPairs> swept_pairs(m, "SweptPairs", "Pairs of features that may meet within a step.");
  pair_columns(swept_pairs);
  swept_pairs.property(
      "time",
      [](nb::handle self) {
        const auto& pairs = nb::cast<const SweptPairs&>(self).pairs;
        return column<SweptPair>(std::span<const SweptPair>(pairs), pairs.empty() ? nullptr : &pairs[0].time, self);
      },
      doc::SweptPair_time);

  bind_queries(m);

  m.def(
      "proximity",
      [](const HeldSurface& a, const HeldSurface* b, double distance, bool nearest_features_once, std::uint32_t rings,
         double rest_distance, bool same_component, nb::handle keeps, Threads* workers) {
        ProximityQuery query(
            {distance, nearest_features_once, filter_of(rings, rest_distance, same_component, keeps), {}, {}});
        ask(query, a, b, workers);
        return ProximityPairs{{query.pairs().begin(), query.pairs().end()}};
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("distance"),
      nb::arg("nearest_features_once") = false, nb::arg("rings") = 0, nb::arg("rest_distance") = 0.0,
      nb::arg("same_component") = false, nb::arg("keeps") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig("def proximity(a: SurfaceTree, b: SurfaceTree | None = None, *, distance: float, nearest_features_once: "
              "bool = False, "
              "rings: int = 0, rest_distance: float = 0.0, same_component: bool = False, "
              "keeps: collections.abc.Callable[[int, int, int], bool] | None = None, workers: Workers | None = None) "
              "-> ProximityPairs"),
      (std::string("All pairs of features within a distance. ") + doc::ProximityQuery + filter_arguments).c_str());
  m.def(
      "safe_distances",
      [](const HeldSurface& a, const HeldSurface* b, double distance, Threads* workers) {
        ProximityQuery query({distance, false, {}, {}, {}});
        ask(query, a, b, workers);
        std::vector<double> distances(a.tree.vertex_count());
        query.safe_distances(distances);
        return own_numbers(std::move(distances));
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("distance"), nb::arg("workers") = nb::none(),
      doc::ProximityQuery_safe_distances);
  m.def(
      "swept",
      [](const HeldSurface& a, const HeldSurface* b, double distance, std::uint32_t rings, double rest_distance,
         bool same_component, nb::handle keeps, Threads* workers) {
        SweptQuery query({distance, false, filter_of(rings, rest_distance, same_component, keeps), {}, {}});
        ask(query, a, b, workers);
        return SweptPairs{{query.pairs().begin(), query.pairs().end()}};
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("distance") = 0.0, nb::arg("rings") = 0,
      nb::arg("rest_distance") = 0.0, nb::arg("same_component") = false, nb::arg("keeps") = nb::none(),
      nb::arg("workers") = nb::none(),
      nb::sig("def swept(a: SurfaceTree, b: SurfaceTree | None = None, *, distance: float = 0.0, rings: int = 0, "
              "rest_distance: float = 0.0, same_component: bool = False, "
              "keeps: collections.abc.Callable[[int, int, int], bool] | None = None, workers: Workers | None = None) "
              "-> SweptPairs"),
      (std::string(doc::SweptQuery) + filter_arguments).c_str());
  m.def(
      "swept_candidates",
      [](const HeldSurface& a, const HeldSurface* b, double distance, std::uint32_t rings, Threads* workers) {
        SweptQuery query({distance, true, filter_of(rings, 0, false, nb::none()), {}, {}});
        ask(query, a, b, workers);
        return FeaturePairs{{query.candidates().begin(), query.candidates().end()}};
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("distance") = 0.0, nb::arg("rings") = 0,
      nb::arg("workers") = nb::none(), doc::SweptOptions_candidates_only);
  m.def(
      "surface_crossings",
      [](const HeldSurface& a, const HeldSurface* b, std::uint32_t rings, double rest_distance, bool same_component,
         nb::handle keeps, Threads* workers) {
        SurfaceCrossingQuery query({filter_of(rings, rest_distance, same_component, keeps), {}, {}});
        ask(query, a, b, workers);
        return FeaturePairs{{query.pairs().begin(), query.pairs().end()}};
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::kw_only(), nb::arg("rings") = 0, nb::arg("rest_distance") = 0.0,
      nb::arg("same_component") = false, nb::arg("keeps") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig("def surface_crossings(a: SurfaceTree, b: SurfaceTree | None = None, *, rings: int = 0, rest_distance: "
              "float = 0.0, "
              "same_component: bool = False, keeps: collections.abc.Callable[[int, int, int], bool] | None = None, "
              "workers: Workers | None = None) -> FeaturePairs"),
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
