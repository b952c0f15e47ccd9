// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/surface/surface_crossings.hpp>

#include "query/triangle_pairs.hpp"
#include "surface/pairs/feature_query.hpp"

namespace morula {
using namespace detail;
namespace {

void find_crossings(const SurfaceTreeState& a, const SurfaceTreeState& b, std::span<const FeaturePair> pairs,
                    std::vector<FeaturePair>& found) {
  const auto corners = [](const SurfaceTreeState& s, std::uint32_t facet) -> Triangle {
    const Facet& f = s.mesh.facets[facet];
    return {s.from_of(f[0]), s.from_of(f[1]), s.from_of(f[2])};
  };
  find_meeting(
      pairs.size(), [&](std::size_t i, const auto& put) { put(corners(a, pairs[i].a), corners(b, pairs[i].b)); },
      [&](std::size_t i) { found.push_back(pairs[i]); });
}

}  // namespace

struct SurfaceCrossingQuery::State {
  CallState call;
  SurfaceCrossingOptions options;
  FeatureQuery<FeaturePair> query;

  void forget() noexcept { query.forget(); }
  SurfaceQueryStatus run(const SurfaceTreeState& a, const SurfaceTreeState& b, Workers& workers) {
    return call_of(*this, CallKind::begins,
                   [&] { return query.run(a, b, {.features = Features::facets}, options, workers, find_crossings); });
  }
  SurfaceQueryStatus resume(Workers& workers) {
    return call_of(*this, CallKind::goes_on, [&] { return query.resume(0, options, workers, find_crossings); });
  }
};

SurfaceCrossingQuery::SurfaceCrossingQuery(SurfaceCrossingOptions options) : state_(std::make_unique<State>()) {
  set_options(std::move(options));
}
SurfaceCrossingQuery::~SurfaceCrossingQuery() = default;
SurfaceCrossingQuery::SurfaceCrossingQuery(SurfaceCrossingQuery&&) noexcept = default;
SurfaceCrossingQuery& SurfaceCrossingQuery::operator=(SurfaceCrossingQuery&&) noexcept = default;

void SurfaceCrossingQuery::set_options(SurfaceCrossingOptions options) {
  require_idle(state_->call);
  FeatureFilter::require_usable(options.filter);
  require_budget(options.budget);
  state_->options = std::move(options);
}
const SurfaceCrossingOptions& SurfaceCrossingQuery::options() const {
  return state_->options;
}

SurfaceQueryStatus SurfaceCrossingQuery::run(const SurfaceTree& surface, Workers& workers) {
  return state_->run(state_of(surface), state_of(surface), workers);
}
SurfaceQueryStatus SurfaceCrossingQuery::run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers) {
  return state_->run(state_of(a), state_of(b), workers);
}
SurfaceQueryStatus SurfaceCrossingQuery::resume(Workers& workers) {
  return state_->resume(workers);
}

std::span<const FeaturePair> SurfaceCrossingQuery::pairs() const {
  return state_->query.found();
}
const std::vector<OpenFacets>& SurfaceCrossingQuery::open() const {
  return state_->query.open();
}

}  // namespace morula
