// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A model of a scene, walked at random: any call may follow any other, and after each update brute force over facets
// says what the scene has to tell.
#pragma once

#include <chrono>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "scene_bodies.hpp"

namespace morula::test {

/// What a caller of a scene does. Any list of calls is a walk: a call that is out of place is rejected, or does
/// nothing.
struct Call {
  enum Kind : std::uint8_t {
    add,
    remove,
    replace,  ///< another collider of the same body; the one before is destroyed
    swap,     ///< the same with another tree
    place,
    nudge,
    part,  ///< far away from all others
    deform,
    reject,  ///< an update of the body that is rejected: the body is not current
    heal,    ///< good ones, of all bodies that are not current
    sleep,
    wake,
    set_masks,
    set_options,
    update,
    update_that_throws,
    ask,  ///< rays and shapes
    count
  };
  Kind kind = update;
  std::uint32_t body = 0;  ///< by its number in the model
  std::uint64_t seed = 0;  ///< of what else is random in it

  static constexpr const char* names[count] = {
      "add",    "remove", "replace", "swap", "place",     "nudge",       "part",   "deform",
      "reject", "heal",   "sleep",   "wake", "set_masks", "set_options", "update", "update_that_throws",
      "ask"};
  std::string words() const {
    std::ostringstream text;
    text << "{Call::" << names[kind] << ", " << body << ", " << seed << "u}";
    return text.str();
  }
};

class SceneWalk {
 public:
  static constexpr std::uint32_t body_count = 8;

  /// So many calls. Most move bodies or look at them, and few take something away.
  static std::vector<Call> random_calls(std::uint64_t seed, std::size_t count) {
    constexpr std::uint32_t shares[Call::count] = {8, 2, 3, 3, 14, 8, 3, 8, 1, 3, 5, 5, 2, 4, 24, 5, 3};
    std::vector<Call::Kind> kinds;
    for (std::uint8_t kind = 0; kind < Call::count; ++kind)
      kinds.insert(kinds.end(), shares[kind], static_cast<Call::Kind>(kind));
    Random random(seed);
    std::vector<Call> calls(count);
    for (Call& call : calls) {
      call.kind = kinds[random.next() % kinds.size()];
      call.body = static_cast<std::uint32_t>(random.next() % body_count);
      call.seed = random.next() % 1'000'000;
    }
    return calls;
  }

  SceneWalk() {
    for (std::uint32_t i = 0; i < body_count; ++i) bodies_.push_back(std::make_unique<Member>(i));
  }

  /// What is wrong after one of these calls, of a new scene; nothing where all is right.
  std::string run(std::span<const Call> calls) {
    begin();
    for (std::size_t i = 0; i < calls.size(); ++i) {
      if (std::string fault = make(calls[i]); !fault.empty()) {
        made_ = i + 1;
        return "call " + std::to_string(i) + ", " + calls[i].words() + ": " + fault;
      }
    }
    made_ = calls.size();
    return {};
  }
  /// Calls of the last run, to its fault.
  std::size_t made() const { return made_; }

  /// Leaves out calls as long as something is still wrong.
  std::vector<Call> shrunk(std::vector<Call> calls, std::size_t most_runs) {
    for (std::size_t length = calls.size() / 2; length > 0 && most_runs > 0;) {
      bool shorter = false;
      for (std::size_t at = 0; at + length <= calls.size() && most_runs > 0; --most_runs) {
        std::vector<Call> fewer(calls.begin(), calls.begin() + static_cast<std::ptrdiff_t>(at));
        fewer.insert(fewer.end(), calls.begin() + static_cast<std::ptrdiff_t>(at + length), calls.end());
        if (run(fewer).empty()) {
          at += length;
          continue;
        }
        fewer.resize(made_);
        calls = std::move(fewer);
        shorter = true;
      }
      if (!shorter || length > calls.size()) length = std::min(length, calls.size()) / 2;
    }
    return calls;
  }

