// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/robot/self_collision.hpp>
#include <mutex>
#include <numeric>

#include "fit/pair_chain.hpp"
#include "fit/pair_search.hpp"
#include "fit/rest_surfaces.hpp"
#include "fit/sphere_group.hpp"
#include "read/xml.hpp"

namespace morula::robot {

namespace {

// The limits of work of each step. Limits are counts, not times: results have to be the same everywhere.
constexpr std::size_t first_samples = 1000;               // in which every pair is tested, and its overlaps are counted
constexpr std::size_t configurations_a_chunk = 64;        // of parallel loops
constexpr std::size_t boxes_of_a_proof = 30'000;          // about 0.1 s if all of them are examined
constexpr std::size_t most_rounds_of_samples = 8;         // multiple of the requested number
constexpr std::size_t most_sphere_tests = 2'000'000'000;  // about 10 s of one thread
constexpr double nearly_every = 0.95;                     // share of the first samples

/// Two links with spheres, by their places among these.
struct Pair {
  std::size_t a = 0, b = 0;
  std::optional<IgnoreReason> reason{};
  PairChain chain{};
  bool overlaps_at_rest = false, meets = false;  // meets: in some configuration that was found
  std::size_t overlaps = 0;                      // among the first samples
};

/// The pairs that meet in the configurations of a chunk.
struct Sampled {
  std::vector<std::size_t> met{};       // indices of pairs
  std::vector<std::uint32_t> counts{};  // numbers of overlaps, one per pair; empty: not requested
  std::size_t tests = 0;
};

class Finder {
 public:
  Finder(const Robot& robot, const RobotSpheres& spheres, const SelfCollisionOptions& options, Workers& workers)
      : robot_(robot), spheres_(spheres), o_(options), workers_(workers), place_(robot.links.size(), none) {
    double size = 0;
    for (std::size_t i = 0; i < spheres.links.size(); ++i) {
      place_[spheres.links[i].link] = i;
      groups_.push_back(group_of(spheres.links[i].spheres));
      size += groups_.back().extent;
    }
    for (const Joint& joint : robot.joints) size += length(joint.origin.translation);
    ranges_ = joint_ranges(robot, size);
    for (std::size_t a = 0; a < groups_.size(); ++a) {
      for (std::size_t b = a + 1; b < groups_.size(); ++b) pairs_.push_back({.a = a, .b = b});
    }
  }

  SelfCollision run() {
    mark_given_and_adjacent();
    mark_touching_at_rest();
    for (Pair& pair : pairs_) {
      if (!pair.reason) pair.chain = chain_of(robot_, ranges_, link(pair.a), link(pair.b));
    }
    tell(0);
    const std::size_t first = std::min(first_samples, o_.samples);
    sample(0, first, true);
    samples_ = first;
    tell(share_of_first);
    search();
    sample_until_steady();
    for (Pair& pair : pairs_) {
      if (is_open(pair) && samples_ > 0) pair.reason = IgnoreReason::never;
    }
    tell(1);
    return result();
  }

 private:
  static constexpr double share_of_first = 0.05, share_of_search = 0.5;  // of the work, for the progress

  std::size_t link(std::size_t place) const { return spheres_.links[place].link; }
  const std::string& name_of(std::size_t place) const { return robot_.links[link(place)].name; }
  LinkPair search_pair(const Pair& pair) const { return {pair.chain, ranges_, groups_[pair.a], groups_[pair.b]}; }
  /// Whether the pair may still turn out never to meet.
  static bool is_open(const Pair& pair) { return !pair.reason && !pair.meets && pair.chain.usable; }

  void stop_on_request() const {
    if (o_.stop.stop_requested()) throw BuildStopped();
  }
  void tell(double share) const {
    stop_on_request();
    if (o_.progress) o_.progress(share);
  }

  void mark(std::size_t link_a, std::size_t link_b, IgnoreReason reason) {
    if (link_a == none || link_b == none || place_[link_a] == none || place_[link_b] == none) return;
    const std::size_t low = std::min(place_[link_a], place_[link_b]), high = std::max(place_[link_a], place_[link_b]);
    if (low == high) return;
    Pair& pair = pairs_[low * (2 * groups_.size() - low - 1) / 2 + (high - low - 1)];
    if (!pair.reason) pair.reason = reason;
  }

