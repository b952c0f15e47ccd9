// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <toolbox/csv.hpp>
#include <toolbox/stopwatch.hpp>

#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/plots.hpp"
#include "shared/table.hpp"

namespace morula::cli {

Json vec3_json(const Vec3& v) {
  return {v.x, v.y, v.z};
}

Json surface_point_json(const SurfacePoint& p) {
  return {{"facet", p.facet}, {"barycentric", p.barycentric}, {"point", vec3_json(p.point)}};
}

std::string vec3_csv(const Vec3& v) {
  return fmt::format("{},{},{}", exact_digits(v.x), exact_digits(v.y), exact_digits(v.z));
}

std::string built_tree_note(bool built_a, bool built_b) {
  if (!built_a && !built_b) return {};
  return fmt::format("note      no tree given for {}: built in quality fast; morula build makes a tighter one\n",
                     built_a && built_b ? "A and B"
                     : built_a          ? "A"
                                        : "B");
}

namespace {

std::string state_of(const CollidedFrame& frame) {
  if (frame.finished) return frame.contacts.empty() ? "apart" : "finished";
  return fmt::format("stopped at level {}", frame.achieved_level);
}

Json contact_json(const Contact& c, const ContactSurface* s) {
  Json json{{"node_a", c.node_a},
            {"node_b", c.node_b},
            {"finished", c.finished},
            {"point", vec3_json(c.point)},
            {"normal", vec3_json(c.normal)},
            {"depth", c.depth},
            {"lens_volume", c.lens_volume},
            {"error_bound", c.error_bound}};
  if (s == nullptr) return json;  // the budget ended before
  json["surface_normal"] = vec3_json(s->normal);
  json["surface_depth"] = s->depth;
  json["on_a"] = surface_point_json(s->on_a);
  json["on_b"] = surface_point_json(s->on_b);
  return json;
}

std::string surface_point_csv(const SurfacePoint& p) {
  const Barycentric& b = p.barycentric;
  return fmt::format("{},{},{},{}", p.facet, exact_digits(b[0]), exact_digits(b[1]), exact_digits(b[2]));
}

std::string frame_cells(const CollidedFrame& frame) {
  return toolbox::csv_cell(frame.name_a) + ',' + toolbox::csv_cell(frame.name_b);
}

}  // namespace

double CollidedFrame::deepest() const {
  double deepest = 0;
  for (const ContactSurface& s : surfaces) deepest = std::max(deepest, s.depth);
  return deepest;
}

std::string collide_text(const CollideRun& run, const std::vector<CollidedFrame>& frames) {
  std::vector<std::string> header{"frame of A", "frame of B", "contacts", "deepest", "pair tests", "µs"};
  if (run.find_crossings) header.insert(header.end(), {"facet pairs", "µs"});
  header.emplace_back("state");
  Table table(header, 2);
  std::size_t touching = 0, crossing = 0, stopped = 0;
  std::vector<double> microseconds;
  for (const CollidedFrame& f : frames) {
    std::vector<std::string> cells{f.name_a,
                                   f.name_b,
                                   std::to_string(f.contacts.size()),
                                   figure(f.deepest()),
                                   std::to_string(f.pair_tests),
                                   figure(f.microseconds)};
    if (run.find_crossings)
      cells.insert(cells.end(), {std::to_string(f.crossings.size()), figure(f.crossings_microseconds)});
    cells.push_back(state_of(f));
    table.add(std::move(cells));
    touching += f.contacts.empty() ? 0 : 1;
    crossing += f.crossings.empty() ? 0 : 1;
    stopped += f.finished ? 0 : 1;
    microseconds.push_back(f.microseconds);
  }
  std::string text = table.text() + '\n';
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "summary   {} of {} have contacts; {} µs per frame (median), {}\n", touching,
                 counted(frames.size(), "frame"), figure(median(microseconds)), counted(run.threads, "thread"));
  if (run.find_crossings) {
    fmt::format_to(out, "crossings the surfaces cross in {} of {}\n", crossing, counted(frames.size(), "frame"));
  }
  if (stopped > 0) {
    fmt::format_to(out,
                   "budget    {} ended {} early: no crossing is missed, but contacts marked unfinished may be none\n",
                   run.budget, counted(stopped, "frame"));
  }
  text += built_tree_note(run.built_a, run.built_b);
  if (!run.output.empty()) fmt::format_to(out, "written   {}\n", run.output);
  if (!run.page.empty()) fmt::format_to(out, "written   {}: open it in a browser\n", run.page);
  return text;
}

