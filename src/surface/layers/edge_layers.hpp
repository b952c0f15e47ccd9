// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pieces of an edge whose points x are nearest to one facet, edge or vertex of the other surface, with the number
// of times that its distance counts.
//
// f(x) = Σ c φ(distance) over facets, edges and vertices (layer_patches.hpp). The nearest point of a facet is in its
// interior, on one of its edges, or a vertex; so f(x) is also a sum over the facets above which x is, the edges beside
// which it is, and all vertices, each with an integer, its index:
//   facet    1
//   edge     1 − (number of its facets on whose side of the edge x is)
//   vertex   1 − (its edges that lead towards x) + (its facets of which both edges do)
// Most indices are 0: of a vertex or edge within a flat part, or one behind a ridge. All conditions are signs of linear
// functions along the edge. Each changes at one number, which all features that depend on it share. So points of the
// edge count each facet exactly once, except for parts of rounding length near the borders of its regions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/layers/layer_mesh.hpp"
#include "surface/pairs/feature_filter.hpp"

namespace morula::detail {

/// A part of an edge of one side, from parameter `from` to `to`, near a feature of the other side.
struct LayerPiece {
  std::uint32_t edge, feature;
  std::uint32_t candidate;  ///< pair of facets, one of the edge and one of the feature
  std::int32_t index;       ///< not 0
  double from, to;
  Feature kind;
  std::uint8_t end;  ///< the edge is one of facet a (0) or b (1) of the candidate
};

/// A facet that acts on the edge.
struct LayerCandidate {
  std::uint32_t facet, number;
  std::uint8_t end;
  bool is_near = false;  ///< a point of the edge is nearer than the thickness; find() sets it
};

class EdgeLayers {
 public:
  /// Adds the pieces of edge p + t u, t in [0, 1]. candidates: facets of `other`, ascending, each once.
  void find(std::uint32_t edge, const Vec3& p, const Vec3& u, const LayerMesh& other, double thickness,
            std::span<LayerCandidate> candidates, std::vector<LayerPiece>& pieces);

 private:
  /// A condition that changes at most once along the edge.
  struct Switch {
    bool before = false;
    double at = 2;
    bool operator()(double t) const { return before != (t >= at); }
  };
  struct Interval {
    double from = 0, to = 1;
    bool is_empty() const { return !(from < to); }
    void cut(const Switch& condition, bool wanted);
  };
  struct NearFacet {
    std::uint32_t facet, candidate;  // place in the list of candidates
    int longest;                     // of a facet that counts as its longest edge; else -1
    std::uint32_t edges[3];          // places in edges_
    Switch beyond[3];                // x is on the outer side of the edge
  };
  struct NearEdge {
    std::uint32_t edge, begin, end;         // uses_[begin … end) are its facets
    Switch at_end[2];                       // its nearest point is its lower, or upper vertex
    bool is_listed = false, is_at = false;  // memory of add_vertex(): whether the vertex is its nearest point
  };
  struct Use {
    std::uint32_t feature, facet, corner;  // place in facets_
    bool operator<(const Use& u) const { return feature != u.feature ? feature < u.feature : facet < u.facet; }
  };
  struct Event {
    double t;
    std::uint32_t what;
    std::int32_t change;
    bool operator<(const Event& e) const { return t != e.t ? t < e.t : what < e.what; }
  };

  static Switch reaches(double constant, double slope);
  Interval within(const Vec3& r0, const Vec3& r1) const;
  void add_facet(std::uint32_t place);
  void add_edges();
  void add_vertices();
  void add_edge(std::uint32_t place);
  void add_vertex(std::uint32_t begin, std::uint32_t end);
  std::int32_t index_at_corner(std::uint32_t place, std::uint32_t corner) const;
  void add_pieces(Feature kind, std::uint32_t feature, const Interval& all, std::int32_t index);
  void mark(std::uint32_t facet) { candidates_[facets_[facet].candidate].is_near = true; }

  // The edge that find() examines.
  std::uint32_t edge_ = 0;
  Vec3 p_, u_;
  double thickness_ = 0;
  const LayerMesh* other_ = nullptr;
  std::span<LayerCandidate> candidates_;
  std::vector<LayerPiece>* pieces_ = nullptr;
  // Memory.
  std::vector<NearFacet> facets_;
  std::vector<NearEdge> edges_;
  std::vector<Use> uses_, corners_;
  std::vector<Event> events_;
  std::vector<std::uint32_t> around_;
  std::uint32_t first_candidate_ = 0;  // of the feature whose pieces are added
};

}  // namespace morula::detail
