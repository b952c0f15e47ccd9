// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/divide/flat_set.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <numeric>
#include <optional>
#include <utility>

#include "generators/divide/largest_protrusion.hpp"
#include "generators/driver/driver.hpp"
#include "generators/driver/join.hpp"
#include "generators/driver/union_volume.hpp"
#include "generators/fit/lattice.hpp"

namespace morula::detail {
namespace {

// An intermediate size of a growing set.
struct Rung {
  std::size_t size;
  bool at_once;        // sought as if it were the requested size
  bool other = false;  // sought by the other start
};

// Sizes 12, 16, 24, 48, 96 …: at 32 and more, further gains of powers of two are not worth their time.
bool is_other_start(std::size_t size) {
  // mutant flat-set-other-start: `2 * few_spheres ||` -> `0 &&`
  return size == 2 * few_spheres || (size >= least_other_start && size % 3 == 0 && std::has_single_bit(size / 3));
}

// The rungs of a set of so many spheres, the last of which is its own. A set is never looser than one of a size below
// it in this list, since it goes through the same sets on the way to its own.
std::vector<Rung> rungs_up_to(std::size_t spheres, bool has_other_start) {
  std::vector<Rung> rungs;
  for (const std::size_t few : {2, 3, 4, 6})
    if (few < spheres) rungs.push_back({few, true});
  const auto add = [&](std::size_t size, bool at_once) {
    rungs.push_back({size, at_once, has_other_start && is_other_start(size)});
  };
  for (std::size_t power = few_spheres; power < spheres; power *= 2) {
    add(power, true);
    if (const std::size_t between = 3 * power / 2; has_other_start && between < spheres) add(between, false);
  }
  if (spheres > 1) add(spheres, true);
  return rungs;
}

// State of a growing set: cached measures of its leaves, valid while these stay unchanged.
struct Growth {
  std::vector<double> gain;  // outside volume per leaf, by itself
  std::vector<int> tried;    // per leaf: number of parts that it was divided into in vain; 1: none
  int parts = 2, failures = 0;
};

struct Set {
  std::vector<BuildNode> leaves;
  double outside = 0;
  std::size_t leftover_patches = 0;
  std::string_view reducer{};
  Growth growth{};
};

class FlatSet {
 public:
  FlatSet(const FitInput& input, const ObjectLines& lines, const BuildRun& run, const FlatSetBy& by, Workers& workers)
      : input_(input),
        union_(lines),
        run_(run),
        by_(by),
        workers_(workers),
        halve_(by.parts(2)),
        quarter_(by.parts(4)),
        too_small_(smallest_radius(run)),
        root_(root_node(input.mesh, run, {})) {}

  CoveredTree operator()() {
    run_.tell(0, 0);
    report_ = new_report(input_.mesh, run_);
    Set best = only_root();
    const double prepared = run_.seconds();
    bool in_time = !run_.out_of_time();
    const std::vector<Rung> rungs = rungs_up_to(run_.spheres, by_.other_start != nullptr);
    double gone = 0, all = 0;
    for (const Rung& rung : rungs) all += static_cast<double>(rung.size);
    for (const Rung& rung : rungs) {
      if (!in_time) break;
      run_.throw_if_stopped();
      climb(best, rung);
      gone += static_cast<double>(rung.size);
      const double share = 0.95 * gone / all;
      run_.tell(share, 1, (run_.seconds() - prepared) * (1 - share) / share);
      in_time = !run_.out_of_time();
    }
    run_.throw_if_stopped();
    return tree_of(std::move(best), !in_time);
  }

 private:
  // The tightest set of the rung's size or fewer: the best so far, that set grown, or one that is sought.
  void climb(Set& best, const Rung& rung) {
    std::optional<Set> at_once;
    if (rung.at_once) at_once = sought_at_once(rung.size);
    // Growing is no rival to seeking a few spheres.
    // mutant flat-set-grown: `by_.grows && best.leaves.size() > 1 && rung.size > few_spheres` -> `false`
    if (by_.grows && best.leaves.size() > 1 && rung.size > few_spheres) {
      grow(best, rung.size);
      improve(best);
    }
    if (at_once) keep_tighter(best, *std::move(at_once));
    if (rung.other) keep_tighter(best, sought(by_.other_start(rung.size)));
    grow(best, rung.size);
  }

  static void keep_tighter(Set& best, Set other) {
    if (other.outside < best.outside) best = std::move(other);
  }

