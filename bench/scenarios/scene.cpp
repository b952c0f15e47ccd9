// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario scene: contacts of 200 bodies that move and bend, in a millisecond of queries; and the pairs of 5,000 boxes
// of which 500 move, by our broad phase, by sweeping along an axis, and by Bullet and FCL.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <morula/geometry/reproducible.hpp>
#include <morula/scene/broad_phase.hpp>
#include <morula/scene/scene.hpp>
#include <morula/tree/sphere_state.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <morula/update/body.hpp>
#include <set>
#include <span>

#include "frames.hpp"
#include "peers.hpp"
#include "resources.hpp"

namespace morula::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t body_count = 200, most_facets_by_force = 3000;
constexpr std::chrono::microseconds time_for_queries = 1000us;

struct Member {
  Body body;
  Collider collider;
  Vec3 middle, axis;
  double phase;
  BodyId id{};
  Member(const Mesh& mesh, const CoveredTree& model, Random& random, const Vec3& at)
      : body(mesh, model),
        collider(mesh, body),
        middle(at),
        axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)},
        phase(random.uniform(0, 6)) {}
};

/// Does some contact own both facets?
bool is_within(const Crossing& crossing, const ScenePair& pair, const Collider& a, const Collider& b) {
  const auto has = [](std::span<const std::uint32_t> facets, std::uint32_t f) {
    return std::find(facets.begin(), facets.end(), f) != facets.end();
  };
  return std::any_of(pair.contacts.begin(), pair.contacts.end(), [&](const Contact& c) {
    return has(a.facets(c.node_a), crossing.facet_a) && has(b.facets(c.node_b), crossing.facet_b);
  });
}

double quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

void add_tail(Result& result) {
  std::size_t in_time = 0;
  for (const double s : result.seconds) in_time += s <= 1.1e-3;
  result.figures.push_back(
      {"share within 1.1 ms", static_cast<double>(in_time) / static_cast<double>(result.seconds.size())});
  result.figures.push_back({"99.9 % us", 1e6 * quantile(result.seconds, 0.999)});
}

/// What the machine makes of a millisecond: as many threads that look at the clock until it is over.
void spin(Workers& workers) {
  const auto start = std::chrono::steady_clock::now();
  parallel_for(workers, workers.thread_count(), 1, [&](std::size_t, std::size_t) {
    while (std::chrono::steady_clock::now() - start < time_for_queries) continue;
  });
}