  // Of all runs.
  std::size_t updates = 0, rejected = 0, thrown = 0, interrupted = 0, crossed = 0, began = 0, ended = 0;
  std::size_t unconfirmed = 0, kept = 0;  // pairs that may touch, and touches that the last update left open

 private:
  struct Bomb {};

  /// A body of the caller, and what the model knows of it.
  struct Member {
    explicit Member(std::uint32_t number)
        : mesh(thing_mesh(number)), bodies{Body(mesh, tree(number % 3, 0)), Body(mesh, tree(number % 3, 1))} {}
    /// Two trees of each kind of mesh, built once.
    static std::shared_ptr<const CoveredTree> tree(std::size_t kind, std::size_t which) {
      static std::shared_ptr<const CoveredTree> all[3][2];
      std::shared_ptr<const CoveredTree>& known = all[kind][which];
      if (!known)
        known = std::make_shared<const CoveredTree>(
            build(thing_mesh(kind), {.method = which == 0 ? Method::octree : Method::grid,
                                     .branching = 8,
                                     .depth = which == 0 ? 2 : static_cast<int>(kind) + 1}));
      return known;
    }
    void begin() {
      collider.reset();
      positions = mesh.positions;
      for (Body& body : bodies) ASSERT_TRUE(body.update(positions));
      which = 0;
      transform = {};
      id = {};
      is_in = is_rejected = is_asleep = is_to_be_read = has_moved = is_known = false;
    }
    void make_collider() {
      collider = std::make_unique<Collider>(mesh, bodies[which]);
      collider->set_transform(transform);
    }
    bool is_read() const { return is_in && (is_to_be_read || !(is_asleep || options.is_static)); }

    Mesh mesh;
    Body bodies[2];
    std::size_t which = 0;
    std::vector<Vec3> positions;
    RigidTransform transform;
    std::unique_ptr<Collider> collider;
    SceneBodyOptions options;
    BodyId id;
    bool is_in = false, is_asleep = false;
    bool is_rejected = false;    // the body's last update
    bool is_to_be_read = false;  // by the next update, asleep or static as it may be
    bool has_moved = false;      // since an update read it
    bool is_known = false;       // an update has read it as it is: what the scene says of it has to be true
  };

  void begin() {
    scene_.reset();
    for (const auto& member : bodies_) member->begin();
    options_ = {};
    salt_ = fuse_ = 0;
    time_ = {};
    rereads_all_ = rereads_extras_ = was_thrown_ = false;
    touching_.clear();
    given_touches_.clear();
    given_bodies_.clear();
    scene_.emplace();
  }