  void mark_given_and_adjacent() {
    for (const auto& [a, b] : o_.given) mark(robot_.find_link(a), robot_.find_link(b), IgnoreReason::given);
    // Joints chain links without spheres between two that have some.
    std::vector<std::size_t> nearest(robot_.links.size(), none);  // the link with spheres that carries a link
    std::vector<std::size_t> body(robot_.links.size());           // the first link of those that move as one
    std::iota(body.begin(), body.end(), std::size_t{0});
    for (const std::size_t i : robot_.order) {
      const Joint& joint = robot_.joints[i];
      nearest[joint.child] = place_[joint.parent] != none ? joint.parent : nearest[joint.parent];
      mark(joint.child, nearest[joint.child], IgnoreReason::adjacent);
      // mutant robot-pairs-floating: `joint.kind == Joint::Kind::fixed` -> `!joint.moves()`
      if (joint.kind == Joint::Kind::fixed) body[joint.child] = body[joint.parent];
    }
    // mutant robot-pairs-rigid: `body[link(pair.a)] == body[link(pair.b)]` -> `false`
    for (const Pair& pair : pairs_)
      if (body[link(pair.a)] == body[link(pair.b)]) mark(link(pair.a), link(pair.b), IgnoreReason::adjacent);
  }

  /// Overlapping spheres do not suffice: the surfaces inside them decide.
  void mark_touching_at_rest() {
    const std::vector<RigidTransform> poses = link_poses(robot_, rest_values(robot_));
    std::vector<std::size_t> near, used;  // pairs, places
    std::size_t tests = 0;
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      Pair& pair = pairs_[p];
      if (pair.reason) continue;
      if (!groups_meet(groups_[pair.a], poses[link(pair.a)], groups_[pair.b], poses[link(pair.b)], tests)) continue;
      pair.overlaps_at_rest = pair.meets = true;
      near.push_back(p);
      used.insert(used.end(), {pair.a, pair.b});
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const RestSurfaces surfaces(robot_, spheres_, poses, used, workers_);
    std::vector<double> distances(near.size());
    workers_.run(near.size(), [&](std::size_t i) {
      if (o_.stop.stop_requested()) return;
      distances[i] = surfaces.distance(pairs_[near[i]].a, pairs_[near[i]].b);
    });
    stop_on_request();
    for (std::size_t i = 0; i < near.size(); ++i) {
      // mutant robot-pairs-surfaces: `0` -> `1`
      if (distances[i] <= 0) {
        pairs_[near[i]].reason = IgnoreReason::rest;
      } else {
        overlapping_.push_back({link(pairs_[near[i]].a), link(pairs_[near[i]].b), distances[i], 0});
      }
    }
  }

  /// The k-th configuration is the k-th of one long sequence of random numbers, for any thread that draws it.
  std::vector<double> configuration(std::size_t k) const {
    constexpr std::uint64_t step_of_random = 0x9e3779b97f4a7c15u;  // of Random's state
    Random random(o_.seed + step_of_random * (k * ranges_.coordinates.size()));
    std::vector<double> values;
    for (const CoordinateRange& range : ranges_.coordinates) values.push_back(random.uniform(range.lower, range.upper));
    return values;
  }

  /// Tests the configurations [begin, end). all: counts the overlaps of every pair that is not ignored, else looks for
  /// open pairs that meet. Returns whether some open pair met.
  bool sample(std::size_t begin, std::size_t end, bool all) {
    std::vector<std::size_t> tested;
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      if (all ? !pairs_[p].reason : is_open(pairs_[p])) tested.push_back(p);
    }
    if (tested.empty() || begin == end) return false;
    const std::size_t count = end - begin, grain = configurations_a_chunk;
    std::vector<Sampled> chunks((count + grain - 1) / grain);
    parallel_for(workers_, count, grain, [&](std::size_t from, std::size_t to) {
      if (!o_.stop.stop_requested()) chunks[from / grain] = sample_chunk(tested, begin + from, begin + to, all);
    });
    stop_on_request();
    bool some = false;
    for (const Sampled& chunk : chunks) {
      sphere_tests_ += chunk.tests;
      for (std::size_t i = 0; i < chunk.counts.size(); ++i) pairs_[tested[i]].overlaps += chunk.counts[i];
      for (const std::size_t p : chunk.met) {
        some = some || is_open(pairs_[p]);
        pairs_[p].meets = true;
      }
    }
    return some;
  }

