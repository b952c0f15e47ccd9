// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "build/top_down.hpp"

#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/random.hpp>

namespace morula {
namespace {

// A single child is worth a level only if it is this much smaller than its parent.
constexpr double least_gain_of_single_child = 0.02;
// Regions smaller than this share of the mesh's diagonal are points for all purposes.
constexpr double smallest_region = 1e-9;

bool worth_keeping(const BuildNode& node, const Division& division) {
  if (division.children.empty()) return false;
  if (division.children.size() > 1) return true;
  return division.children[0].sphere.radius < (1 - least_gain_of_single_child) * node.sphere.radius;
}

// How often each reducer's proposal was taken, in the order of first use.
class Winners {
 public:
  void add(std::string_view reducer) {
    if (reducer.empty()) return;
    for (auto& [name, count] : counts_)
      if (name == reducer) {
        ++count;
        return;
      }
    counts_.emplace_back(reducer, 1);
  }
  // Nothing when there was no choice and no fallback.
  std::string note() const {
    if (counts_.empty() || (counts_.size() == 1 && counts_[0].first != no_proposal)) return {};
    std::string text = "proposals taken: ";
    for (std::size_t i = 0; i < counts_.size(); ++i)
      text += (i > 0 ? ", " : "") + std::string(counts_[i].first) + " " + std::to_string(counts_[i].second);
    return text;
  }

 private:
  std::vector<std::pair<std::string_view, std::size_t>> counts_;
};

}  // namespace

double largest_coordinate(const Mesh& mesh) {
  const Box box = bounding_box(mesh);
  return std::max(largest_component(box.lower), largest_component(box.upper));
}

Built top_down(const Mesh& mesh, const BuildOptions& options, const Box& root_cell, const Divider& divide,
               Workers& workers, const LevelHook& new_level) {
  Built built;
  built.tree.branching = static_cast<std::uint32_t>(options.branching);
  BuildReport& report = built.report;
  report.method = name(options.method);
  report.branching = built.tree.branching;
  report.depth = static_cast<std::uint32_t>(options.depth);
  report.seed = options.seed;
  report.mesh_hash = mesh_hash(mesh);

  // Progress: every level costs about the same, because each goes over the whole surface once.
  const auto progress = [&](double done) {
    if (options.progress) options.progress(done / std::max(1, options.depth));
  };
  progress(0);

  Winners winners;
  std::vector<Region> finished;  // one per node of the tree; only leaves keep theirs
  std::vector<BuildNode> level(1);
  {
    BuildNode& root = level[0];
    root.region = whole_surface(mesh);
    root.cell = root_cell;
    root.seed = options.seed;
    std::vector<Vec3> points;
    corner_positions(mesh, root.region, points);
    const Sphere smallest = enclosing_sphere(points);
    root.sphere = {smallest.center, rounded_up_radius(smallest.radius, std::max(largest_coordinate(mesh),
                                                                                largest_component(smallest.center)))};
    built.tree.append_level({}, std::span(&root.sphere, 1));
  }
  const double too_small = smallest_region * bounding_box(mesh).diagonal();

  for (int depth = 0; depth < options.depth && !level.empty(); ++depth) {
    std::vector<Division> divisions(level.size());
    const auto divide_node = [&](std::size_t i) {
      if (!(level[i].sphere.radius > too_small)) return;
      divisions[i] = divide(level[i]);
      if (!worth_keeping(level[i], divisions[i])) divisions[i] = {};
    };
    // A few nodes at a time, so that progress is reported from here; results do not depend on the grouping.
    constexpr std::size_t nodes_per_report = 16;
    for (std::size_t begin = 0; begin < level.size(); begin += nodes_per_report) {
      const std::size_t end = std::min(level.size(), begin + nodes_per_report);
      workers.run(end - begin, [&](std::size_t i) { divide_node(begin + i); });
      progress(depth + static_cast<double>(end) / static_cast<double>(level.size()));
    }

    std::vector<BuildNode> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      report.leftover_patches += divisions[i].leftover_patches;
      if (!divisions[i].children.empty()) winners.add(divisions[i].reducer);
      finished.push_back(divisions[i].children.empty() ? std::move(level[i].region) : Region{});
      Random seeds(level[i].seed);
      for (BuildNode& child : divisions[i].children) {
        child.seed = seeds.next();
        child.level = depth + 1;
        child.parent = static_cast<std::uint32_t>(i);
        child.ancestors = level[i].ancestors;
        if (depth > 0) child.ancestors.push_back(level[i].sphere);
        next.push_back(std::move(child));
      }
    }
    if (new_level && !next.empty()) {
      new_level(next);
      std::erase_if(next, [](const BuildNode& node) { return node.region.empty(); });
    }
    std::vector<std::uint32_t> child_counts(level.size(), 0);
    std::vector<Sphere> spheres;
    for (const BuildNode& node : next) {
      ++child_counts[node.parent];
      spheres.push_back(node.sphere);
    }
    if (!next.empty()) built.tree.append_level(child_counts, spheres);
    level = std::move(next);
  }
  for (BuildNode& node : level) finished.push_back(std::move(node.region));
  built.cover = assemble_cover(mesh, built.tree, finished);
  for (std::uint32_t i = 0; i < built.tree.level_begin[built.tree.level_count() - 1]; ++i)
    report.early_leaves += built.tree.is_leaf(i);
  if (built.tree.level_count() < static_cast<std::size_t>(options.depth) + 1)
    report.notes.push_back("the surface cannot be divided further: the tree ends at level " +
                           std::to_string(built.tree.level_count() - 1) + " of " + std::to_string(options.depth));
  if (std::string note = winners.note(); !note.empty()) report.notes.push_back(std::move(note));
  progress(options.depth);
  return built;
}

}  // namespace morula
