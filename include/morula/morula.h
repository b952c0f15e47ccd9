/* SPDX-FileCopyrightText: 2026 The Morula authors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Morula from C, and from all languages that can call C: opaque handles, status codes, no exceptions.
 *
 * Every function that can fail returns a morula_status and writes its result through the last pointer, which is first
 * set to NULL or 0. After a failure nothing has changed, except that queries reject a body whose last update was
 * rejected; morula_message() returns the error as text. Lengths are in mesh units, indices start at 0, coordinates are
 * x, y, z. Strings are UTF-8.
 *
 * Options are structs that begin with their size: call their _init function, then set single fields. A program that was
 * compiled with an older header keeps working: fields that it does not have keep their defaults. The _init functions
 * are compiled into the program; other languages call the _defaults function with the size of their own struct.
 *
 * A handle keeps the objects alive that it was made from: a mesh may be destroyed before its model, a model before its
 * body, a body before its scene. One handle is for one thread at a time; different handles are independent, even bodies
 * of one model. */
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
  MORULA_BAD_ARGUMENT = 1, /* a NULL pointer, an option or index out of range, a mesh that is not usable */
  MORULA_BAD_FILE = 2,     /* a file that cannot be read or written */
  MORULA_REFUSED = 3,      /* positions that are not finite or not one per vertex, a body whose last update was
                            * rejected, a search whose bodies have moved */
  MORULA_STOPPED = 4,      /* a callback requested it */
  MORULA_OUT_OF_MEMORY = 5,
  MORULA_INTERNAL = 6 /* a defect of Morula: please report the message */
} morula_status;

/* The error of the last failed call of this thread, as text; "" if no call has failed. Valid until the thread's next
 * failed call. */
MORULA_API const char* morula_message(void);
/* The version, such as "0.1.0". */
MORULA_API const char* morula_version(void);

/* ---- Meshes: triangles, closed or open. ---- */

typedef struct morula_mesh morula_mesh;

/* Creates a mesh. positions: 3 per vertex. facets: 3 vertex indices each, counter-clockwise seen from outside. Both
 * arrays are copied. Cost: linear. */
MORULA_API morula_status morula_mesh_create(const double* positions, size_t vertex_count, const uint32_t* facets,
                                            size_t facet_count, morula_mesh** mesh);
/* Reads a mesh by extension: OBJ, OFF, PLY, STL, VTK (.vtk, .vtp, .vtu), Gmsh (.msh), and glTF if the build has it. */
MORULA_API morula_status morula_mesh_read(const char* path, morula_mesh** mesh);
/* Reads a mesh from the bytes of a file. name: a file name; its extension is the format, and messages quote it. A .gltf
 * may name further files, which are read from the folder of `name`: use .glb for bytes of others. */
MORULA_API morula_status morula_mesh_from_bytes(const char* name, const void* bytes, size_t size, morula_mesh** mesh);
/* Writes a mesh by extension: OBJ, OFF, PLY, STL or .vtp. The write is atomic. */
MORULA_API morula_status morula_mesh_write(const morula_mesh* mesh, const char* path);
/* Generates a sample: bar, capsule, limb, torus, blob, plate, two, tool, hand or vessel.
 * resolution: edges around it, 3 to 4096. */
MORULA_API morula_status morula_mesh_sample(const char* name, int resolution, morula_mesh** mesh);
MORULA_API void morula_mesh_destroy(morula_mesh* mesh);
MORULA_API size_t morula_mesh_vertex_count(const morula_mesh* mesh);
MORULA_API size_t morula_mesh_facet_count(const morula_mesh* mesh);
/* Positions, 3 per vertex, and facets, 3 indices each. Valid while the mesh lives. */
MORULA_API const double* morula_mesh_positions(const morula_mesh* mesh);
MORULA_API const uint32_t* morula_mesh_facets(const morula_mesh* mesh);

/* ---- Models: a sphere tree, and the part of the surface that each sphere owns. ---- */

typedef struct morula_model morula_model;

typedef struct morula_sphere {
  double x, y, z, radius;
} morula_sphere;

/* Stands for a missing node: the parent of the root, the children of a leaf. */
#define MORULA_NO_NODE UINT32_MAX

