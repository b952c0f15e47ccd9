// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Method optimized: the balls of each node are sought, from several starts, where they cover least empty space
// together.
//
//   starts   one ball over the region, split until there are enough; then what the paper's reducers propose
//   seeds    inscribed balls that need to grow least, spread over the region
//   changes  walls nudged, balls moved from where they are missed least to where they help most; kept when they help
//   exact    the region divided by power, each ball fitted to exactly what it owns
//   exchange nodes of a level pass parts to each other across parents
//
// A draft tree estimates where the surface will need small spheres: since all nodes get equally many children, the
// upper levels give each child an equal share of that demand, as far as their own fit allows.

#include <algorithm>
#include <cmath>
#include <memory>
#include <morula/geometry/sampling.hpp>
#include <morula/parallel/threads.hpp>
#include <mutex>
#include <optional>

#include "generators/divide/demand.hpp"
#include "generators/divide/exchange.hpp"
#include "generators/divide/flat_set.hpp"
#include "generators/divide/node_fit.hpp"
#include "generators/driver/union_volume.hpp"
#include "generators/fit/chord_balls.hpp"
#include "generators/fit/lattice.hpp"
#include "generators/fit/medial_seeds.hpp"
#include "generators/methods.hpp"
#include "generators/reduce/reducers.hpp"
#include "medial/shrunken_balls.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t enough_seeds = 200;  // balls to choose seeds from, for one node

// Amount of work per step; for levels of children 1, 2, and all below.
struct Effort {
  NodeFit::Settings fit;
  double first_cell;  // cell width of the grid for splitting, in parts of the region
  int sweeps;
  bool inscribed;                // seeds and sweeps by inscribed balls
  std::size_t medial_samples;    // number of medial samples; 0: no seeds
  std::array<int, 3> starts;     // tries from the beginning; the best is kept
  std::array<int, 3> proposals;  // proposals of the paper's reducers; swept, and kept if better
  std::array<int, 3> changes;
  std::array<float, 2> balance;  // weights on levels 1 and 2
  int exchanges;                 // rounds per level
  enum class Slabs { unseen, seen, seen_finely };
  Slabs slabs;                     // treatment of a tube's slabs
  bool begins_with_seeds = false;  // the first start is inscribed balls, not one ball that is split
};
constexpr Effort fast{.fit = {.spacing = 0.2, .cell = 0.3, .cells_per_radius = 3, .balance = 0, .exact_rounds = 1},
                      .first_cell = 0.45,
                      .sweeps = 1,
                      .inscribed = false,
                      .medial_samples = 0,
                      .starts = {1, 1, 1},
                      .proposals = {0, 0, 0},
                      .changes = {8, 0, 0},
                      .balance = {0, 0},
                      .exchanges = 0,
                      .slabs = Effort::Slabs::unseen};
// A coarser grid finds about the same splits, and a sweep repairs few of the splits that they missed.
constexpr Effort draft = [] {
  Effort effort = fast;
  effort.first_cell = 0.6;
  effort.sweeps = 0;
  return effort;
}();
// The smaller sets that a flat set grows from, for efforts that only split. A set that begins with seeds takes no
// longer, and is 0.8 to 0.9 times as loose; on rings, 0.3 times.
constexpr Effort from_seeds(Effort effort) {
  effort.begins_with_seeds = true;
  effort.changes = {0, 0, 0};
  return effort;
}
constexpr Effort standard{.fit = {.spacing = 0.1, .cell = 0.2, .cells_per_radius = 4, .balance = 0, .exact_rounds = 3},
                          .first_cell = 0.35,
                          .sweeps = 2,
                          .inscribed = true,
                          .medial_samples = 4000,
                          .starts = {4, 1, 1},
                          .proposals = {0, 2, 0},
                          .changes = {200, 60, 4},
                          .balance = {2.5F, 2.0F},
                          .exchanges = 3,
                          .slabs = Effort::Slabs::seen_finely};