  Sampled sample_chunk(std::vector<std::size_t> tested, std::size_t begin, std::size_t end, bool all) const {
    Sampled result;
    if (all) result.counts.resize(tested.size());
    for (std::size_t k = begin; k < end; ++k) {
      const std::vector<RigidTransform> poses = link_poses(robot_, configuration(k));
      for (std::size_t i = 0; i < tested.size();) {
        const Pair& pair = pairs_[tested[i]];
        const bool met =
            groups_meet(groups_[pair.a], poses[link(pair.a)], groups_[pair.b], poses[link(pair.b)], result.tests);
        if (met && all && result.counts[i]++ == 0) result.met.push_back(tested[i]);
        if (met && !all) {
          result.met.push_back(tested[i]);
          tested[i] = tested.back();
          tested.pop_back();
        } else {
          ++i;
        }
      }
    }
    return result;
  }

  /// Decides open pairs by proof, or by going downhill to a contact.
  void search() {
    std::vector<std::size_t> open;
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      if (is_open(pairs_[p])) open.push_back(p);
    }
    detail::Mutex one_call;
    std::size_t done = 0;
    workers_.run(open.size(), [&](std::size_t i) {
      if (o_.stop.stop_requested()) return;
      Pair& pair = pairs_[open[i]];
      const LinkPair searched = search_pair(pair);
      // mutant robot-pairs-descent: `o_.samples > 0` -> `false`
      if (o_.samples > 0 && descend_to_contact(searched, o_.seed + open[i], o_.stop)) {
        pair.meets = true;
      } else {
        const Verdict verdict = prove_apart(searched, boxes_of_a_proof, o_.stop);
        if (verdict == Verdict::meet) pair.meets = true;
        if (verdict == Verdict::apart) pair.reason = IgnoreReason::apart;
      }
      const std::lock_guard lock(one_call);
      ++done;
      const double part = static_cast<double>(done) / static_cast<double>(open.size());
      if (o_.progress) o_.progress(share_of_first + (share_of_search - share_of_first) * part);
    });
    stop_on_request();
  }

  /// Samples until no open pair has met in as many further samples.
  void sample_until_steady() {
    std::size_t last_met = samples_;
    const std::size_t most = most_rounds_of_samples * o_.samples;
    while (samples_ < most && (samples_ < o_.samples || samples_ < 2 * last_met)) {
      if (std::none_of(pairs_.begin(), pairs_.end(), is_open)) {
        samples_ = std::max(samples_, o_.samples);
        return;
      }
      if (sphere_tests_ > most_sphere_tests) return;
      const std::size_t wanted = std::max(o_.samples, 2 * last_met);
      const std::size_t end = std::min({samples_ + std::max(samples_ / 4, first_samples), wanted, most});
      if (sample(samples_, end, false)) last_met = end;
      samples_ = end;
      tell(share_of_search + (1 - share_of_search) * static_cast<double>(end) / static_cast<double>(wanted));
    }
  }

  SelfCollision result() {
    SelfCollision result;
    result.samples = samples_;
    result.pairs = pairs_.size();
    const std::size_t counted = std::min(first_samples, o_.samples);
    for (const Pair& pair : pairs_) {
      if (pair.reason) {
        result.ignored.push_back({link(pair.a), link(pair.b), *pair.reason});
        continue;
      }
      const double share = counted > 0 ? static_cast<double>(pair.overlaps) / static_cast<double>(counted) : 0;
      if (!pair.overlaps_at_rest && share < nearly_every) continue;
      OverlappingPair to{.a = link(pair.a), .b = link(pair.b), .rest_distance = {}, .share = share};
      for (const OverlappingPair& at_rest : overlapping_) {
        if (at_rest.a == to.a && at_rest.b == to.b) to.rest_distance = at_rest.rest_distance;
      }
      result.overlapping.push_back(to);
    }
    result.notes = notes(result);
    return result;
  }