typedef struct morula_build_options {
  size_t size;               /* of this struct, set by the _init function */
  const char* method;        /* octree, grid, hubbard, spawn, medial, combined, optimized */
  const char* quality;       /* quality of method optimized: draft, fast, default, best */
  int branching;             /* largest number of children of a node, 2 to 64 */
  int depth;                 /* levels below the root, 0 to 8; -1: by the number of facets */
  size_t spheres;            /* largest size of a flat set; 0: a tree by depth and branching */
  double max_protrusion;     /* largest protrusion of a leaf, mesh units; 0: no limit */
  double time_limit_seconds; /* undivided nodes then stay leaves, and cover; 0: no limit */
  uint64_t seed;
  int threads; /* 0: one per processor */
  int nested;  /* not 0: every sphere contains its children's */
  /* Called at intervals on the calling thread with the completed share, 0 to 1. A result other than 0 stops it. */
  int (*progress)(double share, void* user);
  void* user;
} morula_build_options;

/* Writes the defaults into a struct of `size` bytes; so do the functions of the same ending below. */
MORULA_API void morula_build_options_defaults(morula_build_options* options, size_t size);
static inline void morula_build_options_init(morula_build_options* options) {
  morula_build_options_defaults(options, sizeof *options);
}
/* Builds a tree in which every level covers the surface. options: NULL for the defaults. The result has the same bits
 * for any number of threads, unless a time limit ends the build. */
MORULA_API morula_status morula_build(const morula_mesh* mesh, const morula_build_options* options,
                                      morula_model** model);
/* Reads a .morula that was built for exactly this mesh, or a .sph, .json or .npz, whose cover is then computed. */
MORULA_API morula_status morula_model_read(const char* path, const morula_mesh* mesh, morula_model** model);
/* Writes .morula, .sph, .json or .npz by extension. The write is atomic. */
MORULA_API morula_status morula_model_write(const morula_model* model, const char* path);
/* Reads a model from the bytes of a .morula that was built for exactly this mesh. */
MORULA_API morula_status morula_model_from_bytes(const void* bytes, size_t size, const morula_mesh* mesh,
                                                 morula_model** model);
/* Writes the bytes of a .morula if `capacity` suffices, and their number to *size. bytes may be NULL with capacity 0.
 * Cost of each call: linear. */
MORULA_API morula_status morula_model_to_bytes(const morula_model* model, void* bytes, size_t capacity, size_t* size);
MORULA_API void morula_model_destroy(morula_model* model);
MORULA_API size_t morula_model_node_count(const morula_model* model);
MORULA_API size_t morula_model_level_count(const morula_model* model);
MORULA_API size_t morula_model_leaf_count(const morula_model* model);
/* Spheres, one per node, level by level from the root, which is node 0. Valid while the model lives. */
MORULA_API const morula_sphere* morula_model_spheres(const morula_model* model);
/* First child and number of children of each node; MORULA_NO_NODE for a leaf. Children are adjacent. */
MORULA_API const uint32_t* morula_model_first_child(const morula_model* model);
MORULA_API const uint32_t* morula_model_child_count(const morula_model* model);
/* Parent of each node; MORULA_NO_NODE for the root. */
MORULA_API const uint32_t* morula_model_parent(const morula_model* model);
/* The nodes whose spheres cover the surface at a level: the nodes of the level, and leaves above it. Writes at most
 * `capacity` nodes, ascending, and their total number to *count. nodes may be NULL with capacity 0. */
MORULA_API morula_status morula_model_level_set(const morula_model* model, size_t level, uint32_t* nodes,
                                                size_t capacity, size_t* count);

/* ---- Skins: vertices that follow bones. ---- */

/* Transforms of bones are 12 numbers each: the rows of [A | t], x -> A x + t, relative to rest. That is the world
 * matrix of the bone times its inverse bind matrix. They are the identity at rest, and may be singular or mirrored. */

typedef struct morula_skin morula_skin;

/* Creates a skin. bones, weights: `influences` of each vertex, one vertex after another; those with weight 0 are left
 * out. bones: below bone_count. The weights of a vertex are divided by their sum, which must be above 0 in vertices
 * that facets use. Both arrays are copied. Cost: linear. */
MORULA_API morula_status morula_skin_create(size_t vertex_count, size_t influences, const uint32_t* bones,
                                            const double* weights, size_t bone_count, morula_skin** skin);
/* Reads the skin of a mesh: a .gltf or .glb with its vertices, or a .npy of shape (vertices, bones). */
MORULA_API morula_status morula_skin_read(const char* path, const morula_mesh* mesh, morula_skin** skin);
MORULA_API void morula_skin_destroy(morula_skin* skin);
MORULA_API size_t morula_skin_bone_count(const morula_skin* skin);
/* Writes the vertices at these transforms, 3 numbers each, to `positions`, with the bits that bodies use. */
MORULA_API morula_status morula_skin_positions(const morula_skin* skin, const morula_mesh* mesh,
                                               const double* transforms, size_t bone_count, double* positions);

