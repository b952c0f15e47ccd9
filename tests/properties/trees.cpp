// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "trees.hpp"

#include <cstdio>
#include <morula/tree/cover.hpp>

#include "covering.hpp"
#include "motions.hpp"
#ifdef MORULA_PROPERTIES_IO
#include <morula/io/tree_file.hpp>
#include <support/scratch_folder.hpp>
#endif

namespace morula::properties {
namespace {

bool same(const SphereTree& a, const SphereTree& b) {
  return a.spheres == b.spheres && a.first_child == b.first_child && a.child_count == b.child_count &&
         a.parent == b.parent && a.level_begin == b.level_begin && a.branching == b.branching;
}
bool same(const Cover& a, const Cover& b) {
  return a.vertex_count == b.vertex_count && a.facet_count == b.facet_count && a.cut_points == b.cut_points &&
         a.patch_facet == b.patch_facet && a.corner_begin == b.corner_begin && a.corners == b.corners &&
         a.region_begin == b.region_begin && a.region_end == b.region_end;
}

// Some spheres smaller, moved, or gone to nothing: what a careless tool might write.
void spoil_spheres(SphereTree& tree, Dice& dice) {
  double largest = 0;
  for (const Sphere& s : tree.spheres) largest = std::max(largest, s.radius);
  for (Sphere& s : tree.spheres) {
    if (dice.chance(0.3)) s.radius *= dice.pick({0.5, 0.9, 1e-3, 1.5});
    if (dice.chance(0.1)) s.center += Vec3{dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(-1, 1)} * largest;
  }
}

// Spheres of any place and size: on vertices, on a lattice, equal ones.
SphereTree strewn(const Mesh& mesh, int branching, int depth, Dice& dice) {
  const Box box = bounding_box(mesh);
  const double size = box.diagonal() > 0 ? box.diagonal() : 1;
  const bool aligned = dice.chance(0.5);
  const double usual = dice.pick({0.125, 0.25, 0.5});
  const auto any_sphere = [&] {
    const Vec3 vertex = mesh.positions[mesh.facets[dice.below(mesh.facet_count())][dice.below(3)]];
    const Vec3 share = aligned ? Vec3{0.25 * dice.between(0, 4), 0.25 * dice.between(0, 4), 0.25 * dice.between(0, 4)}
                               : Vec3{dice.uniform(), dice.uniform(), dice.uniform()};
    const Vec3 inside = box.lower + Vec3{share.x * box.extent().x, share.y * box.extent().y, share.z * box.extent().z};
    return Sphere{dice.chance(0.3) ? vertex : inside, size * (aligned ? usual : dice.uniform(0.05, 0.6))};
  };
  SphereTree tree;
  tree.branching = static_cast<std::uint32_t>(branching);
  tree.append_level({}, std::vector<Sphere>{any_sphere()});
  for (int level = 1; level <= depth; ++level) {
    std::vector<std::uint32_t> counts;
    std::vector<Sphere> spheres;
    for (std::uint32_t node = tree.level_begin[static_cast<std::size_t>(level) - 1]; node < tree.node_count(); ++node) {
      // Leaves may end early.
      counts.push_back(node > 0 && dice.chance(0.2) ? 0 : static_cast<std::uint32_t>(dice.between(1, branching)));
      for (std::uint32_t c = 0; c < counts.back(); ++c) spheres.push_back(any_sphere());
    }
    if (spheres.empty()) break;
    tree.append_level(counts, spheres);
  }
  return tree;
}

std::string sizes(int branching, int depth) {
  return " " + std::to_string(branching) + "/" + std::to_string(depth);
}

// A sphere of somebody else's that contains its region stays as it is, to the bit, and "contains" is worked out in
// double: a corner may be out by the rounding of its three products, the difference and the root.
std::vector<oracle::Ball> with_rounding_of_double(std::vector<oracle::Ball> balls, const Mesh& mesh) {
  double largest = 0;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) largest = std::max(largest, max_norm(mesh.positions[v]));
  for (oracle::Ball& ball : balls) ball.radius += 0x1p-49L * (largest + largest_coordinate(ball.center) + ball.radius);
  return balls;
}

void judge_tree(const Mesh& mesh, const CoveredTree& model, Dice& dice, Record& record) {
  if (record.place.mesh.facets.empty()) record.place.mesh = mesh;
  for (const std::string& fault : validate(mesh, model)) {
    record.fail("validate", fault);
    break;
  }
  const std::vector<std::uint8_t> all(model.tree.node_count(), 1);
  auto balls = balls_of(model.tree.spheres);
  if (model.report.method == "imported") balls = with_rounding_of_double(std::move(balls), mesh);
  judge({mesh, model.tree, model.cover, points_of(mesh.positions), balls, all}, dice, record, {}, "-tree");
}

// Octree, or no builder at all: a millisecond.
Specimen own_tree(std::size_t most_facets, Dice& dice, Record& record) {
  BuildOptions options{.method = Method::octree,
                       .branching = dice.pick({2, 3, 4, 8, 8, 8, 16, 64}),
                       .depth = dice.pick({1, 2, 2, 3, 3, 4})};
  const double most_nodes = dice.chance(0.2) ? 600 : 130;
  int& depth = *options.depth;
  while (depth > 1 && std::pow(options.branching, depth) > most_nodes) --depth;
  if (dice.chance(0.05)) options.spheres = 1 + dice.below(60);
  const auto facets =
      static_cast<std::size_t>(dice.logarithmic(2, static_cast<double>(std::min<std::size_t>(most_facets, 300)) + 1));
  Shape shape = random_shape(dice, facets);
  Specimen s{shape.name, std::move(shape.mesh), nullptr};
  CoveredTree model;
  if (dice.chance(0.4)) {
    s.name += " | strewn" + sizes(options.branching, depth);
    record.place.description += s.name;
    model = cover(s.mesh, strewn(s.mesh, options.branching, depth, dice));
  } else {
    const bool imported = dice.chance(0.2);
    s.name += " | octree" + sizes(options.branching, depth);
    if (options.spheres) s.name += " of " + std::to_string(*options.spheres) + " spheres";
    if (imported) s.name += " imported";
    record.place.description += s.name;
    model = build(s.mesh, options);
    if (imported) {
      SphereTree spoiled = model.tree;
      spoil_spheres(spoiled, dice);
      model = cover(s.mesh, spoiled);
    }
  }
  judge_tree(s.mesh, model, dice, record);
  s.model = std::make_shared<const CoveredTree>(std::move(model));
  return s;
}

// Any of the other generators: tens of milliseconds, most of them per node and not per facet.
Specimen costly_tree(Dice& dice, Record& record) {
  BuildOptions options{.method =
                           dice.pick({Method::grid, Method::grid, Method::hubbard, Method::spawn, Method::medial,
                                      Method::combined, Method::optimized, Method::optimized, Method::optimized})};
  struct Sizes {
    int branching, depth;
  };
  const auto size =
      dice.pick<Sizes>({{2, 1}, {2, 2}, {2, 3}, {2, 4}, {3, 1}, {3, 2}, {4, 1}, {4, 2}, {8, 1}, {8, 1}, {16, 1}});
  options.branching = size.branching;
  int depth = size.depth;
  if (dice.chance(0.03)) options.branching = dice.pick({8, 64}), depth = options.branching == 8 ? 2 : 1;
  options.depth = depth;
  options.seed = 1 + dice.below(3);
  std::size_t most = 60;
  if (options.method == Method::optimized) {
    options.quality = dice.pick({Quality::draft, Quality::fast, Quality::fast, Quality::standard});
    if (options.quality == Quality::standard) most = 12;
  } else if (options.method == Method::combined) {
    most = 16;
  } else if (dice.chance(0.1)) {
    options.optimizer = dice.pick({Optimizer::recenter, Optimizer::simplex, Optimizer::balance});
    most = 16;
  }
  const auto facets = static_cast<std::size_t>(dice.logarithmic(2, static_cast<double>(most) + 1));
  Shape shape = random_shape(dice, facets);
  Specimen s{shape.name + " | " + std::string(name(options.method)), std::move(shape.mesh), nullptr};
  if (options.method == Method::optimized) s.name += " " + std::string(name(options.quality));
  s.name += sizes(options.branching, depth);
  if (options.optimizer != Optimizer::none) s.name += " " + std::string(name(options.optimizer));
  record.place.description += s.name;
  s.model = std::make_shared<const CoveredTree>(build(s.mesh, options));
  judge_tree(s.mesh, *s.model, dice, record);
  return s;
}

Box used_box(const Mesh& mesh) {
  Box box;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) box.add(mesh.positions[v]);
  return box;
}

