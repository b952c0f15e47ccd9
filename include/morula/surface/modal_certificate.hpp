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
  /// Largest norm of coordinates that the certificate is computed for. Finite, positive.
  double largest_norm = 1;
  /// Largest distance that counts as contact, mesh units; finite, not negative.
  double margin = 0;
  /// Distance at rest, mesh units: pairs of facets that are at most this far apart at rest are skipped, like in
  /// PairFilter. These are neighbors, which bend before they touch, and they limit the certificate of a fine mesh. 0:
  /// none.
  double rest_distance = 0;
  /// Divisors of the coordinates in the norm, one per mode: the usual amplitude of each. Positive; empty: all 1.
  std::vector<double> scales{};
};

/// Pairs of facets of a modal body that may touch at given coordinates, decided without moving any vertex [barbic2010].
///
/// Vertex i is at X_i + sum_j q_j U_ij. Along a unit direction n that separates two facets at rest, vertices i of one
/// and k of the other have the distance n · (X_k - X_i) + sum_j q_j n · (U_kj - U_ij). This is at least the rest gap
/// minus |q| times the length of the vector of all n · (U_kj - U_ij). So the two stay apart while |q| is below the
/// least gap / length over their vertices, because a facet is the hull of its vertices. A node holds many facets: its
/// mean displacements represent them, and the deviation of its vertices is added. A pair of nodes that is apart up to
/// the largest norm is finished; the rest are pairs of facets, each with the norm up to which it is proven apart.
///
/// Pairs that share a vertex are skipped, as in SurfaceCrossingQuery, and so are pairs near each other at rest. The gap
/// is reduced by the rounding of positions, here and in move_by_modes().
class ModalCertificate {
 public:
  /// Copies the required data. Throws std::invalid_argument for options out of range, for modes of another number of
  /// vertices or with numbers that are not finite, and for meshes that require_usable() and require_usable_scale()
  /// reject. Cost: a few microseconds per compared pair of facets; only neighbors are compared if largest_norm bends
  /// the body little.
  ModalCertificate(const MeshView& rest, const Modes& modes, const ModalCertificateOptions& options = {});
  ~ModalCertificate();
  ModalCertificate(ModalCertificate&&) noexcept;
  ModalCertificate& operator=(ModalCertificate&&) noexcept;

  /// Root of the sum of squares of q_j / scale_j, rounded up; infinite for coordinates that are not finite, or not one
  /// per mode.
  double norm(std::span<const double> coordinates) const;
  /// Norm up to which no two facets of the certificate touch, or come as near as the margin; at most largest_norm.
  double free_norm() const;
  bool is_free(std::span<const double> coordinates) const { return norm(coordinates) <= free_norm(); }

  /// True if the certificate holds for these coordinates: they are within largest_norm.
  bool is_known(std::span<const double> coordinates) const;
  /// The pairs of facets that may touch at these coordinates; all others are proven apart. Pairs are in the order of
  /// the norm at which they open. For coordinates beyond largest_norm the result is all pairs open at largest_norm,
  /// without a guarantee.
  std::span<const FeaturePair> open(std::span<const double> coordinates) const;
  /// Appends the pairs of open() that intersect, exactly, at the present vertices, in the order of (a, b). These are
  /// the results of SurfaceCrossingQuery with the same rest distance, if positions are those of move_by_modes() at
  /// these coordinates. Returns false, and appends nothing, for coordinates beyond largest_norm and for another number
  /// of positions. Allocates nothing after the first calls.
  bool crossings(std::span<const double> coordinates, const PositionView& positions,
                 std::vector<FeaturePair>& pairs) const;

  std::size_t tested_facet_pairs() const;  ///< tests of the construction
  std::size_t tested_node_pairs() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
