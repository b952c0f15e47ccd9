// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula info: a description of a mesh or a tree file as text, and a check of its guarantees.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <morula/geometry/inspect.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <toolbox/stopwatch.hpp>

#include "shared/command.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct InfoArguments {
  std::string file;
  std::string mesh;
  std::string sph_origin = "none";
  bool check = false;
  unsigned threads = 0;
  bool json = false;
};

/// The consequences of the report for sphere trees: possible queries, faults, harmless properties.
std::vector<std::string> consequences(const MeshReport& r) {
  std::vector<std::string> notes;
  if (r.has_volume()) {
    notes.push_back("closed and oriented: every figure can be measured");
    if (r.volume < 0) notes.push_back("inside out (negative volume): measured the right way round all the same");
  } else if (r.closed) {
    notes.push_back(why_no_inside(r) + ": looseness counts crossings, protrusion cannot be answered");
  } else if (r.oriented) {
    notes.push_back(
        fmt::format("open: {}; looseness is measured by the winding number, n/a where the surface encloses "
                    "no space; protrusion cannot be answered; trees still cover",
                    why_open(r)));
  } else {
    notes.push_back(
        fmt::format("open: {}, and its facets disagree on what is outside; neither looseness nor protrusion "
                    "can be answered; trees still cover",
                    why_open(r)));
  }
  const auto note = [&](std::size_t count, const char* one, const char* many, const char* meaning) {
    if (count > 0) notes.push_back(fmt::format("{}: {}", counted(count, one, many), meaning));
  };
  note(r.nonmanifold_edges, "edge of more than two facets", "edges of more than two facets", "covered like any other");
  note(r.nonmanifold_vertices, "vertex that joins several fans", "vertices that join several fans",
       "covered like any other");
  note(r.degenerate_facets, "facet without area", "facets without area", "covered, though nothing is gained by it");
  note(r.duplicate_facets, "repeated facet", "repeated facets", "covered twice; harmless, but wasted");
  note(r.duplicate_vertices, "repeated position", "repeated positions",
       r.closed ? "harmless" : "facets may be meant to share them; merging them may close the mesh");
  note(r.unused_vertices, "vertex of no facet", "vertices of no facet",
       "kept, since motions count them; never covered");
  return notes;
}

/// The improvements by repair(), and the command for them; empty if there are none.
std::string repair_line(const std::string& file, const MeshReport& r) {
  std::vector<std::string> gains;
  if (r.duplicate_vertices > 0 && !r.closed) gains.emplace_back("merges repeated positions");
  if (r.misoriented_edges > 0 || (r.has_volume() && r.volume < 0)) gains.emplace_back("orients facets");
  if (!r.closed) gains.emplace_back("caps holes of up to N edges with --cap N");
  if (gains.empty()) return {};
  return fmt::format("morula repair {} -o OUT {}", file, fmt::join(gains, ", "));
}

/// How polygons became facets.
std::string polygon_line(const MeshInfo& file) {
  std::string text = fmt::format("{}, cut into facets", file.polygons);
  if (file.concave_polygons > 0) text += fmt::format("; {} concave, cut by ears", file.concave_polygons);
  if (file.crossing_polygons > 0)
    text += fmt::format("; {} {}", file.crossing_polygons,
                        file.crossing_polygons == 1 ? "crosses itself" : "cross themselves");
  if (file.bent_polygons > 0) text += fmt::format("; {} far from flat", file.bent_polygons);
  return text;
}