// Half of the bodies are a few hundred to a few thousand roundings of their coordinates in size, where allowances
// count; half of all have coordinates up to the ends of the range that build() takes.
std::string take_far_away(Mesh& mesh, Dice& dice) {
  const double own = max_norm(used_box(mesh).extent()), size = own > 0 ? own : 1;
  const double away = std::exp2(dice.chance(0.6) ? dice.uniform(40, 47) : dice.uniform(0, 54));
  const Vec3 way = dice.chance(0.3) ? dice.pick<Vec3>({{1, 0, 0}, {0, -1, 0}, {1, 1, 1}, {1, -1, 0.5}})
                                    : Vec3{dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(-1, 1)};
  shift(mesh.positions, way * (size * away));
  const double largest = largest_coordinate(used_box(mesh));
  if (largest > 0 && (dice.chance(0.5) || largest < 0x1p-99 || largest > 0x1p99))
    scale(mesh.positions, std::exp2(dice.chance(0.3) ? dice.pick({-99.0, 99.9}) : dice.uniform(-99, 99.9)) / largest);
  char text[64];
  std::snprintf(text, sizeof text, ", %.2g of its sizes away", away);
  return text;
}

BuildOptions far_options(Method method, Dice& dice) {
  BuildOptions options{.method = method};
  struct Sizes {
    int branching, depth;
  };
  const auto size = dice.pick<Sizes>({{2, 2}, {2, 3}, {2, 4}, {3, 2}, {3, 3}, {4, 2}, {4, 2}, {8, 1}, {8, 2}, {16, 1}});
  options.branching = size.branching;
  options.depth = size.depth;
  options.nested = dice.chance(0.1);
  options.seed = 1 + dice.below(1000);
  if (method == Method::optimized)
    options.quality = dice.pick({Quality::draft, Quality::draft, Quality::fast, Quality::fast, Quality::standard,
                                 Quality::standard, Quality::best});
  const bool proposes = method != Method::optimized && method != Method::octree;
  if (proposes && dice.chance(0.05))
    options.optimizer = dice.pick({Optimizer::recenter, Optimizer::simplex, Optimizer::balance});
  if (dice.chance(0.06)) options.spheres = 1 + dice.below(12);
  return options;
}

}  // namespace

