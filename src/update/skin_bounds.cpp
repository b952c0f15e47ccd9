// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rest data of skinned clusters; cluster_fit.cpp has the reason why bounds from it cover.
#include <algorithm>
#include <cmath>
#include <morula/update/skin_bounds.hpp>
#include <stdexcept>
#include <string>

#include "geometry/rounded_up.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "update/cluster_fit.hpp"
#include "update/rules/modal.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double least_reach = 0x1p-40, largest_reach = 0x1p50, length_limit = 0x1p55;
constexpr std::uint32_t most_clusters = 1u << 24, most_targets = 1u << 16;

// The vertices of each cluster's facets, each once, in ascending order.
std::vector<std::vector<std::uint32_t>> vertices_of_clusters(const MeshView& mesh,
                                                             std::span<const std::uint32_t> cluster_of_facet) {
  if (cluster_of_facet.size() != mesh.facet_count())
    throw std::invalid_argument("there are " + std::to_string(cluster_of_facet.size()) +
                                " numbers of clusters, but the mesh has " + std::to_string(mesh.facet_count()) +
                                " facets");
  const std::uint32_t largest = *std::max_element(cluster_of_facet.begin(), cluster_of_facet.end());
  if (largest >= most_clusters)
    throw std::invalid_argument("the number of a cluster is " + std::to_string(largest) + ", not below " +
                                std::to_string(most_clusters));
  std::vector<std::vector<std::uint32_t>> result(largest + 1);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    std::vector<std::uint32_t>& vertices = result[cluster_of_facet[f]];
    vertices.insert(vertices.end(), mesh.facets[f].begin(), mesh.facets[f].end());
  }
  for (std::vector<std::uint32_t>& vertices : result) {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }
  return result;
}

void require_near(const Modes& targets, std::span<const std::vector<std::uint32_t>> vertices) {
  for (std::size_t j = 0; j < targets.mode_count; ++j)
    for (const std::vector<std::uint32_t>& of_cluster : vertices)
      for (const std::uint32_t v : of_cluster)
        if (!(max_norm(targets.mode(j)[v]) <= largest_reach))
          throw std::invalid_argument("morph target " + std::to_string(j) + " moves vertex " + std::to_string(v) +
                                      " beyond 2^50, too far for bounds in float: scale it");
}

}  // namespace

std::vector<std::uint32_t> clusters_of_runs(std::span<const std::uint32_t> begin) {
  if (begin.empty() || begin.front() != 0 || !std::is_sorted(begin.begin(), begin.end()))
    throw std::invalid_argument("the list of where clusters begin does not go up from 0 to the number of facets");
  std::vector<std::uint32_t> result(begin.back());
  for (std::size_t k = 0; k + 1 < begin.size(); ++k)
    std::fill(result.begin() + begin[k], result.begin() + begin[k + 1], static_cast<std::uint32_t>(k));
  return result;
}

SkinBounds::SkinBounds(const MeshView& mesh, const Skin& skin, std::span<const std::uint32_t> cluster_of_facet,
                       Workers& workers)
    : SkinBounds(mesh, skin, Modes{}, cluster_of_facet, workers) {}