int mesh_info(const InfoArguments& o) {
  if (!o.mesh.empty()) throw UsageError("--mesh belongs to a tree file, and this is a mesh: leave it out");
  MeshInfo file;
  const Mesh mesh = read_mesh(o.file, file);
  const MeshReport r = inspect(mesh);
  std::vector<std::string> notes = consequences(r);
  notes.insert(notes.begin(), file.notes.begin(), file.notes.end());
  if (std::string line = repair_line(o.file, r); !line.empty()) notes.push_back(std::move(line));
  if (o.json) {
    const auto vector = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
    print_json({{"file", o.file},
                {"kind", "mesh"},
                {"vertices", r.vertex_count},
                {"facets", r.facet_count},
                {"polygons", file.polygons},
                {"concave_polygons", file.concave_polygons},
                {"crossing_polygons", file.crossing_polygons},
                {"bent_polygons", file.bent_polygons},
                {"mesh_hash", hash_text(mesh_hash(mesh))},
                {"components", r.component_count},
                {"closed", r.closed},
                {"oriented", r.oriented},
                {"manifold", r.manifold},
                {"boundary_edges", r.boundary_edges},
                {"nonmanifold_edges", r.nonmanifold_edges},
                {"misoriented_edges", r.misoriented_edges},
                {"nonmanifold_vertices", r.nonmanifold_vertices},
                {"degenerate_facets", r.degenerate_facets},
                {"duplicate_facets", r.duplicate_facets},
                {"duplicate_vertices", r.duplicate_vertices},
                {"unused_vertices", r.unused_vertices},
                {"box", {{"lower", vector(r.box.lower)}, {"upper", vector(r.box.upper)}}},
                {"area", r.area},
                {"volume", r.has_volume() ? Json(r.volume) : Json(nullptr)},
                {"notes", notes}});
  } else {
    const Vec3 size = r.box.extent();
    fmt::print("{}, {}\n\n", mesh_line(o.file, mesh), counted(r.component_count, "component"));
    fmt::print("box       {} x {} x {}, diagonal {}\n", figure(size.x), figure(size.y), figure(size.z),
               figure(r.box.diagonal()));
    if (file.polygons > 0) fmt::print("polygons  {}\n", polygon_line(file));
    fmt::print("area      {}\n", figure(r.area));
    fmt::print("volume    {}\n", r.has_volume() ? figure(r.volume) : "n/a");
    fmt::print("closed    {}\noriented  {}\nmanifold  {}\n\n", r.closed ? "yes" : "no", r.oriented ? "yes" : "no",
               r.manifold ? "yes" : "no");
    for (const std::string& note : notes) fmt::print("- {}\n", note);
  }
  return o.check && !r.has_volume() ? exit_check_failed : exit_done;
}

/// Faults of the tree; with its mesh, of its cover as well.
std::vector<std::string> check_tree(const InfoArguments& o, const TreeFile& file, const std::optional<Mesh>& mesh) {
  std::vector<std::string> faults = validate(file.tree);
  if (!faults.empty() || !file.cover || !mesh) return faults;
  if (file.report.mesh_hash != mesh_hash(*mesh)) read_covered_tree(o.file, *mesh);  // throws with the reason
  return validate(*mesh, CoveredTree{file.tree, *file.cover, file.report, file.poses});
}

std::string nesting_line(const SphereTree& tree) {
  const Nesting nesting = certify_nesting(tree, tree.spheres);
  if (nesting.nested)
    return fmt::format("yes: every sphere contains its children's{}",
                       tree.nested ? "" : ", though the file does not say so");
  return fmt::format("no: {} out of the one above, by up to {}",
                     nesting.outside == 1 ? "1 sphere sticks" : fmt::format("{} spheres stick", nesting.outside),
                     figure(nesting.worst_excess));
}

void print_tree(const InfoArguments& o, const TreeFile& file) {
  const SphereTree& tree = file.tree;
  fmt::print("{}: tree of {}, {}, branching {}\n\n{}\n", o.file, counted(tree.node_count(), "sphere"),
             counted(tree.level_count(), "level"), tree.branching, level_table(tree));
  fmt::print("nested     {}\n", nesting_line(tree));
  if (!file.cover) {
    fmt::print("cover      none in this format: morula update and morula convert make one\n");
    return;
  }
  fmt::print("method     {}, branching {}, depth {}, seed {}\n", file.report.method, file.report.branching,
             file.report.depth, file.report.seed);
  fmt::print("mesh       {}, {}, hash {}\n", counted(file.cover->vertex_count, "vertex", "vertices"),
             counted(file.cover->facet_count, "facet"), hash_text(file.report.mesh_hash));
  fmt::print("cover      {}, at most {} of one facet, {}\n", counted(file.cover->patch_count(), "patch", "patches"),
             file.cover->most_patches_of_a_facet(), counted(file.cover->cut_points.size(), "cut point"));
  for (const KnownPose& pose : file.poses) {
    fmt::print("pose       {}: {}\n", pose.name, counted(pose.model->tree.node_count(), "sphere"));
  }
  if (!file.report.growth.empty()) fmt::print("\n{}", growth_text(file.report));
  for (const std::string& note : file.report.notes) fmt::print("note       {}\n", note);
}

