// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/collide/distance.hpp>
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/scale.hpp>
#include <stdexcept>
#include <vector>

#include "collide/facets/world_facets.hpp"
#include "collide/pairs/meter.hpp"
#include "collide/pairs/placed_spheres.hpp"
#include "collide/require.hpp"
#include "geometry/infinity.hpp"
#include "geometry/nearest_pair.hpp"
#include "geometry/object_call.hpp"
#include "geometry/slab.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

struct WaitingPair {
  double bound;  // gap_below of the spheres, negative where they overlap
  std::uint32_t a, b;
};
// The order of a heap with the nearest pair on top; ties by index.
bool comes_later(const WaitingPair& x, const WaitingPair& y) {
  if (x.bound != y.bound) return x.bound > y.bound;
  return x.a != y.a ? x.a > y.a : x.b > y.b;
}

// Memory that outlives queries; each Search empties it.
struct Scratch {
  struct OfBody {
    WorldFacets facets;
    std::vector<std::uint32_t> near;  // facets kept by Search::keep_near
  };
  std::vector<WaitingPair> waiting;
  OfBody a, b;
  std::array<std::uint64_t, 512> recent;  // pairs of facets compared last
};

// One of the two bodies, as one query reads it.
struct SearchedBody {
  SearchedBody(const Collider& body_, Scratch::OfBody& memory)
      : body(body_), tree(body_.tree()), spheres(body_), facets(memory.facets), near(memory.near) {
    facets.start(body);
  }
  bool is_leaf(std::uint32_t node) const { return tree.is_leaf(node); }

  const Collider& body;
  const SphereTree& tree;
  PlacedSpheres spheres;
  WorldFacets& facets;
  std::vector<std::uint32_t>& near;
};

// The line through the two points of the best answer so far; facets are measured along it. It moves with the points.
struct WitnessLine {
  Slab slab{{}, {}};
  std::uint32_t version = 0;  // version of the slab
  bool is_of_facets = false;  // whether the points are the nearest ones of two facets that were compared

  void move_to(const Vec3& a, const Vec3& b, bool of_facets) {
    slab = Slab(a, b - a);
    ++version;
    is_of_facets = of_facets;
  }
};

// The limit of a budget of time, which begins with the query; other budgets are never over by time.
class TimeLimit {
 public:
  explicit TimeLimit(const DistanceOptions& options) : options_(options) {}
  // Reads the clock after every 64 tests.
  bool is_over(std::size_t tests) {
    if (options_.budget.is_time() && !late_ && tests >= next_look_) {
      next_look_ = tests + 64;
      late_ = now(options_.clock) - start_ >= options_.budget.time();
    }
    return late_;
  }

 private:
  const DistanceOptions& options_;
  std::chrono::nanoseconds start_{options_.budget.is_time() ? now(options_.clock) : std::chrono::nanoseconds{}};
  std::size_t next_look_ = 0;
  bool late_ = false;
};

// One query.
class Search {
 public:
  Search(const Collider& a, const Collider& b, const DistanceOptions& options, Scratch& scratch)
      : a_(a, scratch.a), b_(b, scratch.b), options_(options), waiting_(scratch.waiting), recent_(scratch.recent) {
    waiting_.clear();
    recent_.fill(~std::uint64_t{0});
  }

  DistanceBounds run(std::uint32_t likely_a, std::uint32_t likely_b) {
    any_witness();
    push(0, a_.spheres(0), 0, b_.spheres(0), -infinity);
    if (has_budget()) {
      if (likely_a != no_facet)
        try_facets({a_.body.triangle(likely_a), {}, likely_a}, {b_.body.triangle(likely_b), {}, likely_b});
      else
        descend();
    }
    while (!waiting_.empty() && !is_done()) {
      check_interrupt();
      if (!has_budget()) break;
      std::pop_heap(waiting_.begin(), waiting_.end(), comes_later);
      const WaitingPair pair = waiting_.back();
      waiting_.pop_back();
      expand(pair);
    }
    answer_.complete = is_done();
    answer_.lower = lower();
    answer_.farther = answer_.lower > options_.stop_above;
    return answer_;
  }