SkinBounds::SkinBounds(const MeshView& mesh, const Skin& skin, const Modes& targets,
                       std::span<const std::uint32_t> cluster_of_facet, Workers& workers) {
  const StandardFloats standard;
  require_usable(mesh);
  require_skin(skin, mesh);
  if (!targets.empty()) require_modes(targets, mesh);
  if (targets.mode_count >= most_targets)
    throw std::invalid_argument(std::to_string(targets.mode_count) + " morph targets are too many for bounds in float");
  const double reach = std::max(largest_coordinate(mesh), least_reach);
  if (!(reach <= largest_reach))
    throw std::invalid_argument("the mesh has coordinates beyond 2^50, too large for bounds in float: scale it");
  data_.bone_count = static_cast<std::uint32_t>(skin.bone_count);
  data_.reach = rounded_up(reach);
  const std::vector<std::vector<std::uint32_t>> vertices = vertices_of_clusters(mesh, cluster_of_facet);
  require_near(targets, vertices);
  std::vector<ClusterFit::Result> fits(vertices.size());
  parallel_for(workers, vertices.size(), 1, [&](std::size_t k, std::size_t) {
    check_interrupt();
    fits[k] = ClusterFit(mesh, skin, vertices[k]).fit(targets, reach);
  });
  double weight_sum = 1;
  data_.target_count = static_cast<std::uint32_t>(targets.mode_count);
  if (data_.target_count > 0) data_.target_begin.push_back(0);
  for (ClusterFit::Result& fit : fits) {
    fit.cluster.first_row = static_cast<std::uint32_t>(data_.rows.size());
    data_.clusters.push_back(fit.cluster);
    data_.rows.insert(data_.rows.end(), fit.rows.begin(), fit.rows.end());
    data_.targets.insert(data_.targets.end(), fit.targets.begin(), fit.targets.end());
    if (data_.target_count > 0) data_.target_begin.push_back(static_cast<std::uint32_t>(data_.targets.size()));
    weight_sum = std::max(weight_sum, fit.weight_sum);
  }
  data_.largest_size = static_cast<float>(length_limit / weight_sum * (1 - 0x1p-20));
  set_travels();
}

void SkinBounds::set_travels() {
  travels_.assign(data_.target_count, 0.0);
  for (const SkinBoundsTarget& t : data_.targets) {
    const double travel = static_cast<double>(max_norm(t.shift)) + static_cast<double>(t.radius);
    travels_[t.target] = std::max(travels_[t.target], travel);
  }
}

SkinBounds::SkinBounds(SkinBoundsData data) : data_(std::move(data)) {
  const auto require = [](bool holds, const char* what, std::size_t index) {
    if (!holds) throw std::invalid_argument(what + (" " + std::to_string(index)) + " of the rest data is not valid");
  };
  const auto is_length = [](float x) { return x >= 0 && std::isfinite(x); };
  const auto is_point = [](const Vec3f& p) { return is_finite(Vec3(p)); };
  if (data_.bone_count == 0 || !(data_.reach >= static_cast<float>(least_reach)) || !is_length(data_.reach) ||
      !is_length(data_.largest_size))
    throw std::invalid_argument("the rest data needs bones, a reach of at least 2^-40, and a largest size");
  for (std::size_t k = 0; k < data_.clusters.size(); ++k) {
    const SkinBoundsCluster& c = data_.clusters[k];
    const Vec3f& h = c.half_extent;
    require(is_point(c.center) && is_length(c.radius) && is_length(h.x) && is_length(h.y) && is_length(h.z) &&
                is_length(c.overhang) && c.growth >= 1 && is_length(c.growth) && is_length(c.rounding) &&
                c.first_row <= data_.rows.size() && c.row_count <= data_.rows.size() - c.first_row,
            "cluster", k);
  }
  for (std::size_t k = 0; k < data_.rows.size(); ++k) {
    const SkinBoundsRow& row = data_.rows[k];
    require(row.bone < data_.bone_count && std::isfinite(row.weight) && is_length(row.weight_stray) &&
                is_length(row.moment_stray) && is_point(row.center) && is_length(row.radius),
            "row", k);
  }
  const std::vector<std::uint32_t>& begin = data_.target_begin;
  const bool fits = data_.target_count == 0
                        ? begin.empty() && data_.targets.empty()
                        : begin.size() == data_.clusters.size() + 1 && begin.front() == 0 &&
                              begin.back() == data_.targets.size() && std::is_sorted(begin.begin(), begin.end());
  if (!fits || data_.target_count >= most_targets)
    throw std::invalid_argument("the morph targets of the rest data do not fit its clusters");
  for (std::size_t k = 0; k < data_.targets.size(); ++k) {
    const SkinBoundsTarget& t = data_.targets[k];
    const Vec3f& h = t.half_extent;
    require(t.target < data_.target_count && is_point(t.shift) && is_length(t.radius) && is_length(h.x) &&
                is_length(h.y) && is_length(h.z),
            "target", k);
  }
  set_travels();
}

}  // namespace morula