/* Bounds of clusters of facets, such as meshlets or draw clusters, from the bones alone: no body, no tree. */
typedef struct morula_skin_bounds morula_skin_bounds;

typedef struct morula_boxf {
  float lower[3], upper[3];
} morula_boxf;
typedef struct morula_spheref {
  float x, y, z, radius;
} morula_spheref;

/* Computes rest data. cluster_of_facet: a number per facet of the mesh, from 0; NULL: one cluster. Mesh and skin may be
 * destroyed afterwards. Cost: linear in influences. */
MORULA_API morula_status morula_skin_bounds_create(const morula_mesh* mesh, const morula_skin* skin,
                                                   const uint32_t* cluster_of_facet, morula_skin_bounds** bounds);
/* The same with morph targets, which displace vertices before the bones move them. displacements: 3 numbers per target
 * and vertex of the mesh, target after target; copied as rest data. Cost: also vertices x targets. */
MORULA_API morula_status morula_skin_bounds_create_morphed(const morula_mesh* mesh, const morula_skin* skin,
                                                           size_t target_count, const double* displacements,
                                                           const uint32_t* cluster_of_facet,
                                                           morula_skin_bounds** bounds);
MORULA_API void morula_skin_bounds_destroy(morula_skin_bounds* bounds);
/* The largest number of a cluster, plus 1. */
MORULA_API size_t morula_skin_bounds_cluster_count(const morula_skin_bounds* bounds);
/* Computes a sphere and a box of each cluster that contain all its vertices at these transforms, rounded outward.
 * transforms: those of character_count characters, one after another. spheres, boxes: one per character and cluster;
 * either may be NULL. Rejected, with nothing written: transforms that are not finite or too large. Cost: linear in
 * clusters × bones per cluster, whatever the number of vertices. */
MORULA_API morula_status morula_skin_bounds_compute(morula_skin_bounds* bounds, const double* transforms,
                                                    size_t character_count, morula_spheref* spheres,
                                                    morula_boxf* boxes);
/* The same with morph targets. morphs: a number per character and target, by which its displacements are multiplied, of
 * any sign; NULL: all are 0. Also rejected: numbers that are not finite or too large. */
MORULA_API morula_status morula_skin_bounds_compute_morphed(morula_skin_bounds* bounds, const double* transforms,
                                                            const double* morphs, size_t character_count,
                                                            morula_spheref* spheres, morula_boxf* boxes);

/* ---- Bodies: spheres that follow the vertices. ---- */

typedef struct morula_body morula_body;

typedef struct morula_body_options {
  size_t size;
  const char* rules; /* one per level from the root, separated by commas; the last rule serves deeper levels: exact,
                      * wrapped, approach1, approach2, traditional, weighted; and skinned, with a skin */
  int conservative;  /* not 0: radii grow until every level covers, with any rule */
  int threads;       /* threads of updates, 1 or more */
  const morula_skin* skin; /* of morula_body_update_skinned; copied. NULL: none */
} morula_body_options;

MORULA_API void morula_body_options_defaults(morula_body_options* options, size_t size);
static inline void morula_body_options_init(morula_body_options* options) {
  morula_body_options_defaults(options, sizeof *options);
}
/* Creates a body at rest, at the positions of the mesh. options: NULL for the defaults: the rule exact, one thread. */
MORULA_API morula_status morula_body_create(const morula_mesh* mesh, const morula_model* model,
                                            const morula_body_options* options, morula_body** body);
MORULA_API void morula_body_destroy(morula_body* body);
/* Moves every sphere to the positions, in mesh order: vertex i begins stride_bytes * i bytes after the first; 0 means
 * no gaps. The positions are borrowed until the next update, because queries on facets read them; after
 * morula_body_destroy, as long as another handle keeps the body alive. Rejected: positions that are not one per vertex,
 * or not finite; queries then reject the body until an update succeeds. Allocates nothing. Cost: linear in vertices. */
MORULA_API morula_status morula_body_update_double(morula_body* body, const double* positions, size_t vertex_count,
                                                   size_t stride_bytes);
MORULA_API morula_status morula_body_update_float(morula_body* body, const float* positions, size_t vertex_count,
                                                  size_t stride_bytes);
/* Moves every sphere to the transforms of the bones of morula_body_options.skin. With the rule skinned no vertex is
 * read, and every level covers; queries compute the vertices that they read. Such a body rejects positions. Rejected,
 * with no change: another number of bones, and transforms that are not finite or too large. Allocates nothing. */
