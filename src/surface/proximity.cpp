// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/surface/proximity.hpp>

#include "surface/pairs/feature_query.hpp"

namespace morula {
using namespace detail;
namespace {

/// The vertices that a nearest point is combined from, ascending; unused places hold no_slot.
using Simplex = std::array<std::uint32_t, 3>;

Simplex simplex(const SurfaceTreeState& s, Feature feature, std::uint32_t number, const Barycentric& weights) {
  Simplex result;
  result.fill(SurfaceTreeState::no_slot);
  const FeatureVertices vertices(s, feature, number);
  std::size_t size = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (weights[i] != 0) result[size++] = vertices[i];
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

struct ProximityQuery::State {
  CallState call;
  ProximityOptions options;
  FeatureQuery<ProximityPair> query;
  std::vector<ProximityPair> once;  // the pairs found whose nearest features no earlier pair has

  void forget() noexcept {
    query.forget();
    once.clear();
  }
  template <class Step>
  SurfaceQueryStatus run_call(CallKind kind, const Step& step) {
    const auto nearest = [distance = options.distance](const SurfaceTreeState& a, const SurfaceTreeState& b,
                                                       const FeaturePair& pair) {
      const ProximityPair found = nearest_points(pair, FeaturePoints(a, feature_a(pair.kind), pair.a),
                                                 FeaturePoints(b, feature_b(pair.kind), pair.b));
      return found.distance <= distance ? std::optional(found) : std::nullopt;
    };
    return call_of(*this, kind, [&] {
      const SurfaceQueryStatus status = step(one_by_one(nearest));
      if (status && options.nearest_features_once) keep_nearest_features_once();
      return status;
    });
  }
  SurfaceQueryStatus run(const SurfaceTreeState& a, const SurfaceTreeState& b, Workers& workers) {
    return run_call(CallKind::begins, [&](const auto& narrow) {
      return query.run(a, b, {.reach = options.distance}, options, workers, narrow);
    });
  }
  void keep_nearest_features_once();
};

void ProximityQuery::State::keep_nearest_features_once() {
  struct Key {
    Simplex first, second;
    std::uint32_t index;
    bool operator<(const Key& k) const { return std::tie(first, second, index) < std::tie(k.first, k.second, k.index); }
  };
  const std::vector<ProximityPair>& found = query.found();
  std::vector<Key> keys;
  for (std::uint32_t i = 0; i < found.size(); ++i) {
    const ProximityPair& pair = found[i];
    Key key{simplex(query.search().a(), feature_a(pair.kind), pair.a, pair.weights_a),
            simplex(query.search().b(), feature_b(pair.kind), pair.b, pair.weights_b), i};
    // For one surface with itself the order of the two is irrelevant.
    if (query.search().is_with_itself() && key.second < key.first) std::swap(key.first, key.second);
    keys.push_back(key);
  }
  sort_interruptibly(keys, std::less<>());
  std::vector<std::uint32_t> kept;
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (k == 0 || keys[k].first != keys[k - 1].first || keys[k].second != keys[k - 1].second)
      kept.push_back(keys[k].index);
  std::sort(kept.begin(), kept.end());
  once.clear();
  for (const std::uint32_t i : kept) once.push_back(found[i]);
}

ProximityQuery::ProximityQuery(ProximityOptions options) : state_(std::make_unique<State>()) {
  set_options(std::move(options));
}
ProximityQuery::~ProximityQuery() = default;
ProximityQuery::ProximityQuery(ProximityQuery&&) noexcept = default;
ProximityQuery& ProximityQuery::operator=(ProximityQuery&&) noexcept = default;

void ProximityQuery::set_options(ProximityOptions options) {
  require_idle(state_->call);
  require_length(options.distance, "ProximityOptions::distance");
  FeatureFilter::require_usable(options.filter);
  require_budget(options.budget);
  state_->options = std::move(options);
}
const ProximityOptions& ProximityQuery::options() const {
  return state_->options;
}

SurfaceQueryStatus ProximityQuery::run(const SurfaceTree& surface, Workers& workers) {
  return state_->run(state_of(surface), state_of(surface), workers);
}
SurfaceQueryStatus ProximityQuery::run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers) {
  return state_->run(state_of(a), state_of(b), workers);
}
SurfaceQueryStatus ProximityQuery::resume(Workers& workers) {
  const ProximityOptions& options = state_->options;
  return state_->run_call(CallKind::goes_on, [&](const auto& narrow) {
    return state_->query.resume(options.distance, options, workers, narrow);
  });
}

std::span<const ProximityPair> ProximityQuery::pairs() const {
  return state_->options.nearest_features_once ? state_->once : state_->query.found();
}
const std::vector<OpenFacets>& ProximityQuery::open() const {
  return state_->query.open();
}

void ProximityQuery::safe_distances(std::span<double> distances) const {
  const StandardFloats standard;
  const PairSearch& search = state_->query.search();
  if (!search.is_started() || state_->call.is_running) return std::fill(distances.begin(), distances.end(), 0.0);
  // Computed distances may exceed the true ones, so pairs at the true distance may be missing.
  // mutant safe-distances-rounding: `0x1p-46` -> `0`
  const double rounding = 0x1p-46 * state_->query.largest_coordinate();
  const auto half = [rounding](double distance) { return std::max(0.0, 0.5 * (distance - rounding) * (1 - 0x1p-50)); };
  std::fill(distances.begin(), distances.end(), half(state_->query.reach()));
  for (const ProximityPair& pair : state_->query.found()) {
    const auto bound = [&](const SurfaceTreeState& s, Feature feature, std::uint32_t number) {
      for (const std::uint32_t v : FeatureVertices(s, feature, number))
        if (v < distances.size()) distances[v] = std::min(distances[v], half(pair.distance));
    };
    bound(search.a(), feature_a(pair.kind), pair.a);
    if (search.is_with_itself()) bound(search.b(), feature_b(pair.kind), pair.b);
  }
}

}  // namespace morula
