// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula build: a mesh to a tree that covers it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <morula/build/build.hpp>
#include <morula/io/tree_file.hpp>

#include "command.hpp"
#include "figures.hpp"
#include "files.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace morula::cli {
namespace {

struct Options {
  std::string mesh;
  std::string output;
  std::string method{name(BuildOptions{}.method)};
  int branching = BuildOptions{}.branching;
  int depth = BuildOptions{}.depth;
  std::uint64_t seed = BuildOptions{}.seed;
  std::string reducers;
  std::string optimiser{name(BuildOptions{}.optimiser)};
  double balance_excess = BuildOptions{}.balance_excess;
  unsigned threads = 0;
  bool json = false;
};

int build_command(const Options& o) {
  BuildOptions options{.method = parse_method(o.method),
                       .branching = o.branching,
                       .depth = o.depth,
                       .seed = o.seed,
                       .reducers = parse_reducers(o.reducers),
                       .optimiser = parse_optimiser(o.optimiser),
                       .balance_excess = o.balance_excess,
                       .progress = {}};
  require_tree_output(o.output);
  Workers workers(o.threads);

  Stopwatch watch;
  const Mesh mesh = read_mesh(o.mesh);
  const double read_seconds = watch.lap();
  const Built built = [&] {
    Progress progress(fmt::format("building {}", o.method));
    options.progress = [&](const BuildProgress& p) { progress.update(p.share); };
    return build(mesh, options, workers);
  }();
  const double build_seconds = watch.lap();
  const Certificate certificate = certify(built.cover, mesh.positions, built.tree.spheres, workers);
  const double check_seconds = watch.lap();
  if (!certificate.covered) {
    fmt::print(stderr,
               "morula: error: the tree does not cover {}: node {} lacks {}; nothing was written, please report it\n",
               o.mesh, certificate.worst_node, figure(certificate.worst_excess));
    return exit_check_failed;
  }
  write_tree(o.output, built);
  const double write_seconds = watch.lap();

  if (o.json) {
    print_json(
        {{"mesh", o.mesh},
         {"vertices", mesh.vertex_count()},
         {"facets", mesh.facet_count()},
         {"mesh_hash", hash_text(built.report.mesh_hash)},
         {"tree", o.output},
         {"method", built.report.method},
         {"branching", built.report.branching},
         {"depth", built.report.depth},
         {"seed", built.report.seed},
         {"tree_hash", hash_text(tree_hash(built.tree))},
         {"levels", level_json(built.tree)},
         {"early_leaves", built.report.early_leaves},
         {"leftover_patches", built.report.leftover_patches},
         {"notes", built.report.notes},
         {"covered", certificate.covered},
         {"worst_excess", certificate.worst_excess},
         {"threads", workers.thread_count()},
         {"seconds",
          {{"read", read_seconds}, {"build", build_seconds}, {"check", check_seconds}, {"write", write_seconds}}}});
    return exit_done;
  }
  fmt::print("{}\n\n{}\n", mesh_line(o.mesh, mesh), level_table(built.tree));
  fmt::print("early leaves  {}\n", built.report.early_leaves);
  fmt::print("covers        yes: every corner of {} lies in its spheres, at every level\n",
             counted(built.cover.patch_count(), "patch", "patches"));
  fmt::print("seconds       read {}, build {}, check {}, write {} ({})\n", seconds(read_seconds),
             seconds(build_seconds), seconds(check_seconds), seconds(write_seconds),
             counted(workers.thread_count(), "thread"));
  for (const std::string& note : built.report.notes) fmt::print("note          {}\n", note);
  fmt::print("written       {}\n", o.output);
  return exit_done;
}

}  // namespace

void add_build(CLI::App& app, Run& run) {
  auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("build", "Build a sphere tree that covers a mesh at every level");
  command->add_option("MESH", o->mesh, "Mesh file: " + readable_mesh_extensions())->required()->type_name("");
  command->add_option("-o,--output", o->output, "Tree file: .morula (with its cover), .sph or .json")
      ->type_name("TREE")
      ->required();
  command->add_option("--method", o->method, fmt::format("{}", fmt::join(method_names(), ", ")))
      ->type_name("NAME")
      ->capture_default_str();
  command->add_option("--branching", o->branching, "Most children of a node, 2 to 64")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--depth", o->depth, "Levels below the root, 0 to 8")->type_name("N")->capture_default_str();
  command->add_option("--seed", o->seed, "Of every random choice; equal seeds give equal trees")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option(
          "--reducers", o->reducers,
          fmt::format("For medial: of merge,burst,expand; for combined: of {}. The best is taken for each node",
                      fmt::join(reduction_names(), ",")))
      ->type_name("LIST");
  command->add_option("--optimiser", o->optimiser, fmt::format("{}", fmt::join(optimiser_names(), ", ")))
      ->type_name("NAME")
      ->capture_default_str();
  command
      ->add_option("--balance-excess", o->balance_excess,
                   "For the optimiser balance: share by which the worst sphere may stick out further")
      ->type_name("SHARE")
      ->capture_default_str();
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  command->footer("Example:\n  morula build liver.obj -o liver.morula --method grid --branching 8 --depth 3");
  command->callback([o, &run] { run = [o] { return build_command(*o); }; });
}

}  // namespace morula::cli