  std::string make(const Call& call) {
    Random random(call.seed);
    Member& member = *bodies_[call.body % body_count];
    switch (call.kind) {
      case Call::add:
        return add(member, random);
      case Call::remove:
        if (!member.is_in) return misses(member, [&] { scene_->remove(member.id); });
        scene_->remove(member.id);
        member.is_in = false;
        member.collider.reset();
        return {};
      case Call::swap:
      case Call::replace:
        return replace(member, call.kind == Call::swap);
      case Call::place:
        return moved(member, random_transform(random, 1.0));
      case Call::part: {
        RigidTransform far = member.transform;
        far.translation = random_point(random, 1) + Vec3{20.0 * (1 + call.body), 0, 0};
        return moved(member, far);
      }
      case Call::nudge: {
        RigidTransform near = member.transform;
        near.translation = near.translation + random_point(random, 0.02);
        return moved(member, near);
      }
      case Call::deform: {
        const Vec3 stretch{random.uniform(0.8, 1.3), random.uniform(0.8, 1.3), random.uniform(0.8, 1.3)};
        for (std::size_t v = 0; v < member.positions.size(); ++v) {
          const Vec3 p = member.mesh.positions[v];
          member.positions[v] = Vec3{p.x * stretch.x, p.y * stretch.y, p.z * stretch.z} + random_point(random, 0.05);
        }
        return follow(member);
      }
      case Call::heal:
        for (const auto& any : bodies_)
          if (any->is_rejected) follow(*any);
        return {};
      case Call::reject: {
        std::vector<Vec3> bad = member.positions;
        bad[random.next() % bad.size()].x = std::numeric_limits<double>::quiet_NaN();
        if (member.bodies[member.which].update(bad)) return "a body took what is not finite";
        member.is_rejected = true;
        return {};
      }
      case Call::sleep:
      case Call::wake: {
        const bool sleeps = call.kind == Call::sleep;
        if (!member.is_in) return misses(member, [&] { sleeps ? scene_->sleep(member.id) : scene_->wake(member.id); });
        sleeps ? scene_->sleep(member.id) : scene_->wake(member.id);
        member.is_asleep = sleeps;
        member.is_to_be_read = true;
        return scene_->is_asleep(member.id) == sleeps ? "" : "is_asleep() is wrong";
      }
      case Call::set_masks: {
        const SceneBodyOptions masks = random_masks(random);
        if (!member.is_in) return misses(member, [&] { scene_->set_masks(member.id, masks.category, masks.mask); });
        scene_->set_masks(member.id, masks.category, masks.mask);
        member.options.category = masks.category, member.options.mask = masks.mask;
        return {};
      }
      case Call::set_options:
        set_options(random);
        return {};
      case Call::update:
        return update(random, 0);
      case Call::update_that_throws:
        return update(random, 1 + random.next() % 6);
      case Call::ask:
        return ask(random);
      case Call::count:
        break;
    }
    return "no such call";
  }

  /// A call about a body that is not in the scene.
  template <class F>
  std::string misses(const Member& member, const F& f) const {
    if (member.id.generation == 0) return {};  // it never was
    try {
      f();
    } catch (const std::invalid_argument&) {
      return scene_->has(member.id) ? "has() knows a body that was removed" : "";
    }
    return "a body that was removed was accepted";
  }

  static SceneBodyOptions random_masks(Random& random) {
    // Most meet all.
    const std::uint64_t with = random.next() % 24;
    return {.category = 1u << (random.next() % 3), .mask = static_cast<std::uint32_t>(with < 8 ? with : 7)};
  }

  std::string add(Member& member, Random& random) {
    if (member.is_in) return {};
    member.options = random_masks(random);
    member.options.is_static = random.next() % 6 == 0;
    member.options.weight = random.uniform(0, 2);
    member.options.user_data = random.next() % 100;
    member.make_collider();
    const std::size_t size = scene_->size();
    try {
      member.id = scene_->add(*member.collider, member.options);
    } catch (const std::invalid_argument&) {
      if (!member.is_rejected) return "a good body was rejected";
      if (scene_->size() != size) return "a body that was rejected was added";
      member.collider.reset();
      return {};
    }
    if (member.is_rejected) return "a body that is not current was added";
    if (!given_bodies_.emplace(member.id.place, member.id.generation).second) return "a BodyId was given again";
    member.is_in = member.is_to_be_read = member.has_moved = true;
    member.is_asleep = member.is_known = false;
    return {};
  }

  std::string replace(Member& member, bool swaps) {
    if (!member.is_in) return {};
    const std::size_t next = swaps ? 1 - member.which : member.which;
    if (swaps && !member.bodies[next].update(member.positions)) return "a good update was rejected";
    auto other = std::make_unique<Collider>(member.mesh, member.bodies[next]);
    other->set_transform(member.transform);
    const bool is_rejected = !swaps && member.is_rejected;
    try {
      scene_->replace(member.id, *other);
      if (is_rejected) return "a collider of a body that is not current was accepted";
    } catch (const std::invalid_argument&) {
      return is_rejected ? "" : "a good collider was rejected";
    }
    member.collider = std::move(other);
    member.which = next;
    member.is_rejected = false;
    member.is_to_be_read = member.has_moved = true;
    return {};
  }