toolbox::Plot collide_plot(const CollideRun& run, const std::vector<CollidedFrame>& frames) {
  toolbox::Plot plot{.title = fmt::format("{} and {}", run.mesh_a, run.mesh_b), .x_label = "frame", .panels = {}};
  const auto add = [&](const std::string& name, const std::string& unit, const auto& figure_of) {
    std::vector<std::optional<double>> values;
    for (const CollidedFrame& frame : frames) values.push_back(static_cast<double>(figure_of(frame)));
    const std::size_t color = plot.panels.size();
    plot.panels.push_back({.label = name + unit, .lines = {line_over_frames(name, std::move(values), color)}});
  };
  add("contacts", "", [](const CollidedFrame& f) { return f.contacts.size(); });
  add("deepest", ", mesh units", [](const CollidedFrame& f) { return f.deepest(); });
  add("pair tests", "", [](const CollidedFrame& f) { return f.pair_tests; });
  if (run.find_crossings) add("facet pairs", "", [](const CollidedFrame& f) { return f.crossings.size(); });
  return plot;
}

Json collide_json(const CollideRun& run, const std::vector<CollidedFrame>& frames) {
  Json json{
      {"a", run.mesh_a}, {"b", run.mesh_b}, {"rule", run.rule}, {"threads", run.threads}, {"frames", Json::array()}};
  if (!run.budget.empty()) json["budget"] = run.budget;
  if (!run.page.empty()) json["page"] = run.page;
  for (const CollidedFrame& f : frames) {
    Json frame{{"a", f.name_a},
               {"b", f.name_b},
               {"finished", f.finished},
               {"achieved_level", f.achieved_level},
               {"pair_tests", f.pair_tests},
               {"microseconds", f.microseconds},
               {"contacts", Json::array()}};
    for (std::size_t i = 0; i < f.contacts.size(); ++i)
      frame["contacts"].push_back(contact_json(f.contacts[i], i < f.surfaces.size() ? &f.surfaces[i] : nullptr));
    if (run.find_crossings) {
      frame["crossings_microseconds"] = f.crossings_microseconds;
      frame["facet_pairs"] = Json::array();
      for (const Crossing& c : f.crossings)
        frame["facet_pairs"].push_back({{"facet_a", c.facet_a},
                                        {"facet_b", c.facet_b},
                                        {"from", vec3_json(c.segment.from)},
                                        {"to", vec3_json(c.segment.to)}});
    }
    json["frames"].push_back(std::move(frame));
  }
  return json;
}

std::string contacts_csv(const std::vector<CollidedFrame>& frames) {
  std::string text =
      "frame_a,frame_b,node_a,node_b,finished,x,y,z,normal_x,normal_y,normal_z,depth,lens_volume,error_bound,"
      "surface_normal_x,surface_normal_y,surface_normal_z,surface_depth,"
      "facet_a,a0,a1,a2,facet_b,b0,b1,b2\n";
  for (const CollidedFrame& f : frames)
    for (std::size_t i = 0; i < f.contacts.size(); ++i) {
      const Contact& c = f.contacts[i];
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},", frame_cells(f), c.node_a, c.node_b,
                     c.finished ? 1 : 0, vec3_csv(c.point), vec3_csv(c.normal), exact_digits(c.depth),
                     exact_digits(c.lens_volume), exact_digits(c.error_bound));
      if (i >= f.surfaces.size()) {  // the budget ended before
        text += ",,,,,,,,,,,\n";
        continue;
      }
      const ContactSurface& s = f.surfaces[i];
      fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", vec3_csv(s.normal), exact_digits(s.depth),
                     surface_point_csv(s.on_a), surface_point_csv(s.on_b));
    }
  return text;
}

std::string crossings_csv(const std::vector<CollidedFrame>& frames) {
  std::string text = "frame_a,frame_b,facet_a,facet_b,from_x,from_y,from_z,to_x,to_y,to_z\n";
  for (const CollidedFrame& f : frames)
    for (const Crossing& c : f.crossings)
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", frame_cells(f), c.facet_a, c.facet_b,
                     vec3_csv(c.segment.from), vec3_csv(c.segment.to));
  return text;
}

}  // namespace morula::cli
