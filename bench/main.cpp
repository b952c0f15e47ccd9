// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula_bench: times scenarios by name and verifies, in the same run, what they compute.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "baseline.hpp"
#include "input.hpp"
#include "report.hpp"

namespace morula::bench {
namespace {

constexpr int exit_wrong_result = 1;
constexpr int exit_bad_use = 2;

struct NamedScenario {
  const char* name;
  Run run;
};
constexpr std::array<NamedScenario, 25> scenarios{{
    {"build", run_build},
    {"update", run_update},
    {"modal", run_modal},
    {"skinned", run_skinned},
    {"skinned-pick", run_skinned_pick},
    {"rebuild", run_rebuild},
    {"measure", run_measure},
    {"query", run_query},
    {"collide", run_collide},
    {"volumes", run_volumes},
    {"patches", run_patches},
    {"pressed", run_pressed},
    {"distance", run_distance},
    {"haptic", run_haptic},
    {"peers", run_peers},
    {"crossings", run_crossings},
    {"self", run_self},
    {"proximity", run_proximity},
    {"layers", run_layers},
    {"swept", run_swept},
    {"filters", run_filters},
    {"scene", run_scene},
    {"scene-patches", run_scene_patches},
    {"scene-queries", run_scene_queries},
    {"skin-bounds", run_skin_bounds},
}};

int run(int argc, char** argv) {
  CLI::App app{"Times scenarios and verifies their results in the same run.", "morula_bench"};
  std::vector<std::string> wanted, meshes;
  std::vector<std::string> names;
  for (const NamedScenario& scenario : scenarios) names.emplace_back(scenario.name);
  int repeats = 5;
  double patience = 10;
  std::size_t questions = 20000;
  unsigned threads = 1;
  bool json = false;
  std::vector<std::string> methods, method_names;
  for (const Method method : all_methods()) method_names.emplace_back(name(method));
  std::uint64_t seeds = 1;
  std::string baseline_file;
  bool scaling = false;
  app.add_option("--scenario", wanted,
                 "build, update, modal, skinned, skinned-pick, skin-bounds, rebuild, measure, query, volumes, collide, "
                 "patches, "
                 "pressed, crossings, self, proximity, layers, swept, filters, scene, scene-patches, scene-queries, "
                 "distance, haptic, peers; may be repeated "
                 "(default: all)")
      ->check(CLI::IsMember(names));
  app.add_option("--mesh", meshes,
                 "a file, a sample body as NAME or NAME:RESOLUTION, or a flat sheet:RESOLUTION; may be repeated\n"
                 "(default: limb, blob, and bunny00 where the corpus is)");
  app.add_option("--repeats", repeats, "how often each item is timed (default 5)")->check(CLI::Range(1, 100000));
  app.add_option("--patience", patience,
                 "seconds after which an item gets no further repeat; two it always gets (default 10)")
      ->check(CLI::NonNegativeNumber);
  app.add_option(
         "--questions", questions,
         "points that `query` asks about, poses that `collide` tries (default 20000); `distance` asks a hundredth "
         "of it, at most 200 poses")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100000000}));
  app.add_option("--threads", threads, "0: one per processor (default 1)")->check(CLI::Range(0u, 1024u));
  app.add_option("--method", methods,
                 "which generators `build` runs; may be repeated (default: all)\n"
                 "given once, also what makes the tree of other scenarios (default: optimized)")
      ->check(CLI::IsMember(method_names));
  std::string depth = "3";
  app.add_option("--depth", depth, "levels below the root of the trees, or `auto`: a depth that fits the facets")
      ->check(CLI::IsMember({"0", "1", "2", "3", "4", "5", "6", "7", "8", "auto"}))
      ->capture_default_str();
  app.add_option("--seeds", seeds, "trees of so many seeds in `build`, for the spread of looseness (default 1)")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000}));
  app.add_option("--baseline", baseline_file,
                 "CSV with the columns mesh,method,level,looseness; `build` divides its looseness by it");
  app.add_flag("--scaling", scaling, "`build` on bodies of 10 thousand to a million facets, instead of meshes");
  std::size_t load_frames = 0, growth = 0;
  constexpr std::size_t load_bodies = 1000;
  app.add_option("--load", load_frames, "a thousand small bodies for so many frames, instead of meshes")
      ->check(CLI::Range(std::size_t{20}, std::size_t{10000000}));
  app.add_option("--growth", growth,
                 "everything on bodies of 10 thousand, 100 thousand … up to so many facets, instead of meshes")
      ->check(CLI::Range(std::size_t{10000}, std::size_t{20000000}));
