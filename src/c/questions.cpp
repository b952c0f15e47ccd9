// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Queries of the C interface about two bodies.
#include <chrono>
#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/collide/distance.hpp>
#include <tuple>

#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

namespace {

void require_bodies(const morula_body* a, const morula_body* b) {
  require_pointer(a, "a");
  require_pointer(b, "b");
}

void copy(const Vec3& from, double* to) {
  to[0] = from.x, to[1] = from.y, to[2] = from.z;
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
    ContactQuery& query = contacts->query;
    query.set_options(contact_options<CollideOptions>(options));
    query.clear();
    query.add(a->collider, b->collider);
    const ContactStatus status = query.run();
    if (!status) return code_of(status);
    std::vector<morula_contact> found;
    found.swap(contacts->found);
    found.clear();
    for (const Contact& contact : query.contacts().contacts) found.push_back(contact_of(contact));
    contacts->found.swap(found);
    contacts->finished = status.finished;
    return MORULA_OK;
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
    if (!body->surface) body->surface.emplace(*body->mesh);
    if (const Status status = body->surface->follow(body->collider); !status) return code_of(status);
    const SurfaceQueryStatus status = body->self_crossings.run(*body->surface, body->workers);
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
    const DistanceBounds bounds = morula::distance(a->collider, b->collider);
    distance->lower = bounds.lower, distance->upper = bounds.upper;
    copy(bounds.a.point, distance->point_a);
    copy(bounds.b.point, distance->point_b);
    distance->facet_a = bounds.a.facet, distance->facet_b = bounds.b.facet;
    distance->crossing = bounds.crossing ? 1 : 0;
    distance->certified = bounds.certified ? 1 : 0;
    return MORULA_OK;
  });
}
