// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "io/json_checks.hpp"
#include "io/number_text.hpp"
#include "io/tree/format_version.hpp"
#include "io/tree/formats.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

constexpr const char* format_name = "morula spheres";
constexpr std::uint64_t json_version = 1;

// Without a point or an exponent, JSON readers may take a number for an integer, and −0 for 0.
void append_json_double(std::string& text, double value) {
  const std::size_t begin = text.size();
  append_number(text, value);
  if (text.find_first_of(".e", begin) == std::string::npos) text += ".0";
}

double finite_number(const JsonFile& file, const nlohmann::json& value, const std::string& what) {
  if (!value.is_number()) file.fail(what + " is not a number");
  return value.get<double>();
}

Sphere sphere_of(const JsonFile& file, const nlohmann::json& node, const std::string& name) {
  if (!node.is_object()) file.fail(name + " is not an object");
  const nlohmann::json& center = file.member(node, "center", name);
  if (!center.is_array() || center.size() != 3) file.fail("the center of " + name + " is not a list of 3 numbers");
  Sphere sphere;
  for (int axis = 0; axis < 3; ++axis)
    sphere.center[axis] = finite_number(file, center[static_cast<std::size_t>(axis)], "the center of " + name);
  sphere.radius = finite_number(file, file.member(node, "radius", name), "the radius of " + name);
  return sphere;
}

}  // namespace

SphereTree read_json_tree(const std::filesystem::path& path, std::string_view text) {
  JsonFile file(path, text);
  const nlohmann::json& root = file.root();
  if (!root.is_object() || root.value("format", nlohmann::json()) != format_name)
    file.fail(std::string("is JSON, but not a sphere tree: \"format\" is not \"") + format_name + "\"");
  if (const std::uint64_t given = file.unsigned_member(root, "version", "the file"); given == 0 || given > json_version)
    file.fail(unknown_format_version(given, json_version, "write it again"));
  const nlohmann::json& nodes = file.member(root, "nodes", "the file");
  if (!nodes.is_array() || nodes.empty()) file.fail("\"nodes\" is not a list of at least one node");

  SphereTree tree;
  const std::uint64_t branching = file.unsigned_member(root, "branching", "the file");
  if (branching < 2 || branching > max_branching)
    file.fail("the branching is " + std::to_string(branching) + ", not 2 to " + std::to_string(max_branching));
  tree.branching = static_cast<std::uint32_t>(branching);

  // Any numbering is read; ours, level by level, stays as it is.
  const auto name = [](std::size_t node) { return "node " + std::to_string(node); };
  std::vector<char> reached(nodes.size());
  std::vector<std::size_t> level{0};
  std::vector<std::uint32_t> child_counts;
  std::vector<Sphere> spheres{sphere_of(file, nodes[0], name(0))};
  reached[0] = 1;
  while (!spheres.empty()) {
    if (tree.level_count() > max_depth)
      file.fail("the tree has more than " + std::to_string(max_depth + 1) + " levels, which is the most");
    tree.append_level(child_counts, spheres);
    std::vector<std::size_t> next;
    child_counts.clear();
    spheres.clear();
    InterruptPoller poll_interrupt(4096);
    for (const std::size_t node : level) {
      poll_interrupt();
      const nlohmann::json& children = file.member(nodes[node], "children", name(node));
      if (!children.is_array()) file.fail("the children of " + name(node) + " are not a list");
      if (children.size() > branching)
        file.fail(name(node) + " has " + std::to_string(children.size()) + " children, more than the branching");
      for (const nlohmann::json& child : children) {
        if (!child.is_number_unsigned() || child.get<std::uint64_t>() >= nodes.size())
          file.fail("a child of " + name(node) + " is not the number of a node, 0 to " +
                    std::to_string(nodes.size() - 1));
        const auto c = child.get<std::size_t>();
        if (std::exchange(reached[c], char{1})) file.fail(name(c) + " has two parents, or is its own ancestor");
        next.push_back(c);
        spheres.push_back(sphere_of(file, nodes[c], name(c)));
      }
      child_counts.push_back(static_cast<std::uint32_t>(children.size()));
    }
    level = std::move(next);
  }
  for (std::size_t i = 0; i < reached.size(); ++i)
    if (!reached[i]) file.fail(name(i) + " has no parent");
  if (const std::uint64_t levels = file.unsigned_member(root, "levels", "the file"); levels != tree.level_count())
    file.fail("\"levels\" is " + std::to_string(levels) + ", but the nodes form " + std::to_string(tree.level_count()));
  tree.nested = file.flag(root, "nested", "the file");
  file.forget_lists();
  require_valid(path, tree);
  return tree;
}

std::string json_tree_text(const SphereTree& tree) {
  std::string text = "{\n  \"format\": \"" + std::string(format_name) +
                     "\",\n  \"version\": " + std::to_string(json_version) +
                     ",\n  \"branching\": " + std::to_string(tree.branching) +
                     ",\n  \"levels\": " + std::to_string(tree.level_count()) +
                     (tree.nested ? ",\n  \"nested\": true" : "") + ",\n  \"nodes\": [\n";
  InterruptPoller poll_interrupt(4096);
  for (std::size_t i = 0; i < tree.node_count(); ++i) {
    poll_interrupt();
    const Sphere& s = tree.spheres[i];
    text += "    {\"center\": [";
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0) text += ", ";
      append_json_double(text, s.center[axis]);
    }
    text += "], \"radius\": ";
    append_json_double(text, s.radius);
    text += ", \"children\": [";
    for (std::uint32_t k = 0; k < tree.child_count[i]; ++k) {
      if (k > 0) text += ", ";
      append_number(text, tree.first_child[i] + k);
    }
    text += i + 1 < tree.node_count() ? "]},\n" : "]}\n";
  }
  return text + "  ]\n}\n";
}

}  // namespace morula::detail
