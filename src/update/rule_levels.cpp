// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <morula/update/body.hpp>

namespace morula {

Rule rule_of_level(std::span<const Rule> rules, std::size_t level) {
  return rules[std::min(level, rules.size() - 1)];
}

std::string describe_rules(std::span<const Rule> rules, std::size_t level_count) {
  std::string text;
  for (std::size_t begin = 0; begin < level_count;) {
    const Rule rule = rule_of_level(rules, begin);
    std::size_t end = begin + 1;
    while (end < level_count && rule_of_level(rules, end) == rule) ++end;
    if (begin == 0 && end == level_count) return std::string(name(rule));
    if (!text.empty()) text += ", ";
    text += name(rule);
    text += end - begin == 1 ? " on level " + std::to_string(begin)
                             : " on levels " + std::to_string(begin) + "-" + std::to_string(end - 1);
    begin = end;
  }
  return text;
}

bool any_promises_cover(const Body& body) {
  for (std::size_t level = 0; level < body.rest_tree().level_count(); ++level) {
    if (covers(body.options(), rule_of_level(body.options().rules, level))) return true;
  }
  return false;
}

Certificate certify_promised_levels(const Body& body, const std::vector<Vec3>& positions, Workers& workers) {
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  const SphereTree& tree = body.rest_tree();
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    if (covers(body.options(), rule_of_level(body.options().rules, level))) continue;
    // An infinite sphere contains every corner: these nodes cannot fail, nor hide the excess of another.
    for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
      spheres[node].radius = std::numeric_limits<double>::infinity();
    }
  }
  return certify(body.cover(), positions, spheres, workers);
}

bool any_promises_nesting(const Body& body) {
  for (std::size_t level = 0; level + 1 < body.rest_tree().level_count(); ++level) {
    if (rule_of_level(body.options().rules, level) == Rule::wrapped) return true;
  }
  return false;
}

Nesting certify_promised_nesting(const Body& body) {
  const SphereTree& tree = body.rest_tree();
  std::vector<Sphere> about_origin, in_mesh_coordinates;
  for (const Spheref& s : body.spheres()) about_origin.push_back({Vec3(s.center), static_cast<double>(s.radius)});
  body.copy_spheres(in_mesh_coordinates);
  std::vector<std::uint8_t> promises(tree.node_count());
  for (std::size_t level = 0; level < tree.level_count(); ++level)
    if (rule_of_level(body.options().rules, level) == Rule::wrapped)
      std::fill(promises.begin() + tree.level_begin[level], promises.begin() + tree.level_begin[level + 1],
                std::uint8_t{1});
  const Nesting seen[] = {certify_nesting(tree, about_origin, promises),
                          certify_nesting(tree, in_mesh_coordinates, promises)};
  return seen[0].worst_excess > seen[1].worst_excess ? seen[0] : seen[1];
}

}  // namespace morula