MORULA_API morula_status morula_body_update_skinned(morula_body* body, const double* transforms, size_t bone_count);
/* Sets the rigid transform after the deformation: x -> R x + t. rotation: 9, by rows. translation: 3. */
MORULA_API morula_status morula_body_set_transform(morula_body* body, const double* rotation,
                                                   const double* translation);
MORULA_API size_t morula_body_node_count(const morula_body* body);
/* Copies the present spheres, without the transform: one per node, into an array of morula_body_node_count. */
MORULA_API morula_status morula_body_spheres(const morula_body* body, morula_sphere* spheres);
/* Certificate: 1 if the spheres of every level are proven to contain the surface at these positions, up to the rounding
 * of the check; 0 if not. Cost: about 0.1 us per corner and level. */
MORULA_API morula_status morula_body_certify(const morula_body* body, const double* positions, size_t vertex_count,
                                             int* covered);

/* ---- Queries on two bodies. ---- */

/* 1 if leaf spheres overlap; if the rules cover, 0 is a proof that the surfaces have no common point. */
MORULA_API morula_status morula_overlap(const morula_body* a, const morula_body* b, int* overlaps);

typedef struct morula_contact_options {
  size_t size;
  double margin;       /* largest gap that counts as a contact, mesh units */
  int level;           /* level of both trees for the contacts; -1: the leaves */
  int64_t pair_tests;  /* budget in tests; -1: none */
  int64_t nanoseconds; /* budget in time; -1: none. At most one of the two */
} morula_contact_options;

typedef struct morula_contact {
  uint32_t node_a, node_b;
  int32_t finished; /* 0: the budget ended before the pair was opened */
  int32_t reserved;
  double point[3];    /* center of the overlap, or of the gap */
  double normal[3];   /* unit vector from b to a */
  double depth;       /* depth of the spheres, mesh units; negative for a gap */
  double error_bound; /* no common point of both regions is farther from the point */
} morula_contact;

typedef struct morula_contacts morula_contacts;

MORULA_API void morula_contact_options_defaults(morula_contact_options* options, size_t size);
static inline void morula_contact_options_init(morula_contact_options* options) {
  morula_contact_options_defaults(options, sizeof *options);
}
/* Creates an empty list, which keeps its memory from call to call. */
MORULA_API morula_status morula_contacts_create(morula_contacts** contacts);
MORULA_API void morula_contacts_destroy(morula_contacts* contacts);
/* Finds contacts. If the rules cover, every crossing of the surfaces lies within one of the pairs, even if the budget
 * ends the search. options: NULL for the defaults. */
MORULA_API morula_status morula_collide(const morula_body* a, const morula_body* b,
                                        const morula_contact_options* options, morula_contacts* contacts);
MORULA_API size_t morula_contacts_count(const morula_contacts* contacts);
/* The contacts; valid until the next query with this list. */
MORULA_API const morula_contact* morula_contacts_data(const morula_contacts* contacts);
/* Not 0 if the search is complete. */
MORULA_API int morula_contacts_finished(const morula_contacts* contacts);
/* Continues the search of the last morula_collide with this list, which its budget ended, with a new budget: a number
 * of tests or a time; -1: none. Repeated calls always finish: unless the budget is 0, a call opens one pair at any
 * cost. Rejected, with no change: bodies that have moved since. Until the search is complete
 * the list keeps both bodies alive. */
MORULA_API morula_status morula_contacts_resume(morula_contacts* contacts, int64_t pair_tests, int64_t nanoseconds);

/* Pairs of facets that intersect, decided exactly: 2 indices each, of a and of b, ascending. Writes at most `capacity`
 * pairs, and their total number to *count. pairs may be NULL with capacity 0. */
MORULA_API morula_status morula_crossings(const morula_body* a, const morula_body* b, uint32_t* pairs, size_t capacity,
                                          size_t* count);

/* ---- Contact patches: the connected parts of the overlap of two solid bodies, exactly for their surfaces. ---- */

typedef struct morula_patch_options {
  size_t size;
  int max_points; /* largest number of points of a patch, 0 to 16; three or more reproduce force and torque */
  int depths;     /* not 0: compute the depths of patches */
} morula_patch_options;

/* The derivative of a patch's volume with respect to the position of a vertex, mesh units squared. */
typedef struct morula_vertex_gradient {
  uint32_t vertex;
  uint32_t reserved;
  double gradient[3];
} morula_vertex_gradient;

