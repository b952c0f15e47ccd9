// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/generators/build.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>

#include "generators/driver/equal_children.hpp"
#include "generators/driver/join.hpp"
#include "generators/methods.hpp"
#include "parallel/float_environment.hpp"
#include "tree/wrapping.hpp"

namespace morula {
using namespace detail;
namespace {

struct Entry {
  Method method;
  std::string_view name;
  CoveredTree (*build)(const MeshView&, const BuildRun&, Workers&);
};
constexpr std::array<Entry, 7> entries{{
    {Method::octree, "octree", build_octree},
    {Method::grid, "grid", build_grid},
    {Method::hubbard, "hubbard", build_hubbard},
    {Method::spawn, "spawn", build_spawn},
    {Method::medial, "medial", build_medial},
    {Method::combined, "combined", build_combined},
    {Method::optimized, "optimized",
     [](const MeshView& mesh, const BuildRun& run, Workers& workers) { return build_optimized(mesh, run, workers); }},
}};

// An enumeration whose values count up from 0, with its names in that order.
template <class Enum, std::size_t count>
struct Names {
  std::array<std::string_view, count> names;
  std::array<Enum, count> values{};

  constexpr explicit Names(const std::array<std::string_view, count>& names_) : names(names_) {
    for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<Enum>(i);
  }
  std::string_view name(Enum value, const char* what) const {
    const auto i = static_cast<std::size_t>(value);
    if (i >= count) throw std::invalid_argument(std::string("build: unknown ") + what);
    return names[i];
  }
  std::optional<Enum> find(std::string_view wanted) const {
    for (std::size_t i = 0; i < count; ++i)
      if (names[i] == wanted) return values[i];
    return std::nullopt;
  }
};
constexpr Names<Reduction, 6> reduction_names({"grid", "hubbard", "spawn", "merge", "burst", "expand"});
constexpr Names<Optimizer, 4> optimizer_names({"none", "recenter", "simplex", "balance"});
constexpr Names<Quality, 4> quality_names({"draft", "fast", "default", "best"});

constexpr auto methods = [] {
  std::array<Method, entries.size()> all{};
  for (std::size_t i = 0; i < entries.size(); ++i) all[i] = entries[i].method;
  return all;
}();

const Entry& entry(Method method) {
  for (const Entry& e : entries)
    if (e.method == method) return e;
  throw std::invalid_argument("build: unknown method");
}

// Rejects options that the method does not use: users would expect an effect.
void require_used(const BuildOptions& options) {
  const std::string method(name(options.method));
  const bool any_list = options.method == Method::combined;
  if (!options.reducers.empty() && !any_list && options.method != Method::medial)
    throw std::invalid_argument("build: method " + method + " takes no list of reducers; medial and combined do");
  for (std::size_t i = 0; i < options.reducers.size(); ++i) {
    const Reduction r = options.reducers[i];
    const std::string reducer(name(r));
    if (!any_list && r != Reduction::merge && r != Reduction::burst && r != Reduction::expand)
      throw std::invalid_argument("build: method medial reduces by merge, burst or expand, not " + reducer +
                                  "; combined takes any");
    if (std::find(options.reducers.begin(), options.reducers.begin() + static_cast<std::ptrdiff_t>(i), r) !=
        options.reducers.begin() + static_cast<std::ptrdiff_t>(i))
      throw std::invalid_argument("build: reducer " + reducer + " is listed twice");
  }
  const bool proposes = options.method != Method::octree && options.method != Method::optimized;
  if (options.optimizer != Optimizer::none && !proposes)
    throw std::invalid_argument("build: method " + method + " has no use for optimizer " +
                                std::string(name(options.optimizer)));
  if (!(options.balance_excess >= 0) || !std::isfinite(options.balance_excess))
    throw std::invalid_argument("build: balance excess is not a number of at least 0");
  if (options.balance_excess > 0 && options.optimizer != Optimizer::balance)
    throw std::invalid_argument("build: a balance excess needs the optimizer balance, not " +
                                std::string(name(options.optimizer)));
  if (options.quality != Quality::standard && options.method != Method::optimized)
    throw std::invalid_argument("build: method " + method + " has one way only; quality " +
                                std::string(name(options.quality)) + " is for method optimized");
}

void require_numbers(const BuildOptions& options) {
  constexpr std::size_t most_spheres = 100'000'000;
  if (options.spheres && (*options.spheres == 0 || *options.spheres > most_spheres))
    throw std::invalid_argument("build: " + std::to_string(*options.spheres) + " spheres are not in 1…100000000");
  if (options.max_protrusion && !(*options.max_protrusion > 0 && std::isfinite(*options.max_protrusion)))
    throw std::invalid_argument("build: the greatest protrusion is not a number above 0");
  if (!(options.tolerance >= 0 && options.tolerance < 1e30))
    throw std::invalid_argument("build: the tolerance is not a number of at least 0");
  if (options.tolerance > 0 && options.method != Method::optimized)
    throw std::invalid_argument("build: method " + std::string(name(options.method)) +
                                " does not fit for a tolerance; optimized does");
  if (options.time_limit_seconds && !(*options.time_limit_seconds >= 0 && std::isfinite(*options.time_limit_seconds)))
    throw std::invalid_argument("build: the time limit is not a number of at least 0");
}

// A requested level keeps its parts, also if they are as large as the whole: parts of a ball that move apart have to be
// parts.
void remove_useless_divisions(const BuildOptions& options, CoveredTree& model) {
  if (options.spheres || options.max_protrusion) return;
  const std::size_t leaves = remove_equal_children(model, !options.depth);
  if (leaves == 0) return;
  model.report.notes.push_back(
      std::to_string(leaves) +
      (leaves == 1 ? " node stays a leaf, because its parts would be as large as it is"
                   : " nodes stay leaves, because their parts would be as large as they are") +
      (model.tree.node_count() == 1 ? "; a given depth keeps the parts for bodies that deform" : ""));
}

// Wraps regions, so that no method returns a tree without cover.
void wrap(const MeshView& mesh, CoveredTree& model, Workers& workers) {
  const LevelGrowth growth = wrap_regions(mesh, model, workers);
  if (growth.grown == 0) return;
  BuildReport& report = model.report;
  report.notes.push_back(std::to_string(growth.grown) + " spheres grew by up to " +
                         short_number(growth.largest_growth) + ", for the rounding of coordinates");
  if (report.protrusion_bound) *report.protrusion_bound += growth.largest_growth;
}

}  // namespace

std::string_view name(Method method) {
  return entry(method).name;
}

std::optional<Method> method_from_name(std::string_view wanted) {
  for (const Entry& e : entries)
    if (e.name == wanted) return e.method;
  return std::nullopt;
}

std::span<const Method> all_methods() {
  return methods;
}

std::string_view name(Reduction reduction) {
  return reduction_names.name(reduction, "reducer");
}
std::optional<Reduction> reduction_from_name(std::string_view wanted) {
  return reduction_names.find(wanted);
}
std::span<const Reduction> all_reductions() {
  return reduction_names.values;
}

std::string_view name(Optimizer optimizer) {
  return optimizer_names.name(optimizer, "optimizer");
}
std::optional<Optimizer> optimizer_from_name(std::string_view wanted) {
  return optimizer_names.find(wanted);
}
std::span<const Optimizer> all_optimizers() {
  return optimizer_names.values;
}

std::string_view name(Quality quality) {
  return quality_names.name(quality, "quality");
}
std::optional<Quality> quality_from_name(std::string_view wanted) {
  return quality_names.find(wanted);
}
std::span<const Quality> all_qualities() {
  return quality_names.values;
}

CoveredTree build(const MeshView& mesh, const BuildOptions& options, WorkersOrAll given) {
  Workers& workers = given;
  const StandardFloats standard;
  const Entry& chosen = entry(options.method);
  if (options.branching < 2 || options.branching > max_branching)
    throw std::invalid_argument("build: branching " + std::to_string(options.branching) + " is not in 2…64");
  if (options.depth && (*options.depth < 0 || *options.depth > max_depth))
    throw std::invalid_argument("build: depth " + std::to_string(*options.depth) + " is not in 0…8");
  require_used(options);
  require_numbers(options);
  require_usable(mesh);
  require_usable_scale(mesh);
  const BuildRun run(options, mesh);
  run.throw_if_stopped();
  // mutant stop-between-nodes: `const StopChecks stop_checks(run)` -> ``
  const StopChecks stop_checks(run);
  CoveredTree model = chosen.build(mesh, run, workers);
  remove_useless_divisions(options, model);
  model.cover = with_fewer_cuts(mesh, model, workers);
  model.report.most_patches_of_a_facet = model.cover.most_patches_of_a_facet();
  wrap(mesh, model, workers);
  if (options.nested) make_nested(model.tree);
  return model;
}

}  // namespace morula
