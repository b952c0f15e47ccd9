// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Integrals along pieces of edges: volume, gradients, moments and centroid of a patch.
//
// Along a piece the distance is |z| of a linear z (facets), or the square root of a quadratic function (edges and
// vertices). For facets, two Gauss points on either side of z = 0 are exact. The square root is analytic except at two
// complex parameters: so a piece is halved until it is short compared with its distance from them, and Gauss points
// have a relative error below 1e-10 then.
#pragma once

#include <array>
#include <cstdint>
#include <morula/collide/contact_patches.hpp>
#include <span>
#include <vector>

#include "surface/layers/edge_layers.hpp"
#include "surface/layers/layer_mesh.hpp"

namespace morula::detail {

/// One of the points by which a patch is integrated.
struct LayerSample {
  Vec3 middle;          // between the points of both surfaces, about the origin
  Vec3 pressure;        // minus the derivative of the volume with respect to a's point
  double volume, area;  // area: weight times (thickness − distance) / thickness
};

struct LayerSums {
  double volume = 0, pressed_area = 0, depth = 0;
  Vec3 first_moment;  // of the volume, about the origin
  std::array<double, 2> area{};
};

class LayerIntegrals {
 public:
  /// Starts a patch. mesh: of sides a and b, which may be one. coincident: distance up to which points coincide, so
  /// that the vector between them is rounding and has no direction.
  void start(const LayerMesh& a, const LayerMesh& b, double thickness, double coincident);
  /// Adds a piece of an edge of a side. samples: appended to, unless null.
  void add(const LayerPiece& piece, std::uint8_t side, std::vector<LayerSample>* samples);
  const LayerSums& sums() const { return sums_; }
  /// Appends the gradients of a side, ascending by vertex. moment: their moment about a point; sum: their sum.
  void put(std::uint8_t side, const Vec3& about, std::vector<VertexGradient>& gradients, Vec3& sum, Vec3& moment);

 private:
  /// Distances and nearest points of one piece, as functions of t.
  struct Foot {
    std::array<std::uint32_t, 3> vertices{};  // of the feature
    std::size_t size = 1;
    std::array<double, 3> share{}, share_slope{};  // of the vertices: linear in t
    Vec3 offset, offset_slope;                     // from the nearest point to x
    Vec3 normal;                                   // of a facet
  };
  Foot foot_of(const LayerPiece& piece, const LayerMesh& other, const Vec3& p, const Vec3& u) const;
  void integrate(double from, double to, double nearest, double height);
  void gauss(std::span<const std::array<double, 2>> rule, double from, double to);
  void add_point(double t, double share);
  void add_gradient(std::uint8_t side, std::uint32_t vertex, const Vec3& gradient);

  /// Sums by vertex; those of another patch are older.
  struct Gradients {
    const LayerMesh* mesh = nullptr;
    std::vector<Vec3> sum;
    std::vector<std::uint64_t> patch;
    std::vector<std::uint32_t> touched;
  };
  std::array<Gradients, 2> gradients_;
  std::uint64_t patch_ = 0;
  double thickness_ = 0, coincident_ = 0;
  LayerSums sums_;
  // The piece in work.
  Foot foot_;
  std::uint8_t side_ = 0;
  std::array<std::uint32_t, 2> ends_{};
  Vec3 p_, u_;
  double weight_ = 0;
  std::vector<LayerSample>* samples_ = nullptr;
};

}  // namespace morula::detail
