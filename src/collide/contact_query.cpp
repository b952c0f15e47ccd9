// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <morula/collide/contact_query.hpp>
#include <stdexcept>
#include <string>

#include "collide/front/front_walk.hpp"
#include "collide/require.hpp"
#include "parallel/float_environment.hpp"

namespace morula {

struct ContactQuery::State {
  CollideOptions options;
  FrontWalk walk{};
  Contacts contacts{};
  bool front_from_outside = false;

  using Code = ContactStatus::Code;

  ContactStatus usable() const {
    for (std::uint32_t i = 0; i < walk.pairs.size(); ++i) {
      const ColliderPair& pair = walk.pairs[i];
      if (!pair.a->body().is_current() || !pair.b->body().is_current()) return {Code::body_not_current, i};
      if (!options.reach && !(pair.a->body().is_complete() && pair.b->body().is_complete()))
        return {Code::body_not_complete, i};
      if ((options.surfaces || options.exact || options.containment) &&
          !(pair.a->has_current_positions() && pair.b->has_current_positions()))
        return {Code::positions_not_current, i};
      if (!has_level(*pair.a, *pair.b, options.level)) return {Code::bad_level, i};
    }
    return {};
  }

  // Is the front of these bodies and options? In the present frame, when it is to be continued.
  ContactStatus fits(bool same_frame) const {
    const Front& front = walk.front;
    if (front.bodies.empty()) return {Code::no_front};
    if (front.bodies.size() != walk.pairs.size()) return {Code::other_bodies};
    const auto side = [&](const Front::Side& stamp, const Collider& collider) {
      const std::size_t nodes = collider.body().spheres().size();
      if (stamp.ownership != collider.body().ownership() || stamp.spheres.size() != nodes ||
          stamp.travelled.size() != nodes)
        return Code::other_bodies;
      if (!same_frame) return Code::ok;
      if (stamp.frame != collider.body().frame()) return Code::other_frame;
      return stamp.placement == collider.placement() ? Code::ok : Code::other_placement;
    };
    for (std::uint32_t i = 0; i < walk.pairs.size(); ++i) {
      if (const Code code = side(front.bodies[i].a, *walk.pairs[i].a); code != Code::ok) return {code, i};
      if (const Code code = side(front.bodies[i].b, *walk.pairs[i].b); code != Code::ok) return {code, i};
    }
    if (front.margin != options.margin || front.level != options.level.value_or(Front::none))
      return {Code::other_options};
    if (front_from_outside && !walk.is_well_formed()) return {Code::bad_front};
    return {};
  }

  ContactStatus done() {
    front_from_outside = false;
    return {.finished = contacts.finished, .pair_tests = contacts.pair_tests};
  }
};

std::string message(const ContactStatus& status) {
  const std::string which = "pair " + std::to_string(status.bodies) + ": ";
  switch (status.code) {
    case ContactStatus::Code::ok:
      return {};
    case ContactStatus::Code::body_not_current:
      return which + "the last update of a body was refused: update it with good positions first";
    case ContactStatus::Code::body_not_complete:
      return which + "a body was updated lazily: give CollideOptions::reach, which calls Body::reach";
    case ContactStatus::Code::positions_not_current:
      return which +
             "surfaces, crossings or containment are asked for without the positions of this frame: call "
             "Collider::set_positions after it";
    case ContactStatus::Code::no_front:
      return "there is no front: call start() first";
    case ContactStatus::Code::other_bodies:
      return which + "the front is of other bodies or of another ownership: call start()";
    case ContactStatus::Code::other_frame:
      return which + "a body was updated since the front was made: call carry() or start()";
    case ContactStatus::Code::other_placement:
      return which + "a body was placed elsewhere since the front was made: call carry() or start()";
    case ContactStatus::Code::other_options:
      return "the front is of another margin or level: call start()";
    case ContactStatus::Code::bad_front:
      return "the front has indices out of range: call start()";
    case ContactStatus::Code::bad_level:
      return which + "neither tree has the level that contacts are asked for at";
  }
  return {};
}

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
  state_->walk.front.bodies.clear();
  state_->walk.extras.forget();
  state_->walk.pairs.push_back({&a, &b, weight});
  return static_cast<std::uint32_t>(state_->walk.pairs.size() - 1);
}

void ContactQuery::clear() {
  state_->walk.front.bodies.clear();
  state_->walk.extras.forget();
  state_->walk.pairs.clear();
}

void ContactQuery::set_options(CollideOptions options) {
  require_usable(options);
  state_->options = std::move(options);
}

const CollideOptions& ContactQuery::options() const {
  return state_->options;
}

ContactStatus ContactQuery::start(Workers& workers) {
  const StandardFloats standard;
  State& s = *state_;
  if (const ContactStatus status = s.usable(); !status) return status;
  s.walk.start(s.options, true, workers, s.contacts);
  return s.done();
}

ContactStatus ContactQuery::resume(Workers& workers) {
  const StandardFloats standard;
  State& s = *state_;
  if (const ContactStatus status = s.usable(); !status) return status;
  if (const ContactStatus status = s.fits(true); !status) return status;
  if (s.front_from_outside) s.walk.list_finished(s.options, s.contacts);
  s.walk.resume(s.options, workers, s.contacts);
  return s.done();
}

ContactStatus ContactQuery::carry(Workers& workers) {
  const StandardFloats standard;
  State& s = *state_;
  if (const ContactStatus status = s.usable(); !status) return status;
  if (const ContactStatus status = s.fits(false); !status) return status;
  s.walk.carry(s.options, workers, s.contacts);
  return s.done();
}

const Contacts& ContactQuery::contacts() const {
  return state_->contacts;
}

const Front& ContactQuery::front() const {
  return state_->walk.front;
}

void ContactQuery::set_front(Front front) {
  state_->walk.adopt(std::move(front));
  state_->front_from_outside = true;
}

void ContactQuery::cut(std::vector<FrontPair>& pairs) const {
  const StandardFloats standard;
  state_->walk.cut(pairs);
}

}  // namespace morula