  std::string moved(Member& member, const RigidTransform& transform) {
    member.transform = transform;
    if (member.collider) member.collider->set_transform(transform);
    member.has_moved = true;
    return {};
  }
  std::string follow(Member& member) {
    if (!member.bodies[member.which].update(member.positions)) return "a good update was rejected";
    member.is_rejected = false;
    member.has_moved = true;
    return {};
  }

  void set_options(Random& random) {
    SceneOptions next;
    if (random.next() % 4 == 0) next.level = static_cast<std::uint32_t>(random.next() % 4);
    next.margin = random.next() % 3 == 0 ? 0.1 : 0;
    if (const std::uint64_t how = random.next() % 14; how < 5) {
      next.budget = std::array<std::size_t, 5>{0, 40, 300, 3000, 100000}[how];
    } else if (how == 5) {
      next.budget = std::chrono::microseconds(random.next() % 100);
    }
    next.surfaces = random.next() % 4 == 0;
    next.find_crossings = random.next() % 4 == 0;
    salt_ = random.next() % 3;
    if (salt_ != 0 || random.next() % 2 == 0)
      next.accepts = [this](BodyId a, BodyId b) {
        burn();
        return accepts(scene_->user_data(a), scene_->user_data(b));
      };
    next.clock = [this] {
      burn();
      return time_ += std::chrono::microseconds(3);
    };
    rereads_all_ = rereads_all_ || next.level != options_.level || next.margin != options_.margin;
    rereads_extras_ =
        rereads_extras_ || next.surfaces != options_.surfaces || next.find_crossings != options_.find_crossings;
    options_ = next;
    scene_->set_options(std::move(next));
  }
  bool accepts(std::uint64_t a, std::uint64_t b) const { return salt_ == 0 || (a * 7 + b * 7 + salt_) % 4 != 0; }
  void burn() {
    if (fuse_ != 0 && --fuse_ == 0) throw Bomb{};
  }

  std::string update(Random& random, std::uint64_t fuse) {
    // Whom it has to reject.
    const Member* offender = nullptr;
    for (const auto& member : bodies_)
      if (member->is_in && member->is_rejected && (member->is_read() || rereads_all_ || rereads_extras_) &&
          (offender == nullptr || member->id.place < offender->id.place))
        offender = member.get();
    fuse_ = fuse;
    SceneStatus status;
    try {
      status = random.next() % 2 == 0 ? scene_->update() : scene_->update(workers_);
    } catch (const Bomb&) {
      ++thrown;
      was_thrown_ = rereads_all_ = true;
      fuse_ = 0;
      if (!scene_->pairs().empty() || !scene_->ended().empty()) return "pairs after an update that threw";
      return {};
    }
    fuse_ = 0;
    if (offender != nullptr) {
      ++rejected;
      if (status.code != Status::Code::body_not_current || status.offender != offender->id)
        return "not rejected because of a body that is not current: " + message(status);
      return {};
    }
    if (!status) return "rejected: " + message(status);
    ++updates;
    interrupted += !status.finished;
    for (const auto& member : bodies_) {
      if (!member->is_in) continue;
      if (member->is_read() || rereads_all_) member->is_to_be_read = member->has_moved = false;
      member->is_known = !member->has_moved && !member->is_rejected;
    }
    rereads_all_ = rereads_extras_ = was_thrown_ = false;
    return judged(status);
  }

