// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula convert: meshes to meshes, trees to trees.
#include <fmt/format.h>

#include <memory>
#include <morula/geometry/repair.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <optional>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct ConvertArguments {
  std::string input;
  std::string output;
  std::string mesh;
  std::string sph_origin = "none";
  std::optional<std::size_t> frame, level;
  std::string index_map;
  std::size_t animation = MotionOptions{}.animation;
  double frames_per_second = MotionOptions{}.frames_per_second;
  bool nested = false, used_only = false, sofa = false, weld = false;
  unsigned threads = 0;
  bool json = false;
};

/// Reports the output; growth: growth of a cover that had to be made.
int report(const ConvertArguments& o, const std::string& line, const BuildReport* growth) {
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

bool is_pattern(const std::string& path) {
  return std::filesystem::path(path).filename().string().find_first_of("*?") != std::string::npos &&
         !std::filesystem::exists(path);
}

void require_index_map(const ConvertArguments& o) {
  if (o.index_map.empty()) return;
  if (!o.used_only && !o.weld)
    throw UsageError("--index-map belongs to --used-only or --weld: without them vertices keep their numbers");
  if (o.used_only && o.weld) throw UsageError("--index-map has the numbers of one step: --used-only or --weld");
  require_output_place(o.index_map);
  require_not_input(o.index_map, {o.input, o.mesh, o.output});
}

/// After the output, so that an error leaves neither. weld: what --weld merged, or null.
void write_weld_map(const ConvertArguments& o, const MeshWeld* weld) {
  if (weld == nullptr || o.index_map.empty()) return;
  std::string text = "vertex,welded\n";
  for (std::size_t v = 0; v < weld->new_vertex.size(); ++v) text += fmt::format("{},{}\n", v, weld->new_vertex[v]);
  write_whole(o.index_map, text);
  note_written(o.index_map);
}

int convert_mesh(const ConvertArguments& o) {
  require_mesh_output(o.output);
  require_index_map(o);
  LoadedMesh loaded = load_mesh(o.input, o.weld);
  Mesh& mesh = loaded.mesh;
  if (o.used_only) {
    UsedVertices used = used_vertices(mesh);
    mesh = std::move(used.mesh);
    if (!o.index_map.empty()) {
      std::string text = "vertex,index\n";
      for (std::size_t v = 0; v < used.index.size(); ++v) text += fmt::format("{},{}\n", v, used.index[v]);
      write_whole(o.index_map, text);
      note_written(o.index_map);
    }
  }
  write_mesh(o.output, mesh);
  write_weld_map(o, loaded.merged());
  return report(o, mesh_line(o.output, mesh), nullptr);
}

SphereTree read_frame(const ConvertArguments& o) {
  const SphereFrames frames(o.input);
  if (*o.frame >= frames.frame_count()) {
    throw UsageError(fmt::format("--frame {}: {} has frames 0 to {}", *o.frame, o.input, frames.frame_count() - 1));
  }
  return frames.frame(*o.frame);
}

/// The leaves alone, or balls in another order of bytes.
int write_leaves(const ConvertArguments& o, std::span<const Sphere> balls) {
  write_balls(o.output, balls);
  return report(o, fmt::format("{}: {} without a tree", o.output, counted(balls.size(), "ball")), nullptr);
}

bool is_motion_file(const std::string& ending) {
  return ending == ".npy" || ending == ".pc2" || ending == ".mdd";
}

/// Frames from one kind of file to another. A mesh is its own where none is named.
int convert_motion(const ConvertArguments& o, FileKind kind) {
  const std::string ending = extension(o.output);
  const bool is_file = is_motion_file(ending);
  if (!is_file && !ending.empty()) {
    throw UsageError(fmt::format("{}: motions are written as .npy, .pc2, .mdd, or into a folder", o.output));
  }
  const std::string mesh_path = o.mesh.empty() && kind == FileKind::mesh && !is_pattern(o.input) ? o.input : o.mesh;
  if (mesh_path.empty()) throw UsageError(fmt::format("{}: a motion needs its mesh: add --mesh MESH", o.input));
  if (is_file) {
    require_output_place(o.output);
  } else {
    require_folder_place(o.output);
    require_not_input_folder(o.output, {o.input, mesh_path});
  }
  require_index_map(o);
  const LoadedMesh loaded = load_mesh(mesh_path, o.weld);
  const Mesh& mesh = loaded.mesh;
  const Motion motion(o.input, mesh,
                      {.frames_per_second = o.frames_per_second, .animation = o.animation, .weld = loaded.merged()});
  MotionWriter writer(o.output, mesh, motion.frame_count());
  for (std::size_t i = 0; i < motion.frame_count(); ++i) writer.write(motion.frame(i));
  writer.finish();
  write_weld_map(o, loaded.merged());
  return report(o,
                fmt::format("{}: {} of {}", o.output, counted(motion.frame_count(), "frame"),
                            counted(mesh.vertex_count(), "vertex", "vertices")),
                nullptr);
}

/// One level, the leaves where none is named, as SOFA loads spheres.
int write_sofa(const ConvertArguments& o) {
  require_output_place(o.output);
  if (extension(o.output) != ".sph") throw UsageError(fmt::format("{}: SOFA loads spheres from .sph", o.output));
  std::optional<Mesh> mesh;
  if (!o.mesh.empty()) mesh = load_mesh(o.mesh);
  const SphereTree tree =
      o.frame ? read_frame(o) : read_tree(o.input, parse_sph_origin(o.sph_origin, mesh ? &*mesh : nullptr)).tree;
  const std::size_t level = o.level.value_or(tree.level_count() - 1);
  if (level >= tree.level_count()) {
    throw UsageError(fmt::format("--level {}: {} has levels 0 to {}", level, o.input, tree.level_count() - 1));
  }
  const std::vector<Sphere> spheres = level_set_spheres(tree, level);
  write_sofa_spheres(o.output, spheres);
  return report(o, fmt::format("{}: {} for SOFA", o.output, counted(spheres.size(), "sphere")), nullptr);
}

/// One level of every frame, the leaves where none is named, as an animated scene.
int write_scene(const ConvertArguments& o) {
  require_output_place(o.output);
  std::optional<Mesh> mesh;
  if (!o.mesh.empty()) mesh = load_mesh(o.mesh);
  const bool is_motion = file_kind(o.input) == FileKind::sphere_frames;
  std::optional<SphereFrames> given;
  if (is_motion) given.emplace(o.input);
  const std::size_t count = is_motion && !o.frame ? given->frame_count() : 1;
  std::vector<std::vector<Sphere>> frames;
  for (std::size_t i = 0; i < count; ++i) {
    const SphereTree tree = o.frame ? read_frame(o)
                            : is_motion
                                ? given->frame(i)
                                : read_tree(o.input, parse_sph_origin(o.sph_origin, mesh ? &*mesh : nullptr)).tree;
    const std::size_t level = o.level.value_or(tree.level_count() - 1);
    if (level >= tree.level_count()) {
      throw UsageError(fmt::format("--level {}: {} has levels 0 to {}", level, o.input, tree.level_count() - 1));
    }
    frames.push_back(level_set_spheres(tree, level));
  }
  write_gltf_spheres(o.output, frames, o.frames_per_second);
  return report(o, fmt::format("{}: {} in {}", o.output, counted(frames[0].size(), "sphere"), counted(count, "frame")),
                nullptr);
}

bool writes_scene(const ConvertArguments& o) {
  return extension(o.output) == ".glb";
}

int convert_tree(const ConvertArguments& o) {
  if (o.sofa) return write_sofa(o);
  if (writes_scene(o)) return write_scene(o);
  const bool to_balls = extension(o.output) == ".ply";
  if (to_balls) {
    require_output_place(o.output);
  } else {
    require_tree_output(o.output);
  }
  if (to_balls && file_kind(o.input) == FileKind::balls) return write_leaves(o, read_balls(o.input));
  std::optional<Mesh> mesh;
  if (!o.mesh.empty()) mesh = load_mesh(o.mesh);
  const ReadTreeOptions reading = parse_sph_origin(o.sph_origin, mesh ? &*mesh : nullptr);
  TreeFile file = o.frame ? TreeFile{read_frame(o), std::nullopt, {}} : read_tree(o.input, reading);
  if (o.nested && to_balls) throw UsageError(fmt::format("{}: balls have no parents: leave out --nested", o.output));
  if (o.nested && !(mesh && extension(o.output) == ".morula")) make_nested(file.tree);
  if (to_balls) return write_leaves(o, level_set_spheres(file.tree, file.tree.level_count() - 1));
  if (extension(o.output) != ".morula") {
    write_tree(o.output, file.tree);
    if (file.cover) note("the cover stays behind: only .morula files hold it");
    return report(o,
                  fmt::format("{}: {}, {}", o.output, counted(file.tree.node_count(), "sphere"),
                              counted(file.tree.level_count(), "level")),
                  nullptr);
  }
  if (file.cover && !mesh) {
    write_tree(o.output, CoveredTree{std::move(file.tree), std::move(*file.cover), std::move(file.report),
                                     std::move(file.poses)});
    return report(o, fmt::format("{}: copied with its cover", o.output), nullptr);
  }
  if (!mesh) {
    throw UsageError(fmt::format(
        "{} has spheres alone, and a .morula file proves that they cover a mesh: add --mesh MESH", o.input));
  }
  Workers workers = make_workers(o.threads);
  CoveredTree model = o.frame ? cover(*mesh, file.tree, {.nested = o.nested}, workers)
                              : read_covered_tree(o.input, *mesh, reading, workers);
  if (o.nested) make_nested(model.tree);
  write_tree(o.output, model);
  return report(o,
                fmt::format("{}: {}, {}", o.output, counted(model.tree.node_count(), "sphere"),
                            counted(model.cover.patch_count(), "patch", "patches")),
                file.cover ? nullptr : &model.report);
}

int convert_command(const ConvertArguments& o) {
  require_not_input(o.output, {o.input, o.mesh});
  const FileKind kind = file_kind(o.input);
  if (o.frame && kind != FileKind::sphere_frames) {
    throw UsageError(fmt::format("--frame belongs to the .npz of an update, and {} is none: leave it out", o.input));
  }
  const bool holds_tree = kind == FileKind::tree || kind == FileKind::balls || kind == FileKind::sphere_frames;
  if (o.sofa && !holds_tree) throw UsageError(fmt::format("{}: --sofa writes the spheres of a tree", o.input));
  if (o.level && !o.sofa && !writes_scene(o)) {
    throw UsageError("--level belongs to --sofa and .glb: other formats hold all levels");
  }
  const bool to_motion = kind == FileKind::mesh && (extension(o.output).empty() || is_motion_file(extension(o.output)));
  if (o.weld && kind != FileKind::mesh && kind != FileKind::motion && kind != FileKind::folder)
    throw UsageError("--weld belongs to meshes and motions");
  if (o.used_only && (kind != FileKind::mesh || to_motion)) throw UsageError("--used-only belongs to meshes");
  switch (kind) {
    case FileKind::mesh:
      if (o.nested) throw UsageError(fmt::format("{} is a mesh: --nested is for trees, leave it out", o.input));
      if (to_motion) return convert_motion(o, kind);
      if (const std::string ending = extension(o.output);
          ending == ".morula" || ending == ".sph" || ending == ".json" || ending == ".npz") {
        throw UsageError(fmt::format("{} is a mesh and {} a tree: morula build makes trees", o.input, o.output));
      }
      return convert_mesh(o);
    case FileKind::sphere_frames:
      if (!o.frame && !writes_scene(o) && SphereFrames(o.input).frame_count() > 1) {
        throw UsageError(fmt::format("{}: holds the spheres of {} frames: say which one with --frame N", o.input,
                                     SphereFrames(o.input).frame_count()));
      }
      return convert_tree(o);
    case FileKind::tree:
    case FileKind::balls:
      return convert_tree(o);
    case FileKind::motion:
    case FileKind::folder:
      return convert_motion(o, kind);
    default:
      throw UsageError(fmt::format("{}: {}", o.input, known_kinds()));
  }
}

}  // namespace

