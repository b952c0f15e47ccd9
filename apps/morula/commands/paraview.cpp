// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula paraview: a surface, its spheres and contacts frame by frame, as ParaView reads them.
#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <map>
#include <memory>
#include <morula/geometry/triangle.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/paraview_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/query/power_diagram.hpp>
#include <morula/update/body.hpp>

#include "platform/decimal.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;

struct ParaviewArguments {
  std::string mesh, tree, motion, contacts, output;
  std::string sph_origin = "none";
  std::optional<std::size_t> level;
  double frames_per_second = MotionOptions{}.frames_per_second;
  unsigned threads = 0;
  bool json = false;
};

/// The tree with its spheres frame by frame: as given, or as they follow the motion.
class FrameSpheres {
 public:
  FrameSpheres(const ParaviewArguments& o, const Mesh& mesh, std::size_t frame_count, Workers& workers)
      : workers_(workers) {
    if (o.tree.empty()) return;
    if (file_kind(o.tree) == FileKind::sphere_frames) {
      given_.emplace(o.tree);
      if (given_->frame_count() != frame_count) {
        throw UsageError(fmt::format(
            "{} has {} of spheres, but there {} {}: give the motion that they were updated for", o.tree,
            counted(given_->frame_count(), "frame"), frame_count == 1 ? "is" : "are", counted(frame_count, "frame")));
      }
      return;
    }
    const ReadTreeOptions reading = parse_sph_origin(o.sph_origin, &mesh);
    if (o.motion.empty()) {
      rest_ = read_tree(o.tree, reading).tree;
    } else {
      body_.emplace(mesh, read_covered_tree(o.tree, mesh, reading, workers));
    }
  }
  bool any() const { return given_ || rest_ || body_; }
  /// Frames in order.
  SphereTree at(std::size_t frame, const std::vector<Vec3>& positions, const std::string& name) {
    if (given_) return given_->frame(frame);
    if (rest_) return *rest_;
    if (const UpdateStatus status = body_->update(positions, workers_); !status) {
      throw FileError(fmt::format("{}: {}", name, message(status)));
    }
    return body_->current_tree();
  }

 private:
  Workers& workers_;
  std::optional<SphereFrames> given_;
  std::optional<SphereTree> rest_;
  std::optional<Body> body_;
};

VtpData spheres_data(const SphereTree& tree, const std::vector<std::uint32_t>& nodes) {
  std::vector<double> level_of(tree.node_count());
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
      level_of[node] = static_cast<double>(level);
    }
  }
  VtpData data;
  VtpArray radius{"radius", {}}, node_number{"node", {}, 1, true}, level{"level", {}, 1, true},
      parent{"parent", {}, 1, true}, leaf{"leaf", {}, 1, true};
  for (const std::uint32_t node : nodes) {
    data.points.push_back(tree.spheres[node].center);
    radius.values.push_back(tree.spheres[node].radius);
    node_number.values.push_back(node);
    level.values.push_back(level_of[node]);
    parent.values.push_back(tree.parent[node] == no_node ? -1.0 : static_cast<double>(tree.parent[node]));
    leaf.values.push_back(tree.child_count[node] == 0 ? 1 : 0);
  }
  data.point_arrays = {radius, node_number, level, parent, leaf};
  return data;
}

