// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula repair: vertices merged, facets turned, holes capped, and what was done.
#include <fmt/format.h>

#include <memory>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/skin_file.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct RepairArguments {
  std::string mesh;
  std::string output;
  std::string skin, skin_output;
  double merge = 0;
  bool no_merge = false;
  bool remove_degenerate = false;
  bool no_orient = false;
  std::size_t cap = 0;
  unsigned threads = 0;
  bool json = false;
};

Json state_json(const MeshReport& r) {
  return {{"vertices", r.vertex_count},
          {"facets", r.facet_count},
          {"closed", r.closed},
          {"oriented", r.oriented},
          {"manifold", r.manifold},
          {"boundary_edges", r.boundary_edges},
          {"misoriented_edges", r.misoriented_edges},
          {"volume", r.has_volume() ? Json(r.volume) : Json(nullptr)}};
}

std::string state_text(const MeshReport& r) {
  return fmt::format("{}, {}, {}{}", r.closed ? "closed" : fmt::format("open ({})", why_open(r)),
                     r.oriented ? "oriented" : "not oriented", r.manifold ? "manifold" : "not manifold",
                     r.has_volume() ? fmt::format(", volume {}", figure(r.volume)) : "");
}

void print_text(const RepairArguments& o, const RepairedMesh& repaired, const MeshReport& before,
                const MeshReport& after) {
  const RepairReport& r = repaired.report;
  fmt::print("{}\n\nbefore   {}\n", mesh_line(o.output, repaired.mesh), state_text(before));
  const auto line = [](bool is_there, const std::string& text) {
    if (is_there) fmt::print("- {}\n", text);
  };
  line(r.merged_vertices > 0, fmt::format("{} merged into others", counted(r.merged_vertices, "vertex", "vertices")));
  line(r.collapsed_facets > 0,
       fmt::format("{} removed that merging left without area", counted(r.collapsed_facets, "facet")));
  line(r.degenerate_facets > 0, fmt::format("{} without area removed", counted(r.degenerate_facets, "facet")));
  line(r.turned_facets > 0, fmt::format("{} turned over", counted(r.turned_facets, "facet")));
  line(r.capped_holes > 0,
       fmt::format("{} capped with {}", counted(r.capped_holes, "hole"), counted(r.cap_facets, "facet")));
  line(!r.changed(), "nothing to do: the mesh is written as it was");
  fmt::print("after    {}\n", state_text(after));
  line(r.unorientable_pieces > 0,
       fmt::format("{} with one side only: left as they were", counted(r.unorientable_pieces, "component")));
  line(r.open_holes > 0, fmt::format("{} left open{}", counted(r.open_holes, "hole"),
                                     o.cap == 0 ? "; --cap N closes those of at most N edges" : ""));
  line(r.merged_vertices > 0, fmt::format("the vertices have new numbers: a motion{} of the old mesh does not fit",
                                          o.skin.empty() ? " or skin" : ""));
}

int repair_command(const RepairArguments& o) {
  require_mesh_output(o.output);
  require_not_input(o.output, {o.mesh});
  if (o.skin.empty() != o.skin_output.empty())
    throw UsageError("--skin and --skin-output belong together: the skin of MESH, and that of OUT");
  if (!o.skin.empty()) {
    if (extension(o.skin_output) != ".npy")
      throw UsageError(fmt::format("--skin-output {}: skins are written as .npy", o.skin_output));
    require_output_place(o.skin_output);
    require_not_input(o.skin_output, {o.mesh, o.skin});
  }
  const Mesh mesh = load_mesh(o.mesh);
  const Skin skin = o.skin.empty() ? Skin{} : read_skin(o.skin, mesh);
  const std::vector<std::uint32_t> labels = skin.empty() ? std::vector<std::uint32_t>{} : skin_labels(skin);
  RepairOptions options{.remove_degenerate = o.remove_degenerate, .orient = !o.no_orient, .cap_edges = o.cap};
  options.labels = labels;
  options.merge_distance = o.no_merge ? std::nullopt : std::optional(o.merge);
  const RepairedMesh repaired = repair(mesh, options);
  if (repaired.mesh.facets.empty()) {
    throw UsageError(fmt::format("{}: no facet is left; give a smaller --merge distance", o.mesh));
  }
  const MeshReport before = inspect(mesh), after = inspect(repaired.mesh);
  write_mesh(o.output, repaired.mesh);
  note_written(o.output);
  if (!skin.empty()) {
    write_skin(o.skin_output, skin_of_vertices(skin, repaired.report.old_vertex));
    note_written(o.skin_output);
  }
  if (!o.json) {
    print_text(o, repaired, before, after);
    return exit_done;
  }
  const RepairReport& r = repaired.report;
  print_json({{"mesh", o.mesh},
              {"output", o.output},
              {"merged_vertices", r.merged_vertices},
              {"collapsed_facets", r.collapsed_facets},
              {"degenerate_facets_removed", r.degenerate_facets},
              {"turned_facets", r.turned_facets},
              {"unorientable_pieces", r.unorientable_pieces},
              {"capped_holes", r.capped_holes},
              {"cap_facets", r.cap_facets},
              {"open_holes", r.open_holes},
              {"changed", r.changed()},
              {"before", state_json(before)},
              {"after", state_json(after)}});
  return exit_done;
}

}  // namespace

void add_repair(CLI::App& app, Run& run) {
  auto o = std::make_shared<RepairArguments>();
  CLI::App* command = add_command(app, "repair", "Merge vertices, turn facets, cap small holes, and say what was done");
  add_option(*command, "MESH", o->mesh, "Mesh file: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "-o,--output", o->output, "Mesh file: " + writable_mesh_list())->type_name("MESH")->required();
  CLI::Option* merge = add_option(*command, "--merge", o->merge,
                                  "Merge vertices at most this far apart, mesh units; default: equal ones")
                           ->type_name("LENGTH")
                           ->transform(real_number(0));
  add_flag(*command, "--no-merge", o->no_merge, "Merge none")->excludes(merge);
  add_option(*command, "--skin", o->skin,
             "Skin of MESH, .npy or the glTF of MESH itself: merge only vertices with the same weights")
      ->type_name("SKIN");
  add_option(*command, "--skin-output", o->skin_output, "The skin of the vertices that remain")->type_name("NPY");
  add_flag(*command, "--remove-degenerate", o->remove_degenerate, "Remove facets without area; may open a closed mesh");
  add_flag(*command, "--no-orient", o->no_orient,
           "Keep the orientation of all facets; default: consistent, and outward for closed components");
  add_option(*command, "--cap", o->cap, "Close holes of at most N edges, without new vertices; default: none")
      ->type_name("N")
      ->transform(whole_number(0, 500));
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Positions are never moved; vertices and facets that stay keep their order.\n"
             "Example:\n"
             "  morula repair scan.ply -o whole.ply --cap 30\n"
             "  morula repair arm.glb -o arm.ply --skin arm.glb --skin-output skin.npy");
  on_use(*command, [o, &run] { run = [o] { return repair_command(*o); }; });
}

}  // namespace morula::cli
