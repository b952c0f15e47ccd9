// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Queries about pairs of features, which keep their memory and go on where a budget ended them.
#include <memory>
#include <morula/morula.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "held_query.hpp"
#include "holders.hpp"
#include "layer_patches.hpp"
#include "module.hpp"
#include "pairs.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// None, or a tuple (category, mask) of bits per facet.
FacetMasks masks_of(nb::handle given, const char* name) {
  if (given.is_none()) return {};
  if (!PyTuple_Check(given.ptr()) || PyTuple_Size(given.ptr()) != 2) {
    throw nb::type_error((std::string(name) + ": " + describe(given) +
                          ", but None or a tuple of two arrays, category and mask, is needed")
                             .c_str());
  }
  return {indices_of(nb::object(given[0]), (std::string(name) + "[0]").c_str()),
          indices_of(nb::object(given[1]), (std::string(name) + "[1]").c_str())};
}

/// One surface, or two.
struct SeenSurfaces {
  std::shared_ptr<HeldSurface> a, b;

  SurfaceReading reading() const { return SurfaceReading(a.get(), b.get()); }
  void visit(References& references) const {
    references(a);
    references(b);
  }
};

template <class Query, class Options>
using HeldPairQuery = HeldSurfaceQuery<Query, Options, SeenSurfaces>;

template <class Query, class Options>
nb::class_<HeldPairQuery<Query, Options>> bind_pair_query(nb::module_& m, const char* name, const char* text,
                                                          const char* run_text,
                                                          const char* resume_text = doc::ProximityQuery_resume) {
  using Held = HeldPairQuery<Query, Options>;
  nb::class_<Held> query(m, name, collected<Held>(), text);
  query.def(
      "run",
      [](Held& self, std::shared_ptr<HeldSurface> a, std::shared_ptr<HeldSurface> b, Threads* workers) {
        warn_of_duplicates(*a, b.get(), self.options.filter.rest_distance);
        return self.run({std::move(a), std::move(b)}, workers, [](Query& q, const SeenSurfaces& seen, Workers& call) {
          return run_on(q, *seen.a, seen.b.get(), call);
        });
      },
      nb::arg("a"), nb::arg("b") = nb::none(), nb::arg("workers") = nb::none(), run_text);
  bind_going_on(query, resume_text);
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

constexpr const char* query_arguments = R"(
    rings: for one surface with itself, skips pairs with two vertices at most this many edges apart.
    rest_distance: skips pairs that are at most this far apart at rest, mesh units.
    same_component: skips pairs of one component.
    masks_a: two arrays of bits per facet, category and mask: facets i of a and j of b are compared if
        category[i] & mask[j] and category[j] & mask[i] are not 0. masks_b: the arrays of the other surface.
    accepts: called with (kind, a, b) of every pair with near boxes; False skips it. Slow.
    budget: box tests, or a time.)";

/// __init__() of a pair query: arguments `own` of its own, of types Own, which are the first members of its options;
/// then those of all. text: ends with a list of arguments (with_arguments), which goes on. own_text: its own ones, each
/// with a comma after it, as Python writes them.
template <class... Own, class Query, class Options, class... Args>
void bind_init(nb::class_<HeldPairQuery<Query, Options>>& query, const char* own_text, const std::string& text,
               const Args&... own) {
  using Held = HeldPairQuery<Query, Options>;
  query.def(
      "__init__",
      [](Held* self, Own... values, std::uint32_t rings, double rest_distance, bool same_component, nb::handle masks_a,
         nb::handle masks_b, nb::object accepts, BudgetGiven budget) {
        Callback callback = callback_of(accepts, "accepts", pair_filter_wanted);
        PairFilter filter = filter_of(rings, rest_distance, same_component, callback);
        filter.masks_a = masks_of(masks_a, "masks_a");
        filter.masks_b = masks_of(masks_b, "masks_b");
        new (self) Held(Options{values..., std::move(filter), budget_of(budget), {}}, std::move(callback));
      },
      nb::kw_only(), own..., nb::arg("rings") = 0, nb::arg("rest_distance") = 0.0, nb::arg("same_component") = false,
      nb::arg("masks_a") = nb::none(), nb::arg("masks_b") = nb::none(), nb::arg("accepts") = nb::none(),
      nb::arg("budget") = nb::none(),
      nb::sig((std::string("def __init__(self, *, ") + own_text +
               "rings: int = 0, rest_distance: float = 0.0, same_component: bool = False, "
               "masks_a: tuple[morula.typing.Array, morula.typing.Array] | None = None, masks_b: "
               "tuple[morula.typing.Array, morula.typing.Array] | None = None, "
               "accepts: collections.abc.Callable[[int, int, int], bool] | None = None, budget: morula.typing.Budget = "
               "None) -> None")
                  .c_str()),
      (text + query_arguments).c_str());
}

}  // namespace