/* A point that stands for a sector of a patch. The forces of all points add up to -area_vector of side a. */
typedef struct morula_patch_point {
  uint32_t id; /* number of the sector, which stays while the patch exists */
  uint32_t facet_a, facet_b;
  uint32_t reserved;
  double point[3], force[3];
  double volume, depth;                      /* of the sector; depth is its mean depth */
  double point_a[3], point_b[3];             /* points of both surfaces on the line through `point` along the normal */
  double barycentric_a[3], barycentric_b[3]; /* their weights of the vertices of facet_a and facet_b */
} morula_patch_point;

/* The region of one body's surface that lies inside the other body. */
typedef struct morula_patch_side {
  double area_vector[3]; /* derivative of the volume with respect to a translation of this body */
  double moment[3];      /* the same for a rotation about the centroid of the patch */
  double area;
  const morula_vertex_gradient* gradients; /* ascending by vertex; their sum is area_vector */
  size_t gradient_count;
} morula_patch_side;

typedef struct morula_patch {
  uint32_t id; /* number of the patch, which stays while the patch moves little from run to run */
  uint32_t reserved;
  double volume, centroid[3];
  double normal[3];  /* unit vector from b to a; 0 for a body wholly inside the other */
  double depth;      /* least translation of a along the normal that separates both regions, mesh units */
  double mean_depth; /* volume over the length of the area vector */
  morula_patch_side a, b;
  const morula_patch_point* points;
  size_t point_count;
} morula_patch;

typedef struct morula_patches morula_patches;

MORULA_API void morula_patch_options_defaults(morula_patch_options* options, size_t size);
static inline void morula_patch_options_init(morula_patch_options* options) {
  morula_patch_options_defaults(options, sizeof *options);
}
/* Creates the query of two bodies; it keeps both alive, and its memory from run to run. A bad argument: a surface that
 * is open or not oriented, and a body that is inside out. Cost: O(F log F) for F facets. */
MORULA_API morula_status morula_patches_create(morula_body* a, morula_body* b, morula_patches** patches);
MORULA_API void morula_patches_destroy(morula_patches* patches);
/* Computes the patches of the present positions and transforms. options: NULL for the defaults. After a failure the
 * patches are those of the last run. */
MORULA_API morula_status morula_patches_run(morula_patches* patches, const morula_patch_options* options);
MORULA_API size_t morula_patches_count(const morula_patches* patches);
/* The patches; valid until the next run. */
MORULA_API const morula_patch* morula_patches_data(const morula_patches* patches);
/* Sum of the volumes of all patches, mesh units cubed. */
MORULA_API double morula_patches_volume(const morula_patches* patches);
/* Not 0 if the spheres of both bodies cover; otherwise patches may be incomplete. */
MORULA_API int morula_patches_certified(const morula_patches* patches);

typedef struct morula_distance {
  double lower, upper; /* lower <= distance <= upper; both 0 if facets intersect */
  double point_a[3], point_b[3];
  uint32_t facet_a, facet_b;
  int32_t crossing;  /* 1: facets intersect */
  int32_t certified; /* 1: the spheres of both cover, so lower is proven */
} morula_distance;

/* Distance of the surfaces, down to the nearest facets. */
MORULA_API morula_status morula_distance_of(const morula_body* a, const morula_body* b, morula_distance* distance);

typedef struct morula_distance_options {
  size_t size;
  double tolerance;    /* largest upper - lower of a complete result, mesh units */
  double stop_above;   /* stops when lower exceeds this, mesh units; infinite: never */
  double stop_below;   /* stops when upper does not exceed this, mesh units; 0: never */
  int64_t pair_tests;  /* budget in tests; -1: none */
  int64_t nanoseconds; /* budget in time; -1: none. At most one of the two */
} morula_distance_options;

MORULA_API void morula_distance_options_defaults(morula_distance_options* options, size_t size);
static inline void morula_distance_options_init(morula_distance_options* options) {
  morula_distance_options_defaults(options, sizeof *options);
}
/* Bounds of the distance, for callers that need less than morula_distance_of. options: NULL for the defaults, with
 * which the result is that of morula_distance_of. complete: 1 if the nearest facets, the tolerance or a stop was
 * reached; 0 if the budget ended the search, and the bounds then hold, too. */
MORULA_API morula_status morula_distance_bounds(const morula_body* a, const morula_body* b,
                                                const morula_distance_options* options, morula_distance* distance,
                                                int* complete);

