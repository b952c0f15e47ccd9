// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cassert>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>
#include <string>

#include "geometry/hash.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

std::size_t SphereTree::leaf_count() const {
  std::size_t count = 0;
  for (const std::uint32_t children : child_count) count += children == 0;
  return count;
}

std::uint32_t SphereTree::level_of(std::uint32_t node) const {
  assert(node < node_count());
  std::uint32_t level = 0;
  while (node >= level_begin[level + 1]) ++level;
  return level;
}

std::uint32_t SphereTree::append_level(std::span<const std::uint32_t> child_counts,
                                       std::span<const Sphere> new_spheres) {
  const auto first_new = static_cast<std::uint32_t>(node_count());
  const std::uint32_t first_parent = level_count() == 0 ? 0 : level_begin[level_count() - 1];
  assert(level_count() == 0 ? child_counts.empty() && new_spheres.size() == 1
                            : child_counts.size() == first_new - first_parent);
  if (level_begin.empty()) level_begin.push_back(0);
  spheres.insert(spheres.end(), new_spheres.begin(), new_spheres.end());
  first_child.resize(spheres.size(), no_node);
  child_count.resize(spheres.size(), 0);
  parent.resize(spheres.size(), no_node);
  std::uint32_t next = first_new;
  for (std::size_t k = 0; k < child_counts.size(); ++k) {
    if (child_counts[k] == 0) continue;
    const auto p = static_cast<std::uint32_t>(first_parent + k);
    first_child[p] = next;
    child_count[p] = child_counts[k];
    for (std::uint32_t c = 0; c < child_counts[k]; ++c) parent[next++] = p;
  }
  assert(level_count() == 0 || next == node_count());
  level_begin.push_back(static_cast<std::uint32_t>(node_count()));
  return first_new;
}

std::vector<std::uint32_t> level_set(const SphereTree& tree, std::size_t level) {
  if (level >= tree.level_count())
    throw std::invalid_argument("level " + std::to_string(level) + " of a tree of " +
                                std::to_string(tree.level_count()) + " levels, counted from 0");
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < tree.level_begin[level]; ++i)
    if (tree.is_leaf(i)) nodes.push_back(i);
  for (std::uint32_t i = tree.level_begin[level]; i < tree.level_begin[level + 1]; ++i) nodes.push_back(i);
  return nodes;
}

std::vector<Sphere> level_set_spheres(const SphereTree& tree, std::span<const Sphere> spheres, std::size_t level) {
  if (spheres.size() != tree.node_count())
    throw std::invalid_argument(std::to_string(spheres.size()) + " spheres for a tree of " +
                                std::to_string(tree.node_count()) + " nodes");
  std::vector<Sphere> set;
  for (const std::uint32_t i : level_set(tree, level)) set.push_back(spheres[i]);
  return set;
}

std::vector<Sphere> level_set_spheres(const SphereTree& tree, std::size_t level) {
  return level_set_spheres(tree, tree.spheres, level);
}

namespace {

// The first fault of the arrays' sizes and of the levels; empty where there is none.
std::string fault_of_arrays(const SphereTree& tree) {
  const std::size_t n = tree.node_count();
  if (n == 0) return "the tree has no nodes";
  if (tree.first_child.size() != n || tree.child_count.size() != n || tree.parent.size() != n)
    return "spheres, first_child, child_count and parent differ in length";
  if (tree.level_begin.size() < 2 || tree.level_begin.front() != 0 || tree.level_begin.back() != n ||
      tree.level_begin[1] != 1)
    return "level_begin does not span the nodes with a single root";
  for (std::size_t j = 0; j + 1 < tree.level_begin.size(); ++j)
    if (tree.level_begin[j] >= tree.level_begin[j + 1])
      return "level " + std::to_string(j) + " is empty or out of order";
  return {};
}

std::string node_name(std::size_t i) {
  return "node " + std::to_string(i);
}

void check_nodes(const SphereTree& tree, std::vector<std::string>& faults) {
  const std::size_t n = tree.node_count();
  std::size_t next = 1;  // children follow one another in the order of their parents
  for (std::size_t level = 0; level + 1 < tree.level_begin.size(); ++level)
    for (std::uint32_t i = tree.level_begin[level]; i < tree.level_begin[level + 1]; ++i) {
      const Sphere& s = tree.spheres[i];
      if (!is_finite(s.center) || !std::isfinite(s.radius))
        faults.push_back(node_name(i) + " has a number that is not finite");
      // mutant validate-tree-negative-radius: `s.radius < 0` -> `false`
      if (s.radius < 0) faults.push_back(node_name(i) + " has a negative radius");
      const std::uint32_t count = tree.child_count[i];
      if (count > tree.branching)
        faults.push_back(node_name(i) + " has " + std::to_string(count) + " children, more than the branching");
      if (count == 0) {
        if (tree.first_child[i] != no_node) faults.push_back(node_name(i) + " is a leaf with a first child");
        continue;
      }
      if (tree.first_child[i] != next || next + count > n) {
        faults.push_back("the children of " + node_name(i) + " are not where they belong");
        return;
      }
      for (std::uint32_t c = 0; c < count; ++c)
        if (tree.parent[next + c] != i)
          faults.push_back(node_name(next + c) + " does not name " + node_name(i) + " as its parent");
      if (level + 2 >= tree.level_begin.size() || next < tree.level_begin[level + 1] ||
          next + count > tree.level_begin[level + 2])
        faults.push_back("the children of " + node_name(i) + " are not on the next level");
      next += count;
    }
  if (next != n) faults.emplace_back("some nodes have no parent");
}

}  // namespace

std::vector<std::string> validate(const SphereTree& tree) {
  const StandardFloats standard;
  std::vector<std::string> faults;
  if (tree.branching < 2 || tree.branching > static_cast<std::uint32_t>(max_branching))
    faults.push_back("branching " + std::to_string(tree.branching) + " is not in 2…64");
  if (std::string fault = fault_of_arrays(tree); !fault.empty()) {
    faults.push_back(std::move(fault));
    return faults;
  }
  if (tree.parent[0] != no_node) faults.emplace_back("the root has a parent");
  check_nodes(tree, faults);
  // mutant validate-nested: `faults.empty()` -> `false`
  if (tree.nested && faults.empty()) {
    const Nesting nesting = certify_nesting(tree, tree.spheres);
    if (!nesting.nested)
      faults.push_back("the tree says that it is nested, but " + node_name(nesting.worst_node) + " sticks out of " +
                       node_name(tree.parent[nesting.worst_node]) + ", its parent, by " +
                       std::to_string(nesting.worst_excess));
  }
  return faults;
}

std::uint64_t tree_hash(const SphereTree& tree) {
  Hasher hash;
  hash.add(tree.branching);
  for (const Sphere& s : tree.spheres) hash.add(s);
  for (const auto* indices : {&tree.first_child, &tree.child_count, &tree.parent, &tree.level_begin})
    for (const std::uint32_t i : *indices) hash.add(i);
  return hash.value();
}

}  // namespace morula
