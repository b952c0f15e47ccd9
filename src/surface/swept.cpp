// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/surface/swept.hpp>

#include "surface/pairs/feature_query.hpp"

namespace morula {
using namespace detail;

namespace {

void take_candidates(const SurfaceTreeState&, const SurfaceTreeState&, std::span<const FeaturePair> pairs,
                     std::vector<FeaturePair>& found) {
  found.insert(found.end(), pairs.begin(), pairs.end());
}

/// Computes the times of impact of pairs that are not proven to stay apart.
struct Impact {
  double distance;

  std::optional<SweptPair> operator()(const SurfaceTreeState& a, const SurfaceTreeState& b,
                                      const FeaturePair& pair) const {
    const Feature of_a = feature_a(pair.kind), of_b = feature_b(pair.kind);
    const double time = time_of_impact(FeaturePoints(a, of_a, pair.a), FeaturePoints(a, of_a, pair.a, true),
                                       FeaturePoints(b, of_b, pair.b), FeaturePoints(b, of_b, pair.b, true), distance);
    if (time > 1) return std::nullopt;
    return SweptPair{pair, time};
  }
};

}  // namespace

struct SweptQuery::State {
  CallState call;
  SweptOptions options;
  FeatureQuery<SweptPair> query;
  FeatureQuery<FeaturePair> candidates;
  bool has_candidates = false;  // whether the query of candidates was started last, of the two

  void forget() noexcept {
    query.forget();
    candidates.forget();
    has_candidates = false;
  }
  SurfaceQueryStatus run(const SurfaceTreeState& a, const SurfaceTreeState& b, Workers& workers) {
    return call_of(*this, CallKind::begins, [&] {
      const double reach = options.distance;
      const SurfaceQueryStatus status =
          options.candidates_only
              ? candidates.run(a, b, {.reach = reach, .sorted = false, .by_spheres = false}, options, workers,
                               take_candidates)
              : query.run(a, b, {.reach = reach, .by_spheres = false}, options, workers, one_by_one(Impact{reach}));
      if (status) has_candidates = options.candidates_only;
      return status;
    });
  }
  SurfaceQueryStatus resume(Workers& workers) {
    return call_of(*this, CallKind::goes_on, [&]() -> SurfaceQueryStatus {
      const bool is_started = query.search().is_started() || candidates.search().is_started();
      if (is_started && options.candidates_only != has_candidates) return {{.code = Status::Code::other_options}};
      return has_candidates ? candidates.resume(options.distance, options, workers, take_candidates)
                            : query.resume(options.distance, options, workers, one_by_one(Impact{options.distance}));
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
  require_idle(state_->call);
  require_length(options.distance, "SweptOptions::distance");
  FeatureFilter::require_usable(options.filter);
  require_budget(options.budget);
  state_->options = std::move(options);
}
const SweptOptions& SweptQuery::options() const {
  return state_->options;
}

SurfaceQueryStatus SweptQuery::run(const SurfaceTree& surface, Workers& workers) {
  return state_->run(state_of(surface), state_of(surface), workers);
}
SurfaceQueryStatus SweptQuery::run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers) {
  return state_->run(state_of(a), state_of(b), workers);
}
SurfaceQueryStatus SweptQuery::resume(Workers& workers) {
  return state_->resume(workers);
}

std::span<const SweptPair> SweptQuery::pairs() const {
  return state_->query.found();
}
std::span<const FeaturePair> SweptQuery::candidates() const {
  return state_->candidates.found();
}
const std::vector<OpenFacets>& SweptQuery::open() const {
  return state_->has_candidates ? state_->candidates.open() : state_->query.open();
}

double SweptQuery::collision_free_step() const {
  double step = 1;
  for (const SweptPair& pair : pairs()) step = std::min(step, pair.time);
  return step;
}

}  // namespace morula