/// Adds the distance of every vertex to the spheres, negative inside one, and for every facet whether a part of it is
/// uncovered.
void add_cover(VtpData& data, const std::vector<Sphere>& spheres, std::size_t& uncovered_facets) {
  const PowerDiagram diagram(spheres);
  VtpArray distances{"distance", {}}, uncovered{"uncovered", {}, 1, true};
  double largest = 0;
  for (const Vec3& p : data.points) {
    largest = std::max(largest, max_norm(p));
    distances.values.push_back(diagram.least_growth(std::span(&p, 1)).amount);
  }
  for (const Sphere& s : spheres) largest = std::max({largest, max_norm(s.center), s.radius});
  // The tolerance is the certificate's.
  const double tolerance = 0x1p-46 * largest;
  std::vector<std::uint32_t> scratch;
  CutFacet cut;
  for (const Facet& facet : data.facets) {
    const FacetGeometry geometry{{data.points[facet[0]], data.points[facet[1]], data.points[facet[2]]}, facet};
    bool is_uncovered = false;
    cut.clear();
    // Most facets lie in one sphere, and a ball is convex.
    if (diagram.least_growth(geometry.corners).amount > tolerance) diagram.cut(geometry, scratch, cut);
    for (std::size_t k = 0; k < cut.size(); ++k) {
      const Sphere& s = spheres[cut.owner[k]];
      for (const Barycentric& b : cut.polygon(k)) {
        const Vec3 p = b[0] * geometry.corners[0] + b[1] * geometry.corners[1] + b[2] * geometry.corners[2];
        is_uncovered = is_uncovered || distance(p, s.center) > s.radius + tolerance;
      }
    }
    uncovered.values.push_back(is_uncovered ? 1 : 0);
    uncovered_facets += is_uncovered ? 1 : 0;
  }
  data.point_arrays = {distances};
  data.facet_arrays = {uncovered};
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

/// The table of `morula collide -o FILE.csv`, by frames in the order in which they come.
std::vector<VtpData> read_contacts(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError(fmt::format("{}: cannot be read; --contacts takes the table of morula collide", path));
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> header = cells_of(line);
  const std::vector<std::string> wanted{"x",     "y",           "z",      "normal_x", "normal_y", "normal_z",
                                        "depth", "error_bound", "node_a", "node_b",   "frame_a",  "frame_b"};
  std::vector<std::size_t> columns;
  for (const std::string& name : wanted) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) {
      throw FileError(fmt::format("{}:1: has no column {}; --contacts takes the table of morula collide", path, name));
    }
    columns.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  std::vector<VtpData> frames;
  std::string frame;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    const auto cell = [&](std::size_t column) -> const std::string& {
      if (columns[column] >= cells.size()) throw FileError(fmt::format("{}:{}: the line is cut short", path, number));
      return cells[columns[column]];
    };
    const auto value = [&](std::size_t column) {
      const std::string& text = cell(column);
      double result = 0;
      const std::from_chars_result read = platform::read_number(text.data(), text.data() + text.size(), result);
      if (read.ec != std::errc() || read.ptr != text.data() + text.size() || !std::isfinite(result)) {
        throw FileError(fmt::format("{}:{}: {} is '{}', not a number", path, number, wanted[column], text));
      }
      return result;
    };
    if (const std::string now = cell(10) + '\n' + cell(11); frames.empty() || now != frame) {
      frame = now;
      VtpData& data = frames.emplace_back();
      data.point_arrays = {
          {"normal", {}, 3}, {"depth", {}}, {"error_bound", {}}, {"node_a", {}, 1, true}, {"node_b", {}, 1, true}};
    }
    VtpData& data = frames.back();
    data.points.push_back({value(0), value(1), value(2)});
    for (const std::size_t axis : {3, 4, 5}) data.point_arrays[0].values.push_back(value(axis));
    for (std::size_t k = 1; k < data.point_arrays.size(); ++k) data.point_arrays[k].values.push_back(value(k + 5));
  }
  return frames;
}

/// Files of one kind and the .pvd that lists them.
class Series {
 public:
  Series(fs::path folder, std::string name, double frames_per_second)
      : folder_(std::move(folder)), name_(std::move(name)), frames_per_second_(frames_per_second) {}
  void add(const VtpData& data) {
    const std::string file = fmt::format("{}_{:04}.vtp", name_, entries_.size());
    write_vtp(folder_ / file, data);
    entries_.push_back({static_cast<double>(entries_.size()) / frames_per_second_, file});
  }
  void finish(std::vector<std::string>& written) const {
    if (entries_.empty()) return;
    write_pvd(folder_ / (name_ + ".pvd"), entries_);
    written.push_back(name_ + ".pvd");
  }

 private:
  fs::path folder_;
  std::string name_;
  double frames_per_second_;
  std::vector<PvdEntry> entries_;
};