void far_tree(std::optional<Method> method, Dice& dice, Record& record) {
  const auto methods = all_methods();
  const BuildOptions options = far_options(method ? *method : methods[dice.below(methods.size())], dice);
  const bool quick = options.method == Method::octree || options.quality == Quality::draft;
  const auto facets = static_cast<std::size_t>(dice.logarithmic(1, quick ? 150 : 60));
  Shape shape = random_shape(dice, facets);
  shape.name += take_far_away(shape.mesh, dice) + " | " + std::string(name(options.method));
  if (options.method == Method::optimized) shape.name += " " + std::string(name(options.quality));
  shape.name += sizes(options.branching, *options.depth);
  if (options.spheres) shape.name += " of " + std::to_string(*options.spheres) + " spheres";
  if (options.nested) shape.name += " nested";
  record.place.description += shape.name;
  record.place.mesh = shape.mesh;
  BuildOptions chosen = options;
  if (!chosen.spheres && dice.chance(0.06)) {
    const double length = max_norm(used_box(shape.mesh).extent()) * dice.pick({0.1, 0.3});
    if (length > 0) {
      chosen.max_protrusion = length;
      chosen.spheres = 40;
      record.place.description += " within a protrusion";
    }
  }
  const CoveredTree model = build(shape.mesh, chosen);
  for (const std::string& note : model.report.notes)
    record.counts.enlarged += note.find("for the rounding of coordinates") != std::string::npos;
  judge_tree(shape.mesh, model, dice, record);
}

Specimen Specimens::choose(std::uint64_t seed, std::uint64_t number, std::size_t most_facets, Dice& dice,
                           Record& record) {
  if (dice.chance(0.65)) return own_tree(most_facets, dice, record);
  const std::uint64_t block = number / cases_per_tree;
  if (!shared_.model || seed_ != seed || block_ != block) {
    shared_ = {};
    Dice of_block(seed ^ 0x626c6f636bu, block);
    shared_ = costly_tree(of_block, record);
    seed_ = seed;
    block_ = block;
  } else {
    record.place.description += shared_.name;
  }
  return shared_;
}