 private:
  bool has_budget() {
    const std::size_t tests = answer_.sphere_tests + answer_.facet_tests;
    if (options_.budget.is_tests()) return tests < static_cast<std::size_t>(options_.budget.tests());
    return !time_.is_over(tests);
  }
  double lower() const {
    const double waiting = waiting_.empty() ? infinity : waiting_.front().bound;
    return std::min(answer_.upper, std::max(0.0, std::min(waiting, looked_at_)));
  }
  bool is_done() const {
    // A pair exactly as near as the best so far is still examined: so the answer is that of the lowest facets, whatever
    // bound was known at the start.
    if (waiting_.empty() || waiting_.front().bound > answer_.upper || is_settled_) return true;
    if (answer_.upper <= options_.stop_below) return true;
    const double below = lower();
    return below > options_.stop_above || (options_.tolerance > 0 && answer_.upper - below <= options_.tolerance);
  }

  // Takes two corners, so that there is an upper bound for any budget.
  void any_witness() {
    const std::uint32_t facet_a = a_.body.facets(0).front(), facet_b = b_.body.facets(0).front();
    answer_.a = {facet_a, {1, 0, 0}, a_.body.triangle(facet_a)[0]};
    answer_.b = {facet_b, {1, 0, 0}, b_.body.triangle(facet_b)[0]};
    // mutant distance-witness: `) * (1 + 0x1p-49)` -> `)`
    answer_.upper = scaled_length(answer_.b.point - answer_.a.point) * (1 + 0x1p-49);
    answer_.crossing = answer_.upper == 0;
    line_.move_to(answer_.a.point, answer_.b.point, false);
  }

  // Child spheres need not be inside their parents', but the child's region is: a bound for the parents holds for the
  // children.
  void push(std::uint32_t node_a, const Sphere& sphere_a, std::uint32_t node_b, const Sphere& sphere_b,
            double inherited) {
    ++answer_.sphere_tests;
    const double bound = std::max(inherited, gap_below(sphere_a, sphere_b));
    if (bound > answer_.upper) return;
    waiting_.push_back({bound, node_a, node_b});
    std::push_heap(waiting_.begin(), waiting_.end(), comes_later);
  }

  bool splits_a(std::uint32_t node_a, const Sphere& sphere_a, std::uint32_t node_b, const Sphere& sphere_b) const {
    return !a_.is_leaf(node_a) && (b_.is_leaf(node_b) || sphere_a.radius >= sphere_b.radius);
  }

  void expand(const WaitingPair& pair) {
    if (a_.is_leaf(pair.a) && b_.is_leaf(pair.b)) return look_at_facets(pair);
    const Sphere sphere_a = a_.spheres(pair.a), sphere_b = b_.spheres(pair.b);
    if (splits_a(pair.a, sphere_a, pair.b, sphere_b)) {
      const std::uint32_t first = a_.tree.first_child[pair.a];
      for (std::uint32_t child = first; child < first + a_.tree.child_count[pair.a]; ++child)
        push(child, a_.spheres(child), pair.b, sphere_b, pair.bound);
    } else {
      const std::uint32_t first = b_.tree.first_child[pair.b];
      for (std::uint32_t child = first; child < first + b_.tree.child_count[pair.b]; ++child)
        push(pair.a, sphere_a, child, b_.spheres(child), pair.bound);
    }
  }

