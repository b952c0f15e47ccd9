// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/surface/swept.hpp>

#include "surface/feature_query.hpp"

namespace morula {
using namespace detail;

struct SweptQuery::State {
  SweptOptions options;
  FeatureQuery<SweptPair> query;

  template <class Ask>
  SurfaceQueryStatus ask(const Ask& how) {
    const double distance = options.distance;
    const bool candidates_only = options.candidates_only;
    return how(
        [=](const SurfaceTreeState& a, const SurfaceTreeState& b, const FeaturePair& pair) -> std::optional<SweptPair> {
          if (candidates_only) return SweptPair{pair};
          const Feature of_a = feature_a(pair.kind), of_b = feature_b(pair.kind);
          const double time =
              time_of_impact(FeaturePoints(a, of_a, pair.a), FeaturePoints(a, of_a, pair.a, true),
                             FeaturePoints(b, of_b, pair.b), FeaturePoints(b, of_b, pair.b, true), distance);
          if (time > 1) return std::nullopt;
          return SweptPair{pair, time};
        });
  }
  SurfaceQueryStatus run(const SurfaceTreeState& a, const SurfaceTreeState* b, Workers& workers) {
    return ask([&](const auto& narrow) {
      return query.run(a, b, {.reach = options.distance, .sorted = !options.candidates_only}, options, workers, narrow);
    });
  }
};

SweptQuery::SweptQuery(SweptOptions options) : state_(std::make_unique<State>()) {
  set_options(std::move(options));
}
SweptQuery::~SweptQuery() = default;
SweptQuery::SweptQuery(SweptQuery&&) noexcept = default;
SweptQuery& SweptQuery::operator=(SweptQuery&&) noexcept = default;

void SweptQuery::set_options(SweptOptions options) {
  require_length(options.distance, "SweptOptions::distance");
  FeatureFilter::require_usable(options.filter);
  require_budget(options.budget);
  state_->options = std::move(options);
}
const SweptOptions& SweptQuery::options() const {
  return state_->options;
}

SurfaceQueryStatus SweptQuery::run(const SurfaceTree& surface, Workers& workers) {
  return state_->run(surface.state(), nullptr, workers);
}
SurfaceQueryStatus SweptQuery::run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers) {
  return state_->run(a.state(), &b.state(), workers);
}
SurfaceQueryStatus SweptQuery::resume(Workers& workers) {
  return state_->ask([&](const auto& narrow) { return state_->query.resume(state_->options, workers, narrow); });
}

std::span<const SweptPair> SweptQuery::pairs() const {
  return state_->query.found();
}
const std::vector<OpenFacets>& SweptQuery::open() const {
  return state_->query.open();
}

double SweptQuery::collision_free_step() const {
  double step = 1;
  for (const SweptPair& pair : pairs()) step = std::min(step, pair.time);
  return step;
}

}  // namespace morula
