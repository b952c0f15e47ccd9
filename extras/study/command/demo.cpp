// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula demo: what the library does, shown on two bodies in about a minute.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/study/study.hpp>
#include <morula/update/body.hpp>
#include <scenes/scenes.hpp>
#include <stdexcept>

#include "demo_text.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

struct DemoArguments {
  std::string output = "morula-demo";
  bool quick = false;
  unsigned threads = 0;
  bool json = false;
};

/// A scanned or modeled mesh with an inside, when the corpus is unpacked.
std::optional<study::NamedMesh> real_body() {
  const std::optional<std::filesystem::path> corpus = scenes::corpus_folder();
  if (!corpus) return std::nullopt;
  for (const char* file : {"bunny00.off", "elephant.off"}) {
    const std::filesystem::path path = *corpus / file;
    if (!std::filesystem::is_regular_file(path)) continue;
    study::NamedMesh body{path.stem().string(), load_mesh(path)};
    if (inspect(body.mesh).has_volume()) return body;
  }
  return std::nullopt;
}

/// A study of the loosest generator and the tightest, there and back, seen at the leaves.
study::Plan make_plan(bool quick) {
  study::Plan plan;
  plan.bodies.push_back({"limb", sample_body("limb", quick ? 12 : 48)});
  if (quick) {
    plan.samples = 9;
    plan.resolution = 96;
  } else {
    plan.samples = 25;
    if (std::optional<study::NamedMesh> body = real_body()) plan.bodies.push_back(std::move(*body));
  }
  plan.sources = study::sources_of(plan.bodies, {Method::octree, Method::optimized});
  plan.motions = study::paper_motions();
  // On leaves `wrapped` would be `exact` once more.
  plan.rules = {Rule::traditional, Rule::weighted, Rule::approach1, Rule::approach2, Rule::exact};
  plan.and_back = true;
  const std::size_t last = plan.samples - 1;
  plan.measured = {0, last / 4, last / 2, last};  // rest, half way, the full amount, back at rest
  plan.of_levels = {static_cast<std::size_t>(plan.depth)};
  plan.measures = {.paper_grid = false, .protrusion = false, .certificate = true, .timed_updates = quick ? 3 : 5};
  plan.needle_sides = 0;
  plan.keep_trees = true;
  return plan;
}

/// "limb-twist-180": a file name from the words of a motion.
std::string file_stem(const std::string& body, const Deformations& motion) {
  std::string stem = body + '-' + study::describe_all(motion);
  std::replace(stem.begin(), stem.end(), ' ', '-');
  return stem;
}

/// Meshes and trees at rest; at the full amount of every motion the mesh, and the spheres of Morula's tree by every
/// rule.
void write_bodies(const Demo& demo, const std::filesystem::path& folder) {
  const study::Plan& plan = demo.plan;
  for (const study::NamedMesh& body : plan.bodies) write_mesh(folder / (body.name + ".obj"), body.mesh);
  for (const study::TreeFigures& tree : demo.result.trees) {
    const auto& [body, mesh] = demo.body(tree);
    const CoveredTree& model = demo.result.model[tree.source];
    write_tree(folder / fmt::format("{}-{}.morula", body, demo.method(tree)), model);
    if (plan.sources[tree.source].generator != Method::optimized) continue;
    for (std::size_t m = 0; m < plan.motions.size(); ++m) {
      if (demo.result.find({tree.source, m, 0}) == nullptr) continue;  // it cannot make this one
      const std::string stem = file_stem(body, plan.motions[m]);
      const std::vector<Vec3> positions = deform(mesh, plan.motions[m], 1.0);
      write_mesh(folder / (stem + ".obj"), {positions, mesh.facets});
      for (const study::FollowRule& rule : plan.rules) {
        Body moved(mesh, model, rule.options);
        if (!moved.update(positions)) throw std::logic_error("the demo's own motion was rejected by update");
        write_tree(folder / fmt::format("{}-{}.sph", stem, rule.name), moved.current_tree());
      }
    }
  }
}

/// Both limbs of the middle frame, where they are in the world.
study::Touch let_limbs_touch(const Demo& demo, const std::filesystem::path& folder) {
  const auto& [name, mesh] = demo.plan.bodies.front();
  study::TouchPlan plan = study::TouchPlan::crossed_arms(mesh);
  plan.timed_queries = demo.plan.measures.timed_updates;
  study::Touch touch =
      study::run_touch(plan, mesh, demo.result.model[demo.plan.find_source(0, Method::optimized).value()]);
  write_mesh(folder / (name + "-touching-a.obj"), {touch.middle_a, mesh.facets});
  write_mesh(folder / (name + "-touching-b.obj"), {touch.middle_b, mesh.facets});
  return touch;
}