void bind_pair_queries(nb::module_& m) {
  Record<SurfaceQueryStatus>(m, "SurfaceQueryStatus", "The progress of a query.")
      .field("finished", &SurfaceQueryStatus::finished)
      .field("box_tests", &SurfaceQueryStatus::box_tests, doc::SurfaceQueryStatus_box_tests)
      .field("candidates", &SurfaceQueryStatus::candidates, doc::SurfaceQueryStatus_candidates);
  using Near = HeldPairQuery<ProximityQuery, ProximityOptions>;
  auto near = bind_pair_query<ProximityQuery, ProximityOptions>(m, "ProximityQuery", doc::ProximityQuery,
                                                                doc::ProximityQuery_run);
  bind_init<double, bool>(near, "distance: float, nearest_features_once: bool = False, ",
                          with_arguments(doc::ProximityQuery_ProximityQuery, {}), nb::arg("distance"),
                          nb::arg("nearest_features_once") = false);
  near.def(
          "pairs",
          [](Near& self) { return found_by<ProximityPairs>(self, [](ProximityQuery& q) { return q.pairs(); }); },
          doc::ProximityQuery_pairs)
      .def(
          "safe_distances",
          [](Near& self) {
            return own_numbers(self.locked([&](const ProximityQuery& query) {
              if (!self.seen.a) throw std::invalid_argument("the query has not run yet");
              std::vector<double> distances(self.seen.a->tree.vertex_count());
              query.safe_distances(distances);
              return distances;
            }));
          },
          doc::ProximityQuery_safe_distances);
  using Swept = HeldPairQuery<SweptQuery, SweptOptions>;
  auto swept = bind_pair_query<SweptQuery, SweptOptions>(m, "SweptQuery", doc::SweptQuery, doc::SweptQuery_run);
  bind_init<double, bool>(swept, "distance: float = 0.0, candidates_only: bool = False, ",
                          with_arguments(doc::SweptQuery_SweptQuery, {}), nb::arg("distance") = 0.0,
                          nb::arg("candidates_only") = false);
  swept
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
  auto crossing = bind_pair_query<SurfaceCrossingQuery, SurfaceCrossingOptions>(
      m, "SurfaceCrossingQuery", doc::SurfaceCrossingQuery, doc::ProximityQuery_run);
  bind_init(crossing, "", with_arguments("Pairs of facets that intersect, as far as a budget allows.", {}));
  crossing.def(
      "pairs",
      [](Crossing& self) { return found_by<FeaturePairs>(self, [](SurfaceCrossingQuery& q) { return q.pairs(); }); },
      doc::SurfaceCrossingQuery_pairs);
  using Layers = HeldPairQuery<LayerPatchQuery, LayerPatchOptions>;
  auto layers = bind_pair_query<LayerPatchQuery, LayerPatchOptions>(
      m, "LayerPatchQuery", doc::LayerPatchQuery, doc::LayerPatchQuery_run, doc::LayerPatchQuery_resume);
  bind_init<double, std::uint32_t>(
      layers, "thickness: float, max_points: int = 4, ",
      with_arguments(doc::LayerPatchQuery_LayerPatchQuery, {{"thickness", doc::LayerPatchOptions_thickness},
                                                            {"max_points", doc::LayerPatchOptions_max_points}}),
      nb::arg("thickness"), nb::arg("max_points") = 4);
  layers.def(
      "patches", [](Layers& self) { return self.locked([](const LayerPatchQuery& q) { return LayerPatches(q); }); },
      "A copy of the patches, in the order of the lowest pair of facets; later runs do not change it.");
}

}  // namespace morula::python
