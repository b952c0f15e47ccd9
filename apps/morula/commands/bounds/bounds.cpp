// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula bounds: rest data by which an engine computes covering spheres of a skinned mesh from its bones alone.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <morula/io/modal_file.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>

#include "commands/bounds/clusters.hpp"
#include "commands/bounds/evaluators.hpp"
#include "commands/bounds/rest_data.hpp"
#include "commands/bounds/tightness.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct BoundsArguments {
  std::string mesh;
  std::string output;
  std::string skin, transforms, modes, coordinates;
  std::size_t clusters = 64;
  std::string clusters_from;
  bool primitives = false;
  MotionOptions animation;
  std::string evaluator;
  unsigned threads = 0;
  bool json = false;
};

bool is_gltf(const std::string& path) {
  const std::string ending = extension(path);
  return ending == ".gltf" || ending == ".glb";
}

void require_arguments(BoundsArguments& o) {
  if (o.mesh.empty()) throw UsageError("MESH is missing: name a .gltf or .glb, or a mesh with --skin; or --evaluator");
  if (o.output.empty()) throw UsageError("-o is missing: name a .json, or a copy of a .gltf or .glb");
  if (o.skin.empty() && !is_gltf(o.mesh))
    throw UsageError(fmt::format("{}: has no skin; add --skin FILE, or give a .gltf or .glb", o.mesh));
  if (o.skin.empty()) o.skin = o.mesh;
  if (o.transforms.empty() && is_gltf(o.skin)) o.transforms = o.skin;
  if (!o.modes.empty() && is_gltf(o.skin))
    throw UsageError(fmt::format("both --modes and {}, which has morph targets of its own: leave out --modes", o.skin));
  if (!o.coordinates.empty() && (o.modes.empty() || o.transforms.empty()))
    throw UsageError("--coords needs the modes and transforms they belong to: add --modes FILE and --transforms FILE");
  if (o.primitives && !is_gltf(o.mesh)) throw UsageError("--primitives needs a .gltf or .glb as MESH");
  const bool embeds = is_gltf(o.output);
  if (!embeds && extension(o.output) != ".json")
    throw UsageError(fmt::format("{}: bounds are written as .json, or into a copy of a .gltf or .glb", o.output));
  if (embeds && o.skin != o.mesh)
    throw UsageError(fmt::format("{}: bounds go into a copy of a glTF file with its own skin; name a .json", o.output));
  require_output_place(o.output);
  require_not_input(o.output, {o.mesh, o.skin, o.transforms, o.modes, o.coordinates, o.clusters_from});
}

/// The file with the morph targets; none: empty.
std::string file_of_targets(const BoundsArguments& o) {
  if (!o.modes.empty()) return o.modes;
  return is_gltf(o.skin) ? o.skin : is_gltf(o.mesh) ? o.mesh : "";
}

/// Primitives of the mesh, bones of the skin, and morph targets, where they are in glTF files.
GltfParts parts_of(const BoundsArguments& o) {
  GltfParts parts = is_gltf(o.mesh) ? read_gltf_parts(o.mesh) : GltfParts{};
  if (o.skin != o.mesh) {
    GltfParts of_skin = is_gltf(o.skin) ? read_gltf_parts(o.skin) : GltfParts{};
    parts.bones = std::move(of_skin.bones);
    if (file_of_targets(o) != o.mesh) parts.targets = std::move(of_skin.targets);
  }
  return parts;
}

std::vector<std::uint32_t> requested_clusters(const BoundsArguments& o, const Mesh& mesh, const GltfParts& parts) {
  if (o.primitives) return primitive_clusters(parts);
  return o.clusters_from.empty() ? halved_clusters(mesh, o.clusters)
                                 : read_clusters(o.clusters_from, mesh.facet_count());
}

/// Frames without coordinates have all targets at rest.
BoneFrames requested_frames(const BoundsArguments& o, const Skin& skin, const Modes& targets) {
  if (o.transforms.empty()) return {};
  // The animation of the file that has the targets.
  if (is_gltf(o.transforms) && o.transforms == file_of_targets(o))
    return read_bone_frames(o.transforms, skin.bone_count, targets.mode_count, o.animation);
  BoneFrames frames = read_bone_frames(o.transforms, skin.bone_count, o.animation);
  if (o.coordinates.empty()) return frames;
  frames.morphs = read_coordinates(o.coordinates, targets.mode_count);
  if (frames.morphs.frame_count() != frames.frame_count())
    throw FileError(fmt::format("{}: has {}, but {} has {}", o.coordinates,
                                counted(frames.morphs.frame_count(), "frame"), o.transforms, frames.frame_count()));
  return frames;
}

/// Clusters without facets behind the last one that has some.
void add_empty_clusters(SkinBoundsData& data, std::size_t cluster_count) {
  const SkinBoundsCluster empty{.first_row = static_cast<std::uint32_t>(data.rows.size())};
  if (data.clusters.size() < cluster_count) data.clusters.resize(cluster_count, empty);
  if (data.target_count > 0)
    data.target_begin.resize(data.clusters.size() + 1, static_cast<std::uint32_t>(data.targets.size()));
}

struct WrittenBounds {
  double read_seconds = 0, bounds_seconds = 0;
  std::size_t frames = 0;
  Tightness tightness{};
};