  std::string judged(const SceneStatus& status) {
    if (std::string fault = events(); !fault.empty()) return fault;
    const Budget& budget = options_.budget;
    if (budget.is_tests() && status.pair_tests > static_cast<std::size_t>(budget.tests())) return "over its budget";
    bool all_known = true;
    for (const auto& member : bodies_) all_known = all_known && (!member->is_in || member->is_known);
    if (budget.is_unlimited() && all_known && !status.finished) return "not finished, without a budget";
    if (status.undecided_pairs > status.open_pairs) return "more pairs undecided than open";
    late_ = 0;
    for (const auto& x : bodies_)
      for (const auto& y : bodies_) {
        if (!x->is_in || !y->is_in || !(x->id.place < y->id.place) || !x->is_known || !y->is_known) continue;
        if (std::string fault = pair(*x, *y); !fault.empty())
          return "bodies " + std::to_string(x->id.place) + " and " + std::to_string(y->id.place) + ": " + fault;
      }
    return late_ > status.undecided_pairs ? "more events are late than pairs are undecided" : "";
  }

  /// Every touch begins once, stays, and ends once.
  std::string events() {
    std::set<std::uint64_t> here;
    for (const EndedPair& pair : scene_->ended()) {
      ++ended;
      const auto before = touching_.find(pair.id);
      if (before == touching_.end()) return "a touch ended that never began, or had ended";
      if (before->second != std::pair(pair.a, pair.b)) return "a touch ended as one of others";
      touching_.erase(before);
    }
    for (const ScenePair& pair : scene_->pairs()) {
      if (!scene_->has(pair.a) || !scene_->has(pair.b)) return "a pair of a body that was removed";
      if (pair.touches && !here.insert(pair.id).second) return "two touches of the same number";
      if (pair.contacts.empty()) return "a pair without contacts";
      if (pair.touches != (pair.id != 0)) return "a touch without a number, or a number without a touch";
      if (pair.confirmed && !pair.touches) return "confirmed, and no touch";
      if (pair.finished && !pair.confirmed) return "finished, and not confirmed";
      unconfirmed += !pair.touches, kept += pair.touches && !pair.confirmed;
      if (!pair.touches) {
        if (pair.began) return "begun without a touch";
        continue;
      }
      const auto before = touching_.find(pair.id);
      if (pair.began != (before == touching_.end())) return pair.began ? "begun twice" : "never begun";
      if (!pair.began && before->second != std::pair(pair.a, pair.b)) return "a touch of others goes on";
      if (pair.began && !given_touches_.insert(pair.id).second) return "the number of a touch was given again";
      touching_[pair.id] = {pair.a, pair.b};
    }
    for (const ScenePair& pair : scene_->pairs()) began += pair.began;
    return touching_.size() == here.size() ? "" : "a touch has neither stayed nor ended";
  }

  std::string pair(const Member& x, const Member& y) {
    const Collider &a = *x.collider, &b = *y.collider;
    const ScenePair* found = scene_->find(y.id, x.id);
    const bool may_meet = !(x.options.is_static && y.options.is_static) && (x.options.category & y.options.mask) != 0 &&
                          (y.options.category & x.options.mask) != 0 &&
                          accepts(x.options.user_data, y.options.user_data);
    if (!may_meet) return found == nullptr ? "" : "a pair of two that may not meet";
    for (const Crossed& crossing : crossings_by_force(a, b)) {
      ++crossed;
      if (found == nullptr) return "they cross, and there is no pair";
      if (!is_within(crossing, *found, a, b)) return "a crossing outside all contacts";
      if (!options_.find_crossings || !found->finished) continue;
      const bool is_listed = std::any_of(found->crossings.begin(), found->crossings.end(), [&](const Crossing& c) {
        return c.facet_a == crossing.facet_a && c.facet_b == crossing.facet_b;
      });
      if (!is_listed) return "a crossing is not in the list";
    }
    if (!options_.find_crossings && found != nullptr && !found->crossings.empty())
      return "crossings that nobody asked for";
    if (std::string fault = touch_of(found, a, b); !fault.empty()) return fault;
    if (found == nullptr && comes_near(a, b)) return "they come as near as the margin, and there is no pair";
    if (found == nullptr || !found->finished) return {};
    const std::size_t surfaces = options_.surfaces ? found->contacts.size() : 0;
    if (!options_.budget.is_time() && found->surfaces.size() != surfaces) return "surfaces are missing, or too many";
    return as_alone(*found, a, b);
  }

