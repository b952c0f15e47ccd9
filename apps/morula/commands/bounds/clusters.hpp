// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Clusters: a partition of the facets of a mesh, as a number for each facet.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/io/skin_bounds_file.hpp>
#include <span>
#include <utility>
#include <vector>

namespace morula::cli {

/// Halves the facets by the middles of their boxes across the longest axis, over and over, into clusters of about equal
/// numbers. count: from 1; more than there are facets count as one each. Cost: O(F log count).
std::vector<std::uint32_t> halved_clusters(const Mesh& mesh, std::size_t count);
/// Cluster k has the facets of primitive k.
std::vector<std::uint32_t> primitive_clusters(const GltfParts& parts);

/// The facets of each cluster as ranges of numbers, from the first to before the second.
using FacetRanges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
std::vector<FacetRanges> facet_ranges(std::span<const std::uint32_t> cluster_of_facet, std::size_t cluster_count);
/// The vertices that facets of each cluster use, each once.
std::vector<std::vector<std::uint32_t>> cluster_vertices(const Mesh& mesh,
                                                         std::span<const std::uint32_t> cluster_of_facet,
                                                         std::size_t cluster_count);

}  // namespace morula::cli