/// spinning: gets the time of as many frames in which nothing is done.
Result many_bodies(const Input& input, const Settings& settings, std::optional<Budget> budget, const char* item,
                   Result* spinning = nullptr) {
  Result result{.scenario = "scene", .item = item, .mesh = input.name};
  const CoveredTree model = build(input.mesh, {}, *settings.workers);
  const std::vector<Frame> frames = bend_and_back(input.mesh);
  const double size = bounding_box(input.mesh).diagonal();
  // Closely packed: the balls around long bodies reach some twenty others.
  Random random(1);
  std::vector<std::unique_ptr<Member>> members;
  for (std::size_t i = 0; i < body_count; ++i) {
    const Vec3 at{static_cast<double>(i % 6), static_cast<double>(i / 6 % 6), static_cast<double>(i / 36)};
    members.push_back(std::make_unique<Member>(input.mesh, model, random, at * (0.5 * size)));
  }
  SceneOptions options;
  if (budget) options.budget = *budget;
  Scene scene(options);
  // Without a budget every touch is told in its frame.
  Scene whole;
  double near = 0, open = 0, touching = 0, tests = 0, undecided = 0, began = 0, late = 0;
  std::size_t wrong = 0, checked = 0, lost = 0, frame = 0;
  const auto check = [&](std::size_t i, std::size_t j) {
    const Member &a = *members[std::min(i, j)], &b = *members[std::max(i, j)];
    const ScenePair* pair = scene.find(a.id, b.id);
    for (const Crossing& crossing : brute_force::crossings(a.collider, b.collider)) {
      ++checked;
      if (pair == nullptr || !is_within(crossing, *pair, a.collider, b.collider)) ++lost;
    }
  };
  timed(settings, [&] {
    for (std::size_t f = 0; f < frames.size(); ++f, ++frame) {
      for (std::size_t i = 0; i < members.size(); ++i) {
        Member& m = *members[i];
        require(m.body.update(frames[(f + 7 * i) % frames.size()], *settings.workers));
        const double t = 2 * 3.14159265358979 * static_cast<double>(f) / static_cast<double>(frames.size()) + m.phase;
        const Vec3 sway{std::sin(t), std::cos(t), std::sin(2 * t)};
        m.collider.set_transform(RigidTransform::from_axis(m.axis, t, m.middle + sway * (0.05 * size)));
        if (frame == 0) m.id = scene.add(m.collider, {.user_data = i}), whole.add(m.collider);
      }
      // The first frame makes memory.
      if (frame == 0) result.expect(static_cast<bool>(scene.update(*settings.workers)), "the scene was rejected");
      SceneStatus status;
      result.seconds.push_back(seconds_of([&] { status = scene.update(*settings.workers); }));
      if (spinning != nullptr) spinning->seconds.push_back(seconds_of([&] { spin(*settings.workers); }));
      near += static_cast<double>(status.near_pairs), open += static_cast<double>(status.open_pairs);
      require(whole.update(*settings.workers));
      undecided += static_cast<double>(status.undecided_pairs);
      for (const ScenePair& pair : scene.pairs()) touching += pair.touches;
      for (const ScenePair& pair : whole.pairs()) {
        began += pair.began && frame > 0;
        const ScenePair* found = scene.find(pair.a, pair.b);
        late += found == nullptr || !found->touches;
      }
      for (const ScenePair& pair : scene.pairs()) {
        const bool touches = whole.find(pair.a, pair.b) != nullptr;
        wrong += (pair.began || pair.confirmed) && !touches;
        late += pair.touches && !touches;
      }
      for (const EndedPair& pair : scene.ended()) wrong += whole.find(pair.a, pair.b) != nullptr;
      tests += static_cast<double>(status.pair_tests);
      if (frame % 8 != 0 || input.mesh.facet_count() > most_facets_by_force) continue;
      const std::size_t i = random.next() % body_count;
      for (const std::size_t j : {i + 1, i + 6, i + 36})
        if (j < body_count) check(i, j);
      if (scene.pairs().empty()) continue;
      const ScenePair& pair = scene.pairs()[random.next() % scene.pairs().size()];
      check(scene.user_data(pair.a), scene.user_data(pair.b));
    }
  });
  const auto count = static_cast<double>(result.seconds.size());
  result.expect(lost == 0, std::to_string(lost) + " crossings are in no contact");
  result.expect(wrong == 0, std::to_string(wrong) + " events are false");
  result.expect(late <= undecided, "more events are late than pairs were undecided");
  result.expect(checked > 0 || input.mesh.facet_count() > most_facets_by_force, "nothing crosses");
  result.figures = {{"near pairs", near / count},   {"touching", touching / count},
                    {"not finished", open / count}, {"began", began / count},
                    {"late events", late / count},  {"undecided", undecided / count},
                    {"pair tests", tests / count},  {"crossings checked", static_cast<double>(checked)}};
  add_tail(result);
  if (spinning != nullptr) add_tail(*spinning);
  return result;
}

/// Whether the contacts of a pair hold every two final nodes that clearly overlap, by all leaf spheres in double.
bool holds_all(const Collider& a, const Collider& b, std::span<const Contact> contacts) {
  const auto spheres_of = [](const Collider& body) {
    std::vector<Sphere> spheres;
    for (const Spheref& s : body.sphere_state().spheres)
      spheres.push_back({body.transform()(body.sphere_state().origin + Vec3(s.center)), s.radius});
    return spheres;
  };
  const std::vector<Sphere> all_a = spheres_of(a), all_b = spheres_of(b);
  std::set<std::pair<std::uint32_t, std::uint32_t>> found;
  for (const Contact& contact : contacts) found.emplace(contact.node_a, contact.node_b);
  const auto is_within = [&](std::uint32_t leaf_a, std::uint32_t leaf_b) {
    for (std::uint32_t node_a = leaf_a; node_a != no_node; node_a = a.tree().parent[node_a])
      for (std::uint32_t node_b = leaf_b; node_b != no_node; node_b = b.tree().parent[node_b])
        if (found.count({node_a, node_b}) > 0) return true;
    return false;
  };
  const double clear = 1e-3 * all_b[0].radius;
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < all_a.size(); ++i)
    if (a.tree().is_leaf(i) && distance(all_a[i].center, all_b[0].center) < all_a[i].radius + all_b[0].radius)
      near.push_back(i);
  for (const std::uint32_t i : near)
    for (std::uint32_t j = 0; j < all_b.size(); ++j)
      if (b.tree().is_leaf(j) &&
          distance(all_a[i].center, all_b[j].center) < all_a[i].radius + all_b[j].radius - clear && !is_within(i, j))
        return false;
  return true;
}

