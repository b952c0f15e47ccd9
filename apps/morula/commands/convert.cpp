// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula convert: meshes to meshes, trees to trees.
#include <fmt/format.h>

#include <memory>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct Options {
  std::string input;
  std::string output;
  std::string mesh;
  std::string sph_origin = "none";
  unsigned threads = 0;
  bool json = false;
};

/// What was written; `growth` of a cover that had to be made.
int report(const Options& o, const std::string& line, const BuildReport* growth) {
  note_written(o.output);
  if (o.json) {
    Json json{{"input", o.input}, {"output", o.output}};
    if (growth != nullptr) json["growth"] = growth_json(*growth);
    print_json(json);
    return exit_done;
  }
  fmt::print("{}\n", line);
  if (growth != nullptr) fmt::print("{}", growth_text(*growth));
  return exit_done;
}

int convert_mesh(const Options& o) {
  require_mesh_output(o.output);
  const Mesh mesh = read_mesh(o.input);
  write_mesh(o.output, mesh);
  return report(o, mesh_line(o.output, mesh), nullptr);
}

int convert_tree(const Options& o) {
  require_tree_output(o.output);
  std::optional<Mesh> mesh;
  if (!o.mesh.empty()) mesh = read_mesh(o.mesh);
  const ReadTreeOptions reading = parse_sph_origin(o.sph_origin, mesh ? &*mesh : nullptr);
  TreeFile file = read_tree(o.input, reading);
  if (extension(o.output) != ".morula") {
    write_tree(o.output, file.tree);
    if (file.cover) say("morula: note: the cover stays behind: only .morula files hold it\n");
    return report(o,
                  fmt::format("{}: {}, {}", o.output, counted(file.tree.node_count(), "sphere"),
                              counted(file.tree.level_count(), "level")),
                  nullptr);
  }
  if (file.cover && !mesh) {
    write_tree(o.output, CoveredTree{std::move(file.tree), std::move(*file.cover), std::move(file.report)});
    return report(o, fmt::format("{}: copied with its cover", o.output), nullptr);
  }
  if (!mesh) {
    throw UsageError(fmt::format(
        "{} has spheres alone, and a .morula file proves that they cover a mesh: add --mesh MESH", o.input));
  }
  Workers workers = make_workers(o.threads);
  const CoveredTree built = read_covered_tree(o.input, *mesh, reading, workers);
  write_tree(o.output, built);
  return report(o,
                fmt::format("{}: {}, {}", o.output, counted(built.tree.node_count(), "sphere"),
                            counted(built.cover.patch_count(), "patch", "patches")),
                file.cover ? nullptr : &built.report);
}

int convert_command(const Options& o) {
  require_not_input(o.output, {o.input, o.mesh});
  switch (file_kind(o.input)) {
    case FileKind::mesh:
      if (file_kind(o.output) == FileKind::tree) {
        throw UsageError(fmt::format("{} is a mesh and {} a tree: morula build makes trees", o.input, o.output));
      }
      return convert_mesh(o);
    case FileKind::tree:
      return convert_tree(o);
    default:
      throw UsageError(
          fmt::format("{}: neither a mesh ({}) nor a tree (.morula .sph .json)", o.input, readable_mesh_extensions()));
  }
}

}  // namespace

void add_convert(CLI::App& app, Run& run) {
  auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("convert", "Convert between mesh formats, or between tree formats");
  command->add_option("IN", o->input, "Mesh or tree file")->required()->type_name("");
  command->add_option("OUT", o->output, "Mesh (" + writable_mesh_list() + ") or tree (.morula .sph .json) file")
      ->required()
      ->type_name("");
  command
      ->add_option("--mesh", o->mesh, "The mesh of a tree: needed to give bare spheres a cover, that is, for .morula")
      ->type_name("MESH");
  add_sph_origin(*command, o->sph_origin);
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  command->footer(
      "Example:\n"
      "  morula convert bunny.off bunny.obj\n"
      "  morula convert bunny.sph bunny.morula --mesh bunny.obj --sph-origin bbox-center");
  command->callback([o, &run] { run = [o] { return convert_command(*o); }; });
}

}  // namespace morula::cli
