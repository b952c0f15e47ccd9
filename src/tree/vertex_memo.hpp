// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cached values of a mesh's vertices.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace morula::detail {

/// Consecutive facets share most of their vertices, so values of recent vertices are kept. The last of vertices with a
/// common entry is kept, so a value may be made again, but it is never that of another vertex.
template <class Value>
class VertexMemo {
 public:
  /// facets: estimated number of requested facets; few need little room.
  explicit VertexMemo(std::size_t facets) : entries_(std::bit_ceil(std::clamp<std::size_t>(facets, 64, 65536))) {}

  /// make: called if the vertex has no entry.
  template <class Make>
  const Value& of(std::uint32_t vertex, const Make& make) {
    Entry& entry = entries_[vertex & (entries_.size() - 1)];
    // mutant memo-other-vertex: `!= vertex` -> `== no_vertex`
    if (entry.vertex != vertex) entry = {vertex, make()};
    return entry.value;
  }

 private:
  static constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();
  struct Entry {
    std::uint32_t vertex = no_vertex;
    Value value{};
  };
  std::vector<Entry> entries_;  // their number is a power of two
};

/// Separates new vertices from seen ones: it recognizes most vertices that have come already.
class SeenVertices {
 public:
  explicit SeenVertices(std::size_t facets) : seen_(facets) {}
  /// False only for a vertex that has come already.
  bool is_new(std::uint32_t vertex) {
    bool first = false;
    seen_.of(vertex, [&] { return first = true; });
    return first;
  }

 private:
  VertexMemo<bool> seen_;
};

}  // namespace morula::detail