/// Bodies that arrive, one in each frame, at a terrain of a ball per facet; the time of the update in which one does.
Result arrivals(const Input& input, const Settings& settings, const Budget& budget, const char* item) {
  Result result{.scenario = "scene", .item = item, .mesh = input.name};
  constexpr int side = 500;
  const CoveredTree model = build(input.mesh, {}, *settings.workers);
  const double size = bounding_box(input.mesh).diagonal(), cell = size / 25;
  const auto corner = [&](int i, int j) {
    return Vec3{i * cell, j * cell, 0.1 * size * std::sin(0.2 * i) * std::cos(0.3 * j)};
  };
  std::vector<Sphere> balls;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      for (const bool upper : {false, true}) {
        const Vec3 p = corner(i + 1, j), q = corner(i, j + 1), r = upper ? corner(i + 1, j + 1) : corner(i, j);
        const Vec3 middle = (p + q + r) / 3.0;
        balls.push_back({middle, std::max({distance(middle, p), distance(middle, q), distance(middle, r)})});
      }
  const PosedSpheres land(tree_from_spheres(balls), true);
  const Collider terrain(land.sphere_state());
  const Body body(input.mesh, model);
  constexpr int count = 20;
  std::vector<std::unique_ptr<Collider>> colliders;
  Scene scene({.budget = budget});
  const BodyId ground = scene.add(terrain, {.is_static = true});
  std::vector<BodyId> ids;
  for (int i = 0; i < count; ++i) {
    colliders.push_back(std::make_unique<Collider>(input.mesh, body));
    colliders.back()->set_transform({.translation = {2 * size * i, 0, 100 * size}});
    ids.push_back(scene.add(*colliders.back()));
  }
  require(scene.update(*settings.workers));
  std::size_t contacts = 0, wrong = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    colliders[i]->set_transform({.translation = {0.9 * size * static_cast<double>(i), 5 * size, 0}});
    SceneStatus status;
    result.seconds.push_back(seconds_of([&] { status = scene.update(*settings.workers); }));
    require(status);
    const ScenePair* pair = scene.find(ground, ids[i]);
    if (pair != nullptr) contacts += pair->contacts.size();
    if (i % 5 == 0) wrong += pair == nullptr || !holds_all(terrain, *colliders[i], pair->contacts);
  }
  result.expect(wrong == 0, "a contact with the terrain is missing");
  result.figures = {{"contacts a pair", static_cast<double>(contacts) / count},
                    {"worst us", 1e6 * *std::max_element(result.seconds.begin(), result.seconds.end())}};
  return result;
}

/// All boxes sorted anew along x, where they are nearly sorted; then each is compared with those that begin before it
/// ends.
class AxisSweep final : public BoxPeer {
 public:
  AxisSweep(std::span<const Box> boxes, std::size_t moving_count)
      : boxes_(boxes.begin(), boxes.end()), moving_count_(moving_count) {
    for (std::uint32_t i = 0; i < boxes_.size(); ++i) order_.push_back(i);
  }
  void move(std::size_t box, const Box& to) override { boxes_[box] = to; }
  void find(std::vector<std::uint64_t>& pairs) override {
    for (std::size_t i = 1; i < order_.size(); ++i)
      for (std::size_t j = i; j > 0 && boxes_[order_[j]].lower.x < boxes_[order_[j - 1]].lower.x; --j)
        std::swap(order_[j], order_[j - 1]);
    sorted_.clear();
    for (const std::uint32_t i : order_) sorted_.push_back(boxes_[i]);
    for (std::size_t i = 0; i < sorted_.size(); ++i)
      for (std::size_t j = i + 1; j < sorted_.size() && sorted_[j].lower.x <= sorted_[i].upper.x; ++j) {
        const Box &a = sorted_[i], &b = sorted_[j];
        if (a.lower.y > b.upper.y || b.lower.y > a.upper.y || a.lower.z > b.upper.z || b.lower.z > a.upper.z) continue;
        const std::uint64_t x = std::min(order_[i], order_[j]), y = std::max(order_[i], order_[j]);
        if (x < moving_count_) pairs.push_back(x << 32 | y);
      }
  }

 private:
  std::vector<Box> boxes_, sorted_;
  std::vector<std::uint32_t> order_;
  std::size_t moving_count_;
};

std::unique_ptr<BoxPeer> make_axis_sweep(std::span<const Box> boxes, std::size_t moving_count) {
  return std::make_unique<AxisSweep>(boxes, moving_count);
}

class OwnBoxes final : public BoxPeer {
 public:
  OwnBoxes(std::span<const Box> boxes, std::size_t moving_count) {
    for (std::size_t i = 0; i < boxes.size(); ++i) broad_.add(boxes[i], i >= moving_count);
  }
  void move(std::size_t box, const Box& to) override { require(broad_.move(static_cast<std::uint32_t>(box), to)); }
  void find(std::vector<std::uint64_t>& pairs) override {
    broad_.update();
    for (const BoxPair& pair : broad_.pairs()) pairs.push_back(std::uint64_t{pair.a} << 32 | pair.b);
  }

 private:
  BroadPhase broad_;
};

std::unique_ptr<BoxPeer> make_own(std::span<const Box> boxes, std::size_t moving_count) {
  return std::make_unique<OwnBoxes>(boxes, moving_count);
}

