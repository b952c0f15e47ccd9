// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula deform: a motion from parametric deformations, composed in the order of the command line.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <morula/deform/deformation.hpp>
#include <morula/io/motion_file.hpp>
#include <set>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

std::string vector_text(const Vec3& v) {
  return fmt::format("{},{},{}", v.x, v.y, v.z);
}

struct DeformArguments {
  std::string mesh;
  std::string output;
  std::vector<double> stretch, twist, bend, noise, rotate;
  int poke = 0;
  double shrink = Stretch{}.shrink;
  std::string poke_center = vector_text(Poke{}.center);
  std::string poke_push = vector_text(Poke{}.push);
  double poke_radius = Poke{}.radius;
  double wavelength = Noise{}.wavelength;
  std::uint64_t seed = Noise{}.seed;
  std::string axis = "auto";
  std::size_t frames = 25;
  bool one_way = false;
  std::string extension = "obj";
  unsigned threads = 0;
  bool json = false;
};

/// In the order given; an option may be given more than once.
Deformations deformations_in_order(const DeformArguments& o, const CLI::App& command) {
  const Axis axis = parse_axis(o.axis);
  const Poke poke{.center = parse_vector("--poke-center", o.poke_center),
                  .push = parse_vector("--poke-push", o.poke_push),
                  .radius = o.poke_radius};
  Deformations list;
  std::map<std::string, std::size_t> taken;
  for (const CLI::Option* option : command.parse_order()) {
    const std::string name = option->get_single_name();
    const std::size_t i = taken[name]++;
    if (name == "stretch") list.emplace_back(Stretch{.factor = o.stretch[i], .shrink = o.shrink, .axis = axis});
    if (name == "twist") list.emplace_back(Twist{.degrees = o.twist[i], .axis = axis});
    if (name == "bend") list.emplace_back(Bend{.degrees = o.bend[i], .axis = axis});
    if (name == "poke") list.emplace_back(poke);
    if (name == "noise") {
      list.emplace_back(Noise{.amplitude = o.noise[i], .wavelength = o.wavelength, .seed = o.seed});
    }
    if (name == "rotate") list.emplace_back(Rotate{.degrees = o.rotate[i], .axis = axis});
  }
  if (list.empty()) {
    throw UsageError("no deformation: give --stretch, --twist, --bend, --poke, --noise or --rotate");
  }
  return list;
}

int deform_command(const DeformArguments& o, const CLI::App& command) {
  const Deformations deformations = deformations_in_order(o, command);
  if (o.frames < 3 && !o.one_way) {
    throw UsageError("--frames 2, out and back, never leaves rest: give 3 or more, or --one-way");
  }
  const std::string own = extension(o.output);
  const bool is_npy = (own == ".npy" || own == ".pc2" || own == ".mdd") && !std::filesystem::is_directory(o.output);
  const FileKind kind = file_kind(o.output);
  if (!is_npy && kind != FileKind::folder && kind != FileKind::unknown) {
    throw UsageError(
        fmt::format("{}: a motion is a folder of meshes or a .npy file (or .pc2, .mdd); name one of these", o.output));
  }
  const std::string ending = "." + o.extension;
  std::vector<std::string> written;
  std::set<std::string> read;
  for (const MeshFileKind& format : mesh_file_kinds()) {
    read.emplace(format.extension);
    // STL frames would lose their vertices.
    if (format.is_written && format.extension != ".stl") written.emplace_back(format.extension.substr(1));
  }
  check_name("format", o.extension, written);
  if (is_npy) {
    require_output_place(o.output);
    require_not_input(o.output, {o.mesh});
  } else {
    require_folder_place(o.output);
    require_frames_not_input(o.output, o.frames, ending, {o.mesh});
    require_no_foreign_files(o.output, o.frames, ending, read);
  }
  const Mesh mesh = load_mesh(o.mesh);
  const std::vector<double> parameters = frame_parameters(o.frames, !o.one_way);
  // The full amount is tried first, so that an impossible deformation is rejected ahead of any output.
  deform(mesh, deformations, *std::max_element(parameters.begin(), parameters.end()));

  {
    MotionWriter writer(o.output, mesh, o.frames, ending);
    Progress progress("deforming");
    for (std::size_t i = 0; i < o.frames; ++i) {
      progress.update(static_cast<double>(i) / static_cast<double>(o.frames));
      writer.write(deform(mesh, deformations, parameters[i]));
    }
    writer.finish();
    note_written(o.output);
  }

  std::vector<std::string> words;
  for (const Deformation& deformation : deformations) words.push_back(describe(deformation));
  if (o.json) {
    print_json({{"mesh", o.mesh},
                {"motion", o.output},
                {"vertices", mesh.vertex_count()},
                {"deformations", words},
                {"frames", o.frames},
                {"parameters", parameters}});
  } else {
    fmt::print("{}\n", mesh_line(o.mesh, mesh));
    fmt::print("{}: {} of {}, {}\n", o.output, counted(o.frames, "frame"), fmt::join(words, ", then "),
               o.one_way ? "out only" : "out and back to rest");
  }
  return exit_done;
}

}  // namespace

