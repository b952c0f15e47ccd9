// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula pairs: features of a mesh that cross, are near, or may meet within a step.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <morula/geometry/connectivity.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <optional>
#include <toolbox/csv.hpp>
#include <toolbox/stopwatch.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

struct PairsArguments {
  std::string from, to;
  bool swept = false, crossing = false, candidates = false;
  std::optional<double> within;
  double distance = 0;
  bool with_self = false, once = false, weld = false;
  std::uint32_t rings = 0;
  double rest_distance = 0;
  std::string rest;
  std::string output;
  unsigned threads = 0;
  bool json = false;
};

/// A pair and its distance or time; none where there is neither.
struct Row {
  FeaturePair pair;
  std::optional<double> value{};
};

struct Found {
  std::vector<Row> rows;
  SurfaceQueryStatus status;
  double microseconds = 0;
};

/// A pose of a mesh; weld: null if the mesh was not welded.
Mesh read_pose(const std::string& path, const Mesh& rest, const std::string& rest_path, const MeshWeld* weld) {
  Mesh mesh = load_mesh(path);
  if (weld != nullptr && mesh.vertex_count() == weld->new_vertex.size()) {
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      const std::uint32_t first = weld->old_vertex[weld->new_vertex[v]];
      if (mesh.positions[v] != mesh.positions[first])
        throw UsageError(
            fmt::format("{}: vertices {} and {} are merged, but they are at different positions; leave out --weld",
                        path, first, v));
    }
    mesh = welded(mesh, *weld);
  }
  if (mesh.facets != rest.facets || mesh.positions.size() != rest.positions.size())
    throw UsageError(fmt::format("{} and {} are not the same mesh: vertices or facets differ", rest_path, path));
  return mesh;
}

template <class Query>
Found run_query(Query& query, const SurfaceTree& tree, Workers& workers) {
  toolbox::Stopwatch watch;
  Found found;
  found.status = query.run(tree, workers);
  found.microseconds = 1e6 * watch.lap();
  if (!found.status) throw UsageError(message(found.status));
  return found;
}

Found find_pairs(const PairsArguments& o, const SurfaceTree& tree, Workers& workers) {
  const PairFilter filter{.rings = o.rings, .rest_distance = o.rest_distance, .same_component = !o.with_self};
  if (o.crossing) {
    SurfaceCrossingQuery query({.filter = filter});
    Found found = run_query(query, tree, workers);
    for (const FeaturePair& pair : query.pairs()) found.rows.push_back({pair});
    return found;
  }
  if (o.within) {
    ProximityQuery query({.distance = *o.within, .nearest_features_once = o.once, .filter = filter});
    Found found = run_query(query, tree, workers);
    for (const ProximityPair& pair : query.pairs()) found.rows.push_back({pair, pair.distance});
    return found;
  }
  SweptQuery query({.distance = o.distance, .candidates_only = o.candidates, .filter = filter});
  Found found = run_query(query, tree, workers);
  for (const SweptPair& pair : query.pairs()) found.rows.push_back({pair, pair.time});
  for (const FeaturePair& pair : query.candidates()) found.rows.push_back({pair});
  if (o.candidates)
    std::sort(found.rows.begin(), found.rows.end(), [](const Row& p, const Row& q) { return p.pair < q.pair; });
  return found;
}

std::string csv(const SurfaceTree& tree, const std::vector<Row>& rows) {
  std::string text = "kind,a0,a1,a2,b0,b1,b2,distance_or_time\n";
  const auto out = std::back_inserter(text);
  for (const auto& [pair, value] : rows) {
    const auto facet = [&](std::uint32_t f) {
      const Facet& v = tree.facets()[f];
      fmt::format_to(out, ",{},{},{}", v[0], v[1], v[2]);
    };
    if (pair.kind == PairKind::vertex_facet) {
      fmt::format_to(out, "vf,{},,", pair.a);
      facet(pair.b);
    } else if (pair.kind == PairKind::edge_edge) {
      const auto &a = tree.edges()[pair.a], &b = tree.edges()[pair.b];
      fmt::format_to(out, "ee,{},{},,{},{},", a[0], a[1], b[0], b[1]);
    } else {
      text += "ff";
      facet(pair.a);
      facet(pair.b);
    }
    text += value ? ',' + exact_digits(*value) + '\n' : ",\n";
  }
  return text;
}