Json tree_json(const InfoArguments& o, const TreeFile& file) {
  Json json{{"file", o.file},
            {"kind", "tree"},
            {"nodes", file.tree.node_count()},
            {"leaves", file.tree.leaf_count()},
            {"branching", file.tree.branching},
            {"tree_hash", hash_text(tree_hash(file.tree))},
            {"levels", level_json(file.tree)},
            {"nested", certify_nesting(file.tree, file.tree.spheres).nested},
            {"cover", nullptr}};
  if (file.cover) {
    json["cover"] = {{"vertices", file.cover->vertex_count},
                     {"facets", file.cover->facet_count},
                     {"patches", file.cover->patch_count()},
                     {"most_patches_of_a_facet", file.cover->most_patches_of_a_facet()},
                     {"cut_points", file.cover->cut_points.size()},
                     {"corners", file.cover->corners.size()}};
    json["method"] = file.report.method;
    json["depth"] = file.report.depth;
    json["seed"] = file.report.seed;
    json["mesh_hash"] = hash_text(file.report.mesh_hash);
    json["growth"] = growth_json(file.report);
    json["notes"] = file.report.notes;
    json["poses"] = Json::array();
    for (const KnownPose& pose : file.poses) {
      json["poses"].push_back({{"name", pose.name}, {"nodes", pose.model->tree.node_count()}});
    }
  }
  return json;
}

int tree_info(const InfoArguments& o) {
  std::optional<Mesh> mesh;
  if (!o.mesh.empty()) mesh = load_mesh(o.mesh);
  const ReadTreeOptions reading = parse_sph_origin(o.sph_origin, mesh ? &*mesh : nullptr);
  const TreeFile file = read_tree(o.file, reading);
  const std::vector<std::string> faults = o.check ? check_tree(o, file, mesh) : std::vector<std::string>{};
  // A tree without a cover proves nothing: the growth for a cover measures how far it is from covering.
  std::optional<CoveredTree> repaired;
  if (o.check && faults.empty() && mesh && !file.cover) {
    Workers workers = make_workers(o.threads);
    repaired = cover(*mesh, file.tree, {}, workers);
  }
  if (o.json) {
    Json json = tree_json(o, file);
    if (o.check) json["faults"] = faults;
    if (repaired) json["growth_to_cover"] = growth_json(repaired->report);
    print_json(json);
  } else {
    print_tree(o, file);
    if (repaired) fmt::print("\n{}", growth_text(repaired->report));
    if (o.check && faults.empty()) {
      fmt::print("check      {}\n", !file.cover ? "the arrays are sound"
                                    : mesh
                                        ? "the tree is sound, the patches tile the mesh, every sphere wraps its region"
                                        : "the arrays are sound; add --mesh MESH to check the cover");
    }
    for (const std::string& fault : faults) fmt::print("fault      {}\n", fault);
  }
  return faults.empty() ? exit_done : exit_check_failed;
}

void require_no_tree_options(const InfoArguments& o, const char* what) {
  if (!o.mesh.empty())
    throw UsageError(fmt::format("--mesh belongs to a tree file, and this is {}: leave it out", what));
}

