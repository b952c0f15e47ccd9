// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <morula/collide/contact_query.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "collide/body_identity.hpp"
#include "collide/facets/contact_geometry.hpp"
#include "collide/front/front_walk.hpp"
#include "collide/pairs/descent.hpp"
#include "collide/require.hpp"
#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;

struct ContactQuery::State {
  CollideOptions options;
  CallState call{};
  FrontWalk walk{};
  Contacts contacts{};
  std::vector<PairAsRead> read{};      // pairs as the present call reads them, one per pair
  std::vector<BodyIdentity> bodies{};  // bodies of the last call that was not rejected, two per pair
  // A front from set_front() has to be checked before its use. The finished contacts in it, or in a front whose
  // contacts were moved out, have to be listed again.
  bool front_from_outside = false, lacks_contacts = false;

  void forget() noexcept {
    walk.forget();
    contacts = Contacts{};
    front_from_outside = lacks_contacts = false;
  }

  // Keeps the memory of the lists.
  void clear_contacts() noexcept {
    contacts.contacts.clear();
    contacts.surfaces.clear();
    contacts.crossings.clear();
    contacts.crossings_begin.clear();
    contacts.achieved_level.clear();
    contacts.finished_count = 0;
    contacts.finished = false;
    contacts.pair_tests = 0;
  }

  using Code = Status::Code;

  Status usable() const {
    const Needs needs{.all_spheres = !options.refresh_children,
                      .positions = options.surfaces || options.find_crossings || options.containment};
    for (std::uint32_t i = 0; i < walk.pairs.size(); ++i) {
      const ColliderPair& pair = walk.pairs[i];
      for (Status status : {status_of(*pair.a, 0, needs), status_of(*pair.b, 1, needs)}) {
        status.pair = i;
        if (!status) return status;
      }
      if (!has_level(*pair.a, *pair.b, options.level)) return {.code = Code::bad_level, .pair = i};
    }
    return {};
  }

  void begin_reading() {
    read.clear(), bodies.clear();
    for (const ColliderPair& pair : walk.pairs) {
      read.emplace_back(*pair.a, *pair.b);
      bodies.emplace_back(*pair.a), bodies.emplace_back(*pair.b);
    }
  }
  // Whether a front of this number of frame is of this body. index: in `bodies`.
  bool is_same_body(const Front::Side& stamp, const Collider& collider, std::size_t index) const {
    // mutant front-of-assigned: `BodyIdentity(collider) == bodies[index]` -> `index < bodies.size()`
    if (!front_from_outside) return BodyIdentity(collider) == bodies[index];
    const SphereState& now = collider.sphere_state();
    // The spheres of a lazy body change within a frame.
    if (options.refresh_children || stamp.spheres.empty()) return true;
    return stamp.origin == now.origin &&
           std::memcmp(stamp.spheres.data(), now.spheres.data(), now.spheres.size_bytes()) == 0;
  }
  // ok, or the first body that a callback of the present call has moved.
  Status unmoved() const {
    for (std::uint32_t i = 0; i < read.size(); ++i)
      if (Status status = read[i].status(); !status) {
        status.pair = i;
        return status;
      }
    return {};
  }

  // ok if the front is one of these bodies; same_frame: and of their present frame and transforms.
  Status is_of_bodies(bool same_frame) const {
    const Front& front = walk.front;
    if (front.pairs.empty()) return {Code::no_front};
    if (front.pairs.size() != walk.pairs.size()) return {Code::other_bodies};
    const auto side = [&](const Front::Side& stamp, const Collider& collider, std::size_t index) {
      const std::size_t nodes = collider.sphere_state().spheres.size();
      // A front for resume() alone has no spheres.
      const bool resumes = same_frame && stamp.spheres.empty() && stamp.path_length.empty();
      if (stamp.cover_id != collider.sphere_state().cover_id ||
          (!resumes && (stamp.spheres.size() != nodes || stamp.path_length.size() != nodes)))
        return Code::other_bodies;
      if (!same_frame) return Code::ok;
      if (stamp.frame != collider.sphere_state().frame) return Code::other_frame;
      if (!is_same_body(stamp, collider, index)) return Code::other_bodies;
      return stamp.transform == collider.transform() ? Code::ok : Code::other_transform;
    };
    for (std::uint32_t i = 0; i < walk.pairs.size(); ++i) {
      if (const Code code = side(front.pairs[i].a, *walk.pairs[i].a, 2 * i); code != Code::ok)
        return {.code = code, .pair = i};
      if (const Code code = side(front.pairs[i].b, *walk.pairs[i].b, 2 * i + 1); code != Code::ok)
        return {.code = code, .pair = i};
    }
    return {};
  }

