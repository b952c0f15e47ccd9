// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "io/number_text.hpp"
#include "io/text_scanner.hpp"
#include "io/tree/formats.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

// The most slots of a complete tree in breadth-first order, which are mostly unused when the real tree is not full;
// beyond this, other formats serve.
constexpr std::uint64_t most_slots = 10'000'000;

// Counting stops past most_slots, so that no number overflows.
std::uint64_t slot_count(std::uint64_t levels, std::uint64_t branching) {
  std::uint64_t slots = 0, of_level = 1;
  for (std::uint64_t level = 0; level < levels && slots <= most_slots; ++level, of_level *= branching)
    slots += of_level;
  return slots;
}

std::string too_many_slots(std::uint64_t levels, std::uint64_t branching) {
  return std::to_string(levels) + " levels of branching " + std::to_string(branching) + " take more than " +
         std::to_string(most_slots) + " lines in a .sph; use the native format, .morula, or .json";
}

// A −0 stays −0 if the other term is 0.
double moved(double coordinate, double origin) {
  return origin == 0 ? coordinate : coordinate + origin;
}

}  // namespace

SphereTree read_sph(const std::filesystem::path& path, std::string_view text, const Vec3& origin) {
  TextScanner in(path, text);
  if (!in.next_line()) in.fail("the file is empty; a .sph begins with its levels and branching");
  const std::uint64_t levels = in.count("the number of levels");
  const std::uint64_t branching = in.count("the branching");
  in.require_line_end("the branching");
  if (levels < 1 || levels > max_depth + 1)
    in.fail("the tree has " + std::to_string(levels) + " levels, not 1 to " + std::to_string(max_depth + 1));
  if (branching < 2 || branching > max_branching)
    in.fail("the branching is " + std::to_string(branching) + ", not 2 to " + std::to_string(max_branching));
  const std::uint64_t slots = slot_count(levels, branching);
  if (slots > most_slots) in.fail(too_many_slots(levels, branching));

  SphereTree tree;
  tree.branching = static_cast<std::uint32_t>(branching);
  std::uint64_t lines_read = 0;
  // For each slot of the level above: the index within that level of its node, or no_node.
  std::vector<std::uint32_t> parents{0};
  for (std::uint64_t level = 0; level < levels; ++level) {
    const std::uint64_t slots_per_parent = level == 0 ? 1 : branching;
    std::vector<std::uint32_t> child_counts(level == 0 ? 0 : tree.node_count() - tree.level_begin.end()[-2]);
    std::vector<std::uint32_t> nodes;
    std::vector<Sphere> spheres;
    for (const std::uint32_t parent : parents)
      for (std::uint64_t slot = 0; slot < slots_per_parent; ++slot) {
        in.require_line(lines_read++, slots, "nodes");
        const Vec3 center{in.number("x"), in.number("y"), in.number("z")};
        const double radius = in.number("the radius");
        in.number("the weight");
        in.require_line_end("x y z r w");
        const bool used = radius > 0 && parent != no_node;
        if (level == 0 && !used)
          in.fail("the root's radius is not above 0, which marks it as unused; the tree is empty");
        nodes.push_back(used ? static_cast<std::uint32_t>(spheres.size()) : no_node);
        if (!used) continue;
        if (level > 0) ++child_counts[parent];
        spheres.push_back({{moved(center.x, origin.x), moved(center.y, origin.y), moved(center.z, origin.z)}, radius});
      }
    if (!spheres.empty()) tree.append_level(child_counts, spheres);
    parents = std::move(nodes);
  }
  require_valid(path, tree);
  return tree;
}

std::string sph_text(const std::filesystem::path& path, const SphereTree& tree) {
  if (slot_count(tree.level_count(), tree.branching) > most_slots)
    throw FileError(platform::text_of(path) + ": " + too_many_slots(tree.level_count(), tree.branching));
  for (std::size_t i = 0; i < tree.node_count(); ++i)
    if (!(tree.spheres[i].radius > 0))
      throw FileError(platform::text_of(path) + ": node " + std::to_string(i) +
                      " has radius 0, which means an unused line in a .sph; use .morula or .json");
  std::string text;
  append_number(text, tree.level_count());
  text += ' ';
  append_number(text, tree.branching);
  text += '\n';
  // mutant looks-sph-written: `4096` -> `1u << 30`
  InterruptPoller poll_interrupt(4096);
  std::vector<std::uint32_t> slots{0};  // the node of each slot of this level, or no_node
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t node : slots) {
      poll_interrupt();
      if (node == no_node) {
        text += "0 0 0 -1 0\n";
      } else {
        const Sphere& s = tree.spheres[node];
        for (const double number : {s.center.x, s.center.y, s.center.z, s.radius}) {
          append_number(text, number);
          text += ' ';
        }
        text += "1\n";
      }
      if (level + 1 == tree.level_count()) continue;
      const std::uint32_t children = node == no_node ? 0 : tree.child_count[node];
      for (std::uint32_t k = 0; k < tree.branching; ++k)
        next.push_back(k < children ? tree.first_child[node] + k : no_node);
    }
    slots = std::move(next);
  }
  return text;
}

}  // namespace morula::detail
