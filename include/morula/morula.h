/* SPDX-FileCopyrightText: 2026 The Morula authors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Morula from C, and from every language that can call C: opaque handles, status codes, no exceptions.
 *
 * Every function that can fail returns a morula_status and writes its result through the last pointer, which is set to
 * NULL or 0 first. After a failure morula_message() says in words what was wrong, and nothing has changed. Lengths are
 * in mesh units, indices from 0, coordinates x, y, z. Strings are UTF-8.
 *
 * Options are structs that begin with their size: fill them by their _init function, then set what you want. A program
 * that was compiled with an older header keeps working: what it does not know has its default.
 *
 * Handles keep alive what they were made from: a mesh may be destroyed after its model, a model after its body.
 * One handle is for one thread at a time; different handles are independent, also bodies of one model. */
#ifndef MORULA_MORULA_H
#define MORULA_MORULA_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#if defined(MORULA_C_BUILDING)
#define MORULA_API __declspec(dllexport)
#else
#define MORULA_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define MORULA_API __attribute__((visibility("default")))
#else
#define MORULA_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum morula_status {
  MORULA_OK = 0,
  MORULA_BAD_ARGUMENT = 1, /* a pointer that is NULL, an option or index out of range, a mesh that is not usable */
  MORULA_BAD_FILE = 2,     /* a file that cannot be read or written */
  MORULA_REFUSED = 3,      /* positions that are not finite or not as many as vertices: the body is as it was */
  MORULA_STOPPED = 4,      /* a callback asked for it */
  MORULA_OUT_OF_MEMORY = 5,
  MORULA_INTERNAL = 6 /* a defect of Morula: please report the message */
} morula_status;

/* What went wrong in the last call of this thread that failed; "" before the first. Valid until the thread's next call
 * that fails. */
MORULA_API const char* morula_message(void);
/* "0.1.0" */
MORULA_API const char* morula_version(void);

/* ---- Meshes: triangles, closed or open. ---- */

typedef struct morula_mesh morula_mesh;

/* positions: 3 per vertex. facets: 3 vertex indices each, counter-clockwise seen from outside. Both are copied.
 * Cost: linear. */
MORULA_API morula_status morula_mesh_create(const double* positions, size_t vertex_count, const uint32_t* facets,
                                            size_t facet_count, morula_mesh** mesh);
/* By extension: OBJ, OFF, PLY, STL, VTK (.vtk, .vtp, .vtu), Gmsh (.msh), and glTF where the build reads it. */
MORULA_API morula_status morula_mesh_read(const char* path, morula_mesh** mesh);
/* By extension: OBJ, OFF, PLY, STL or .vtp; whole or not at all. */
MORULA_API morula_status morula_mesh_write(const morula_mesh* mesh, const char* path);
/* A body made by formula: bar, capsule, limb, torus, blob, plate, two, tool. resolution: edges around it, 3 to 4096. */
MORULA_API morula_status morula_mesh_sample(const char* name, int resolution, morula_mesh** mesh);
MORULA_API void morula_mesh_destroy(morula_mesh* mesh);
MORULA_API size_t morula_mesh_vertex_count(const morula_mesh* mesh);
MORULA_API size_t morula_mesh_facet_count(const morula_mesh* mesh);
/* 3 per vertex; 3 per facet. As long as the mesh lives. */
MORULA_API const double* morula_mesh_positions(const morula_mesh* mesh);
MORULA_API const uint32_t* morula_mesh_facets(const morula_mesh* mesh);

/* ---- Models: a sphere tree, and which part of the surface each sphere owns. ---- */

typedef struct morula_model morula_model;

typedef struct morula_sphere {
  double x, y, z, radius;
} morula_sphere;

typedef struct morula_build_options {
  size_t size;               /* of this struct, set by morula_build_options_init */
  const char* method;        /* octree, grid, hubbard, spawn, medial, combined, optimized */
  const char* quality;       /* of method optimized: draft, fast, default, best */
  int branching;             /* most children of a node, 2 to 64 */
  int depth;                 /* levels below the root, 0 to 8; -1: by the number of facets */
  size_t spheres;            /* not 0: a flat set of at most so many */
  double max_protrusion;     /* not 0: no leaf sticks out farther than this length */
  double time_limit_seconds; /* not 0: what is not divided by then stays as it is, and covers */
  uint64_t seed;
  int threads; /* 1 or more */
  int nested;  /* not 0: every sphere contains its children's */
  /* Called now and then on the calling thread with the share that is done, 0 to 1; not 0 stops the build. */
  int (*progress)(double share, void* user);
  void* user;
} morula_build_options;

MORULA_API void morula_build_options_init(morula_build_options* options);
/* A tree whose every level covers the surface. options: NULL for the defaults. Equal bits for any number of threads,
 * unless a time limit ends it. */
MORULA_API morula_status morula_build(const morula_mesh* mesh, const morula_build_options* options,
                                      morula_model** model);
/* .morula as it was built for exactly this mesh; .sph, .json and .npz get a cover made for it. */
MORULA_API morula_status morula_model_read(const char* path, const morula_mesh* mesh, morula_model** model);
/* .morula, .sph, .json or .npz by extension; whole or not at all. */
MORULA_API morula_status morula_model_write(const morula_model* model, const char* path);
MORULA_API void morula_model_destroy(morula_model* model);
MORULA_API size_t morula_model_node_count(const morula_model* model);
MORULA_API size_t morula_model_level_count(const morula_model* model);
MORULA_API size_t morula_model_leaf_count(const morula_model* model);
/* One per node, level by level from the root, which is node 0. As long as the model lives. */
MORULA_API const morula_sphere* morula_model_spheres(const morula_model* model);
/* 0xffffffff for a leaf; children are adjacent. */
MORULA_API const uint32_t* morula_model_first_child(const morula_model* model);
MORULA_API const uint32_t* morula_model_child_count(const morula_model* model);
/* 0xffffffff for the root. */
MORULA_API const uint32_t* morula_model_parent(const morula_model* model);
/* The nodes whose spheres cover the surface at a level: those of the level, and leaves above it. Writes at most
 * `capacity` of them, ascending, and their number to *count, which may be more. nodes may be NULL with capacity 0. */