struct Summary {
  std::size_t vertex_facet = 0, edge_edge = 0, facet_facet = 0;
  std::optional<double> least;
};

Summary summary(const std::vector<Row>& rows) {
  Summary s;
  for (const auto& [pair, value] : rows) {
    ++(pair.kind == PairKind::vertex_facet ? s.vertex_facet
       : pair.kind == PairKind::edge_edge  ? s.edge_edge
                                           : s.facet_facet);
    if (value) s.least = std::min(s.least.value_or(*value), *value);
  }
  return s;
}

void print_text(const PairsArguments& o, const SurfaceTree& tree, const Found& found) {
  const Summary s = summary(found.rows);
  fmt::print("{}: {} vertices, {} facets, {} edges\n\n", o.from, tree.vertex_count(), tree.facets().size(),
             tree.edges().size());
  Table table({"pairs", "number"}, 1);
  if (o.crossing) {
    table.add({"facets that cross", std::to_string(s.facet_facet)});
  } else {
    table.add({"vertex and facet", std::to_string(s.vertex_facet)});
    table.add({"edge and edge", std::to_string(s.edge_edge)});
  }
  table.add({"compared (boxes near, not left out)", std::to_string(found.status.candidates)});
  fmt::print("{}", table.text());
  if (o.within)
    fmt::print("{}\n", s.least ? fmt::format("nearest: {}", figure(*s.least))
                               : fmt::format("nothing is within {}", figure(*o.within)));
  if (o.swept && !o.candidates)
    fmt::print("{}\n",
               s.least ? fmt::format("no impact before {:.6g} of the step", *s.least) : "no impact in the whole step");
  fmt::print("query: {:.0f} µs\n", found.microseconds);
  if (!o.with_self &&
      components_by_vertices(MeshView(PositionView(std::vector<Vec3>(tree.vertex_count())), tree.facets())).count == 1)
    note("{} is one component, and pairs within a component are skipped: add --self", o.from);
}

void print_json_report(const PairsArguments& o, const SurfaceTree& tree, const Found& found) {
  const Summary s = summary(found.rows);
  Json json{{"from", o.from}};
  if (!o.to.empty()) json["to"] = o.to;
  json["query"] = o.crossing ? "crossing" : o.within ? "within" : "swept";
  json["vertices"] = tree.vertex_count();
  json["facets"] = tree.facets().size();
  json["edges"] = tree.edges().size();
  json["duplicate_vertices"] = tree.duplicate_vertices();
  if (o.crossing) {
    json["facet_facet"] = s.facet_facet;
  } else {
    json["vertex_facet"] = s.vertex_facet;
    json["edge_edge"] = s.edge_edge;
  }
  json["candidates"] = found.status.candidates;
  json["box_tests"] = found.status.box_tests;
  if (o.within) {
    json["distance"] = *o.within;
    json["least_distance"] = s.least ? Json(*s.least) : Json();
  }
  if (o.swept && !o.candidates) json["collision_free_step"] = s.least.value_or(1);
  json["microseconds"] = found.microseconds;
  print_json(json);
}

/// For queries within components: corners that only touch are found at distance 0, though the surface is whole there,
/// unless their distance at rest leaves them out.
void note_corners_apart(const PairsArguments& o, const SurfaceTree& tree) {
  if (o.with_self && o.rest_distance == 0) note_duplicate_vertices(o.from, tree.duplicate_vertices(), o.weld);
}

