// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Results of a study, and functions that look them up.
#include <algorithm>
#include <morula/study/run.hpp>

namespace morula::study {
namespace {

template <class Part>
std::optional<double> part_of(const std::optional<Looseness>& looseness, Part part) {
  return looseness ? (*looseness).*part : std::nullopt;
}

template <class Value>
double worst(const MotionRun& cell, const Value& value) {
  double most = 0;
  for (const Sample& s : cell.samples)
    for (const LevelFigures& l : s.levels) most = std::max(most, value(l));
  return most;
}

}  // namespace

std::optional<double> LevelFigures::looseness() const {
  return part_of(grid, &Looseness::looseness);
}

std::optional<double> LevelFigures::looseness_box() const {
  if (!looseness() || !(box_volume > 0)) return std::nullopt;
  return grid->outside_volume / box_volume;
}

std::optional<double> LevelFigures::looseness_fixed() const {
  return part_of(lattice, &Looseness::looseness);
}

std::optional<double> LevelFigures::missed_volume() const {
  return part_of(grid, &Looseness::missed_volume);
}

std::optional<double> LevelFigures::protrusion_worst() const {
  return protrusion ? std::optional(protrusion->worst / diagonal) : std::nullopt;
}

std::optional<double> LevelFigures::protrusion_mean() const {
  return protrusion ? std::optional(protrusion->mean / diagonal) : std::nullopt;
}

std::optional<double> LevelFigures::error(ErrorUnit unit) const {
  return unit == ErrorUnit::volume ? looseness() : looseness_box();
}

std::optional<double> LevelFigures::error_on_half_grid(ErrorUnit unit) const {
  const std::optional<double> known = part_of(half_grid, &Looseness::looseness);
  if (unit == ErrorUnit::volume || !known) return known;
  return box_volume > 0 ? std::optional(half_grid->outside_volume / box_volume) : std::nullopt;
}

const UpdateCounts* TreeFigures::find_counts(std::string_view name) const {
  const auto at = std::find_if(counts.begin(), counts.end(), [&](const UpdateCounts& c) { return c.name == name; });
  return at == counts.end() ? nullptr : &*at;
}

const LevelFigures* MotionRun::at(std::size_t sample, std::size_t level) const {
  for (const Sample& s : samples) {
    if (s.sample != sample) continue;
    for (const LevelFigures& l : s.levels)
      if (l.level == level) return &l;
  }
  return nullptr;
}

double MotionRun::worst_looseness_fixed() const {
  return worst(*this, [](const LevelFigures& l) { return l.looseness_fixed().value_or(0); });
}

double MotionRun::worst_uncovered_area() const {
  return worst(*this, [](const LevelFigures& l) { return l.coverage.uncovered_area; });
}

double MotionRun::worst_uncovered_distance() const {
  return worst(*this, [](const LevelFigures& l) { return l.coverage.uncovered_distance; });
}

const MotionRun* Result::find(const MotionRunKey& key) const {
  const auto at = std::lower_bound(cells.begin(), cells.end(), key,
                                   [](const MotionRun& cell, const MotionRunKey& wanted) { return cell.key < wanted; });
  return at != cells.end() && at->key == key ? &*at : nullptr;
}

std::vector<TreeLevel> tree_levels(const Mesh& mesh, const CoveredTree& model) {
  std::vector<bool> used(mesh.vertex_count(), false);
  for (const Facet& facet : mesh.facets)
    for (const std::uint32_t vertex : facet) used[vertex] = true;
  const SphereTree& tree = model.tree;
  std::vector<TreeLevel> levels(tree.level_count());
  for (std::size_t level = 0; level < levels.size(); ++level) {
    for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
      ++levels[level].nodes;
      bool empty = true;
      for (std::size_t v = 0; v < used.size() && empty; ++v)
        empty = !used[v] || power(tree.spheres[node], mesh.positions[v]) > 0;
      levels[level].void_spheres += empty ? 1 : 0;
    }
    if (level < model.report.growth.size()) levels[level].grown = model.report.growth[level].grown;
  }
  return levels;
}

std::size_t shown_tree(const Plan& plan) {
  return plan.find_source(0, Method::medial).value_or(0);
}

}  // namespace morula::study
