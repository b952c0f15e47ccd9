// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Modal certificate: a proof that a body moved by modes cannot touch itself while the norm of its coordinates stays
// below a limit.
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
  /// Largest norm of coordinates (ModalCertificate::norm) for which the certificate is computed. Finite, positive.
  double largest_norm = 1;
  /// Largest distance of two facets that counts as contact, mesh units. Finite, 0 or more.
  double margin = 0;
  /// Pairs of facets that are at most this far apart at rest are skipped, as in PairFilter, mesh units; finite, 0 or
  /// more. 0 skips none. A fine mesh needs it: without it, facets that are near each other along the surface make
  /// free_norm() small.
  double rest_distance = 0;
  /// Divisors of the coordinates in the norm, one per mode, such as the usual amplitude of each. Between 2^-100 and
  /// 2^100; empty: all 1.
  std::vector<double> scales{};
};

/// Pairs of facets of a modal body that may touch at given coordinates, decided without moving any vertex [barbic2010].
///
/// Vertex i is at X_i + sum_j q_j U_ij, where X_i is its rest position. Let n be a unit vector that separates two
/// facets at rest. Along n, vertices i of one facet and k of the other are n · (X_k - X_i) + sum_j q_j n · (U_kj -
/// U_ij) apart. This is at least their gap n · (X_k - X_i) minus |q| times the length of the vector with the components
/// n · (U_kj - U_ij). A facet is the convex hull of its vertices, so the two facets stay apart while |q| is below the
/// least gap / length over their pairs of vertices.
///
/// The constructor searches a tree of boxes. For a node of many facets, the length is that of the difference of mean
/// displacements, plus the largest deviations of the nodes' vertices from these means. It does not open a pair of nodes
/// that is proven apart up to largest_norm. It stores each remaining pair of facets with the norm up to which the pair
/// is proven apart.
///
/// Facets that share a vertex are skipped, as in SurfaceCrossingQuery, and so are those within rest_distance. Gaps are
/// reduced by a bound of the rounding errors of the certificate and of move_by_modes(). Several threads may call const
/// members at once.
class ModalCertificate {
 public:
  /// Copies the required data. Throws std::invalid_argument for options out of range, for modes of another number of
  /// vertices or with a displacement that is not finite or is 2^100 or more, and for meshes that require_usable() and
  /// require_usable_scale() reject. Cost: a few microseconds per compared pair of facets (tested_facet_pairs). If
  /// largest_norm bends the body little, only neighbors are compared.
  ModalCertificate(const MeshView& rest, const Modes& modes, const ModalCertificateOptions& options = {});
  ~ModalCertificate();
  ModalCertificate(ModalCertificate&&) noexcept;
  ModalCertificate& operator=(ModalCertificate&&) noexcept;

  /// The norm of coordinates: the square root of the sum of (q_j / scales_j)², rounded up; infinite for coordinates
  /// that are not finite, and for another number of coordinates than modes.
  double norm(std::span<const double> coordinates) const;
  /// The norm up to which no pair of facets touches or comes as near as the margin, except skipped pairs; at most
  /// largest_norm.
  double free_norm() const;
  /// True if no pair of facets touches at these coordinates, except skipped pairs; false if that is not proven.
  bool is_free(std::span<const double> coordinates) const { return norm(coordinates) <= free_norm(); }

  /// True if the certificate is valid for these coordinates: their norm is at most largest_norm.
  bool is_known(std::span<const double> coordinates) const;
  /// The pairs of facets that may touch at these coordinates; all others, except skipped pairs, are proven apart. Pairs
  /// are ordered by the norm up to which they are proven apart. Beyond largest_norm the result is all stored pairs, and
  /// other pairs may touch.
  std::span<const FeaturePair> open(std::span<const double> coordinates) const;
  /// Tests the pairs of open() exactly, with vertices at `positions`, and appends those that intersect to `pairs`, in
  /// the order of (a, b). positions: those of move_by_modes() at these coordinates. The appended pairs are then those
  /// of SurfaceCrossingQuery with the same rest distance. Returns false, and appends nothing, for coordinates beyond
  /// largest_norm and for another number of positions. Allocates only if `pairs` has to grow.
  bool crossings(std::span<const double> coordinates, const PositionView& positions,
                 std::vector<FeaturePair>& pairs) const;

  std::size_t tested_facet_pairs() const;  ///< number of pairs of facets that the constructor compared
  std::size_t tested_node_pairs() const;   ///< number of pairs of nodes that it compared

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