std::vector<Result> boxes_of(const Settings& settings, std::size_t count, std::size_t moving_count, double step,
                             const std::string& name) {
  const double room = std::cbrt(static_cast<double>(count)) * 0.6;
  Random random(2);
  const auto somewhere = [&](double reach) {
    return Vec3{random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
  };
  std::vector<Box> boxes;
  std::vector<Vec3> velocities;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 lower = somewhere(room);
    boxes.push_back(
        {lower, lower + Vec3{random.uniform(0.4, 1.2), random.uniform(0.4, 1.2), random.uniform(0.4, 1.2)}});
    velocities.push_back(somewhere(step));
  }
  std::vector<BoxPeerKind> kinds{{"morula, tree", "", make_own}, {"one axis swept", "", make_axis_sweep}};
  kinds.insert(kinds.end(), box_peer_kinds().begin(), box_peer_kinds().end());
  std::vector<std::unique_ptr<BoxPeer>> peers;
  std::vector<Result> results;
  for (const BoxPeerKind& kind : kinds) {
    peers.push_back(kind.make(boxes, moving_count));
    results.push_back({.scenario = "scene", .item = kind.name + (", " + name), .mesh = "boxes"});
    if (!peers.back()) results.back().note = std::string("peer not built: install ") + kind.package;
  }
  std::vector<std::size_t> missed(kinds.size()), more(kinds.size());
  double pairs = 0;
  std::vector<std::uint64_t> exact, found;
  for (int frame = 0; frame < 25 * settings.repeats; ++frame) {
    for (std::size_t i = 0; i < moving_count; ++i) {
      for (int axis = 0; axis < 3; ++axis)
        if (std::abs(boxes[i].center()[axis] + velocities[i][axis]) > room) velocities[i][axis] = -velocities[i][axis];
      boxes[i].lower = boxes[i].lower + velocities[i], boxes[i].upper = boxes[i].upper + velocities[i];
    }
    // The sweep gives what all have to give; who comes first changes with the frame.
    exact.clear();
    AxisSweep(boxes, moving_count).find(exact);
    std::sort(exact.begin(), exact.end());
    pairs += static_cast<double>(exact.size());
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const std::size_t which = (k + static_cast<std::size_t>(frame)) % kinds.size();
      if (!peers[which]) continue;
      found.clear();
      const double seconds = processor_seconds_of([&] {
        for (std::size_t i = 0; i < moving_count; ++i) peers[which]->move(i, boxes[i]);
        peers[which]->find(found);
      });
      if (frame > 0) results[which].seconds.push_back(seconds);  // the first makes memory
      std::sort(found.begin(), found.end());
      std::size_t common = 0;
      for (auto x = exact.begin(), y = found.begin(); x != exact.end() && y != found.end();) {
        if (*x == *y)
          ++common, ++x, ++y;
        else if (*x < *y)
          ++x;
        else
          ++y;
      }
      missed[which] += exact.size() - common, more[which] += found.size() - common;
    }
  }
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (!peers[k]) continue;
    const auto frames = static_cast<double>(25 * settings.repeats);
    results[k].figures = {{"pairs", pairs / frames},
                          {"more pairs", static_cast<double>(more[k]) / frames},
                          {"missed", static_cast<double>(missed[k]) / frames},
                          {"times ours", median(results[k].seconds) / median(results[0].seconds)}};
  }
  results[0].expect(missed[0] == 0, "pairs are missing");
  results[0].expect(more[0] == 0, "there are pairs that do not overlap");
  results[0].expect(pairs > 0, "nothing overlaps");
  return results;
}

}  // namespace

std::vector<Result> run_scene(const Input& input, const Settings& settings) {
  std::vector<Result> results;
  Result spinning{.scenario = "scene", .item = "a clock for 1 ms", .mesh = input.name};
  results.push_back(many_bodies(input, settings, time_for_queries, "200 bodies, 1 ms", &spinning));
  results.push_back(std::move(spinning));
  results.push_back(many_bodies(input, settings, Budget(100000), "200 bodies, 100,000 tests"));
  results.push_back(many_bodies(input, settings, std::nullopt, "200 bodies, to the end"));
  results.push_back(many_bodies(input, settings, Budget(20ms), "200 bodies, 20 ms"));
  results.push_back(arrivals(input, settings, Budget(1ms), "arrival at 500,000 facets, 1 ms"));
  results.push_back(arrivals(input, settings, Budget(3000), "arrival at 500,000 facets, 3,000 tests"));
  for (Result& result : boxes_of(settings, 5000, 500, 0.05, "500 of 5,000 move")) results.push_back(std::move(result));
  for (Result& result : boxes_of(settings, 1000, 1000, 0.05, "1,000 of 1,000 move"))
    results.push_back(std::move(result));
  return results;
}

}  // namespace morula::bench
