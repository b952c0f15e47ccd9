// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/io/skin_bounds_file.hpp>

#include "io/array/npy.hpp"
#include "io/byte_source.hpp"
#include "io/text_scanner.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

std::vector<std::uint32_t> clusters_of_array(const std::filesystem::path& path, std::size_t facet_count) {
  const ByteSource source(path);
  const NpyArray array = read_npy_header(source, {.sizes = {facet_count}, .words = "(facets,)", .integers = true});
  return read_npy_indices(source, array, "the array of clusters", false);
}

std::vector<std::uint32_t> clusters_of_text(const std::filesystem::path& path, std::size_t facet_count) {
  const std::string text = read_whole(path);
  TextScanner in(path, text);
  std::vector<std::uint32_t> clusters;
  while (in.next_line())
    while (!in.at_line_end()) {
      if (clusters.size() == facet_count)
        in.fail("has more numbers than the mesh has facets, " + std::to_string(facet_count));
      const std::uint64_t cluster = in.count("a cluster");
      if (cluster >= facet_count)
        in.fail("cluster " + std::to_string(cluster) + " is not below the number of facets, " +
                std::to_string(facet_count));
      clusters.push_back(static_cast<std::uint32_t>(cluster));
    }
  return clusters;
}

}  // namespace

std::vector<std::uint32_t> read_clusters(const std::filesystem::path& path, std::size_t facet_count) {
  const StandardFloats standard;
  const bool is_array = lower_extension(path) == ".npy";
  const std::vector<std::uint32_t> clusters =
      is_array ? clusters_of_array(path, facet_count) : clusters_of_text(path, facet_count);
  if (clusters.size() != facet_count)
    throw FileError(platform::text_of(path) + ": has " + std::to_string(clusters.size()) + " numbers for " +
                    std::to_string(facet_count) + " facets; one for each is needed");
  for (std::size_t f = 0; f < facet_count; ++f)
    if (clusters[f] >= facet_count)
      throw FileError(platform::text_of(path) + ": facet " + std::to_string(f) + " is in cluster " +
                      std::to_string(clusters[f]) + ", which is not below the number of facets, " +
                      std::to_string(facet_count));
  return clusters;
}

}  // namespace morula