int paraview_command(const ParaviewArguments& o) {
  if (o.level && o.tree.empty()) throw UsageError("--level belongs to a tree, and none is given");
  require_folder_place(o.output);
  require_not_input_folder(o.output, {o.mesh, o.tree, o.motion, o.contacts});
  Workers workers = make_workers(o.threads);
  const Mesh mesh = load_mesh(o.mesh);
  std::optional<Motion> motion;
  if (!o.motion.empty()) {
    motion.emplace(o.motion, mesh, MotionOptions{.frames_per_second = o.frames_per_second, .animation = 0});
  }
  const std::size_t frame_count = motion ? motion->frame_count() : 1;
  FrameSpheres frames(o, mesh, frame_count, workers);
  std::vector<VtpData> contacts;
  if (!o.contacts.empty()) contacts = read_contacts(o.contacts);

  std::vector<std::string> written;
  std::size_t uncovered_facets = 0, uncovered_frames = 0, spheres = 0;
  WholeFolder folder(o.output, WholeFolder::Mode::merge);
  {
    Series surface(folder.path(), "surface", o.frames_per_second), balls(folder.path(), "spheres", o.frames_per_second),
        touches(folder.path(), "contacts", o.frames_per_second);
    Progress progress("writing");
    for (std::size_t i = 0; i < frame_count; ++i) {
      progress.update(static_cast<double>(i) / static_cast<double>(frame_count));
      VtpData data;
      data.points = motion ? motion->frame(i) : mesh.positions;
      data.facets = mesh.facets;
      if (frames.any()) {
        const SphereTree tree = frames.at(i, data.points, motion ? motion->frame_name(i) : o.mesh);
        if (o.level && *o.level >= tree.level_count()) {
          throw UsageError(fmt::format("--level {}: the tree has levels 0 to {}", *o.level, tree.level_count() - 1));
        }
        const std::size_t level = o.level.value_or(tree.level_count() - 1);
        std::vector<std::uint32_t> nodes = level_set(tree, level);
        std::vector<Sphere> shown;
        for (const std::uint32_t node : nodes) shown.push_back(tree.spheres[node]);
        const std::size_t before = uncovered_facets;
        add_cover(data, shown, uncovered_facets);
        uncovered_frames += uncovered_facets > before ? 1 : 0;
        if (!o.level) {
          nodes.resize(tree.node_count());
          for (std::uint32_t node = 0; node < nodes.size(); ++node) nodes[node] = node;
        }
        spheres = nodes.size();
        balls.add(spheres_data(tree, nodes));
      }
      surface.add(data);
    }
    for (const VtpData& frame : contacts) touches.add(frame);
    surface.finish(written);
    balls.finish(written);
    touches.finish(written);
  }
  folder.commit();
  note_written(o.output);
  if (o.json) {
    Json json{{"mesh", o.mesh}, {"output", o.output}, {"files", written}, {"frames", frame_count}};
    json["spheres"] = frames.any() ? Json(spheres) : Json(nullptr);
    json["uncovered_facets"] = frames.any() ? Json(uncovered_facets) : Json(nullptr);
    json["uncovered_frames"] = frames.any() ? Json(uncovered_frames) : Json(nullptr);
    print_json(json);
    return exit_done;
  }
  fmt::print("{}: {}\n", o.output, counted(frame_count, "frame"));
  if (frames.any()) {
    fmt::print("spheres    {} a frame\n", spheres);
    fmt::print("uncovered  {}\n", uncovered_facets == 0 ? "nothing: every facet is covered in every frame"
                                                        : fmt::format("{} in {}", counted(uncovered_facets, "facet"),
                                                                      counted(uncovered_frames, "frame")));
  }
  for (const std::string& file : written) fmt::print("written    {}\n", (fs::path(o.output) / file).string());
  return exit_done;
}

}  // namespace

void add_paraview(CLI::App& app, Run& run) {
  auto o = std::make_shared<ParaviewArguments>();
  CLI::App* command = add_command(app, "paraview", "Write a surface, its spheres and contacts for ParaView");
  add_option(*command, "MESH", o->mesh, "Mesh at rest: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "TREE", o->tree, "Its tree, balls (.ply), or the spheres of all frames (.npz of morula update)")
      ->type_name("");
  add_option(*command, "MOTION", o->motion, fmt::format("Positions: {}", motion_kinds()))->type_name("");
  add_option(*command, "-o,--output", o->output, "Folder for surface.pvd, spheres.pvd, contacts.pvd and their frames")
      ->type_name("DIR")
      ->required();
  add_option(*command, "--level", o->level,
             "Level of the spheres, and of the uncovered surface; default: all, and the last")
      ->type_name("N")
      ->transform(whole_number());
  add_option(*command, "--contacts", o->contacts, "Contact table of morula collide -o")->type_name("CSV");
  add_option(*command, "--fps", o->frames_per_second, "Frames per second, for the times in the .pvd")
      ->type_name("X")
      ->transform(number_above_zero())
      ->capture_default_str();
  add_sph_origin(*command, o->sph_origin);
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Example:\n"
             "  morula paraview limb.obj limb.morula motion -o limb\n"
             "  morula paraview limb.obj spheres.npz motion -o limb --contacts contacts.csv");
  on_use(*command, [o, &run] { run = [o] { return paraview_command(*o); }; });
}

}  // namespace morula::cli
