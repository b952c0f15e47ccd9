// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>
#include <toolbox/csv.hpp>
#include <toolbox/stopwatch.hpp>

#include "commands/collide/report.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/extension.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

/// Everything that is printed and written, frame by frame: patches are valid until the next run only.
struct PatchReport {
  Table table{{"frame of A", "frame of B", "patch", "volume", "depth", "mean depth", "normal", "centroid", "points"},
              2};
  std::string rows =
      "frame_a,frame_b,patch,volume,depth,mean_depth,normal_x,normal_y,normal_z,centroid_x,centroid_y,centroid_z,"
      "area_a,area_b,force_x,force_y,force_z,points\n";
  Json frames = Json::array();
  std::vector<double> microseconds;
  std::size_t overlapping = 0, uncertified = 0;
};

void require_closed(const Side& side) {
  const MeshReport report = inspect(side.mesh());
  std::string fault;
  if (!report.closed) {
    fault =
        fmt::format("open ({}): morula repair merges equal vertices, and with --cap N closes holes", why_open(report));
  } else if (!report.oriented) {
    fault = fmt::format("not oriented ({}): morula repair turns its facets",
                        counted(report.misoriented_edges, "misoriented edge"));
  } else if (report.volume < 0) {
    fault = fmt::format("inside out (volume {}): morula repair turns its facets", figure(report.volume));
  }
  if (!fault.empty()) throw UsageError(fmt::format("--patches needs closed bodies, but {} is {}", side.name(), fault));
}

std::string patch_vector_text(const Vec3& v) {
  return fmt::format("{} {} {}", figure(v.x), figure(v.y), figure(v.z));
}

Json patch_side_json(const PatchSide& side) {
  return {{"area", side.area},
          {"area_vector", vec3_json(side.area_vector)},
          {"moment", vec3_json(side.moment)},
          {"facets", side.facets.size()}};
}

Json patch_json(const ContactPatch& p) {
  Json json{{"id", p.id},
            {"volume", p.volume},
            {"depth", p.depth},
            {"mean_depth", p.mean_depth},
            {"normal", vec3_json(p.normal)},
            {"centroid", vec3_json(p.centroid)},
            {"crossing_count", p.crossing_count},
            {"a", patch_side_json(p.a)},
            {"b", patch_side_json(p.b)},
            {"points", Json::array()}};
  for (const PatchPoint& point : p.points)
    json["points"].push_back({{"id", point.id},
                              {"point", vec3_json(point.point)},
                              {"force", vec3_json(point.force)},
                              {"volume", point.volume},
                              {"depth", point.depth},
                              {"on_a", surface_point_json(point.on_a)},
                              {"on_b", surface_point_json(point.on_b)}});
  return json;
}

void add_patch_frame(PatchReport& report, const std::string& name_a, const std::string& name_b,
                     const ContactPatchQuery& query) {
  Json frame{{"a", name_a},
             {"b", name_b},
             {"volume", query.volume()},
             {"certified", query.certified()},
             {"microseconds", report.microseconds.back()},
             {"patches", Json::array()}};
  for (const ContactPatch& p : query.patches()) {
    report.table.add({name_a, name_b, std::to_string(p.id), figure(p.volume), figure(p.depth), figure(p.mean_depth),
                      patch_vector_text(p.normal), patch_vector_text(p.centroid), std::to_string(p.points.size())});
    fmt::format_to(std::back_inserter(report.rows), "{},{},{},{},{},{},{},{},{},{},{},{}\n", toolbox::csv_cell(name_a),
                   toolbox::csv_cell(name_b), p.id, exact_digits(p.volume), exact_digits(p.depth),
                   exact_digits(p.mean_depth), vec3_csv(p.normal), vec3_csv(p.centroid), exact_digits(p.a.area),
                   exact_digits(p.b.area), vec3_csv(-p.a.area_vector), p.points.size());
    frame["patches"].push_back(patch_json(p));
  }
  if (query.patches().empty()) report.table.add({name_a, name_b, "-", "0", "-", "-", "-", "-", "0"});
  report.frames.push_back(std::move(frame));
  report.overlapping += query.patches().empty() ? 0 : 1;
  report.uncertified += query.certified() ? 0 : 1;
}

