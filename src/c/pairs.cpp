// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features of the C interface.
#include <algorithm>
#include <array>
#include <limits>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <type_traits>
#include <utility>

#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

struct morula_pairs {
  std::shared_ptr<morula_body> a, b;  // declared ahead of the queries, which borrow their surfaces for a resume
  ProximityQuery near;
  SurfaceCrossingQuery crossing;
  bool is_near = true;                   // the query of the last search
  std::vector<morula_pair> found, next;  // next: memory for the pairs of a call
  bool is_read = false;                  // `found` is of the last search
  bool finished = false;
};

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// The numbers of kinds are those of the library.
static_assert(MORULA_VERTEX_FACET == static_cast<int>(PairKind::vertex_facet) &&
              MORULA_FACET_VERTEX == static_cast<int>(PairKind::facet_vertex) &&
              MORULA_EDGE_EDGE == static_cast<int>(PairKind::edge_edge) &&
              MORULA_FACET_FACET == static_cast<int>(PairKind::facet_facet));

enum class FeatureKind : std::uint8_t { vertex, edge, facet };

void write_vertices(const SurfaceTree& surface, FeatureKind kind, std::uint32_t feature, std::uint32_t* vertices) {
  std::fill_n(vertices, 3, none);
  if (kind == FeatureKind::vertex) vertices[0] = feature;
  if (kind == FeatureKind::edge) std::copy_n(surface.edges()[feature].data(), 2, vertices);
  if (kind == FeatureKind::facet) std::copy_n(surface.facets()[feature].data(), 3, vertices);
}

morula_pair pair_of(const FeaturePair& pair, const SurfaceTree& a, const SurfaceTree& b) {
  using enum FeatureKind;
  constexpr std::array<std::pair<FeatureKind, FeatureKind>, 4> kinds{
      {{vertex, facet}, {facet, vertex}, {edge, edge}, {facet, facet}}};
  const auto [of_a, of_b] = kinds[static_cast<std::size_t>(pair.kind)];
  morula_pair to{};
  to.kind = static_cast<std::int32_t>(pair.kind);
  to.a = pair.a, to.b = pair.b;
  write_vertices(a, of_a, pair.a, to.vertices_a);
  write_vertices(b, of_b, pair.b, to.vertices_b);
  return to;
}

morula_pair pair_of(const ProximityPair& pair, const SurfaceTree& a, const SurfaceTree& b) {
  morula_pair to = pair_of(static_cast<const FeaturePair&>(pair), a, b);
  to.distance = pair.distance;
  std::copy(pair.weights_a.begin(), pair.weights_a.end(), to.weights_a);
  std::copy(pair.weights_b.begin(), pair.weights_b.end(), to.weights_b);
  copy(pair.point_a, to.point_a);
  copy(pair.point_b, to.point_b);
  return to;
}

struct Wanted {
  double distance = 0;
  bool nearest_features_once = false;
  PairFilter filter;
  Budget budget;
};

Wanted pair_options(const morula_pair_options* given) {
  const morula_pair_options options = over_defaults(given, &morula_pair_options_defaults);
  if (options.rings < 0)
    throw std::invalid_argument("rings is " + std::to_string(options.rings) + ": 0 or more are possible");
  Wanted wanted;
  wanted.distance = options.distance;
  wanted.nearest_features_once = options.nearest_features_once != 0;
  wanted.filter.rings = static_cast<std::uint32_t>(options.rings);
  wanted.filter.rest_distance = options.rest_distance;
  wanted.filter.same_component = options.same_component != 0;
  wanted.budget = budget_of(options.box_tests, options.nanoseconds, "box_tests");
  return wanted;
}

/// Copies the pairs of a call that was not rejected. A call that continues a search has found all pairs in the list,
/// and perhaps more; pairs are sorted, so a longer list is copied as a whole.
template <class Query>
morula_status read(morula_pairs& pairs, const Query& query, const SurfaceQueryStatus& status) {
  const SurfaceTree& a = *pairs.a->surface;
  const SurfaceTree& b = *pairs.b->surface;
  // mutant c-pairs-not-read: `!pairs.is_read || query` -> `query`
  if (!pairs.is_read || query.pairs().size() != pairs.found.size()) {
    pairs.next.clear();
    for (const auto& pair : query.pairs()) pairs.next.push_back(pair_of(pair, a, b));
    pairs.found.swap(pairs.next);
    pairs.is_read = true;
  }
  pairs.finished = status.finished;
  if (status.finished) pairs.a.reset(), pairs.b.reset();
  return MORULA_OK;
}