  // Compares all pairs of facets that may be as near as the best so far.
  void look_at_facets(const WaitingPair& pair) {
    // Any direction is sound, so the slab stays correct after a find has moved the line.
    const Slab slab = line_.slab;
    const double reach_a = a_.facets.reach(pair.a, line_.version, [&](const Triangle& t) { return slab.end(t, 1); });
    const double reach_b = b_.facets.reach(pair.b, line_.version, [&](const Triangle& t) { return slab.end(t, -1); });
    ++answer_.sphere_tests;
    if (-reach_b - reach_a > slab.width(answer_.upper)) return;
    keep_near(a_, pair.a, b_.spheres(pair.b), reach_b, slab);
    keep_near(b_, pair.b, a_.spheres(pair.a), reach_a, slab);
    for (const std::uint32_t j : b_.near)
      for (const std::uint32_t i : a_.near) {
        if (-b_.facets[j].reach - a_.facets[i].reach > slab.width(answer_.upper)) continue;
        if (!has_budget()) {
          waiting_.push_back(pair);
          std::push_heap(waiting_.begin(), waiting_.end(), comes_later);
          return;
        }
        ++answer_.sphere_tests;
        const double bound = gap_below(a_.facets[i].sphere, b_.facets[j].sphere);
        if (bound > answer_.upper) continue;
        if (was_just_looked_at(a_.facets[i].facet, b_.facets[j].facet)) continue;
        const double found = try_facets(a_.facets[i], b_.facets[j]);
        looked_at_ = std::min(looked_at_, std::max({found, bound, pair.bound}));
        if (answer_.upper <= options_.stop_below) {
          // The rest of this pair is not examined.
          looked_at_ = std::min(looked_at_, pair.bound);
          return;
        }
      }
    if (!options_.to_facets) {
      // No waiting pair is nearer by its spheres.
      looked_at_ = std::min(looked_at_, pair.bound);
      is_settled_ = true;
    }
  }

  // Keeps the facets that may be as near to the other leaf as the best so far.
  void keep_near(SearchedBody& body, std::uint32_t leaf, const Sphere& other, double reach, const Slab& slab) {
    body.near.clear();
    const auto range = body.facets.of_leaf(leaf);
    for (std::size_t i = range.begin; i < range.end; ++i) {
      if (-body.facets[i].reach - reach > slab.width(answer_.upper)) continue;
      ++answer_.sphere_tests;
      if (gap_below(body.facets[i].sphere, other) <= answer_.upper) body.near.push_back(static_cast<std::uint32_t>(i));
    }
  }

  // Facets have parts in several leaves, so pairs recur. A forgotten pair is only compared once more.
  bool was_just_looked_at(std::uint32_t facet_a, std::uint32_t facet_b) {
    std::uint64_t& slot = recent_[(facet_a * 0x9e3779b9u ^ facet_b * 0x85ebca6bu) >> 23];
    const std::uint64_t pair = std::uint64_t{facet_a} << 32 | facet_b;
    if (slot == pair) return true;
    slot = pair;
    return false;
  }

  // Returns the lower bound for the two facets.
  double try_facets(const WorldFacet& facet_a, const WorldFacet& facet_b) {
    ++answer_.facet_tests;
    const NearestPair found = nearest_pair(facet_a.corners, facet_b.corners);
    const bool is_first =
        facet_a.facet != answer_.a.facet ? facet_a.facet < answer_.a.facet : facet_b.facet < answer_.b.facet;
    if (found.upper < answer_.upper || (found.upper == answer_.upper && (!line_.is_of_facets || is_first))) {
      answer_.upper = found.upper;
      // mutant distance-crossing-forgotten: `answer_.crossing = found.crossing` -> ``
      answer_.crossing = found.crossing;
      answer_.a = {facet_a.facet, found.a, found.point_a};
      answer_.b = {facet_b.facet, found.b, found.point_b};
      line_.move_to(found.point_a, found.point_b, true);
    }
    return found.lower;
  }

  // Finds a good first upper bound: descends to the nearest child each time, down to one pair of facets.
  void descend() {
    std::uint32_t node_a = 0, node_b = 0;
    Sphere sphere_a = a_.spheres(0), sphere_b = b_.spheres(0);
    while (!a_.is_leaf(node_a) || !b_.is_leaf(node_b)) {
      if (splits_a(node_a, sphere_a, node_b, sphere_b))
        to_nearest_child(a_, node_a, sphere_a, sphere_b);
      else
        to_nearest_child(b_, node_b, sphere_b, sphere_a);
      if (!has_budget()) return;
    }
    const std::size_t i = nearest_facet(a_.facets, a_.facets.of_leaf(node_a), sphere_b);
    const std::size_t j = nearest_facet(b_.facets, b_.facets.of_leaf(node_b), a_.facets[i].sphere);
    try_facets(a_.facets[i], b_.facets[j]);
  }