UpdateOptions random_rules(Dice& dice) {
  UpdateOptions options;
  const auto several = [&](std::initializer_list<Rule> rules) {
    options.rules.clear();
    for (int n = dice.between(1, 3); n > 0; --n) options.rules.push_back(rules.begin()[dice.below(rules.size())]);
  };
  const double kind = dice.uniform();
  if (kind < 0.35) {
    options.rules = {Rule::exact};
  } else if (kind < 0.45) {
    options.rules = {Rule::wrapped};
  } else if (kind < 0.55) {
    several({Rule::exact, Rule::wrapped});
  } else if (kind < 0.9) {
    options.conservative = true;
    several({Rule::traditional, Rule::weighted, Rule::approach1, Rule::approach2, Rule::exact, Rule::wrapped});
  } else {
    several({Rule::traditional, Rule::weighted, Rule::approach1, Rule::approach2, Rule::wrapped});
    options.rules.push_back(Rule::exact);
  }
  if (dice.chance(0.3)) {
    using Options = RuleOptions;
    options.details.approach1_weights =
        dice.pick({Options::Weights::uniform, Options::Weights::inverse_distance, Options::Weights::area});
    options.details.approach1_inner_center =
        dice.pick({Options::InnerCenter::children, Options::InnerCenter::linked_vertices});
    options.details.approach2_inner_boxes =
        dice.pick({Options::InnerBoxes::child_spheres, Options::InnerBoxes::child_centers});
    options.details.distance_floor = dice.pick({0.0, 0.25});
  }
  return options;
}

std::string name(const UpdateOptions& options) {
  std::string text;
  for (const Rule rule : options.rules) text += (text.empty() ? "" : "/") + std::string(name(rule));
  return text + (options.conservative ? " conservative" : "");
}

std::vector<std::uint8_t> promised(const SphereTree& tree, const UpdateOptions& options) {
  std::vector<std::uint8_t> level_holds(tree.level_count());
  bool below = true;  // do all deeper levels cover?
  for (std::size_t level = level_holds.size(); level-- > 0;) {
    const Rule rule = options.rules[std::min(level, options.rules.size() - 1)];
    // Leaves follow `exact` under `wrapped`; those that end above the last level are on levels of their own.
    const bool holds = options.conservative || rule == Rule::exact || rule == Rule::modal || rule == Rule::skinned ||
                       (rule == Rule::wrapped && below);
    level_holds[level] = holds;
    below = below && holds;
  }
  std::vector<std::uint8_t> nodes(tree.node_count());
  for (std::uint32_t node = 0; node < nodes.size(); ++node) nodes[node] = level_holds[tree.level_of(node)];
  return nodes;
}

void round_trip(const Mesh& mesh, const CoveredTree& model, Record& record) {
  ++record.counts.round_trips;
  // By another numbering of vertices and back.
  const auto order = leaf_order(model);
  const Mesh other_mesh = renumbered(mesh, order);
  const CoveredTree other = renumbered(model, other_mesh, order);
  for (const std::string& fault : validate(other_mesh, other)) {
    record.fail("renumbered", fault);
    break;
  }
  std::vector<std::uint32_t> back(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) back[order[i]] = i;
  const CoveredTree again = renumbered(other, mesh, back);
  record.expect(same(again.tree, model.tree) && same(again.cover, model.cover), "round-trip",
                "renumbered there and back, the tree is another");
#ifdef MORULA_PROPERTIES_IO
  static const test::ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "tree.morula";
  try {
    write_tree(path, model);
    const TreeFile file = read_tree(path);
    record.expect(same(file.tree, model.tree) && file.cover && same(*file.cover, model.cover), "round-trip",
                  "written and read, the tree is another");
    const CoveredTree read = read_covered_tree(path, mesh);
    record.expect(same(read.tree, model.tree) && same(read.cover, model.cover), "round-trip",
                  "read with its mesh, the tree is another");
  } catch (const std::exception& error) {
    record.fail("round-trip", error.what());
  }
  std::filesystem::remove(path);
#endif
}

}  // namespace morula::properties