constexpr Effort best{.fit = {.spacing = 0.06, .cell = 0.2, .cells_per_radius = 5, .balance = 0, .exact_rounds = 4},
                      .first_cell = 0.35,
                      .sweeps = 3,
                      .inscribed = true,
                      .medial_samples = 12000,
                      .starts = {8, 3, 2},
                      .proposals = {0, 0, 0},
                      .changes = {120, 80, 50},
                      .balance = {2.5F, 2.0F},
                      .exchanges = 5,
                      .slabs = Effort::Slabs::seen_finely};

const Effort& effort_of(Quality quality) {
  if (quality == Quality::draft) return draft;
  if (quality == Quality::fast) return fast;
  return quality == Quality::best ? best : standard;
}

Effort effort_for(const BuildRun& run) {
  Effort effort = effort_of(run.quality);
  // Narrow cells would take sets of 64 beyond a second.
  if (is_flat_set(run) && effort.slabs == Effort::Slabs::seen_finely) effort.slabs = Effort::Slabs::seen;
  return effort;
}

constexpr float while_splitting = 0.6F, afterwards = 0.15F;
constexpr std::array further_starts{Reduction::spawn, Reduction::expand, Reduction::grid, Reduction::hubbard};

class OptimizedDivider {
 public:
  // balls: inscribed balls of the whole object. demand: none in the draft tree.
  OptimizedDivider(const FitInput& input, const BuildRun& run, const Effort& effort, const std::vector<Sphere>& balls,
                   Demand demand, Workers& workers)
      : input_(input), run_(run), effort_(effort), balls_(balls), demand_(std::move(demand)), workers_(workers) {}

  Division operator()(const BuildNode& node) const {
    const auto level = static_cast<std::size_t>(std::min(node.level, 2));
    const std::size_t starts = shared_among_children(effort_.starts[level]);
    std::vector<BuildNode> nodes(starts, node);
    Random seeds(node.seed);
    for (BuildNode& n : nodes) n.seed = seeds.next();
    const RegionPoints points =
        region_points(input_, node, static_cast<std::size_t>(run_.branching), effort_.fit.spacing);
    // Only the tightest is kept: at the root each start holds all facets. The first of equals is kept.
    NodeFit::Exact tightest;
    std::size_t tightest_start = starts;
    Mutex choosing;
    const auto fit = [&](std::size_t k) {
      run_.throw_if_stopped();
      NodeFit::Exact exact = attempt(nodes[k], points, level, k, starts > 1);
      const std::lock_guard lock(choosing);
      const bool is_better =
          tightest_start == starts || exact.cost < tightest.cost || (exact.cost == tightest.cost && k < tightest_start);
      if (is_better) tightest = std::move(exact), tightest_start = k;
    };
    // Only the root has the workers to itself.
    if (node.level == 0)
      workers_.run(starts, fit);
    else
      for (std::size_t k = 0; k < starts; ++k) fit(k);
    return division_of(std::move(tightest));
  }

 private:
  static constexpr std::size_t few_children = 8;

  // A node's tries are shared among its children: many children share the tries that few would have.
  std::size_t shared_among_children(int tries) const {
    const auto children = std::max(few_children, static_cast<std::size_t>(run_.branching));
    return (few_children * static_cast<std::size_t>(tries) + children - 1) / children;
  }
  // At the root, whose changes are many, fewer children than a few need fewer; not less than 8, the number of `fast`.
  std::size_t changes_on(std::size_t level) const {
    const std::size_t changes = shared_among_children(effort_.changes[level]);
    const auto children = static_cast<std::size_t>(run_.branching);
    if (level > 0 || children >= few_children) return changes;
    constexpr std::size_t least = 8;
    return std::max(std::min(changes, least), changes * children / few_children);
  }