/* ---- Pairs of features: vertices, edges and facets that are near each other, and facets that intersect. ---- */

/* The kinds of the two features of a pair: the first is of a, the second of b. */
typedef enum morula_pair_kind {
  MORULA_VERTEX_FACET = 0, /* with MORULA_EDGE_EDGE the only kinds of near pairs of a body with itself */
  MORULA_FACET_VERTEX = 1,
  MORULA_EDGE_EDGE = 2,
  MORULA_FACET_FACET = 3 /* of morula_pairs_crossing */
} morula_pair_kind;

typedef struct morula_pair_options {
  size_t size;
  double distance;           /* largest distance of a near pair, mesh units; finite, 0 or more */
  int nearest_features_once; /* not 0: a pair of nearest features that several facets and edges find is kept once */
  /* For a body with itself, besides pairs that share a vertex: */
  int rings;            /* skips pairs with two vertices at most this many edges apart; 0: none */
  double rest_distance; /* skips pairs that are at most this far apart at rest, mesh units; 0: none */
  int same_component;   /* not 0: skips pairs of one component */
  int reserved;
  int64_t box_tests;   /* budget in tests; -1: none */
  int64_t nanoseconds; /* budget in time; -1: none. At most one of the two */
} morula_pair_options;

/* Two features with nearest points. The numbers of features stay the same while the body exists. */
typedef struct morula_pair {
  int32_t kind;                          /* a morula_pair_kind */
  uint32_t a, b;                         /* numbers of vertices or facets of the mesh, or of edges */
  uint32_t vertices_a[3], vertices_b[3]; /* of the features; UINT32_MAX: an edge or a vertex has no more */
  int32_t reserved;
  double distance;                   /* of the points, mesh units; this and the rest are 0 for crossings */
  double weights_a[3], weights_b[3]; /* of the vertices in the points */
  double point_a[3], point_b[3];
} morula_pair;

typedef struct morula_pairs morula_pairs;

MORULA_API void morula_pair_options_defaults(morula_pair_options* options, size_t size);
static inline void morula_pair_options_init(morula_pair_options* options) {
  morula_pair_options_defaults(options, sizeof *options);
}
/* Creates an empty list, which keeps its memory from call to call. */
MORULA_API morula_status morula_pairs_create(morula_pairs** pairs);
MORULA_API void morula_pairs_destroy(morula_pairs* pairs);
/* Finds every vertex-facet and edge-edge pair within options->distance, in world coordinates: of two bodies, or of one
 * with itself if b is NULL or a. Pairs are in the order of (kind, a, b). A search that its budget ends has found some
 * of them. Complete for any rules, up to 2^-46 of the largest coordinate. options: NULL for the defaults. The first
 * call with a body sorts its facets, outside the budget; later calls reuse the order. Until the search is complete the
 * list keeps both bodies alive. */
MORULA_API morula_status morula_pairs_near(morula_body* a, morula_body* b, const morula_pair_options* options,
                                           morula_pairs* pairs);
/* The same for pairs of facets that intersect, decided exactly. It ignores the distance. */
MORULA_API morula_status morula_pairs_crossing(morula_body* a, morula_body* b, const morula_pair_options* options,
                                               morula_pairs* pairs);
/* Continues the last search with this list, which its budget ended, with a new budget: a number of tests or a time; -1:
 * none. Repeated calls always finish, unless the budget is 0. Rejected, with no change: bodies that have moved since.
 */
MORULA_API morula_status morula_pairs_resume(morula_pairs* pairs, int64_t box_tests, int64_t nanoseconds);
MORULA_API size_t morula_pairs_count(const morula_pairs* pairs);
/* The pairs; valid until the next call with this list. */
MORULA_API const morula_pair* morula_pairs_data(const morula_pairs* pairs);
/* Not 0 if the last search is complete. */
MORULA_API int morula_pairs_finished(const morula_pairs* pairs);

/* ---- Queries on one body. ---- */

typedef struct morula_ray {
  double origin[3], direction[3]; /* largest |component| of the direction: 2^-200 to 2^200 */
  double t_end;                   /* the ray ends at origin + t_end direction; 0 or more, may be infinite */
} morula_ray;

typedef struct morula_ray_hit {
  double t;              /* distance from the origin in lengths of the direction; infinite: the ray misses */
  double point[3];       /* this, barycentric and normal are 0 if the ray misses */
  double barycentric[3]; /* of the point */
  double normal[3];      /* outward unit normal of the facet; 0 for a facet without area */
  uint32_t facet;        /* UINT32_MAX: the ray misses */
  int32_t certified;     /* 1: the spheres of the body cover, so a miss is proven */
} morula_ray_hit;

