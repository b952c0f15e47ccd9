// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The part of the module that the C interface lacks: the layout of its structs as web/src/*.js writes and reads
// them, and a build whose progress JavaScript hears.
#include <morula/morula.h>

#include <cstddef>

#define MORULA_AT(type, field, offset) static_assert(offsetof(type, field) == (offset), #type "." #field)

static_assert(sizeof(std::size_t) == 4 && sizeof(void*) == 4);
MORULA_AT(morula_build_options, method, 4);
MORULA_AT(morula_build_options, quality, 8);
MORULA_AT(morula_build_options, branching, 12);
MORULA_AT(morula_build_options, depth, 16);
MORULA_AT(morula_build_options, spheres, 20);
MORULA_AT(morula_build_options, max_protrusion, 24);
MORULA_AT(morula_build_options, time_limit_seconds, 32);
MORULA_AT(morula_build_options, seed, 40);
MORULA_AT(morula_build_options, threads, 48);
MORULA_AT(morula_build_options, nested, 52);
MORULA_AT(morula_build_options, progress, 56);
static_assert(sizeof(morula_build_options) == 64);

MORULA_AT(morula_body_options, rules, 4);
MORULA_AT(morula_body_options, conservative, 8);
MORULA_AT(morula_body_options, threads, 12);
MORULA_AT(morula_body_options, skin, 16);
static_assert(sizeof(morula_body_options) == 20);

MORULA_AT(morula_contact_options, margin, 8);
MORULA_AT(morula_contact_options, level, 16);
MORULA_AT(morula_contact_options, pair_tests, 24);
MORULA_AT(morula_contact_options, nanoseconds, 32);
static_assert(sizeof(morula_contact_options) == 40);

MORULA_AT(morula_contact, node_a, 0);
MORULA_AT(morula_contact, node_b, 4);
MORULA_AT(morula_contact, finished, 8);
MORULA_AT(morula_contact, point, 16);
MORULA_AT(morula_contact, normal, 40);
MORULA_AT(morula_contact, depth, 64);
MORULA_AT(morula_contact, error_bound, 72);
static_assert(sizeof(morula_contact) == 80);

MORULA_AT(morula_distance, lower, 0);
MORULA_AT(morula_distance, upper, 8);
MORULA_AT(morula_distance, point_a, 16);
MORULA_AT(morula_distance, point_b, 40);
MORULA_AT(morula_distance, facet_a, 64);
MORULA_AT(morula_distance, facet_b, 68);
MORULA_AT(morula_distance, crossing, 72);
MORULA_AT(morula_distance, certified, 76);
static_assert(sizeof(morula_distance) == 80);

MORULA_AT(morula_distance_options, tolerance, 8);
MORULA_AT(morula_distance_options, stop_above, 16);
MORULA_AT(morula_distance_options, stop_below, 24);
MORULA_AT(morula_distance_options, pair_tests, 32);
MORULA_AT(morula_distance_options, nanoseconds, 40);
static_assert(sizeof(morula_distance_options) == 48);

MORULA_AT(morula_pair_options, distance, 8);
MORULA_AT(morula_pair_options, nearest_features_once, 16);
MORULA_AT(morula_pair_options, rings, 20);
MORULA_AT(morula_pair_options, rest_distance, 24);
MORULA_AT(morula_pair_options, same_component, 32);
MORULA_AT(morula_pair_options, box_tests, 40);
MORULA_AT(morula_pair_options, nanoseconds, 48);
static_assert(sizeof(morula_pair_options) == 56);

MORULA_AT(morula_pair, kind, 0);
MORULA_AT(morula_pair, a, 4);
MORULA_AT(morula_pair, b, 8);
MORULA_AT(morula_pair, vertices_a, 12);
MORULA_AT(morula_pair, vertices_b, 24);
MORULA_AT(morula_pair, distance, 40);
MORULA_AT(morula_pair, weights_a, 48);
MORULA_AT(morula_pair, weights_b, 72);
MORULA_AT(morula_pair, point_a, 96);
MORULA_AT(morula_pair, point_b, 120);
static_assert(sizeof(morula_pair) == 144);

static_assert(sizeof(morula_ray) == 56);
MORULA_AT(morula_ray_hit, t, 0);
MORULA_AT(morula_ray_hit, point, 8);
MORULA_AT(morula_ray_hit, barycentric, 32);
MORULA_AT(morula_ray_hit, normal, 56);
MORULA_AT(morula_ray_hit, facet, 80);
MORULA_AT(morula_ray_hit, certified, 84);
static_assert(sizeof(morula_ray_hit) == 88);

MORULA_AT(morula_location, inside, 0);
MORULA_AT(morula_location, on_surface, 4);
MORULA_AT(morula_location, winding, 8);
MORULA_AT(morula_location, certified, 12);
static_assert(sizeof(morula_location) == 16);
static_assert(sizeof(morula_sphere) == 32);

#undef MORULA_AT

extern "C" {

// Of JavaScript: not 0 stops the build.
__attribute__((import_module("morula"), import_name("progress"))) int morula_web_progress(double share);

// Builds with the options; has_progress: not 0 calls morula_web_progress.
__attribute__((export_name("morula_web_build"))) morula_status morula_web_build(const morula_mesh* mesh,
                                                                                const morula_build_options* options,
                                                                                int has_progress,
                                                                                morula_model** model) {
  morula_build_options wanted = *options;
  if (has_progress != 0) wanted.progress = [](double share, void*) { return morula_web_progress(share); };
  return morula_build(mesh, &wanted, model);
}
}