MORULA_API morula_status morula_model_level_set(const morula_model* model, size_t level, uint32_t* nodes,
                                                size_t capacity, size_t* count);

/* ---- Bodies: spheres that follow the vertices. ---- */

typedef struct morula_body morula_body;

typedef struct morula_body_options {
  size_t size;
  const char* rules; /* one per level from the root, separated by commas; the last serves all deeper levels: exact,
                      * wrapped, approach1, approach2, traditional, weighted */
  int conservative;  /* not 0: radii grow until every level covers, whatever the rule */
  int threads;       /* 1 or more; of updates */
} morula_body_options;

MORULA_API void morula_body_options_init(morula_body_options* options);
/* At rest, where the mesh is. options: NULL for the defaults: the rule exact, one thread. */
MORULA_API morula_status morula_body_create(const morula_mesh* mesh, const morula_model* model,
                                            const morula_body_options* options, morula_body** body);
MORULA_API void morula_body_destroy(morula_body* body);
/* Moves every sphere to the positions, in mesh order: vertex i begins stride_bytes * i bytes after the first; 0 means
 * that there is nothing between them. They are borrowed until the next update: queries about facets read them there.
 * Refused, with nothing changed: not one per vertex; not finite. Allocates nothing. Cost: linear in vertices. */
MORULA_API morula_status morula_body_update_double(morula_body* body, const double* positions, size_t vertex_count,
                                                   size_t stride_bytes);
MORULA_API morula_status morula_body_update_float(morula_body* body, const float* positions, size_t vertex_count,
                                                  size_t stride_bytes);
/* Where the body is, on top of its deformation: x -> R x + t. rotation: 9, by rows. translation: 3. */
MORULA_API morula_status morula_body_set_transform(morula_body* body, const double* rotation,
                                                   const double* translation);
MORULA_API size_t morula_body_node_count(const morula_body* body);
/* The present spheres, before the body is placed: one per node, into an array of morula_body_node_count. */
MORULA_API morula_status morula_body_spheres(const morula_body* body, morula_sphere* spheres);
/* Certificate: 1 when the spheres of every level are proven to contain the surface at these positions, up to the
 * rounding of the check; 0 when not. Cost: some 0.1 us per corner and level. */
MORULA_API morula_status morula_body_certify(const morula_body* body, const double* positions, size_t vertex_count,
                                             int* covered);

/* ---- Questions about two bodies. ---- */

/* 1 when leaf spheres overlap; 0 is a proof that the surfaces have no point in common, where the rules cover. */
MORULA_API morula_status morula_overlap(const morula_body* a, const morula_body* b, int* overlaps);

typedef struct morula_contact_options {
  size_t size;
  double margin;       /* pairs this far apart count, too */
  int level;           /* contacts at this level of both trees; -1: at the leaves */
  int64_t pair_tests;  /* a budget; -1: none */
  int64_t nanoseconds; /* a budget of time; -1: none. At most one of the two */
} morula_contact_options;

typedef struct morula_contact {
  uint32_t node_a, node_b;
  int32_t finished; /* 0: the budget ended before the pair was looked into */
  int32_t reserved;
  double point[3];    /* the middle of the overlap, or of the gap */
  double normal[3];   /* unit, from b to a */
  double depth;       /* of the spheres; minus the gap */
  double error_bound; /* no common point of both regions is farther from the point */
} morula_contact;

typedef struct morula_contacts morula_contacts;

MORULA_API void morula_contact_options_init(morula_contact_options* options);
/* An empty list, which keeps its memory from call to call. */
MORULA_API morula_status morula_contacts_create(morula_contacts** contacts);
MORULA_API void morula_contacts_destroy(morula_contacts* contacts);
/* Every crossing of the surfaces lies within one of the pairs, also when the budget ends the search, where the rules
 * cover. options: NULL for the defaults. */
MORULA_API morula_status morula_collide(const morula_body* a, const morula_body* b,
                                        const morula_contact_options* options, morula_contacts* contacts);
MORULA_API size_t morula_contacts_count(const morula_contacts* contacts);
/* As long as nothing else is asked with this list. */
MORULA_API const morula_contact* morula_contacts_data(const morula_contacts* contacts);
/* Not 0: the search came to its end. */
MORULA_API int morula_contacts_finished(const morula_contacts* contacts);

/* Pairs of facets that intersect, decided exactly: 2 indices each, of a and of b, in ascending order. Writes at most
 * `capacity` pairs, and their number to *count, which may be more. pairs may be NULL with capacity 0. */
MORULA_API morula_status morula_crossings(const morula_body* a, const morula_body* b, uint32_t* pairs, size_t capacity,
                                          size_t* count);

typedef struct morula_distance {
  double lower, upper; /* lower <= distance <= upper; both 0 when facets intersect */
  double point_a[3], point_b[3];
  uint32_t facet_a, facet_b;
  int32_t crossing;  /* 1: facets intersect */
  int32_t certified; /* 1: the spheres of both cover, so that lower is a proof */
} morula_distance;

/* Of the surfaces, down to the nearest facets. */
MORULA_API morula_status morula_distance_of(const morula_body* a, const morula_body* b, morula_distance* distance);

#ifdef __cplusplus
}
#endif

#endif