  // ok if no index of the front, which is of these bodies, is out of range.
  Status is_in_range() const {
    if (front_from_outside && !walk.is_well_formed()) return {Code::bad_front};
    return {};
  }

  // ok if the front belongs to these bodies and options, and to the present frame when it is to be continued.
  Status fits(bool same_frame) const {
    if (const Status status = is_of_bodies(same_frame); !status) return status;
    const Front& front = walk.front;
    if (front.margin != options.margin || front.level != options.level.value_or(Front::none))
      return {Code::other_options};
    return is_in_range();
  }

  // Descends depth-first, without a queue or a front.
  void descend(const CollideOptions& given) {
    contacts.contacts.clear();
    contacts.surfaces.clear();
    contacts.pair_tests = 0;
    contacts.achieved_level.clear();
    for (std::uint32_t i = 0; i < walk.pairs.size(); ++i) {
      check_interrupt();
      const TreePair trees(*walk.pairs[i].a, *walk.pairs[i].b, given.margin, given.level.value_or(leaf_level));
      contacts.pair_tests += each_overlapping(trees, [&](std::uint32_t node_a, std::uint32_t node_b) {
                               make_room(contacts.contacts);
                               Contact& contact = contacts.contacts.emplace_back();
                               describe(trees, node_a, node_b, contact);
                               contact.pair = i;
                               contact.finished = true;
                             }).tests;
      contacts.achieved_level.push_back(trees.depth());
    }
    contacts.finished_count = contacts.contacts.size();
    contacts.finished = true;
    walk.extras.add(walk.pairs, given, nullptr, contacts);
  }

  void run(const CollideOptions& given, Workers& workers) {
    if (!given.budget.is_unlimited() || given.refresh_children)
      walk.start(given, false, workers, contacts);
    else
      descend(given);
    walk.end_front();
  }

  /// Runs a call: work(), if the bodies and then fits() are ok.
  template <class Fits, class Work>
  ContactStatus call_of(CallKind kind, const Fits& fits, const Work& work) {
    const StandardFloats standard;
    ObjectCall own(*this, kind);
    if (!own.status()) return {own.status()};
    if (const Status status = usable(); !status) return {status};
    if (const Status status = fits(); !status) return {status};
    begin_reading();
    work();
    const Status status = unmoved();
    own.finish(status);
    if (!status) return {status};
    front_from_outside = lacks_contacts = false;
    return {{}, contacts.finished, contacts.pair_tests};
  }
  template <class Work>
  ContactStatus fresh(const Work& work) {
    return call_of(
        CallKind::begins, [] { return Status{}; }, work);
  }
  template <class Work>
  ContactStatus from_front(bool same_frame, const Work& work) {
    return call_of(
        CallKind::goes_on, [&] { return fits(same_frame); }, work);
  }
};

ContactQuery::ContactQuery(CollideOptions options) {
  require_usable(options);
  state_ = std::make_unique<State>(State{.options = std::move(options)});
}
ContactQuery::~ContactQuery() = default;
ContactQuery::ContactQuery(ContactQuery&&) noexcept = default;
ContactQuery& ContactQuery::operator=(ContactQuery&&) noexcept = default;

