// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Patches of the last run, by which the next run recognizes them.
#pragma once

#include <array>
#include <cstdint>
#include <morula/collide/contact_patches.hpp>
#include <span>
#include <vector>

namespace morula::detail {

class KnownLayers {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;
  struct Patch {
    std::uint32_t id = none;
    int axis = 0;  // of the world, from which sectors are counted
  };
  /// A patch of this run that is a known one. swapped: its side a is side b of the known one.
  struct Match {
    std::uint32_t known = none;
    bool swapped = false;
  };

  void clear() noexcept { now_.clear(); }
  /// Adds a patch of this run to the next list.
  void add(const Patch& patch, std::span<const VertexGradient> a, std::span<const VertexGradient> b);
  /// The next list becomes the known one.
  void finish();
  /// Empties the next list.
  void start() { next_.clear(); }

  const Patch& operator[](std::uint32_t known) const { return now_.patches[known]; }
  /// Sets the numbers of common vertices of the known patches and of one patch of this run.
  void count(std::uint32_t patch, std::span<const VertexGradient> a, std::span<const VertexGradient> b,
             bool may_be_swapped);
  /// Matches the counted patches, the largest number first, each once. matches: by patch.
  void match(std::span<Match> matches);

 private:
  struct Vertex {
    std::uint32_t vertex, patch;
    auto operator<=>(const Vertex&) const = default;
  };
  struct Common {
    std::uint32_t known, patch;
    bool swapped;
    std::uint32_t count = 1;
    auto operator<=>(const Common&) const = default;
  };
  void count_side(std::uint32_t patch, std::span<const VertexGradient> side, const std::vector<Vertex>& known,
                  bool swapped);
  struct List {
    std::vector<Patch> patches;
    std::array<std::vector<Vertex>, 2> vertices;  // ascending in the known list
    void clear() noexcept { patches.clear(), vertices[0].clear(), vertices[1].clear(); }
  };
  List now_, next_;
  std::vector<Common> common_;
  std::vector<bool> taken_;
};

}  // namespace morula::detail
