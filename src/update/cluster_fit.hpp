// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rest data of one skinned cluster.
#pragma once

#include <cstdint>
#include <map>
#include <morula/geometry/mesh_view.hpp>
#include <morula/update/skin_bounds.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// A cluster's vertices and how bones and morph targets move them.
class ClusterFit {
 public:
  ClusterFit(const MeshView& mesh, const Skin& skin, std::span<const std::uint32_t> vertices);

  struct Result {
    SkinBoundsCluster cluster{};  ///< first_row is 0
    std::vector<SkinBoundsRow> rows{};
    std::vector<SkinBoundsTarget> targets{};
    double weight_sum = 1;  ///< sum of the factors that multiply transforms
  };
  /// targets: finite displacements of all vertices of the mesh, or none. reach: the largest |coordinate| of a used
  /// vertex.
  Result fit(const Modes& targets, double reach);

 private:
  struct Share {
    std::uint32_t place;
    double weight;
  };

  void add_weights(const Skin& skin, std::uint32_t vertex);
  std::uint32_t main_bone() const;
  SkinBoundsRow row_of(const SkinBoundsCluster& cluster, std::uint32_t bone, bool is_main) const;
  void add_targets(const Modes& targets, double reach, Result& result) const;
  void set_allowances(Result& result, double reach) const;

  std::span<const std::uint32_t> vertices_;
  std::vector<Vec3> places_;  // about the cluster's center, once it is determined
  std::map<std::uint32_t, std::vector<Share>> of_bone_;
  double slack_ = 0, overhang_ = 0;
  double absolute_ = 0;  // more than 1 + 2 overhang_ if influences of one bone cancel
  std::size_t influences_ = 0;
};

}  // namespace morula::detail