/* Finds the first facet that each ray hits, in world coordinates: watertight, no ray passes between adjacent facets.
 * hits: one per ray. Rejected, with nothing written: a ray that is not finite or out of range. */
MORULA_API morula_status morula_first_hits(const morula_body* body, const morula_ray* rays, size_t ray_count,
                                           morula_ray_hit* hits);

typedef struct morula_location {
  int32_t inside;     /* 1: inside the surface or on it */
  int32_t on_surface; /* 1: exactly on a facet */
  int32_t winding;    /* winding number of the surface around the point; 0 outside, on it, or without orientation */
  int32_t certified;  /* 1: the spheres of the body cover; 0: `inside` may be wrong */
} morula_location;

/* Locates points, 3 numbers each, in world coordinates, exactly. locations: one per point. A bad argument: an open
 * surface. Rejected, with nothing written: a point that is not finite or too large. The first call examines the
 * surface; later calls reuse that. */
MORULA_API morula_status morula_locate(morula_body* body, const double* points, size_t point_count,
                                       morula_location* locations);

/* Self-contact: the pairs of facets of the body that intersect, decided exactly, without pairs that share a vertex. Two
 * indices each, the lower one first, ascending. Writes at most `capacity` pairs, and their total number to *count.
 * pairs may be NULL with capacity 0. The first call sorts the facets; later calls reuse the order. */
MORULA_API morula_status morula_self_crossings(morula_body* body, uint32_t* pairs, size_t capacity, size_t* count);

/* ---- Haptics: proxies that stay on their side of the surface of a body. ---- */

typedef struct morula_haptic_options {
  size_t size;
  double radius;      /* of the ball that touches, mesh units; 0: a point */
  double skin;        /* distance kept besides the radius, mesh units; 0 or less: a default that depends on the body */
  double stiffness;   /* force per mesh unit between proxy and device point */
  double friction;    /* coefficient of Coulomb friction */
  int smooth_normals; /* not 0: the direction of the force does not jump between facets */
  int max_moves;      /* largest number of straight moves in a step, 1 or more */
} morula_haptic_options;

typedef struct morula_haptic_step {
  double proxy[3];       /* center of the proxy */
  double force[3];       /* on the device: stiffness times (proxy - device point) */
  double point[3];       /* of the surface, nearest to the proxy; this, barycentric and normal are 0 without a touch */
  double barycentric[3]; /* of the point */
  double normal[3];      /* unit vector from the point to the proxy */
  uint32_t facet;        /* of the point; UINT32_MAX without a touch */
  int32_t touches;       /* 1: a facet is at radius + skin */
  int32_t settled;       /* 1: no move that brings the proxy nearer to the device point was found */
  int32_t jammed;        /* 1: the surface closed around the proxy, or moved too far in one step to be followed */
  int32_t certified;     /* 1: the spheres of the body cover; if 0, facets may be missed */
  uint32_t moves;        /* number of straight moves */
} morula_haptic_step;

typedef struct morula_haptic_probe morula_haptic_probe;

MORULA_API void morula_haptic_options_defaults(morula_haptic_options* options, size_t size);
static inline void morula_haptic_options_init(morula_haptic_options* options) {
  morula_haptic_options_defaults(options, sizeof *options);
}
/* Creates a probe: a point or a ball. options: NULL for the defaults: a point, stiffness 1, 8 moves. */
MORULA_API morula_status morula_haptic_probe_create(const morula_haptic_options* options, morula_haptic_probe** probe);
MORULA_API void morula_haptic_probe_destroy(morula_haptic_probe* probe);
/* Moves the proxy toward the device point (3 numbers, world coordinates); its center passes through no facet. The first
 * step starts at its device point. The body: the same in every step, or another one of the same mesh; it must stay
 * unchanged during the call. Rejected, with no change: a body whose last update was rejected, another number of
 * vertices or facets than in the last step, a point that is not finite, a skin too small for the body. */
MORULA_API morula_status morula_haptic_probe_step(morula_haptic_probe* probe, const morula_body* body,
                                                  const double* device, morula_haptic_step* step);
/* Forgets the proxy: the next step starts at its device point. */
MORULA_API void morula_haptic_probe_reset(morula_haptic_probe* probe);