/// b: a itself for patches of one body. view: null without a page.
PatchReport patches_of_frames(Side& a, Side& b, CollideView* view, Workers& workers) {
  PatchReport report;
  CrossingQuery crossed;
  const bool is_one = &a == &b;
  ContactPatchQuery query = is_one ? ContactPatchQuery(a.collider()) : ContactPatchQuery(a.collider(), b.collider());
  const std::size_t count = std::max(a.frame_count(), b.frame_count());
  Progress progress("colliding");
  for (std::size_t frame = 0; frame < count; ++frame) {
    progress.update(static_cast<double>(frame) / static_cast<double>(count));
    a.move_to(frame, workers);
    if (!is_one) b.move_to(frame, workers);
    toolbox::Stopwatch watch;
    const Status status = query.run();
    report.microseconds.push_back(1e6 * watch.lap());
    if (status.code == Status::Code::inside_out) {
      const Side& side = status.body == 0 ? a : b;
      throw UsageError(
          fmt::format("{}: {} is inside out where it meets the other body: morula repair turns facets of a "
                      "mesh, and a motion must not mirror it",
                      side.frame_name(frame), side.name()));
    }
    if (!status) throw UsageError(message(status));
    add_patch_frame(report, a.frame_name(frame), b.frame_name(frame), query);
    if (view == nullptr) continue;
    // Of one body, facets that share a vertex would be among the pairs.
    if (is_one) {
      view->end_frame_with_patches(a.frame_name(frame), query.patches(), {});
      continue;
    }
    if (const Status crossings = crossed.run(a.collider(), b.collider()); !crossings)
      throw UsageError(message(crossings));
    view->end_frame_with_patches(a.frame_name(frame) + ", " + b.frame_name(frame), query.patches(), crossed.pairs());
  }
  return report;
}

}  // namespace

int collide_patches(const PatchRun& run) {
  const std::vector<Rule> rules = parse_rules(run.rule);
  require_position_rules(rules);
  if (!run.output.empty()) {
    if (extension(run.output) != ".csv")
      throw UsageError(fmt::format("-o {}: patches are written as .csv", run.output));
    require_output_place(run.output);
    require_not_input(run.output, {run.a.mesh, run.a.tree, run.a.motion, run.b.mesh, run.b.tree, run.b.motion});
  }
  if (!run.page.empty())
    collide_views().require(run.page, {run.a.mesh, run.a.tree, run.a.motion, run.b.mesh, run.b.tree, run.b.motion});
  Workers workers = make_workers(run.threads);
  Side a(run.a, run.sph_origin, workers);
  std::optional<Side> other;
  if (!run.b.mesh.empty()) other.emplace(run.b, run.sph_origin, workers);
  Side& b = other ? *other : a;
  require_closed(a);
  if (other) require_closed(b);
  a.prepare(rules, workers);
  if (other) b.prepare(rules, workers);
  std::unique_ptr<CollideView> view;
  if (!run.page.empty() && other)
    view = collide_views().make(a.stem() + " and " + b.stem(), {&a.collider(), &b.collider()}, run.rule);
  if (!run.page.empty() && !other) view = collide_views().make(a.stem(), {&a.collider()}, run.rule);
  const PatchReport report = patches_of_frames(a, b, view.get(), workers);
  if (!run.output.empty()) {
    write_whole(run.output, report.rows);
    note_written(run.output);
  }
  if (view) {
    write_whole(run.page, view->text());
    note_written(run.page);
  }
  if (run.json) {
    print_json({{"a", a.name()},
                {"b", b.name()},
                {"rule", run.rule},
                {"threads", workers.thread_count()},
                {"frames", report.frames}});
    return exit_done;
  }
  fmt::print("{}\nsummary   {} of {} have patches; {} µs per frame (median)\n", report.table.text(), report.overlapping,
             counted(report.microseconds.size(), "frame"), figure(median(report.microseconds)));
  if (report.uncertified > 0)
    fmt::print("note      patches may be missing in {}: spheres of the rule {} do not cover\n",
               counted(report.uncertified, "frame"), run.rule);
  fmt::print("{}", built_tree_note(a.tree_was_built(), other && b.tree_was_built()));
  for (const std::string& file : {run.output, run.page})
    if (!file.empty()) fmt::print("written   {}\n", file);
  return exit_done;
}

}  // namespace morula::cli
