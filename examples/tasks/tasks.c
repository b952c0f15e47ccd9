/* SPDX-FileCopyrightText: 2026 The Morula authors */
/* SPDX-License-Identifier: Apache-2.0 */
/* The tasks of docs/reference/c.md in C; tasks.cpp and tasks.py do the same and print the same numbers. Run it in a folder
 * with limb.obj, tool.obj and their trees, limb.morula and tool.morula. */
#include <math.h>
#include <morula/morula.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* [helpers] */
static void must(morula_status status) {
  if (status == MORULA_OK) return;
  fprintf(stderr, "%s\n", morula_message());
  exit(1);
}

static morula_body* read_body(const char* mesh_file, const char* tree_file, double y) {
  morula_mesh* mesh;
  morula_model* model;
  morula_body* body;
  must(morula_mesh_read(mesh_file, &mesh));
  must(morula_model_read(tree_file, mesh, &model));
  must(morula_body_create(mesh, model, NULL, &body)); /* it keeps the mesh and the model alive */
  must(morula_body_set_transform(body, (double[]){1, 0, 0, 0, 1, 0, 0, 0, 1}, (double[]){0, y, 0}));
  morula_model_destroy(model);
  morula_mesh_destroy(mesh);
  return body;
}

static double* copy_of_positions(const morula_mesh* mesh) {
  const size_t bytes = 3 * morula_mesh_vertex_count(mesh) * sizeof(double);
  double* positions = malloc(bytes);
  if (positions == NULL) exit(1);
  return memcpy(positions, morula_mesh_positions(mesh), bytes);
}
/* [end] */

static morula_sphere root_of(const morula_body* body) {
  morula_sphere* spheres = malloc(morula_body_node_count(body) * sizeof *spheres);
  if (spheres == NULL) exit(1);
  must(morula_body_spheres(body, spheres));
  const morula_sphere root = spheres[0];
  free(spheres);
  return root;
}

/* [build] */
static void build(void) {
  morula_mesh* mesh;
  morula_model* model;
  must(morula_mesh_read("limb.obj", &mesh));
  must(morula_build(mesh, NULL, &model));
  must(morula_model_write(model, "built.morula"));
  printf("build: %zu spheres on %zu levels\n", morula_model_node_count(model), morula_model_level_count(model));
  morula_model_destroy(model);
  morula_mesh_destroy(mesh);
}
/* [end] */

/* [update] */
static void update(void) {
  morula_mesh* mesh;
  must(morula_mesh_read("limb.obj", &mesh));
  morula_body* body = read_body("limb.obj", "limb.morula", 0);
  const size_t vertices = morula_mesh_vertex_count(mesh);
  double* positions = copy_of_positions(mesh);
  for (int frame = 1; frame <= 10; ++frame) {
    for (size_t v = 0; v < vertices; ++v) positions[3 * v] *= 1.0625;
    must(morula_body_update_double(body, positions, vertices, 0));
  }
  int covered;
  must(morula_body_certify(body, positions, vertices, &covered));
  printf("update: root radius %.9g, %s\n", root_of(body).radius, covered ? "covered" : "not covered");
  free(positions);
  morula_body_destroy(body), morula_mesh_destroy(mesh);
}
/* [end] */

/* [contacts] */
static void contacts(void) {
  morula_body *limb = read_body("limb.obj", "limb.morula", 0), *tool = read_body("tool.obj", "tool.morula", 0.75);
  morula_contacts* found;
  must(morula_contacts_create(&found));
  must(morula_collide(limb, tool, NULL, found)); /* options with a budget end it early */
  double deepest = 0;
  for (size_t i = 0; i < morula_contacts_count(found); ++i)
    deepest = fmax(deepest, morula_contacts_data(found)[i].depth);
  printf("contacts: %zu, deepest %.9g\n", morula_contacts_count(found), deepest);
  morula_contacts_destroy(found);
  morula_body_destroy(limb), morula_body_destroy(tool);
}
/* [end] */

/* [distance] */
static void distance(void) {
  morula_body *limb = read_body("limb.obj", "limb.morula", 0), *tool = read_body("tool.obj", "tool.morula", 2);
  morula_distance bounds;
  must(morula_distance_of(limb, tool, &bounds));
  printf("distance: %.9g, facets %u and %u\n", bounds.upper, bounds.facet_a, bounds.facet_b);
  morula_body_destroy(limb), morula_body_destroy(tool);
}
/* [end] */

/* [self_contact] */
static void self_contact(void) {
  morula_mesh* mesh;
  size_t count;
  must(morula_mesh_read("limb.obj", &mesh));
  morula_body* body = read_body("limb.obj", "limb.morula", 0);
  double* folded = copy_of_positions(mesh);
  for (size_t v = 0; v < morula_mesh_vertex_count(mesh); ++v)
    if (folded[3 * v] < 0) folded[3 * v] *= -0.875;
  must(morula_body_update_double(body, folded, morula_mesh_vertex_count(mesh), 0));
  must(morula_self_crossings(body, NULL, 0, &count));
  printf("self-contact: %zu pairs of facets\n", count);
  free(folded);
  morula_body_destroy(body), morula_mesh_destroy(mesh);
}
/* [end] */

/* [scene] */
static void scene(void) {
  morula_scene* scene;
  must(morula_scene_create(NULL, 1, &scene));
  for (int i = 0; i < 5; ++i) {
    morula_body* body = read_body("limb.obj", "limb.morula", 0.75 * i);
    must(morula_scene_add(scene, body, 0));
    morula_body_destroy(body); /* the scene keeps it */
  }
  must(morula_scene_update(scene));
  size_t count = 0;
  for (size_t i = 0; i < morula_scene_pair_count(scene); ++i) count += morula_scene_pairs(scene)[i].contact_count;
  printf("scene: %zu pairs of bodies, %zu contacts\n", morula_scene_pair_count(scene), count);
  morula_scene_destroy(scene);
}
/* [end] */

int main(void) {
  build();
  update();
  contacts();
  distance();
  self_contact();
  scene();
  return 0;
}
