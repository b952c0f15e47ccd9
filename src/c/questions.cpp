// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Queries of the C interface about two bodies.
#include <limits>
#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/collide/distance.hpp>
#include <tuple>
#include <utility>

#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

namespace {

void require_bodies(const morula_body* a, const morula_body* b) {
  require_pointer(a, "a");
  require_pointer(b, "b");
}

/// Writes as many pairs as the caller has room for, and their total number.
template <class Pairs, class Indices>
void write_pairs(const Pairs& found, const Indices& indices, std::uint32_t* pairs, std::size_t capacity,
                 std::size_t* count) {
  for (const auto& pair : found) {
    if (*count < capacity) std::tie(pairs[2 * *count], pairs[2 * *count + 1]) = indices(pair);
    ++*count;
  }
}

/// Copies the contacts of a call that was not rejected, except those that are in the list already.
morula_status read(morula_contacts& contacts, const ContactStatus& status) {
  const Contacts& result = contacts.query.contacts();
  const std::span<const Contact> all = result.contacts;
  // Without memory the list stays as it is.
  if (all.size() > contacts.found.capacity()) contacts.found.reserve(std::max(all.size(), 2 * contacts.found.size()));
  contacts.found.resize(contacts.final_count);
  for (const Contact& contact : all.subspan(contacts.final_count)) contacts.found.push_back(contact_of(contact));
  contacts.final_count = result.finished_count;
  contacts.finished = status.finished;
  if (status.finished) {
    contacts.query.clear();
    contacts.a.reset(), contacts.b.reset();
  }
  return MORULA_OK;
}

void write(const DistanceBounds& bounds, morula_distance& to) {
  to.lower = bounds.lower, to.upper = bounds.upper;
  copy(bounds.a.point, to.point_a);
  copy(bounds.b.point, to.point_b);
  to.facet_a = bounds.a.facet, to.facet_b = bounds.b.facet;
  to.crossing = bounds.crossing ? 1 : 0;
  to.certified = bounds.certified ? 1 : 0;
}

}  // namespace

morula_contact morula::detail::contact_of(const Contact& contact) {
  morula_contact to{};
  to.node_a = contact.node_a, to.node_b = contact.node_b;
  to.finished = contact.finished ? 1 : 0;
  copy(contact.point, to.point);
  copy(contact.normal, to.normal);
  to.depth = contact.depth;
  to.error_bound = contact.error_bound;
  return to;
}

morula_status morula_overlap(const morula_body* a, const morula_body* b, int* overlaps) {
  return guarded([&] {
    require_pointer(overlaps, "overlaps");
    *overlaps = 0;
    require_bodies(a, b);
    *overlaps = overlap(a->collider, b->collider) ? 1 : 0;
    return MORULA_OK;
  });
}

void morula_contact_options_defaults(morula_contact_options* options, size_t size) {
  write_defaults(options, size, [](morula_contact_options& defaults) {
    defaults.level = -1;
    defaults.pair_tests = -1;
    defaults.nanoseconds = -1;
  });
}

morula_status morula_contacts_create(morula_contacts** contacts) {
  return guarded([&] {
    require_pointer(contacts, "contacts");
    *contacts = nullptr;
    *contacts = new morula_contacts;
    return MORULA_OK;
  });
}

void morula_contacts_destroy(morula_contacts* contacts) {
  delete contacts;
}

morula_status morula_collide(const morula_body* a, const morula_body* b, const morula_contact_options* options,
                             morula_contacts* contacts) {
  return guarded([&]() -> morula_status {
    require_pointer(contacts, "contacts");
    require_bodies(a, b);
    // mutant c-contacts-rejected: `contacts->a ? contacts->other` -> `contacts->a ? contacts->query`
    ContactQuery& query = contacts->a ? contacts->other : contacts->query;
    CollideOptions wanted = contact_options<CollideOptions>(options);
    const bool has_budget = !wanted.budget.is_unlimited();
    query.set_options(std::move(wanted));
    query.clear();
    query.add(a->collider, b->collider);
    const ContactStatus status = has_budget ? start_for_resume(query) : query.run();
    if (!status) {
      query.clear();
      return code_of(status);
    }
    if (&query == &contacts->other) {
      std::swap(contacts->query, contacts->other);
      contacts->other.clear();
    }
    contacts->a = a->of_caller, contacts->b = b->of_caller;
    contacts->final_count = 0;
    return read(*contacts, status);
  });
}