/// Searches with a query; b: NULL or a for one body with itself.
template <class Query, class Options>
morula_status search(morula_body* a, morula_body* b, Options options, Query& query, morula_pairs& pairs) {
  require_pointer(a, "a");
  if (b == nullptr) b = a;
  const SurfaceTree *first = nullptr, *second = nullptr;
  if (const morula_status code = surface_of(*a, first); code != MORULA_OK) return code;
  if (const morula_status code = surface_of(*b, second); code != MORULA_OK) return code;
  Options before = query.options();
  query.set_options(std::move(options));
  const SurfaceQueryStatus status = a == b ? query.run(*first, a->workers) : query.run(*first, *second, a->workers);
  if (!status) {
    query.set_options(std::move(before));
    return code_of(status);
  }
  pairs.a = a->of_caller, pairs.b = b->of_caller;
  pairs.is_near = std::is_same_v<Query, ProximityQuery>;
  pairs.is_read = false;
  return read(pairs, query, status);
}

/// Continues a search that a budget ended.
template <class Query>
morula_status resume(morula_pairs& pairs, Query& query, const Budget& budget) {
  // The query itself sees deformations alone: its surfaces keep the transforms of the search.
  for (const morula_body* body : {pairs.a.get(), pairs.b.get()})
    // mutant c-pairs-moved: `body->surface_transform != body->collider.transform()` -> `body == nullptr`
    if (body->surface_transform != body->collider.transform()) return code_of_resume({Status::Code::other_transform});
  auto options = query.options();
  options.budget = budget;
  query.set_options(std::move(options));
  const SurfaceQueryStatus status = query.resume(pairs.a->workers);
  if (!status) return code_of_resume(status);
  return read(pairs, query, status);
}

}  // namespace

morula_status morula::detail::surface_of(morula_body& body, const SurfaceTree*& result) {
  if (!body.surface) body.surface.emplace(*body.mesh);
  const std::uint64_t frame = body.collider.sphere_state().frame;
  // Following a body that has not moved would end searches that a budget has interrupted.
  if (!askable(body.collider) || body.surface_frame != frame || body.surface_transform != body.collider.transform()) {
    if (const Status status = body.surface->follow(body.collider); !status) return code_of(status);
    body.surface_frame = frame;
    body.surface_transform = body.collider.transform();
  }
  result = &*body.surface;
  return MORULA_OK;
}

void morula_pair_options_defaults(morula_pair_options* options, size_t size) {
  write_defaults(options, size, [](morula_pair_options& defaults) {
    defaults.box_tests = -1;
    defaults.nanoseconds = -1;
  });
}

morula_status morula_pairs_create(morula_pairs** pairs) {
  return guarded([&] {
    require_pointer(pairs, "pairs");
    *pairs = nullptr;
    *pairs = new morula_pairs;
    return MORULA_OK;
  });
}

void morula_pairs_destroy(morula_pairs* pairs) {
  delete pairs;
}

morula_status morula_pairs_near(morula_body* a, morula_body* b, const morula_pair_options* options,
                                morula_pairs* pairs) {
  return guarded([&] {
    require_pointer(pairs, "pairs");
    Wanted wanted = pair_options(options);
    return search(
        a, b,
        ProximityOptions{wanted.distance, wanted.nearest_features_once, std::move(wanted.filter), wanted.budget, {}},
        pairs->near, *pairs);
  });
}

morula_status morula_pairs_crossing(morula_body* a, morula_body* b, const morula_pair_options* options,
                                    morula_pairs* pairs) {
  return guarded([&] {
    require_pointer(pairs, "pairs");
    Wanted wanted = pair_options(options);
    return search(a, b, SurfaceCrossingOptions{std::move(wanted.filter), wanted.budget, {}}, pairs->crossing, *pairs);
  });
}

morula_status morula_pairs_resume(morula_pairs* pairs, int64_t box_tests, int64_t nanoseconds) {
  return guarded([&] {
    require_pointer(pairs, "pairs");
    const Budget budget = budget_of(box_tests, nanoseconds, "box_tests");
    if (!pairs->a) throw std::invalid_argument("pairs: no budget has ended their last search");
    return pairs->is_near ? resume(*pairs, pairs->near, budget) : resume(*pairs, pairs->crossing, budget);
  });
}

size_t morula_pairs_count(const morula_pairs* pairs) {
  return pairs == nullptr ? 0 : pairs->found.size();
}
const morula_pair* morula_pairs_data(const morula_pairs* pairs) {
  return pairs == nullptr ? nullptr : pairs->found.data();
}
int morula_pairs_finished(const morula_pairs* pairs) {
  return pairs != nullptr && pairs->finished ? 1 : 0;
}
