// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Modal certificate: a proof that a modal body cannot touch itself while its coordinates stay within a ball.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/geometry/mesh_view.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/update/modes.hpp>
#include <span>
#include <vector>

namespace morula {

struct ModalCertificateOptions {
  /// Certified is as far as this, at the most: coordinates whose norm is larger are not looked at. Finite, positive.
  double largest_norm = 1;
  /// Surfaces this near count as contact. Mesh units, finite, not negative.
  double margin = 0;
  /// Leaves out pairs of facets that are this close at rest, as PairFilter does: neighbors, which bend before they
  /// touch. They are what limits a certificate of a fine mesh. 0: none.
  double rest_distance = 0;
  /// What a coordinate is divided by in the norm, one per mode: how far it usually goes. Positive; none: all 1.
  std::vector<double> scales{};
};

/// Which facets of a modal body may touch at given coordinates, decided before any vertex moves [barbic2010].
///
/// Vertex i is at X_i + sum_j q_j U_ij. Along a unit direction n that separates two facets at rest, vertices i of the
/// one and k of the other are n · (X_k - X_i) + sum_j q_j n · (U_kj - U_ij) apart: not less than the rest gap minus |q|
/// times the length of the vector of all n · (U_kj - U_ij). So the two stay apart while |q| is below the least of gap /
/// length over their vertices; a facet is the hull of its vertices. Of nodes, that hold many facets, the mean
/// displacements stand for all, and what vertices differ from them is added. A pair of nodes that is apart up to the
/// largest norm is done; what is left are pairs of facets, each with the norm up to which it is proven apart.
///
/// Pairs that share a vertex are left out, as SurfaceCrossingQuery leaves them out, and those near each other at rest.
/// What rounding does to positions, here and in move_by_modes(), is paid for by the gap.
class ModalCertificate {
 public:
  /// Copies what it needs. Throws std::invalid_argument for options out of range, modes of another number of vertices
  /// or with numbers that are not finite, and where require_usable() and require_usable_scale() do.
  /// Cost: some microseconds per pair of facets that is looked at; neighbors alone where largest_norm bends little.
  ModalCertificate(const MeshView& rest, const Modes& modes, const ModalCertificateOptions& options = {});
  ~ModalCertificate();
  ModalCertificate(ModalCertificate&&) noexcept;
  ModalCertificate& operator=(ModalCertificate&&) noexcept;

  /// The root of the sum of squares of q_j / scale_j, rounded up; infinite for coordinates that are not finite or not
  /// one per mode.
  double norm(std::span<const double> coordinates) const;
  /// No two facets that count touch, or come as near as the margin, while the norm is at most this. Not
  /// more than largest_norm.
  double free_norm() const;
  bool is_free(std::span<const double> coordinates) const { return norm(coordinates) <= free_norm(); }

  /// Is something known at these coordinates: are they within largest_norm?
  bool is_known(std::span<const double> coordinates) const;
  /// The pairs of facets that may touch there: all others are proven apart. Those that are the first to be open come
  /// first. Of coordinates that are not known, all pairs that are open at largest_norm, and that says nothing.
  std::span<const FeaturePair> open(std::span<const double> coordinates) const;
  /// Adds those of open() that intersect, exactly, where the vertices are now, in the order of (a, b): what
  /// SurfaceCrossingQuery finds with the same rest distance, when positions are those of move_by_modes() at these
  /// coordinates. Returns false, with nothing added, for coordinates that are not known and for another number of
  /// positions. No allocation once warm.
  bool crossings(std::span<const double> coordinates, const PositionView& positions,
                 std::vector<FeaturePair>& pairs) const;

  std::size_t tested_facet_pairs() const;  ///< when it was made
  std::size_t tested_node_pairs() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