  std::size_t nearest_facet(const WorldFacets& facets, WorldFacets::Range range, const Sphere& other) {
    answer_.sphere_tests += range.end - range.begin;
    double least = infinity;
    std::size_t nearest = range.begin;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const double gap = gap_below(facets[i].sphere, other);
      if (gap < least) least = gap, nearest = i;
    }
    return nearest;
  }

  void to_nearest_child(const SearchedBody& body, std::uint32_t& node, Sphere& sphere, const Sphere& other) {
    double least = infinity;
    const std::uint32_t first = body.tree.first_child[node], end = first + body.tree.child_count[node];
    for (std::uint32_t child = first; child < end; ++child) {
      ++answer_.sphere_tests;
      const Sphere s = body.spheres(child);
      const double bound = gap_below(s, other);
      if (bound < least) least = bound, node = child, sphere = s;
    }
  }

  SearchedBody a_, b_;
  const DistanceOptions& options_;
  TimeLimit time_{options_};
  std::vector<WaitingPair>& waiting_;  // a heap, the nearest on top
  std::array<std::uint64_t, 512>& recent_;
  DistanceBounds answer_;
  WitnessLine line_;
  double looked_at_ = infinity;  // least lower bound of the pairs that will not be examined again
  bool is_settled_ = false;
};

}  // namespace

struct DistanceQuery::State {
  CallState call;
  Scratch scratch;
  // The last answer, and its bodies.
  std::uint64_t cover_id_a = 0, cover_id_b = 0;
  std::uint32_t last_a = no_facet, last_b = no_facet;

  void forget() noexcept {
    const CallState kept = call;
    *this = State();
    call = kept;
  }
};

DistanceQuery::DistanceQuery() : state_(std::make_unique<State>()) {}
DistanceQuery::~DistanceQuery() = default;
DistanceQuery::DistanceQuery(DistanceQuery&&) noexcept = default;
DistanceQuery& DistanceQuery::operator=(DistanceQuery&&) noexcept = default;

DistanceBounds DistanceQuery::run(const Collider& a, const Collider& b, const DistanceOptions& options) {
  const StandardFloats standard;
  DistanceBounds bounds;
  bounds.upper = infinity;
  ObjectCall own(*state_, CallKind::begins);
  bounds.status = own.status();
  if (bounds.status) bounds.status = askable(a, 0);
  if (bounds.status) bounds.status = askable(b, 1);
  if (bounds.status &&
      !(options.tolerance >= 0 && options.stop_above >= 0 && options.stop_below >= 0 && options.budget.tests() >= 0))
    bounds.status = {Status::Code::bad_option};
  if (!bounds.status) return bounds;

  State& s = *state_;
  const PairAsRead read(a, b);
  const bool same = s.cover_id_a == a.sphere_state().cover_id && s.cover_id_b == b.sphere_state().cover_id &&
                    s.last_a < a.mesh_facets().size() && s.last_b < b.mesh_facets().size();
  const bool warm = options.warm_start && same;
  Search search(a, b, options, s.scratch);
  DistanceBounds answer = search.run(warm ? s.last_a : no_facet, warm ? s.last_b : no_facet);
  own.finish(read.status());
  bounds.status = s.call.ended;
  if (!bounds.status) return bounds;
  answer.certified = a.sphere_state().covers && b.sphere_state().covers;
  s.cover_id_a = a.sphere_state().cover_id;
  s.cover_id_b = b.sphere_state().cover_id;
  s.last_a = answer.a.facet;
  s.last_b = answer.b.facet;
  return answer;
}

DistanceBounds distance(const Collider& a, const Collider& b, const DistanceOptions& options) {
  const DistanceBounds answer = DistanceQuery().run(a, b, options);
  if (!answer.status) throw std::invalid_argument(message(answer.status));
  return answer;
}

}  // namespace morula
