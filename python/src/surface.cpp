// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features of deforming surfaces: near, swept, crossing.
#include <morula/morula.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// A surface tree and the positions that it borrows.
struct HeldSurface {
  SurfaceTree tree;
  std::vector<Positions> positions;
  mutable std::shared_mutex mutex;

  explicit HeldSurface(SurfaceTree&& made) : tree(std::move(made)) {}
};

struct FeaturePairs {
  std::vector<FeaturePair> pairs;
};
struct ProximityPairs {
  std::vector<ProximityPair> pairs;
};
struct SweptPairs {
  std::vector<SweptPair> pairs;
};

template <class Holder, class Member>
auto pair_column(Member FeaturePair::*member) {
  return [member](nb::handle self) {
    const auto& pairs = nb::cast<const Holder&>(self).pairs;
    using Row = std::remove_cvref_t<decltype(pairs[0])>;
    using Scalar = std::conditional_t<std::is_enum_v<Member>, std::uint8_t, Member>;
    return column<Row>(std::span<const Row>(pairs),
                       pairs.empty() ? nullptr : reinterpret_cast<const Scalar*>(&(pairs[0].*member)), self);
  };
}

constexpr const char* kind_text = "(n,) uint8: morula.PairKind of each pair.";
constexpr const char* index_text = "(n,) uint32: a vertex, a facet, or an edge of SurfaceTree.edges.";

template <class Holder>
Record<Holder>& pair_columns(Record<Holder>& record) {
  record.property("kind", pair_column<Holder>(&FeaturePair::kind), kind_text)
      .property("a", pair_column<Holder>(&FeaturePair::a), index_text)
      .property("b", pair_column<Holder>(&FeaturePair::b), index_text)
      .table([](const Holder& self) { return self.pairs.size(); });
  return record;
}

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
    std::shared_lock<std::shared_mutex> first(a.mutex, std::defer_lock), second;
    if (b && b != &a) {
      second = std::shared_lock(b->mutex, std::defer_lock);
      // One order for everybody.
      if (b < &a)
        second.lock(), first.lock();
      else
        first.lock(), second.lock();
    } else {
      first.lock();
    }
    return b && b != &a ? query.run(a.tree, b->tree, call) : query.run(a.tree, call);
  });
  require(status);
  return status;
}

constexpr const char* filter_arguments = R"(

Args:
    b: another surface; none: one surface with itself. Pairs that share a vertex are left out then.
    rings: pairs of which some two vertices are at most so many edges apart are left out.
    rest_distance: pairs that are this close at rest are left out, mesh units.
    same_component: pairs of one piece are left out.
    keeps: called with (kind, a, b) of every pair whose boxes are near; False leaves it out. Slow: it holds the
        interpreter's lock.)";

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