#ifdef MORULA_BENCH_ROBOT
  std::size_t planning = 0;
  app.add_option("--planning", planning, "collision checks of so many configurations of an arm, instead of meshes")
      ->check(CLI::Range(std::size_t{10}, std::size_t{10000000}));
#else
  constexpr std::size_t planning = 0;
#endif
  app.add_flag("--json", json, "one JSON object instead of text");
  app.footer(
      "Example:\n  morula_bench --scenario update --mesh limb:96 --threads 2\n\n"
      "Exit codes: 0 all results verified, 1 a result is wrong, 2 bad use or bad input.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_bad_use;
  }

  std::optional<Baseline> baseline;
  if (!baseline_file.empty()) baseline.emplace(baseline_file);
  const std::vector<Input> found =
      scaling || load_frames > 0 || growth > 0 || planning > 0 ? std::vector<Input>{} : inputs(meshes);
  Workers workers(threads);
  Settings settings{.repeats = repeats, .patience = patience, .questions = questions, .workers = &workers};
  settings.seeds = seeds;
  settings.depth = depth == "auto" ? std::nullopt : std::optional(std::stoi(depth));
  settings.baseline = baseline ? &*baseline : nullptr;
  for (const std::string& method : methods) settings.methods.push_back(*method_from_name(method));
  if (methods.empty()) settings.methods.assign(all_methods().begin(), all_methods().end());
  std::vector<Result> results;
  std::size_t wrong = 0;
  for (const Input& input : found) {
    if (!json)
      fmt::print("{}: {} vertices, {} facets; threads: {}\n", input.name, input.mesh.vertex_count(),
                 input.mesh.facet_count(), workers.thread_count());
    for (const NamedScenario& scenario : scenarios) {
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), scenario.name) == wanted.end()) continue;
      for (Result& result : scenario.run(input, settings)) {
        if (!json) print(result);
        wrong += !result.faults.empty();
        results.push_back(std::move(result));
      }
      std::fflush(stdout);
    }
  }
  const auto take = [&](std::vector<Result> more) {
    for (Result& result : more) {
      if (!json) print(result);
      wrong += !result.faults.empty();
      results.push_back(std::move(result));
    }
  };
  if (scaling) take(run_build_scaling(settings));
  if (load_frames > 0) take(run_load(load_bodies, load_frames, settings));
  if (growth > 0) take(run_growth(growth, settings));
#ifdef MORULA_BENCH_ROBOT
  if (planning > 0) take(run_planning(planning, settings));
#endif
  const std::vector<SummaryRow> summary = build_summary(results);
  if (!json) print(summary);
  if (json)
    fmt::print("{}\n", to_json(found, results, summary, settings));
  else if (wrong == 0)
    fmt::print("{} results, all verified\n", results.size());
  else
    fmt::print("{} results, {} of them WRONG\n", results.size(), wrong);
  return wrong == 0 ? 0 : exit_wrong_result;
}

}  // namespace
}  // namespace morula::bench

int main(int argc, char** argv) {
  try {
    return morula::bench::run(argc, argv);
  } catch (const std::exception& error) {
    // Files that cannot be read and bodies that do not exist; everything else would be a fault of ours, and says so.
    fmt::print(stderr, "morula_bench: {}\n", error.what());
    return morula::bench::exit_bad_use;
  }
}