int balls_info(const InfoArguments& o) {
  require_no_tree_options(o, "balls without a tree");
  const std::vector<Sphere> balls = read_balls(o.file);
  std::vector<double> radii;
  Box box;
  for (const Sphere& ball : balls) {
    radii.push_back(ball.radius);
    box.add(ball.center - Vec3{ball.radius, ball.radius, ball.radius});
    box.add(ball.center + Vec3{ball.radius, ball.radius, ball.radius});
  }
  std::sort(radii.begin(), radii.end());
  const Vec3 size = balls.empty() ? Vec3{} : box.extent();
  if (o.json) {
    Json json{{"file", o.file}, {"kind", "balls"}, {"balls", balls.size()}, {"radius", nullptr}, {"box", nullptr}};
    if (!balls.empty()) {
      json["radius"] = {{"smallest", radii.front()}, {"median", median(radii)}, {"largest", radii.back()}};
      const auto vector = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
      json["box"] = {{"lower", vector(box.lower)}, {"upper", vector(box.upper)}};
    }
    print_json(json);
    return exit_done;
  }
  fmt::print("{}: {} without a tree\n", o.file, counted(balls.size(), "ball"));
  if (balls.empty()) return exit_done;
  fmt::print("\nradius    smallest {}, median {}, largest {}\n", figure(radii.front()), figure(median(radii)),
             figure(radii.back()));
  fmt::print("box       {} x {} x {}\n\n", figure(size.x), figure(size.y), figure(size.z));
  fmt::print("- measured as they are; where a tree is needed, one is made over them and given a cover\n");
  return exit_done;
}

int frames_info(const InfoArguments& o) {
  require_no_tree_options(o, "spheres of a motion");
  const SphereFrames frames(o.file);
  const SphereTree tree = frames.frame(0);
  // Every frame is read, so that --check means all of them.
  if (o.check)
    for (std::size_t i = 1; i < frames.frame_count(); ++i) frames.frame(i);
  if (o.json) {
    Json json{{"file", o.file},
              {"kind", "spheres of frames"},
              {"frames", frames.frame_count()},
              {"nodes", tree.node_count()},
              {"leaves", tree.leaf_count()},
              {"branching", tree.branching},
              {"levels", level_json(tree)}};
    if (o.check) json["faults"] = Json::array();
    print_json(json);
    return exit_done;
  }
  fmt::print("{}: {} of a tree of {}, {}, branching {}\n\nIn the first frame\n{}\n", o.file,
             counted(frames.frame_count(), "frame"), counted(tree.node_count(), "sphere"),
             counted(tree.level_count(), "level"), tree.branching, level_table(tree));
  fmt::print("- measure and view take them together with the motion; convert --frame N takes one out\n");
  if (o.check) fmt::print("check      the arrays are sound in every frame\n");
  return exit_done;
}

int info_command(const InfoArguments& o) {
  switch (file_kind(o.file)) {
    case FileKind::balls:
      return balls_info(o);
    case FileKind::sphere_frames:
      return frames_info(o);
    case FileKind::motion:
      throw UsageError(
          fmt::format("{}: positions of frames, which mean nothing without their mesh; morula view and "
                      "morula update take both",
                      o.file));
    case FileKind::mesh:
      return mesh_info(o);
    case FileKind::tree:
      return tree_info(o);
    default:
      throw UsageError(fmt::format("{}: {}", o.file, known_kinds()));
  }
}

}  // namespace

void add_info(CLI::App& app, Run& run) {
  auto o = std::make_shared<InfoArguments>();
  CLI::App* command = add_command(app, "info", "Say what a mesh or a tree file is, and what it is good for");
  add_option(*command, "FILE", o->file, "Mesh, tree, balls (.ply) or spheres of frames (.npz)")
      ->required()
      ->type_name("");
  add_flag(*command, "--check", o->check,
           "Exit with 1 if a mesh has no inside, or a tree violates a guarantee (its cover is checked with --mesh)");
  add_option(*command, "--mesh", o->mesh, "The mesh of a tree")->type_name("MESH");
  add_sph_origin(*command, o->sph_origin);
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Example:\n"
             "  morula info liver.obj\n"
             "  morula info liver.morula --check --mesh liver.obj");
  on_use(*command, [o, &run] { run = [o] { return info_command(*o); }; });
}

}  // namespace morula::cli
