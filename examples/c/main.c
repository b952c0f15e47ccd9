/* SPDX-FileCopyrightText: 2026 The Morula authors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Two bodies from C: one deforms and comes near the other; contacts within a budget, exact crossings, distance, proof.
 */
#include <math.h>
#include <morula/morula.h>
#include <stdio.h>
#include <stdlib.h>

/* Ends the program when a call fails. */
static void must(morula_status status, const char* what) {
  if (status == MORULA_OK) return;
  fprintf(stderr, "%s: %s\n", what, morula_message());
  exit(1);
}

static void check(int good, const char* what) {
  printf("%s: %s\n", good ? "ok" : "FAILED", what);
  if (!good) exit(1);
}

int main(void) {
  morula_mesh* mesh;
  morula_model* model;
  morula_build_options options;
  must(morula_mesh_sample("limb", 24, &mesh), "sample");
  morula_build_options_init(&options);
  options.quality = "fast";
  must(morula_build(mesh, &options, &model), "build");
  printf("%zu facets, %zu spheres on %zu levels\n", morula_mesh_facet_count(mesh), morula_model_node_count(model),
         morula_model_level_count(model));

  morula_body *arm, *other;
  must(morula_body_create(mesh, model, NULL, &arm), "body");
  must(morula_body_create(mesh, model, NULL, &other), "body");
  const double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double aside[3] = {0, 0, 1.5};
  must(morula_body_set_transform(other, upright, aside), "place");

  const size_t vertices = morula_mesh_vertex_count(mesh);
  const double* rest = morula_mesh_positions(mesh);
  double* bent = malloc(3 * vertices * sizeof *bent);
  morula_contacts* contacts;
  morula_contact_options budget;
  must(morula_contacts_create(&contacts), "contacts");
  morula_contact_options_init(&budget);
  budget.pair_tests = 2000;
  if (bent == NULL) return 1;

  int always_covered = 1, never_lost = 1, touched = 0;
  for (int frame = 0; frame <= 10; ++frame) {
    for (size_t v = 0; v < vertices; ++v) {
      const double* p = rest + 3 * v;
      bent[3 * v] = p[0], bent[3 * v + 1] = p[1], bent[3 * v + 2] = p[2] + 0.012 * frame * p[0] * p[0];
    }
    int covered, overlaps;
    size_t crossings;
    morula_distance distance;
    must(morula_body_update_double(arm, bent, vertices, 0), "update");
    must(morula_body_certify(arm, bent, vertices, &covered), "certify");
    must(morula_overlap(arm, other, &overlaps), "overlap");
    must(morula_collide(arm, other, &budget, contacts), "collide");
    must(morula_crossings(arm, other, NULL, 0, &crossings), "crossings");
    must(morula_distance_of(arm, other, &distance), "distance");
    printf("frame %2d: distance %.4f, contacts %zu%s, crossing facets %zu\n", frame, distance.upper,
           morula_contacts_count(contacts), morula_contacts_finished(contacts) ? "" : " so far", crossings);
    always_covered = always_covered && covered;
    if (crossings > 0 && (!overlaps || morula_contacts_count(contacts) == 0 || distance.upper > 0)) never_lost = 0;
    if (crossings > 0) touched = 1;
  }
  check(always_covered, "every level covered the surface in every frame");
  check(touched, "the bodies touched");
  check(never_lost, "no crossing without a contact");

  bent[4] = NAN;
  check(morula_body_update_double(arm, bent, vertices, 0) == MORULA_REFUSED, morula_message());

  free(bent);
  morula_contacts_destroy(contacts);
  morula_body_destroy(arm);
  morula_body_destroy(other);
  morula_model_destroy(model);
  morula_mesh_destroy(mesh);
  return 0;
}
