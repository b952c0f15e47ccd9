// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula sample: a mesh made by formula, for trying things out.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/mesh_file.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct Options {
  std::string name;
  std::string output;
  int resolution = 48;
  unsigned threads = 0;
  bool json = false;
};

std::vector<std::string> body_names() {
  return {sample_body_names().begin(), sample_body_names().end()};
}

int sample_command(const Options& o) {
  check_name("body", o.name, body_names());
  require_mesh_output(o.output);
  require_not_input(o.output, {});
  const Mesh mesh = sample_body(o.name, o.resolution);
  write_mesh(o.output, mesh);
  note_written(o.output);
  if (o.json) {
    print_json({{"body", o.name},
                {"mesh", o.output},
                {"resolution", o.resolution},
                {"vertices", mesh.vertex_count()},
                {"facets", mesh.facet_count()},
                {"mesh_hash", hash_text(mesh_hash(mesh))}});
  } else {
    fmt::print("{}\n", mesh_line(o.output, mesh));
  }
  return exit_done;
}

}  // namespace

void add_sample(CLI::App& app, Run& run) {
  auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("sample", "Write a sample mesh made by formula");
  command->add_option("NAME", o->name, fmt::format("{}", fmt::join(body_names(), ", ")))->required()->type_name("");
  command->add_option("-o,--output", o->output, "Mesh file: " + writable_mesh_list())->type_name("MESH")->required();
  command->add_option("--resolution", o->resolution, "Edges around or along the body, 3 to 4096")
      ->type_name("N")
      ->transform(whole_number(3, 4096))
      ->capture_default_str();
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  command->footer("Example:\n  morula sample limb -o limb.obj");
  command->callback([o, &run] { run = [o] { return sample_command(*o); }; });
}

}  // namespace morula::cli