  std::vector<std::string> notes(const SelfCollision& found) const {
    std::vector<std::string> texts, at_rest, often;
    for (const OverlappingPair& pair : found.overlapping) {
      const std::string names = fmt::format("{}-{}", robot_.links[pair.a].name, robot_.links[pair.b].name);
      if (pair.rest_distance) at_rest.push_back(fmt::format("{} ({:.3g})", names, *pair.rest_distance));
      if (pair.share >= nearly_every) often.push_back(fmt::format("{} ({:.1f} %)", names, 100 * pair.share));
    }
    if (!at_rest.empty()) {
      texts.push_back(
          fmt::format("spheres overlap at rest although the surfaces are apart, by the distance in brackets: {}; these "
                      "pairs are tested. More spheres part them (--link LINK=N), or half the distance as "
                      "--max-protrusion",
                      fmt::join(at_rest, ", ")));
    }
    if (!often.empty()) {
      texts.push_back(
          fmt::format("spheres overlap in nearly every configuration, in the share in brackets: {}; these "
                      "pairs are tested. If they need no test, list them in an SRDF (--srdf)",
                      fmt::join(often, ", ")));
    }
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const Joint& joint = robot_.joints[i];
      if (!ranges_.usable[i] && joint.moves()) {
        texts.push_back(
            fmt::format("joint {} has {}: every pair of links that it moves against each other is tested, "
                        "unless the surfaces touch at rest",
                        joint.name, joint.range_known ? "a range far larger than the robot" : "no known range"));
      }
    }
    return texts;
  }

  const Robot& robot_;
  const RobotSpheres& spheres_;
  const SelfCollisionOptions& o_;
  Workers& workers_;
  std::vector<std::size_t> place_;  // of a link among those with spheres
  std::vector<SphereGroup> groups_;
  JointRanges ranges_;
  std::vector<Pair> pairs_;
  std::vector<OverlappingPair> overlapping_;  // at rest
  std::size_t samples_ = 0, sphere_tests_ = 0;
};

}  // namespace

std::string_view name(IgnoreReason reason) {
  switch (reason) {
    case IgnoreReason::given:
      return "User";
    case IgnoreReason::adjacent:
      return "Adjacent";
    case IgnoreReason::rest:
      return "Default";
    case IgnoreReason::apart:
    case IgnoreReason::never:
      return "Never";
  }
  return "";
}

bool overlap(std::span<const Sphere> a, const RigidTransform& at_a, std::span<const Sphere> b,
             const RigidTransform& at_b) {
  const RigidTransform to_b = relative_to(at_b, at_a);
  return std::any_of(a.begin(), a.end(), [&](const Sphere& s) {
    const Vec3 center = to_b(s.center);
    return std::any_of(b.begin(), b.end(), [&](const Sphere& t) {
      const double reach = s.radius + t.radius;
      return squared_distance(center, t.center) <= reach * reach;
    });
  });
}

SelfCollision find_ignored(const Robot& robot, const RobotSpheres& spheres, const SelfCollisionOptions& options,
                           WorkersOrAll given) {
  Workers& workers = given;
  return Finder(robot, spheres, options, workers).run();
}

std::vector<std::array<std::string, 2>> read_ignored_pairs(const std::filesystem::path& srdf) {
  const Xml xml(srdf, "robot");
  std::vector<std::array<std::string, 2>> pairs;
  constexpr const char* element = "disable_collisions";
  for (auto at = xml.root().FirstChildElement(element); at != nullptr; at = at->NextSiblingElement(element)) {
    pairs.push_back({xml.text(*at, "link1"), xml.text(*at, "link2")});
  }
  return pairs;
}

}  // namespace morula::robot