  // Side by side on a tube: centers are much nearer to their middle than to the surface.
  static bool are_slabs(std::span<const Sphere> spheres, double mean_radius) {
    constexpr double much_nearer = 0.3;
    const Vec3 middle = middle_of(spheres);
    double squares = 0;
    for (const Sphere& s : spheres) squares += squared_distance(s.center, middle);
    return squares < much_nearer * much_nearer * mean_radius * mean_radius * static_cast<double>(spheres.size());
  }
  // The balls of a ball or a shell lie side by side also, but centers on a tube's axis are in one line.
  static bool are_in_line(std::span<const Sphere> spheres) {
    constexpr double much_nearer = 0.1;
    const Vec3 middle = middle_of(spheres);
    std::vector<Vec3> centers;
    for (const Sphere& s : spheres) centers.push_back(s.center);
    const Vec3 axis = principal_axes(centers)[0];
    double along = 0, squares = 0;
    for (const Vec3& c : centers) {
      along += dot(c - middle, axis) * dot(c - middle, axis);
      squares += squared_distance(c, middle);
    }
    return squares - along < much_nearer * much_nearer * along;
  }
  static Vec3 middle_of(std::span<const Sphere> spheres) {
    Vec3 middle{};
    for (const Sphere& s : spheres) middle += s.center / static_cast<double>(spheres.size());
    return middle;
  }

  static constexpr NodeFit::Settings::SlabCell narrow{0.15, 16}, upper{0.25, 6}, lower{0.4, 6};

  // The first balls: by splitting; for further starts, by the paper's reducers.
  std::vector<Sphere> first_spheres(const BuildNode& node, const RegionPoints& points, std::size_t start) const {
    const auto most = static_cast<std::size_t>(run_.branching);
    if (start > 0) {
      std::vector<Sphere> proposed = proposed_spheres(node, further_starts[(start - 1) % further_starts.size()]);
      if (!proposed.empty()) return proposed;
    }
    NodeFit::Settings settings = effort_.fit;
    settings.cell = effort_.first_cell;
    NodeFit fit(input_, node, points, most, 0, settings);
    const std::vector<GroupBall> seeds =
        effort_.begins_with_seeds ? seeds_for(node, fit, Dilation::length) : std::vector<GroupBall>{};
    if (seeds.empty())
      fit.children().split_from_one();
    else
      fit.children().start_from_grid(seeds);
    for (int i = 0; i < 2; ++i) fit.children().sweep(while_splitting, true);
    return fit.children().spheres();
  }

  NodeFit::Exact attempt(const BuildNode& node, const RegionPoints& points, std::size_t level, std::size_t start,
                         bool with_cost) const {
    const auto most = static_cast<std::size_t>(run_.branching);
    const std::vector<Sphere> spheres = first_spheres(node, points, start);
    double mean_radius = 0;
    for (const Sphere& s : spheres) mean_radius += s.radius / static_cast<double>(spheres.size());
    NodeFit::Settings settings = effort_.fit;
    if (demand_ && node.level < run_.depth - 1 && level < 2) settings.balance = effort_.balance[level];
    // mutant slabs-cells: `are_slabs(spheres, mean_radius)` -> `spheres.empty()`
    const bool slabs = effort_.slabs != Effort::Slabs::unseen && are_slabs(spheres, mean_radius);
    const bool fine_slabs = slabs && effort_.slabs == Effort::Slabs::seen_finely && level < 2 && are_in_line(spheres);
    // mutant slabs-narrow-cells: `narrow` -> `upper`
    if (slabs) settings.slab_cell = fine_slabs ? narrow : level < 2 ? upper : lower;
    NodeFit fit(input_, node, points, most, mean_radius, settings, demand_);
    ChildFit& children = fit.children();
    children.start_from(spheres);
    for (int i = 0; i < effort_.sweeps; ++i) children.sweep(afterwards, true);
    constexpr int settling_sweeps = 2;
    for (std::size_t k = 0; k < shared_among_children(effort_.proposals[level]); ++k)
      children.try_spheres(proposed_spheres(node, further_starts[k % further_starts.size()]), settling_sweeps);
    if (effort_.inscribed) {
      constexpr int inscribed_sweeps = 2;
      // Centers on a tube's axis have their final place already: only their distances count.
      if (!balls_.empty() && !fine_slabs) {
        const GroupPoints few = some_of(fit.points());
        const std::vector<GroupBall> candidates = touching(node, fit, few);
        for (const Dilation d : {Dilation::length, Dilation::square})
          children.try_seeds(medial_seeds(candidates, few, most, d), inscribed_sweeps, settling_sweeps);
      }
      children.try_inscribed(2 * inscribed_sweeps, settling_sweeps);
    }
    run_.throw_if_stopped();
    constexpr int move_every = 5;
    children.try_changes(static_cast<int>(changes_on(level)), move_every);
    NodeFit::Exact exact = fit.exact(with_cost);
    // One ball that is as good as many (the region of a ball, say) is still divided: parts that move apart have to be
    // parts.
    if (exact.spheres.size() < 2) exact = fit.divided_anyway(proposed_spheres(node, Reduction::grid));
    return exact;
  }

