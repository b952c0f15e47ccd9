// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

#include "io/gltf/animation.hpp"
#include "parallel/interruptible_sort.hpp"

namespace morula::gltf {
using namespace detail;
namespace {

/// A vertex of the joined mesh. A target without displacements of the set displaces it by zero.
struct PlaceOfVertex {
  const VertexSet* set;
  std::size_t vertex;
  std::uint32_t label;  // of its node and its influences

  std::size_t target_count() const { return set->targets.size(); }
  Vec3 displacement(std::size_t target) const {
    return target < set->targets.size() && !set->targets[target].empty() ? set->targets[target][vertex] : Vec3{};
  }
};

bool comes_before(const PlaceOfVertex& a, const PlaceOfVertex& b) {
  if (a.label != b.label) return a.label < b.label;
  // A node may flatten what is apart, and unfold it in another frame.
  const Vec3 here = a.set->positions[a.vertex], there = b.set->positions[b.vertex];
  for (int axis = 0; axis < 3; ++axis)
    if (here[axis] != there[axis]) return here[axis] < there[axis];
  for (std::size_t k = 0; k < std::max(a.target_count(), b.target_count()); ++k) {
    const Vec3 p = a.displacement(k), q = b.displacement(k);
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] != q[axis]) return p[axis] < q[axis];
  }
  return false;
}

}  // namespace

// Vertices of one label are moved by the same numbers in every frame: joined_skin() has bones of their own for each
// node, with the weights of the node's morph targets the same for all its vertices.
std::vector<std::uint32_t> vertex_labels(const Document& document) {
  const std::vector<std::uint32_t> of_skin = skin_labels(joined_skin(document));
  std::vector<PlaceOfVertex> places;
  for (const std::uint32_t i : document.drawn)
    for (const VertexSet& set : document.meshes[document.nodes[i].mesh].vertices)
      for (std::size_t v = 0; v < set.positions.size(); ++v) {
        make_room(places);
        places.push_back({&set, v, of_skin[places.size()]});
      }
  std::vector<std::uint32_t> sorted(places.size()), labels(places.size());
  std::iota(sorted.begin(), sorted.end(), std::uint32_t{0});
  // mutant weld-morphs: `comes_before(places[v], places[w])` -> `places[v].label < places[w].label`
  const auto is_less = [&](std::uint32_t v, std::uint32_t w) { return comes_before(places[v], places[w]); };
  sort_interruptibly(sorted, is_less);
  for (std::size_t i = 1; i < sorted.size(); ++i)
    labels[sorted[i]] = labels[sorted[i - 1]] + (is_less(sorted[i - 1], sorted[i]) ? 1 : 0);
  return labels;
}

}  // namespace morula::gltf
