// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What has been found out about vertices of a mesh, for a while.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace morula::detail {

/// Facets that follow one another share most of their vertices: what was found out about one a moment ago is kept. Of
/// vertices that fall together the last is kept, so a value may be made anew, but never for another vertex.
template <class Value>
class VertexMemo {
 public:
  /// facets: about how many will be asked for; few need little room.
  explicit VertexMemo(std::size_t facets) : entries_(std::bit_ceil(std::clamp<std::size_t>(facets, 64, 65536))) {}

  /// make: called when the vertex is not known, or no longer.
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
  std::vector<Entry> entries_;  // a power of two of them
};

/// Tells a vertex that comes for the first time from most of those that have come before.
class SeenVertices {
 public:
  explicit SeenVertices(std::size_t facets) : seen_(facets) {}
  /// False only for a vertex that has come before.
  bool is_new(std::uint32_t vertex) {
    bool first = false;
    seen_.of(vertex, [&] { return first = true; });
    return first;
  }

 private:
  VertexMemo<bool> seen_;
};

}  // namespace morula::detail