  // The proposal of one of the paper's reducers; none if it has none.
  std::vector<Sphere> proposed_spheres(const BuildNode& node, Reduction kind) const {
    const RegionSamples samples = region_samples(input_.mesh, node.region, input_.shape.orientation(), node.seed);
    const Proposals proposals =
        combined_reducer({kind}, BuildOptions{})({samples.points, samples.normals, node.sphere,
                                                  static_cast<std::size_t>(run_.branching), node.seed, input_.shape});
    return proposals.front().reducer == no_proposal ? std::vector<Sphere>{} : proposals.front().spheres;
  }

  // Seeds for a node; none on a mesh without an inside.
  std::vector<GroupBall> seeds_for(const BuildNode& node, const NodeFit& fit, Dilation dilation) const {
    const GroupPoints few = some_of(fit.points());
    return medial_seeds(touching(node, fit, few), few, static_cast<std::size_t>(run_.branching), dilation);
  }

  static GroupPoints some_of(const GroupPoints& points) {
    constexpr std::size_t enough = 300;
    GroupPoints few;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / enough) few.push_back(points[i]);
    return few;
  }

  // Inscribed balls that touch the region, in grid coordinates; an even choice when they are many.
  std::vector<GroupBall> touching(const BuildNode& node, const NodeFit& fit, const GroupPoints& points) const {
    constexpr float near = 0.25F;  // parts of the region
    const OutsideGrid& grid = const_cast<NodeFit&>(fit).grid();
    std::vector<GroupBall> found;
    for (const Sphere& ball : balls_) {
      if (distance(ball.center, node.sphere.center) > node.sphere.radius) continue;
      const Vec3f c = grid.to_grid(ball.center);
      const float r = static_cast<float>(ball.radius / grid.cell());
      const float reach = r + near * fit.child_width();
      bool touches = false;
      for (std::size_t i = 0; i < points.size() && !touches; ++i) {
        const float dx = points.x[i] - c.x, dy = points.y[i] - c.y, dz = points.z[i] - c.z;
        touches = dx * dx + dy * dy + dz * dz < reach * reach;
      }
      if (touches) found.push_back({c, r, 0});
    }
    if (found.size() <= enough_seeds) return found;
    std::vector<GroupBall> some;
    for (std::size_t k = 0; k < enough_seeds; ++k) some.push_back(found[k * found.size() / enough_seeds]);
    return some;
  }

  const FitInput& input_;
  const BuildRun& run_;
  const Effort& effort_;
  const std::vector<Sphere>& balls_;
  Demand demand_;
  Workers& workers_;
};