typedef struct morula_haptic_tool_options {
  size_t size;
  double skin;               /* as in morula_haptic_options */
  double stiffness;          /* force per mesh unit between the centers of proxy and device */
  double rotation_stiffness; /* torque per radian; negative: stiffness times inertia per mass of the balls */
  int max_moves;             /* largest number of moves in a step, 1 or more */
} morula_haptic_tool_options;

typedef struct morula_haptic_tool_result {
  double rotation[9], translation[3];          /* pose of the proxy, tool coordinates to world; rotation by rows */
  double force[3], torque[3];                  /* on the device, about the center of mass of the balls */
  int32_t touches, settled, jammed, certified; /* as in morula_haptic_step; jammed also if the tool has not started,
                                                * because a ball reaches the surface at each device pose so far */
  uint32_t moves;
  uint32_t contact_count;
} morula_haptic_tool_result;

typedef struct morula_tool_contact {
  double point[3], barycentric[3], normal[3]; /* as in morula_haptic_step */
  double distance;                            /* from the point to the center of the ball, mesh units */
  uint32_t ball, facet;
} morula_tool_contact;

typedef struct morula_haptic_tool morula_haptic_tool;

MORULA_API void morula_haptic_tool_options_defaults(morula_haptic_tool_options* options, size_t size);
static inline void morula_haptic_tool_options_init(morula_haptic_tool_options* options) {
  morula_haptic_tool_options_defaults(options, sizeof *options);
}
/* Creates a rigid tool of balls, copied, in the tool's coordinates: at least one. options: NULL for the defaults:
 * stiffness 1, 16 moves. */
MORULA_API morula_status morula_haptic_tool_create(const morula_sphere* balls, size_t ball_count,
                                                   const morula_haptic_tool_options* options,
                                                   morula_haptic_tool** tool);
MORULA_API void morula_haptic_tool_destroy(morula_haptic_tool* tool);
/* Moves the proxy toward the device pose x -> R x + t; no ball meets a facet on the way. rotation: 9, by rows.
 * translation: 3. The body: as in morula_haptic_probe_step. */
MORULA_API morula_status morula_haptic_tool_step(morula_haptic_tool* tool, const morula_body* body,
                                                 const double* rotation, const double* translation,
                                                 morula_haptic_tool_result* step);
/* Contacts of the last step, contact_count of them; valid until the next step. */
MORULA_API const morula_tool_contact* morula_haptic_tool_contacts(const morula_haptic_tool* tool);
/* Forgets the proxy: the next step starts at its device pose. */
MORULA_API void morula_haptic_tool_reset(morula_haptic_tool* tool);

/* ---- Scenes: contacts among many bodies. ---- */

typedef struct morula_scene morula_scene;

/* Two bodies that touch or may touch. They touch if leaf spheres overlap, or are no farther apart than the margin. */
typedef struct morula_scene_pair {
  morula_body *a, *b;
  const morula_contact* contacts; /* contacts of a and b */
  size_t contact_count;
  int32_t touches;   /* 1: a touch has begun and not ended; 0: whether the bodies touch is open */
  int32_t confirmed; /* 1: the bodies touch at their present poses; 0: the budget left that open */
  int32_t began;     /* 1: the touch began in the last update */
  int32_t finished;  /* 0: the budget ended before every contact was opened */
} morula_scene_pair;

/* Creates a scene. options: NULL for the defaults; the budget is that of one update, for all pairs together. threads: 1
 * or more; a budget of time uses one. */
MORULA_API morula_status morula_scene_create(const morula_contact_options* options, int threads, morula_scene** scene);
MORULA_API void morula_scene_destroy(morula_scene* scene);
/* Adds a body, which may be updated and moved; the scene reads it in its own update. is_static: not 0 for a body that
 * never moves; two static bodies form no pair. A body that the scene already has is a bad argument. */
MORULA_API morula_status morula_scene_add(morula_scene* scene, morula_body* body, int is_static);
MORULA_API morula_status morula_scene_remove(morula_scene* scene, const morula_body* body);
/* Finds the pairs of bodies that touch or may touch; called once a frame, after the bodies have moved. If the rules
 * cover and two surfaces cross, their pair is found and the crossing lies within one of its contacts, even if the
 * budget ends the search. Rejected, with no change: a body whose last update was rejected. */
MORULA_API morula_status morula_scene_update(morula_scene* scene);
MORULA_API size_t morula_scene_pair_count(const morula_scene* scene);
/* The pairs; valid until the scene is updated or destroyed, or a body is removed. A touch without a pair has
 * ended. */
MORULA_API const morula_scene_pair* morula_scene_pairs(const morula_scene* scene);

#ifdef __cplusplus
}
#endif

#endif
