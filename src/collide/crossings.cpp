// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <morula/collide/collider.hpp>
#include <morula/collide/crossings.hpp>
#include <vector>

#include "collide/facets/facet_crossings.hpp"
#include "collide/pairs/descent.hpp"
#include "collide/require.hpp"
#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

bool have_nodes(const Collider& a, const Collider& b, std::span<const NodePair> nodes) {
  return std::all_of(nodes.begin(), nodes.end(), [&](const NodePair& pair) {
    return pair.a < a.tree().node_count() && pair.b < b.tree().node_count();
  });
}

}  // namespace

struct CrossingQuery::State {
  CallState call;
  std::vector<Crossing> found;
  std::size_t leaf_pairs = 0, facets_read = 0, pairs_tested = 0;

  // The memory, kept for the next query.
  std::vector<NodePair> leaves;
  FacetCrossings facets;

  void forget() noexcept {
    CallState kept = call;
    *this = State();
    call = kept;
  }
  void find(const Collider& a, const Collider& b, std::span<const NodePair> nodes);
};

void CrossingQuery::State::find(const Collider& a, const Collider& b, std::span<const NodePair> nodes) {
  facets.start(a, b);
  for (const NodePair& pair : nodes) facets.add(pair);
  facets.finish();
  found.clear();
  for (const FacetPairKey& pair : facets.pairs())
    found.push_back(
        {pair.facet_a(), pair.facet_b(), *intersection(a.triangle(pair.facet_a()), b.triangle(pair.facet_b()))});
  leaf_pairs = nodes.size();
  facets_read = facets.facets_read();
  pairs_tested = facets.pairs_tested();
}

CrossingQuery::CrossingQuery() : state_(std::make_unique<State>()) {}
CrossingQuery::~CrossingQuery() = default;
CrossingQuery::CrossingQuery(CrossingQuery&&) noexcept = default;
CrossingQuery& CrossingQuery::operator=(CrossingQuery&&) noexcept = default;

std::span<const Crossing> CrossingQuery::pairs() const {
  return state_->found;
}
std::size_t CrossingQuery::leaf_pairs() const {
  return state_->leaf_pairs;
}
std::size_t CrossingQuery::facets_read() const {
  return state_->facets_read;
}
std::size_t CrossingQuery::pairs_tested() const {
  return state_->pairs_tested;
}

Status CrossingQuery::run(const Collider& a, const Collider& b, std::span<const NodePair> nodes) {
  const StandardFloats standard;
  if (const Status status = status_of_pair(a, b, {.all_spheres = false, .positions = true}); !status) return status;
  if (!have_nodes(a, b, nodes)) return {Status::Code::bad_option};
  ObjectCall own(*state_, CallKind::begins);
  if (!own.status()) return own.status();
  const PairAsRead read(a, b);
  state_->find(a, b, nodes);
  own.finish(read.status());
  return state_->call.ended;
}

Status CrossingQuery::run(const Collider& a, const Collider& b) {
  const StandardFloats standard;
  if (const Status status = status_of_pair(a, b, {.positions = true}); !status) return status;
  ObjectCall own(*state_, CallKind::begins);
  if (!own.status()) return own.status();
  const PairAsRead read(a, b);
  state_->leaves.clear();
  each_overlapping(TreePair(a, b, 0, leaf_level), [&](std::uint32_t node_a, std::uint32_t node_b) {
    state_->leaves.push_back({node_a, node_b});
  });
  state_->find(a, b, state_->leaves);
  own.finish(read.status());
  return state_->call.ended;
}

std::vector<Crossing> crossings(const Collider& a, const Collider& b) {
  CrossingQuery query;
  require_good(query.run(a, b));
  return {query.pairs().begin(), query.pairs().end()};
}

std::vector<Crossing> brute_force::crossings(const Collider& a, const Collider& b) {
  require_bodies(a, b, {.all_spheres = false, .positions = true});
  struct Boxed {
    Triangle triangle;
    Box box;
  };
  const auto boxed = [](const Collider& collider) {
    std::vector<Boxed> all(collider.mesh_facets().size());
    for (std::uint32_t facet = 0; facet < all.size(); ++facet) {
      all[facet].triangle = collider.triangle(facet);
      for (const Vec3& p : all[facet].triangle) all[facet].box.add(p);
    }
    return all;
  };
  const auto apart = [](const Box& s, const Box& t) {
    return s.lower.x > t.upper.x || t.lower.x > s.upper.x || s.lower.y > t.upper.y || t.lower.y > s.upper.y ||
           s.lower.z > t.upper.z || t.lower.z > s.upper.z;
  };
  const PairAsRead read(a, b);
  const std::vector<Boxed> all_a = boxed(a), all_b = boxed(b);
  std::vector<Crossing> found;
  for (std::uint32_t i = 0; i < all_a.size(); ++i) {
    check_interrupt();
    for (std::uint32_t j = 0; j < all_b.size(); ++j) {
      if (apart(all_a[i].box, all_b[j].box)) continue;
      if (const auto common = intersection(all_a[i].triangle, all_b[j].triangle)) found.push_back({i, j, *common});
    }
  }
  require_good(read.status());
  return found;
}

}  // namespace morula
