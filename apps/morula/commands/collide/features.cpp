// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <toolbox/csv.hpp>
#include <toolbox/stopwatch.hpp>

#include "commands/collide/moving_surface.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

struct SurfacePair {
  const MovingSurface *a, *b;  // the same: with itself
  char letter_a, letter_b;
};

struct FeatureFrame {
  std::size_t facets = 0, vertex_facet = 0, edge_edge = 0;
  std::optional<double> nearest{};
  double microseconds = 0;
};

std::string feature(const SurfaceTree& tree, bool is_vertex, bool is_edge, std::uint32_t number) {
  if (is_vertex) return fmt::format("{},,", number);
  if (is_edge) return fmt::format("{},{},", tree.edges()[number][0], tree.edges()[number][1]);
  const Facet& f = tree.facets()[number];
  return fmt::format("{},{},{}", f[0], f[1], f[2]);
}

void add_row(std::string& text, std::size_t frame, const SurfacePair& surfaces, const FeaturePair& pair,
             const std::string& distance) {
  const bool is_edges = pair.kind == PairKind::edge_edge;
  const char* const kind = pair.kind == PairKind::facet_facet    ? "ff"
                           : is_edges                            ? "ee"
                           : pair.kind == PairKind::facet_vertex ? "fv"
                                                                 : "vf";
  fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", frame, surfaces.letter_a, surfaces.letter_b, kind,
                 feature(surfaces.a->tree(), pair.kind == PairKind::vertex_facet, is_edges, pair.a),
                 feature(surfaces.b->tree(), pair.kind == PairKind::facet_vertex, is_edges, pair.b), distance);
}

}  // namespace

int collide_features(const FeatureRun& run) {
  if (!run.output.empty()) {
    if (extension(run.output) != ".csv") throw UsageError(fmt::format("-o {}: pairs are written as .csv", run.output));
    require_output_place(run.output);
    require_not_input(run.output, {run.a.mesh, run.a.motion, run.b.mesh, run.b.motion});
  }
  Workers workers = make_workers(run.threads);
  MovingSurface a(run.a);
  std::optional<MovingSurface> b;
  if (!run.b.mesh.empty()) b.emplace(run.b);
  std::vector<SurfacePair> surface_pairs;
  if (run.with_self) {
    note_duplicate_vertices(run.a.mesh, a.tree().duplicate_vertices(), run.a.weld);
    if (b) note_duplicate_vertices(run.b.mesh, b->tree().duplicate_vertices(), run.b.weld);
    surface_pairs.push_back({&a, &a, 'a', 'a'});
  }
  if (b && run.with_self) surface_pairs.push_back({&*b, &*b, 'b', 'b'});
  if (b) surface_pairs.push_back({&a, &*b, 'a', 'b'});

  SurfaceCrossingQuery crossing;
  ProximityQuery near({.distance = run.within.value_or(0)});
  std::string rows = "frame,surface_a,surface_b,kind,a0,a1,a2,b0,b1,b2,distance\n";
  std::vector<FeatureFrame> frames(std::max(a.frame_count(), b ? b->frame_count() : 1));
  {
    Progress progress("colliding");
    for (std::size_t i = 0; i < frames.size(); ++i) {
      progress.update(static_cast<double>(i) / static_cast<double>(frames.size()));
      FeatureFrame& frame = frames[i];
      a.move_to(i, workers);
      if (b) b->move_to(i, workers);
      for (const SurfacePair& surfaces : surface_pairs) {
        const auto run_query = [&](auto& query) {
          toolbox::Stopwatch watch;
          const SurfaceQueryStatus status = surfaces.a == surfaces.b
                                                ? query.run(surfaces.a->tree(), workers)
                                                : query.run(surfaces.a->tree(), surfaces.b->tree(), workers);
          frame.microseconds += 1e6 * watch.lap();
          if (!status) throw UsageError(message(status));
        };
        if (!run.within) {
          run_query(crossing);
          frame.facets += crossing.pairs().size();
          if (!run.output.empty())
            for (const FeaturePair& pair : crossing.pairs()) add_row(rows, i, surfaces, pair, "");
          continue;
        }
        run_query(near);
        for (const ProximityPair& pair : near.pairs()) {
          ++(pair.kind == PairKind::edge_edge ? frame.edge_edge : frame.vertex_facet);
          frame.nearest = std::min(frame.nearest.value_or(pair.distance), pair.distance);
          if (!run.output.empty()) add_row(rows, i, surfaces, pair, exact_digits(pair.distance));
        }
      }
    }
  }
  if (!run.output.empty()) {
    write_whole(run.output, rows);
    note_written(run.output);
  }
  if (run.json) {
    Json json{{"a", run.a.mesh}, {"self", run.with_self}, {"threads", workers.thread_count()}};
    if (b) json["b"] = run.b.mesh;
    if (run.within) json["within"] = *run.within;
    json["frames"] = Json::array();
    for (const FeatureFrame& f : frames) {
      Json frame{{"microseconds", f.microseconds}};
      if (run.within) {
        frame["vertex_facet"] = f.vertex_facet;
        frame["edge_edge"] = f.edge_edge;
        frame["least_distance"] = f.nearest ? Json(*f.nearest) : Json();
      } else {
        frame["facet_pairs"] = f.facets;
      }
      json["frames"].push_back(std::move(frame));
    }
    print_json(json);
    return exit_done;
  }
  Table table(run.within ? std::vector<std::string>{"frame", "vertex and facet", "edge and edge", "nearest", "µs"}
                         : std::vector<std::string>{"frame", "facets that cross", "µs"},
              1);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FeatureFrame& f = frames[i];
    if (run.within) {
      table.add({std::to_string(i), std::to_string(f.vertex_facet), std::to_string(f.edge_edge),
                 f.nearest ? figure(*f.nearest) : "-", figure(f.microseconds)});
    } else {
      table.add({std::to_string(i), std::to_string(f.facets), figure(f.microseconds)});
    }
  }
  fmt::print("{}", table.text());
  if (!run.output.empty()) fmt::print("written   {}\n", run.output);
  return exit_done;
}

}  // namespace morula::cli