  /// What the scene says of a touch is confirmed by brute force, or open; what is open is counted.
  std::string touch_of(const ScenePair* found, const Collider& a, const Collider& b) {
    const double gap = found == nullptr ? 0 : least_gap(a, b, options_.level);
    const bool crosses = found != nullptr && !crossings_by_force(a, b).empty();
    const bool is_apart = gap > options_.margin + gap_in_doubt;
    if (found == nullptr) return "";
    if (found->confirmed && is_apart) return "a touch is confirmed of bodies that are apart";
    if (found->began && is_apart) return "a touch began of bodies that are apart";
    // A touch that the scene does not tell yet, or tells still.
    late_ += (crosses && !found->touches) || (is_apart && found->touches);
    return "";
  }

  bool comes_near(const Collider& a, const Collider& b) const {
    const Sphere sphere_a = around(a), sphere_b = around(b);
    if (distance(sphere_a.center, sphere_b.center) > sphere_a.radius + sphere_b.radius + options_.margin) return false;
    for (std::uint32_t v = 0; v < a.vertex_count(); ++v)
      for (std::uint32_t w = 0; w < b.vertex_count(); ++w)
        if (distance(a.vertex(v), b.vertex(w)) < options_.margin) return true;
    return false;
  }

  /// A finished pair has the contacts of collide().
  std::string as_alone(const ScenePair& found, const Collider& a, const Collider& b) const {
    CollideOptions options{.margin = options_.margin};
    if (options_.level && *options_.level < std::max(a.tree().level_count(), b.tree().level_count()))
      options.level = options_.level;
    const Contacts alone = collide(a, b, options);
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> of_scene, of_two;
    for (const Contact& c : found.contacts) of_scene.emplace(c.node_a, c.node_b);
    for (const Contact& c : alone.contacts) of_two.emplace(c.node_a, c.node_b);
    return of_scene == of_two ? "" : "finished, with other contacts than both have alone";
  }

  std::string ask(Random& random) {
    // It may be asked when nothing has moved that an update would read.
    bool is_current = true, has_bodies = false;
    for (const auto& member : bodies_) {
      has_bodies = has_bodies || member->is_in;
      if (member->is_read() && member->has_moved) is_current = false;
    }
    if (was_thrown_ && has_bodies) is_current = false;
    const SceneRayHit hit = scene_->first_hit({random_point(random, 3), random_point(random, 1)});
    const SceneStatus touch = scene_->touch(Sphere{random_point(random, 2), 0.5});
    if (is_current) return {};
    if (hit.status.code != Status::Code::other_frame) return "a ray was answered before bodies that moved were read";
    return touch.code == Status::Code::other_frame ? "" : "a shape was answered before bodies that moved were read";
  }

  std::vector<std::unique_ptr<Member>> bodies_;
  Workers workers_{2};
  std::size_t made_ = 0;

  // Of one walk.
  SceneOptions options_;
  std::uint64_t salt_ = 0;
  std::uint64_t fuse_ = 0;  // the callback that throws, counted from now; 0: none
  std::chrono::nanoseconds time_{0};
  bool rereads_all_ = false, rereads_extras_ = false;  // requested since the last update
  bool was_thrown_ = false;                            // the last update
  std::map<std::uint64_t, std::pair<BodyId, BodyId>> touching_;
  std::size_t late_ = 0;                   // pairs whose touch the last update does not tell as it is
  std::set<std::uint64_t> given_touches_;  // every number of a touch ever given
  std::set<std::pair<std::uint32_t, std::uint32_t>> given_bodies_;  // every BodyId ever given
  std::optional<Scene> scene_;                                      // last: it borrows
};

}  // namespace morula::test
