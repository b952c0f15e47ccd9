// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula sample: a generated mesh, or modes and bones that move it, for trying things out.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/modal_file.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/update/sample_motions.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct SampleArguments {
  std::string name;
  std::string output;
  int resolution = 48;
  std::uint64_t modes = 4;
  std::uint64_t frames = 25;
  bool modes_given = false, frames_given = false;
  unsigned threads = 0;
  bool json = false;
};

std::vector<std::string> body_names() {
  return {sample_body_names().begin(), sample_body_names().end()};
}

// The names of arrays that move a body; they follow its name and a dash.
std::vector<std::string> array_names() {
  return {"modes", "coords", "weights", "bones"};
}

int write_array(const SampleArguments& o, const std::string& body, const std::string& array) {
  check_name("sample array", array, array_names());
  if (extension(o.output) != ".npy") throw UsageError(o.output + ": arrays are written as .npy");
  require_output_place(o.output);
  const bool has_modes = array == "modes" || array == "coords", has_frames = array == "coords" || array == "bones";
  if (o.modes_given && !has_modes) throw UsageError("--modes: " + o.name + " has none");
  if (o.frames_given && !has_frames) throw UsageError("--frames: " + o.name + " has none");
  const Mesh mesh = sample_body(body, o.resolution);
  std::vector<std::uint64_t> shape;
  if (array == "modes") {
    write_modes(o.output, sample_modes(mesh.positions, o.modes));
    shape = {o.modes, mesh.vertex_count(), 3};
  } else if (array == "coords") {
    write_coordinates(o.output, {o.modes, sample_coordinates(o.modes, o.frames)});
    shape = {o.frames, o.modes};
  } else if (array == "weights") {
    const Skin skin = sample_skin(mesh.positions);
    write_skin(o.output, skin);
    shape = {mesh.vertex_count(), skin.bone_count};
  } else {
    constexpr std::size_t bone_count = 2;
    write_bone_frames(o.output, {bone_count, sample_bones(mesh.positions, o.frames)});
    shape = {o.frames, bone_count, 3, 4};
  }
  note_written(o.output);
  if (o.json)
    print_json({{"body", body}, {"array", array}, {"file", o.output}, {"resolution", o.resolution}, {"shape", shape}});
  else
    fmt::print("{}: {} of {}, {}\n", o.output, array, body, fmt::join(shape, " × "));
  return exit_done;
}

int sample_command(const SampleArguments& o) {
  const std::size_t dash = o.name.find('-');
  const std::string body = o.name.substr(0, dash);
  check_name("body", body, body_names());
  require_not_input(o.output, {});
  if (dash != std::string::npos) return write_array(o, body, o.name.substr(dash + 1));
  if (o.modes_given) throw UsageError("--modes: a mesh has none; did you mean " + body + "-modes?");
  if (o.frames_given) throw UsageError("--frames: a mesh has none; did you mean " + body + "-bones?");
  require_mesh_output(o.output);
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
  auto o = std::make_shared<SampleArguments>();
  CLI::App* command = add_command(app, "sample", "Generate a sample mesh, or arrays that move it");
  add_option(*command, "NAME", o->name,
             fmt::format("{}; or arrays for one, with -{} after its name", fmt::join(body_names(), ", "),
                         fmt::join(array_names(), ", -")))
      ->required()
      ->type_name("");
  add_option(*command, "-o,--output", o->output, "Mesh file: " + writable_mesh_list() + "; of an array: .npy")
      ->type_name("FILE")
      ->required();
  add_option(*command, "--resolution", o->resolution, "Edges around or along the body, 3 to 4096")
      ->type_name("N")
      ->transform(whole_number(3, 4096))
      ->capture_default_str();
  CLI::Option* const modes = add_option(*command, "--modes", o->modes, "Number of bending modes")
                                 ->type_name("N")
                                 ->transform(whole_number(1, 1000));
  CLI::Option* const frames = add_option(*command, "--frames", o->frames, "Number of frames of -coords and -bones")
                                  ->type_name("N")
                                  ->transform(whole_number(1, 1000000));
  modes->capture_default_str();
  frames->capture_default_str();
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Example:\n  morula sample limb -o limb.obj\n  morula sample limb-modes -o modes.npy\n"
             "  morula sample limb-coords -o coords.npy");
  on_use(*command, [o, modes, frames, &run] {
    o->modes_given = modes->count() > 0;
    o->frames_given = frames->count() > 0;
    run = [o] { return sample_command(*o); };
  });
}

}  // namespace morula::cli