  // Seeks the set as if its size were requested, so that larger sets cannot be looser.
  Set sought_at_once(std::size_t size) {
    Set set = sought(by_.one_level(size));
    if (by_.improve && size == static_cast<std::size_t>(run_.branching)) first_level_ = set.leaves;
    if (by_.levels && (by_.quick || is_slender(set)))
      if (std::optional<Set> other = last_level(size)) keep_tighter(set, *std::move(other));
    if (by_.grows) grow(set, size);
    return set;
  }

  double outside(const std::vector<BuildNode>& leaves) {
    std::vector<Sphere> spheres;
    for (const BuildNode& leaf : leaves) spheres.push_back(leaf.sphere);
    return union_.outside(spheres);
  }

  Set only_root() {
    Set set;
    set.leaves.push_back(root_);
    set.outside = outside(set.leaves);
    return set;
  }

  Set sought(const Divider& divide) {
    Division division = children_of(root_, divide, too_small_);
    if (division.children.empty()) return only_root();
    Set set{std::move(division.children), 0, division.leftover_patches, division.reducer};
    set.outside = outside(set.leaves);
    improve(set);
    return set;
  }

  void improve(Set& set) {
    if (!by_.improve || set.leaves.size() < 2) return;
    std::vector<BuildNode> improved = set.leaves;
    // Children of one node: exchange may move parts among all of them.
    for (BuildNode& leaf : improved) leaf.parent = 0;
    by_.improve(improved);
    if (const double now = outside(improved); now < set.outside) {
      set.leaves = std::move(improved);
      set.outside = now;
      set.growth = {};
    }
  }

  // Whether spheres lie side by side like slabs: their centers are much nearer than their surfaces are.
  static bool is_slender(const Set& set) {
    constexpr double much_nearer = 0.5;
    if (set.leaves.size() < 2) return false;
    std::vector<double> nearest;
    for (const BuildNode& a : set.leaves) {
      double least = std::numeric_limits<double>::infinity();
      for (const BuildNode& b : set.leaves)
        if (&a != &b) least = std::min(least, distance(a.sphere.center, b.sphere.center) / a.sphere.radius);
      nearest.push_back(least);
    }
    const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
    std::nth_element(nearest.begin(), middle, nearest.end());
    return *middle < much_nearer;
  }

  // The leaves of a tree of as many levels as the number of spheres allows; nothing if that is one level, or if they
  // are too many.
  std::optional<Set> last_level(std::size_t most) {
    // Trees seldom use all their places: a tree that could have a few leaves too many may have few enough.
    const std::size_t about = most + most / 4;
    int depth = 0;
    for (std::size_t leaves = 1; leaves <= about / static_cast<std::size_t>(run_.branching); ++depth)
      leaves *= static_cast<std::size_t>(run_.branching);
    if (depth < 2) return std::nullopt;
    if (tree_depth_ != depth) tree_ = leaves_of_tree(depth), tree_depth_ = depth;
    return tree_.leaves.size() > most ? std::nullopt : std::optional(tree_);
  }

  // Its first level is the available set of so many, with exchanged parts.
  Set leaves_of_tree(int depth) {
    Set set;
    const Divider divide = by_.levels(depth);
    std::vector<BuildNode> finished;  // leaves that cannot be divided further
    const bool is_begun = first_level_.size() > 1;
    set.leaves = is_begun ? first_level_ : std::vector{root_};
    for (int level = is_begun ? 1 : 0; level < depth; ++level) {
      std::vector<Division> divisions(set.leaves.size());
      const auto divide_one = [&](std::size_t i) {
        if (!run_.stop.stop_requested()) divisions[i] = children_of(set.leaves[i], divide, too_small_);
      };
      if (set.leaves.size() == 1)
        divide_one(0);  // the only task, so it has the workers to itself
      else
        workers_.run(set.leaves.size(), divide_one);
      run_.throw_if_stopped();
      std::vector<BuildNode> next;
      for (std::size_t i = 0; i < divisions.size(); ++i) {
        set.leftover_patches += divisions[i].leftover_patches;
        if (divisions[i].children.empty()) finished.push_back(std::move(set.leaves[i]));
        for (BuildNode& child : divisions[i].children) {
          child.parent = static_cast<std::uint32_t>(i);
          next.push_back(std::move(child));
        }
      }
      if (by_.improve && level > 0 && !next.empty()) by_.improve(next);
      set.leaves = std::move(next);
    }
    std::move(finished.begin(), finished.end(), std::back_inserter(set.leaves));
    set.outside = outside(set.leaves);
    return set;
  }