int pairs_command(const PairsArguments& o) {
  if (int{o.swept} + int{o.crossing} + int{o.within.has_value()} != 1)
    throw UsageError("give one of --swept, --within LENGTH and --crossing");
  if (o.swept == o.to.empty())
    throw UsageError(o.swept
                         ? "--swept needs two meshes: where the step begins and where it ends"
                         : fmt::format("{}: a second mesh is the end of a step; add --swept, or leave it out", o.to));
  if ((o.candidates || o.distance > 0) && !o.swept)
    throw UsageError("--candidates and --distance belong to --swept: add it");
  if (o.once && !o.within) throw UsageError("--once belongs to --within LENGTH: add it");
  if (!o.rest.empty() && o.rest_distance == 0) throw UsageError("--rest belongs to --rest-distance LENGTH: add it");
  if (!o.output.empty()) {
    if (extension(o.output) != ".csv") throw UsageError(fmt::format("-o {}: pairs are written as .csv", o.output));
    require_output_place(o.output);
    require_not_input(o.output, {o.from, o.to, o.rest});
  }
  Workers workers = make_workers(o.threads);
  const LoadedMesh loaded = load_mesh(o.from, o.weld);
  const Mesh& from = loaded.mesh;
  const MeshWeld* const merged = loaded.merged();
  const Mesh to = o.to.empty() ? Mesh{} : read_pose(o.to, from, o.from, merged);
  SurfaceTree tree(o.rest.empty() ? from : read_pose(o.rest, from, o.from, merged));
  note_corners_apart(o, tree);
  const PositionView from_view(from.positions), to_view(to.positions);
  const Status moved = o.swept ? tree.update(from_view, to_view, workers) : tree.update(from_view, workers);
  if (!moved) throw UsageError(fmt::format("{}: {}", o.to.empty() ? o.from : o.to, message(moved)));
  const Found found = find_pairs(o, tree, workers);
  if (!o.output.empty()) {
    write_whole(o.output, csv(tree, found.rows));
    note_written(o.output);
  }
  if (o.json) {
    print_json_report(o, tree, found);
  } else {
    print_text(o, tree, found);
  }
  return exit_done;
}

}  // namespace

void add_pairs(CLI::App& app, Run& run) {
  auto o = std::make_shared<PairsArguments>();
  CLI::App* command = add_command(app, "pairs", "Features of a mesh that cross, are near, or may meet within a step");
  add_option(*command, "FROM", o->from, "Mesh of one or several components: " + readable_mesh_extensions())
      ->required()
      ->type_name("");
  add_option(*command, "TO", o->to, "The same mesh at the end of a step; vertices move on straight lines")
      ->type_name("");
  add_flag(*command, "--swept", o->swept, "Pairs of vertex and facet, edge and edge, that may meet on the way to TO");
  add_option(*command, "--within", o->within, "Pairs of vertex and facet, edge and edge, at most this far apart")
      ->type_name("LENGTH")
      ->transform(real_number(0));
  add_flag(*command, "--crossing", o->crossing, "Pairs of facets that intersect");
  add_flag(*command, "--self", o->with_self, "Also pairs within a component, unless they share a vertex");
  add_weld(*command, o->weld, "FROM, and of TO and of --rest with it,");
  add_option(*command, "--rings", o->rings, "Skip pairs within a component that are at most this many edges apart")
      ->type_name("N")
      ->transform(whole_number(0, 8));
  add_option(*command, "--rest-distance", o->rest_distance, "Skip pairs that are at most this far apart at rest")
      ->type_name("LENGTH")
      ->transform(real_number(0));
  add_option(*command, "--rest", o->rest, "The mesh at rest, for --rest-distance; default: FROM")->type_name("MESH");
  add_option(*command, "--distance", o->distance, "With --swept: distance that counts as an impact; default: 0")
      ->type_name("LENGTH")
      ->transform(real_number(0));
  add_flag(*command, "--candidates", o->candidates, "With --swept: all pairs whose swept boxes meet, without times");
  add_flag(*command, "--once", o->once, "With --within: each pair of nearest features once");
  add_option(*command, "-o,--output", o->output, "The pairs, by vertices, as FILE.csv")->type_name("FILE");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(
      *command,
      "Rows are kind,a0,a1,a2,b0,b1,b2,distance_or_time: vf has one vertex and three of a facet, ee two and two, ff\n"
      "three and three. A time is a share of the step, and never later than the impact.\n"
      "\n"
      "Example:\n"
      "  morula pairs cloth0.ply cloth1.ply --swept --self -o pairs.csv\n"
      "  morula pairs hand.obj --within 0.002 --self --rings 2 -o near.csv");
  on_use(*command, [o, &run] { run = [o] { return pairs_command(*o); }; });
}

}  // namespace morula::cli
