// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/layers/edge_layers.hpp"

#include <algorithm>
#include <cmath>

namespace morula::detail {

/// constant + slope t ≥ 0.
EdgeLayers::Switch EdgeLayers::reaches(double constant, double slope) {
  const double root = -constant / slope;
  if (root > 0 && root < 1) return {slope < 0, root};
  return {constant + 0.5 * slope >= 0, 2};
}

void EdgeLayers::Interval::cut(const Switch& condition, bool wanted) {
  if (condition.at >= to || condition.at <= from) {
    if (condition(0.5 * (from + to)) != wanted) to = from;
  } else if (condition.before == wanted) {
    to = condition.at;
  } else {
    from = condition.at;
  }
}

/// The part of the edge where r0 + t r1 is shorter than the thickness.
EdgeLayers::Interval EdgeLayers::within(const Vec3& r0, const Vec3& r1) const {
  const double squared = thickness_ * thickness_, speed = squared_length(r1);
  if (!(speed > 0)) return squared_length(r0) < squared ? Interval{} : Interval{0, 0};
  const double nearest = -dot(r0, r1) / speed;
  const double least = squared_length(r0 + r1 * nearest);
  if (!(least < squared)) return {0, 0};
  const double half = std::sqrt((squared - least) / speed);
  return {std::max(0.0, nearest - half), std::min(1.0, nearest + half)};
}

void EdgeLayers::find(std::uint32_t edge, const Vec3& p, const Vec3& u, const LayerMesh& other, double thickness,
                      std::span<LayerCandidate> candidates, std::vector<LayerPiece>& pieces) {
  edge_ = edge, p_ = p, u_ = u, thickness_ = thickness, other_ = &other;
  candidates_ = candidates, pieces_ = &pieces;
  facets_.clear(), uses_.clear(), corners_.clear();
  const Vec3 lower = min(p, p + u), upper = max(p, p + u);
  for (std::uint32_t i = 0; i < candidates.size(); ++i) {
    const std::uint32_t facet = candidates[i].facet;
    if (!other.is_usable(facet)) continue;
    const Triangle t = other.triangle(facet);
    const Vec3 gap = max(lower - max(t[0], max(t[1], t[2])), min(t[0], min(t[1], t[2])) - upper);
    if (squared_length(max(gap, Vec3{})) > thickness * thickness) continue;
    const auto place = static_cast<std::uint32_t>(facets_.size());
    facets_.push_back({facet, i, -1, {}, {}});
    for (std::uint32_t k = 0; k < 3; ++k) {
      uses_.push_back({other.edges(facet)[k], place, k});
      corners_.push_back({other.corners(facet)[k], place, k});
    }
  }
  for (std::uint32_t i = 0; i < facets_.size(); ++i) add_facet(i);
  add_edges();
  add_vertices();
}

void EdgeLayers::add_facet(std::uint32_t place) {
  NearFacet& facet = facets_[place];
  const Triangle t = other_->triangle(facet.facet);
  const LayerNormal of(t);
  if (of.is_segment()) {
    facet.longest = of.longest;
    return;
  }
  Interval above;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 outwards = cross(t[(k + 1) % 3] - t[k], of.normal);
    facet.beyond[k] = reaches(dot(p_ - t[k], outwards), dot(u_, outwards));
    if (!above.is_empty()) above.cut(facet.beyond[k], false);
  }
  if (above.is_empty()) return;
  const Interval near = within(of.normal * dot(p_ - t[0], of.normal), of.normal * dot(u_, of.normal));
  above = {std::max(above.from, near.from), std::min(above.to, near.to)};
  if (above.is_empty()) return;
  mark(place);
  first_candidate_ = facet.candidate;
  events_.clear();
  add_pieces(Feature::facet, facet.facet, above, 1);
}

// Adds the pieces of an interval at whose events the index changes.
void EdgeLayers::add_pieces(Feature kind, std::uint32_t feature, const Interval& all, std::int32_t index) {
  const LayerCandidate& candidate = candidates_[first_candidate_];
  double from = all.from;
  const auto add = [&](double to) {
    if (index != 0 && from < to)
      pieces_->push_back({edge_, feature, candidate.number, index, from, to, kind, candidate.end});
    from = to;
  };
  for (const Event& event : events_) {
    if (event.change == 0) continue;
    add(event.t);
    index += event.change;
  }
  add(all.to);
}

void EdgeLayers::add_edges() {
  edges_.clear();
  std::sort(uses_.begin(), uses_.end());
  for (std::uint32_t i = 0, end = 0; i < uses_.size(); i = end) {
    const auto place = static_cast<std::uint32_t>(edges_.size());
    for (end = i; end < uses_.size() && uses_[end].feature == uses_[i].feature; ++end)
      facets_[uses_[end].facet].edges[uses_[end].corner] = place;
    edges_.push_back({uses_[i].feature, i, end, {}});
    add_edge(place);
  }
}