void print_report(const BoundsArguments& o, const Mesh& mesh, const SkinBoundsData& data, WrittenBounds& written) {
  if (o.json) {
    Json report{{"mesh", o.mesh},
                {"output", o.output},
                {"vertices", mesh.vertex_count()},
                {"facets", mesh.facet_count()},
                {"clusters", data.clusters.size()},
                {"bones", data.bone_count},
                {"rows", data.rows.size()},
                {"morph_targets", data.target_count},
                {"frames", written.frames}};
    if (written.frames > 0) report.update(written.tightness.json());
    report["seconds"] = {{"read", written.read_seconds}, {"bounds", written.bounds_seconds}};
    print_json(report);
    return;
  }
  fmt::print("{}\n\n", mesh_line(o.mesh, mesh));
  fmt::print("bounds        {}, {}, {}", counted(data.clusters.size(), "cluster"), counted(data.bone_count, "bone"),
             counted(data.rows.size(), "row"));
  if (data.target_count > 0) fmt::print(", {}", counted(data.target_count, "morph target"));
  fmt::print("\n");
  if (written.frames > 0) {
    fmt::print("checked       {}\n", counted(written.frames, "frame"));
    fmt::print("radius        {} of the smallest sphere's\n", written.tightness.text());
    fmt::print("uncovered     {} corners\n", written.tightness.uncovered_count());
  } else {
    fmt::print("checked       no frame: the file has no animation; --transforms FILE has some\n");
  }
  fmt::print("written       {}\n", o.output);
}

int bounds_command(BoundsArguments o) {
  if (!o.evaluator.empty()) {
    check_name("evaluator", o.evaluator, evaluator_names());
    if (!o.mesh.empty() || !o.output.empty())
      throw UsageError("--evaluator prints a text and writes no bounds: leave out MESH and -o");
    if (o.json)
      print_json({{"evaluator", o.evaluator}, {"text", evaluator_text(o.evaluator)}});
    else
      fmt::print("{}", evaluator_text(o.evaluator));
    return exit_done;
  }
  require_arguments(o);
  Workers workers = make_workers(o.threads);
  toolbox::Stopwatch watch;
  const Mesh mesh = load_mesh(o.mesh);
  const Skin skin = read_skin(o.skin, mesh);
  const GltfParts parts = parts_of(o);
  const std::string modes = file_of_targets(o);
  const Modes targets = modes.empty() ? Modes{} : read_modes(modes, mesh);
  const std::vector<std::uint32_t> clusters = requested_clusters(o, mesh, parts);
  const BoneFrames frames = requested_frames(o, skin, targets);
  WrittenBounds written{.read_seconds = watch.lap(), .frames = frames.frame_count()};
  SkinBoundsData data = SkinBounds(mesh, skin, targets, clusters, workers).data();
  if (o.primitives) add_empty_clusters(data, parts.primitives.size());
  written.bounds_seconds = watch.lap();
  written.tightness = measured_tightness(data, mesh, skin, targets, clusters, frames, workers);
  const std::string text = bounds_text(data, mesh, clusters, parts);
  if (is_gltf(o.output))
    write_gltf_extra(o.mesh, o.output, "morula_skin_bounds", text);
  else
    write_whole(o.output, text + "\n");
  note_written(o.output);
  print_report(o, mesh, data, written);
  return written.tightness.uncovered_count() > 0 ? exit_check_failed : exit_done;
}

}  // namespace

void add_bounds(CLI::App& app, Run& run) {
  auto o = std::make_shared<BoundsArguments>();
  CLI::App* command =
      add_command(app, "bounds", "Write data by which bones alone give covering spheres of a skinned mesh");
  add_option(*command, "MESH", o->mesh, "Character: .gltf or .glb; or a mesh file with --skin")->type_name("");
  add_option(*command, "-o,--output", o->output, "Rest data: .json, or a copy of MESH with the data in its extras")
      ->type_name("BOUNDS");
  add_option(*command, "--skin", o->skin, "Skin: .npy of shape (vertices, bones); default: that of a glTF MESH")
      ->type_name("FILE");
  add_option(*command, "--transforms", o->transforms,
             "Transforms to check and measure by: .npy of shape (frames, bones, 3, 4); default: a glTF's animation")
      ->type_name("FILE");
  add_option(*command, "--modes", o->modes,
             "Morph targets: .npy of shape (targets, vertices, 3); default: those of a glTF MESH")
      ->type_name("FILE");
  add_option(*command, "--coords", o->coordinates, "Their numbers to check by: .npy of shape (frames, targets)")
      ->type_name("FILE");
  CLI::Option* clusters = add_option(*command, "--clusters", o->clusters, "Number of clusters of facets")
                              ->type_name("N")
                              ->transform(whole_number(1, 0xffffff))
                              ->capture_default_str();
  CLI::Option* from =
      add_option(*command, "--clusters-from", o->clusters_from, "Cluster of each facet: .npy of integers, or a text")
          ->type_name("FILE")
          ->excludes(clusters);
  add_flag(*command, "--primitives", o->primitives, "One cluster for each primitive of a glTF file")
      ->excludes(clusters)
      ->excludes(from);
  add_option(*command, "--animation", o->animation.animation, "Animation of glTF, counted from 0")
      ->type_name("N")
      ->transform(whole_number(0, 1000000));
  add_option(*command, "--fps", o->animation.frames_per_second, "Frames per second of glTF; default: 30")
      ->type_name("RATE")
      ->transform(number_above_zero());
  add_option(*command, "--evaluator", o->evaluator, "Print the code that evaluates rest data and exit: c, glsl, wgsl")
      ->type_name("LANGUAGE");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Example:\n"
             "  morula bounds hero.glb -o hero.bounds.json --clusters 64\n"
             "  morula bounds --evaluator glsl > skin_bounds.glsl");
  on_use(*command, [o, &run] { run = [o] { return bounds_command(*o); }; });
}

}  // namespace morula::cli