  // Places that are left go to the spheres of largest outside volume, as long as the union gets smaller. The choice of
  // the next sphere does not depend on `most`: if two sets grow from the same one, the larger goes through the smaller,
  // so it is never looser. A division that did not help a set still does not when the set may grow further.
  void grow(Set& set, std::size_t most) {
    if (set.leaves.size() >= most) return;
    Growth& known = set.growth;
    if (!by_.grows || known.gain.size() != set.leaves.size()) known = growth_of(set);
    // Halves are tried first. If they do not help, quarters may: the outside volume of two spheres of a plate is as
    // large as that of one.
    constexpr int most_failures = 3;
    while (set.leaves.size() + static_cast<std::size_t>(known.parts) <= most + 1 && !run_.out_of_time()) {
      run_.throw_if_stopped();
      if (known.failures == most_failures) {
        if (!by_.grows || known.parts == 4) return;
        known.parts = 4, known.failures = 0;
        continue;
      }
      const std::size_t worst = worst_of(known);
      if (worst == known.gain.size())
        known.failures = most_failures;
      else if (!divide(set, worst, known.parts == 2 ? halve_ : quarter_))
        known.tried[worst] = known.parts, ++known.failures;
    }
  }

  Growth growth_of(const Set& set) const {
    Growth growth;
    for (const BuildNode& leaf : set.leaves) growth.gain.push_back(union_.outside(leaf.sphere));
    growth.tried.assign(set.leaves.size(), 1);
    return growth;
  }

  // The leaf to divide next; their number if there is none.
  static std::size_t worst_of(const Growth& known) {
    std::size_t worst = known.gain.size();
    for (std::size_t i = 0; i < known.gain.size(); ++i)
      if (known.tried[i] < known.parts && known.gain[i] > 0 &&
          (worst == known.gain.size() || known.gain[i] > known.gain[worst]))
        worst = i;
    return worst;
  }

  // Whether the parts of a leaf, in its place, have less outside volume.
  bool divide(Set& set, std::size_t at, const Divider& divider) {
    Division parts = children_of(set.leaves[at], divider, too_small_);
    if (parts.children.size() < 2) return false;
    const std::size_t before = set.leaves.size();
    BuildNode whole = std::exchange(set.leaves[at], std::move(parts.children[0]));
    std::move(parts.children.begin() + 1, parts.children.end(), std::back_inserter(set.leaves));
    const double now = outside(set.leaves);
    if (!(now < set.outside)) {
      set.leaves.resize(before);
      set.leaves[at] = std::move(whole);
      return false;
    }
    set.outside = now;
    set.leftover_patches += parts.leftover_patches;
    Growth& known = set.growth;
    known.gain[at] = union_.outside(set.leaves[at].sphere);
    for (std::size_t i = before; i < set.leaves.size(); ++i) known.gain.push_back(union_.outside(set.leaves[i].sphere));
    known.tried[at] = 1;
    known.tried.resize(known.gain.size(), 1);
    known.parts = 2, known.failures = 0;
    return true;
  }

  // Leaves [begin, end) of `order` in groups of equal size, as many as a node may have children, cut across their
  // longest axis.
  std::vector<std::size_t> cut(const std::vector<BuildNode>& leaves, std::vector<std::uint32_t>& order,
                               std::size_t begin, std::size_t end) const {
    const auto parts = static_cast<std::size_t>(run_.branching);
    std::vector<std::size_t> ends;
    const auto halve = [&](const auto& self, std::size_t from, std::size_t to, std::size_t into) -> void {
      if (into < 2 || to - from < 2) {
        ends.push_back(to);
        return;
      }
      // Every group gets a part: if there are fewer leaves than parts, shares are rounded to none.
      const std::size_t left = into / 2,
                        middle = from + std::clamp<std::size_t>((to - from) * left / into, 1, to - from - 1);
      std::vector<Vec3> centers;
      for (std::size_t i = from; i < to; ++i) centers.push_back(leaves[order[i]].sphere.center);
      const Vec3 axis = principal_axes(centers)[0];
      const auto along = [&](std::uint32_t leaf) { return dot(leaves[leaf].sphere.center, axis); };
      const auto first = order.begin() + static_cast<std::ptrdiff_t>(from);
      std::stable_sort(first, order.begin() + static_cast<std::ptrdiff_t>(to),
                       [&](std::uint32_t a, std::uint32_t b) { return along(a) < along(b); });
      self(self, from, middle, left);
      self(self, middle, to, into - left);
    };
    halve(halve, begin, end, parts);
    return ends;
  }