/// The commands that give one cell of the table again.
std::string recipe(const study::Plan& plan, const study::MotionRun& cell, const std::string& folder) {
  const std::string stem = (std::filesystem::path(folder) / plan.body_of(cell.key.source).name).string();
  return fmt::format(
      "  morula deform {0}.obj -o motion.npy --{1} --frames {2}\n"
      "  morula update {0}.obj {0}-{3}.morula motion.npy -o spheres --rule {4}\n"
      "  morula measure {0}.obj spheres --motion motion.npy --grid fixed --resolution {5} --no-protrusion\n",
      stem, study::describe_all(plan.motions[cell.key.motion]), plan.samples, plan.sources[cell.key.source].method,
      plan.rules[cell.key.rule].name, plan.resolution);
}

void print_text(const Demo& demo, const study::Touch& touch, const std::string& folder, double elapsed) {
  const std::vector<study::TreeFigures>& trees = demo.result.trees;
  fmt::print(
      "Looseness of the leaves, in object volumes (share of the surface left uncovered): worst of the frames at rest,\n"
      "half way, at the full amount and back at rest; {} frames out and back. Times: median frame, one thread.\n\n{}\n",
      demo.plan.samples, demo_table(demo));
  for (const study::TreeFigures& tree : trees) {
    const Mesh& mesh = demo.body(tree).mesh;
    const SphereTree& spheres = demo.result.model[tree.source].tree;
    fmt::print("{} {}: {}, {}; {} ({}) built in {}\n", demo.body(tree).name, demo.method(tree),
               counted(mesh.vertex_count(), "vertex", "vertices"), counted(mesh.facet_count(), "facet"),
               counted(spheres.node_count(), "sphere"), counted(spheres.leaf_count(), "leaf", "leaves"),
               seconds(tree.build_seconds));
  }
  for (const study::Skipped& skipped : demo.result.skipped) fmt::print("{}\n", skipped.reason);
  fmt::print("\nWhat it shows\n");
  for (const std::string& finding : demo_findings(demo)) fmt::print("{}", wrapped("- " + finding));
  fmt::print(
      "\nContacts of two limbs that deform and touch, under budgets in pair tests: mean per frame of {}; error bound "
      "in\n"
      "diagonals; crossings are pairs of facets, by brute force. Times: median, one thread.\n\n{}\n{}",
      touch.crossings.size(), touch_table(touch), wrapped(touch_finding(touch)));
  fmt::print("\nFiles to look at, in {} ({})\n", folder, seconds(elapsed));
  const std::string body = demo.body(trees.front()).name;
  fmt::print("- demo.csv, contacts.csv and demo.json: every figure with all digits\n");
  fmt::print("- {0}-touching-a.obj and {0}-touching-b.obj: the two limbs in the middle of their motion\n", body);
  const std::vector<const study::MotionRun*> cells = demo.cells(trees.front());
  if (!cells.empty()) {
    const std::string stem = file_stem(body, demo.plan.motions[cells.front()->key.motion]);
    fmt::print("- {0}.obj with {0}-exact.sph and {0}-approach2.sph: the body at the full amount, and its spheres\n",
               stem);
    fmt::print("- any cell again, from files:\n{}", recipe(demo.plan, *cells.back(), folder));
  }
}

int demo_command(const DemoArguments& o) {
  require_folder_place(o.output);
  Workers workers = make_workers(o.threads);
  Demo demo{make_plan(o.quick), {}};
  WholeFolder stage(o.output);
  toolbox::Stopwatch watch;
  study::Touch touch;
  {
    Progress progress("demo");
    study::RunOptions options;
    options.progress = [&](double share, std::string what) { progress.update(share, std::move(what)); };
    demo.result = study::run(demo.plan, workers, options);
    write_bodies(demo, stage.path());
    progress.update(1, "contacts");
    touch = let_limbs_touch(demo, stage.path());
  }
  Json json = demo_json(demo);
  json["contacts"] = touch_json(touch);
  write_whole(stage.path() / "demo.json", json_text(json, 2) + "\n");
  write_whole(stage.path() / "demo.csv", demo_csv(demo));
  write_whole(stage.path() / "contacts.csv", touch_csv(touch));
  stage.commit();
  note_written(o.output);
  if (o.json) {
    print_json(json);
  } else {
    print_text(demo, touch, o.output, watch.lap());
  }
  std::vector<std::string> faults = study::faults(demo.plan, demo.result);
  for (std::string& fault : touch_faults(touch)) faults.push_back(std::move(fault));
  for (const std::string& fault : faults) complain(exit_check_failed, "{}: please report it", fault);
  return faults.empty() ? exit_done : exit_check_failed;
}

}  // namespace

void add_demo(CLI::App& app, Run& run) {
  auto o = std::make_shared<DemoArguments>();
  CLI::App* command = add_command(app, "demo", "Show what every rule does to a tree while its body deforms");
  add_option(*command, "-o,--output", o->output, "Folder for figures, trees, meshes and spheres")
      ->type_name("FOLDER")
      ->capture_default_str();
  add_flag(*command, "--quick", o->quick, "One small body and few frames: seconds instead of about a minute");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command, "Example:\n  morula demo -o morula-demo");
  on_use(*command, [o, &run] { run = [o] { return demo_command(*o); }; });
}

}  // namespace morula::cli