void EdgeLayers::add_edge(std::uint32_t place) {
  NearEdge& edge = edges_[place];
  const auto [lower, upper] = other_->ends(edge.edge);
  const Vec3 from = other_->at(lower), along = other_->at(upper) - from, arm = p_ - from;
  const double squared = squared_length(along), constant = dot(arm, along), slope = dot(u_, along);
  // An edge without length is its lower vertex.
  edge.at_end[0] = squared > 0 ? reaches(-constant, -slope) : Switch{true, 2};
  edge.at_end[1] = squared > 0 ? reaches(constant - squared, slope) : Switch{false, 2};
  if (!(squared > 0)) return;
  Interval beside;
  for (const Switch& at_end : edge.at_end)
    if (!beside.is_empty()) beside.cut(at_end, false);
  const Interval near = within(arm - along * (constant / squared), u_ - along * (slope / squared));
  beside = {std::max(beside.from, near.from), std::min(beside.to, near.to)};
  if (beside.is_empty()) return;
  events_.clear();
  std::int32_t index = 1;
  first_candidate_ = facets_[uses_[edge.begin].facet].candidate;
  for (std::uint32_t i = edge.begin; i < edge.end; ++i) {
    mark(uses_[i].facet);
    const NearFacet& facet = facets_[uses_[i].facet];
    if (facet.longest >= 0) {
      if (facet.longest != static_cast<int>(uses_[i].corner)) --index;
      continue;
    }
    const Switch& beyond = facet.beyond[uses_[i].corner];
    if (!beyond(beside.from)) --index;
    if (beyond.at > beside.from && beyond.at < beside.to) events_.push_back({beyond.at, i, beyond.before ? -1 : 1});
  }
  std::sort(events_.begin(), events_.end());
  add_pieces(Feature::edge, edge.edge, beside, index);
}

/// 1 if the nearest point of a facet is its corner, minus the number of its edges whose nearest point it is.
std::int32_t EdgeLayers::index_at_corner(std::uint32_t place, std::uint32_t corner) const {
  const NearFacet& facet = facets_[place];
  const std::uint32_t out = corner, in = (corner + 2) % 3;
  const bool at_out = edges_[facet.edges[out]].is_at, at_in = edges_[facet.edges[in]].is_at;
  const auto longest = static_cast<std::uint32_t>(facet.longest);
  const bool is_nearest = facet.longest < 0 ? at_out && at_in : longest == out ? at_out : longest == in && at_in;
  return is_nearest - at_out - at_in;
}

void EdgeLayers::add_vertices() {
  std::sort(corners_.begin(), corners_.end());
  for (std::uint32_t i = 0, end = 0; i < corners_.size(); i = end) {
    for (end = i; end < corners_.size() && corners_[end].feature == corners_[i].feature;) ++end;
    add_vertex(i, end);
  }
}

void EdgeLayers::add_vertex(std::uint32_t begin, std::uint32_t end) {
  const std::uint32_t vertex = corners_[begin].feature;
  const Interval near = within(p_ - other_->at(vertex), u_);
  if (near.is_empty()) return;
  around_.clear(), events_.clear();
  for (std::uint32_t i = begin; i < end; ++i) {
    mark(corners_[i].facet);
    const NearFacet& facet = facets_[corners_[i].facet];
    for (const std::uint32_t k : {corners_[i].corner, (corners_[i].corner + 2) % 3}) {
      NearEdge& edge = edges_[facet.edges[k]];
      if (!edge.is_listed) around_.push_back(facet.edges[k]);
      edge.is_listed = true;
    }
  }
  // c of the vertex, and then c of each facet and edge of which it is the nearest point; c of an edge with m facets is
  // 1 - m, of which each facet takes 1.
  std::int32_t index = 1 + static_cast<std::int32_t>(end - begin) - static_cast<std::int32_t>(around_.size());
  for (const std::uint32_t place : around_) {
    NearEdge& edge = edges_[place];
    edge.is_listed = false;
    const Switch& at_end = edge.at_end[other_->ends(edge.edge)[0] == vertex ? 0 : 1];
    edge.is_at = at_end(near.from);
    index += edge.is_at;
    if (at_end.at > near.from && at_end.at < near.to) events_.push_back({at_end.at, place, 0});
  }
  for (std::uint32_t i = begin; i < end; ++i) index += index_at_corner(corners_[i].facet, corners_[i].corner);
  std::sort(events_.begin(), events_.end());
  for (Event& event : events_) {
    NearEdge& edge = edges_[event.what];
    const auto of_facets = [&] {
      std::int32_t sum = 0;
      for (std::uint32_t k = edge.begin; k < edge.end; ++k) {
        const Use& use = uses_[k];
        const bool is_first = other_->corners(facets_[use.facet].facet)[use.corner] == vertex;
        sum += index_at_corner(use.facet, is_first ? use.corner : (use.corner + 1) % 3);
      }
      return sum;
    };
    event.change = -of_facets();
    edge.is_at = !edge.is_at;
    event.change += of_facets() + (edge.is_at ? 1 : -1);
  }
  first_candidate_ = facets_[corners_[begin].facet].candidate;
  add_pieces(Feature::vertex, vertex, near, index);
}

}  // namespace morula::detail
