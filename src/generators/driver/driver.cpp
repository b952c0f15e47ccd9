// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/driver.hpp"

#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>

namespace morula::detail {
namespace {

// A single child is worth a level only if it is this much smaller than its parent.
constexpr double least_gain_of_single_child = 0.02;

bool worth_keeping(const BuildNode& node, const Division& division) {
  if (division.children.empty()) return false;
  if (division.children.size() > 1) return true;
  return division.children[0].sphere.radius < (1 - least_gain_of_single_child) * node.sphere.radius;
}

}  // namespace

double smallest_radius(const BuildRun& run) {
  // A sphere about a point has a radius of 2^-48 of its coordinates: a region that small is not worth dividing, nor can
  // it be divided.
  constexpr double share_of_diagonal = 1e-9, share_of_coordinate = 0x1p-47;
  return std::max(share_of_diagonal * run.box().diagonal(), share_of_coordinate * run.largest_coordinate());
}

BuildNode root_node(const MeshView& mesh, const BuildRun& run, const Box& cell) {
  BuildNode root;
  root.region = whole_surface(mesh);
  root.cell = cell;
  root.seed = run.seed;
  std::vector<Vec3> points;
  corner_positions(mesh, root.region, points);
  const Sphere smallest = enclosing_sphere(points);
  root.sphere = {smallest.center,
                 rounded_up_radius(smallest.radius, std::max(run.largest_coordinate(), max_norm(smallest.center)))};
  return root;
}

Division children_of(const BuildNode& node, const Divider& divide, double too_small) {
  if (!(node.sphere.radius > too_small)) return {};
  Division division = divide(node);
  if (!worth_keeping(node, division)) return {};
  Random seeds(node.seed);
  for (BuildNode& child : division.children) {
    child.seed = seeds.next();
    child.level = node.level + 1;
    child.ancestors = node.ancestors;
    if (node.level > 0) child.ancestors.push_back(node.sphere);
  }
  return division;
}

BuildReport new_report(const MeshView& mesh, const BuildRun& run) {
  BuildReport report;
  report.method = name(run.method);
  report.branching = static_cast<std::uint32_t>(run.branching);
  report.depth = static_cast<std::uint32_t>(run.depth);
  report.seed = run.seed;
  report.mesh_hash = mesh_hash(mesh);
  return report;
}

void Winners::add(const Division& division) {
  if (division.reducer.empty() || division.children.empty()) return;
  for (auto& [name, count] : counts_)
    if (name == division.reducer) {
      ++count;
      return;
    }
  counts_.emplace_back(division.reducer, 1);
}

std::string Winners::note() const {
  if (counts_.empty() || (counts_.size() == 1 && counts_[0].first != no_proposal)) return {};
  std::string text = "proposals taken: ";
  for (std::size_t i = 0; i < counts_.size(); ++i)
    text += (i > 0 ? ", " : "") + std::string(counts_[i].first) + " " + std::to_string(counts_[i].second);
  return text;
}

}  // namespace morula::detail