std::vector<Sphere> medial_set(const MeshView& mesh, const ObjectShape& shape, std::size_t count, std::uint64_t seed,
                               Workers& workers) {
  if (count == 0 || !shape.has_volume()) return {};
  std::vector<Vec3> points, normals;
  for (const SurfacePoint& s : sample_surface(mesh, count, seed)) {
    const Triangle t = mesh.corners(s.facet);
    points.push_back(s.point);
    normals.push_back(normalized(cross(t[1] - t[0], t[2] - t[0])) * shape.orientation());
  }
  return shrunken_balls(shape.distance(), points, normals, BallSharing::on_round_parts, workers);
}

// The number of samples is limited by the search at the nodes that are divided last. It is the same for flat sets and
// trees of one level, however many their children: a set goes through the smaller ones as if they were requested, and
// is never looser than such a tree.
std::size_t medial_samples(const Effort& effort, const BuildRun& run) {
  constexpr std::size_t least = 8 * enough_seeds;
  if (is_flat_set(run)) return std::min(effort.medial_samples, least);
  if (is_worst_first(run)) return effort.medial_samples;  // the tree's depth has no limit
  std::size_t nodes = 1;
  for (int level = 1; level < run.depth && nodes < effort.medial_samples; ++level)
    nodes *= static_cast<std::size_t>(run.branching);
  return std::min(effort.medial_samples, std::max(least, nodes * enough_seeds));
}

// Inputs of one mesh's tree. Borrowed.
struct OptimizedInput {
  const FitInput& fit;
  const Effort& effort;
  const std::vector<Sphere>& balls;  // inscribed balls of the whole object
  Workers& workers;
};

// A set sought at once, by splitting and, for efforts that only split, from seeds.
CoveredTree flat_tree(const OptimizedInput& input, const ObjectLines& fine, const BuildRun& run) {
  const FitInput& fit = input.fit;
  const Effort& effort = input.effort;
  const FitInput fine_fit = fit_input(fit.mesh, fit.shape, fine);
  const bool has_other_start = !effort.inscribed && run.spheres >= least_other_start;
  const Effort seeded = from_seeds(effort);
  const std::vector<Sphere> seeds =
      has_other_start ? chord_balls(fit.mesh, fine, enough_seeds, run.seed) : std::vector<Sphere>{};
  const auto divider = [&](const FitInput& by, const BuildRun& level_run, const Effort& how) -> Divider {
    const auto level = std::make_shared<const BuildRun>(level_run);
    const std::vector<Sphere>& starts = how.begins_with_seeds ? seeds : input.balls;
    return [level, divide = OptimizedDivider(by, *level, how, starts, {}, input.workers)](const BuildNode& node) {
      return divide(node);
    };
  };
  FlatSetBy by{.one_level = [&](std::size_t most) { return divider(fit, run.one_level(most), effort); },
               .parts = [&](std::size_t most) { return divider(fine_fit, run.one_level(most), fast); },
               .levels = {},
               .improve = {},
               .grows = true};
  if (has_other_start)
    by.other_start = [&](std::size_t most) { return divider(fine_fit, run.one_level(most), seeded); };
  if (effort.exchanges > 0) {
    by.levels = [&](int depth) { return divider(fine_fit, of_levels(run, depth), effort); };
    by.improve = [&](std::vector<BuildNode>& nodes) { exchange(fine_fit, nodes, effort.exchanges, input.workers); };
  }
  return flat_set(fit, fine, run, by, input.workers);
}

