// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/contact_query.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "collide/pairs/descent.hpp"
#include "collide/patches/patch_engine.hpp"
#include "collide/require.hpp"
#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

struct ContactPatchQuery::State {
  State(const Collider& a, const Collider& b) : body{hold(a), hold(b)}, poses{&a.sphere_state(), &b.sphere_state()} {
    surface.reserve(2);
    surface.emplace_back(a, "first");
    surface.emplace_back(b, "second");
  }

  explicit State(const Collider& one)
      : body{hold(one), hold(one)}, poses{&one.sphere_state(), &one.sphere_state()}, self(one) {}

  /// ok, or the first body whose collider another one was assigned to: its facets may be others.
  Status unassigned() const {
    for (std::uint8_t k = 0; k < 2; ++k)
      if (&body[k]->sphere_state() != poses[k]) return {Status::Code::body_replaced, k};
    return {};
  }

  CallState call;
  std::array<std::shared_ptr<const Collider>, 2> body;
  std::array<const SphereState*, 2> poses;  // whose facets the surfaces are of
  std::vector<ClosedSurface> surface;       // of two bodies
  std::optional<SelfSurface> self;          // of one body
  std::unique_ptr<PatchEngine> engine;
  std::unique_ptr<ContactQuery> search;  // of runs with a budget
  std::vector<NodePair> leaves;
  // `next` is that of a run which may still be rejected.
  PatchResult result, next;
  std::vector<Contact> contacts;
  // Patches of the last finished run, for the ids of the next one.
  std::vector<KnownPatch> known;
  std::uint32_t next_id = 0;
  bool finished = false, certified = false;

  void forget() noexcept {
    engine.reset();
    search.reset();
    result.clear();
    contacts.clear();
    known.clear();
    finished = certified = false;
  }
  PatchStatus find(const ContactPatchOptions& options);
  PatchStatus find_within(const ContactPatchOptions& options);
  PatchStatus find_below(const ContactPatchOptions& options, Meter* meter);
  void keep(bool is_finished);
};

PatchStatus ContactPatchQuery::State::find_below(const ContactPatchOptions& options, Meter* meter) {
  if (!engine) engine = std::make_unique<PatchEngine>();
  return engine->find({{body[0].get(), body[1].get()}, {&surface[0], &surface[1]}}, leaves, options, meter, known,
                      next_id, next);
}

PatchStatus ContactPatchQuery::State::find(const ContactPatchOptions& options) {
  leaves.clear();
  if (self) {
    if (!engine) engine = std::make_unique<PatchEngine>();
    return engine->find_self(*body[0], *self, options, {result.sides[0].facets, result.sides[1].facets}, known, next_id,
                             next);
  }
  if (!options.budget.is_unlimited()) return find_within(options);
  each_overlapping(TreePair(*body[0], *body[1], 0, leaf_level), [&](std::uint32_t a, std::uint32_t b) {
    leaves.push_back({a, b});
  });
  return find_below(options, nullptr);
}

// Contacts of the search bound all crossings whenever it ends. If it finishes, they are the pairs of leaves that
// overlap; then their facets give the crossings, or these pairs stay the bound.
PatchStatus ContactPatchQuery::State::find_within(const ContactPatchOptions& options) {
  const CollideOptions limits{.budget = options.budget, .clock = options.clock};
  Meter meter(limits);
  if (!search) {
    search = std::make_unique<ContactQuery>();
    search->add(*body[0], *body[1]);
  }
  search->set_options(limits);
  const ContactStatus status = search->run();
  if (!status) return {{.code = status.code, .body = status.body}};
  if (!status.finished || !meter.try_spend(static_cast<std::uint32_t>(status.pair_tests))) return {};
  for (const Contact& contact : search->contacts().contacts) leaves.push_back({contact.node_a, contact.node_b});
  return find_below(options, &meter);
}

void ContactPatchQuery::State::keep(bool is_finished) {
  if (is_finished) {
    std::swap(result, next);
    known.assign(result.known.begin(), result.known.end());
    contacts.clear();
  } else {
    result.clear();
    const std::vector<Contact>& found = search->contacts().contacts;
    contacts.assign(found.begin(), found.end());
  }
  finished = is_finished;
  certified = self || (body[0]->sphere_state().covers && body[1]->sphere_state().covers);
}

ContactPatchQuery::ContactPatchQuery(const Collider& a, const Collider& b) {
  const StandardFloats standard;
  state_ = std::make_unique<State>(a, b);
}
ContactPatchQuery::ContactPatchQuery(const Collider& body) {
  const StandardFloats standard;
  state_ = std::make_unique<State>(body);
}
ContactPatchQuery::~ContactPatchQuery() = default;
ContactPatchQuery::ContactPatchQuery(ContactPatchQuery&&) noexcept = default;
ContactPatchQuery& ContactPatchQuery::operator=(ContactPatchQuery&&) noexcept = default;

Status ContactPatchQuery::run(const ContactPatchOptions& options) {
  const StandardFloats standard;
  State& s = *state_;
  if (const Status status = s.unassigned(); !status) return status;
  if (const Status status = status_of_pair(*s.body[0], *s.body[1], {.positions = true}); !status) return status;
  if (options.max_points > 16 || options.budget.tests() < 0 || (s.self && !options.budget.is_unlimited()))
    return {Status::Code::bad_option};
  ObjectCall own(s, CallKind::begins);
  if (!own.status()) return own.status();
  const PairAsRead read(*s.body[0], *s.body[1]);
  const PatchStatus found = s.find(options);
  const Status status = found ? read.status() : Status(found);
  if (status) s.keep(found.finished);
  own.finish(status);
  return status;
}

std::span<const ContactPatch> ContactPatchQuery::patches() const {
  return state_->result.patches;
}
std::span<const Contact> ContactPatchQuery::contacts() const {
  return state_->contacts;
}
bool ContactPatchQuery::finished() const {
  return state_->finished;
}
double ContactPatchQuery::volume() const {
  return state_->result.volume;
}
bool ContactPatchQuery::certified() const {
  return state_->certified;
}

}  // namespace morula