void add_deform(CLI::App& app, Run& run) {
  auto o = std::make_shared<DeformArguments>();
  CLI::App* command = add_command(app, "deform", "Make a motion: stretch, twist, bend, poke, shake or turn a mesh");
  add_option(*command, "MESH", o->mesh, "Mesh file: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "-o,--output", o->output, "Folder for 0000.obj, 0001.obj, ... or one .npy, .pc2 or .mdd file")
      ->type_name("MOTION")
      ->required();
  const auto amounts = [&](const char* name, std::vector<double>& values, const char* unit, const char* help) {
    add_option(*command, name, values, help)->type_name(unit)->allow_extra_args(false)->transform(real_number());
  };
  amounts("--stretch", o->stretch, "FACTOR", "Stretch along the axis; the cross-section shrinks to keep the volume");
  amounts("--twist", o->twist, "DEGREES", "Turn one end against the other");
  amounts("--bend", o->bend, "DEGREES", "Roll the axis into an arc");
  command->add_flag("--poke", o->poke, "Push a dent into the top (see --poke-center)");
  amounts("--noise", o->noise, "SHARE", "Smooth random displacement, at most this share of the diagonal");
  amounts("--rotate", o->rotate, "DEGREES", "Turn rigidly");
  add_option(*command, "--axis", o->axis, "Axis of all deformations: x, y, z or auto, the longest side of the box")
      ->type_name("AXIS")
      ->capture_default_str();
  add_option(*command, "--shrink", o->shrink, "Cross-section of --stretch times factor^-SHRINK; 0.5 keeps the volume")
      ->type_name("EXPONENT")
      ->transform(real_number())
      ->capture_default_str();
  add_option(*command, "--poke-center", o->poke_center, "Center of the dent relative to the box, 0 to 1 on each axis")
      ->type_name("X,Y,Z")
      ->capture_default_str();
  add_option(*command, "--poke-push", o->poke_push, "Displacement in diagonals")
      ->type_name("X,Y,Z")
      ->capture_default_str();
  add_option(*command, "--poke-radius", o->poke_radius, "Reach of the dent in diagonals")
      ->type_name("SHARE")
      ->transform(number_above_zero())
      ->capture_default_str();
  add_option(*command, "--noise-wavelength", o->wavelength, "Shortest wave of --noise in diagonals")
      ->type_name("SHARE")
      ->transform(number_above_zero())
      ->capture_default_str();
  add_option(*command, "--seed", o->seed, "Of --noise")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_option(*command, "--frames", o->frames, "Number of frames; with an odd number the middle one has the full amount")
      ->type_name("N")
      ->transform(whole_number(2, 1000000))
      ->capture_default_str();
  add_flag(*command, "--one-way", o->one_way, "End at the full amount instead of going back to rest");
  add_option(*command, "--format", o->extension, "Format of meshes in a folder: obj, off, ply or vtp")
      ->type_name("NAME")
      ->capture_default_str();
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Deformations are applied in the given order, each to the result of the previous one.\n"
             "Example:\n"
             "  morula deform liver.obj -o motion/ --bend 90 --twist 45 --frames 25\n"
             "  morula deform liver.obj -o motion.npy --stretch 2");
  on_use(*command, [o, command, &run] { run = [o, command] { return deform_command(*o, *command); }; });
}

}  // namespace morula::cli