std::uint32_t ContactQuery::add(const Collider& a, const Collider& b, double weight) {
  const StandardFloats standard;
  if (!(std::isfinite(weight) && weight >= 0))
    throw std::invalid_argument("the weight of a pair of bodies is " + std::to_string(weight) +
                                ": it must be finite and not negative");
  require_idle(state_->call);
  state_->walk.pairs.push_back({hold(a), hold(b), weight});
  state_->walk.end_front();
  state_->walk.extras.forget();
  return static_cast<std::uint32_t>(state_->walk.pairs.size() - 1);
}

void ContactQuery::clear() {
  require_idle(state_->call);
  state_->walk.end_front();
  state_->walk.extras.forget();
  state_->walk.pairs.clear();
  state_->clear_contacts();
  state_->contacts.containment.clear();
}

void ContactQuery::set_options(CollideOptions options) {
  require_idle(state_->call);
  require_usable(options);
  state_->options = std::move(options);
}

const CollideOptions& ContactQuery::options() const {
  return state_->options;
}

ContactStatus ContactQuery::run(Workers& workers) {
  State& s = *state_;
  return s.fresh([&] { s.run(s.options, workers); });
}

Status ContactQuery::warm_up(Workers& workers) {
  State& s = *state_;
  const ContactStatus status = s.fresh([&] {
    CollideOptions all = s.options;
    all.budget = {};
    s.run(all, workers);
    s.walk.start(all, true, workers, s.contacts);
  });
  if (!status) return status;
  s.walk.end_front();
  s.clear_contacts();
  return {};
}

ContactStatus ContactQuery::start(Workers& workers) {
  State& s = *state_;
  return s.fresh([&] { s.walk.start(s.options, true, workers, s.contacts); });
}

ContactStatus detail::start_for_resume(ContactQuery& query) {
  ContactQuery::State& s = *query.state_;
  return s.fresh([&] { s.walk.start(s.options, false, serial_workers(), s.contacts); });
}

ContactStatus ContactQuery::resume(Workers& workers) {
  State& s = *state_;
  return s.from_front(true, [&] {
    // mutant contacts-taken-away: `s.front_from_outside || s.lacks_contacts` -> `s.front_from_outside`
    if (s.front_from_outside || s.lacks_contacts) s.walk.list_finished(s.options, s.contacts);
    s.walk.resume(s.options, workers, s.contacts);
  });
}

ContactStatus ContactQuery::carry(Workers& workers) {
  State& s = *state_;
  return s.from_front(false, [&] { s.walk.carry(s.options, workers, s.contacts); });
}

const Contacts& ContactQuery::contacts() const {
  return state_->contacts;
}

Contacts ContactQuery::take_contacts() {
  require_idle(state_->call);
  state_->lacks_contacts = true;
  return std::exchange(state_->contacts, Contacts{});
}

ContactSurface ContactQuery::surface(std::size_t contact) {
  const StandardFloats standard;
  State& s = *state_;
  require_idle(s.call);
  if (contact >= s.contacts.contacts.size())
    throw std::invalid_argument("there is no contact " + std::to_string(contact) + ", but " +
                                std::to_string(s.contacts.contacts.size()));
  const Contact& c = s.contacts.contacts[contact];
  const ColliderPair& pair = s.walk.pairs[c.pair];
  require_bodies(*pair.a, *pair.b, {.all_spheres = !s.options.refresh_children, .positions = true});
  const ObjectCall own(s, CallKind::begins);
  const PairAsRead read(*pair.a, *pair.b);
  const ContactSurface surface = s.walk.extras.surface_of(s.walk.pairs, c);
  require_good(read.status());
  return surface;
}

const Front& ContactQuery::front() const {
  return state_->walk.front;
}

void ContactQuery::set_front(Front front) {
  require_idle(state_->call);
  state_->walk.adopt(std::move(front));
  state_->front_from_outside = true;
  state_->call.ended = {};
}

void ContactQuery::cut(std::vector<FrontPair>& pairs) const {
  const StandardFloats standard;
  require_idle(state_->call);
  if (state_->front_from_outside && !state_->walk.front.pairs.empty()) {
    require_good(state_->is_of_bodies(false));
    require_good(state_->is_in_range());
  }
  state_->walk.cut(pairs);
}

}  // namespace morula
