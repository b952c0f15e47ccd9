// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Features at rest in floats, which prove for eight features against eight others that they are near at rest.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/parallel/workers.hpp>
#include <span>
#include <vector>

#include "surface/boxes/feature_boxes.hpp"

namespace morula::detail {

/// Eight points side by side. Unused places hold NaN, which is near nothing.
struct alignas(32) PointGroup {
  float at[3][8];
};

/// A group of eight vertices is one group of points, of edges two, of facets three: their first corners, their second
/// corners and so on.
struct ShapeGroups {
  const PointGroup* first = nullptr;
  std::uint32_t corners = 1;
  const PointGroup* operator[](std::uint32_t group) const { return first + corners * group; }
};

/// The kernels of one kind of processor; all kinds compute the same bits. Bit 8 i + j stands for feature i of a and
/// feature j of b. Each returns the bits, of those given, whose features have two points with a squared distance, as
/// computed in floats, of at most `squared`.
struct NearShapes {
  using Kernel = std::uint64_t (*)(const PointGroup* a, const PointGroup* b, std::uint64_t bits, float squared);
  Kernel corners;        ///< first corners of any two shapes
  Kernel edges;          ///< edges and edges
  Kernel vertex_facets;  ///< vertices and facets
};
/// The kernels that this processor runs, the narrowest first.
std::span<const NearShapes> all_near_shapes();

/// All features at rest, in the groups of FeatureBoxes. Coordinates are about the surface's origin and scaled by a
/// power of two to at most 1. It serves every distance at rest.
class RestShapes {
 public:
  RestShapes(const SurfaceTreeState& s, Features features, Workers& workers);
  std::size_t bytes() const;

  ShapeGroups facets(std::uint32_t block) const { return {groups_.data() + first_[block], 3}; }
  ShapeGroups vertices(std::uint32_t block) const { return {groups_.data() + first_[block] + 3, 1}; }
  /// One past the end for a last block without edges.
  ShapeGroups edges(std::uint32_t block) const { return {groups_.data() + first_edges_[block], 2}; }
  /// The power of two by which coordinates are scaled.
  double scale() const { return scale_; }

 private:
  double scale_ = 1;
  std::vector<PointGroup> groups_;
  std::vector<std::uint32_t> first_, first_edges_;  // by block
};

/// RestShapes for one distance.
class NearAtRest {
 public:
  /// It proves nothing.
  NearAtRest() = default;
  /// rest_distance: a length above 0. rounding: the allowance of ExclusionTest.
  NearAtRest(std::shared_ptr<const RestShapes> shapes, double rest_distance, double rounding);
  /// Whether it can prove of any pair that it is near.
  bool is_able() const { return squared_ > 0; }
  const RestShapes& shapes() const { return *shapes_; }
  /// The bits, of those given, whose features are surely at most rest_distance apart at rest: feature i of group
  /// group_a of a and feature j of group group_b of b.
  std::uint64_t near(const ShapeGroups& a, std::uint32_t group_a, const ShapeGroups& b, std::uint32_t group_b,
                     std::uint64_t bits) const;

 private:
  std::uint64_t near_facets(const PointGroup* a, const PointGroup* b, std::uint64_t bits) const;

  std::shared_ptr<const RestShapes> shapes_;
  NearShapes kernels_{};
  float squared_ = 0;
};

}  // namespace morula::detail