void add_convert(CLI::App& app, Run& run) {
  auto o = std::make_shared<ConvertArguments>();
  CLI::App* command = add_command(app, "convert", "Convert between mesh formats, tree formats, or motions");
  add_option(*command, "IN", o->input,
             "Mesh or tree file, balls (.ply), spheres of frames (.npz) with --frame, or a motion with --mesh; if OUT "
             "is a motion, a mesh gives its animation, or itself as one frame")
      ->required()
      ->type_name("");
  add_option(*command, "OUT", o->output,
             "Mesh (" + writable_mesh_list() +
                 ") or tree (.morula .sph .json .npz) file; for a tree .ply has its leaves, .glb a scene to view; for "
                 "a motion .npy, .pc2, .mdd or a folder")
      ->required()
      ->type_name("");
  add_option(*command, "--mesh", o->mesh,
             "Mesh of a tree, required for the cover of .morula if the tree has none; or mesh of a motion")
      ->type_name("MESH");
  add_option(*command, "--frame", o->frame, "Frame of an .npz of morula update, counted from 0")
      ->type_name("N")
      ->transform(whole_number());
  add_flag(*command, "--used-only", o->used_only,
           "Drop mesh vertices that no facet uses, such as those inside a solid");
  add_flag(
      *command, "--weld", o->weld,
      "Merge the vertices of a mesh that are equal and stay so: position, and for glTF joints, weights and morphs");
  add_option(*command, "--index-map", o->index_map,
             "With --used-only: a table of the former number of each vertex; with --weld: of the new number")
      ->type_name("CSV");
  add_flag(*command, "--sofa", o->sofa, "One level of a tree for SOFA's SphereLoader, also with the ending .sph");
  add_option(*command, "--level", o->level, "Level for --sofa and .glb; default: the leaves")
      ->type_name("N")
      ->transform(whole_number());
  add_option(*command, "--animation", o->animation, "Animation of a glTF motion, counted from 0")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_option(*command, "--fps", o->frames_per_second, "Frames per second of a .glb and of a glTF motion")
      ->type_name("X")
      ->transform(number_above_zero())
      ->capture_default_str();
  add_flag(*command, "--nested", o->nested, "Grow or move the spheres of a tree until each contains its children's");
  add_sph_origin(*command, o->sph_origin);
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Example:\n"
             "  morula convert bunny.off bunny.obj\n"
             "  morula convert bunny.sph bunny.morula --mesh bunny.obj --sph-origin bbox-center");
  on_use(*command, [o, &run] { run = [o] { return convert_command(*o); }; });
}

}  // namespace morula::cli
