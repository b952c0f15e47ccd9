// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula demo: what the library does, shown on two bodies in about a minute.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <scenes/scenes.hpp>

#include "demo/run.hpp"
#include "demo/text.hpp"
#include "demo/touch.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"

namespace morula::cli {
namespace {

struct Options {
  std::string output = "morula-demo";
  bool quick = false;
  unsigned threads = 0;
  bool json = false;
};

/// A scanned or modelled mesh with an inside, when the corpus is unpacked.
std::optional<NamedMesh> real_body() {
  const std::optional<std::filesystem::path> corpus = scenes::corpus_folder();
  if (!corpus) return std::nullopt;
  for (const char* file : {"bunny00.off", "elephant.off"}) {
    const std::filesystem::path path = *corpus / file;
    if (!std::filesystem::is_regular_file(path)) continue;
    NamedMesh body{path.stem().string(), read_mesh(path)};
    if (inspect(body.mesh).has_volume()) return body;
  }
  return std::nullopt;
}

DemoPlan make_plan(bool quick) {
  DemoPlan plan;
  plan.bodies.push_back({"limb", sample_body("limb", quick ? 12 : 48)});
  if (quick) {
    plan.frame_count = 9;
    plan.repeats = 3;
    plan.resolution = 96;
  } else if (std::optional<NamedMesh> body = real_body()) {
    plan.bodies.push_back(std::move(*body));
  }
  plan.motions = paper_motions();
  return plan;
}

/// The commands that give one cell of the table again.
std::string recipe(const DemoPlan& plan, const DemoTree& tree, const DemoCell& cell, const std::string& folder) {
  const std::string stem = (std::filesystem::path(folder) / tree.body).string();
  return fmt::format(
      "  morula deform {0}.obj -o motion.npy --{1} --frames {2}\n"
      "  morula update {0}.obj {0}-{3}.morula motion.npy -o spheres --rule {4}\n"
      "  morula measure {0}.obj spheres --motion motion.npy --grid fixed --resolution {5} --no-protrusion\n",
      stem, cell.motion, plan.frame_count, name(tree.method), name(cell.rule), plan.resolution);
}

/// Two limbs with the tree that the first experiment built.
DemoTouch let_limbs_touch(const DemoPlan& plan, const std::vector<DemoTree>& trees,
                          const std::filesystem::path& folder) {
  const auto tree = std::find_if(trees.begin(), trees.end(), [&](const DemoTree& t) {
    return t.body == plan.bodies.front().name && t.method == Method::morula;
  });
  return run_touch(plan.bodies.front().mesh, tree->built, plan.repeats, folder);
}

void print_text(const DemoPlan& plan, const std::vector<DemoTree>& trees, const DemoTouch& touch,
                const std::string& folder, double elapsed) {
  fmt::print(
      "Looseness of the leaves, in object volumes (share of the surface left bare): worst of the frames at rest,\n"
      "half way, at the full amount and back at rest; {} frames out and back. Times: median frame, one thread.\n\n{}\n",
      plan.frame_count, demo_table(trees));
  for (const DemoTree& tree : trees) {
    fmt::print("{} {}: {}, {}; {} ({}) built in {}\n", tree.body, name(tree.method),
               counted(tree.vertices, "vertex", "vertices"), counted(tree.facets, "facet"),
               counted(tree.spheres, "sphere"), counted(tree.leaves, "leaf", "leaves"), seconds(tree.build_seconds));
  }
  for (const DemoTree& tree : trees) {
    if (tree.method != trees.front().method) continue;
    for (const std::string& reason : tree.skipped) fmt::print("{}\n", reason);
  }
  fmt::print("\nWhat it shows\n");
  for (const std::string& finding : demo_findings(trees)) fmt::print("- {}\n", finding);
  fmt::print(
      "\nContacts of two limbs that deform and touch, under budgets in pair tests: mean per frame of {}; error bound "
      "in\n"
      "diagonals; crossings are pairs of facets, by brute force. Times: median, one thread.\n\n{}\n{}\n",
      touch.frame_count, touch_table(touch), touch_finding(touch));
  fmt::print("\nWhat to look at, in {} ({})\n", folder, seconds(elapsed));
  const std::string body = trees.front().body;
  fmt::print("- demo.csv, contacts.csv and demo.json: every figure with all digits\n");
  fmt::print("- {0}-touching-a.obj and {0}-touching-b.obj: the two limbs in the middle of their motion\n", body);
  if (!trees.front().cells.empty()) {
    const std::string stem = file_stem(body, trees.front().cells.front().motion);
    fmt::print("- {0}.obj with {0}-exact.sph and {0}-approach2.sph: the body at the full amount, and its spheres\n",
               stem);
    fmt::print("- any cell again, from files:\n{}", recipe(plan, trees.front(), trees.front().cells.back(), folder));
  }
}

int demo_command(const Options& o) {
  Workers workers = make_workers(o.threads);
  const DemoPlan plan = make_plan(o.quick);
  require_folder_place(o.output);
  WholeFolder stage(o.output);
  Stopwatch watch;
  std::vector<DemoTree> trees;
  DemoTouch touch;
  {
    Progress progress("demo");
    trees = run_demo(plan, stage.path(), workers,
                     [&](double share, std::string label) { progress.update(share, std::move(label)); });
    progress.update(1, "contacts");
    touch = let_limbs_touch(plan, trees, stage.path());
  }
  Json json = demo_json(plan, trees);
  json["contacts"] = touch_json(touch);
  write_whole(stage.path() / "demo.json", json_text(json, 2) + "\n");
  write_whole(stage.path() / "demo.csv", demo_csv(trees));
  write_whole(stage.path() / "contacts.csv", touch_csv(touch));
  stage.commit();
  note_written(o.output);
  if (o.json) {
    print_json(json);
  } else {
    print_text(plan, trees, touch, o.output, watch.lap());
  }
  std::vector<std::string> faults = demo_faults(trees);
  for (std::string& fault : touch_faults(touch)) faults.push_back(std::move(fault));
  for (const std::string& fault : faults) say("morula: error: {}: please report it\n", fault);
  return faults.empty() ? exit_done : exit_check_failed;
}

}  // namespace

void add_demo(CLI::App& app, Run& run) {
  auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("demo", "Show what every rule does to a tree while its body deforms");
  command->add_option("-o,--output", o->output, "Folder for figures, trees, meshes and spheres")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->add_flag("--quick", o->quick, "One small body and few frames: seconds instead of about a minute");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  command->footer("Example:\n  morula demo -o morula-demo");
  command->callback([o, &run] { run = [o] { return demo_command(*o); }; });
}

}  // namespace morula::cli