morula_status morula_contacts_resume(morula_contacts* contacts, int64_t pair_tests, int64_t nanoseconds) {
  return guarded([&] {
    require_pointer(contacts, "contacts");
    CollideOptions wanted = contacts->query.options();
    wanted.budget = budget_of(pair_tests, nanoseconds, "pair_tests");
    if (!contacts->a) throw std::invalid_argument("contacts: no budget has ended their last search");
    contacts->query.set_options(std::move(wanted));
    const ContactStatus status = contacts->query.resume();
    if (!status) return code_of_resume(status);
    return read(*contacts, status);
  });
}

size_t morula_contacts_count(const morula_contacts* contacts) {
  return contacts == nullptr ? 0 : contacts->found.size();
}
const morula_contact* morula_contacts_data(const morula_contacts* contacts) {
  return contacts == nullptr ? nullptr : contacts->found.data();
}
int morula_contacts_finished(const morula_contacts* contacts) {
  return contacts != nullptr && contacts->finished ? 1 : 0;
}

morula_status morula_crossings(const morula_body* a, const morula_body* b, uint32_t* pairs, size_t capacity,
                               size_t* count) {
  return guarded([&]() -> morula_status {
    require_pointer(count, "count");
    *count = 0;
    require_bodies(a, b);
    if (capacity != 0) require_pointer(pairs, "pairs");
    CrossingQuery query;
    if (const Status status = query.run(a->collider, b->collider); !status) return code_of(status);
    write_pairs(
        query.pairs(), [](const Crossing& pair) { return std::tuple(pair.facet_a, pair.facet_b); }, pairs, capacity,
        count);
    return MORULA_OK;
  });
}

morula_status morula_self_crossings(morula_body* body, uint32_t* pairs, size_t capacity, size_t* count) {
  return guarded([&]() -> morula_status {
    require_pointer(count, "count");
    *count = 0;
    require_pointer(body, "body");
    if (capacity != 0) require_pointer(pairs, "pairs");
    const SurfaceTree* surface = nullptr;
    if (const morula_status code = surface_of(*body, surface); code != MORULA_OK) return code;
    const SurfaceQueryStatus status = body->self_crossings.run(*surface, body->workers);
    if (!status) return code_of(status);
    write_pairs(
        body->self_crossings.pairs(), [](const FeaturePair& pair) { return std::tuple(pair.a, pair.b); }, pairs,
        capacity, count);
    return MORULA_OK;
  });
}

morula_status morula_distance_of(const morula_body* a, const morula_body* b, morula_distance* distance) {
  return guarded([&] {
    require_pointer(distance, "distance");
    *distance = {};
    require_bodies(a, b);
    write(morula::distance(a->collider, b->collider), *distance);
    return MORULA_OK;
  });
}

void morula_distance_options_defaults(morula_distance_options* options, size_t size) {
  write_defaults(options, size, [](morula_distance_options& defaults) {
    defaults.stop_above = std::numeric_limits<double>::infinity();
    defaults.pair_tests = -1;
    defaults.nanoseconds = -1;
  });
}

morula_status morula_distance_bounds(const morula_body* a, const morula_body* b, const morula_distance_options* options,
                                     morula_distance* distance, int* complete) {
  return guarded([&]() -> morula_status {
    require_pointer(distance, "distance");
    *distance = {};
    require_pointer(complete, "complete");
    *complete = 0;
    require_bodies(a, b);
    const morula_distance_options wanted = over_defaults(options, &morula_distance_options_defaults);
    DistanceOptions same;
    same.tolerance = wanted.tolerance;
    same.stop_above = wanted.stop_above, same.stop_below = wanted.stop_below;
    same.budget = budget_of(wanted.pair_tests, wanted.nanoseconds, "pair_tests");
    const DistanceBounds bounds = DistanceQuery().run(a->collider, b->collider, same);
    if (!bounds.status) return code_of(bounds.status);
    write(bounds, *distance);
    *complete = bounds.complete ? 1 : 0;
    return MORULA_OK;
  });
}
