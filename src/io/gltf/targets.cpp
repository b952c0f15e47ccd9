// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/gltf/animation.hpp"
#include "parallel/interruption.hpp"

namespace morula::gltf {
using namespace detail;

Modes joined_targets(const Document& document) {
  Modes modes;
  for (const std::uint32_t i : document.drawn) {
    const MeshData& mesh = document.meshes[document.nodes[i].mesh];
    modes.mode_count += mesh.weights.size();
    for (const VertexSet& set : mesh.vertices) modes.vertex_count += set.positions.size();
  }
  // Each mode has a displacement for every vertex, although a target moves those of one node. By a division, because a
  // product of counts may overflow.
  constexpr std::size_t most_per_byte = 32;
  if (modes.mode_count != 0 && modes.vertex_count > most_per_byte * document.bytes / modes.mode_count)
    document.fail("has " + std::to_string(modes.mode_count) + " morph targets over " +
                  std::to_string(modes.vertex_count) + " vertices, more than a file of this size can mean");
  resize_interruptibly(modes.displacements, modes.mode_count * modes.vertex_count);
  const Moment rest = at_rest(document);
  std::size_t first_mode = 0, first_vertex = 0;
  InterruptPoller poll_interrupt(1u << 14);
  for (const std::uint32_t i : document.drawn) {
    const Node& node = document.nodes[i];
    const MeshData& mesh = document.meshes[node.mesh];
    for (const VertexSet& set : mesh.vertices) {
      for (std::size_t k = 0; k < set.targets.size(); ++k)
        for (std::size_t v = 0; v < set.targets[k].size(); ++v) {
          poll_interrupt();
          const Vec3& u = set.targets[k][v];
          Vec3& own = modes.displacements[(first_mode + k) * modes.vertex_count + first_vertex + v];
          own = node.skin == none ? rest.of_node[i].linear(u) : u;
          if (!is_finite(own))
            document.fail("node " + std::to_string(i) + ": morph target " + std::to_string(k) +
                          " has a displacement that is not finite");
        }
      first_vertex += set.positions.size();
    }
    first_mode += mesh.weights.size();
  }
  return modes;
}

std::vector<double> target_coordinates(const Document& document, const Moment& rest, const Moment& moment) {
  std::vector<double> coordinates;
  for (const std::uint32_t i : document.drawn)
    for (std::size_t k = 0; k < moment.weights[i].size(); ++k)
      // mutant gltf-target-rest: `- rest.` -> `- 0 * rest.`
      coordinates.push_back(moment.weights[i][k] - rest.weights[i][k]);
  return coordinates;
}

}  // namespace morula::gltf