// The tighter, reduced by the tolerance, of two sets: one fitted for it, and one fitted to cover. Few spheres that are
// fitted for a tolerance are not always the better ones.
CoveredTree tolerant_flat_tree(const OptimizedInput& input, ObjectLines& lines, ObjectLines& fine,
                               const BuildRun& run) {
  lines.set_tolerance(0);
  fine.set_tolerance(0);
  BuildRun exact_run = run.pass(0, 0.5);
  exact_run.tolerance = 0;
  CoveredTree covering = flat_tree(input, fine, exact_run);
  if (run.out_of_time()) return covering;
  lines.set_tolerance(run.tolerance);
  fine.set_tolerance(run.tolerance);
  CoveredTree fitted = flat_tree(input, fine, run.pass(0.5, 1));
  UnionVolume outside(fine);
  const auto outside_of = [&](const CoveredTree& model) {
    return outside.outside(level_set_spheres(model.tree, model.tree.level_count() - 1));
  };
  // mutant tolerance-fitted-for-alone: `outside_of(covering) < outside_of(fitted)` -> `false`
  if (!(outside_of(covering) < outside_of(fitted))) return fitted;
  double& bound = *covering.report.protrusion_bound;
  bound = std::max(0.0, bound - run.tolerance);
  return covering;
}

// Worst leaf first, without a limit of depth.
CoveredTree grown_tree(const OptimizedInput& input, const BuildRun& run) {
  return top_down(input.fit.mesh, run,
                  {.divide = OptimizedDivider(input.fit, run, input.effort, input.balls, {}, input.workers),
                   .distance = &input.fit.shape.distance()},
                  input.workers);
}

// Level by level; demand is estimated from a fast tree where the effort balances it. divided: see DriverInput.
CoveredTree level_tree(const OptimizedInput& input, const BuildRun& run, const std::function<void()>& divided) {
  const LevelHook exchange_parts = [&](std::vector<BuildNode>& nodes) {
    // Siblings have distributed demand evenly: level 1 keeps what it owns.
    const auto change = nodes[0].level >= 2 ? exchange : settle;
    change(input.fit, nodes, input.effort.exchanges, input.workers);
  };
  const auto tree_by = [&](const BuildRun& by, Demand demand) {
    return top_down(
        input.fit.mesh, by,
        {.divide = OptimizedDivider(input.fit, by, input.effort, input.balls, std::move(demand), input.workers),
         .new_level = exchange_parts,
         .lines = &input.fit.lines,
         .divided = divided},
        input.workers);
  };
  if (input.effort.balance[0] == 0 || run.depth < 2) return tree_by(run, {});
  constexpr double first_share = 0.15;
  CoveredTree first = fast_tree(input.fit, run.pass(0, first_share), input.workers);
  if (run.out_of_time()) return first;
  Demand demand = demand_from(input.fit, first, input.workers);
  first = {};
  return tree_by(run.pass(first_share, 1), std::move(demand));
}

}  // namespace

CoveredTree fast_tree(const FitInput& input, const BuildRun& run, Workers& workers) {
  const std::vector<Sphere> none;
  BuildRun deep = run;
  deep.spheres = 0;
  deep.max_protrusion = 0;
  return top_down(input.mesh, deep,
                  {.divide = OptimizedDivider(input, deep, fast, none, {}, workers), .lines = &input.lines}, workers);
}

CoveredTree build_optimized(const MeshView& mesh, const BuildRun& run, Workers& workers) {
  const Effort effort = effort_for(run);
  const bool grows = is_worst_first(run) && !is_flat_set(run);
  std::optional<ObjectShape> object;
  effort.medial_samples > 0 || grows ? object.emplace(mesh, workers) : object.emplace(mesh);
  ObjectLines lines(mesh, *object, cells_for(run, mesh, *object), workers);
  lines.set_tolerance(run.tolerance);
  const FitInput fit = fit_input(mesh, *object, lines);
  const std::vector<Sphere> balls = medial_set(mesh, *object, medial_samples(effort, run), run.seed, workers);
  const OptimizedInput input{fit, effort, balls, workers};
  if (is_flat_set(run)) {
    ObjectLines fine(mesh, *object, flat_set_cells, workers);
    return run.tolerance > 0 ? tolerant_flat_tree(input, lines, fine, run) : flat_tree(input, fine, run);
  }
  if (grows) return grown_tree(input, run);
  return level_tree(input, run, [&] { object.reset(); });
}

}  // namespace morula::detail