  Sphere around(const std::vector<BuildNode>& leaves, std::span<const std::uint32_t> of) const {
    std::vector<Vec3> points, more;
    for (const std::uint32_t leaf : of) {
      corner_positions(input_.mesh, leaves[leaf].region, more);
      points.insert(points.end(), more.begin(), more.end());
    }
    const Sphere smallest = enclosing_sphere(points);
    return {smallest.center, rounded_up_radius(smallest.radius, std::max(input_.pad, max_norm(smallest.center)))};
  }

  CoveredTree tree_of(Set set, bool out_of_time) {
    struct Span {
      std::size_t begin, end;
    };
    std::vector<BuildNode>& leaves = set.leaves;
    std::vector<std::uint32_t> order(leaves.size());
    std::iota(order.begin(), order.end(), 0u);
    // Before their regions go.
    report_.protrusion_bound = std::max(0.0, largest_protrusion(input_.mesh, input_.shape, leaves) - run_.tolerance);
    CoveredTree model;
    model.tree.branching = report_.branching;
    model.tree.append_level({}, std::span(leaves.size() > 1 ? &root_.sphere : &leaves[0].sphere, 1));
    std::vector<Region> regions;
    std::vector<Span> level{{0, leaves.size()}};
    while (!level.empty()) {
      std::vector<std::uint32_t> counts;
      std::vector<Span> next;
      for (const Span& node : level) {
        regions.push_back(node.end - node.begin == 1 ? std::move(leaves[order[node.begin]].region) : Region{});
        counts.push_back(0);
        if (node.end - node.begin == 1) continue;
        for (std::size_t begin = node.begin; const std::size_t end : cut(leaves, order, node.begin, node.end)) {
          next.push_back({begin, end});
          begin = end;
          ++counts.back();
        }
      }
      std::vector<Sphere> spheres(next.size());
      workers_.run(next.size(), [&](std::size_t i) {
        const auto of = std::span(order).subspan(next[i].begin, next[i].end - next[i].begin);
        spheres[i] = of.size() == 1 ? leaves[of[0]].sphere : around(leaves, of);
      });
      if (!next.empty()) model.tree.append_level(counts, spheres);
      level = std::move(next);
    }
    model.cover = assemble_cover(input_.mesh, model.tree, std::move(regions));
    report_.depth = static_cast<std::uint32_t>(model.tree.level_count() - 1);
    report_.level_seconds.assign(model.tree.level_count(), 0.0);
    report_.level_seconds[std::min<std::size_t>(1, report_.depth)] = run_.seconds();
    report_.leftover_patches = set.leftover_patches;
    for (std::uint32_t i = 0; i < model.tree.level_begin[model.tree.level_count() - 1]; ++i)
      report_.early_leaves += model.tree.is_leaf(i);
    if (out_of_time) {
      report_.complete = false;
      report_.notes.push_back("the time limit of " + short_number(*run_.time_limit_seconds) + " s was over at " +
                              std::to_string(leaves.size()) + " spheres, which are left undivided");
    } else if (leaves.size() < run_.spheres) {
      report_.notes.push_back(std::to_string(leaves.size()) + " spheres, not " + std::to_string(run_.spheres) +
                              ": more would be no tighter, or the surface cannot be divided further");
    }
    Winners winners;
    Division winner;
    winner.reducer = set.reducer;
    winner.children.resize(1);
    winners.add(winner);
    if (std::string note = winners.note(); !note.empty()) report_.notes.push_back(std::move(note));
    run_.tell(1, static_cast<int>(report_.depth), 0.0);
    run_.throw_if_stopped();
    model.report = std::move(report_);
    return model;
  }

  const FitInput& input_;
  UnionVolume union_;
  const BuildRun& run_;
  const FlatSetBy& by_;
  Workers& workers_;
  Divider halve_, quarter_;
  double too_small_;
  BuildNode root_;
  std::vector<BuildNode> first_level_;  // first level of trees; empty if parts are not exchanged
  Set tree_;                            // leaves of a tree of tree_depth_ levels
  int tree_depth_ = 0;
  BuildReport report_;
};

}  // namespace

CoveredTree flat_set(const FitInput& input, const ObjectLines& lines, const BuildRun& run, const FlatSetBy& by,
                     Workers& workers) {
  return FlatSet(input, lines, run, by, workers)();
}

}  // namespace morula::detail
